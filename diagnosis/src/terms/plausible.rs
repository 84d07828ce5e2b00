//! Plausible sizes: the prior of a term.
//!
//! In: a term with its coefficients. Out: what its size costs beyond what its physics allows, in units of minus twice the
//! log-likelihood. Within the plausible range, which the reports print, nothing; beyond it the square of how many times, as a
//! normal distribution of the logarithm has it. A size that nobody has seen is not forbidden: it needs the more evidence.

use super::{Shape, acceleration, expansion, lag};

/// The standard deviation of the logarithm of a size beyond its plausible range: twice the end of the range costs 4, ten times
/// 43, which only an effect far above the noise pays.
const BEYOND: f64 = 0.35;

/// What a size costs beyond its plausible range.
pub(crate) fn oddity(shape: &Shape, coefficients: &[f64]) -> f64 {
    let [coefficient] = coefficients else { return 0.0 };
    let size = coefficient.abs();
    match shape {
        Shape::Lag { .. } => outside(1.0 / size, lag::PLAUSIBLE),
        Shape::Acceleration { .. } => outside(1.0 / size, acceleration::PLAUSIBLE),
        Shape::Expansion { .. } => outside(size, expansion::PLAUSIBLE),
        _ => 0.0,
    }
}

fn outside(size: f64, (least, most): (f64, f64)) -> f64 {
    if !size.is_finite() || size <= 0.0 {
        return 0.0;
    }
    let times = (least / size).ln().max((size / most).ln()).max(0.0);
    (times / BEYOND).powi(2)
}
