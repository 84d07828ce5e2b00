//! The report as text. In: a history. Out: alarms, then a line a machine.

use super::{age, count, most, open};
use crate::history::{BOUND, History};

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
            "{} machines until {}: {alarms}. {} series and comparisons were tested; the chance of any false alarm among all of \
             them is at most {} %.",
            history.machines.len(),
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
        let line = format!("{}: {} ({age}), {count}; {most}", machine.name, last.verdict);
        text += &paragraph(&line, "  ");
    }
    text
}
