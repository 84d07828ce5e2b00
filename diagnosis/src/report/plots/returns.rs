//! What comes back. In: for each channel the states that predict its residual where they were not fitted to it. Out: one plot: the
//! share that each state predicts beside those above it, and what is left.

use pages::plot::{Part, Shares, Tone, Unit, Whole};

use super::Figure;
use crate::diagnosis::{Diagnosis, Returning};
use crate::report::data;

/// So many channels are drawn, as elsewhere on the page: all are told in words below.
const CHANNELS: usize = 12;

/// The colours of states, in order.
const TONES: [Tone; 4] = [Tone::One, Tone::Two, Tone::Three, Tone::Four];

const CAPTION: &str = "The share of the residuals of the known calibration that a function of a state predicts in passes, runs \
     or reversals to which it was not fitted. No term has been chosen yet. Each state is added to those above it. No model of \
     these states can explain the part that does not come back.";

pub(super) fn figures(diagnosis: &Diagnosis) -> Vec<Figure> {
    let wholes: Vec<Whole> =
        data::by_channel(diagnosis).take(CHANNELS).map(|lines| whole(diagnosis, lines)).collect();
    if wholes.is_empty() {
        return Vec::new();
    }
    let caption = match data::by_channel(diagnosis).count() - wholes.len() {
        0 => CAPTION.to_owned(),
        more => format!("{CAPTION} {more} more channels are described only in words."),
    };
    vec![Figure::new(Shares::new("What comes back", "the residual's variance", wholes), caption)]
}

/// The states of a channel, each with what it adds to those before, and what is left.
fn whole(diagnosis: &Diagnosis, lines: &[Returning]) -> Whole {
    let mut parts = Vec::new();
    let (mut before, mut share) = ("", 0.0);
    for (line, tone) in lines.iter().zip(TONES.into_iter().cycle()) {
        let added = line.state.strip_prefix(before).unwrap_or(&line.state).trim_start_matches(", ");
        parts.push(Part { label: added.to_owned(), share: line.share - share, note: String::new(), tone });
        (before, share) = (&line.state, line.share);
    }
    let Some(last) = lines.last() else { return Whole { label: String::new(), parts } };
    parts.push(Part {
        label: "does not come back".to_owned(),
        share: 1.0 - share,
        note: format!("{} rms", Unit::of(last.unit, last.left).text(last.left, 2)),
        tone: Tone::Quiet,
    });
    Whole { label: data::named(diagnosis, last.recording, &last.channel), parts }
}
