//! Targets: commands that name the end of a motion and not its way.
//!
//! In: a recording. Out: the axes whose command is an end point, and the rows in which these are on their way. Telemetry of a servo
//! and logs of a control system often store the target: it steps at once, and the axis runs there while the command stands. On
//! the way such a command says nothing of where the axis should be, so that only rows at rest tell an error; but where a loop
//! without dead time explains the way, the command was followed after all, and all rows count.

use std::ops::Range;

use crate::candidates::geometric;
use crate::noise::middle;
use crate::position_loop::{PositionLoop, Stand, Start};
use crate::recording::{AxisChannels, Instrument, Recording};
use crate::states::Given;
use crate::way::Way;

/// A command is an end point where more than this share of the way is driven while it stands. Behind a command that shows the way,
/// an axis has its following error left to go; it is half of the way only where the whole motion lasts two time constants.
const WHILE_STANDING: f64 = 0.5;

/// A loop explains the way where it leaves less than this share of the distance to the target, root mean square: friction and
/// rounding. A dead time of two rows leaves a quarter.
const EXPLAINED: f64 = 0.15;

/// Time constants of loops that are tried: from a tenth of the step between rows to 100 steps, each longer than the last by this factor.
const LOOPS: (f64, f64, f64) = (0.1, 100.0, 1.2);

/// A target is reached within three standard deviations of what is read, or half a step of its display: an axis that creeps its
/// last step does not stand. And within this share of the longest way: a loop never quite arrives.
const REACHED: (f64, f64, f64) = (3.0, 0.5, 1e-3);

/// The share of its time at a target in which an axis must stand there, at the end, to have reached it.
const AT_REST: f64 = 1.0 / REST_PART as f64;
const REST_PART: usize = 4;

/// What is known of commands that are end points.
#[derive(Clone, Debug, Default)]
pub(crate) struct Targets {
    /// The axes whose command is an end point that no loop follows.
    pub(crate) axes: Vec<usize>,
    /// The rows in which such an axis is on its way; empty where there is none.
    pub(crate) on_the_way: Vec<bool>,
}

/// A command and what follows it, one entry a row.
struct Pair<'p> {
    given: &'p Given,
    command: &'p [f64],
    /// Where the axis is, its zero taken off.
    follows: Vec<f64>,
    /// The rows in which the command stands at one place each.
    stands: Vec<Range<usize>>,
}

impl Targets {
    /// Looks at every axis whose place was read; `letters` are those of the axes.
    pub(crate) fn new(recording: &Recording, given: &Given, letters: &[&str]) -> Self {
        let mut targets = Self::default();
        for (axis, letter) in letters.iter().enumerate() {
            let Some(command) = recording.axes.get(axis).and_then(|known| known.command.as_deref()) else {
                continue;
            };
            let Some(pair) = read(recording, axis, letter)
                .and_then(|place| Pair::new(given, command, &place))
                .filter(|pair| pair.is_end_point() && !pair.follows_a_loop())
            else {
                continue;
            };
            targets.axes.push(axis);
            targets.on_the_way.resize(command.len(), false);
            targets.on_the_way.iter_mut().zip(pair.on_the_way()).for_each(|(all, here)| *all |= here);
        }
        targets
    }
}

/// Where an axis was read to be, up to a zero: by its drive, as an angle, or by the tip in its own direction.
fn read(recording: &Recording, axis: usize, letter: &str) -> Option<Vec<f64>> {
    let AxisChannels { command, actual, measured } = recording.axes.get(axis)?;
    let direction = ["X", "Y", "Z"].iter().position(|known| *known == letter);
    let tip = direction.and_then(|direction| recording.measured[direction].as_ref());
    if let Some(place) = actual.as_ref().or(measured.as_ref()).or(tip) {
        return Some(place.clone());
    }
    let Instrument::Linear(line) = &recording.instrument else { return None };
    let sense = line.direction[direction.filter(|_| line.axis == Some(axis))?].signum();
    let rows = command.as_ref()?.iter().zip(recording.deviation.as_ref()?);
    Some(rows.map(|(command, deviation)| command + sense * deviation).collect())
}

impl<'p> Pair<'p> {
    /// `None` where the command never changes.
    fn new(given: &'p Given, command: &'p [f64], place: &[f64]) -> Option<Self> {
        let mut stands: Vec<Range<usize>> = Vec::new();
        for row in 0..command.len() {
            match stands.last_mut() {
                Some(rows)
                    if command[row] == command[rows.start] && given.legs[row] == given.legs[rows.start] =>
                {
                    rows.end = row + 1;
                }
                _ => stands.push(row..row + 1),
            }
        }
        let ends = stands.iter().map(|rows| place[rows.end - 1] - command[rows.end - 1]);
        let mut ends: Vec<f64> = ends.filter(|end| end.is_finite()).collect();
        let zero = middle(&mut ends)?;
        let follows = place.iter().map(|place| place - zero).collect();
        (stands.len() > 1).then_some(Self { given, command, follows, stands })
    }

    fn distance(&self, row: usize) -> f64 {
        (self.follows[row] - self.command[row]).abs()
    }

    /// Whether most of the way is driven while the command stands.
    fn is_end_point(&self) -> bool {
        let (mut driven, mut told) = (0.0, 0.0);
        for pair in self.stands.windows(2) {
            let rows = &pair[1];
            let step = (self.command[rows.start] - self.command[rows.start - 1]).abs();
            let nearer = self.distance(rows.start) - self.distance(rows.end - 1);
            // What brought it to the first place of a leg is not known.
            let told_here = step > 0.0 && self.given.legs[rows.start] == self.given.legs[rows.start - 1];
            if told_here && nearer.is_finite() {
                told += step;
                driven += nearer.max(0.0);
            }
        }
        driven > WHILE_STANDING * told
    }

    /// Whether some loop without dead time explains the way.
    fn follows_a_loop(&self) -> bool {
        let way = Way::new(&self.given.time, self.command, &self.given.legs);
        let start = |position: f64| match position.is_finite() {
            true => Start::At(Stand { position, velocity: 0.0 }),
            false => Start::AtRest,
        };
        let starts: Vec<Start> = way.stretches().map(|rows| start(self.follows[rows.start])).collect();
        let whole = self.size(|row| self.follows[row] - self.command[row]);
        let (least, most, factor) = LOOPS;
        geometric(least * self.given.step, most * self.given.step, factor).into_iter().any(|time_constant| {
            let followed = way.behind_loop(PositionLoop { time_constant, inertia: 0.0 }, &starts, 0.0);
            self.size(|row| self.follows[row] - followed[row].position) < EXPLAINED * whole
        })
    }

    /// The root mean square of a difference while the command stands, against what is left of it in the end.
    fn size(&self, difference: impl Fn(usize) -> f64) -> f64 {
        let (mut squares, mut count) = (0.0, 0.0_f64);
        for rows in &self.stands {
            let left = difference(rows.end - 1);
            for value in rows.clone().map(|row| difference(row) - left).filter(|value| value.is_finite()) {
                squares += value * value;
                count += 1.0;
            }
        }
        (squares / count.max(1.0)).sqrt()
    }

    /// The rows from each step of the command until the axis stands where it will stay; all of them where it does not.
    fn on_the_way(&self) -> Vec<bool> {
        let reached = self.resolution();
        let mut on_the_way = vec![false; self.command.len()];
        for (number, rows) in self.stands.iter().enumerate() {
            let end = self.follows[rows.end - 1];
            let away = |row: &usize| (self.follows[*row] - end).abs() > reached;
            let last = rows.clone().rev().find(away);
            let arrived = last.map_or(rows.start, |row| row + 1);
            let rest = crate::number(rows.end - arrived) / crate::number(rows.len());
            let stays = end.is_finite() && rest >= AT_REST;
            // Where the axis did not stir, it is not known whether it did not have to.
            let stirred = last.is_some() || number == 0;
            let until = if stays && stirred { arrived } else { rows.end };
            on_the_way[rows.start..until].fill(true);
        }
        on_the_way
    }

    /// How far apart two readings may be that are of one place.
    fn resolution(&self) -> f64 {
        let second = |row: usize| self.follows[row - 1] - 2.0 * self.follows[row] + self.follows[row + 1];
        let known = |value: &f64| value.is_finite();
        // At the end of its time at a target an axis is likeliest to stand.
        let ends =
            self.stands.iter().map(|rows| (rows.end - rows.len() / REST_PART).max(1) + 1..rows.end - 1);
        let mut bends: Vec<f64> = ends.flatten().map(|row| second(row).abs()).filter(known).collect();
        let steps = self.follows.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let display = steps.filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
        // The median of what is normal is 0.6745 of its deviation; second differences have six times the variance.
        let noise = middle(&mut bends).unwrap_or(0.0) / 0.6745 / 6.0_f64.sqrt();
        let ways =
            self.stands.windows(2).map(|pair| self.command[pair[1].start] - self.command[pair[0].start]);
        let longest = ways.map(f64::abs).filter(known).fold(0.0, f64::max);
        REACHED.0 * noise + REACHED.2 * longest + if display.is_finite() { REACHED.1 * display } else { 0.0 }
    }
}

#[cfg(test)]
mod tests;
