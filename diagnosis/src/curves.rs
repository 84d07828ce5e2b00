//! Curves: a table in the place of several smooth terms that only imitate it together.
//!
//! In: a fitted model. Out: the same, or one in which a `table` of an error motion stands for the polynomial and the long
//! waves of that motion, where it says the same with less.

pub(crate) mod nodes;

use crate::conditions::Conditions;
use crate::fit::Fit;
use crate::harmonics;
use crate::model::{Effect, Fitted, Model, Place};
use crate::scene::Scene;
use crate::study::Study;
use crate::terms::Shape;
use crate::travel::Travel;

/// How many nodes are tried.
const NODES: [usize; 3] = [8, 12, 20];
/// Of how many even nodes those are taken that a curve needs: what has a place of its own there is a fortieth of the travel long.
pub(crate) const FINE: usize = 40;
/// A wave of more than this share of the travel may be part of a curve.
pub(crate) const LONG: f64 = 0.12;

/// Tries tables for every motion of which two or more smooth terms are in the model, or a polynomial of a high power, and of
/// every axis that is known at stations alone. A table over one place stays: smooth terms beside it are others.
pub(crate) fn try_tables(study: &Study<'_>, mut fit: Fit, conditions: &Conditions<'_>) -> Fit {
    let travels = conditions.travels;
    let mut places: Vec<(Place, usize)> = Vec::new();
    for fitted in fit.model.chosen() {
        if let Some(axis) = smooth(&fitted.effect, travels).or_else(|| wave_along(&fitted.effect))
            && !places.contains(&(fitted.effect.place, axis))
        {
            places.push((fitted.effect.place, axis));
        }
    }
    for at_stations in known_at_stations(study, travels) {
        if !places.contains(&at_stations) {
            places.push(at_stations);
        }
    }
    places.retain(|(place, axis)| {
        !fit.model.effects.iter().any(|fitted| is_dent(fitted, *place, &travels[*axis]))
    });
    for (place, axis) in places {
        let imitations = [false, true].map(|waving| Imitation { place, axis, waving });
        for imitation in imitations {
            fit = imitation.replaced(study, fit, conditions);
        }
    }
    fit
}

/// The own motions of axes that are known at stations alone: a table of what was read there is the first thing to try.
fn known_at_stations(study: &Study<'_>, travels: &[Travel]) -> Vec<(Place, usize)> {
    let axes = (0..travels.len()).filter(|axis| travels[*axis].is_known_at_stations_alone());
    axes.filter_map(|axis| Some((study.own_place(axis)?, axis))).collect()
}

/// What may imitate a curve of a motion along an axis.
struct Imitation {
    place: Place,
    axis: usize,
    /// Whether waves of any length may, which together draw every curve.
    waving: bool,
}

impl Imitation {
    /// Whether it holds an effect of a model. A wave with harmonics that comes again is no curve: what one turn of a screw does, the next
    /// does too, and a table would have to say it anew for each turn.
    fn holds(&self, model: &Model, fitted: &Fitted, travels: &[Travel]) -> bool {
        fitted.effect.place == self.place
            && !harmonics::comes_again(model, &fitted.effect, travels)
            && (smooth(&fitted.effect, travels) == Some(self.axis) || self.waving && waves(fitted, self.axis))
    }

    /// Whether there is enough of it for a table to be tried.
    fn is_tried(&self, model: &Model, travels: &[Travel]) -> bool {
        let parts: Vec<&Fitted> =
            model.effects.iter().filter(|fitted| self.holds(model, fitted, travels)).collect();
        let winding =
            |fitted: &&Fitted| matches!(fitted.effect.shape, Shape::Polynomial { degree, .. } if degree > 2);
        let unnamed = parts.is_empty() && travels[self.axis].is_known_at_stations_alone();
        if self.waving {
            parts.len() >= MANY
        } else {
            unnamed || parts.len() > 1 || parts.iter().any(winding)
        }
    }

    /// The fit with a table in the place of it, where that says the same with less.
    fn replaced(&self, study: &Study<'_>, mut fit: Fit, conditions: &Conditions<'_>) -> Fit {
        let Conditions { weights, travels, .. } = *conditions;
        if !self.is_tried(&fit.model, travels) {
            return fit;
        }
        let travel = &travels[self.axis];
        let kept = fit.model.keeping(|fitted| !self.holds(&fit.model, fitted, travels));
        let mut shapes = tables(study, self.axis, travel);
        if self.waving {
            let fine = even(travel.low, travel.high, FINE);
            shapes.extend(nodes::thinned(study, &kept, (self.place, self.axis), &fine, weights));
        }
        for shape in shapes {
            let effect = Effect { place: self.place, shape };
            let trial = kept.with(Fitted::unfitted(effect));
            let trial = conditions.refine(study, trial);
            if conditions.cost(study, &trial) >= conditions.cost(study, &fit) {
                continue;
            }
            // A curve that is flat but for one place is a place; that is looked for elsewhere, without imitations.
            if trial.model.effects.last().is_some_and(|table| is_dent(table, self.place, travel)) {
                return conditions.refine(study, kept);
            }
            fit = trial;
        }
        fit
    }
}

/// A model without the vibrations of a motion of which many are multiples of one frequency and none of those stands out, where it has
/// any: they draw pulses that come at equal times, which have no name here. Waves along an axis are kept: the elements of one drive
/// repeat in multiples of each other.
pub(crate) fn without_combs(model: &Model) -> Option<Model> {
    let vibrations: Vec<(&Fitted, f64)> = model.chosen().iter().filter_map(vibration).collect();
    let is_comb = |(lowest, of): &&(&Fitted, f64)| {
        let same = vibrations.iter().filter(|(other, _)| other.effect.place == lowest.effect.place);
        let teeth = same.filter(|(_, frequency)| is_multiple(*frequency, *of));
        let energies: Vec<f64> = teeth.map(|(tooth, _)| energy(tooth)).collect();
        energies.len() >= MANY && !one_stands_out(&energies)
    };
    let place = vibrations.iter().find(is_comb)?.0.effect.place;
    Some(model.keeping(|fitted| fitted.effect.place != place || vibration(fitted).is_none()))
}

/// A vibration with its frequency.
fn vibration(fitted: &Fitted) -> Option<(&Fitted, f64)> {
    match fitted.effect.shape {
        Shape::Vibration { frequency } => Some((fitted, frequency)),
        _ => None,
    }
}

/// Whether a frequency is a multiple of another one.
fn is_multiple(frequency: f64, of: f64) -> bool {
    let times = frequency / of;
    times.round() >= 1.0 && (times / times.round() - 1.0).abs() < COMB
}

/// A frequency may be off from its multiple by this share. Pulses of a real warm-up, the one recording that holds any, are off by up
/// to as much: they do not come at exactly equal times. Three frequencies within a decade above a fourth are all multiples of it in
/// so narrow a band by chance once in 250 times.
const COMB: f64 = 0.02;

fn energy(fitted: &Fitted) -> f64 {
    fitted.coefficients.iter().map(|value| value * value).sum()
}

fn one_stands_out(energies: &[f64]) -> bool {
    let largest = energies.iter().fold(0.0, |most: f64, energy| most.max(*energy));
    largest >= STANDS_OUT * energies.iter().sum::<f64>()
}

/// Whether an effect is a table of this motion that is flat but for one place.
pub(crate) fn is_dent(fitted: &Fitted, place: Place, travel: &Travel) -> bool {
    fitted.effect.place == place
        && active(fitted).is_some_and(|(from, to)| to - from < BROAD * travel.range())
}

/// The share of the travel from which on a feature is a curve, and below which it is a place.
pub(crate) const BROAD: f64 = 0.3;

/// The share of a table's height from which on it is active.
const ACTIVE: f64 = 0.2;

/// Where a table differs from its median: from the last quiet node before to the first one behind.
pub(crate) fn active(fitted: &Fitted) -> Option<(f64, f64)> {
    let Shape::Table { nodes, .. } = &fitted.effect.shape else { return None };
    let median = median_along(nodes, &fitted.coefficients)?;
    let height = fitted.coefficients.iter().map(|value| (value - median).abs()).fold(0.0, f64::max);
    if height == 0.0 {
        return None;
    }
    let moved = |value: &f64| (value - median).abs() > ACTIVE * height;
    let places = fitted
        .coefficients
        .iter()
        .enumerate()
        .filter(|(_, value)| moved(value))
        .map(|(at, _)| at % nodes.len());
    let (first, last) =
        places.fold((nodes.len(), 0), |(first, last), place| (first.min(place), last.max(place)));
    let from = nodes.get(first.saturating_sub(1))?;
    let to = nodes.get((last + 1).min(nodes.len() - 1))?;
    Some((*from, *to))
}

/// The median of a table's values along its axis: each counts for the travel that is nearest to its node.
fn median_along(nodes: &[f64], values: &[f64]) -> Option<f64> {
    let last = nodes.len().checked_sub(1)?;
    let length = |at: usize| (nodes[(at + 1).min(last)] - nodes[at.saturating_sub(1)]) / 2.0;
    let mut sorted: Vec<(f64, f64)> =
        values.iter().enumerate().map(|(at, value)| (*value, length(at % nodes.len()))).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = sorted.iter().map(|(_, length)| length).sum::<f64>() / 2.0;
    let mut passed = 0.0;
    sorted.into_iter().find_map(|(value, length)| {
        passed += length;
        (passed >= half).then_some(value)
    })
}

/// The axis along which an effect is a smooth curve.
fn smooth(effect: &Effect, travels: &[Travel]) -> Option<usize> {
    let long = |(axis, period): &(usize, f64)| *period > LONG * travels[*axis].range();
    match effect.shape {
        Shape::Polynomial { axis, .. } | Shape::Table { axis, .. } => Some(axis),
        ref shape => shape.wave_along().filter(long).map(|(axis, _)| axis),
    }
}

/// The axis along which an effect is a wave.
fn wave_along(effect: &Effect) -> Option<usize> {
    matches!(effect.shape, Shape::Cyclic { .. }).then(|| effect.shape.axis()).flatten()
}

/// Whether an effect is a wave along an axis, or in time, which strokes of equal length make one along it.
fn waves(fitted: &Fitted, axis: usize) -> bool {
    wave_along(&fitted.effect) == Some(axis) || matches!(fitted.effect.shape, Shape::Vibration { .. })
}

/// So many smooth terms and waves draw any curve; three may be a fundamental, a harmonic and a slope.
const MANY: usize = 4;
/// One stands out that has more than half of what all of them have.
const STANDS_OUT: f64 = 0.5;

/// Tables of an axis: with nodes at its stations, where it stands at a few; else at equal steps, as long as there is something to fit
/// at every node. A node of which only held-out samples know could have any value.
fn tables(study: &Study<'_>, axis: usize, travel: &Travel) -> Vec<Shape> {
    let nodes = match stations(study, axis, travel) {
        Some(stations) => vec![stations],
        None => {
            let fitted = fitted_places(study, axis);
            let even = NODES.map(|count| even(travel.low, travel.high, count));
            even.into_iter().filter(|nodes| held(nodes, &fitted)).collect()
        }
    };
    nodes.into_iter().map(|nodes| Shape::Table { axis, nodes, directed: false, repeats: false }).collect()
}

/// Nodes at equal steps from one place to another, both included.
pub(crate) fn even(from: f64, to: f64, count: usize) -> Vec<f64> {
    let at = |node: usize| from + (to - from) * crate::number(node) / crate::number(count - 1);
    (0..count).map(at).collect()
}

/// The programmed positions of an axis in the rows that are not held out and in which something was observed, in order.
pub(crate) fn fitted_places(study: &Study<'_>, axis: usize) -> Vec<f64> {
    places(study, axis, |scene| scene.fitted_rows())
}

/// The programmed positions of an axis in those of some rows in which something was observed, in order.
fn places(study: &Study<'_>, axis: usize, rows: impl Fn(&Scene) -> Vec<bool>) -> Vec<f64> {
    let mut places = Vec::new();
    for scene in &study.scenes {
        let of_these = rows(scene);
        let observed = |row: usize| scene.channels.iter().any(|channel| channel.values[row].is_finite());
        let known = scene.given.programmed[axis].iter().enumerate();
        let used = known.filter(|(row, q)| q.is_finite() && of_these[*row] && observed(*row));
        places.extend(used.map(|(_, q)| *q));
    }
    places.sort_by(f64::total_cmp);
    places
}

/// The stations of an axis, where it was observed at a few places.
pub(crate) fn stations(study: &Study<'_>, axis: usize, travel: &Travel) -> Option<Vec<f64>> {
    at_few(&places(study, axis, |scene| vec![true; scene.rows()]), travel)
}

/// These places, where they are few: within a thousandth of the travel a place is the same.
fn at_few(places: &[f64], travel: &Travel) -> Option<Vec<f64>> {
    let mut stations: Vec<f64> = Vec::new();
    for place in places {
        if stations.last().is_none_or(|last| place - last > 1e-3 * travel.range()) {
            stations.push(*place);
        }
        if stations.len() > MOST_STATIONS {
            return None;
        }
    }
    (stations.len() >= FEWEST_STATIONS).then_some(stations)
}

/// The fewest and the most stations that make the nodes of a table.
const FEWEST_STATIONS: usize = 4;
const MOST_STATIONS: usize = 40;

/// Whether one of some places is nearer to every node than to its neighbours.
fn held(nodes: &[f64], places: &[f64]) -> bool {
    let half = nodes.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min) / 2.0;
    nodes.iter().all(|node| {
        let from = places.partition_point(|place| *place < node - half);
        places.get(from).is_some_and(|place| *place <= node + half)
    })
}

#[cfg(test)]
mod tests;
