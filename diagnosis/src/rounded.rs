//! Rounded commands: programmed positions of which a recorder kept few digits.
//!
//! In: times and positions of one axis. Out: the step to which they were rounded, and the way that was rounded to them. The rounding
//! of a command is noise of what is predicted; a tool that steps by 0.1 mm is no tool that moves. Within a leg an axis mostly moves
//! straight on, so that a line through many rows is nearer to the way than each of them.

use std::f64::consts::PI;
use std::ops::Range;

/// A step smaller than this share of the travel is none that matters: a good machine errs by as much, 10 um in a metre.
const MATTERS: f64 = 1e-5;

/// A command was rounded where lines fit it to its step through short stretches in motion, at least through one of four, and where
/// most of these do show rounding: more than this share of what a step makes. A program's own steps lie on the line or far off.
const SHORT: usize = 9;
const STRAIGHT: f64 = 0.25;
const SHOWN: f64 = 0.5;

/// What differs by less of the travel is the same number, worked out twice.
const ALIKE: f64 = 1e-9;

/// The widest line goes through this many rows on each side.
const WIDEST: usize = 64;

/// A line fits rounded rows that leave no more than their rounding, a step over the root of twelve; this much more by chance.
const CHANCE: f64 = 1.1;

/// A command that was rounded.
pub(crate) struct Rounded {
    /// What all positions are multiples of, mm or rad.
    pub(crate) step: f64,
    /// The way, as well as it is known.
    pub(crate) way: Vec<f64>,
}

/// The standard deviation of what was rounded to a step.
pub(crate) fn deviation(step: f64) -> f64 {
    step / 12f64.sqrt()
}

/// The step to which was rounded what has this standard deviation.
pub(crate) fn step(deviation: f64) -> f64 {
    deviation * 12f64.sqrt()
}

/// How far rounding is off, at most, in a way that comes back: an axis at constant speed passes the steps of a display in a steady
/// beat, and at one place a display is off by as much in every pass. `rounding` is its standard deviation, `noise` that of a reading.
/// What the noise is beside it tells one step from the next and blurs the beat, as its characteristic function says.
pub(crate) fn beat(rounding: f64, noise: f64) -> f64 {
    if rounding <= 0.0 {
        return 0.0;
    }
    let beside = (noise.powi(2) - rounding.powi(2)).max(0.0) / step(rounding).powi(2);
    0.5 * step(rounding) * (-2.0 * PI * PI * beside).exp()
}

/// Looks at the command of an axis; `None` where nothing speaks for rounding. `legs` are those of the rows.
pub(crate) fn unrounded(
    time: &[f64],
    command: &[f64],
    legs: impl Iterator<Item = Range<usize>>,
) -> Option<Rounded> {
    let step = step_of(time, command)?;
    let mut way = command.to_vec();
    for rows in legs.filter(|rows| command[rows.clone()].iter().all(|place| place.is_finite())) {
        for row in rows.clone() {
            way[row] = smooth(time, command, step, &rows, row);
        }
    }
    Some(Rounded { step, way })
}

/// The step to which a command in motion was rounded.
fn step_of(time: &[f64], command: &[f64]) -> Option<f64> {
    let steps: Vec<f64> = command.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let known = || command.iter().copied().filter(|place| place.is_finite());
    let (low, high) =
        known().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(q), high.max(q)));
    let bend = |pair: &[f64]| (pair[1] - pair[0]).abs();
    // Where every row moves by several steps, only differences of moves are as fine as one.
    let moves = steps.iter().map(|step| step.abs()).chain(steps.windows(2).map(bend));
    let step = moves.filter(|step| *step > ALIKE * (high - low)).fold(f64::INFINITY, f64::min);
    let whole = |place: f64| (place - (place / step).round() * step).abs() < 1e-3 * step;
    // A command that stands has no step.
    let matters = step.is_finite() && step > MATTERS * (high - low);
    if !matters || !known().all(|place| whole(place - low)) {
        return None;
    }
    let moving = || {
        command.chunks_exact(SHORT).enumerate().filter(|(_, part)| {
            // Stations at which it is read several times are stairs as well: only what moves in every row is told from them.
            part.windows(2).all(|pair| (pair[1] - pair[0]).abs() > 0.5 * step)
        })
    };
    let left = |number: usize| {
        let rows = number * SHORT..(number + 1) * SHORT;
        line(time, command, rows).left / deviation(step)
    };
    let lines: Vec<f64> = moving().map(|(number, _)| left(number)).collect();
    let straight = crate::number(lines.iter().filter(|left| **left <= CHANCE).count());
    let shown = crate::number(lines.iter().filter(|left| (SHOWN..=CHANCE).contains(*left)).count());
    (straight > STRAIGHT * crate::number(lines.len()) && shown > 0.5 * straight).then_some(step)
}

/// The place on the widest line through a row that its neighbours in the leg may have been rounded from.
fn smooth(time: &[f64], command: &[f64], step: f64, leg: &Range<usize>, row: usize) -> f64 {
    let widths = std::iter::successors(Some(WIDEST), |width| (*width > 2).then(|| width / 2));
    let windows = widths.flat_map(|width| {
        [(width, width), (2 * width, 0), (0, 2 * width)]
            .map(|(before, behind)| (row.checked_sub(before), row + behind))
    });
    let inside = windows.filter_map(|(first, last)| {
        let first = first.filter(|first| *first >= leg.start)?;
        (last < leg.end).then_some(first..last + 1)
    });
    let mut lines = inside.map(|rows| line(time, command, rows));
    let fits = lines.find(|line| line.left <= CHANCE * deviation(step));
    fits.map_or(command[row], |line| line.mean + line.slope * (time[row] - line.middle))
}

/// The line through some rows.
struct Line {
    middle: f64,
    mean: f64,
    slope: f64,
    /// The root mean square of what it leaves.
    left: f64,
}

fn line(time: &[f64], command: &[f64], rows: Range<usize>) -> Line {
    let count = crate::number(rows.len());
    let middle = rows.clone().map(|row| time[row]).sum::<f64>() / count;
    let mean = rows.clone().map(|row| command[row]).sum::<f64>() / count;
    let (mut squares, mut products, mut spread) = (0.0, 0.0, 0.0);
    for row in rows {
        let (t, q) = (time[row] - middle, command[row] - mean);
        squares += t * t;
        products += t * q;
        spread += q * q;
    }
    let slope = products / squares;
    Line { middle, mean, slope, left: ((spread - products * slope).max(0.0) / count).sqrt() }
}

#[cfg(test)]
mod tests;
