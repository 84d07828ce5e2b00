//! `polynomial`: a smooth error along an axis (scale, straightness, pitch), or a component against temperature.
//!
//! In: positions or temperatures. Out: the powers of x = (q - center) / scale, which are far less alike than those of q;
//! [`in_position`] turns coefficients of x into those of q.

use super::Shape;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "A smooth error along the axis: power 1 is a scale error or an inclined guide, higher powers \
    are a bent guide.";

/// Fills the powers of x from `first` on.
pub(crate) fn fill(inputs: &[f64], center: f64, scale: f64, first: usize, out: &mut [Vec<f64>]) {
    out.iter_mut().for_each(Vec::clear);
    for input in inputs {
        let x = (input - center) / scale;
        let mut power = if first == 0 { 1.0 } else { x };
        for column in out.iter_mut() {
            column.push(power);
            power *= x;
        }
    }
}

/// The matrix that turns the coefficients of a polynomial or a coupling into those of powers of the position (or the
/// temperature) itself, from power 0 on: a row for each power.
pub(crate) fn in_position(shape: &Shape) -> Vec<Vec<f64>> {
    let (first, degree, center, scale) = match *shape {
        Shape::Polynomial { degree, center, scale, .. }
        | Shape::SensorPolynomial { degree, center, scale, .. } => (0, degree, center, scale),
        Shape::Coupling { degree, scale, .. } => (1, degree, 0.0, scale),
        _ => return Vec::new(),
    };
    // x^k = sum over m of binomial(k, m) q^m (-center)^(k-m) / scale^k
    let mut matrix = vec![vec![0.0; degree + 1 - first]; degree + 1];
    for k in first..=degree {
        let mut binomial = 1.0;
        for (m, row) in matrix.iter_mut().enumerate().take(k + 1) {
            row[k - first] = binomial * power(-center, k - m) / power(scale, k);
            binomial *= crate::number(k - m) / crate::number(m + 1);
        }
    }
    matrix
}

fn power(base: f64, exponent: usize) -> f64 {
    (0..exponent).fold(1.0, |product, _| product * base)
}
