//! The amplitude of a wave that may be hidden in noise. In: its sine and cosine with their covariance. Out: the amplitude with an interval.
//!
//! The length of (a, b) is too large where the wave is weak: noise alone has a length. So the interval holds those amplitudes A for which
//! a length as short, and one as long, as was found have 2.5 % each: of a length with equal noise s in both, (r/s)^2 follows the
//! noncentral chi-squared distribution of two degrees of freedom with the offset (A/s)^2. It begins at 0 where noise alone gives the
//! length, and is r -+ 1.96 s where the wave is strong.

use nalgebra::DMatrix;

use crate::diagnosis::Estimate;

/// Below each end.
const TAIL: f64 = 0.025;

/// The amplitude in a unit, of which `factor` make one of that of the coefficients; nothing where a coefficient is not known.
pub(super) fn amplitude(
    coefficients: &[f64],
    covariance: &DMatrix<f64>,
    (factor, unit): (f64, &str),
) -> Option<Estimate> {
    let [sine, cosine] = coefficients else { return None };
    let part = |row: usize, column: usize| covariance.get((row, column)).copied();
    let (first, second, both) = (part(0, 0)?, part(1, 1)?, part(0, 1)?);
    let length = sine.hypot(*cosine);
    // Along the wave that was found; of a weak one any direction is as good.
    let (cos, sin) = if length > 0.0 { (sine / length, cosine / length) } else { (1.0, 0.0) };
    let along = cos * cos * first + 2.0 * cos * sin * both + sin * sin * second;
    let noise = along.sqrt();
    if !(noise > 0.0 && noise.is_finite() && length.is_finite()) {
        return None;
    }
    let reached = length / noise;
    // A length shorter than the noise is luck, and says no more than one of the size of the noise.
    let ends = (offset(reached, 1.0 - TAIL), offset(reached.max(1.0), TAIL));
    // The length without what noise adds to it on average, which is half the variance over the length.
    let value = (reached * reached - 1.0).max(0.0).sqrt().clamp(ends.0, ends.1);
    let scaled = |of: f64| of * noise * factor;
    Some(Estimate { value: scaled(value), ci95: (scaled(ends.0), scaled(ends.1)), unit: unit.to_owned() })
}

/// The offset from zero for which a length up to `reached` has this probability; 0 where it has less for no offset.
fn offset(reached: f64, probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, reached + FAR);
    if below(reached, low) < probability {
        return 0.0;
    }
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if below(reached, middle) < probability { high = middle } else { low = middle }
    }
    (low + high) / 2.0
}

/// An offset of 5 standard deviations more than the length that was reached leaves less than 1e-6 below it, and not 2.5 %.
const FAR: f64 = 5.0;

/// Halvings of an interval until nothing of it is left in ten digits.
const HALVINGS: usize = 40;

/// The probability that a length is at most `reached` with this offset, both in standard deviations: the density
/// r exp(-(r^2 + A^2) / 2) I0(r A), integrated where it is not nothing.
fn below(reached: f64, offset: f64) -> f64 {
    let from = (offset - SPREAD).max(0.0);
    if reached <= from {
        return 0.0;
    }
    let to = reached.min(offset + SPREAD);
    let step = (to - from) / STEPS;
    let density =
        |length: f64| length * (-(length - offset).powi(2) / 2.0).exp() * scaled_bessel(length * offset);
    // Simpson's rule: weights 1, 4, 2, 4, ..., 4, 1.
    let mut sum = density(from) + density(to);
    let mut place = 1.0;
    while place < STEPS {
        let weight = if place % 2.0 == 0.0 { 2.0 } else { 4.0 };
        sum += weight * density(from + place * step);
        place += 1.0;
    }
    sum * step / 3.0
}

/// A normal distribution has less than 1e-15 beyond.
const SPREAD: f64 = 8.0;

/// Steps of the integral, an even number: the rule is right to 1e-7, as is the Bessel function.
const STEPS: f64 = 128.0;

/// exp(-x) I0(x), to 2e-7: Abramowitz and Stegun, 9.8.1 and 9.8.2.
fn scaled_bessel(x: f64) -> f64 {
    if x < 3.75 {
        let t = (x / 3.75).powi(2);
        let series = [3.515_622_9, 3.089_942_4, 1.206_749_2, 0.265_973_2, 0.036_076_8, 0.004_581_3];
        return (-x).exp() * (1.0 + t * horner(&series, t));
    }
    let series = [
        0.398_942_28,
        0.013_285_92,
        0.002_253_19,
        -0.001_575_65,
        0.009_162_81,
        -0.020_577_06,
        0.026_355_37,
        -0.016_476_33,
        0.003_923_77,
    ];
    horner(&series, 3.75 / x) / x.sqrt()
}

fn horner(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

#[cfg(test)]
mod tests {
    use super::{amplitude, below};
    use nalgebra::DMatrix;

    #[test]
    fn a_length_of_noise_alone_is_rayleigh_s() {
        for length in [0.3_f64, 1.0, 2.4477] {
            assert!((below(length, 0.0) - (1.0 - (-length * length / 2.0).exp())).abs() < 1e-6, "{length}");
        }
        assert!((below(30.0, 3.0) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_strong_wave_has_the_interval_of_a_straight_line_and_a_weak_one_begins_at_zero() {
        let noise = DMatrix::from_diagonal_element(3, 3, 1e-8);
        let strong = amplitude(&[3e-3, 4e-3], &noise, (1000.0, "um")).unwrap();
        assert!((strong.value - 5.0).abs() < 2e-3);
        assert!((strong.ci95.0 - (5.0 - 0.196)).abs() < 3e-3 && (strong.ci95.1 - 5.196).abs() < 3e-3);
        let weak = amplitude(&[1e-4, 0.0], &noise, (1000.0, "um")).unwrap();
        assert!(weak.ci95.0 == 0.0 && weak.ci95.1 > 0.1 && weak.value == 0.0, "{weak:?}");
    }
}
