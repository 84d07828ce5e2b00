//! Faults of the files in words. In: what to change in them. Out: an item each.

use super::figure::{change, percent};
use super::item::Item;
use super::parameter;
use crate::diagnosis::{Change, Diagnosis};

/// All faults, in the order in which they were found.
pub(super) fn items(diagnosis: &Diagnosis) -> Vec<Item> {
    diagnosis.model.iter().map(item).collect()
}

/// A fault in one sentence: what seems to be wrong, and how much of what the files leave it explains.
pub(super) fn sentence(change: &Change) -> String {
    let explains = match change.share.is_finite() {
        true => format!(": corrected, it explains {}", percent(change.share)),
        false => String::new(),
    };
    format!("It seems that {}{explains}.", change.fault)
}

fn item(fault: &Change) -> Item {
    let amount = fault.amount.as_slice();
    Item::new(
        sentence(fault).trim_end_matches('.').to_owned(),
        [
            ("where", vec![place(fault)]),
            ("change", vec![fault.remedy.clone()]),
            ("how much", parameter::lines(amount, 0)),
            ("evidence", vec![evidence(fault)]),
            ("or else", fault.alternatives.clone()),
        ],
    )
}

fn place(fault: &Change) -> String {
    let line = fault.line.map(|line| format!(", line {line}")).unwrap_or_default();
    format!("{}{line}: {}", fault.name, fault.path)
}

fn evidence(fault: &Change) -> String {
    let evidence = &fault.evidence;
    let rms = change(evidence.with, evidence.without, evidence.unit);
    rms.map_or_else(String::new, |(with, without)| {
        format!("held-out rms {without} with the file as it is, {with} with the change")
    })
}
