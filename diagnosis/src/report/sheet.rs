//! What the report says, before it is text or a page. In: a diagnosis. Out: its sections in order, each with items of
//! labelled facts or with plain sentences.

use super::item::Item;
use super::{brief, data, files, finding, instrument, remains, verdict};
use crate::diagnosis::Diagnosis;

/// The whole report.
pub(super) struct Sheet {
    /// What it begins with.
    pub(super) summary: Summary,
    /// What is wrong with the files, before anything is said of the machine.
    pub(super) files: Option<Section>,
    /// What comes back, before anything has a name.
    pub(super) returns: Option<Section>,
    /// What was found.
    pub(super) found: Vec<Section>,
    /// What is open, and what all this stands on.
    pub(super) open: Vec<Section>,
}

/// The report at a glance.
pub(super) struct Summary {
    /// The machine.
    pub(super) title: String,
    /// The verdict, a sentence without its end.
    pub(super) verdict: String,
    /// A line of the table for each finding.
    pub(super) findings: Vec<brief::Row>,
}

/// A part of it under one heading.
pub(super) struct Section {
    pub(super) heading: &'static str,
    pub(super) body: Body,
}

pub(super) enum Body {
    /// Things with facts about each.
    Items(Vec<Item>),
    /// Sentences, in order.
    List(Vec<String>),
}

/// The report of a diagnosis. Sections that have nothing to say are left out.
pub(super) fn sheet(diagnosis: &Diagnosis) -> Sheet {
    let items = |heading, items: Vec<Item>| {
        (!items.is_empty()).then_some(Section { heading, body: Body::Items(items) })
    };
    let list = |heading, lines: Vec<String>| {
        (!lines.is_empty()).then_some(Section { heading, body: Body::List(lines) })
    };
    let found = [
        items("What was left out", finding::items(diagnosis)),
        items("The instruments' own settings", instrument::items(diagnosis)),
        items("What no term explains", remains::unexplained(diagnosis)),
        items("Repeatability", remains::repeatability(diagnosis)),
    ];
    let open = [
        list("What to measure next", remains::next_measurements(diagnosis)),
        list("What these recordings cannot decide", diagnosis.undecided.clone()),
        items("Figures", if diagnosis.after.rms.is_nan() { Vec::new() } else { data::figures(diagnosis) }),
        items("Recordings", data::recordings(diagnosis)),
    ];
    Sheet {
        summary: Summary {
            title: format!("Diagnosis of {}", diagnosis.machine),
            verdict: verdict::sentence(diagnosis),
            findings: brief::rows(&diagnosis.findings),
        },
        files: items("Your files", files::items(diagnosis)),
        returns: list("What comes back", data::returns(diagnosis)),
        found: found.into_iter().flatten().collect(),
        open: open.into_iter().flatten().collect(),
    }
}
