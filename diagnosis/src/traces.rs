//! Traces: every sample of a diagnosis beside what the model says of it.
//!
//! In: a study, what the calibration alone left and what was found. Out: columns as long as the recordings, for whoever draws, tests or
//! fits them on: nothing is thinned out, unlike in [`crate::pictures`].

use crate::channel::ChannelAt;
use crate::engine::Found;
use crate::pictures::Before;
use crate::study::Study;
use crate::zeros;

/// One channel of one recording, row by row: mm or rad, s. NaN where nothing was measured, and where a row is left out because an axis
/// turned in it or had not arrived.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// The recording, by number; the one that is held out as a whole is the last.
    pub recording: usize,
    /// The channel's name in it: `measured.x`.
    pub channel: String,
    /// `mm` or `rad`.
    pub unit: &'static str,
    /// Time since the first row.
    pub time: Vec<f64>,
    /// The run of each row.
    pub run: Vec<i64>,
    /// What was measured; with the faults of the recording mended, where [`crate::diagnosis::Diagnosis::model`] tells of one.
    pub measured: Vec<f64>,
    /// Measured minus what the calibration alone predicts, the free settings of the instrument fitted.
    pub before: Vec<f64>,
    /// Measured minus what the calibration and the findings predict.
    pub after: Vec<f64>,
    /// Whether the row was held out: nothing was fitted to it.
    pub held_out: Vec<bool>,
    /// Whether the sample was left out as an outlier.
    pub outlier: Vec<bool>,
}

/// The traces of all channels of all recordings.
pub(crate) fn traces(study: &Study<'_>, before: &Before, found: &Found) -> Vec<Trace> {
    let after = zeros::residuals(study, &found.fit.model);
    let left = before.residuals.iter().zip(after);
    let mut traces = Vec::new();
    for (number, (scene, (before, after))) in study.scenes.iter().zip(left).enumerate() {
        let held_out: Vec<bool> = scene.fitted_rows().iter().map(|fitted| !fitted).collect();
        for (place, (before, after)) in before.iter().zip(after).enumerate() {
            let (at, channel) = (ChannelAt { scene: number, channel: place }, &scene.channels[place]);
            traces.push(Trace {
                recording: number,
                channel: channel.name.clone(),
                unit: if channel.kind.angular(study.equations) { "rad" } else { "mm" },
                time: scene.recording.time.clone(),
                run: scene.recording.run.clone(),
                measured: channel.values.to_vec(),
                before: before.clone(),
                after,
                held_out: held_out.clone(),
                outlier: found.appraisal.weights.outliers.of(at).to_vec(),
            });
        }
    }
    traces
}
