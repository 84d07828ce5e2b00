//! The words of a limit. In: a limit. Out: clauses that text and page share.

use crate::answer::{Advice, Pair, Pass};
use crate::answer::{Limit, Limits};
use crate::size::{short, significant};

/// What the effect of a limit is, with all that was drawn for it: `EXX cyclic (period 21 to 34 mm)`.
pub(super) fn name(limit: &Limit) -> String {
    let drawn = if limit.drawn.is_empty() { String::new() } else { format!(" ({})", limit.drawn) };
    format!("{}{drawn}", limit.name())
}

/// By which names an effect at the limit would be found, and what else was drawn for it.
pub(super) fn told_and_drawn(limit: &Limit) -> String {
    let drawn = if limit.drawn.is_empty() { String::new() } else { format!("; {}", limit.drawn) };
    format!("{}{drawn}", told(limit))
}

/// The limit with its sense and unit: `0.82 um`, `below 120 1/s`.
pub(super) fn size(limit: &Limit) -> Option<String> {
    let size = limit.size()?;
    let sense = if limit.scale.is_gain { "below " } else { "" };
    let known = limit.found.as_ref().map_or(0.0, |found| found.uncertainty);
    let known = if known > VAGUE { format!(" (to {:.0} %)", 100.0 * known) } else { String::new() };
    Some(format!("{sense}{} {}{known}", significant(size, 2), limit.scale.unit))
}

/// A limit that is known less well than this is told with how well.
const VAGUE: f64 = 0.15;

/// The interval of an effect at the limit: `+- 0.21 um`.
pub(super) fn interval(limit: &Limit) -> String {
    limit
        .half()
        .map_or_else(|| "-".to_owned(), |half| format!("+- {} {}", significant(half, 2), limit.scale.unit))
}

/// By which names an effect at the limit would be found.
pub(super) fn told(limit: &Limit) -> String {
    let Some(found) = &limit.found else { return String::new() };
    let others: Vec<&str> = found.others.iter().map(|other| other.name.as_str()).collect();
    match (others.as_slice(), found.first) {
        ([], first) if first >= MOSTLY => "by its name".to_owned(),
        ([], first) => {
            format!("by its name in {} of 10, otherwise under varying names", short((10.0 * first).round()))
        }
        (others, _) => format!("or else {}", others.join(", ")),
    }
}

/// The share of its own name from which on a limit is told by its name alone.
const MOSTLY: f64 = 0.75;

/// What a kind without a limit was taken for.
pub(super) fn never(limit: &Limit) -> String {
    let largest = limit.scale.told(limit.largest);
    let instead = match limit.instead.as_slice() {
        [] if limit.trials.iter().any(|trial| trial.is_unexplained) => "it stays unexplained".to_owned(),
        [] => "nothing was reported instead".to_owned(),
        [one] => format!("{one} was reported instead"),
        [one, other, ..] => format!("{one} or {other} was reported instead"),
    };
    let tried = if limit.scale.is_gain { "not found at a gain of" } else { "not found up to" };
    format!("{}: {tried} {} {}; {instead}", name(limit), significant(largest, 2), limit.scale.unit)
}

/// What is never told apart, by the measurement that would: a sentence for each.
pub(super) fn pairs(limits: &Limits) -> Vec<String> {
    let mut grouped: Vec<(&str, Vec<Pair>)> = Vec::new();
    for limit in &limits.all {
        for other in limit.found.iter().flat_map(|found| &found.others) {
            let pair = Pair { effect: limit.name(), other: Some(other.name.clone()) };
            let turned = Pair { effect: other.name.clone(), other: Some(limit.name()) };
            match grouped.iter_mut().find(|(advice, _)| *advice == other.separate_by) {
                Some((_, pairs)) if pairs.contains(&turned) => {}
                Some((_, pairs)) => pairs.push(pair),
                None => grouped.push((&other.separate_by, vec![pair])),
            }
        }
    }
    let sentence = |(advice, pairs): &(&str, Vec<Pair>)| {
        let told = told_apart(pairs);
        if advice.is_empty() { told } else { format!("{told}. To separate them: {advice}") }
    };
    grouped.iter().map(sentence).collect()
}

/// Why no effect would be found.
pub(super) fn none(limits: &Limits) -> &'static str {
    if limits.all.is_empty() {
        "No effect was tested: each one that was asked for is in the recording already."
    } else {
        "No effect would be found at any size."
    }
}

/// What the recording shows already.
pub(super) fn already(limits: &Limits) -> Option<String> {
    let names = limits.already.iter().map(|one| format!("{} {}", one.motion, one.term));
    let names: Vec<String> = names.collect();
    (!names.is_empty()).then(|| {
        format!(
            "Found in the recording itself, so not tested: {}. Any further effect adds to it.",
            names.join(", ")
        )
    })
}

/// The extra passes, a sentence each, and what none of them settles.
pub(super) fn passes(advice: &Advice) -> Vec<String> {
    let pass = |(number, pass): (usize, &Pass)| {
        let also = if number == 0 { "" } else { "then also " };
        format!("{also}{} ({}): resolves {}", pass.words, lasting(pass.time), told_apart(&pass.settles))
    };
    let mut lines: Vec<String> = advice.passes.iter().enumerate().map(pass).collect();
    if !advice.left.is_empty() {
        lines.push(format!("none of the passes tried resolves {}", told_apart(&advice.left)));
    }
    lines
}

/// Pairs by their effects: `EXX cyclic from EBX cyclic or EAX cyclic`.
fn told_apart(pairs: &[Pair]) -> String {
    let mut grouped: Vec<(&str, Vec<&str>)> = Vec::new();
    for pair in pairs {
        let other = pair.other.as_deref();
        match grouped.iter_mut().find(|(known, _)| *known == pair.effect) {
            Some((_, others)) => others.extend(other),
            None => grouped.push((&pair.effect, other.into_iter().collect())),
        }
    }
    let told = grouped.iter().map(|(effect, others)| match others.as_slice() {
        [] => (*effect).to_owned(),
        others => format!("{effect} from {}", others.join(" or ")),
    });
    told.collect::<Vec<_>>().join("; ")
}

/// A time in s or min.
fn lasting(time: f64) -> String {
    if time < 120.0 { format!("{} s", short(time)) } else { format!("{} min", short(time / 60.0)) }
}
