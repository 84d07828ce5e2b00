//! How large a correction may be. In: a calibration that was measured. Out: the limit that its own data give, for whoever sets none.
//!
//! A controller that is told no limit moves by whatever a slip of a unit makes of a table. What was measured tells how large
//! corrections are; twice as much leaves room for another place of the tool and for what changes until the next calibration.

use model_dsl::calibration::Calibration;
use model_dsl::equations::Equations;
use model_dsl::source::Spanned;

use crate::controller::{Geometry, Space, Wanted};

/// The limit is this many times the largest correction: room for another place of the tool, and for what changes until the next
/// calibration. A slip of a unit makes ten times as much and more.
const ROOM: f64 = 2.0;

/// The largest correction within the measured range, and the limit that it gives: mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// The largest correction over all slides.
    pub largest: f64,
    /// Twice as much, rounded up to two digits.
    pub limit: f64,
}

/// Writes the limit of corrections into a calibration that has none. Nothing where it has one, where nothing is to be corrected, where the
/// inverse refuses, or where the correction depends on an axis over which nothing was measured: how large it becomes is then not known.
pub(super) fn write(calibration: &mut Calibration, equations: &Equations) -> Option<Bound> {
    if calibration.limits.compensation.is_some() {
        return None;
    }
    let bound = bound(calibration, equations)?;
    calibration.limits.compensation = Some(Spanned::new(bound.limit, Default::default()));
    Some(bound)
}

fn bound(calibration: &Calibration, equations: &Equations) -> Option<Bound> {
    let unmeasured = unmeasured(calibration, equations);
    let wanted =
        unmeasured.iter().filter_map(|axis| Some((equations.axes.get(*axis)?.letter.clone(), PLACE)));
    let wanted = Wanted { ranges: wanted.collect(), ..Wanted::default() };
    let space = Space::new(equations, calibration, &wanted).ok()?;
    let geometry = Geometry::new(equations, calibration);
    let mut largest = 0.0_f64;
    for pose in space.poses(&geometry) {
        let correction = geometry.correction(&pose).ok()?;
        for axis in &unmeasured {
            let elsewhere = geometry.correction(&pose.moved(*axis, FAR)).ok()?;
            if elsewhere.iter().zip(&correction).any(|(there, here)| (there - here).abs() > SAME) {
                return None;
            }
        }
        let slides = equations.axes.iter().zip(correction).filter(|(axis, _)| !axis.rotary);
        let size = slides.map(|(_, part)| part * part).sum::<f64>().sqrt();
        largest = largest.max(size);
    }
    (largest > 0.0 && largest.is_finite()).then(|| Bound { largest, limit: rounded_up(ROOM * largest) })
}

/// Where an axis stands over which nothing was measured, mm or rad: a range must have an extent.
const PLACE: [f64; 2] = [0.0, 1e-6];

/// Another place of such an axis, mm or rad.
const FAR: f64 = 1.0;

/// Corrections that differ by less are the same, mm or rad: a nanometre over a travel of a metre, for a place that is a millimetre away.
const SAME: f64 = 1e-9;

/// The axes over which nothing was measured.
fn unmeasured(calibration: &Calibration, equations: &Equations) -> Vec<usize> {
    let measured = |axis: usize| {
        let mut terms = calibration.motions.iter().flat_map(|motion| &motion.terms);
        terms.any(|term| !term.value.nodes(axis).is_empty())
    };
    (0..equations.axes.len()).filter(|axis| !measured(*axis)).collect()
}

/// Rounded up to two digits, so that a person can read it.
fn rounded_up(value: f64) -> f64 {
    let step = 10.0_f64.powf(value.log10().floor() - 1.0);
    // Steps are counted first: a tenth is no binary number, and 0.2 stays 0.2.
    let steps = (value / step * (1.0 - 1e-12)).ceil();
    format!("{:.12}", steps * step).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_rounded_up_to_two_digits() {
        for (value, limit) in
            [(0.2, 0.2), (0.201, 0.21), (0.0123, 0.013), (1.0, 1.0), (9.91, 10.0), (3e-5, 3e-5)]
        {
            assert!((rounded_up(value) - limit).abs() < 1e-12, "{value}: {}", rounded_up(value));
        }
    }
}
