//! Pictures: the numbers behind the plots of a diagnosis, thinned so that a page stays small.
//!
//! In: a study and what was found in it. Out: plain data: samples of every channel with the state in which each was taken and
//! what the model leaves there before and after; circles; spectra; distributions and contributions. It exists so that the
//! report computes nothing. What is a sum over samples (distributions, means of runs, contributions, root mean squares) is
//! taken over all of them, not over the thinned ones.

mod channel;
mod circle;
mod contribution;
mod distribution;
mod gather;
mod spectrum;

pub(crate) use gather::Before;

/// What can be drawn of a diagnosis. Lengths are in mm, angles in rad, times in s, temperatures in degC where nothing else
/// is said.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    /// The recordings that are drawn, in order; of many the first.
    pub recordings: Vec<Picture>,
    /// What each finding does, in the order of the findings.
    pub contributions: Vec<Contribution>,
    /// How residuals of the channels that count for the rms are distributed: before, after, after where held out.
    pub distributions: Vec<Distribution>,
}

impl Pictures {
    /// Whether the findings change nothing that could be seen in any channel.
    pub fn unchanged(&self) -> bool {
        self.recordings.iter().flat_map(|picture| &picture.channels).all(|channel| channel.unchanged)
    }
}

/// What one finding adds to the readings, over all samples that count for the rms; the mean of each channel is taken out, since
/// the channel's zero is free. In the unit of the residual.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contribution {
    /// Root mean square.
    pub rms: f64,
    /// The greatest size.
    pub max: f64,
}

/// A distribution of residuals, in the unit of the residual.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Distribution {
    /// Whether the findings are taken out.
    pub after: bool,
    /// Whether only held-out samples are counted.
    pub held_out: bool,
    /// The ends of the classes, one more than there are classes.
    pub edges: Vec<f64>,
    /// How many samples fell into each class.
    pub counts: Vec<usize>,
    /// How many samples lie beyond all classes.
    pub beyond: usize,
}

/// One recording.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    /// Its number in the diagnosis.
    pub recording: usize,
    /// Its channels; of many the first.
    pub channels: Vec<ChannelPicture>,
    /// How many channels it has.
    pub of: usize,
    /// The circle that it goes round, where it does.
    pub circle: Option<Circle>,
}

/// One channel of a recording.
#[derive(Clone, Debug, Default)]
pub struct ChannelPicture {
    /// The channel's name.
    pub name: String,
    /// What it shows, in words.
    pub title: String,
    /// `mm` or `rad`.
    pub unit: &'static str,
    /// Whether it counts for the rms of the diagnosis.
    pub counts: bool,
    /// How many samples it has; outliers are left out.
    pub samples: usize,
    /// The samples that were left out as outliers.
    pub outliers: usize,
    /// Root mean square of all samples before and after.
    pub rms: (f64, f64),
    /// Whether the findings change nothing that could be seen: before and after are then one.
    pub unchanged: bool,
    /// How far nearly all samples reach from zero before and after: a few that lie much farther would press all others
    /// together in a plot.
    pub reach: (f64, f64),
    /// The samples to draw.
    pub shown: Samples,
    /// The runs, where there are several.
    pub runs: Vec<RunMean>,
    /// Amplitudes over frequency, Hz.
    pub over_time: Option<Spectrum>,
    /// Amplitudes over the position of an axis.
    pub over_position: Vec<PositionSpectrum>,
}

/// Samples in order of time: columns of one length.
#[derive(Clone, Debug, Default)]
pub struct Samples {
    /// Time since the recording began.
    pub time: Vec<f64>,
    /// The repeat that it belongs to.
    pub run: Vec<i64>,
    /// What the known calibration leaves, zeros fitted.
    pub before: Vec<f64>,
    /// What the findings leave.
    pub after: Vec<f64>,
    /// Whether it was held out.
    pub held_out: Vec<bool>,
    /// Whether it was left out as an outlier.
    pub outlier: Vec<bool>,
    /// The axes that move.
    pub axes: Vec<AxisTrack>,
    /// Temperatures that change, those that findings read first.
    pub temperatures: Vec<Track>,
    /// Loads that change.
    pub loads: Vec<Track>,
}

/// An axis at each sample.
#[derive(Clone, Debug, Default)]
pub struct AxisTrack {
    /// Its letter.
    pub letter: String,
    /// `mm` or `rad`.
    pub unit: &'static str,
    /// Position.
    pub position: Vec<f64>,
    /// Direction of the last real motion: +1 or -1.
    pub direction: Vec<f64>,
    /// Velocity; empty where rows are too far apart to tell it.
    pub velocity: Vec<f64>,
}

/// A sensor at each sample.
#[derive(Clone, Debug, Default)]
pub struct Track {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its values.
    pub values: Vec<f64>,
}

/// The means of one run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunMean {
    /// Its number.
    pub run: i64,
    /// Mean before and after.
    pub mean: (f64, f64),
    /// Root mean square before and after.
    pub rms: (f64, f64),
    /// Whether all of it was held out.
    pub held_out: bool,
}

/// Amplitudes of waves before and after; of close ones the highest.
#[derive(Clone, Debug, Default)]
pub struct Spectrum {
    /// Frequency (or period) and amplitude.
    pub before: Vec<(f64, f64)>,
    /// The same with the findings.
    pub after: Vec<(f64, f64)>,
    /// The lines that were found, with their names.
    pub found: Vec<(f64, String)>,
}

/// Amplitudes over the period along an axis.
#[derive(Clone, Debug, Default)]
pub struct PositionSpectrum {
    /// The axis's letter.
    pub axis: String,
    /// `mm` or `rad`.
    pub unit: &'static str,
    /// Over the period.
    pub spectrum: Spectrum,
}

/// A nominal circle and the deviations from it.
#[derive(Clone, Debug, Default)]
pub struct Circle {
    /// Nominal radius.
    pub radius: f64,
    /// What lies at 0 and at 90 degrees: `+X`, `+Y`.
    pub directions: [String; 2],
    /// Passes, each in one sense; of many the first and the last.
    pub passes: Vec<Pass>,
    /// How many passes there are.
    pub of: usize,
}

/// One way along the circle, or a part of it.
#[derive(Clone, Debug, Default)]
pub struct Pass {
    /// The repeat that it belongs to.
    pub run: i64,
    /// Whether it turns from the first direction to the second: against the clock.
    pub against_the_clock: bool,
    /// Whether all of it was held out.
    pub held_out: bool,
    /// Angle, and the radial deviation as it was measured with the instrument's zero and the circle's centre taken out, as the
    /// known calibration gives it, and with the findings.
    pub points: Vec<[f64; 4]>,
}
