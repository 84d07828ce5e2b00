//! The figures of circular tests, ISO 230-4.
//!
//! In: traces, and what was read on them. Out: circles with their traces, pairs of senses and figures.
//!
//! | figure | definition |
//! | --- | --- |
//! | circular deviation G | the least radial distance of two concentric circles that hold the actual path of one sense: the minimum zone |
//! | G by least squares | the range of radial distances about the least-squares centre, which the standard lets stand for it; it is never less |
//! | bidirectional circular deviation G(b) | G of the paths of both senses together, about one centre |
//! | radial deviation F, max and min | distance of the actual path from the centre minus the nominal radius, about the least-squares centre of the trace |
//! | the same as set up | about the nominal centre, as the instrument was centred; arcs have it too |
//! | mean bidirectional radial deviation D | radius of the least-squares circle of both paths minus the nominal radius |
//!
//! These are the definitions as the literature of the standard (editions of 1996 to 2022) has them; the newer editions say
//! *error* for *deviation*.

mod figures;
mod reader;

use std::f64::consts::TAU;

use recording::Instrument;

use crate::NotGiven;
use crate::circles::PathTrace;
use crate::course::Course;
use crate::figure::{Figure, Sensor};
use crate::fit::{Place, from, least_squares, minimum_zone};
use figures::figures;
use reader::Reader;

/// The widest gap between readings of a full circle, rad: 15 degrees.
const WIDEST_GAP: f64 = TAU / 24.0;

/// How far the feeds of one circle may lie apart, as a share.
const SAME_FEED: f64 = 0.02;

/// How far centres and radii of one circle may lie apart, as a share of the radius.
const SAME_PLACE: f64 = 1e-3;

/// The sense of a trace: right-handed about the third direction is counterclockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// From the first direction of the plane to the second.
    Counterclockwise,
    /// From the second direction of the plane to the first.
    Clockwise,
}

impl Sense {
    /// `CCW` or `CW`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Counterclockwise => "CCW",
            Self::Clockwise => "CW",
        }
    }
}

/// A circle that was driven, with all that was read on it: mm, rad.
#[derive(Clone, Debug, PartialEq)]
pub struct Circle {
    /// The plane: `XY`, `YZ` or `ZX`. Angles count from its first direction to its second.
    pub plane: &'static str,
    /// The centre of the nominal path in the plane's directions, part frame; none where the machine's constants are not known.
    pub center: Option<[f64; 2]>,
    /// The nominal radius.
    pub radius: f64,
    /// The feed along it, mm/s.
    pub feed: f64,
    /// What read it.
    pub sensor: Sensor,
    /// Every time it was driven, in order.
    pub traces: Vec<Trace>,
    /// One trace of each sense together, in order.
    pub pairs: Vec<Pair>,
    /// The figures; of several traces or pairs the greatest, the least for F_min, the mean for D.
    pub figures: Vec<Figure>,
}

/// One time around in one sense.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// The run.
    pub run: i64,
    /// The sense.
    pub sense: Sense,
    /// The angle it goes around, rad.
    pub span: f64,
    /// What was read, in order of time.
    pub points: Vec<Point>,
    /// Greatest and least radial deviation about the nominal centre, as the instrument was set up, or why there are none. Arcs
    /// have them too.
    pub set_up: Result<[f64; 2], String>,
    /// Its figures, or why there are none.
    pub figures: Result<TraceFigures, String>,
}

/// A reading on a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where on the circle by the program: from 0 to below 2 pi.
    pub angle: f64,
    /// The radial deviation about the least-squares centre of the trace, or about the nominal one where there is none; outwards
    /// positive.
    pub radial: f64,
    /// The actual path, relative to the nominal centre.
    pub place: Place,
}

/// The figures of one trace.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TraceFigures {
    /// The circular deviation G: the width of the minimum zone.
    pub circular: f64,
    /// The range about the least-squares centre.
    pub circular_least_squares: f64,
    /// Greatest and least radial deviation about the least-squares centre.
    pub radial: [f64; 2],
    /// Least-squares centre minus nominal centre; none where the place of the nominal centre is not known.
    pub center: Option<Place>,
    /// Radius of the least-squares circle minus the nominal radius.
    pub radius: f64,
}

/// Two traces of opposite senses together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pair {
    /// The runs of the counterclockwise and of the clockwise one.
    pub runs: [i64; 2],
    /// The readings of both.
    pub readings: usize,
    /// The bidirectional circular deviation G(b): the width of the minimum zone of both.
    pub circular: f64,
    /// The range about the least-squares centre of both.
    pub circular_least_squares: f64,
    /// The mean bidirectional radial deviation D.
    pub radius: f64,
}

/// The circles of a recording, and why there are none where there might be.
pub(crate) fn evaluate(course: &Course<'_>, traces: Vec<PathTrace>) -> (Vec<Circle>, Vec<NotGiven>) {
    let mut circles: Vec<Circle> = Vec::new();
    let mut groups: Vec<Vec<PathTrace>> = Vec::new();
    for trace in traces {
        let group = groups.iter_mut().find(|group| group.first().is_some_and(|first| alike(first, &trace)));
        match group {
            Some(group) => group.push(trace),
            None => groups.push(vec![trace]),
        }
    }
    let mut without: Vec<NotGiven> = Vec::new();
    for group in groups {
        let Some(first) = group.first() else { continue };
        match Reader::of(course, first) {
            Ok(reader) => circles.push(circle(course, &reader, &group)),
            Err(because) => {
                let what = format!("circular and radial deviations in {}", first.plane);
                let reason = NotGiven::new(what, because);
                if !without.contains(&reason) {
                    without.push(reason);
                }
            }
        }
    }
    if circles.is_empty()
        && without.is_empty()
        && matches!(course.recording.instrument, Instrument::Ballbar { .. })
    {
        without.push(NotGiven::new(
            "circular and radial deviations",
            "the programmed path is not a circle in XY, YZ or ZX",
        ));
    }
    (circles, without)
}

/// Whether two traces are of one circle at one feed.
fn alike(one: &PathTrace, other: &PathTrace) -> bool {
    let far = SAME_PLACE * one.circle.radius;
    let centers = one.circle.center.iter().zip(other.circle.center);
    one.directions == other.directions
        && centers.into_iter().all(|(one, other)| (one - other).abs() <= far)
        && (one.circle.radius - other.circle.radius).abs() <= far
        && (one.feed - other.feed).abs() <= SAME_FEED * one.feed
}

fn circle(course: &Course<'_>, reader: &Reader<'_>, group: &[PathTrace]) -> Circle {
    let traces: Vec<Trace> = group.iter().map(|own| trace(course, reader, own)).collect();
    let first = group.first();
    let radius = first.map_or(0.0, |first| reader.radius(first));
    let pairs = pairs(&traces, radius);
    Circle {
        plane: first.map_or("", |first| first.plane),
        center: first.map(|first| first.circle.center).filter(|_| course.absolute),
        radius,
        feed: first.map_or(0.0, |first| first.feed),
        sensor: reader.sensor(),
        figures: figures(&traces, &pairs),
        traces,
        pairs,
    }
}

fn trace(course: &Course<'_>, reader: &Reader<'_>, own: &PathTrace) -> Trace {
    let radius = reader.radius(own);
    let mut points: Vec<Point> = own
        .rows
        .iter()
        .zip(&own.angles)
        .map(|(row, angle)| (angle.rem_euclid(TAU), reader.place(own, *row, *angle)))
        .filter(|(_, place)| place.iter().all(|part| part.is_finite()))
        .map(|(angle, place)| Point { angle, radial: from([0.0; 2], place).0 - radius, place })
        .collect();
    let places: Vec<Place> = points.iter().map(|point| point.place).collect();
    let set_up = set_up(&places, radius, reader.centered(course));
    let figures = trace_figures(own, &points, radius).map(|(figures, center)| {
        for point in &mut points {
            point.radial = from(center, point.place).0 - radius;
        }
        let center = reader.centered(course).then_some(center);
        TraceFigures { center, ..figures }
    });
    let sense = if own.counterclockwise { Sense::Counterclockwise } else { Sense::Clockwise };
    Trace { run: own.run, sense, span: own.span(), points, set_up, figures }
}

/// Greatest and least radial deviation about the nominal centre.
fn set_up(places: &[Place], radius: f64, centered: bool) -> Result<[f64; 2], String> {
    if !centered {
        return Err(
            "without a calibration, the constants of the machine and therefore the centre are unknown"
                .to_owned(),
        );
    }
    if places.is_empty() {
        return Err("it has no readings".to_owned());
    }
    let [near, far] = ends(places, [0.0; 2]);
    Ok([far - radius, near - radius])
}

/// The figures of a trace, and its least-squares centre.
fn trace_figures(own: &PathTrace, points: &[Point], radius: f64) -> Result<(TraceFigures, Place), String> {
    if !own.full() {
        return Err(format!(
            "the path is not a full circle: it covers {:.0} degrees",
            own.span().to_degrees()
        ));
    }
    let gap = widest_gap(points);
    if gap > WIDEST_GAP {
        return Err(format!("{:.0} degrees of the circle have no readings", gap.to_degrees()));
    }
    let places: Vec<Place> = points.iter().map(|point| point.place).collect();
    let round = least_squares(&places).ok_or_else(|| "the readings do not form a circle".to_owned())?;
    let [near, far] = ends(&places, round.center);
    let radial = [far - radius, near - radius];
    let figures = TraceFigures {
        circular: minimum_zone(&places, round.center).width,
        circular_least_squares: radial[0] - radial[1],
        radial,
        center: None,
        radius: round.radius - radius,
    };
    Ok((figures, round.center))
}

/// Least and greatest distance from a centre.
fn ends(places: &[Place], center: Place) -> [f64; 2] {
    let distances = || places.iter().map(|place| from(center, *place).0);
    [distances().fold(f64::INFINITY, f64::min), distances().fold(f64::NEG_INFINITY, f64::max)]
}

/// The widest angle in which nothing was read.
fn widest_gap(points: &[Point]) -> f64 {
    let mut angles: Vec<f64> = points.iter().map(|point| point.angle).collect();
    angles.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (angles.first(), angles.last()) else { return TAU };
    let between = angles.iter().zip(angles.iter().skip(1)).map(|(one, next)| next - one);
    between.fold(first + TAU - last, f64::max)
}

/// One trace of each sense together: of the same run where there are such, else in order.
fn pairs(traces: &[Trace], radius: f64) -> Vec<Pair> {
    let of = |sense: Sense| {
        traces
            .iter()
            .filter(move |trace| trace.sense == sense && trace.figures.is_ok())
            .collect::<Vec<&Trace>>()
    };
    let (ones, mut others) = (of(Sense::Counterclockwise), of(Sense::Clockwise));
    let shared = |trace: &Trace| others.iter().any(|other| other.run == trace.run);
    let by_run = ones.iter().any(|one| shared(one));
    let mut pairs = Vec::new();
    for one in ones {
        let place = others.iter().position(|other| !by_run || other.run == one.run);
        let Some(other) = place.map(|place| others.remove(place)) else { continue };
        pairs.extend(pair(one, other, radius));
    }
    pairs
}

fn pair(one: &Trace, other: &Trace, radius: f64) -> Option<Pair> {
    let places: Vec<Place> = one.points.iter().chain(&other.points).map(|point| point.place).collect();
    let round = least_squares(&places)?;
    let [near, far] = ends(&places, round.center);
    Some(Pair {
        runs: [one.run, other.run],
        readings: places.len(),
        circular: minimum_zone(&places, round.center).width,
        circular_least_squares: far - near,
        radius: round.radius - radius,
    })
}
