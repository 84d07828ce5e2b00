//! Findings in words. In: the findings of a diagnosis. Out: an item each: where, what, how much, on what evidence, what
//! else it could be, and what compensation does about it.

use super::figure::{change, percent};
use super::physics::{first_power, friction, interval, left, removed, side, state, title};
use super::sheet::Item;
use super::{parameter, remains, told};
use crate::diagnosis::{Alternative, Diagnosis, Evidence, Finding, Location};

/// All findings, in order.
pub(super) fn items(diagnosis: &Diagnosis) -> Vec<Item> {
    diagnosis.findings.iter().map(item).collect()
}

fn item(finding: &Finding) -> Item {
    let heading = format!(
        "{} in {} ({}): {} of the explainable variance",
        title(finding.term),
        finding.motion,
        finding.motion_meaning,
        percent(finding.share)
    );
    let removed = [removed(finding), left(finding)].join(" ");
    Item::new(
        heading,
        [
            ("where", vec![place(&finding.location)]),
            ("what", vec![what(finding)]),
            ("how much", parameter::lines(&finding.parameters, first_power(finding.term))),
            ("evidence", vec![evidence(&finding.evidence)]),
            ("or else", alternatives(&finding.alternatives)),
            ("compensation", vec![removed.trim_end().to_owned()]),
        ],
    )
}

fn place(location: &Location) -> String {
    let link = if location.link.is_empty() { String::new() } else { format!("link {}", location.link) };
    let interval = location.interval.as_ref().map(interval).unwrap_or_default();
    let parts =
        [link, side(location.side).to_owned(), state(location.state), interval, location.detail.clone()];
    remains::joined(&parts)
}

fn what(finding: &Finding) -> String {
    let friction = friction(finding).filter(|_| !finding.explanation.contains("not play"));
    let sentences = [finding.explanation.as_str(), friction.unwrap_or_default()];
    sentences.join(" ").trim().to_owned()
}

fn evidence(evidence: &Evidence) -> String {
    match change(evidence.with, evidence.without, evidence.unit) {
        Some((with, without)) => format!("held-out rms {without} without it, {with} with it"),
        None => "no data could be held out: it is fitted, not tested".to_owned(),
    }
}

/// Other names, and the measurement that separates each.
pub(super) fn alternatives(alternatives: &[Alternative]) -> Vec<String> {
    told(alternatives)
        .map(|other| {
            let name = name(other);
            if other.separate_by.is_empty() {
                name
            } else {
                format!("{name}; to separate: {}", other.separate_by)
            }
        })
        .collect()
}

fn name(other: &Alternative) -> String {
    match other.motion.as_str() {
        "instrument" => format!("{} of the instrument", other.term),
        motion => format!("{} of {motion}", other.term),
    }
}
