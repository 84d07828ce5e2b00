//! The report: a fleet's history in words. In: a history. Out: text for a terminal, JSON for programs, pages for a browser. Nothing is
//! decided here.

mod chart;
mod html;
mod text;

pub use html::{Pages, page, pages};
pub use text::text;

use pages::text::spoken;

use crate::change::FEWEST;
use crate::diagnosed::ERROR;
use crate::history::{Entry, Followed, History, Machine};
use crate::series::days;

/// A history as JSON.
#[must_use]
pub fn json(history: &History) -> String {
    serde_json::to_string_pretty(history).map(|text| text + "\n").unwrap_or_default()
}

/// A number in the unit in which people read it.
pub(crate) fn number(value: f64, unit: &str) -> String {
    diagnosis::report::size(value, unit)
}

/// How long ago a machine was measured: `3 days ago`; nothing of one that never was.
fn age(history: &History, machine: &Machine) -> Option<String> {
    let past = (days(history.until) - days(machine.last()?.time)).max(0.0).floor();
    Some(match past {
        0.0 => "today".to_owned(),
        1.0 => "1 day ago".to_owned(),
        past if past < 60.0 => format!("{past} days ago"),
        past => format!("{} weeks ago", (past / 7.0).floor()),
    })
}

/// The number of a machine that changed most plainly.
fn worst(machine: &Machine) -> Option<&Followed> {
    let known = machine.series.iter().filter_map(|followed| Some((followed, followed.change.as_ref()?)));
    let plainer = |one: &(&Followed, &crate::Change), other: &(&Followed, &crate::Change)| {
        (!one.0.alarm, one.1.probability).partial_cmp(&(!other.0.alarm, other.1.probability))
    };
    known
        .min_by(|one, other| plainer(one, other).unwrap_or(std::cmp::Ordering::Equal))
        .map(|(followed, _)| followed)
}

/// What a machine did since it is looked at, in a few words: what changed most plainly, or why nothing can be told.
fn most(machine: &Machine) -> String {
    let effects = machine.series.iter().filter(|followed| !followed.series.is_noise()).count();
    match worst(machine) {
        Some(worst) => brief(worst),
        None if machine.series.is_empty() => "no recording gives a number to follow".to_owned(),
        None => {
            let effects = match effects {
                0 => "only the noise is followed, because nothing else was found".to_owned(),
                1 => "1 number and the noise are followed".to_owned(),
                more => format!("{more} numbers and the noise are followed"),
            };
            format!("{effects}; changes are reported from {FEWEST} recordings on")
        }
    }
}

/// How many recordings a machine has, how many of them are where the fleet file looks no more, and what is open about them.
fn count(machine: &Machine) -> String {
    let all = machine.recordings.len();
    let mut parts = vec![counted(all, "recording")];
    match machine.recordings.iter().filter(|entry| !entry.listed).count() {
        0 => {}
        gone => parts.push(format!("{gone} of them missing")),
    }
    parts.extend(open(machine));
    parts.join(", ")
}

/// The verdict about a recording in words.
fn verdict(entry: &Entry) -> String {
    match entry.verdict.as_str() {
        ERROR => "cannot be diagnosed".to_owned(),
        word => spoken(word),
    }
}

/// A number of things: `1 machine`, `2 machines`.
fn counted(number: usize, what: &str) -> String {
    if number == 1 { format!("1 {what}") } else { format!("{number} {what}s") }
}

/// What is open about the recordings of a machine: how many are wrong, and how many are still to be diagnosed.
fn open(machine: &Machine) -> Vec<String> {
    let parts = [(machine.errors(), "with errors"), (machine.pending, "pending")];
    parts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect()
}

/// A change in a few words; that it is no more than chance gives, where there is no alarm about it.
fn brief(followed: &Followed) -> String {
    let series = &followed.series;
    let name = series.name();
    let Some(change) = &followed.change else {
        return format!("{name}: too few recordings to detect a change");
    };
    let size = match series.is_noise() {
        true => format!("{:.2} times", change.size.exp()),
        false => format!("{} +- {}", number(change.size, &series.unit), number(change.half, &series.unit)),
    };
    let silent = match (series.untold.len(), series.points.len()) {
        (0, _) => String::new(),
        (1, told) => format!("; 1 recording of {} does not resolve it", told.saturating_add(1)),
        (silent, told) => {
            format!("; {silent} recordings of {} do not resolve it", told.saturating_add(silent))
        }
    };
    match followed.alarm {
        true => format!("{name}: {} of {size}{silent}", change.kind),
        false => format!("{name}: no reported change ({} of {size}){silent}", change.kind),
    }
}
