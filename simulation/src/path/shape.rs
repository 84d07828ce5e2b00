//! Shapes: the geometry of a path, run by run as a list of legs.

use std::f64::consts::{PI, TAU};

use super::leg::Leg;

/// The geometry of a path. Axes go by number; angles of a plane count from its first axis to its second.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Straight from one point to another, with one axis or with several at once: a diagonal.
    Line {
        /// What moves.
        strokes: Vec<Stroke>,
        /// Whether it comes back.
        back: bool,
        /// How far it goes beyond both ends, so that the ends are approached like the rest: mm or rad along the path.
        overrun: f64,
        /// Where it stops to be read; read on the fly where there are none.
        stations: Option<Stations>,
    },
    /// Circles around the place where the axes stand.
    Circle {
        /// The two axes.
        plane: [usize; 2],
        /// mm.
        radius: f64,
        /// The angle at which the first circle begins, rad.
        start: f64,
        /// How far each circle goes beyond both its ends, rad.
        overshoot: f64,
        /// One circle for each entry: true is counter-clockwise, from the first axis to the second.
        counterclockwise: Vec<bool>,
    },
    /// A square on its corner around the place where the axes stand, both ways.
    Diamond {
        /// The two axes.
        plane: [usize; 2],
        /// From the centre to the corners, mm.
        radius: f64,
    },
    /// Lines to and fro along the first axis, stepping along the second, and back the same way.
    Grid {
        /// The two axes.
        plane: [usize; 2],
        /// One corner.
        from: [f64; 2],
        /// The opposite corner.
        to: [f64; 2],
        /// How many lines.
        lines: u32,
    },
    /// A spiral around the place where the axes stand, outwards and back. The feed is that around the centre.
    Spiral {
        /// The two axes.
        plane: [usize; 2],
        /// The radius at which it begins, mm.
        inner: f64,
        /// The radius at which it ends, mm.
        outer: f64,
        /// How many turns.
        turns: f64,
    },
    /// Straight from point to point; an axis that a point does not name stays.
    Points(Vec<Vec<(usize, f64)>>),
    /// At rest.
    Still {
        /// How long, s.
        time: f64,
    },
}

/// The motion of one axis along a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// The axis.
    pub axis: usize,
    /// Where it begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
}

/// Stops along a line, evenly spaced, both ends among them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stations {
    /// How many; at least two.
    pub count: u32,
    /// How long each lasts, s.
    pub dwell: f64,
    /// How often it is read meanwhile, evenly, the last time at the end; at least once.
    pub readings: u32,
}

impl Shape {
    /// The axes that it names.
    pub(super) fn axes(&self) -> Vec<usize> {
        match self {
            Self::Line { strokes, .. } => strokes.iter().map(|stroke| stroke.axis).collect(),
            Self::Circle { plane, .. }
            | Self::Diamond { plane, .. }
            | Self::Grid { plane, .. }
            | Self::Spiral { plane, .. } => plane.to_vec(),
            Self::Points(points) => points.iter().flatten().map(|(axis, _)| *axis).collect(),
            Self::Still { .. } => Vec::new(),
        }
    }

    /// The legs of one run from where the axes stand; `rotary` tells which axes turn.
    pub(super) fn legs(&self, base: &[f64], rotary: &[bool]) -> Vec<Leg> {
        match self {
            Self::Line { strokes, back, overrun, stations } => {
                line(base, rotary, strokes, *back, *overrun, *stations)
            }
            Self::Circle { plane, radius, start, overshoot, counterclockwise } => circles(
                base,
                *plane,
                *radius,
                start - direction(counterclockwise) * overshoot,
                *overshoot,
                counterclockwise,
            ),
            Self::Diamond { plane, radius } => {
                let corner = |quarter: u32| {
                    let angle = 0.5 * PI * f64::from(quarter);
                    moved(base, *plane, [radius * angle.cos(), radius * angle.sin()], true)
                };
                let corners = (0..=4).chain((0..4).rev()).map(corner).collect();
                polyline(corners, rotary)
            }
            Self::Grid { plane, from, to, lines } => polyline(grid(base, *plane, *from, *to, *lines), rotary),
            Self::Spiral { plane, inner, outer, turns } => {
                let arc = |radii, angles| Leg::Arc { base: base.to_vec(), plane: *plane, radii, angles };
                let end = TAU * turns;
                vec![arc([*inner, *outer], [0.0, end]), arc([*outer, *inner], [end, 0.0])]
            }
            Self::Points(points) => {
                let mut place = base.to_vec();
                let points = points.iter().map(|point| {
                    point.iter().for_each(|(axis, position)| set(&mut place, *axis, *position));
                    place.clone()
                });
                polyline(points.collect(), rotary)
            }
            Self::Still { time } => vec![Leg::Rest { at: base.to_vec(), time: *time, readings: 0 }],
        }
    }
}

fn direction(counterclockwise: &[bool]) -> f64 {
    if counterclockwise.first() == Some(&false) { -1.0 } else { 1.0 }
}

fn set(place: &mut [f64], axis: usize, position: f64) {
    if let Some(slot) = place.get_mut(axis) {
        *slot = position;
    }
}

/// A place with two of its positions replaced, or added to.
fn moved(base: &[f64], plane: [usize; 2], to: [f64; 2], add: bool) -> Vec<f64> {
    let mut place = base.to_vec();
    for (axis, position) in plane.into_iter().zip(to) {
        let before = if add { base.get(axis).copied().unwrap_or(0.0) } else { 0.0 };
        set(&mut place, axis, before + position);
    }
    place
}

/// Circle after circle without a jump: a circle that keeps the direction goes on where the last one ended.
fn circles(
    base: &[f64],
    plane: [usize; 2],
    radius: f64,
    start: f64,
    overshoot: f64,
    counterclockwise: &[bool],
) -> Vec<Leg> {
    let mut angle = start;
    let arcs = counterclockwise.iter().map(|positive| {
        let from = angle;
        angle += if *positive { TAU + 2.0 * overshoot } else { -TAU - 2.0 * overshoot };
        Leg::Arc { base: base.to_vec(), plane, radii: [radius; 2], angles: [from, angle] }
    });
    arcs.collect()
}

fn grid(base: &[f64], plane: [usize; 2], from: [f64; 2], to: [f64; 2], lines: u32) -> Vec<Vec<f64>> {
    let mut corners = Vec::new();
    let gaps = f64::from(lines.saturating_sub(1).max(1));
    for line in 0..lines {
        let across = from[1] + (to[1] - from[1]) * f64::from(line) / gaps;
        let ends = if line % 2 == 0 { [from[0], to[0]] } else { [to[0], from[0]] };
        corners.extend(ends.map(|along| moved(base, plane, [along, across], false)));
    }
    let back: Vec<_> = corners.iter().rev().skip(1).cloned().collect();
    corners.extend(back);
    corners
}

fn polyline(corners: Vec<Vec<f64>>, rotary: &[bool]) -> Vec<Leg> {
    let legs = corners.windows(2).filter_map(|pair| match pair {
        [from, to] => Some(straight(from, to, rotary)),
        _ => None,
    });
    legs.filter(|leg| leg.length() > 0.0).collect()
}

/// The length counts slides; only where none moves it counts angles.
fn straight(from: &[f64], to: &[f64], rotary: &[bool]) -> Leg {
    let way = |turns: bool| {
        let steps = from.iter().zip(to).zip(rotary).filter(|(_, rotary)| **rotary == turns);
        steps.map(|((from, to), _)| (to - from) * (to - from)).sum::<f64>().sqrt()
    };
    let slides = way(false);
    let length = if slides > 0.0 { slides } else { way(true) };
    Leg::Straight { from: from.to_vec(), to: to.to_vec(), length }
}

fn line(
    base: &[f64],
    rotary: &[bool],
    strokes: &[Stroke],
    back: bool,
    overrun: f64,
    stations: Option<Stations>,
) -> Vec<Leg> {
    let point = |share: f64| {
        let mut place = base.to_vec();
        let at = |stroke: &Stroke| stroke.from * (1.0 - share) + stroke.to * share;
        strokes.iter().for_each(|stroke| set(&mut place, stroke.axis, at(stroke)));
        place
    };
    let length = straight(&point(0.0), &point(1.0), rotary).length();
    let beyond = if length > 0.0 { overrun / length } else { 0.0 };
    let Some(stations) = stations else {
        let ends = [-beyond, 1.0 + beyond, -beyond];
        let ends = ends.iter().take(if back { 3 } else { 2 });
        return polyline(ends.map(|share| point(*share)).collect(), rotary);
    };
    let gaps = f64::from(stations.count.saturating_sub(1).max(1));
    let shares = (0..stations.count).map(|station| f64::from(station) / gaps);
    let there: Vec<f64> = shares.collect();
    let mut stops: Vec<(f64, bool)> = vec![(-beyond, false)];
    stops.extend(there.iter().map(|share| (*share, true)));
    stops.push((1.0 + beyond, false));
    if back {
        stops.extend(there.iter().rev().map(|share| (*share, true)));
        stops.push((-beyond, false));
    }
    let mut legs = Vec::new();
    let mut before: Option<Vec<f64>> = None;
    for (share, read) in stops {
        let place = point(share);
        let travel = before.as_ref().map(|before| straight(before, &place, rotary));
        legs.extend(travel.filter(|leg| leg.length() > 0.0));
        if read {
            let at = place.clone();
            legs.push(Leg::Rest { at, time: stations.dwell, readings: stations.readings.max(1) });
        }
        before = Some(place);
    }
    legs
}
