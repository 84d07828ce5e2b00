//! States: what the machine did in each row of a recording, as far as terms depend on it.
//!
//! In: a recording, the time constants of the position loops that are known so far, and the offset of the instrument's
//! clock. Out: for each axis position, velocity, acceleration, direction and time since the last reversal, behind the loop
//! where the axis has one; and views of stretches of rows.

mod beginning;
mod corners;
mod motion;
mod plays;

use std::ops::Range;
use std::sync::Arc;

use crate::legs::{legs, stretches};
use crate::noise::typical_step;
use crate::parallel;
use crate::position_loop::{PositionLoop, Start};
use crate::recording::{AxisChannels, Recording};
use crate::rounded::unrounded;
use crate::way::Way;
use beginning::beginning;
use motion::Motion;
use plays::followed;

pub(crate) use corners::{behind_corners, beside_reversals, unseen_turns};
pub(crate) use plays::{Crossing, Play};

/// A column of one entry a row, held once wherever it is needed: a recording has many rows.
pub(crate) type Shared = Arc<[f64]>;

/// What states start from: what a recording says in each row, under the numbers of the study.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    /// s, from the first row.
    pub(crate) time: Shared,
    /// The typical step of time between rows, s.
    pub(crate) step: f64,
    /// The number of the leg of each row: from leg to leg nothing is driven.
    pub(crate) legs: Arc<[usize]>,
    /// The programmed position of each axis; the way that was rounded to it, where it was.
    pub(crate) programmed: Arc<[Shared]>,
    /// The step to which the command of each axis was rounded; 0 where nothing speaks for that.
    pub(crate) rounded: Arc<[f64]>,
    /// By the sensors of the study; NaN where the recording lacks one.
    pub(crate) temperatures: Arc<[Vec<f64>]>,
    pub(crate) loads: Arc<[Vec<f64>]>,
}

impl Given {
    /// What a recording says, with sensors and loads in the study's order.
    pub(crate) fn new(recording: &Recording, temperatures: Vec<Vec<f64>>, loads: Vec<Vec<f64>>) -> Self {
        let rows = recording.time.len();
        let mut programmed: Vec<Shared> =
            recording.axes.iter().map(|axis| nominal_position(axis, rows)).collect();
        let legs: Arc<[usize]> = legs(&recording.time, &recording.run, &programmed).into();
        let mut rounded = vec![0.0; programmed.len()];
        for (axis, step) in rounded.iter_mut().enumerate() {
            let command = recording.axes[axis].command.as_deref();
            if let Some(found) =
                command.and_then(|command| unrounded(&recording.time, command, stretches(&legs)))
            {
                programmed[axis] = found.way.into();
                *step = found.step;
            }
        }
        Self {
            time: recording.time.as_slice().into(),
            step: typical_step(&recording.time),
            legs,
            programmed: programmed.into(),
            rounded: rounded.into(),
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
    pub(crate) crossing: Crossing,
    /// Whether its command bends between rows.
    pub(crate) bends: bool,
    /// Whether it moves already where a leg begins.
    pub(crate) underway: bool,
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
    pub(crate) velocity: Shared,
    pub(crate) acceleration: Shared,
    /// +1 or -1: that of the last real motion; +1 before the first. A leg that begins where none ended begins with the direction
    /// of its own first motion.
    pub(crate) direction: Shared,
    /// Whether the axis begins a leg elsewhere than where it ended the last one; empty where it never does.
    pub(crate) displaced: Arc<[bool]>,
    /// Infinite before the first reversal since it was displaced.
    pub(crate) since_reversal: Shared,
    /// At which flank of its play the axis is, from -1 to 1: that of its direction, or on the way there where it crosses.
    pub(crate) flank: Shared,
    /// Which way it jumped last where a jump does not come from a play behind the drive: its direction, or that which it had until it
    /// has gone back so far.
    pub(crate) jumped: Shared,
    /// Its position loop.
    pub(crate) position_loop: PositionLoop,
    /// How the position changes with the time constant of the loop.
    pub(crate) lag_slope: Shared,
    /// How it changes with the inertia of the loop, where that has one.
    pub(crate) inertia_slope: Option<Shared>,
    /// Whether it is not known where the axis is, because it began underway a moment ago; empty where it never does.
    pub(crate) unsettled: Vec<bool>,
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
    pub(crate) velocity: &'s [f64],
    pub(crate) acceleration: &'s [f64],
    pub(crate) direction: &'s [f64],
    /// Empty where the axis is displaced in none of them.
    displaced: &'s [bool],
    pub(crate) since_reversal: &'s [f64],
    pub(crate) flank: &'s [f64],
    pub(crate) jumped: &'s [f64],
    pub(crate) lag_slope: &'s [f64],
    inertia_slope: Option<&'s [f64]>,
}

impl AxisRows<'_> {
    /// Where a play of this width stands in each row, from -1 to 1: it follows the position, and begins anew where the axis was
    /// displaced.
    pub(crate) fn followed(&self, play: &mut Play, width: f64) -> Vec<f64> {
        followed(self.position, self.direction, self.displaced, play, width)
    }

    /// How the position changes with the inertia of the loop; 0 for a first-order loop.
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
            velocity: &axis.velocity[rows.clone()],
            acceleration: &axis.acceleration[rows.clone()],
            direction: &axis.direction[rows.clone()],
            displaced: axis.displaced.get(rows.clone()).unwrap_or_default(),
            since_reversal: &axis.since_reversal[rows.clone()],
            flank: &axis.flank[rows.clone()],
            jumped: &axis.jumped[rows.clone()],
            lag_slope: &axis.lag_slope[rows.clone()],
            inertia_slope: axis.inertia_slope.as_ref().map(|slope| &slope[rows]),
        }
    }

    /// Whether a leg begins in a row, counted from the first of the stretch.
    pub(crate) fn begins(&self, row: usize) -> bool {
        let (legs, row) = (&self.states.given.legs, self.first + row);
        row > 0 && legs[row] != legs[row - 1]
    }

    /// Where an axis was a time before each row: between two rows on the arc on which it is accelerated; before its leg where that begins,
    /// and behind it where it ends.
    pub(crate) fn earlier(&self, axis: usize, time: f64) -> Vec<f64> {
        let (given, position) = (&self.states.given, &self.states.axes[axis].position);
        let mut leg = 0..0;
        let earlier = |row: usize| {
            if !leg.contains(&row) {
                leg = leg_of(&given.legs, row);
            }
            let (times, places) = (&given.time[leg.clone()], &position[leg.clone()]);
            let wanted = given.time[row] - time;
            let after = times.partition_point(|known| *known <= wanted);
            if after == 0 || after == times.len() {
                return places[after.saturating_sub(1)];
            }
            let step = times[after] - times[after - 1];
            let share = (wanted - times[after - 1]) / step;
            let sagging =
                0.5 * steady_acceleration(times, places, after) * step * step * share * (1.0 - share);
            places[after - 1] + share * (places[after] - places[after - 1]) - sagging
        };
        (self.first..self.end).map(earlier).collect()
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

/// The acceleration between a row and the one before it: the smaller of those at both rows, and none where they differ in sign. On an arc
/// the two are alike; at a corner of the path one of them is no acceleration.
fn steady_acceleration(times: &[f64], places: &[f64], row: usize) -> f64 {
    let at = |row: usize| {
        let slope = |row: usize| (places[row] - places[row - 1]) / (times[row] - times[row - 1]);
        2.0 * (slope(row + 1) - slope(row)) / (times[row + 1] - times[row - 1])
    };
    if row < 2 || row + 1 >= times.len() {
        return 0.0;
    }
    let (before, behind) = (at(row - 1), at(row));
    if before * behind > 0.0 { before.signum() * before.abs().min(behind.abs()) } else { 0.0 }
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
                        // What is no more than rounding is no motion.
                        let resolution = resolution(axis, programmed).max(given.rounded[number]);
                        axis_states(given, axis, programmed, loops[number], (clock, resolution))
                    }
                }
            });
        Self { given: given.clone(), axes }
    }

    /// Whether it is not known in a row where an axis is, because it began underway a moment ago.
    pub(crate) fn is_unsettled(&self, row: usize) -> bool {
        self.axes.iter().any(|axis| axis.unsettled.get(row) == Some(&true))
    }

    /// The states in a stretch of rows.
    pub(crate) fn rows(&self, rows: Range<usize>) -> Rows<'_> {
        Rows { states: self, first: rows.start, end: rows.end, time: &self.given.time[rows] }
    }
}

/// The rows of the leg that a row belongs to. The numbers of legs rise.
fn leg_of(legs: &[usize], row: usize) -> Range<usize> {
    let leg = legs[row];
    legs.partition_point(|other| *other < leg)..legs.partition_point(|other| *other <= leg)
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
            velocity: self.zero.clone(),
            acceleration: self.zero.clone(),
            direction: self.forward.clone(),
            displaced: Arc::default(),
            since_reversal: self.never.clone(),
            flank: self.forward.clone(),
            jumped: self.forward.clone(),
            position_loop: PositionLoop::default(),
            lag_slope: self.zero.clone(),
            inertia_slope: None,
            unsettled: Vec::new(),
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
    axis: &AxisChannels,
    programmed: &Shared,
    driven: Driven,
    (clock, resolution): (f64, f64),
) -> AxisStates {
    let way = Way::new(&given.time, programmed, &given.legs);
    let mut states = if driven.position_loop.acts() {
        let way = if driven.bends { way.bending() } else { way };
        let starts: Vec<Start> =
            way.stretches().map(|rows| beginning(&given.time, axis, &way, driven, rows)).collect();
        behind_loop(given, &way, driven, &starts, clock, resolution)
    } else if driven.position_loop.leads() {
        ahead(given, programmed, driven.position_loop, clock, resolution)
    } else {
        as_programmed(given, &way, programmed, clock, resolution)
    };
    plays::cross(given, programmed, driven.crossing, resolution, &mut states);
    states
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
    way: &Way<'_>,
    programmed: &Shared,
    clock: f64,
    resolution: f64,
) -> AxisStates {
    let (time, legs) = (&*given.time, &*given.legs);
    let curve = way.curve(derivative(time, legs, programmed));
    let position = if clock == 0.0 { programmed.clone() } else { curve.earlier(clock).into() };
    // A little earlier: what is seen then is the way just before, not the mean of the ways before and after.
    let step = 1e-3 * given.step;
    let mut slope = curve.earlier(clock + step);
    slope.iter_mut().zip(position.iter()).for_each(|(earlier, now)| *earlier = (*earlier - now) / step);
    let slope: Shared = slope.into();
    let velocity: Shared = derivative(time, legs, &position).into();
    let acceleration = derivative(time, legs, &velocity).into();
    let Motion { direction, displaced, since_reversal, moves } =
        Motion::of(time, legs, way.command(), &position, resolution);
    AxisStates {
        position,
        velocity,
        acceleration,
        flank: direction.clone(),
        jumped: direction.clone(),
        direction,
        displaced,
        since_reversal,
        position_loop: PositionLoop::default(),
        lag_slope: slope.clone(),
        inertia_slope: None,
        unsettled: Vec::new(),
        clock_slope: slope,
        moves,
    }
}

/// Of a drive that leads: by its time constant times the velocity of the way at the rows.
fn ahead(
    given: &Given,
    programmed: &Shared,
    position_loop: PositionLoop,
    clock: f64,
    resolution: f64,
) -> AxisStates {
    let (time, legs) = (&*given.time, &*given.legs);
    let velocity = derivative(time, legs, programmed);
    let led = programmed.iter().zip(&velocity).map(|(q, v)| q - position_loop.time_constant * v);
    let led: Shared = led.collect();
    let states = as_programmed(given, &Way::new(time, &led, legs), &led, clock, resolution);
    let speeds = Way::new(time, &velocity, legs);
    let shown = speeds.curve(derivative(time, legs, &velocity)).earlier(clock);
    AxisStates { position_loop, lag_slope: shown.iter().map(|velocity| -velocity).collect(), ..states }
}

/// The relative step by which the slopes with time constant and inertia are taken.
const LOOP_STEP: f64 = 1e-4;

fn behind_loop(
    given: &Given,
    way: &Way<'_>,
    driven: Driven,
    starts: &[Start],
    clock: f64,
    resolution: f64,
) -> AxisStates {
    let stands = way.behind_loop(driven.position_loop, starts, clock);
    let slope = |changed: PositionLoop, change: f64| -> Shared {
        let changed = way.behind_loop(changed, starts, clock);
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
    let acceleration = derivative(&given.time, &given.legs, &velocity);
    let Motion { direction, displaced, since_reversal, moves } =
        Motion::of(&given.time, &given.legs, way.command(), &position, resolution);
    AxisStates {
        position,
        clock_slope: velocity.iter().map(|velocity| -velocity).collect(),
        velocity: velocity.into(),
        acceleration: acceleration.into(),
        flank: direction.clone(),
        jumped: direction.clone(),
        direction,
        displaced,
        since_reversal,
        position_loop: driven.position_loop,
        lag_slope,
        inertia_slope,
        unsettled: beginning::unsettled(given, way, starts, driven.position_loop.settling()),
        moves,
    }
}

/// The derivative in time by the parabola through each sample and its neighbours in the same leg; NaN samples are passed over.
fn derivative(time: &[f64], legs: &[usize], values: &[f64]) -> Vec<f64> {
    let known: Vec<usize> = (0..values.len()).filter(|row| values[*row].is_finite()).collect();
    let slope = |from: usize, to: usize| (values[to] - values[from]) / (time[to] - time[from]);
    let mut result = vec![f64::NAN; values.len()];
    for (place, row) in known.iter().enumerate() {
        let same_leg = |other: &usize| legs[*other] == legs[*row];
        let before = place.checked_sub(1).map(|place| known[place]).filter(same_leg);
        let after = known.get(place + 1).copied().filter(same_leg);
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

#[cfg(test)]
mod tests;
