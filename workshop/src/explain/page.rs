//! How an explanation looks. In: entries. Out: text of at most 100 columns.

use std::fmt::Write;

use textwrap::{Options, WordSplitter, fill};

use model_dsl::calibration::factor::vocabulary::{FactorEntry, FactorHolds, Measure};

use super::entry::Entry;

pub(super) const WIDTH: usize = 100;

/// Everything there is to explain, a line each.
pub(super) fn overview(
    codes: &[Entry<'_>],
    terms: &[Entry<'_>],
    factors: &[(&FactorEntry, Entry<'_>)],
    words: &[&str],
) -> String {
    let mut text = String::from("Terms\n-----\n\n");
    for term in terms {
        line(&mut text, term.name, 16, term.part("value").unwrap_or_default());
    }
    text.push_str("\nFactors of terms, under `times`\n-------------------------------\n\n");
    for (factor, _) in factors {
        line(&mut text, factor.name, 16, factor.value);
    }
    text.push_str("\nDiagnostics\n-----------\n\n");
    for code in codes {
        line(&mut text, code.name, 7, code.title);
    }
    text.push_str("\nWords of the glossary\n---------------------\n\n");
    // A word is found by its whole name, and so none is broken at a hyphen.
    let whole = Options::new(WIDTH).word_splitter(WordSplitter::NoHyphenation);
    put(&mut text, &fill(&words.join(", "), whole));
    text.push_str("\n`abbe explain NAME` tells more of each, of an error motion by its name, such as EX0C or EA(0Y)C, of a\n\
         topology word such as XYFZ, and of each word of the guide's glossary, such as squareness.\n");
    text
}

fn line(text: &mut String, name: &str, column: usize, words: &str) {
    let indent = " ".repeat(column);
    let name = format!("{name:<column$}");
    put(text, &fill(words, Options::new(WIDTH).initial_indent(&name).subsequent_indent(&indent)));
}

/// The page of a diagnostic.
pub(super) fn code(entry: &Entry<'_>) -> String {
    let mut text = format!("{}: {}\n\n", entry.name, entry.title);
    put(&mut text, &fill(entry.part("").unwrap_or_default(), WIDTH));
    if let Some(kind) = entry.part("example").and_then(example) {
        section(&mut text, &format!("Example, {kind}"));
        block(&mut text, &entry.example('+'));
    }
    section(&mut text, "Corrected");
    put(&mut text, &fill(entry.part("mend").unwrap_or_default(), WIDTH));
    let mended = entry.example('-');
    if !mended.is_empty() {
        text.push('\n');
        block(&mut text, &mended);
    }
    text
}

/// What an example is, in words; nothing where the entry has none.
fn example(kind: &str) -> Option<String> {
    let (kind, more) =
        kind.split_once(", ").map_or((kind, String::new()), |(kind, more)| (kind, format!(", {more}")));
    if kind == "none" {
        return None;
    }
    let words = match kind.split_once(' ') {
        Some((kind, _)) => format!("as part of a {}{more}", file(kind)),
        None => format!("as a whole {}{more}", file(kind)),
    };
    Some(words)
}

fn file(kind: &str) -> &str {
    match kind {
        "machine" => "machine file",
        "calibration" => "calibration file",
        "recording" => "recording file",
        "path" => "path file",
        "set-up" => "set-up file",
        "measurement" => "measurement as a laser's program writes it",
        "correction" => "correction as a controller saves it",
        "volumetric" => "file for a volumetric compensation, ISG CSV",
        "equations" => "equation file for the machine excello-921",
        other => other,
    }
}

/// The page of a term.
pub(super) fn term(entry: &Entry<'_>) -> String {
    let kind =
        if entry.title.is_empty() { "a term of an error motion" } else { "a setting of an instrument" };
    let mut text = format!("{}: {kind}\n\n", entry.name);
    let what = diagnosis::meaning(entry.name).or(entry.part("is")).unwrap_or_default();
    put(&mut text, &fill(what, WIDTH));
    let parts = [
        ("Its value", "value"),
        ("In a recording", "shows"),
        ("What looks the same", "also"),
        ("How to measure it", "measure"),
        ("How to remove it", "remove"),
    ];
    for (title, name) in parts {
        section(&mut text, title);
        put(&mut text, &fill(entry.part(name).unwrap_or_default(), WIDTH));
    }
    let form =
        if entry.part("form").is_some() { "In a calibration file, under `errors`" } else { "In a path file" };
    section(&mut text, form);
    block(&mut text, &entry.example('-'));
    text
}

/// The page of a factor.
pub(super) fn factor(known: &FactorEntry, entry: &Entry<'_>) -> String {
    let mut text = format!("{}: a factor of a term\n\n", known.name);
    put(
        &mut text,
        &fill(&format!("It multiplies a term under `times`. Examples: {}.", known.physics), WIDTH),
    );
    section(&mut text, "Its value");
    put(&mut text, &fill(known.value, WIDTH));
    section(&mut text, "Its keys");
    for key in known.keys {
        let absent = key.or.map_or_else(String::new, |absent| format!("; if left out: {absent}"));
        line(&mut text, key.name, 16, &format!("{}{absent}", holds(key.holds)));
    }
    section(&mut text, "In real time");
    let compensated = known.not_compensable.map_or_else(
        || "A controller knows it in time, so it can compensate a term with this factor.".to_owned(),
        |reason| format!("No controller compensates a term with this factor: {reason}."),
    );
    put(&mut text, &fill(&compensated, WIDTH));
    section(&mut text, "In a calibration file, under `errors`");
    block(&mut text, &entry.example('-'));
    text
}

/// What stands behind a key of a factor, in words.
fn holds(holds: FactorHolds) -> &'static str {
    match holds {
        FactorHolds::Axis => "the letter of an axis",
        FactorHolds::Sensor => "the name of a sensor",
        FactorHolds::Load => "the name of a load",
        FactorHolds::Power => "1, 2 or 3",
        FactorHolds::Range(_) => {
            "two values of the state, the lower first; beyond them the factor is constant"
        }
        FactorHolds::Nodes(_) => "positions in rising order",
        FactorHolds::Ratios => "bare numbers, one for each node",
        FactorHolds::Amount(measure, _) => match measure {
            Measure::Position => "a position",
            Measure::Speed => "a speed, `mm/s`",
            Measure::Acceleration => "an acceleration, `mm/s^2`",
            Measure::Temperature => "a temperature, `degC`",
            Measure::Step => "a temperature difference, `K`",
            Measure::Rise => "a temperature difference per unit of speed, `mK.s/mm`",
            Measure::Time => "a time, `s`",
            Measure::Angle => "an angle, `deg`",
            Measure::Load => "a load, `N`",
            Measure::Rate => "turns per second for each unit of the load, `Hz/%`",
        },
    }
}

fn section(text: &mut String, title: &str) {
    put(text, &format!("\n{title}\n{}\n", "-".repeat(title.len())));
}

fn block(text: &mut String, lines: &[&str]) {
    for line in lines {
        put(text, &format!("    {line}"));
    }
}

fn put(text: &mut String, line: &str) {
    // A string takes every line.
    let _ = writeln!(text, "{line}");
}
