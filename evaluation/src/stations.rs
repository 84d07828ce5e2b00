//! Stations: where the axes stood on straight lines, and from which side they came.
//!
//! In: a course. Out: the straight lines of its path, each with the readings at rest and the direction of every approach. A
//! run is taken apart into places; a place where the axes stood long enough is a station, the others are passed in motion.
//! The direction of an approach is that of the motion before it. Recordings of stations alone lack the overrun at the ends
//! of a cycle: [`cycle`] finds what stands for it.

mod cycle;

use std::collections::BTreeSet;
use std::ops::Range;

use crate::circles::PathTrace;
use crate::course::{Course, cell, dot, range};

/// How long an axis stands at a station at least, s: rows that follow each other faster, each with another position, were read
/// in motion. A reading at rest waits for the axis to settle.
const REST: f64 = 0.5;

/// Stands that are closer than this share of the length of their line are at one target.
const SAME_TARGET: f64 = 1e-4;

/// The most lines that are told apart.
const MOST_LINES: usize = 500;

/// A line that is passed in motion is told of where it is longer than this share of the range of its axis.
const WORTH_TELLING: f64 = 0.2;

/// The lines of a recording.
#[derive(Default)]
pub(crate) struct Travelled {
    /// The lines with stations, in order.
    pub(crate) lines: Vec<Line>,
    /// The axes that moved alone and stopped nowhere, with the time between rows, s.
    pub(crate) in_motion: Vec<(usize, f64)>,
    /// Whether there were more lines than are told apart.
    pub(crate) overfull: bool,
}

/// A straight line in the positions of the axes.
pub(crate) struct Line {
    /// The axes that move along it.
    pub(crate) axes: Vec<usize>,
    /// How each axis of the machine moves for each mm or rad along it; the first of them in its positive sense.
    pub(crate) direction: Vec<f64>,
    /// The place of the line nearest to all zeros.
    pub(crate) foot: Vec<f64>,
    /// The readings at rest, in order of time.
    pub(crate) approaches: Vec<Approach>,
}

impl Line {
    /// Whether an overrun that the recording lacks was taken for granted.
    pub(crate) fn assumed(&self) -> bool {
        self.approaches.iter().any(|approach| approach.assumed)
    }
}

/// A stand at a station after an approach along the line.
pub(crate) struct Approach {
    /// Where on the line.
    pub(crate) at: f64,
    /// Whether it came in the positive direction.
    pub(crate) up: bool,
    /// The rows of the later half of the stand: what is read there.
    pub(crate) rows: Range<usize>,
    /// Whether the stand has one row only.
    pub(crate) single: bool,
    /// Whether the way there is not in the recording, but what a cycle has.
    pub(crate) assumed: bool,
}

/// A place, and the rows in which the program stays there.
struct Stop {
    position: Vec<f64>,
    rows: Range<usize>,
    rested: bool,
    /// Whether it was approached in the direction of the way on, by an overrun that was not recorded.
    entered: bool,
}

/// The straight lines of a recording; runs that are circles have none.
pub(crate) fn travelled(course: &Course<'_>, circles: &[PathTrace]) -> Travelled {
    let mut travelled = Travelled::default();
    let mut in_motion = BTreeSet::new();
    let straight = |block: &Range<usize>| {
        !circles.iter().any(|trace| trace.rows.first().is_some_and(|row| block.contains(row)))
    };
    let blocks = course.recording.runs().into_iter().map(|(block, _)| block);
    let mut runs: Vec<Vec<Stop>> = blocks.filter(straight).map(|block| stops(course, block)).collect();
    cycle::complete(course, &mut runs);
    for stops in runs {
        for piece in pieces(course, &stops) {
            travelled.take(course, &stops, piece, &mut in_motion);
        }
    }
    let with_stations: BTreeSet<&Vec<usize>> = travelled.lines.iter().map(|line| &line.axes).collect();
    in_motion.retain(|axis| !with_stations.contains(&vec![*axis]));
    let step = typical_step(&course.recording.time);
    travelled.in_motion = in_motion.into_iter().map(|axis| (axis, step)).collect();
    travelled
}

impl Travelled {
    /// Takes what one straight piece shows.
    fn take(&mut self, course: &Course<'_>, stops: &[Stop], piece: Piece, in_motion: &mut BTreeSet<usize>) {
        let Some(members) = stops.get(piece.stops.clone()) else { return };
        let approaches = approaches(course, members, &piece);
        if approaches.is_empty() {
            in_motion.extend(alone_in_motion(course, members, &piece));
            return;
        }
        let known = self.lines.iter_mut().find(|line| line.holds(course, members, &piece));
        if let Some(line) = known {
            line.approaches.extend(approaches);
        } else if self.lines.len() < MOST_LINES {
            let foot = members.first().map(|stop| foot(&stop.position, &piece.direction)).unwrap_or_default();
            self.lines.push(Line { axes: piece.axes, direction: piece.direction, foot, approaches });
        } else {
            self.overfull = true;
        }
    }
}

impl Line {
    /// Whether a piece lies on this line.
    fn holds(&self, course: &Course<'_>, members: &[Stop], piece: &Piece) -> bool {
        self.axes == piece.axes
            && [members.first(), members.last()]
                .into_iter()
                .flatten()
                .all(|stop| beside(course, &foot(&stop.position, &self.direction), &self.foot))
    }

    /// How far apart two targets are at least.
    pub(crate) fn tolerance(&self) -> f64 {
        let places: Vec<f64> = self.approaches.iter().map(|approach| approach.at).collect();
        (SAME_TARGET * range(&places)).max(f64::MIN_POSITIVE)
    }
}

/// The places of a run, one after another.
fn stops(course: &Course<'_>, block: Range<usize>) -> Vec<Stop> {
    let mut stops: Vec<Stop> = Vec::new();
    let time = |row: usize| cell(&course.recording.time, row);
    for row in block.filter(|row| course.complete(*row)) {
        let position = course.position(row);
        // Where commands are missing for so long, the axes may have left and come back.
        let stays = |stop: &&mut Stop| {
            let unknown = stop.rows.end < row && time(row) - time(stop.rows.end - 1) >= REST;
            !unknown && same(course, &stop.position, &position)
        };
        match stops.last_mut().filter(stays) {
            Some(stop) => stop.rows.end = row + 1,
            None => stops.push(Stop { position, rows: row..row + 1, rested: false, entered: false }),
        }
    }
    let starts: Vec<f64> = stops.iter().map(|stop| time(stop.rows.start)).collect();
    for (number, stop) in stops.iter_mut().enumerate() {
        let own = time(stop.rows.start);
        let stood = time(stop.rows.end - 1) - own;
        let lasted =
            match (starts.get(number + 1), number.checked_sub(1).and_then(|before| starts.get(before))) {
                (Some(next), _) => next - own,
                // The last one of a run: what the rows show, or what they suggest.
                (None, Some(before)) if stop.rows.len() == 1 => own - before,
                (None, _) => stood,
            };
        stop.rested = lasted >= REST;
        // The way into a place may have begun within its tolerance.
        stop.position = course.position(stop.rows.end - 1);
    }
    stops
}

fn same(course: &Course<'_>, one: &[f64], other: &[f64]) -> bool {
    let pairs = one.iter().zip(other).zip(&course.tolerance);
    pairs.into_iter().all(|((one, other), tolerance)| (one - other).abs() <= *tolerance)
}

/// Whether two feet are of one line. The first two places give the direction of a diagonal only as well as they are rounded,
/// and every axis has its part of that.
fn beside(course: &Course<'_>, one: &[f64], other: &[f64]) -> bool {
    let widest = course.tolerance.iter().copied().fold(0.0, f64::max);
    one.iter().zip(other).all(|(one, other)| (one - other).abs() <= widest)
}

/// A straight piece of a path.
struct Piece {
    /// Its places, by their numbers.
    stops: Range<usize>,
    axes: Vec<usize>,
    direction: Vec<f64>,
}

/// The longest straight pieces, one after another; the corner between two belongs to both.
fn pieces(course: &Course<'_>, stops: &[Stop]) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut start = 0;
    while let (Some(first), Some(second)) = (stops.get(start), stops.get(start + 1)) {
        let (axes, direction) = direction(course, &first.position, &second.position);
        if axes.is_empty() {
            start += 1;
            continue;
        }
        let own = foot(&first.position, &direction);
        let mut end = start + 2;
        while stops.get(end).is_some_and(|next| beside(course, &foot(&next.position, &direction), &own)) {
            end += 1;
        }
        pieces.push(Piece { stops: start..end, axes, direction });
        start = end - 1;
    }
    pieces
}

/// The axes that move between two places, and the unit vector along which they do.
fn direction(course: &Course<'_>, from: &[f64], to: &[f64]) -> (Vec<usize>, Vec<f64>) {
    let steps = from.iter().zip(to).zip(&course.tolerance);
    let step: Vec<f64> = steps
        .map(|((from, to), tolerance)| if (to - from).abs() > *tolerance { to - from } else { 0.0 })
        .collect();
    let length = dot(&step, &step).sqrt();
    let sign = step.iter().find(|part| **part != 0.0).map_or(1.0, |part| part.signum());
    let axes = (0..step.len()).filter(|axis| cell(&step, *axis) != 0.0).collect();
    (axes, step.iter().map(|part| sign * part / length).collect())
}

fn foot(position: &[f64], direction: &[f64]) -> Vec<f64> {
    let along = dot(position, direction);
    position.iter().zip(direction).map(|(position, direction)| position - along * direction).collect()
}

/// The stands on a piece, where the way there is known: along the line from another place, or by an overrun that is not in the
/// recording, which leaves the way on.
fn approaches(course: &Course<'_>, members: &[Stop], piece: &Piece) -> Vec<Approach> {
    let at = |stop: &Stop| dot(&stop.position, &piece.direction);
    let approach = |(number, stop): (usize, &Stop)| {
        let near = |number: usize| members.get(number);
        let (before, after) = (number.checked_sub(1).and_then(near), near(number + 1));
        let moved = before.filter(|before| !same(course, &before.position, &stop.position));
        let first = before.is_none() && piece.stops.start == 0;
        let (up, assumed) = match (moved, after) {
            (Some(before), _) => (at(stop) > at(before), false),
            (None, Some(after)) if stop.entered && (first || before.is_some()) => {
                (at(after) > at(stop), true)
            }
            _ => return None,
        };
        let rows = &stop.rows;
        let single = rows.len() == 1;
        // The later half of a stand counts.
        Some(Approach { at: at(stop), up, rows: rows.start + rows.len() / 2..rows.end, single, assumed })
    };
    members.iter().enumerate().filter(|(_, stop)| stop.rested).filter_map(approach).collect()
}

/// The axis that moves alone and stops nowhere, where that is a good part of its way.
fn alone_in_motion(course: &Course<'_>, members: &[Stop], piece: &Piece) -> Option<usize> {
    let [axis] = piece.axes.as_slice() else { return None };
    let places: Vec<f64> = members.iter().map(|stop| cell(&stop.position, *axis)).collect();
    let whole = course.positions.get(*axis).map_or(0.0, |column| range(column));
    (range(&places) > WORTH_TELLING * whole).then_some(*axis)
}

/// The median step between rows, s.
fn typical_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.iter().zip(time.iter().skip(1)).map(|(one, next)| next - one).collect();
    steps.sort_by(f64::total_cmp);
    cell(&steps, steps.len() / 2)
}
