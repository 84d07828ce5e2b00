//! Spectra. In: amplitudes over frequency and over the period along an axis. Out: plots with the lines that were found.

use pages::plot::{Axis, Band, Cartesian, Draw, Line, Series};

use super::{Captions, Figure, sides};
use crate::diagnosis::{Diagnosis, IntervalOf};
use crate::pictures::{ChannelPicture, Spectrum};

const TIME: &str =
    "The amplitude of each wave in time; of close waves, the largest. A steady vibration is one line.";
const POSITION: &str = "The amplitude of each wave along the axis. The pitch of a screw and its fractions are lines; backlash \
     and errors that repeat with the whole travel are at the right.";

pub(super) fn figures(
    diagnosis: &Diagnosis,
    channel: &ChannelPicture,
    captions: &mut Captions,
) -> Vec<Figure> {
    let mut figures = Vec::new();
    for drawn in &channel.over_position {
        let title = format!("Amplitudes by period along {}", drawn.axis);
        let axis = Axis::new(&format!("period along {}", drawn.axis), drawn.unit).logarithmic();
        let plot = plot(&title, axis, &drawn.spectrum, channel);
        figures.push(Figure::new(plot, captions.once(POSITION)));
    }
    if let Some(spectrum) = &channel.over_time {
        let axis = Axis::exactly("frequency", "Hz").logarithmic();
        let intervals = diagnosis.unexplained.iter().filter_map(|unexplained| unexplained.interval.as_ref());
        let bands = intervals.filter(|interval| interval.of == IntervalOf::Frequency);
        let plot = bands
            .map(|interval| Band::of_x(interval.from, interval.to, "unexplained"))
            .fold(plot("Amplitudes by frequency", axis, spectrum, channel), Cartesian::band);
        figures.push(Figure::new(plot, captions.once(TIME)));
    }
    figures
}

fn plot(title: &str, axis: Axis, spectrum: &Spectrum, channel: &ChannelPicture) -> Cartesian {
    let amplitude = Axis::new("amplitude", channel.unit).reaching(0.0);
    let line = |name: &str, look, points: &[(f64, f64)]| Series::new(name, look, Draw::Line, points.to_vec());
    let plot = sides(channel).into_iter().fold(Cartesian::new(title, axis, amplitude), |plot, side| {
        plot.series(line(side.name, side.look, side.of(&spectrum.before, &spectrum.after)))
    });
    spectrum.found.iter().fold(plot, |plot, (at, name)| plot.line(Line::new(*at, name)))
}
