//! The report as text. In: a history. Out: alarms, then a line a machine.

use super::{age, count, counted, most, open, verdict};
use crate::diagnosed::ERROR;
use crate::history::{BOUND, Entry, History};

/// The report names at most this many unreadable recordings of a machine, the latest first: as many as fit a glance.
const MOST_NAMED: usize = 3;

/// The report for a terminal that is so many columns wide.
#[must_use]
pub fn text(history: &History, columns: usize) -> String {
    let mut text = String::new();
    let paragraph = |text: &str, indent: &str| {
        let options = textwrap::Options::new(columns.max(40)).initial_indent("").subsequent_indent(indent);
        textwrap::fill(text, options) + "\n"
    };
    let alarms = match history.alarms.len() {
        0 => "no alarm".to_owned(),
        1 => "1 alarm".to_owned(),
        more => format!("{more} alarms"),
    };
    text += &paragraph(
        &format!(
            "{} until {}: {alarms}. {} series and comparisons were tested; the chance of any false alarm among all of \
             them is at most {} %.",
            counted(history.machines.len(), "machine"),
            history.until.day(),
            history.questions,
            BOUND * 100.0
        ),
        "",
    );
    for alarm in &history.alarms {
        text += "\n";
        text += &paragraph(&format!("{}: {}", alarm.machine, alarm.reason), "  ");
        text += &paragraph(&format!("  look at: {}", alarm.look_at), "    ");
        if !alarm.recordings.is_empty() {
            text += &paragraph(&format!("  based on: {}", alarm.recordings.join(", ")), "    ");
        }
    }
    text += "\n";
    for machine in &history.machines {
        let Some(last) = machine.last() else {
            let parts: Vec<String> = ["no result yet".to_owned()].into_iter().chain(open(machine)).collect();
            text += &paragraph(&format!("{}: {}", machine.name, parts.join(", ")), "  ");
            continue;
        };
        let age = age(history, machine).unwrap_or_default();
        let (count, most) = (count(machine), most(machine));
        let line = format!("{}: {} ({age}), {count}; {most}", machine.name, verdict(last));
        text += &paragraph(&line, "  ");
        let wrong: Vec<&Entry> =
            machine.recordings.iter().rev().filter(|entry| entry.verdict == ERROR).collect();
        for entry in wrong.iter().take(MOST_NAMED) {
            let why = entry.sentence.lines().next().unwrap_or_default();
            text += &paragraph(&format!("  cannot be diagnosed: {}: {why}", entry.recording), "    ");
        }
        if wrong.len() > MOST_NAMED {
            let more = wrong.len().saturating_sub(MOST_NAMED);
            text += &paragraph(&format!("  and {more} older ones: `--format json` has all of them"), "    ");
        }
    }
    text
}
