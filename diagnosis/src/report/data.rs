//! What the diagnosis stands on. In: a diagnosis. Out: the noise, the residuals and the recordings, in words.

use super::figure::{percent, size};
use super::item::Item;
use crate::diagnosis::{Diagnosis, NoiseSummary, Residual, Returning, Summary};

/// The noise, and what the model leaves before and after.
pub(super) fn figures(diagnosis: &Diagnosis) -> Vec<Item> {
    let before = residual(&diagnosis.before);
    let after = residual(&diagnosis.after);
    let facts = [
        ("noise", vec![noise(&diagnosis.noise)]),
        ("known before", vec![before]),
        ("with findings", vec![after]),
    ];
    vec![Item::new("Root mean square of the noise, and of what the model leaves".to_owned(), facts)]
}

/// What of each channel comes back with which state, before any name: that all of the findings could explain at most.
pub(super) fn returns(diagnosis: &Diagnosis) -> Vec<String> {
    // The last line of a channel holds the states of those before it.
    let last = |number: usize, one: &Returning| {
        let next = diagnosis.returns.get(number + 1);
        next.is_none_or(|next| (next.recording, &next.channel) != (one.recording, &one.channel))
    };
    let lines = diagnosis.returns.iter().enumerate().filter(|(number, one)| last(*number, one));
    lines.map(|(_, one)| returning(one)).collect()
}

fn returning(one: &Returning) -> String {
    let Returning { channel, state, share, left, unit, .. } = one;
    format!(
        "{channel}: {} of the residual comes back with the {state}; what does not is {} (rms).",
        percent(*share),
        size(*left, unit)
    )
}

fn noise(noise: &NoiseSummary) -> String {
    let all = size(noise.value, noise.unit);
    if noise.wander > 0.0 && noise.wander.is_finite() {
        let [white, wander] = [noise.white, noise.wander].map(|part| size(part, noise.unit));
        let time = size(noise.time_constant, "s");
        return format!("{all}: white {white}, wandering {wander} with a correlation time of {time}");
    }
    format!("{all}, white")
}

fn residual(residual: &Residual) -> String {
    let all = size(residual.rms, residual.unit);
    match residual.holdout_rms {
        Some(held_out) => {
            format!("{all} over all samples, {} over those held out", size(held_out, residual.unit))
        }
        None => format!("{all} over all samples; nothing could be held out"),
    }
}

/// The recordings, in order.
pub(super) fn recordings(diagnosis: &Diagnosis) -> Vec<Item> {
    diagnosis.recordings.iter().map(recording).collect()
}

fn recording(summary: &Summary) -> Item {
    let title = summary.title.as_ref().map_or_else(String::new, |title| format!(" ({title})"));
    let runs = counted(summary.runs, "run");
    let mut samples = format!("{} used", summary.samples);
    if summary.outliers > 0 {
        samples += &format!(", {} left out", counted(summary.outliers, "outlier"));
    }
    if summary.missing > 0 {
        samples += &format!(", {} missing", summary.missing);
    }
    Item::new(
        format!("{}{title}", summary.file),
        [
            (
                "instrument",
                vec![format!("{}, {} in {runs}", summary.instrument, counted(summary.rows, "row"))],
            ),
            ("samples", vec![samples]),
            ("held out", vec![summary.held_out.clone()]),
        ],
    )
}

fn counted(count: usize, what: &str) -> String {
    if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
}
