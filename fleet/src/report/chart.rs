//! Drawings of series. In: a number of a machine over time. Out: a small drawing for a line of a table, and a plot with axes.

use pages::plot::{Axis, Cartesian, Draw, Line, Look, Plot, Series as Drawn, Tone};
use pages::svg::{Drawing, number};

use crate::history::{Followed, Point};
use crate::series::days;

/// A small drawing: an interval a recording, with a dot where it was found by itself and a ring where it was followed.
const SMALL: (f64, f64) = (168.0, 36.0);

/// What is left free around it.
const EDGE: f64 = 3.0;

/// The most points that are drawn, the last ones: more than there are pixels would be one band.
const MOST: usize = 160;

/// The small drawing; nothing of an empty series.
pub(super) fn small(followed: &Followed) -> Option<String> {
    let points = followed.series.points.get(followed.series.points.len().saturating_sub(MOST)..)?;
    let (first, last) = (points.first()?.days(), points.last()?.days());
    let ends = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
        (low.min(point.low), high.max(point.high))
    });
    let span = |from: f64, to: f64| if to > from { to - from } else { 1.0 };
    let across = |point: &Point| EDGE + (SMALL.0 - 2.0 * EDGE) * (point.days() - first) / span(first, last);
    let up = |value: f64| SMALL.1 - EDGE - (SMALL.1 - 2.0 * EDGE) * (value - ends.0) / span(ends.0, ends.1);
    let title = format!("{} over time", followed.series.name());
    let mut drawing = Drawing::new(SMALL.0, SMALL.1, &title);
    let whiskers: String = points
        .iter()
        .map(|point| {
            format!("M{} {}V{}", number(across(point)), number(up(point.low)), number(up(point.high)))
        })
        .collect();
    drawing.element("path", &[("class", "h cq"), ("d", &whiskers)]);
    let colour = if followed.alarm { "c2" } else { "c1" };
    for point in points {
        let class = format!("{} {colour}", if point.claimed { "m" } else { "h" });
        let (x, y) = (number(across(point)), number(up(point.value)));
        drawing.element("circle", &[("class", &class), ("cx", &x), ("cy", &y), ("r", "1.6")]);
    }
    Some(drawing.inline())
}

/// The plot with axes: weeks since the first recording of the series; the change, where it is no chance.
pub(super) fn plot(followed: &Followed) -> Option<String> {
    let series = &followed.series;
    let (first, last) = (series.points.first()?, series.points.last()?);
    let week = |point: &Point| (point.days() - days(first.time)) / 7.0;
    let marks = |claimed: bool| -> Vec<(f64, f64)> {
        series
            .points
            .iter()
            .filter(|point| point.claimed == claimed)
            .map(|point| (week(point), point.value))
            .collect()
    };
    let gap = (f64::NAN, f64::NAN);
    let intervals: Vec<(f64, f64)> = series
        .points
        .iter()
        .flat_map(|point| [(week(point), point.low), (week(point), point.high), gap])
        .collect();
    let axis = Axis::exactly(&format!("weeks since {}", first.time.day()), "");
    let mut plot = Cartesian::new(&series.name(), axis, Axis::new(&series.parameter, &series.unit))
        .series(Drawn::new("95 % interval", Look::of(0).toned(Tone::Quiet), Draw::Line, intervals))
        .series(Drawn::new("found here", Look::of(0), Draw::Marks, marks(true)))
        .series(Drawn::new("followed", Look::of(2), Draw::Hollow, marks(false)));
    if let Some(change) = series_change(followed) {
        let ends = [(0.0, change.before.0), (week(last), change.after.0)];
        plot = match series.points.get(change.from).filter(|_| change.kind == "step") {
            Some(point) => plot.line(Line::new(week(point), "step")),
            None => plot.series(Drawn::new("trend", Look::of(1), Draw::Line, ends.to_vec())),
        };
    }
    Some(plot.draw().inline())
}

/// The change that there is an alarm about, in the values themselves.
fn series_change(followed: &Followed) -> Option<&crate::Change> {
    followed.change.as_ref().filter(|_| followed.alarm && !followed.series.is_noise())
}
