//! The circles of a path. In: a course. Out: traces: stretches of rows in which the nominal tool tip goes around a circle in
//! one sense, one full turn of it or what there is.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

use crate::course::{Course, cell, range};
use crate::fit::{Place, Round, from, least_squares};

/// How far the nominal path of a circle may lie beside it, as a share of the radius: the chords of an interpolator and filters
/// of the setpoints, and no polygon.
const BESIDE: f64 = 1e-3;

/// The share of the rows that must lie on the circle: the others lead in and out.
const MOST: f64 = 0.5;

/// The fewest rows of a trace.
const FEWEST: usize = 16;

/// How far the path must go back before its sense turns, rad.
const TURNS: f64 = 0.02;

/// What a full circle may lack: where its sense turns, rows are lost. 1 degree.
const DEGREE: f64 = PI / 180.0;

/// The motion out of the plane of a circle, as a share of its diameter.
const FLAT: f64 = 1e-3;

/// The planes: their directions in the order in which the angle counts from the first to the second, and their names.
/// Anticlockwise is right-handed about the third direction.
const PLANES: [([usize; 2], &str); 3] = [([0, 1], "XY"), ([1, 2], "YZ"), ([2, 0], "ZX")];

/// A stretch of the path around a circle in one sense.
#[derive(Clone, Debug)]
pub(crate) struct PathTrace {
    /// The plane's directions.
    pub(crate) directions: [usize; 2],
    /// The plane's name.
    pub(crate) plane: &'static str,
    /// The nominal circle, part frame.
    pub(crate) circle: Round,
    /// The run.
    pub(crate) run: i64,
    /// Whether it is counterclockwise.
    pub(crate) counterclockwise: bool,
    /// Its rows, without those in which it stood.
    pub(crate) rows: Vec<usize>,
    /// The nominal angle in each of them, going on beyond a turn, rad.
    pub(crate) angles: Vec<f64>,
    /// The speed along the circle, mm/s.
    pub(crate) feed: f64,
}

impl PathTrace {
    /// The angle that it goes around, rad.
    pub(crate) fn span(&self) -> f64 {
        range(&self.angles)
    }

    /// Whether it is a full circle, but for the step between two rows or a degree.
    pub(crate) fn full(&self) -> bool {
        let step = self.span() / crate::number(self.angles.len().max(2) - 1);
        self.span() >= TAU - (1.5 * step).max(DEGREE)
    }
}

/// All circular traces of a recording.
pub(crate) fn traces(course: &Course<'_>) -> Vec<PathTrace> {
    course.recording.runs().into_iter().flat_map(|(block, _)| of_block(course, block)).collect()
}

fn of_block(course: &Course<'_>, block: Range<usize>) -> Vec<PathTrace> {
    let rows: Vec<usize> = block.filter(|row| course.complete(*row)).collect();
    let Some((directions, plane)) = plane(course, &rows) else { return Vec::new() };
    let place = |row: usize| directions.map(|direction| tip(course, direction, row));
    let moving = moving(&rows, place);
    let Some(circle) = circle(&moving, place) else { return Vec::new() };
    let on_it = |row: &usize| {
        let (distance, _) = from(circle.center, place(*row));
        (distance - circle.radius).abs() <= BESIDE * circle.radius
    };
    let rows: Vec<usize> = moving.into_iter().filter(on_it).collect();
    let angles = unwrapped(rows.iter().map(|row| angle(circle.center, place(*row))));
    let pieces = one_sense(&angles);
    let trace = |piece: Range<usize>| {
        let rows = rows.get(piece.clone())?.to_vec();
        let angles = angles.get(piece)?.to_vec();
        let (first, last) = (*rows.first()?, *rows.last()?);
        let lasted = cell(&course.recording.time, last) - cell(&course.recording.time, first);
        let trace = PathTrace {
            directions,
            plane,
            circle,
            run: course.recording.run.get(first).copied().unwrap_or(1),
            counterclockwise: angles.last()? > angles.first()?,
            feed: circle.radius * range(&angles) / lasted,
            rows,
            angles,
        };
        (trace.rows.len() >= FEWEST && trace.span() > FRAC_PI_2).then(|| one_turn(trace))
    };
    pieces.into_iter().filter_map(trace).collect()
}

/// The plane in which the nominal tip moves, where it moves in one.
fn plane(course: &Course<'_>, rows: &[usize]) -> Option<([usize; 2], &'static str)> {
    let ranges = [0, 1, 2].map(|direction| {
        let column: Vec<f64> = rows.iter().map(|row| tip(course, direction, *row)).collect();
        range(&column)
    });
    let of = |direction: usize| cell(&ranges, direction);
    let flat = |([one, other], _): &&([usize; 2], &str)| {
        let (short, long) = (of(*one).min(of(*other)), of(*one).max(of(*other)));
        let third = 3 - one - other;
        short > 0.2 * long && of(third) <= FLAT * short
    };
    PLANES.iter().find(flat).copied()
}

fn tip(course: &Course<'_>, direction: usize, row: usize) -> f64 {
    course.tip.get(direction).map_or(f64::NAN, |column| cell(column, row))
}

/// The rows without those that stay where the one before was.
fn moving(rows: &[usize], place: impl Fn(usize) -> Place) -> Vec<usize> {
    let mut moving: Vec<usize> = Vec::new();
    for row in rows {
        if moving.last().is_none_or(|last| place(*last) != place(*row)) {
            moving.push(*row);
        }
    }
    moving
}

/// The circle on which most rows lie. Those that do not are left out, and the circle is fitted again.
fn circle(rows: &[usize], place: impl Fn(usize) -> Place) -> Option<Round> {
    let all: Vec<Place> = rows.iter().map(|row| place(*row)).collect();
    let mut points = all.clone();
    for _ in 0..8 {
        let circle = least_squares(&points)?;
        let distance = |point: &Place| (from(circle.center, *point).0 - circle.radius).abs();
        let mut sorted: Vec<f64> = points.iter().map(distance).collect();
        sorted.sort_by(f64::total_cmp);
        let farthest = sorted.last().copied()?;
        if farthest <= BESIDE * circle.radius {
            let on_it = all.iter().filter(|point| distance(point) <= BESIDE * circle.radius).count();
            return (crate::number(on_it) >= MOST * crate::number(all.len())).then_some(circle);
        }
        // The worst tenth goes, and with it what pulled the circle aside.
        let limit = cell(&sorted, sorted.len() * 9 / 10).max(BESIDE * circle.radius);
        points = all.iter().copied().filter(|point| distance(point) <= limit).collect();
    }
    None
}

fn angle(center: Place, point: Place) -> f64 {
    (point[1] - center[1]).atan2(point[0] - center[0])
}

/// Angles that go on beyond a turn.
fn unwrapped(angles: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut last: Option<f64> = None;
    let next = |angle: f64| {
        let whole = last.map_or(angle, |last| angle - TAU * ((angle - last) / TAU).round());
        last = Some(whole);
        whole
    };
    angles.map(next).collect()
}

/// The stretches in which the angle goes one way.
fn one_sense(angles: &[f64]) -> Vec<Range<usize>> {
    let mut pieces = Vec::new();
    let (mut start, mut farthest, mut sense) = (0, 0, 0.0);
    for number in 1..angles.len() {
        let step = cell(angles, number) - cell(angles, farthest);
        if sense == 0.0 && step.abs() > TURNS {
            sense = step.signum();
        }
        if sense == 0.0 {
            continue;
        }
        if step * sense > 0.0 {
            farthest = number;
        } else if -step * sense > TURNS {
            pieces.push(start..farthest + 1);
            (start, farthest, sense) = (farthest, number, step.signum());
        }
    }
    pieces.push(start..angles.len());
    pieces
}

/// The middle turn of a trace that goes on beyond one: what comes before and after it runs in and out.
fn one_turn(mut trace: PathTrace) -> PathTrace {
    if trace.span() <= TAU {
        return trace;
    }
    let (first, last) = (trace.angles.first().copied(), trace.angles.last().copied());
    let middle = f64::midpoint(first.unwrap_or(0.0), last.unwrap_or(0.0));
    let inside: Vec<bool> = trace.angles.iter().map(|angle| (-PI..PI).contains(&(angle - middle))).collect();
    let mut keep = inside.iter();
    trace.rows.retain(|_| keep.next() == Some(&true));
    let mut keep = inside.iter();
    trace.angles.retain(|_| keep.next() == Some(&true));
    trace
}
