//! By position. In: the samples of a channel. Out: for each axis that moves what is left before and after against its
//! position, by the direction of motion.

use pages::plot::{Axis, Band, Cartesian, Look};

use super::{Captions, Figure, marked, residual};
use crate::diagnosis::{Diagnosis, Interval, IntervalOf};
use crate::pictures::{AxisTrack, ChannelPicture, Samples};

/// The most axes that are drawn of a channel.
const AXES: usize = 3;

const BEFORE: &str = "The residuals of the known calibration, with its zeros fitted. A distance between the two directions is \
     backlash, friction or following error. A slope is a scale error or an angle; a wave comes from a screw or an encoder.";
const AFTER: &str = "What the findings leave, on a scale of its own. Residuals should show no form.";

pub(super) fn figures(
    diagnosis: &Diagnosis,
    channel: &ChannelPicture,
    captions: &mut Captions,
) -> Vec<Figure> {
    let mut figures = Vec::new();
    for axis in channel.shown.axes.iter().take(AXES) {
        let bands = bands(diagnosis, channel, axis);
        let plot = |title: &str, values: &[f64], reach: f64| {
            let title = format!("{title}, by position of {}", axis.letter);
            let position = Axis::new(&format!("position of {}", axis.letter), axis.unit);
            let plot = Cartesian::new(&title, position, residual(channel, reach));
            let plot = bands.iter().cloned().fold(plot, Cartesian::band);
            let forward = series(&channel.shown, axis, values, true);
            forward.chain(series(&channel.shown, axis, values, false)).fold(plot, Cartesian::series)
        };
        if !channel.unchanged {
            let plot = plot("Before", &channel.shown.before, channel.reach.0);
            figures.push(Figure::new(plot, captions.once(BEFORE)));
        }
        let (title, caption) = if channel.unchanged { ("Residual", BEFORE) } else { ("After", AFTER) };
        let plot = plot(title, &channel.shown.after, channel.reach.1);
        figures.push(Figure::new(plot, captions.once(caption)));
    }
    figures
}

fn series(
    shown: &Samples,
    axis: &AxisTrack,
    values: &[f64],
    forward: bool,
) -> impl Iterator<Item = pages::plot::Series> {
    let rows =
        (0..shown.time.len()).filter(|row| !shown.outlier[*row] && (axis.direction[*row] > 0.0) == forward);
    let points = rows.map(|row| ((axis.position[row], values[row]), shown.held_out[row]));
    let (name, look) =
        if forward { ("moving to +", Look::of(0)) } else { ("moving to \u{2212}", Look::of(1)) };
    marked(&format!("{name}{}", axis.letter), look, points).into_iter()
}

/// Stretches of this axis to which something is confined.
fn bands(diagnosis: &Diagnosis, channel: &ChannelPicture, axis: &AxisTrack) -> Vec<Band> {
    let band = |interval: &Interval, label: &str| {
        let factor =
            if interval.unit == "deg" && axis.unit == "rad" { std::f64::consts::PI / 180.0 } else { 1.0 };
        let here = matches!(&interval.of, IntervalOf::Axis(letter) if *letter == axis.letter);
        here.then(|| Band::of_x(interval.from * factor, interval.to * factor, label))
    };
    let findings = diagnosis.findings.iter().filter_map(|finding| {
        let interval = finding.location.interval.as_ref()?;
        band(interval, &format!("{} of {}", finding.term, finding.motion))
    });
    let unexplained =
        diagnosis.unexplained.iter().filter(|unexplained| unexplained.direction == channel.name);
    let unexplained =
        unexplained.filter_map(|unexplained| band(unexplained.interval.as_ref()?, "unexplained"));
    findings.chain(unexplained).collect()
}
