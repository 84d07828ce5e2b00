//! States: what the machine did in each row of a recording, as far as terms depend on it.
//!
//! In: a recording, the time constants of the position loops that are known so far, and the offset of the instrument's
//! clock. Out: for each axis position, velocity, acceleration, direction and time since the last reversal, behind the loop
//! where the axis has one; and views of stretches of rows.

use std::ops::Range;

use crate::noise::typical_step;
use crate::recording::{AxisChannels, Recording};
use crate::way::{CORNER, Way};

/// The states of all rows of one recording.
#[derive(Clone, Debug)]
pub(crate) struct States {
    pub(crate) time: Vec<f64>,
    pub(crate) axes: Vec<AxisStates>,
    /// By the sensors of the study; NaN where this recording lacks one.
    pub(crate) temperatures: Vec<Vec<f64>>,
    pub(crate) loads: Vec<Vec<f64>>,
}

/// The states of one axis, one entry a row: mm or rad, and s.
#[derive(Clone, Debug, Default)]
pub(crate) struct AxisStates {
    pub(crate) position: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
    /// +1 or -1: that of the last real motion; +1 before the first.
    pub(crate) direction: Vec<f64>,
    /// Infinite before the first reversal.
    pub(crate) since_reversal: Vec<f64>,
    /// How the position changes with the time constant of the loop.
    pub(crate) lag_slope: Vec<f64>,
    /// How the position changes with the offset of the instrument's clock.
    pub(crate) clock_slope: Vec<f64>,
    /// Whether the axis moves at all.
    pub(crate) moves: bool,
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
        &self.states.temperatures[number][self.first..self.end]
    }

    /// A load by number.
    pub(crate) fn load(&self, number: usize) -> &'s [f64] {
        &self.states.loads[number][self.first..self.end]
    }
}

impl States {
    /// The states of a recording whose temperatures and loads are given by the numbers of the study.
    pub(crate) fn new(
        recording: &Recording,
        temperatures: Vec<Vec<f64>>,
        loads: Vec<Vec<f64>>,
        lags: &[f64],
        clock: f64,
    ) -> Self {
        let time = recording.time.clone();
        let axes = recording.axes.iter().zip(lags);
        let axes = axes.map(|(axis, lag)| axis_states(&time, &recording.run, axis, *lag, clock)).collect();
        Self { time, axes, temperatures, loads }
    }

    /// The states in a stretch of rows.
    pub(crate) fn rows(&self, rows: Range<usize>) -> Rows<'_> {
        Rows { states: self, first: rows.start, end: rows.end, time: &self.time[rows] }
    }
}

/// The position that stands for an axis: programmed, or the drive's where nothing was programmed; 0 where neither is known.
pub(crate) fn nominal_position(axis: &AxisChannels, rows: usize) -> Vec<f64> {
    axis.command
        .as_ref()
        .or(axis.actual.as_ref())
        .or(axis.measured.as_ref())
        .cloned()
        .unwrap_or(vec![0.0; rows])
}

fn axis_states(time: &[f64], run: &[i64], axis: &AxisChannels, lag: f64, clock: f64) -> AxisStates {
    let programmed = nominal_position(axis, time.len());
    let resolution = resolution(axis, &programmed);
    let way = Way::new(time, &programmed, derivative(time, run, &programmed));
    if lag > 0.0 {
        behind_loop(time, run, &way, lag, clock, resolution)
    } else {
        as_programmed(time, run, &way, clock, resolution)
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
fn as_programmed(time: &[f64], run: &[i64], way: &Way<'_>, clock: f64, resolution: f64) -> AxisStates {
    let position = way.earlier(clock);
    // A little earlier: what is seen then is the way just before, not the mean of the ways before and after.
    let step = 1e-3 * typical_step(time);
    let clock_slope: Vec<f64> = way
        .earlier(clock + step)
        .iter()
        .zip(&position)
        .map(|(earlier, now)| (earlier - now) / step)
        .collect();
    let acceleration = derivative(time, run, &derivative(time, run, &position));
    let (direction, since_reversal, moves) = directions(time, &position, resolution);
    let lag_slope = clock_slope.clone();
    AxisStates { position, acceleration, direction, since_reversal, lag_slope, clock_slope, moves }
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
    let (further, _) = way.behind_loop(lag * (1.0 + LAG_STEP), clock);
    let lag_slope =
        further.iter().zip(&position).map(|(far, near)| (far - near) / (lag * LAG_STEP)).collect();
    let velocity: Vec<f64> = command.iter().zip(&position).map(|(command, q)| (command - q) / lag).collect();
    let acceleration = derivative(time, run, &velocity);
    let clock_slope = velocity.iter().map(|velocity| -velocity).collect();
    let (direction, since_reversal, moves) = directions(time, &position, resolution);
    AxisStates { position, acceleration, direction, since_reversal, lag_slope, clock_slope, moves }
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
