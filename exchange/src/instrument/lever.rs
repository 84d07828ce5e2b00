//! Abbe's principle, undone: angular motions act on a reading off the carriage's frame, each with its lever arm. In:
//! readings of a displacement, where they were taken, and the angular motions that were measured. Out: the readings without them.
//!
//! The lever arms are those of the machine's equations at the place of the measurement. Nothing is taken off where the set-up does
//! not say where that was.

use super::curve::Curve;
use super::placed::Placed;
use super::setup::{Measurement, Place};
use super::uncertainty::{Uncertainty, together};
use super::view::{View, dot};

/// What lever arms did to a measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Levers {
    /// The angular motions that were taken off, with the most that each of them made, mm: indices of motions.
    pub taken: Vec<(usize, f64)>,
    /// Those of the moving axis that act at this place and were not measured: they are still in the readings.
    pub remaining: Vec<usize>,
}

/// An angular motion that was measured and acts on a measurement.
struct Acting {
    motion: usize,
    curve: Curve,
    /// Where its axis stood, where it is not the one that moved.
    stood: Option<f64>,
    /// Its lever arm at each target, mm, in the sense of the motion that is measured.
    arms: Vec<f64>,
}

impl Acting {
    /// The angle and its uncertainty while the moving axis comes to a position; of an axis that stood, the mean of its directions.
    fn angle(&self, forward: bool, at: f64) -> (f64, Option<Uncertainty>) {
        let Some(stood) = self.stood else { return side(&self.curve, forward, at) };
        let ((one, first), (other, second)) =
            (side(&self.curve, true, stood), side(&self.curve, false, stood));
        (f64::midpoint(one, other), first.or(second))
    }

    fn arm(&self, target: usize) -> f64 {
        self.arms.get(target).copied().unwrap_or(f64::NAN)
    }
}

/// Takes the angular motions off the readings; what they are measured as stands in `angles`. The second answer adds their
/// uncertainty to those of the means.
///
/// Those of axes that stood are taken off too: the zero of an angular instrument is as it happened to be, and a calibration
/// with that zero in the angle must not have it in a squareness again.
pub(super) fn take_off(
    placed: &mut Placed,
    one: &Measurement,
    place: &Place,
    angles: &[(usize, &Curve)],
    view: &View<'_>,
) -> (Levers, Shares) {
    let (acting, remaining) = acting(&placed.positions, one, place, angles, view);
    let mut levers = Levers { taken: Vec::new(), remaining };
    for one in &acting {
        let mut most = 0.0_f64;
        for run in &mut placed.runs {
            for (target, value) in &mut run.readings {
                let at = placed.positions.get(*target).copied().unwrap_or(f64::NAN);
                let share = one.arm(*target) * one.angle(run.forward, at).0;
                most = most.max(share.abs());
                *value -= share;
            }
        }
        levers.taken.push((one.motion, most));
    }
    (levers, Shares { acting, positions: placed.positions.clone() })
}

/// The angular motions that have a lever arm somewhere along the measurement: those that were measured; and those of the moving
/// axis that were not.
fn acting(
    positions: &[f64],
    one: &Measurement,
    place: &Place,
    angles: &[(usize, &Curve)],
    view: &View<'_>,
) -> (Vec<Acting>, Vec<usize>) {
    const NOTHING: f64 = 1e-9;
    let (mut measured, mut remaining) = (Vec::new(), Vec::new());
    let arms = arms(positions, one, place, view);
    let motions = view.equations.motions.iter().enumerate().zip(arms);
    for ((motion, known), arms) in motions.filter(|((_, known), _)| known.angular && !known.alignment) {
        let Some(axis) = known.axis.filter(|_| arms.iter().any(|arm| arm.abs() > NOTHING)) else { continue };
        let moves = axis == one.axis;
        match angles.iter().find(|(other, _)| *other == motion) {
            Some((_, curve)) => {
                let stood = (!moves).then(|| place.position(axis));
                measured.push(Acting { motion, curve: (*curve).clone(), stood, arms });
            }
            None if moves => remaining.push(motion),
            None => {}
        }
    }
    (measured, remaining)
}

/// The lever arm of every motion at every target, in the sense of the motion that is measured.
fn arms(positions: &[f64], one: &Measurement, place: &Place, view: &View<'_>) -> Vec<Vec<f64>> {
    let there = view.at_place(place);
    let (Some(direction), Some(shown)) = (view.direction(one.motion.value), view.shown(one.motion.value))
    else {
        return Vec::new();
    };
    let levers: Vec<Vec<[f64; 3]>> = positions.iter().map(|at| there.levers(one.axis, *at, place)).collect();
    let arm = |all: &Vec<[f64; 3]>, motion: usize| {
        all.get(motion).map_or(0.0, |lever| dot(*lever, direction) / shown)
    };
    let motions = 0..view.equations.motions.len();
    motions.map(|motion| levers.iter().map(|all| arm(all, motion)).collect()).collect()
}

/// The first measured rotation whose zero would be in the slope of a straightness that does not say where it was taken: its lever
/// arm changes along the axis.
pub(super) fn turning(one: &Measurement, ends: &[f64], angles: &[usize], view: &View<'_>) -> Option<usize> {
    const NOTHING: f64 = 1e-9;
    let arms = arms(ends, one, &Place::default(), view);
    let changes = |arms: &Vec<f64>| {
        arms.windows(2).any(|pair| matches!(pair, [one, other] if (one - other).abs() > NOTHING))
    };
    angles.iter().copied().find(|motion| arms.get(*motion).is_some_and(changes))
}

/// What uncertain angles add to the uncertainty of each mean.
pub(super) struct Shares {
    acting: Vec<Acting>,
    /// The positions of all targets, to which the lever arms belong.
    positions: Vec<f64>,
}

impl Shares {
    /// Adds the uncertainties of the angles to those of a curve's means.
    pub(super) fn add_to(&self, curve: &mut Curve) {
        let positions = curve.positions.clone();
        for (forward, means) in [(true, &mut curve.forward), (false, &mut curve.reverse)] {
            for (mean, at) in means.iter_mut().flatten().zip(&positions) {
                let target = self.positions.iter().position(|position| position == at).unwrap_or(usize::MAX);
                let own = (1.0, mean.uncertainty);
                let more = self.acting.iter().map(|one| (one.arm(target), one.angle(forward, *at).1));
                mean.uncertainty = together(&std::iter::once(own).chain(more).collect::<Vec<_>>());
            }
        }
    }
}

/// A curve and its uncertainty at a position while the axis goes one way: linear between its targets, held beyond them. The
/// uncertainty is the greater one of the neighbours. A direction that was not read is taken for the other one.
fn side(curve: &Curve, forward: bool, at: f64) -> (f64, Option<Uncertainty>) {
    let (own, other) = (&curve.forward, &curve.reverse);
    let means = if forward { own.as_ref().or(other.as_ref()) } else { other.as_ref().or(own.as_ref()) };
    let Some(means) = means else { return (f64::NAN, None) };
    let above = curve.positions.partition_point(|position| *position < at).min(means.len().saturating_sub(1));
    let below = if curve.positions.get(above) == Some(&at) { above } else { above.saturating_sub(1) };
    let (Some(low), Some(high)) = (means.get(below), means.get(above)) else { return (f64::NAN, None) };
    let position = |place: usize| curve.positions.get(place).copied().unwrap_or(f64::NAN);
    let (left, right) = (position(below), position(above));
    let share = if right > left { ((at - left) / (right - left)).clamp(0.0, 1.0) } else { 0.0 };
    let greater = low.uncertainty.zip(high.uncertainty);
    let greater = greater.map(|(one, other)| if one.standard > other.standard { one } else { other });
    (low.value + share * (high.value - low.value), greater)
}
