//! A simulated recording as a picture. In: what was simulated, and the machine. Out: one drawing: the path in the planes of the
//! slides, and what the instrument reads over time.
//!
//! Positions are shown as errors: what is measured minus where the tool would stand by the command.

use model_dsl::calibration::AxisName;
use pages::plot::{Axis, Cartesian, Draw, Look, MOST_MARKS, Plot, Series, panels, style, thin};

use crate::instrument::Channel;
use crate::plant::Plant;
use crate::simulate::{Reading, Simulated, channel_name};

/// A picture in a path's plane has at least this part of its longer side as its shorter one.
const NARROWEST: f64 = 0.2;

/// The drawing as a file of its own: SVG.
pub fn svg(simulated: &Simulated, plant: &Plant) -> String {
    let axes = &plant.names().axes;
    let mut plots = slices(simulated, axes);
    plots.extend(simulated.readings.iter().map(|reading| over_time(simulated, plant, reading)));
    let plots: Vec<&dyn Plot> = plots.iter().map(|plot| -> &dyn Plot { plot }).collect();
    let title = simulated.title.clone().unwrap_or_else(|| plant.names().machine.clone());
    panels(&title, &plots, 3).file(&style())
}

/// The path in each plane of two slides of which one moves; of the slide alone where there is but one.
fn slices(simulated: &Simulated, axes: &[AxisName]) -> Vec<Cartesian> {
    let slides: Vec<(&str, &[f64])> = axes
        .iter()
        .zip(&simulated.commands)
        .filter(|(axis, _)| !axis.rotary)
        .map(|(axis, column)| (axis.letter.as_str(), column.as_slice()))
        .collect();
    let moves = |column: &[f64]| extent(column).is_some_and(|(low, high)| high > low);
    let mut plots = Vec::new();
    for (number, one) in slides.iter().enumerate() {
        let others = slides.iter().skip(number + 1).filter(|other| moves(one.1) || moves(other.1));
        plots.extend(others.map(|other| slice(&simulated.run, *one, *other)));
    }
    let turning = axes.iter().zip(&simulated.commands).filter(|(axis, column)| axis.rotary && moves(column));
    let alone: Vec<_> = slides.iter().filter(|slide| slides.len() == 1 && moves(slide.1)).collect();
    plots.extend(alone.iter().map(|(letter, column)| along(simulated, letter, column, "mm")));
    plots.extend(turning.map(|(axis, column)| along(simulated, &axis.letter, column, "rad")));
    plots
}

/// Two slides against each other, alike in scale; runs are apart.
fn slice(run: &[i64], (one, x): (&str, &[f64]), (other, y): (&str, &[f64])) -> Cartesian {
    let step = x.len().div_ceil(MOST_MARKS).max(1);
    let mut points = Vec::new();
    let mut last = None;
    for (row, ((x, y), run)) in x.iter().zip(y).zip(run).enumerate().filter(|(row, _)| row % step == 0) {
        if row > 0 && last != Some(run) {
            points.push((f64::NAN, f64::NAN));
        }
        last = Some(run);
        points.push((*x, *y));
    }
    let [(a, b), (c, d)] = wide_enough(extent(x), extent(y));
    let title = format!("Path in {one} and {other}");
    let axis = |letter: &str, low: f64, high: f64| {
        Axis::exactly(&format!("command of {letter}"), "mm").reaching(low).reaching(high)
    };
    let plot = Cartesian::new(&title, axis(one, a, b), axis(other, c, d)).sized(480.0, 300.0).equal();
    let start = points.iter().copied().find(|point| point.0.is_finite()).into_iter().collect();
    plot.series(Series::new("", Look::of(0), Draw::Line, points)).series(Series::new(
        "start",
        Look::of(1),
        Draw::Marks,
        start,
    ))
}

/// One axis over time.
fn along(simulated: &Simulated, letter: &str, column: &[f64], unit: &str) -> Cartesian {
    let axis = Axis::new(&format!("command of {letter}"), unit);
    let plot = Cartesian::new(&format!("Path of {letter}"), Axis::new("time", "s"), axis).sized(480.0, 300.0);
    plot.series(Series::new("", Look::of(0), Draw::Line, thinned(&simulated.time, column)))
}

/// What a channel reads, with noise and without it where that is another thing.
fn over_time(simulated: &Simulated, plant: &Plant, reading: &Reading) -> Cartesian {
    let axes = &plant.names().axes;
    let name = channel_name(reading.channel, axes);
    let (title, unit) = match reading.channel {
        Channel::Measured(_) => (format!("{name} minus its nominal position"), "mm"),
        Channel::Angle(_) => (format!("{name} minus its command"), "rad"),
        Channel::Deviation if simulated.instrument.angular() => (name, "rad"),
        Channel::Deviation => (name, "mm"),
    };
    let nominal = nominal(simulated, plant, reading.channel);
    let error = |values: &[f64]| -> Vec<f64> {
        values.iter().zip(&nominal).map(|(value, nominal)| value - nominal).collect()
    };
    let (noisy, clean) = (error(&reading.values), error(&reading.clean));
    let shown = thinned(&simulated.time, &noisy);
    let told = thin::told(shown.len(), simulated.time.len()).unwrap_or_default();
    let axis = Axis::new("reading", unit);
    let mut plot = Cartesian::new(&title, Axis::new("time", "s"), axis).subtitle(&told).sized(480.0, 300.0);
    if reading.values == reading.clean {
        return plot.series(Series::new("", Look::of(0), Draw::Line, shown));
    }
    plot = plot.series(Series::new("as read", Look::of(0), Draw::Line, shown));
    plot.series(Series::new("without noise", Look::of(1), Draw::Line, thinned(&simulated.time, &clean)))
}

/// What an instrument that reads places would read of a machine without errors; zero for one that reads deviations.
fn nominal(simulated: &Simulated, plant: &Plant, channel: Channel) -> Vec<f64> {
    let rows = simulated.time.len();
    let command = |row: usize| -> Vec<f64> {
        simulated.commands.iter().map(|column| column.get(row).copied().unwrap_or(f64::NAN)).collect()
    };
    match channel {
        Channel::Measured(direction) => {
            let tip = |row| plant.nominal(&command(row)).tip.get(direction).copied().unwrap_or(f64::NAN);
            (0..rows).map(tip).collect()
        }
        Channel::Angle(axis) => simulated.commands.get(axis).cloned().unwrap_or_default(),
        Channel::Deviation => vec![0.0; rows],
    }
}

fn thinned(time: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    let rows = thin::extremes(values, MOST_MARKS).into_iter();
    rows.filter_map(|row| Some((*time.get(row)?, *values.get(row)?))).collect()
}

fn extent(column: &[f64]) -> Option<(f64, f64)> {
    let finite = || column.iter().copied().filter(|value| value.is_finite());
    Some((finite().reduce(f64::min)?, finite().reduce(f64::max)?))
}

/// Both stretches, the shorter one widened around its middle.
fn wide_enough(x: Option<(f64, f64)>, y: Option<(f64, f64)>) -> [(f64, f64); 2] {
    let both = [x.unwrap_or_default(), y.unwrap_or_default()];
    let longest = both.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    both.map(|(low, high)| {
        let more = (NARROWEST * longest - (high - low)).max(0.0) / 2.0;
        (low - more, high + more)
    })
}
