//! Over time, runs, velocity, temperature and load. In: the samples of a channel. Out: what is left before and after against each.

use pages::plot::{Axis, Cartesian, Draw, Series};

use super::{Captions, Figure, marked, outlying, residual, sides};
use crate::pictures::{AxisTrack, ChannelPicture, RunMean, Track};

const TIME: &str =
    "Over time: a slow change is heat, a settling fixture or a wandering sensor; a jump is an event.";
const RUNS: &str = "The mean of each run: runs in the same state should agree.";
const VELOCITY: &str = "Against velocity: a slope is a following error or a clock offset.";
const TEMPERATURE: &str = "Against temperature: an error that follows a sensor can be compensated with it.";
const LOAD: &str = "Against load: a slope is compliance.";

pub(super) fn figures(channel: &ChannelPicture, captions: &mut Captions) -> Vec<Figure> {
    let mut figures = vec![time(channel, captions)];
    if channel.runs.len() > 1 {
        figures.push(Figure::new(over_runs(channel), captions.once(RUNS)));
    }
    for axis in channel.shown.axes.iter().filter(|axis| varied(axis)).take(AXES) {
        let unit = if axis.unit == "mm" { "mm/s" } else { "rad/s" };
        let name = format!("velocity of {}", axis.letter);
        figures.push(Figure::new(over(channel, &name, unit, &axis.velocity), captions.once(VELOCITY)));
    }
    let tracks =
        [(&channel.shown.temperatures, "temperature", TEMPERATURE), (&channel.shown.loads, "load", LOAD)];
    for (tracks, what, caption) in tracks {
        let drawn =
            |Track { name, unit, values }: &Track| over(channel, &format!("{what} {name}"), unit, values);
        figures.extend(tracks.iter().map(|track| Figure::new(drawn(track), captions.once(caption))));
    }
    figures
}

/// Over time alone.
pub(super) fn time(channel: &ChannelPicture, captions: &mut Captions) -> Figure {
    Figure::new(over_time(channel), captions.once(TIME))
}

/// The most axes whose velocity is drawn.
const AXES: usize = 3;

/// Velocities are put into classes of a tenth of the fastest.
const CLASSES: f64 = 10.0;
/// Standing still and one feed to and fro are three classes. Each feed may fall on the edge of two, which makes six.
const STEADY: usize = 6;

/// Whether an axis moves at more velocities than standing still and one feed forwards and backwards.
fn varied(axis: &AxisTrack) -> bool {
    let fastest =
        axis.velocity.iter().filter(|speed| speed.is_finite()).fold(0.0_f64, |most, v| most.max(v.abs()));
    let class = |speed: &f64| crate::index((CLASSES * (speed / fastest + 1.0)).round());
    let mut classes: Vec<usize> = axis.velocity.iter().filter_map(class).collect();
    classes.sort_unstable();
    classes.dedup();
    classes.len() > STEADY
}

/// How far before and after reach together.
fn reach(channel: &ChannelPicture) -> f64 {
    channel.reach.0.max(channel.reach.1)
}

/// Before and after against a state.
fn over(channel: &ChannelPicture, name: &str, unit: &str, values: &[f64]) -> Cartesian {
    let title = format!("{}, by {name}", what(channel));
    let plot = Cartesian::new(&title, Axis::new(name, unit), residual(channel, reach(channel)));
    both(channel, values).into_iter().fold(plot, Cartesian::series)
}

/// What is drawn.
fn what(channel: &ChannelPicture) -> &'static str {
    if channel.unchanged { "Residual" } else { "Before and after" }
}

/// The residual before and after against a state, without outliers: a series of the fitted samples and one of the held-out samples each.
fn both(channel: &ChannelPicture, values: &[f64]) -> Vec<Series> {
    let shown = &channel.shown;
    let rows = || (0..shown.time.len()).filter(|row| !shown.outlier[*row]);
    let of = |residual: &'_ [f64]| -> Vec<((f64, f64), bool)> {
        rows().map(|row| ((values[row], residual[row]), shown.held_out[row])).collect()
    };
    let sides = sides(channel).into_iter();
    sides
        .flat_map(|side| marked(side.name, side.look, of(side.of(&shown.before, &shown.after)).into_iter()))
        .collect()
}

fn over_time(channel: &ChannelPicture) -> Cartesian {
    let shown = &channel.shown;
    let plot = Cartesian::new(
        &format!("{}, over time", what(channel)),
        Axis::new("time", "s"),
        residual(channel, reach(channel)),
    );
    let plot = both(channel, &shown.time).into_iter().fold(plot, Cartesian::series);
    // Outliers that would press all others together are told as a number only.
    let near = |row: usize| shown.before[row].abs() < reach(channel);
    let outliers = (0..shown.time.len()).filter(|row| shown.outlier[*row] && near(*row));
    let points: Vec<(f64, f64)> = outliers.map(|row| (shown.time[row], shown.before[row])).collect();
    if points.is_empty() {
        plot
    } else {
        plot.series(Series::new("outliers", outlying(), Draw::Marks, points))
    }
}

fn over_runs(channel: &ChannelPicture) -> Cartesian {
    let number = |run: &RunMean| f64::from(i32::try_from(run.run).unwrap_or(i32::MAX));
    let plot = Cartesian::new(
        "Mean of each run",
        Axis::exactly("run", "").counted(),
        Axis::new("mean residual", channel.unit),
    );
    sides(channel).into_iter().fold(plot, |plot, side| {
        let mean = |run: &RunMean| if side.after { run.mean.1 } else { run.mean.0 };
        let points = || channel.runs.iter().map(|run| ((number(run), mean(run)), run.held_out));
        let line = Series::new("", side.look, Draw::Line, points().map(|(point, _)| point).collect());
        marked(side.name, side.look, points()).into_iter().fold(plot.series(line), Cartesian::series)
    })
}
