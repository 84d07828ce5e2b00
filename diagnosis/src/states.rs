//! States: what the machine did in each row of a recording, as far as terms depend on it.
//!
//! In: a recording, the time constants of the position loops that are known so far, and the offset of the instrument's
//! clock. Out: for each axis position, velocity, acceleration, direction and time since the last reversal, behind the loop
//! where the axis has one; and views of stretches of rows.

use std::ops::Range;
use std::sync::Arc;

use crate::noise::typical_step;
use crate::parallel;
use crate::position_loop::{PositionLoop, Stand};
use crate::recording::{AxisChannels, Recording};
use crate::way::{CORNER, Way};

/// A column of one entry a row, held once wherever it is needed: a recording has many rows.
pub(crate) type Shared = Arc<[f64]>;

/// What states start from: what a recording says in each row, under the numbers of the study.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    /// s, from the first row.
    pub(crate) time: Shared,
    /// The typical step of time between rows, s.
    pub(crate) step: f64,
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
            step: typical_step(&recording.time),
            programmed: recording.axes.iter().map(|axis| nominal_position(axis, rows)).collect(),
            temperatures: temperatures.into(),
            loads: loads.into(),
        }
    }
}

/// How an axis is driven.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Driven {
    pub(crate) position_loop: PositionLoop,
    /// What the drive's own feedback shows beyond where the axis is: its zero.
    pub(crate) zero: f64,
    /// How far the drive goes after a reversal until it has crossed its play and takes the axis along, mm or rad; 0: the play
    /// acts at once.
    pub(crate) crossing: f64,
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
    /// At which flank of its play the axis is, from -1 to 1: that of its direction, or on the way there where it crosses.
    pub(crate) flank: Shared,
    /// Its position loop.
    pub(crate) position_loop: PositionLoop,
    /// How the position changes with the time constant of the loop.
    pub(crate) lag_slope: Shared,
    /// How it changes with the inertia of the loop, where that has one.
    pub(crate) inertia_slope: Option<Shared>,
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
    pub(crate) flank: &'s [f64],
    pub(crate) lag_slope: &'s [f64],
    inertia_slope: Option<&'s [f64]>,
}

impl AxisRows<'_> {
    /// How the position changes with the inertia of the loop; 0 for a loop of first order.
    pub(crate) fn inertia_slope(&self) -> Vec<f64> {
        self.inertia_slope.map_or_else(|| vec![0.0; self.position.len()], <[f64]>::to_vec)
    }
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
            flank: &axis.flank[rows.clone()],
            lag_slope: &axis.lag_slope[rows.clone()],
            inertia_slope: axis.inertia_slope.as_ref().map(|slope| &slope[rows]),
        }
    }

    /// The position loop of an axis.
    pub(crate) fn position_loop(&self, axis: usize) -> PositionLoop {
        self.states.axes[axis].position_loop
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
    /// The states of a recording behind these loops, shown by a clock with this offset.
    pub(crate) fn new(recording: &Recording, given: &Given, loops: &[Driven], clock: f64) -> Self {
        let still: Vec<bool> = given.programmed.iter().map(|programmed| stands(programmed)).collect();
        let standing = still.contains(&true).then(|| Standing::new(given.time.len()));
        let axes =
            parallel::counted(loops.len().min(still.len()), given.time.len() * loops.len(), |number| {
                let programmed = &given.programmed[number];
                match standing.as_ref().filter(|_| still[number]) {
                    Some(standing) => standing.at(programmed),
                    None => {
                        let axis = &recording.axes[number];
                        axis_states(given, &recording.run, axis, programmed, loops[number], clock)
                    }
                }
            });
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
            flank: self.forward.clone(),
            position_loop: PositionLoop::default(),
            lag_slope: self.zero.clone(),
            inertia_slope: None,
            clock_slope: self.zero.clone(),
            moves: false,
        }
    }
}

/// The position that stands for an axis, for all to share.
pub(crate) fn nominal_position(axis: &AxisChannels, rows: usize) -> Shared {
    axis.position_or_zero(rows).into()
}

fn axis_states(
    given: &Given,
    run: &[i64],
    axis: &AxisChannels,
    programmed: &Shared,
    driven: Driven,
    clock: f64,
) -> AxisStates {
    let time = &*given.time;
    let resolution = resolution(axis, programmed);
    let way = Way::new(time, programmed);
    let mut states = if driven.position_loop.acts() {
        let start = start(time, axis, &way, driven);
        behind_loop(time, run, &way, driven, start, clock, resolution)
    } else {
        as_programmed(given, run, &way, programmed, clock, resolution)
    };
    if driven.crossing > 0.0 {
        states.flank = flank(&states.position, &states.direction, driven.crossing);
    }
    states
}

/// Where the axis is in its play: it goes from flank to flank while its drive goes as far as the play is wide.
fn flank(position: &[f64], direction: &[f64], crossing: f64) -> Shared {
    let mut play = Play::default();
    position.iter().zip(direction).map(|(q, direction)| play.follow(*q, *direction, crossing)).collect()
}

/// The play operator: where within [-1, 1] something stands that follows a position by 2 dq / width.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Play {
    /// The last position that is known, and where it stood there.
    last: Option<(f64, f64)>,
}

impl Play {
    /// Where it stands at the next position; before anything is known, where the direction leaves it.
    pub(crate) fn follow(&mut self, position: f64, direction: f64, width: f64) -> f64 {
        let stands = match self.last {
            None => direction,
            Some((last, stood)) if position.is_finite() => {
                (stood + 2.0 * (position - last) / width).clamp(-1.0, 1.0)
            }
            Some((_, stood)) => stood,
        };
        if position.is_finite() {
            self.last = Some((position, stands));
        }
        stands
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
    given: &Given,
    run: &[i64],
    way: &Way<'_>,
    programmed: &Shared,
    clock: f64,
    resolution: f64,
) -> AxisStates {
    let time = &*given.time;
    let curve = way.curve(derivative(time, run, programmed));
    let position = if clock == 0.0 { programmed.clone() } else { curve.earlier(clock).into() };
    // A little earlier: what is seen then is the way just before, not the mean of the ways before and after.
    let step = 1e-3 * given.step;
    let mut slope = curve.earlier(clock + step);
    slope.iter_mut().zip(position.iter()).for_each(|(earlier, now)| *earlier = (*earlier - now) / step);
    let slope: Shared = slope.into();
    let acceleration = derivative(time, run, &derivative(time, run, &position)).into();
    let (direction, since_reversal, moves) = directions(time, &position, resolution);
    AxisStates {
        position,
        acceleration,
        flank: direction.clone(),
        direction,
        since_reversal: since_reversal.into(),
        position_loop: PositionLoop::default(),
        lag_slope: slope.clone(),
        inertia_slope: None,
        clock_slope: slope,
        moves,
    }
}

/// The relative step by which the slopes with time constant and inertia are taken.
const LOOP_STEP: f64 = 1e-4;

/// Where an axis stands in the first row, as its drive's own feedback says, where a recording does not begin at rest: it is then
/// further from its command than friction leaves it. The speed is that of the rows within the loop's time.
fn start(time: &[f64], axis: &AxisChannels, way: &Way<'_>, driven: Driven) -> Option<Stand> {
    let actual = axis.actual.as_ref()?;
    let first = *actual.first().filter(|first| first.is_finite())?;
    let early =
        time.iter().zip(actual).take_while(|(at, _)| **at - time[0] <= driven.position_loop.time_constant);
    let (mut moved, mut squares) = (0.0, 0.0);
    for (at, position) in early.filter(|(_, position)| position.is_finite()) {
        moved += (at - time[0]) * (position - first);
        squares += (at - time[0]) * (at - time[0]);
    }
    let velocity = if squares > 0.0 { moved / squares } else { 0.0 };
    let position = first - driven.zero;
    let lag = driven.position_loop.time_constant * way.fastest();
    ((position - way.first()).abs() > AWAY * lag).then_some(Stand { position, velocity })
}

/// The share of the lag at the highest speed beyond which an axis does not begin at rest.
const AWAY: f64 = 0.05;

fn behind_loop(
    time: &[f64],
    run: &[i64],
    way: &Way<'_>,
    driven: Driven,
    start: Option<Stand>,
    clock: f64,
    resolution: f64,
) -> AxisStates {
    let stands = way.behind_loop(driven.position_loop, start, clock);
    let slope = |changed: PositionLoop, change: f64| -> Shared {
        let changed = way.behind_loop(changed, start, clock);
        changed.iter().zip(&stands).map(|(far, near)| (far.position - near.position) / change).collect()
    };
    let PositionLoop { time_constant, inertia } = driven.position_loop;
    let slower = time_constant * LOOP_STEP;
    let lag_slope = slope(PositionLoop { time_constant: time_constant + slower, inertia }, slower);
    let heavier = inertia * LOOP_STEP;
    let inertia_slope =
        (inertia > 0.0).then(|| slope(PositionLoop { time_constant, inertia: inertia + heavier }, heavier));
    let velocity: Vec<f64> = stands.iter().map(|stand| stand.velocity).collect();
    let position: Shared = stands.iter().map(|stand| stand.position).collect();
    let acceleration = derivative(time, run, &velocity);
    let (direction, since_reversal, moves) = directions(time, &position, resolution);
    AxisStates {
        position,
        acceleration: acceleration.into(),
        flank: direction.clone(),
        direction,
        since_reversal: since_reversal.into(),
        position_loop: driven.position_loop,
        lag_slope,
        inertia_slope,
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
fn directions(time: &[f64], position: &[f64], resolution: f64) -> (Shared, Vec<f64>, bool) {
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
    (directions.into(), since, moved)
}

#[cfg(test)]
mod tests;

/// Rows in which it is not known from which side an axis came to its place: it stands where it stood in the row before, and leaves
/// the other way than it came. The cycle of ISO 230-2 goes beyond its last target and comes back in between; a path without an
/// overrun does not.
pub(crate) fn unseen_turns(position: &[f64]) -> Vec<bool> {
    let known = || position.iter().copied().filter(|position| position.is_finite());
    let range = known().fold(f64::NEG_INFINITY, f64::max) - known().fold(f64::INFINITY, f64::min);
    let mut unseen = vec![false; position.len()];
    let mut came = 0.0;
    let mut first = 0;
    for row in 1..position.len() {
        let step = position[row] - position[row - 1];
        // A missing position is no step: nothing is known of it. A millionth of the travel is rounding.
        if step.is_nan() || step.abs() <= 1e-6 * range {
            continue;
        }
        if came * step < 0.0 {
            unseen[first + 1..row].fill(true);
        }
        (came, first) = (step, row);
    }
    unseen
}

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
