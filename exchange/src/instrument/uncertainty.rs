//! Standard uncertainties. In: scatter. Out: a standard uncertainty with its degrees of freedom, what several give together, and
//! the interval of 95 % by Student's t.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// A standard uncertainty, in the unit of its quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// The standard uncertainty.
    pub standard: f64,
    /// Its degrees of freedom; infinite where it was given and not estimated.
    pub freedom: f64,
}

impl Uncertainty {
    /// One that was given and not estimated.
    pub fn given(standard: f64) -> Self {
        Self { standard, freedom: f64::INFINITY }
    }

    /// Half of the interval that holds the value with a probability of 95 %: Student's t times the standard uncertainty.
    pub fn expanded(self) -> f64 {
        if self.standard == 0.0 {
            return 0.0;
        }
        let student = StudentsT::new(0.0, 1.0, self.freedom.min(MOST_FREEDOM));
        student.map_or(f64::NAN, |student| student.inverse_cdf(0.975)) * self.standard
    }
}

/// More degrees of freedom make no difference to four digits.
const MOST_FREEDOM: f64 = 1e6;

/// The uncertainty of a sum of independent quantities, each with its factor: the root of the sum of squares, with the degrees
/// of freedom by Welch and Satterthwaite. Not known where one of them is not.
pub(super) fn together(parts: &[(f64, Option<Uncertainty>)]) -> Option<Uncertainty> {
    let (mut variance, mut share) = (0.0, 0.0);
    for (factor, part) in parts {
        let part = (*part)?;
        let square = (factor * part.standard) * (factor * part.standard);
        variance += square;
        share += square * square / part.freedom;
    }
    let freedom = if share > 0.0 { variance * variance / share } else { f64::INFINITY };
    // Without any scatter the freedom is that of the least of its parts.
    let least =
        parts.iter().filter_map(|(_, part)| Some(part.as_ref()?.freedom)).fold(f64::INFINITY, f64::min);
    let freedom = if variance > 0.0 { freedom } else { least };
    Some(Uncertainty { standard: variance.sqrt(), freedom })
}

/// The mean of some values.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / count(values.len())
}

/// The standard uncertainty of the mean of some values, from their scatter; not known from one value.
pub(super) fn of_mean(values: &[f64]) -> Option<Uncertainty> {
    let freedom = count(values.len().checked_sub(1).filter(|freedom| *freedom > 0)?);
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    Some(Uncertainty { standard: (squares / freedom / count(values.len())).sqrt(), freedom })
}

/// A count as a number: exact, as no file holds 2^53 readings.
#[expect(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
pub(super) fn count(number: usize) -> f64 {
    number as f64
}
