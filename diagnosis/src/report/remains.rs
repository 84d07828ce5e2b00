//! What the findings leave open. In: a diagnosis. Out: what no term explains, how far runs differ, and what to measure
//! next, in words.

use super::figure::size;
use super::item::Item;
use super::physics::{interval, state};
use super::told;
use crate::diagnosis::{Diagnosis, Repeatability, Unexplained};

/// What stands above the noise and no term fits, with its place.
pub(super) fn unexplained(diagnosis: &Diagnosis) -> Vec<Item> {
    diagnosis.unexplained.iter().map(unexplained_item).collect()
}

fn unexplained_item(unexplained: &Unexplained) -> Item {
    let table = unexplained
        .table_of
        .as_ref()
        .map(|motion| format!("A table of {motion} over this stretch could represent it without a cause."));
    Item::new(
        format!(
            "{}: {} rms where it appears",
            unexplained.direction,
            size(unexplained.rms, unexplained.unit)
        ),
        [
            ("where", vec![place(unexplained)]),
            ("what", vec![unexplained.detail.clone()]),
            ("stand-in", table.into_iter().collect()),
        ],
    )
}

/// Link, state and stretch.
fn place(unexplained: &Unexplained) -> String {
    let link = unexplained.link.as_ref().map(|link| format!("link {link}")).unwrap_or_default();
    let interval = unexplained.interval.as_ref().map(interval).unwrap_or_default();
    joined(&[link, state(unexplained.state), interval])
}

/// The place in a few words, for the verdict.
pub(super) fn brief(unexplained: &Unexplained) -> String {
    let rms = size(unexplained.rms, unexplained.unit);
    match &unexplained.interval {
        Some(stretch) => format!("in {}, {} ({rms} rms there)", unexplained.direction, interval(stretch)),
        None => format!("in {} ({rms} rms)", unexplained.direction),
    }
}

/// How far runs differ.
pub(super) fn repeatability(diagnosis: &Diagnosis) -> Vec<Item> {
    diagnosis.repeatability.iter().map(repeatability_item).collect()
}

fn repeatability_item(repeatability: &Repeatability) -> Item {
    let Repeatability { between_runs, expected, unit, detail } = repeatability;
    let title = format!("Runs in the same state differ by {} (one sigma)", size(*between_runs, unit));
    let expected = format!("the noise within runs gives {}", size(*expected, unit));
    Item::new(title, [("expected", vec![expected]), ("depends on", vec![detail.clone()])])
}

/// The measurements that would separate what is told under several names: each once, in the order of the findings.
pub(super) fn next_measurements(diagnosis: &Diagnosis) -> Vec<String> {
    let findings = diagnosis.findings.iter().flat_map(|finding| told(&finding.alternatives));
    let settings = diagnosis.settings.iter().flat_map(|setting| told(&setting.alternatives));
    let mut wanted: Vec<String> = Vec::new();
    for other in findings.chain(settings) {
        let wish = capital(other.separate_by.trim());
        if !wish.is_empty() && !wanted.contains(&wish) {
            wanted.push(wish);
        }
    }
    wanted
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The parts that say something, behind one another.
pub(super) fn joined(parts: &[String]) -> String {
    let parts: Vec<&str> = parts.iter().map(|part| part.trim()).filter(|part| !part.is_empty()).collect();
    parts.join("; ")
}
