//! What the diagnosis stands on. In: a diagnosis. Out: the noise, the residuals and the recordings, in words.

use super::figure::{percent, size};
use super::item::Item;
use crate::diagnosis::{Diagnosis, NoiseSummary, NothingReturns, Residual, Returning, Summary};

/// The noise, and what the model leaves before and after.
pub(super) fn figures(diagnosis: &Diagnosis) -> Vec<Item> {
    let before = residual(&diagnosis.before);
    let after = residual(&diagnosis.after);
    let facts = [
        ("noise", vec![noise(&diagnosis.noise)]),
        ("known before", vec![before]),
        ("with findings", vec![after]),
    ];
    vec![Item::new("Root mean square of the noise and of the residuals".to_owned(), facts)]
}

/// What of each channel comes back with which state, before any name: that all of the findings could explain at most; and of which
/// channels nothing does, and why.
pub(super) fn returns(diagnosis: &Diagnosis) -> Vec<String> {
    let mut lines: Vec<String> =
        by_channel(diagnosis).filter_map(<[Returning]>::last).map(|one| returning(diagnosis, one)).collect();
    lines.extend([true, false].into_iter().filter_map(|twice| nothing(diagnosis, twice)));
    if lines.is_empty() && diagnosis.undecidable.is_some() {
        lines.push("No search was made for it, because these recordings decide nothing.".to_owned());
    }
    lines
}

/// The lines of each channel: the last one holds the states of those before it.
pub(super) fn by_channel(diagnosis: &Diagnosis) -> impl Iterator<Item = &[Returning]> {
    diagnosis.returns.chunk_by(|one, next| (one.recording, &one.channel) == (next.recording, &next.channel))
}

/// A channel by its name, with its recording where there are several.
pub(super) fn named(diagnosis: &Diagnosis, recording: usize, channel: &str) -> String {
    match diagnosis.recordings.get(recording) {
        Some(summary) if diagnosis.recordings.len() > 1 => format!("{channel} of {}", summary.file),
        _ => channel.to_owned(),
    }
}

fn returning(diagnosis: &Diagnosis, one: &Returning) -> String {
    format!(
        "{}: {} of the residual comes back with the {}; the rest is {} (rms).",
        named(diagnosis, one.recording, &one.channel),
        percent(one.share),
        one.state,
        size(one.left, one.unit)
    )
}

/// The channels of which nothing comes back, since nothing is driven twice or though something is.
fn nothing(diagnosis: &Diagnosis, driven_twice: bool) -> Option<String> {
    let of = diagnosis.nothing_returns.iter().filter(|one| one.driven_twice == driven_twice);
    let names: Vec<String> =
        of.map(|NothingReturns { recording, channel, .. }| named(diagnosis, *recording, channel)).collect();
    let names = (!names.is_empty()).then(|| names.join(", "))?;
    Some(if driven_twice {
        format!("{names}: nothing comes back; no state predicts more of the residual than chance.")
    } else {
        format!("{names}: it is unknown what comes back, because nothing was driven twice.")
    })
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
