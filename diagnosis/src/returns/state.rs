//! States of which a residual may be a function, and the units in which each of them comes back.
//!
//! In: the states of the machine in each row, without any model. Out: for each quantity that was recorded its values, the branch
//! on which it is (forward or backward), and the unit of each row: two legs of the quantity, there and back, within one run.
//! What holds in one unit and not in the others has not come back.

use std::ops::Range;

use crate::states::{AxisStates, States};
use crate::study::Study;

/// What a residual may be a function of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// The position of an axis.
    Position(usize),
    /// Position and direction of motion.
    Branch(usize),
    /// The direction alone.
    Direction(usize),
    /// The way since the last reversal, by direction.
    Way(usize),
    Velocity(usize),
    Acceleration(usize),
    /// The place of all axes together, with the direction of each.
    Path,
    Temperature(usize),
    Load(usize),
}

impl Quantity {
    /// The axis of which it is a state, where it is that of one.
    pub(crate) fn axis(self) -> Option<usize> {
        match self {
            Self::Position(axis)
            | Self::Branch(axis)
            | Self::Direction(axis)
            | Self::Way(axis)
            | Self::Velocity(axis)
            | Self::Acceleration(axis) => Some(axis),
            Self::Path | Self::Temperature(_) | Self::Load(_) => None,
        }
    }

    /// The state's word in reports.
    pub(crate) fn state(self) -> &'static str {
        match self {
            Self::Position(_) | Self::Branch(_) | Self::Path => "position",
            Self::Direction(_) => "direction",
            Self::Way(_) => "reversal",
            Self::Velocity(_) => "velocity",
            Self::Acceleration(_) => "acceleration",
            Self::Temperature(_) => "temperature",
            Self::Load(_) => "load",
        }
    }
}

/// A quantity in every row.
pub(crate) struct State {
    pub(crate) quantity: Quantity,
    /// NaN where it is not known.
    pub(super) values: Vec<f64>,
    /// Whether a row is on the second branch.
    pub(super) second: Option<Vec<bool>>,
    /// The unit of each row.
    pub(super) units: Vec<usize>,
    pub(super) count: usize,
    /// The least and the greatest value.
    pub(super) range: (f64, f64),
    /// Whether values are numbers of cells and not of a scale.
    pub(super) cells: bool,
}

/// A leg ends where a quantity has turned back by this share of its range: less is the rounding, the noise or the regulation of
/// it, and more would join strokes of different length.
const TURNS: f64 = 0.1;

/// All states of a recording that vary and come back.
pub(super) fn states(study: &Study<'_>, scene: usize, states: &States) -> Vec<State> {
    let run = &study.scenes[scene].recording.run;
    let runs: Vec<Range<usize>> =
        study.scenes[scene].recording.runs().into_iter().map(|(rows, _)| rows).collect();
    let mut all = Vec::new();
    for (axis, known) in states.axes.iter().enumerate().filter(|(_, axis)| axis.moves) {
        all.extend(of_axis(axis, known, (run, &runs), &states.given.time));
    }
    all.extend(path(states, run));
    let given = &states.given;
    let slow = |quantity: Quantity, values: &[f64]| {
        let units = units(&legs(values, &runs), values.len());
        state(quantity, values.to_vec(), None, units)
    };
    all.extend(given.temperatures.iter().enumerate().filter_map(|(n, v)| slow(Quantity::Temperature(n), v)));
    all.extend(given.loads.iter().enumerate().filter_map(|(n, v)| slow(Quantity::Load(n), v)));
    all
}

fn of_axis(
    axis: usize,
    known: &AxisStates,
    (run, runs): (&[i64], &[Range<usize>]),
    time: &[f64],
) -> Vec<State> {
    let position = known.position.to_vec();
    let back: Vec<bool> = known.direction.iter().map(|direction| *direction < 0.0).collect();
    let units = units(&legs(&position, runs), position.len());
    let velocity = slopes(&position, time, run);
    let acceleration = known.acceleration.to_vec();
    let ways = ways(&position, &known.direction, run);
    let direction: Vec<f64> = known.direction.iter().map(|direction| (1.0 - direction) / 2.0).collect();
    let mut turned = state(Quantity::Direction(axis), direction, None, units.clone());
    turned.iter_mut().for_each(|state| state.cells = true);
    [
        turned,
        state(Quantity::Position(axis), position.clone(), None, units.clone()),
        state(Quantity::Branch(axis), position, Some(back.clone()), units.clone()),
        state(Quantity::Way(axis), ways, Some(back), units.clone()),
        state(Quantity::Velocity(axis), velocity, None, units.clone()),
        state(Quantity::Acceleration(axis), acceleration, None, units),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn state(
    quantity: Quantity,
    values: Vec<f64>,
    second: Option<Vec<bool>>,
    (units, count): (Vec<usize>, usize),
) -> Option<State> {
    let range = range(&values);
    let varies = range.1 > range.0 && count > 1;
    varies.then_some(State { quantity, values, second, units, count, range, cells: false })
}

/// Speeds from row to row, within runs.
fn slopes(position: &[f64], time: &[f64], run: &[i64]) -> Vec<f64> {
    let last = position.len().saturating_sub(1);
    let slope = |row: usize| {
        let from = if row > 0 && run[row - 1] == run[row] { row - 1 } else { row };
        let to = if row < last && run[row + 1] == run[row] { row + 1 } else { row };
        if time[to] > time[from] { (position[to] - position[from]) / (time[to] - time[from]) } else { 0.0 }
    };
    (0..position.len()).map(slope).collect()
}

/// How far an axis has gone since it turned; since the run began before it has.
fn ways(position: &[f64], direction: &[f64], run: &[i64]) -> Vec<f64> {
    let mut from = f64::NAN;
    let mut ways = Vec::with_capacity(position.len());
    for row in 0..position.len() {
        let new = row == 0 || run[row] != run[row - 1] || direction[row] != direction[row - 1];
        if new || from.is_nan() {
            from = position[row.saturating_sub(usize::from(row > 0 && run[row] == run[row - 1]))];
        }
        ways.push((position[row] - from).abs());
    }
    ways
}

/// Cells along an axis of a path in several axes: fine enough that a smooth function is nearly constant in each, and coarse
/// enough that passes share them.
const CELLS: f64 = 48.0;

/// The place of all axes that move together, where more than one does: cells, and in which visit of its cell a row is.
fn path(states: &States, run: &[i64]) -> Option<State> {
    let moving: Vec<&AxisStates> = states.axes.iter().filter(|axis| axis.moves).collect();
    if moving.len() < 2 {
        return None;
    }
    let ranges: Vec<(f64, f64)> = moving.iter().map(|axis| range(&axis.position)).collect();
    let mut numbers = std::collections::BTreeMap::new();
    let mut visits: Vec<(usize, usize)> = Vec::new();
    let (mut values, mut units, mut count) = (Vec::new(), Vec::new(), 0);
    for row in 0..run.len() {
        let mut key = Vec::with_capacity(2 * moving.len());
        for (axis, (low, high)) in moving.iter().zip(&ranges) {
            let cell = crate::index((axis.position[row] - low) / (high - low) * CELLS);
            key.push(cell.map(|cell| 2 * cell + usize::from(axis.direction[row] < 0.0)));
        }
        if key.iter().any(Option::is_none) {
            values.push(f64::NAN);
            units.push(0);
            continue;
        }
        let next = numbers.len();
        let number = *numbers.entry(key).or_insert(next);
        if number == visits.len() {
            visits.push((0, row));
        }
        let (visit, last) = &mut visits[number];
        *visit += usize::from(row > *last + 1 || (row > *last && run[row] != run[*last]));
        *last = row;
        values.push(crate::number(number));
        units.push(*visit);
        count = count.max(*visit + 1);
    }
    let mut path = state(Quantity::Path, values, None, (units, count))?;
    path.cells = true;
    Some(path)
}

fn range(values: &[f64]) -> (f64, f64) {
    let known = values.iter().copied().filter(|value| value.is_finite());
    known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

/// The legs of a quantity: rows of one run in which it goes one way.
fn legs(values: &[f64], runs: &[Range<usize>]) -> Vec<Range<usize>> {
    let (low, high) = range(values);
    let far = TURNS * (high - low);
    runs.iter().flat_map(|rows| legs_of_run(values, rows.clone(), far)).collect()
}

fn legs_of_run(values: &[f64], rows: Range<usize>, far: f64) -> Vec<Range<usize>> {
    let (mut legs, mut from, mut way) = (Vec::new(), rows.start, 0.0);
    // Where it stood farthest on its way, and from where it set out while no way is known.
    let mut end: Option<(usize, f64)> = None;
    for row in rows.clone().filter(|row| values[*row].is_finite()) {
        let (at, farthest) = *end.get_or_insert((row, values[row]));
        let gone = values[row] - farthest;
        if way == 0.0 && gone.abs() > far {
            way = gone.signum();
        }
        if way != 0.0 && gone * way < -far {
            legs.push(from..at + 1);
            (from, way) = (at + 1, -way);
            end = Some((row, values[row]));
        } else if way != 0.0 && gone * way >= 0.0 {
            end = Some((row, values[row]));
        }
    }
    if from < rows.end {
        legs.push(from..rows.end);
    }
    legs
}

/// The unit of each row: two legs of one run each, there and back, where that leaves more than one unit; else each leg.
fn units(legs: &[Range<usize>], rows: usize) -> (Vec<usize>, usize) {
    let pairs = if legs.len() > 3 { 2 } else { 1 };
    let mut units = vec![0; rows];
    for (number, leg) in legs.iter().enumerate() {
        units[leg.clone()].fill(number / pairs);
    }
    (units, legs.len().div_ceil(pairs))
}
