//! Summaries: what a recording held, for the reader of a diagnosis.
//!
//! In: a recording in the study, and which of its samples were left out. Out: its instrument, its rows and samples, and what of it was held out.

use crate::channel::ChannelAt;
use crate::diagnosis::Summary;
use crate::recording::Instrument;
use crate::scene::Scene;
use crate::study::Study;
use crate::weights::Outliers;

/// The summaries of all recordings, and how many of their samples were left out.
pub(super) fn summaries(study: &Study<'_>, outliers: &Outliers) -> Vec<Summary> {
    study.scenes.iter().enumerate().map(|(number, scene)| summary(number, scene, outliers)).collect()
}

fn summary(number: usize, scene: &Scene<'_>, left_out: &Outliers) -> Summary {
    let recording = scene.recording;
    let (mut samples, mut missing, mut outliers) = (0, 0, 0);
    for (channel, known) in scene.channels.iter().enumerate() {
        let marks = left_out.of(ChannelAt { scene: number, channel });
        for (value, outlier) in known.values.iter().zip(marks) {
            match (value.is_finite(), outlier) {
                (false, _) => missing += 1,
                (true, true) => outliers += 1,
                (true, false) => samples += 1,
            }
        }
    }
    Summary {
        file: recording.file.clone(),
        title: recording.title.clone(),
        instrument: instrument(&recording.instrument),
        rows: scene.rows(),
        samples,
        missing,
        outliers,
        runs: scene.run_numbers().len(),
        held_out: held_out(scene),
    }
}

fn instrument(instrument: &Instrument) -> &'static str {
    match instrument {
        Instrument::Position => "position",
        Instrument::Ballbar { .. } => "ballbar",
        Instrument::Linear(_) => "linear",
        Instrument::Straightness(_) => "straightness",
        Instrument::Angular { .. } => "angular",
        Instrument::Probe => "probe",
    }
}

fn held_out(scene: &Scene<'_>) -> String {
    let held = scene.blocks.iter().filter(|block| block.held_out).count();
    match &scene.recording.holdout {
        _ if held == scene.blocks.len() => "all of it".to_owned(),
        Some(runs) => {
            let numbers: Vec<String> = runs.iter().map(ToString::to_string).collect();
            format!("run {}", numbers.join(", "))
        }
        None => format!("{held} of {} blocks of time", scene.blocks.len()),
    }
}
