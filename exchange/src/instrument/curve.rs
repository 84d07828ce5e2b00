//! What one measurement shows: a mean at each target for each direction. In: readings in runs. Out: the curve with its
//! uncertainties, and figures of the whole.

use super::placed::{Placed, Way};
use super::uncertainty::{Uncertainty, count, mean, of_mean, together};

/// The mean of the readings at one target from one side: mm or rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// How many readings it is of.
    pub readings: usize,
    /// Its standard uncertainty from the scatter of the runs; not known from one reading.
    pub uncertainty: Option<Uncertainty>,
}

/// A measured curve over the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Where: mm or rad, ascending.
    pub positions: Vec<f64>,
    /// While the axis moved in its positive direction, where it was read so.
    pub forward: Option<Vec<Mean>>,
    /// While it moved in its negative direction, where it was read so.
    pub reverse: Option<Vec<Mean>>,
}

/// A curve with what belongs to it as a whole.
#[derive(Clone, Debug)]
pub(super) struct Averaged {
    pub(super) curve: Curve,
    /// Targets that lack a reading from one side, and are left out.
    pub(super) left_out: Vec<f64>,
    /// The runs over all targets of the curve, as departures from its means: forward and reverse.
    departures: [Vec<Vec<f64>>; 2],
}

impl Averaged {
    /// Averages over the runs.
    pub(super) fn new(placed: &Placed) -> Self {
        let side = |forward: bool| {
            let mut at = vec![Vec::new(); placed.positions.len()];
            let own = placed.runs.iter().filter(move |run| run.forward == forward);
            for (target, value) in own.flat_map(|run| &run.readings) {
                if let Some(readings) = at.get_mut(*target) {
                    readings.push(*value);
                }
            }
            placed.runs.iter().any(|run| run.forward == forward).then_some(at)
        };
        let (forward, reverse) = (side(true), side(false));
        let read = |side: &Option<Vec<Vec<f64>>>, target: usize| {
            side.as_ref().is_none_or(|side| side.get(target).is_some_and(|readings| !readings.is_empty()))
        };
        let (kept, lost): (Vec<usize>, Vec<usize>) = (0..placed.positions.len())
            .partition(|target| read(&forward, *target) && read(&reverse, *target));
        let at = |targets: &[usize]| -> Vec<f64> {
            targets.iter().filter_map(|target| placed.positions.get(*target).copied()).collect()
        };
        let means = |side: Option<Vec<Vec<f64>>>| {
            let side = side?;
            Some(
                kept.iter()
                    .filter_map(|target| side.get(*target))
                    .map(|readings| Mean::of(readings))
                    .collect(),
            )
        };
        let curve = Curve { positions: at(&kept), forward: means(forward), reverse: means(reverse) };
        let departures = [true, false].map(|forward| departures(&placed.runs, forward, &kept, &curve));
        Self { left_out: at(&lost), departures, curve }
    }

    /// The uncertainty of a sum over the targets of the mean curve, each with its weight, from the scatter of whole runs:
    /// readings of one run go together. Both directions count half, the one that there is alone. Not known where a direction has
    /// fewer than two whole runs.
    pub(super) fn scatter(&self, weights: &[f64]) -> Option<Uncertainty> {
        let parts = self.scatters(weights);
        let share = 1.0 / count(parts.len());
        together(&parts.iter().map(|part| (share, *part)).collect::<Vec<_>>())
    }

    /// The same of the difference of the directions.
    pub(super) fn scatter_of_difference(&self, weights: &[f64]) -> Option<Uncertainty> {
        let parts = self.scatters(weights);
        together(&parts.iter().map(|part| (1.0, *part)).collect::<Vec<_>>())
    }

    fn scatters(&self, weights: &[f64]) -> Vec<Option<Uncertainty>> {
        let sides = [&self.curve.forward, &self.curve.reverse].into_iter().zip(&self.departures);
        let there = sides.filter(|(side, _)| side.is_some());
        there
            .map(|(_, runs)| {
                let sums: Vec<f64> = runs
                    .iter()
                    .map(|run| run.iter().zip(weights).map(|(one, weight)| one * weight).sum())
                    .collect();
                of_mean(&sums)
            })
            .collect()
    }
}

/// The whole runs of a direction as departures from its means.
fn departures(runs: &[Way], forward: bool, kept: &[usize], curve: &Curve) -> Vec<Vec<f64>> {
    let side = if forward { &curve.forward } else { &curve.reverse };
    let Some(means) = side else { return Vec::new() };
    let own = runs.iter().filter(|run| run.forward == forward);
    own.filter_map(|run| {
        let by_target: std::collections::BTreeMap<usize, f64> = run.readings.iter().copied().collect();
        kept.iter().zip(means).map(|(target, mean)| Some(by_target.get(target)? - mean.value)).collect()
    })
    .collect()
}

impl Mean {
    fn of(readings: &[f64]) -> Self {
        Self { value: mean(readings), readings: readings.len(), uncertainty: of_mean(readings) }
    }

    fn plus(self, offset: f64) -> Self {
        Self { value: self.value + offset, ..self }
    }
}

impl Curve {
    /// The mean of the directions at each target, or the one that there is.
    pub fn centre(&self) -> Vec<f64> {
        match (&self.forward, &self.reverse) {
            (Some(forward), Some(reverse)) => forward
                .iter()
                .zip(reverse)
                .map(|(one, other)| f64::midpoint(one.value, other.value))
                .collect(),
            (one, other) => one.iter().chain(other).flatten().map(|mean| mean.value).collect(),
        }
    }

    /// Forward minus reverse at each target, where both were read.
    pub fn differences(&self) -> Option<Vec<f64>> {
        let (forward, reverse) = (self.forward.as_ref()?, self.reverse.as_ref()?);
        Some(forward.iter().zip(reverse).map(|(one, other)| one.value - other.value).collect())
    }

    /// The curve with something added at each position.
    pub(super) fn plus(&self, added: impl Fn(f64) -> f64) -> Self {
        let side = |side: &Option<Vec<Mean>>| {
            let side = side.as_ref()?;
            Some(side.iter().zip(&self.positions).map(|(mean, at)| mean.plus(added(*at))).collect())
        };
        Self { positions: self.positions.clone(), forward: side(&self.forward), reverse: side(&self.reverse) }
    }

    /// The mean of curves over the same positions.
    pub(super) fn mean(curves: &[Self]) -> Option<Self> {
        let first = curves.first()?;
        let side = |side: fn(&Self) -> &Option<Vec<Mean>>| {
            let at = |place: usize| {
                let means = curves.iter().filter_map(|curve| side(curve).as_ref()?.get(place).copied());
                Mean::of_all(&means.collect::<Vec<_>>())
            };
            side(first).as_ref().map(|own| (0..own.len()).map(at).collect())
        };
        Some(Self {
            positions: first.positions.clone(),
            forward: side(|curve| &curve.forward),
            reverse: side(|curve| &curve.reverse),
        })
    }

    /// Half the sum of two curves over the same positions, the second with a sign.
    pub(super) fn half_sum(&self, other: &Self, sign: f64) -> Self {
        let side = |one: &Option<Vec<Mean>>, other: &Option<Vec<Mean>>| {
            let pairs = one.as_ref()?.iter().zip(other.as_ref()?);
            Some(pairs.map(|(one, other)| one.half_sum(other, sign)).collect())
        };
        Self {
            positions: self.positions.clone(),
            forward: side(&self.forward, &other.forward),
            reverse: side(&self.reverse, &other.reverse),
        }
    }
}

impl Mean {
    /// The mean of independent means, with all their readings.
    fn of_all(means: &[Self]) -> Self {
        let share = 1.0 / count(means.len());
        let parts: Vec<_> = means.iter().map(|mean| (share, mean.uncertainty)).collect();
        Self {
            value: mean(&means.iter().map(|mean| mean.value).collect::<Vec<_>>()),
            readings: means.iter().map(|mean| mean.readings).sum(),
            uncertainty: together(&parts),
        }
    }

    fn half_sum(&self, other: &Self, sign: f64) -> Self {
        Self {
            value: (self.value + sign * other.value) / 2.0,
            readings: self.readings.min(other.readings),
            uncertainty: together(&[(0.5, self.uncertainty), (0.5, other.uncertainty)]),
        }
    }
}
