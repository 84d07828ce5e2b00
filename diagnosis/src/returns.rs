//! What comes back: the part of a residual that some function of a state predicts in units to which it was not fitted.
//!
//! In: the states of a recording, and the residual of a channel. Out, before any term has a name: which states predict it, how
//! much of it, and what they leave. What they leave is the floor: noise is what does not come back. A function of a state is a
//! curve without a model, fitted to all units of that state but one, and asked for the one; it counts where it predicts more than
//! chance does, which is what it predicts of a noise that wanders as the residual does.

mod chance;
mod curve;
mod state;

use crate::channel::ChannelAt;
use crate::course::Course;
use crate::model::Model;
use crate::noise::{self, Noise};
use crate::observations;
use crate::parallel;
use crate::states::States;
use crate::study::Study;
use crate::weights::Outliers;
use chance::Normals;
use curve::{Place, Sums, at};

pub(crate) use state::{Quantity, State};

/// The states of one recording, and the rows to which curves are fitted.
#[derive(Default)]
pub(crate) struct Returns {
    states: Vec<State>,
    rows: Vec<usize>,
    time: Vec<f64>,
    places: Places,
}

/// Which rows lie at the same place, and came there in which unit.
#[derive(Default)]
struct Places {
    /// For each row its place; `None` where that is not known.
    of: Vec<Option<usize>>,
    units: Vec<usize>,
    rows: Vec<Vec<usize>>,
}

/// What a function of a state predicts in other units.
struct Prediction<'s> {
    grid: Grid<'s>,
    curves: Vec<Curve>,
    /// The share of the residual's variance within units that it takes.
    share: f64,
    /// How many other units, in the mean, a row is predicted by.
    others: f64,
}

/// The curve of all units but those of one group.
struct Curve {
    heights: Vec<f64>,
    /// 1 at nodes of which the others say anything, else 0.
    known: Vec<f64>,
}

/// A state that predicts more than chance does, beside those before it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Return {
    /// Its number among the states.
    pub(crate) state: usize,
    /// The share of the residual's variance that all of them up to this one predict, and the root mean square of what they leave.
    pub(crate) share: f64,
    pub(crate) left: f64,
}

/// The most rows that curves are fitted to: enough for a thousand nodes.
const FITTED: usize = 6000;
/// How many nodes a curve may have; the number that predicts best is taken.
const NODES: [usize; 4] = [8, 32, 128, 512];
/// The rows of a unit that a node needs, at least.
const ROWS_OF_A_NODE: usize = 2;
/// The most groups in which units are left out.
const FOLDS: usize = 12;
/// The most states that predict together.
const MOST: usize = 4;
/// How many residuals of mere noise tell what chance predicts.
const DRAWS: u64 = 12;
/// A state predicts more than chance if the logarithm of what it leaves lies this many standard deviations below the mean over the
/// draws of noise. By chance one state in ten thousand does.
const BEYOND: f64 = 4.0;
/// The least share of the rows that other units must say something of.
const COVERED: f64 = 0.2;

impl Returns {
    pub(crate) fn new(study: &Study<'_>, scene: usize, states: &States) -> Self {
        let time = &states.given.time;
        let stride = time.len().div_ceil(FITTED).max(1);
        let rows: Vec<usize> = (0..time.len()).step_by(stride).collect();
        let time = rows.iter().map(|row| time[*row]).collect();
        let states = state::states(study, scene, states);
        let places = Places::new(&states);
        Self { states, rows, time, places }
    }

    /// Whether what other units read at the place of a row lies from it by more than half this distance; also where none came by.
    pub(crate) fn apart(&self, residual: &[f64], row: usize, distance: f64) -> bool {
        let Some(Some(place)) = self.places.of.get(row) else { return true };
        let unit = self.places.units[row];
        let others = self.places.rows[*place].iter().filter(|other| self.places.units[**other] != unit);
        let mut values: Vec<f64> =
            others.map(|other| residual[*other]).filter(|value| value.is_finite()).collect();
        let middle = noise::middle(&mut values);
        middle.is_none_or(|middle| (residual[row] - middle).abs() > 0.5 * distance.abs())
    }

    /// Whether any state comes by in more than one unit.
    pub(crate) fn driven_twice(&self) -> bool {
        !self.states.is_empty()
    }

    /// What a state is a state of.
    pub(crate) fn quantity(&self, one: Return) -> Quantity {
        self.states[one.state].quantity
    }

    /// The states that predict a residual, that of the greatest share first, each beside those before.
    pub(crate) fn of(&self, residual: &[f64], valid: &[bool], noise: Noise) -> Vec<Return> {
        let mut left = residual.to_vec();
        let mut found: Vec<Return> = Vec::new();
        let mut noise = noise;
        let whole = variance(residual, valid);
        while found.len() < MOST {
            let chances = self.chances(valid, &noise);
            let best = self
                .states
                .iter()
                .enumerate()
                .filter(|(number, _)| !found.iter().any(|known| known.state == *number))
                .filter_map(|(number, state)| {
                    let prediction = self.predict(state, &left, valid)?;
                    let (mean, deviation) = chances[number];
                    let beyond = prediction.left() < mean.min(0.0) - BEYOND * deviation;
                    beyond.then_some((number, prediction))
                })
                .max_by(|a, b| a.1.share.total_cmp(&b.1.share));
            let Some((state, prediction)) = best else { break };
            let before = variance(&left, valid);
            prediction.take_from(&mut left);
            let variance = variance(&left, valid);
            // What holds within units only says nothing of the whole.
            if variance >= before {
                break;
            }
            let share = 1.0 - variance / whole.max(f64::MIN_POSITIVE);
            found.push(Return { state, share, left: variance.sqrt() });
            let (rows, kept) = self.thinned(&left, valid);
            noise = noise::estimate(&self.time, &rows, &kept, 0.0).0;
        }
        found
    }

    /// What is left of a residual beside what these states predict, and the factor by which noise is smaller than that: a mean of
    /// few units carries noise of its own.
    pub(crate) fn beside(&self, states: &[Return], residual: &[f64], valid: &[bool]) -> (Vec<f64>, f64) {
        let mut left = residual.to_vec();
        let mut factor = 1.0;
        for one in states {
            let Some(prediction) = self.predict(&self.states[one.state], &left, valid) else { continue };
            let mut less = left.clone();
            prediction.take_from(&mut less);
            if prediction.share > 0.0 && variance(&less, valid) < variance(&left, valid) {
                left = less;
                factor *= (prediction.others / (prediction.others + 1.0)).sqrt();
            }
        }
        (left, factor)
    }

    /// The sum of squares that the best single state takes from a residual in other units; 0 where none takes any.
    pub(crate) fn most(&self, residual: &[f64], valid: &[bool]) -> f64 {
        let whole = variance(residual, valid);
        let taken = |state: &State| {
            let mut left = residual.to_vec();
            self.predict(state, residual, valid)?.take_from(&mut left);
            Some(whole - variance(&left, valid))
        };
        let most = self.states.iter().filter_map(taken).fold(0.0, f64::max);
        most * crate::number(valid.iter().filter(|valid| **valid).count())
    }

    /// The share of a signal in a residual that stays where any single state takes what comes back with it: 1 for what no state
    /// knows of, 0 for what is a function of one.
    pub(crate) fn stays(&self, signal: &[f64], residual: &[f64], valid: &[bool]) -> f64 {
        let product = |a: &[f64], b: &[f64]| -> f64 {
            let rows = a.iter().zip(b).zip(valid).filter(|(_, valid)| **valid);
            rows.map(|((a, b), _)| a * b).sum()
        };
        let whole = product(signal, residual);
        if whole <= 0.0 {
            return 1.0;
        }
        let left = |state: &State| {
            let mut left = residual.to_vec();
            self.predict(state, residual, valid).filter(|known| known.share > 0.0)?.take_from(&mut left);
            Some(product(signal, &left) / whole)
        };
        self.states.iter().filter_map(left).fold(1.0, f64::min)
    }

    fn thinned(&self, residual: &[f64], valid: &[bool]) -> (Vec<f64>, Vec<bool>) {
        self.rows.iter().map(|row| (residual[*row], valid[*row])).unzip()
    }

    /// Mean and standard deviation of the logarithm of what each state leaves of mere noise.
    fn chances(&self, valid: &[bool], noise: &Noise) -> Vec<(f64, f64)> {
        let rows = valid.len();
        let draws: Vec<Vec<f64>> = (0..DRAWS)
            .map(|seed| {
                let drawn = Normals::new(seed).noise(&self.time, noise);
                let mut residual = vec![f64::NAN; rows];
                self.rows.iter().zip(drawn).for_each(|(row, value)| residual[*row] = value);
                residual
            })
            .collect();
        let of = |state: &State| {
            let left: Vec<f64> = draws
                .iter()
                .filter_map(|residual| Some(self.predict(state, residual, valid)?.left()))
                .collect();
            let count = crate::number(left.len().max(1));
            let mean = left.iter().sum::<f64>() / count;
            let squares = left.iter().map(|left| (left - mean).powi(2)).sum::<f64>();
            (mean, (squares / (count - 1.0).max(1.0)).sqrt())
        };
        self.states.iter().map(of).collect()
    }

    /// What a state predicts with the number of nodes that predicts best.
    fn predict<'s>(&'s self, state: &'s State, residual: &[f64], valid: &[bool]) -> Option<Prediction<'s>> {
        let usable: Vec<usize> = self
            .rows
            .iter()
            .copied()
            .filter(|row| valid[*row] && residual[*row].is_finite() && state.values[*row].is_finite())
            .collect();
        let most = usable.len() / state.count / ROWS_OF_A_NODE;
        let counts: Vec<usize> = if state.cells {
            vec![crate::index(state.range.1)? + 1]
        } else {
            NODES.into_iter().filter(|count| *count <= most.max(NODES[0])).collect()
        };
        let centred = centred(state, residual, &usable);
        counts
            .into_iter()
            .filter_map(|count| Grid::new(state, count).predict(&centred, &usable))
            .max_by(|a, b| a.share.total_cmp(&b.share))
    }
}

/// Places along an axis, fine enough for a single station of a screw.
const PLACES: usize = 256;

impl Places {
    /// The places of all axes together where several move, else those of the one that does, by direction.
    fn new(states: &[State]) -> Self {
        let path = states.iter().find(|state| state.quantity == Quantity::Path);
        let branch = || states.iter().find(|state| matches!(state.quantity, Quantity::Branch(_)));
        let Some(state) = path.or_else(branch) else { return Self::default() };
        let grid = Grid::new(state, PLACES);
        let nearest = |(node, share): Place| node + usize::from(share > 0.5);
        let of: Vec<Option<usize>> =
            (0..state.values.len()).map(|row| grid.place(row).map(nearest)).collect();
        let count = of.iter().flatten().max().map_or(0, |most| most + 1);
        let mut rows = vec![Vec::new(); count];
        for (row, place) in of.iter().enumerate() {
            if let Some(place) = place {
                rows[*place].push(row);
            }
        }
        Self { of, units: state.units.clone(), rows }
    }
}

/// A residual with the mean of each unit taken out: what wanders has no zero.
fn centred(state: &State, residual: &[f64], usable: &[usize]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); state.count];
    for row in usable {
        let sum = &mut sums[state.units[*row]];
        *sum = (sum.0 + residual[*row], sum.1 + 1.0);
    }
    let mut centred = residual.to_vec();
    for row in usable {
        let (sum, count) = sums[state.units[*row]];
        centred[*row] -= sum / count;
    }
    centred
}

/// Nodes along a state.
struct Grid<'s> {
    state: &'s State,
    nodes: usize,
    /// How many folds its units are left out in.
    folds: usize,
}

impl<'s> Grid<'s> {
    fn new(state: &'s State, nodes: usize) -> Self {
        Self { state, nodes, folds: state.count.min(FOLDS) }
    }

    fn place(&self, row: usize) -> Option<Place> {
        let value = self.state.values[row];
        let second = self.state.second.as_ref().is_some_and(|second| second[row]);
        let first = if second { self.nodes } else { 0 };
        if self.state.cells {
            return crate::index(value).map(|cell| (cell, 0.0));
        }
        let (low, high) = self.state.range;
        let along = (value - low) / (high - low) * crate::number(self.nodes - 1);
        let node = crate::index(along)?.min(self.nodes - 2);
        Some((first + node, along - crate::number(node)))
    }

    fn size(&self) -> usize {
        if self.state.second.is_some() { 2 * self.nodes } else { self.nodes }
    }

    /// Nodes behind which no curve goes on.
    fn ends(&self) -> Vec<usize> {
        if self.state.cells {
            (0..self.nodes).collect()
        } else if self.state.second.is_some() {
            vec![self.nodes - 1]
        } else {
            Vec::new()
        }
    }

    /// The curves of all groups of units, each fitted to the others; and how many groups came by each node.
    fn curves(&self, residual: &[f64], usable: &[usize]) -> (Vec<Curve>, Vec<f64>) {
        let mut folds = vec![Sums::new(self.size()); self.folds];
        for row in usable {
            if let Some(place) = self.place(*row) {
                folds[self.fold(*row)].add(place, residual[*row]);
            }
        }
        let mut whole = Sums::new(self.size());
        folds.iter().for_each(|sums| whole.plus(sums, 1.0));
        let ends = self.ends();
        let curve = |sums: &Sums| {
            let mut others = whole.clone();
            others.plus(sums, -1.0);
            let known = (0..self.size()).map(|node| if others.seen(node) { 1.0 } else { 0.0 });
            Curve { known: known.collect(), heights: others.solve(&ends) }
        };
        let seen = |node: usize| crate::number(folds.iter().filter(|sums| sums.seen(node)).count());
        (folds.iter().map(curve).collect(), (0..self.size()).map(seen).collect())
    }

    fn fold(&self, row: usize) -> usize {
        self.state.units[row] % self.folds
    }

    fn predict(self, residual: &[f64], usable: &[usize]) -> Option<Prediction<'s>> {
        let (curves, units) = self.curves(residual, usable);
        let mut prediction = Prediction { grid: self, curves, share: 0.0, others: 0.0 };
        let mut by_unit = vec![[0.0; 5]; prediction.grid.state.count];
        let (mut covered, mut others) = (0.0, 0.0);
        for row in usable {
            let Some((value, place)) = prediction.at(*row) else { continue };
            let left = residual[*row] - value;
            let sums = &mut by_unit[prediction.grid.state.units[*row]];
            let parts = [1.0, residual[*row], residual[*row].powi(2), left, left * left];
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
            covered += 1.0;
            others += (at(&units, place) - 1.0).max(1.0);
        }
        if covered < COVERED * crate::number(usable.len()) || covered == 0.0 {
            return None;
        }
        let (mut before, mut after) = (0.0, 0.0);
        for [count, sum, squares, left, left_squares] in by_unit.into_iter().filter(|sums| sums[0] > 0.0) {
            before += squares - sum * sum / count;
            after += left_squares - left * left / count;
        }
        prediction.share = 1.0 - after / f64::max(before, f64::MIN_POSITIVE);
        prediction.others = others / covered;
        Some(prediction)
    }
}

impl Prediction<'_> {
    /// The logarithm of the share of the variance that it leaves: of two units a share has one limit above and none below, and a
    /// mean of it is that of its worst.
    fn left(&self) -> f64 {
        (1.0 - self.share).max(f64::MIN_POSITIVE).ln()
    }

    /// What other units predict in a row, and where on the grid that is.
    fn at(&self, row: usize) -> Option<(f64, Place)> {
        let place = self.grid.place(row)?;
        let Curve { heights, known } = &self.curves[self.grid.fold(row)];
        (at(known, place) > 0.5).then(|| (at(heights, place), place))
    }

    /// Takes it from a residual, wherever other units say anything.
    fn take_from(&self, residual: &mut [f64]) {
        for (row, left) in residual.iter_mut().enumerate() {
            *left -= self.at(row).map_or(0.0, |(value, _)| value);
        }
    }
}

/// The mean square of a residual about its mean.
fn variance(residual: &[f64], valid: &[bool]) -> f64 {
    let known = || residual.iter().zip(valid).filter(|(_, valid)| **valid).map(|(value, _)| *value);
    let count = crate::number(known().count()).max(1.0);
    let mean = known().sum::<f64>() / count;
    known().map(|value| (value - mean).powi(2)).sum::<f64>() / count
}

/// The study in which it is told for each channel which states predict what a model leaves, outliers left out.
pub(crate) fn told<'a>(study: Study<'a>, model: &Model, outliers: &Outliers) -> Study<'a> {
    let of_scene = |scene: usize| {
        let course = Course::new(&study, scene, model);
        let residuals = observations::residuals(&study, scene, model, &course);
        let known = &study.scenes[scene];
        parallel::counted(residuals.len(), known.rows() * residuals.len(), |channel| {
            let residual = &residuals[channel];
            let outliers = outliers.of(ChannelAt { scene, channel });
            let valid: Vec<bool> =
                residual.iter().zip(outliers).map(|(value, out)| value.is_finite() && !out).collect();
            let floor = known.channels[channel].rounding;
            let noise = noise::estimate(&known.recording.time, residual, &valid, floor).0;
            known.returns.of(residual, &valid, noise)
        })
    };
    let returning = (0..study.scenes.len()).map(of_scene).collect();
    study.with_returning(returning)
}

#[cfg(test)]
mod tests;
