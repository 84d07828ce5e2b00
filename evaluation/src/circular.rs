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

use std::f64::consts::TAU;

use diagnosis::recording::Instrument;

use crate::circles::PathTrace;
use crate::course::{Course, cell};
use crate::figure::{Figure, Given, Rests, Sensor, Unit};
use crate::fit::{Place, from, least_squares, minimum_zone};
use crate::{NotGiven, number};

/// The widest gap between readings of a full circle, rad: 15 degrees.
const WIDEST_GAP: f64 = TAU / 24.0;

/// How far the nominal path may lie from a ballbar's nominal length, as a share of it.
const BAR: f64 = 0.01;

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
            "the programmed path is no circle in XY, YZ or ZX",
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

/// What gives the actual path.
enum Reader<'r> {
    /// Radial deviations of a ballbar.
    Radial { deviation: &'r [f64], radius: f64 },
    /// The tool tip in the plane.
    Tip { columns: [Vec<f64>; 2], sensor: Sensor },
}

impl<'r> Reader<'r> {
    fn of(course: &'r Course<'_>, trace: &PathTrace) -> Result<Self, String> {
        match &course.recording.instrument {
            Instrument::Ballbar { radius, .. } => {
                let off = (trace.circle.radius - radius).abs();
                if off > BAR * radius {
                    let own = trace.circle.radius;
                    return Err(format!(
                        "the path has a radius of {own:.3} mm and the bar one of {radius:.3} mm: it does not lie in the plane"
                    ));
                }
                let deviation = course.recording.deviation.as_deref();
                let deviation = deviation.ok_or_else(|| "the channel `deviation` is missing".to_owned())?;
                Ok(Self::Radial { deviation, radius: *radius })
            }
            Instrument::Position => {
                let (columns, sensor) = course.seen(trace.directions)?;
                Ok(Self::Tip { columns, sensor })
            }
            _ => Err("a circle is read by the instruments `ballbar` and `position`".to_owned()),
        }
    }

    fn sensor(&self) -> Sensor {
        match self {
            Self::Radial { .. } => Sensor::Instrument,
            Self::Tip { sensor, .. } => *sensor,
        }
    }

    fn radius(&self, trace: &PathTrace) -> f64 {
        match self {
            Self::Radial { radius, .. } => *radius,
            Self::Tip { .. } => trace.circle.radius,
        }
    }

    /// Whether the centre about which the readings stand is the nominal one.
    fn centered(&self, course: &Course<'_>) -> bool {
        match self {
            Self::Radial { .. } => true,
            Self::Tip { sensor, .. } => *sensor == Sensor::Feedback || course.absolute,
        }
    }

    /// The actual path relative to the nominal centre; NaN where nothing was read.
    fn place(&self, trace: &PathTrace, row: usize, angle: f64) -> Place {
        match self {
            Self::Radial { deviation, radius } => {
                let distance = radius + cell(deviation, row);
                [distance * angle.cos(), distance * angle.sin()]
            }
            Self::Tip { columns: [one, other], .. } => {
                let [x, y] = trace.circle.center;
                [cell(one, row) - x, cell(other, row) - y]
            }
        }
    }
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
        return Err("without a calibration the machine's constants, and with them the centre, are not known"
            .to_owned());
    }
    if places.is_empty() {
        return Err("nothing was read on it".to_owned());
    }
    let [near, far] = ends(places, [0.0; 2]);
    Ok([far - radius, near - radius])
}

/// The figures of a trace, and its least-squares centre.
fn trace_figures(own: &PathTrace, points: &[Point], radius: f64) -> Result<(TraceFigures, Place), String> {
    if !own.full() {
        return Err(format!(
            "the path is no full circle: it goes around {:.0} degrees",
            own.span().to_degrees()
        ));
    }
    let gap = widest_gap(points);
    if gap > WIDEST_GAP {
        return Err(format!("nothing was read over {:.0} degrees of the circle", gap.to_degrees()));
    }
    let places: Vec<Place> = points.iter().map(|point| point.place).collect();
    let round = least_squares(&places).ok_or_else(|| "the readings make no circle".to_owned())?;
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

/// The source of all figures here.
const SOURCE: &str = "ISO 230-4";

fn figures(traces: &[Trace], pairs: &[Pair]) -> Vec<Figure> {
    let of = |sense: Sense| traces.iter().filter(move |trace| trace.sense == sense).collect::<Vec<&Trace>>();
    let (ccw, cw) = (of(Sense::Counterclockwise), of(Sense::Clockwise));
    let all: Vec<&Trace> = traces.iter().collect();
    let circular = |figures: &TraceFigures| figures.circular;
    let squares = |figures: &TraceFigures| figures.circular_least_squares;
    vec![
        one_way(
            "G_CCW",
            "circular deviation, counterclockwise",
            &ccw,
            "counterclockwise",
            f64::max,
            circular,
        ),
        one_way("G_CW", "circular deviation, clockwise", &cw, "clockwise", f64::max, circular),
        both_ways("G_b", "bidirectional circular deviation", pairs, traces, |pair| pair.circular),
        one_way(
            "G_CCW_LS",
            "circular deviation by least squares, counterclockwise",
            &ccw,
            "counterclockwise",
            f64::max,
            squares,
        ),
        one_way(
            "G_CW_LS",
            "circular deviation by least squares, clockwise",
            &cw,
            "clockwise",
            f64::max,
            squares,
        ),
        both_ways("G_b_LS", "bidirectional circular deviation by least squares", pairs, traces, |pair| {
            pair.circular_least_squares
        }),
        one_way("F_max", "greatest radial deviation", &all, "", f64::max, |figures| figures.radial[0]),
        one_way("F_min", "least radial deviation", &all, "", f64::min, |figures| figures.radial[1]),
        set_up_figure(
            "F_max_set_up",
            "greatest radial deviation about the centre as set up",
            traces,
            f64::max,
            0,
        ),
        set_up_figure(
            "F_min_set_up",
            "least radial deviation about the centre as set up",
            traces,
            f64::min,
            1,
        ),
        both_ways("D", "mean bidirectional radial deviation", pairs, traces, |pair| pair.radius),
    ]
}

/// The greatest or least of some traces; where one of them has no figures, of the others.
fn one_way(
    symbol: &'static str,
    name: &'static str,
    traces: &[&Trace],
    sense: &str,
    choose: fn(f64, f64) -> f64,
    value: impl Fn(&TraceFigures) -> f64,
) -> Figure {
    let good: Vec<(&TraceFigures, usize)> =
        traces.iter().filter_map(|trace| Some((trace.figures.as_ref().ok()?, trace.points.len()))).collect();
    let rests =
        Rests { targets: None, readings: good.iter().map(|(_, count)| count).sum(), runs: [good.len(); 2] };
    let value = good.iter().map(|(figures, _)| value(figures)).reduce(choose);
    let value = value.ok_or_else(|| no_trace(traces, sense));
    Figure { symbol, name, source: SOURCE, value: Given::from(value), unit: Unit::Length, rests }
}

/// The greatest or least of all traces about the centre as set up.
fn set_up_figure(
    symbol: &'static str,
    name: &'static str,
    traces: &[Trace],
    choose: fn(f64, f64) -> f64,
    part: usize,
) -> Figure {
    let good: Vec<(f64, usize)> = traces
        .iter()
        .filter_map(|trace| Some((*trace.set_up.as_ref().ok()?.get(part)?, trace.points.len())))
        .collect();
    let rests =
        Rests { targets: None, readings: good.iter().map(|(_, count)| count).sum(), runs: [good.len(); 2] };
    let reason = || traces.iter().find_map(|trace| trace.set_up.clone().err()).unwrap_or_default();
    let value = good.iter().map(|(value, _)| *value).reduce(choose).ok_or_else(reason);
    Figure { symbol, name, source: SOURCE, value: Given::from(value), unit: Unit::Length, rests }
}

fn no_trace(traces: &[&Trace], sense: &str) -> String {
    match traces.first().map(|trace| &trace.figures) {
        Some(Err(reason)) => reason.clone(),
        _ => format!("the circle was not driven {sense}"),
    }
}

/// What both senses give together: of several pairs the one of the greatest size; D is the mean of all.
fn both_ways(
    symbol: &'static str,
    name: &'static str,
    pairs: &[Pair],
    traces: &[Trace],
    value: impl Fn(&Pair) -> f64,
) -> Figure {
    let values: Vec<f64> = pairs.iter().map(value).collect();
    let rests = Rests {
        targets: None,
        readings: pairs.iter().map(|pair| pair.readings).sum(),
        runs: [2 * values.len(); 2],
    };
    let value = if values.is_empty() {
        let only = traces.iter().find(|trace| trace.figures.is_ok());
        Err(match only {
            Some(trace) => format!("full circles were driven {} only", trace.sense.name()),
            None => no_trace(&traces.iter().collect::<Vec<&Trace>>(), ""),
        })
    } else if symbol == "D" {
        Ok(values.iter().sum::<f64>() / number(values.len()))
    } else {
        Ok(values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    };
    Figure { symbol, name, source: SOURCE, value: Given::from(value), unit: Unit::Length, rests }
}
