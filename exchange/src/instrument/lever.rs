//! Abbe's principle, undone: the angular motions of an axis act on a reading off the carriage's frame, each with its lever arm. In:
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
    /// Those that act at this place and were not measured: they are still in the readings.
    pub remaining: Vec<usize>,
}

/// An angular motion that acts on a measurement.
struct Acting<'c> {
    motion: usize,
    /// Its curve, where it was measured.
    curve: Option<&'c Curve>,
    /// Its lever arm at each position, mm, in the sense of the motion that is measured.
    arms: Vec<f64>,
}

/// Takes the angular motions off the readings; what they are measured as stands in `angles`. The second answer adds their
/// uncertainty to those of the means.
pub(super) fn take_off(
    placed: &mut Placed,
    one: &Measurement,
    place: &Place,
    angles: &[(usize, &Curve)],
    view: &View<'_>,
) -> (Levers, Shares) {
    let acting = acting(&placed.positions, one, place, angles, view);
    let mut levers = Levers::default();
    let mut shares = Shares::default();
    for one in &acting {
        let Some(curve) = one.curve else {
            levers.remaining.push(one.motion);
            continue;
        };
        let mut most = 0.0_f64;
        for run in &mut placed.runs {
            for (target, value) in &mut run.readings {
                let at = placed.positions.get(*target).copied().unwrap_or(f64::NAN);
                let share =
                    one.arms.get(*target).copied().unwrap_or(f64::NAN) * side(curve, run.forward, at).0;
                most = most.max(share.abs());
                *value -= share;
            }
        }
        levers.taken.push((one.motion, most));
        shares.0.push((curve.clone(), one.arms.clone()));
    }
    shares.1.clone_from(&placed.positions);
    (levers, shares)
}

/// The angular motions of the axis that have a lever arm somewhere along the measurement.
fn acting<'c>(
    positions: &[f64],
    one: &Measurement,
    place: &Place,
    angles: &[(usize, &'c Curve)],
    view: &View<'_>,
) -> Vec<Acting<'c>> {
    const NOTHING: f64 = 1e-9;
    let there = view.at_place(place);
    let (Some(direction), Some(shown)) = (view.direction(one.motion.value), view.shown(one.motion.value))
    else {
        return Vec::new();
    };
    let levers: Vec<Vec<[f64; 3]>> = positions.iter().map(|at| there.levers(one.axis, *at, place)).collect();
    let motions = view.equations.motions.iter().enumerate();
    let own =
        motions.filter(|(_, motion)| motion.angular && !motion.alignment && motion.axis == Some(one.axis));
    own.filter_map(|(motion, _)| {
        let arm = |all: &Vec<[f64; 3]>| all.get(motion).map_or(0.0, |lever| dot(*lever, direction) / shown);
        let arms: Vec<f64> = levers.iter().map(arm).collect();
        let curve = angles.iter().find(|(known, _)| *known == motion).map(|(_, curve)| *curve);
        arms.iter().any(|arm| arm.abs() > NOTHING).then_some(Acting { motion, curve, arms })
    })
    .collect()
}

/// What uncertain angles add to the uncertainty of each mean: curves with their lever arms over the positions of all targets.
#[derive(Default)]
pub(super) struct Shares(Vec<(Curve, Vec<f64>)>, Vec<f64>);

impl Shares {
    /// Adds the uncertainties of the angles to those of a curve's means.
    pub(super) fn add_to(&self, curve: &mut Curve) {
        let positions = curve.positions.clone();
        for (forward, means) in [(true, &mut curve.forward), (false, &mut curve.reverse)] {
            for (mean, at) in means.iter_mut().flatten().zip(&positions) {
                let mut parts = vec![(1.0, mean.uncertainty)];
                let target = self.1.iter().position(|position| position == at);
                let arm =
                    |arms: &Vec<f64>| target.and_then(|target| arms.get(target)).copied().unwrap_or(f64::NAN);
                parts.extend(self.0.iter().map(|(angle, arms)| (arm(arms), side(angle, forward, *at).1)));
                mean.uncertainty = together(&parts);
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
