//! States: what the machine did in each row of a recording, as far as terms depend on it.
//!
//! In: a recording, the time constants of the position loops that are known so far, and the offset of the instrument's
//! clock. Out: for each axis position, velocity, acceleration, direction and time since the last reversal, behind the loop
//! where the axis has one; and views of stretches of rows.

use std::ops::Range;
use std::sync::Arc;

use crate::noise::typical_step;
use crate::recording::{AxisChannels, Recording};
use crate::way::{CORNER, Way};

/// A column of one entry a row, held once wherever it is needed: a recording has many rows.
pub(crate) type Shared = Arc<[f64]>;

/// What states start from: what a recording says in each row, under the numbers of the study.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    /// s, from the first row.
    pub(crate) time: Shared,
    /// The programmed position of each axis.
    pub(crate) programmed: Arc<[Shared]>,
    /// By the sensors of the study; NaN where the recording lacks one.
    pub(crate) temperatures: Arc<[Vec<f64>]>,
    pub(crate) loads: Arc<[Vec<f64>]>,
}

impl Given {
    /// What a recording says, with sensors and loads in the study's order.
    pub(crate) fn new(recording: &Recording, temperatures: Vec<Vec<f64>>, loads: Vec<Vec<f64>>) -> Self {
        let rows = recording.time.len();
        Self {
            time: recording.time.as_slice().into(),
            programmed: recording.axes.iter().map(|axis| nominal_position(axis, rows)).collect(),
            temperatures: temperatures.into(),
            loads: loads.into(),
        }
    }
}

/// The states of all rows of one recording.
#[derive(Clone, Debug)]
pub(crate) struct States {
    pub(crate) given: Given,
    pub(crate) axes: Vec<AxisStates>,
}

/// The states of one axis, one entry a row: mm or rad, and s.
#[derive(Clone, Debug, Default)]
pub(crate) struct AxisStates {
    pub(crate) position: Shared,
    pub(crate) acceleration: Shared,
    /// +1 or -1: that of the last real motion; +1 before the first.
    pub(crate) direction: Shared,
    /// Infinite before the first reversal.
    pub(crate) since_reversal: Shared,
    /// How the position changes with the time constant of the loop.
    pub(crate) lag_slope: Shared,
    /// How the position changes with the offset of the instrument's clock.
    pub(crate) clock_slope: Shared,
    /// Whether the axis moves at all.
    pub(crate) moves: bool,
}

/// The columns of an axis that stands, the same for each of them.
struct Standing {
    zero: Shared,
    forward: Shared,
    never: Shared,
}

/// The states in a stretch of rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows<'s> {
    states: &'s States,
    first: usize,
    end: usize,
    pub(crate) time: &'s [f64],
}

/// The states of one axis in a stretch of rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AxisRows<'s> {
    pub(crate) position: &'s [f64],
    pub(crate) acceleration: &'s [f64],
    pub(crate) direction: &'s [f64],
    pub(crate) since_reversal: &'s [f64],
    pub(crate) lag_slope: &'s [f64],
}

impl<'s> Rows<'s> {
    /// How many rows there are.
    pub(crate) fn len(&self) -> usize {
        self.end - self.first
    }

    /// An axis by number.
    pub(crate) fn axis(&self, number: usize) -> AxisRows<'s> {
        let axis = &self.states.axes[number];
        let rows = self.first..self.end;
        AxisRows {
            position: &axis.position[rows.clone()],
            acceleration: &axis.acceleration[rows.clone()],
            direction: &axis.direction[rows.clone()],
            since_reversal: &axis.since_reversal[rows.clone()],
            lag_slope: &axis.lag_slope[rows],
        }
    }

    /// A sensor by number, degC.
    pub(crate) fn temperature(&self, number: usize) -> &'s [f64] {
        &self.states.given.temperatures[number][self.first..self.end]
    }

    /// A load by number.
    pub(crate) fn load(&self, number: usize) -> &'s [f64] {
        &self.states.given.loads[number][self.first..self.end]
    }
}

impl States {
    /// The states of a recording behind loops of these time constants, shown by a clock with this offset.
    pub(crate) fn new(recording: &Recording, given: &Given, lags: &[f64], clock: f64) -> Self {
        let mut standing: Option<Standing> = None;
        let mut axes = Vec::with_capacity(lags.len());
        for ((axis, programmed), lag) in recording.axes.iter().zip(given.programmed.iter()).zip(lags) {
            axes.push(if stands(programmed) {
                standing.get_or_insert_with(|| Standing::new(programmed.len())).at(programmed)
            } else {
                axis_states(&given.time, &recording.run, axis, programmed, *lag, clock)
            });
        }
        Self { given: given.clone(), axes }
    }

    /// The states in a stretch of rows.
    pub(crate) fn rows(&self, rows: Range<usize>) -> Rows<'_> {
        Rows { states: self, first: rows.start, end: rows.end, time: &self.given.time[rows] }
    }
}

/// Whether an axis is at one place in every row.
fn stands(programmed: &[f64]) -> bool {
    programmed.first().is_some_and(|first| first.is_finite() && programmed.iter().all(|q| q == first))
}

impl Standing {
    fn new(rows: usize) -> Self {
        let all = |value: f64| vec![value; rows].into();
        Self { zero: all(0.0), forward: all(1.0), never: all(f64::INFINITY) }
    }

    fn at(&self, position: &Shared) -> AxisStates {
        AxisStates {
            position: position.clone(),
            acceleration: self.zero.clone(),
            direction: self.forward.clone(),
            since_reversal: self.never.clone(),
            lag_slope: self.zero.clone(),
            clock_slope: self.zero.clone(),
            moves: false,
        }
    }
}

/// The position that stands for an axis: programmed, or the drive's where nothing was programmed; 0 where neither is known.
pub(crate) fn nominal_position(axis: &AxisChannels, rows: usize) -> Shared {
    let known = axis.command.as_ref().or(axis.actual.as_ref()).or(axis.measured.as_ref());
    known.map_or_else(|| vec![0.0; rows].into(), |known| known.as_slice().into())
}

fn axis_states(
    time: &[f64],
    run: &[i64],
    axis: &AxisChannels,
    programmed: &Shared,
    lag: f64,
    clock: f64,
) -> AxisStates {
    let resolution = resolution(axis, programmed);
    let way = Way::new(time, programmed, derivative(time, run, programmed));
    if lag > 0.0 {
        behind_loop(time, run, &way, lag, clock, resolution)
    } else {
        as_programmed(time, run, &way, programmed, clock, resolution)
    }
}

/// How far an axis must turn back before it has really turned: nothing but rounding for a programmed position; more for a
/// measured one, whose noise would turn it in every row.
fn resolution(axis: &AxisChannels, positions: &[f64]) -> f64 {
    let finite = positions.iter().filter(|position| position.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), position| {
        (low.min(*position), high.max(*position))
    });
    let range = (high - low).max(0.0);
    if axis.command.is_some() { 1e-9 * range } else { 1e-3 * range }
}

/// Without a loop. A quick loop stays behind by its time constant times the speed on the way to a row, as a late clock does.
fn as_programmed(
    time: &[f64],
    run: &[i64],
    way: &Way<'_>,
    programmed: &Shared,
    clock: f64,
    resolution: f64,
) -> AxisStates {
    let position = if clock == 0.0 { programmed.clone() } else { way.earlier(clock).into() };
    // A little earlier: what is seen then is the way just before, not the mean of the ways before and after.
    let step = 1e-3 * typical_step(time);
    let mut slope = way.earlier(clock + step);
    slope.iter_mut().zip(position.iter()).for_each(|(earlier, now)| *earlier = (*earlier - now) / step);
    let slope: Shared = slope.into();
    let acceleration = derivative(time, run, &derivative(time, run, &position)).into();
    let (direction, since_reversal, moves) = directions(time, &position, resolution);
    AxisStates {
        position,
        acceleration,
        direction: direction.into(),
        since_reversal: since_reversal.into(),
        lag_slope: slope.clone(),
        clock_slope: slope,
        moves,
    }
}

/// The relative step by which the slope with the time constant is taken.
const LAG_STEP: f64 = 1e-4;

fn behind_loop(
    time: &[f64],
    run: &[i64],
    way: &Way<'_>,
    lag: f64,
    clock: f64,
    resolution: f64,
) -> AxisStates {
    let (position, command) = way.behind_loop(lag, clock);
    let (mut lag_slope, _) = way.behind_loop(lag * (1.0 + LAG_STEP), clock);
    lag_slope.iter_mut().zip(&position).for_each(|(far, near)| *far = (*far - near) / (lag * LAG_STEP));
    let mut velocity = command;
    velocity.iter_mut().zip(&position).for_each(|(command, q)| *command = (*command - q) / lag);
    let acceleration = derivative(time, run, &velocity);
    let (direction, since_reversal, moves) = directions(time, &position, resolution);
    AxisStates {
        position: position.into(),
        acceleration: acceleration.into(),
        direction: direction.into(),
        since_reversal: since_reversal.into(),
        lag_slope: lag_slope.into(),
        clock_slope: velocity.iter().map(|velocity| -velocity).collect(),
        moves,
    }
}

/// The derivative in time by the parabola through each sample and its neighbours in the same run; NaN samples are passed over.
fn derivative(time: &[f64], run: &[i64], values: &[f64]) -> Vec<f64> {
    let known: Vec<usize> = (0..values.len()).filter(|row| values[*row].is_finite()).collect();
    let slope = |from: usize, to: usize| (values[to] - values[from]) / (time[to] - time[from]);
    let mut result = vec![f64::NAN; values.len()];
    for (place, row) in known.iter().enumerate() {
        let same_run = |other: &usize| run[*other] == run[*row];
        let before = place.checked_sub(1).map(|place| known[place]).filter(same_run);
        let after = known.get(place + 1).copied().filter(same_run);
        result[*row] = match (before, after) {
            (Some(before), Some(after)) => {
                let (left, right) = (time[*row] - time[before], time[after] - time[*row]);
                (slope(before, *row) * right + slope(*row, after) * left) / (left + right)
            }
            (Some(before), None) => slope(before, *row),
            (None, Some(after)) => slope(*row, after),
            (None, None) => 0.0,
        };
    }
    result
}

/// Direction of the last real motion, time since the last reversal, and whether there is any motion.
fn directions(time: &[f64], position: &[f64], resolution: f64) -> (Vec<f64>, Vec<f64>, bool) {
    let mut direction = 1.0;
    let mut moved = false;
    let mut reversed = f64::NEG_INFINITY;
    let mut extreme: Option<f64> = None;
    let mut directions = Vec::with_capacity(position.len());
    let mut since = Vec::with_capacity(position.len());
    for (time, position) in time.iter().zip(position) {
        if position.is_finite() {
            let from = *extreme.get_or_insert(*position);
            let gone = position - from;
            if gone.abs() > resolution && (!moved || gone * direction < 0.0) {
                if moved {
                    reversed = *time;
                }
                direction = gone.signum();
                moved = true;
            }
            if gone * direction > 0.0 {
                extreme = Some(*position);
            }
        }
        directions.push(direction);
        since.push(time - reversed);
    }
    (directions, since, moved)
}

#[cfg(test)]
mod tests;

/// Rows behind a corner of the path that lies between two rows: where the axis was on the way is not recorded, so that no
/// loop and no clock can be judged by them.
pub(crate) fn behind_corners(time: &[f64], run: &[i64], position: &[f64]) -> Vec<bool> {
    let slope = |row: usize| (position[row] - position[row - 1]) / (time[row] - time[row - 1]);
    let fastest = (1..time.len())
        .filter(|row| run[*row] == run[row - 1])
        .map(|row| slope(row).abs())
        .filter(|slope| slope.is_finite())
        .fold(0.0, f64::max);
    (0..time.len())
        .map(|row| {
            let inside = row >= 2 && row + 1 < time.len() && run[row - 2] == run[row + 1];
            let (before, here, after) =
                if inside { (slope(row - 1), slope(row), slope(row + 1)) } else { return false };
            let mixed = (here - before).abs().min((after - here).abs()) > MIXED * fastest;
            mixed && (after - before).abs() > CORNER * fastest
        })
        .collect()
}

/// The least share of the highest speed by which the speed changes before and behind such a row.
const MIXED: f64 = 0.02;
