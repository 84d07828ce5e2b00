//! Findings in words. In: the findings of a diagnosis. Out: an item each: where, what, how much, on what evidence, what
//! else it could be, and what compensation does about it.

use super::element::repeats;
use super::figure::{change, percent};
use super::item::Item;
use super::physics::{ahead, friction, interval, left, pushed, removed, side, state, title};
use super::{parameter, remains, told};
use crate::diagnosis::{Alternative, Diagnosis, Evidence, Finding, Location};

/// All findings, in order.
pub(super) fn items(diagnosis: &Diagnosis) -> Vec<Item> {
    diagnosis.findings.iter().map(item).collect()
}

fn item(finding: &Finding) -> Item {
    let heading = format!(
        "{} in {} ({}): {} of the explainable variance",
        heading_of(finding),
        finding.motion,
        finding.motion_meaning,
        percent(finding.share)
    );
    let removed = [removed(finding), left(finding)].join(" ");
    let equation = finding.form.as_ref().map(|form| form.equation.mathml.clone());
    let item = Item::new(
        heading,
        [
            ("where", vec![place(&finding.location)]),
            ("form", form(finding)),
            ("what", vec![what(finding)]),
            ("how much", parameter::of_finding(finding)),
            ("evidence", vec![evidence(&finding.evidence)]),
            ("or else", alternatives(&finding.alternatives)),
            ("compensation", vec![removed.trim_end().to_owned()]),
        ],
    );
    match equation {
        Some(equation) => item.with_formula("form", equation),
        None => item,
    }
}

/// The form of a finding that has no name of its own: how large it is where, its equation, and what has it.
fn form(finding: &Finding) -> Vec<String> {
    let Some(form) = &finding.form else { return Vec::new() };
    let physics = match form.physics.as_slice() {
        [] => String::new(),
        known => format!("Examples: {}.", known.join("; ")),
    };
    vec![form.words.clone(), format!("{} = {}", finding.motion, form.equation.text), physics]
}

/// The term as it begins a line; of a form, that it is one.
fn heading_of(finding: &Finding) -> String {
    match &finding.form {
        Some(_) => format!("{} (a form, not a cause)", title(finding.term)),
        None => title(finding.term),
    }
}

fn place(location: &Location) -> String {
    let link = if location.link.is_empty() { String::new() } else { format!("link {}", location.link) };
    let interval = location.interval.as_ref().map(interval).unwrap_or_default();
    // The detail says it better, where there is one.
    let how = if location.detail.is_empty() { state(location.state) } else { location.detail.clone() };
    let parts = [link, side(location.side).to_owned(), how, interval];
    remains::joined(&parts)
}

fn what(finding: &Finding) -> String {
    let repeats = repeats(finding);
    let sentences = [
        finding.explanation.as_str(),
        repeats.as_deref().unwrap_or_default(),
        friction(finding).unwrap_or_default(),
        ahead(finding).unwrap_or_default(),
        pushed(finding).unwrap_or_default(),
    ];
    let said: Vec<&str> = sentences.into_iter().filter(|sentence| !sentence.is_empty()).collect();
    said.join(" ")
}

fn evidence(evidence: &Evidence) -> String {
    match change(evidence.with, evidence.without, evidence.unit) {
        Some((with, without)) => {
            let of = evidence.drive.as_ref().map(|axis| format!(" of the drive's feedback of {axis}"));
            format!("held-out rms{} {without} without it, {with} with it", of.unwrap_or_default())
        }
        None => "no data could be held out, so it is fitted but not tested".to_owned(),
    }
}

/// Other names, those that one measurement separates together, and that measurement.
pub(super) fn alternatives(alternatives: &[Alternative]) -> Vec<String> {
    let mut groups: Vec<(Vec<String>, &str)> = Vec::new();
    for other in told(alternatives) {
        let by = other.separate_by.as_str();
        match groups.iter_mut().find(|(_, known)| *known == by) {
            Some((names, _)) => names.push(name(other)),
            None => groups.push((vec![name(other)], by)),
        }
    }
    let lines = groups.into_iter().map(|(names, by)| {
        let separated = if by.is_empty() { String::new() } else { format!("; to separate: {by}") };
        names.join(", ") + &separated
    });
    lines.collect()
}

fn name(other: &Alternative) -> String {
    match other.motion.as_str() {
        "instrument" => format!("{} of the instrument", other.term),
        motion => format!("{} of {motion}", other.term),
    }
}
