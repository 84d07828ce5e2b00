//! The pictures of an evaluation. In: lines and circles. Out: drawings in the way in which the standards draw them.

use std::f64::consts::PI;

use pages::plot::{
    Axis, Cartesian, Draw, Look, MOST_MARKS, Plot, Polar, Series, Tone, Trace as PolarTrace, thin,
};

use super::shown::Shown;
use super::words;
use crate::circular::{Circle, Sense, Trace};
use crate::diagonals;
use crate::figure::{Figure, Unit};
use crate::iso230_2::{Side, Target, TargetFigures};
use crate::positioning::Positioning;

/// So many traces of one sense can be told apart in one picture.
const TRACES: usize = 2;

/// A picture and what is to be seen in it.
pub(super) struct Picture {
    pub(super) drawing: String,
    pub(super) caption: String,
}

/// The diagram of ISO 230-2, and what turns with the direction at each target.
pub(super) fn positioning(line: &Positioning) -> Vec<Picture> {
    let mut all = vec![deviations(line)];
    if line.targets.iter().any(|target| target.reversal().is_some()) {
        all.push(reversals(line));
    }
    all
}

/// Deviations at the targets by direction, with means and bands.
fn deviations(line: &Positioning) -> Picture {
    let readings = |of: fn(&Target) -> &Vec<f64>| {
        let points = line.readings.iter().flat_map(|one| of(one).iter().map(|value| (one.position, *value)));
        points.collect::<Vec<_>>()
    };
    let curve = |value: &dyn Fn(&TargetFigures) -> Option<f64>| {
        counted(line).map(|target| (target.position, value(target).unwrap_or(f64::NAN))).collect::<Vec<_>>()
    };
    let side = |up: bool, edge: f64| {
        curve(&|target: &TargetFigures| {
            let side: Side = if up { target.up? } else { target.down? };
            if edge == 0.0 { Some(side.mean) } else { Some(side.mean + edge * side.s?) }
        })
    };
    let mut plot = Cartesian::new("Deviation from target", along(line), deviation("deviation", line.unit))
        .subtitle(&sizes(&line.figures, &["A", "E", "R", "B"]))
        .sized(480.0, 300.0);
    for (up, name, mean, band) in [(true, "up", 0, 6), (false, "down", 1, 7)] {
        let values = readings(if up { |target| &target.up } else { |target| &target.down });
        if values.is_empty() {
            continue;
        }
        plot = add(plot, &format!("{name}: readings"), Look::of(mean), Draw::Marks, values);
        plot = add(plot, &format!("{name}: mean"), Look::of(mean), Draw::Line, side(up, 0.0));
        plot = add(plot, &format!("{name}: mean \u{b1} 2 s"), Look::of(band), Draw::Line, side(up, 2.0));
        plot = add(plot, "", Look::of(band), Draw::Line, side(up, -2.0));
    }
    plot = add(plot, "mean of both", Look::of(4), Draw::Line, curve(&TargetFigures::mean));
    Picture {
        drawing: plot.draw().inline(),
        caption: "Up: approached in the positive direction; down: in the negative direction. The distance between the two means \
                  is the reversal value. A is the height from the lowest to the highest edge of the bands."
            .to_owned(),
    }
}

/// The targets that count.
fn counted(line: &Positioning) -> impl Iterator<Item = &TargetFigures> {
    line.targets.iter().filter(|target| !line.left_out.contains(&target.position))
}

fn reversals(line: &Positioning) -> Picture {
    let curve = |value: &dyn Fn(&TargetFigures) -> Option<f64>| {
        let points = counted(line).map(|target| (target.position, value(target).unwrap_or(f64::NAN)));
        points.filter(|point| point.1.is_finite()).collect::<Vec<_>>()
    };
    let axis = deviation("size", line.unit).reaching(0.0);
    let mut plot = Cartesian::new("Reversal and repeatability at each target", along(line), axis)
        .subtitle(&sizes(&line.figures, &["B", "B_mean", "R_up", "R_down"]));
    let up = |target: &TargetFigures| target.up?.repeatability();
    let down = |target: &TargetFigures| target.down?.repeatability();
    plot = add(plot, "reversal B", Look::of(4), Draw::MarkedLine, curve(&TargetFigures::reversal));
    plot = add(plot, "repeatability up, 4 s", Look::of(0), Draw::MarkedLine, curve(&up));
    plot = add(plot, "repeatability down, 4 s", Look::of(1), Draw::MarkedLine, curve(&down));
    Picture {
        drawing: plot.draw().inline(),
        caption: "A reversal value that is the same everywhere is backlash or friction. A reversal value that changes along the \
                  travel comes from wear, or from an angle that changes with the direction."
            .to_owned(),
    }
}

/// The mean bidirectional deviation of all diagonals in one picture.
pub(super) fn diagonals(lines: &[&Positioning]) -> Option<Picture> {
    let first = lines.first()?;
    let mut plot = Cartesian::new(
        "Mean deviation along each diagonal",
        Axis::new("place along the diagonal", first.unit.name()),
        deviation("deviation", first.unit),
    );
    for (number, line) in lines.iter().enumerate() {
        let points = line.targets.iter().filter_map(|target| Some((target.position, target.mean()?)));
        plot = add(plot, &diagonals::name(line), Look::of(number), Draw::MarkedLine, points.collect());
    }
    Some(Picture {
        drawing: plot.draw().inline(),
        caption: "Slopes that differ from diagonal to diagonal show angles between the axes. A slope common to all diagonals \
                  shows scales."
            .to_owned(),
    })
}

/// Both senses of a circle, around and unrolled.
pub(super) fn circle(circle: &Circle) -> Vec<Picture> {
    let shown = traces(circle);
    if shown.is_empty() {
        return Vec::new();
    }
    let nominal = shown.iter().any(|trace| trace.figures.is_err());
    let center = if nominal { "nominal centre of each arc" } else { "least-squares centre of each trace" };
    let [first, second] = words::directions(circle);
    let told = match circle.traces.len() - shown.len() {
        0 => sizes(&circle.figures, &["G_CCW", "G_CW", "G_b", "D"]),
        _ => format!("of {} traces, the first and the last of each sense are shown", circle.traces.len()),
    };
    let around = [format!("+{first}"), format!("+{second}")];
    let title = format!("Radial deviation about the {center}");
    let mut polar =
        Polar::new(&title, around.each_ref().map(String::as_str), circle.radius, "mm").subtitle(&told);
    let mut unrolled = Cartesian::new(
        "Radial deviation over the angle",
        Axis::new(&format!("angle from +{first} towards +{second}"), "rad").reaching(0.0).reaching(2.0 * PI),
        deviation("radial deviation", Unit::Length),
    )
    .sized(480.0, 300.0);
    for (number, trace) in shown.iter().enumerate() {
        let tone = if trace.sense == Sense::Counterclockwise { Tone::One } else { Tone::Two };
        let (name, look) = (trace_name(trace), Look::of(number).toned(tone));
        let points = points(trace);
        unrolled = unrolled.series(Series::new(&name, look, Draw::Line, broken(&points)));
        polar = polar.trace(PolarTrace { name, look, draw: Draw::Line, points });
    }
    vec![
        Picture {
            drawing: polar.draw().inline(),
            caption: "An ellipse along the axes shows scales. An ellipse along a diagonal shows squareness if it is the same in \
                      both senses, and unequal position loops if it rotates with the sense. A step where an axis reverses, with \
                      the opposite sign in the other sense, is backlash or friction."
                .to_owned(),
        },
        Picture {
            drawing: unrolled.draw().inline(),
            caption: "At 0\u{b0}, 90\u{b0}, 180\u{b0} and 270\u{b0} one of the axes reverses.".to_owned(),
        },
    ]
}

/// The traces that are drawn: all, or the first and the last of each sense.
fn traces(circle: &Circle) -> Vec<&Trace> {
    if circle.traces.len() <= 2 * TRACES {
        return circle.traces.iter().filter(|trace| !trace.points.is_empty()).collect();
    }
    let of = |sense: Sense| {
        let mut all =
            circle.traces.iter().filter(move |trace| trace.sense == sense && !trace.points.is_empty());
        let first = all.next();
        first.into_iter().chain(all.next_back())
    };
    of(Sense::Counterclockwise).chain(of(Sense::Clockwise)).collect()
}

fn trace_name(trace: &Trace) -> String {
    format!("{}, run {}", trace.sense.name(), trace.run)
}

/// Angles and radial deviations, thinned.
fn points(trace: &Trace) -> Vec<(f64, f64)> {
    thinned(trace.points.iter().map(|point| (point.angle, point.radial)).collect())
}

/// With a gap where a line would run back across the whole plot.
fn broken(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut all = Vec::with_capacity(points.len() + 2);
    let mut last: Option<f64> = None;
    for (angle, radial) in points {
        if last.is_some_and(|last| (last - angle).abs() > PI) {
            all.push((f64::NAN, f64::NAN));
        }
        all.push((*angle, *radial));
        last = Some(*angle);
    }
    all
}

fn thinned(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let values: Vec<f64> = points.iter().map(|point| point.1).collect();
    let rows = thin::extremes(&values, MOST_MARKS);
    rows.into_iter().filter_map(|row| points.get(row).copied()).collect()
}

fn add(plot: Cartesian, name: &str, look: Look, draw: Draw, points: Vec<(f64, f64)>) -> Cartesian {
    if points.iter().any(|point| point.1.is_finite()) {
        plot.series(Series::new(name, look, draw, thinned(points)))
    } else {
        plot
    }
}

fn along(line: &Positioning) -> Axis {
    let what = match line.axes.as_slice() {
        [axis] => format!("position of {axis}"),
        _ => "place along the diagonal".to_owned(),
    };
    Axis::new(&what, line.unit.name())
}

fn deviation(what: &str, unit: Unit) -> Axis {
    Axis::new(what, unit.name())
}

/// Some figures in a line, those that there are.
fn sizes(figures: &[Figure], symbols: &[&str]) -> String {
    let named = symbols.iter().filter_map(|symbol| figures.iter().find(|figure| figure.symbol == *symbol));
    let shown = Shown::figures(figures);
    let told = named.filter_map(|figure| {
        let value = shown.number(figure.value.number()?);
        Some(format!("{} {value} {}", figure.symbol.replace('_', " "), super::words::unit(shown.unit)))
    });
    told.collect::<Vec<_>>().join(", ")
}
