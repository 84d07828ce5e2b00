//! What a report of a positioning test says of the test itself, as ISO 230-2 asks for it. In: a line and its evaluation. Out: a label and
//! what the recording knows of it; a blank where it knows nothing, to be filled in by hand.

use crate::Evaluation;
use crate::positioning::{Kind, Positioning};

/// What stands where the recording knows nothing.
const BLANK: &str = "________";

/// The lines of the head.
pub(super) fn of(line: &Positioning, evaluation: &Evaluation) -> Vec<(&'static str, String)> {
    let blank = || BLANK.to_owned();
    let unit = line.unit;
    let counted: Vec<f64> = line.targets.iter().map(|target| target.position).collect();
    let ends = counted.first().zip(counted.last());
    let range = ends.map_or_else(blank, |(first, last)| {
        format!("{} from {} to {}", counted.len(), unit.place(*first), unit.place(*last))
    });
    let others = line.at.iter().map(|(axis, at, unit)| format!("{axis} {}", unit.place(*at)));
    let others: Vec<String> = others.collect();
    let kind = match line.kind {
        Kind::Slide => "slide",
        Kind::Rotary => "rotary axis",
        Kind::FaceDiagonal | Kind::BodyDiagonal => "diagonal of",
    };
    vec![
        ("machine", format!("{}; maker and serial number {BLANK}", evaluation.machine)),
        ("axis", format!("{kind} {}", line.axes.join(" and "))),
        ("instrument", format!("{}; maker and serial number {BLANK}", evaluation.instrument)),
        ("date", evaluation.date.clone().unwrap_or_else(blank)),
        ("other axes at", if others.is_empty() { blank() } else { others.join(", ") }),
        ("temperatures", temperatures(evaluation)),
        ("runs", runs(line)),
        ("targets", range),
        ("feed, dwell, compensation used", blank()),
    ]
}

/// Each sensor from its least to its greatest value.
fn temperatures(evaluation: &Evaluation) -> String {
    let told = evaluation.temperatures.iter().map(|(name, [low, high])| {
        if (high - low) < 0.05 {
            format!("{name} {low:.1} degC")
        } else {
            format!("{name} {low:.1} to {high:.1} degC")
        }
    });
    let told: Vec<String> = told.collect();
    if told.is_empty() { BLANK.to_owned() } else { told.join(", ") }
}

/// How often each target was read from either side.
fn runs(line: &Positioning) -> String {
    let side = |up: bool| {
        let counts = line.targets.iter().filter_map(|target| if up { target.up } else { target.down });
        let counts: Vec<usize> = counts.map(|side| side.readings).collect();
        match (counts.iter().min(), counts.iter().max()) {
            (Some(least), Some(most)) if least == most => format!("{most}"),
            (Some(least), Some(most)) => format!("{least} to {most}"),
            _ => "none".to_owned(),
        }
    };
    format!("{} upwards, {} downwards", side(true), side(false))
}
