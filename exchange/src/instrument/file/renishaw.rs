//! Renishaw's text of a measurement at targets (`.rtl`, `.rta` and its relatives). In: the text. Out: its readings.
//!
//! Sections with a name and `::`, in which entries `key: value` stand; they differ between versions, so that they are read by
//! name. A linear measurement (`Owner: Linear`) has its targets in mm and its deviations in um; of the others the format does
//! not tell the units, and the set-up must.

use std::collections::BTreeSet;

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::quantity::{Unit, parse_unit};
use model_dsl::source::{SourceFile, Span};

use super::super::measured::{Flagged, Measured, Reading, Run};
use super::cell::{Piece, shown};
use super::section::{Section, is, sections};

/// Reads the whole file.
pub(super) fn read(source: SourceFile, diagnostics: &mut Diagnostics) -> Option<Measured> {
    let sections = sections(source.text());
    let find = |name: &str| sections.iter().find(|section| section.name == name);
    let mut need = |name: &str| {
        let found = find(name);
        if found.is_none() {
            diagnostics.push(missing(name, last(&sections)));
        }
        found
    };
    let (targets, deviations) = (need("TARGET DATA"), need("DEVIATIONS"));
    let (targets, deviations) = (targets?, deviations?);
    let listed = read_targets(targets, diagnostics)?;
    let count = find("RUNS").and_then(|runs| read_count(runs, "Run-count", diagnostics));
    let runs = read_runs(deviations, listed.len(), count.as_ref().map(|count| count.0), diagnostics)?;
    tell_broken_off(&runs, listed.len(), count, diagnostics);
    if find("EOF").is_none() {
        diagnostics.push(without_end(last(&sections)));
    }
    let linear = find("HEADER").is_some_and(is_linear);
    let about = find("USER-TEXT").map(about).unwrap_or_default();
    let flagged = flags(targets);
    let known = |unit: &str| parse_unit(unit).ok().filter(|_| linear);
    let (target_unit, deviation_unit): (Option<Unit>, Option<Unit>) = (known("mm"), known("um"));
    drop(sections);
    Some(Measured { targets: listed, target_unit, deviation_unit, runs, flagged, about, source })
}

fn last(sections: &[Section<'_>]) -> Span {
    sections.last().map_or(Span::default(), |section| section.span)
}

fn missing(name: &str, span: Span) -> Diagnostic {
    let message = format!("the file has no section `{name}::`");
    let help = "check whether the file was cut off; a measurement at targets has `TARGET DATA::`, `RUNS::` and `DEVIATIONS::`";
    Diagnostic::error("E0923", span, message).help(help)
}

fn without_end(span: Span) -> Diagnostic {
    let message = "the file ends without `EOF::`";
    let help = "compare it with the file on the instrument; it may have been cut off";
    Diagnostic::warning("W0902", span, message).help(help)
}

/// Whether the header says that displacements along the axis were measured.
fn is_linear(header: &Section<'_>) -> bool {
    match header.entry("Owner") {
        Some(owner) if !owner.text.is_empty() => owner.text.eq_ignore_ascii_case("linear"),
        _ => header.entry("File type").is_some_and(|kind| kind.text.eq_ignore_ascii_case("rtl")),
    }
}

fn about(user: &Section<'_>) -> Vec<(String, String)> {
    let entries = user.entries().filter(|(_, value)| !value.text.is_empty());
    entries.map(|(key, value)| (key.to_owned(), value.text.to_owned())).collect()
}

/// `Flags: 0 1 2 0` for one direction, `0 0 2 0` for both.
fn flags(targets: &Section<'_>) -> Option<Flagged> {
    match targets.entry("Flags")?.words().nth(1)?.text {
        "0" => Some(Flagged::BothWays),
        "1" => Some(Flagged::OneWay),
        _ => None,
    }
}

/// A count with the place of its number.
fn read_count(section: &Section<'_>, key: &str, diagnostics: &mut Diagnostics) -> Option<(u32, Span)> {
    let value = section.entry(key)?;
    value.ordinal(&format!("`{key}`"), diagnostics).map(|count| (count, value.span))
}

/// The targets, which may go on over several lines; their number must be the one that the file tells.
fn read_targets(section: &Section<'_>, diagnostics: &mut Diagnostics) -> Option<Vec<f64>> {
    let pieces = target_pieces(section);
    let Some(pieces) = pieces.filter(|pieces| !pieces.is_empty()) else {
        let mistake = Diagnostic::error("E0923", section.span, "the file lists no targets");
        diagnostics.push(mistake.help("write one position for each target after `Targets :`"));
        return None;
    };
    let numbers: Vec<Option<f64>> =
        pieces.iter().map(|piece| piece.number("a target", diagnostics)).collect();
    let numbers: Vec<f64> = numbers.into_iter().collect::<Option<_>>()?;
    if let Some((count, span)) = read_count(section, "Target-count", diagnostics)
        && usize::try_from(count).is_ok_and(|count| count != numbers.len())
    {
        let message = format!("the file gives {count} as the number of targets but lists {}", numbers.len());
        diagnostics.push(
            Diagnostic::error("E0924", span, message).help("check whether the file was changed or cut off"),
        );
        return None;
    }
    refuse_equal(&numbers, &pieces, diagnostics)?;
    Some(numbers)
}

/// The words behind `Targets :`, up to the next line with a key.
fn target_pieces<'t>(section: &Section<'t>) -> Option<Vec<Piece<'t>>> {
    let mut rest = section.lines.iter().skip_while(|line| !starts(line, "Targets"));
    let (_, first) = rest.next()?.split_once(':')?;
    let more = rest.take_while(|line| !line.text.contains(':'));
    Some(first.words().chain(more.flat_map(|line| line.words())).collect())
}

fn starts(line: &Piece<'_>, key: &str) -> bool {
    line.split_once(':').is_some_and(|(name, _)| is(name.text, key))
}

/// Reports two targets at one place (E0928).
fn refuse_equal(numbers: &[f64], pieces: &[Piece<'_>], diagnostics: &mut Diagnostics) -> Option<()> {
    let mut order: Vec<usize> = (0..numbers.len()).collect();
    let at = |index: usize| numbers.get(index).copied().unwrap_or(f64::NAN);
    order.sort_by(|one, other| at(*one).total_cmp(&at(*other)).then(one.cmp(other)));
    let equal = order.windows(2).find_map(|pair| {
        let (one, other) = (*pair.first()?, *pair.last()?);
        (at(one) == at(other)).then_some((pieces.get(one)?.span, pieces.get(other)?))
    });
    let Some((first, again)) = equal else { return Some(()) };
    let message = format!("two targets are at `{}`", shown(again.text));
    let mistake = Diagnostic::error("E0928", again.span, message).also(first, "the first of them");
    diagnostics.push(mistake.help("give each target its own place"));
    None
}

/// The rows `run target deviation`, gathered to runs in the order of the file.
fn read_runs(
    section: &Section<'_>,
    targets: usize,
    most: Option<u32>,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Run>> {
    let mut runs: Vec<Run> = Vec::new();
    let mut places = std::collections::BTreeMap::new();
    let mut seen = BTreeSet::new();
    let rows = section.lines.iter().filter(|line| !line.text.ends_with(':'));
    for line in rows {
        let row = read_row(*line, targets, most, diagnostics)?;
        if !seen.insert((row.run, row.reading.target)) {
            let message =
                format!("run {} has a second reading at target {}", row.run, row.reading.target + 1);
            let mistake = Diagnostic::error("E0927", line.span, message);
            diagnostics.push(
                mistake.help(
                    "check whether a part of the file was copied in twice; a run reads each target once",
                ),
            );
            return None;
        }
        let place = *places.entry(row.run).or_insert(runs.len());
        match runs.get_mut(place) {
            Some(run) => run.readings.push(row.reading),
            None => {
                runs.push(Run { number: row.run, told: None, readings: vec![row.reading], span: line.span })
            }
        }
    }
    if runs.is_empty() {
        let mistake = Diagnostic::error("E0923", section.span, "the file has no deviations");
        diagnostics.push(
            mistake.help("check whether the file was cut off; each row must be `run target deviation`"),
        );
        return None;
    }
    Some(runs)
}

struct Row {
    run: u32,
    reading: Reading,
}

fn read_row(
    line: Piece<'_>,
    targets: usize,
    most: Option<u32>,
    diagnostics: &mut Diagnostics,
) -> Option<Row> {
    let words: Vec<Piece<'_>> = line.words().collect();
    let [run, target, deviation] = words.as_slice() else {
        let message = format!("a row must be `run target deviation`, found `{}`", shown(line.text));
        diagnostics.push(
            Diagnostic::error("E0923", line.span, message)
                .help("check whether the file was changed or cut off"),
        );
        return None;
    };
    let number = run.ordinal("the run", diagnostics)?;
    let index = target.ordinal("the target", diagnostics)?;
    let deviation = deviation.number("the deviation", diagnostics)?;
    if let Some(most) = most.filter(|most| number > *most) {
        diagnostics.push(out_of_range(run, "run", u64::from(most)));
        return None;
    }
    let target_index = usize::try_from(index).ok().filter(|index| *index <= targets);
    let Some(target_index) = target_index else {
        diagnostics.push(out_of_range(target, "target", u64::try_from(targets).unwrap_or(u64::MAX)));
        return None;
    };
    Some(Row { run: number, reading: Reading { target: target_index - 1, deviation } })
}

fn out_of_range(piece: &Piece<'_>, what: &str, most: u64) -> Diagnostic {
    let message = format!("there is no {what} {}: the file gives {most} as their number", shown(piece.text));
    Diagnostic::error("E0926", piece.span, message)
        .help("check whether the file was changed, or put together from two files")
}

/// Tells runs that lack readings, or are not there at all (W0901).
fn tell_broken_off(runs: &[Run], targets: usize, count: Option<(u32, Span)>, diagnostics: &mut Diagnostics) {
    for run in runs.iter().filter(|run| run.readings.len() < targets) {
        let message = format!("run {} has {} of {targets} readings", run.number, run.readings.len());
        let help = "measure the run again if it matters; its missing targets have fewer readings";
        diagnostics.push(Diagnostic::warning("W0901", run.span, message).help(help));
    }
    if let Some((count, span)) = count
        && usize::try_from(count).is_ok_and(|count| runs.len() < count)
    {
        let message = format!("the file gives {count} as the number of runs but has {}", runs.len());
        let help = "the measurement was broken off; the existing readings are used";
        diagnostics.push(Diagnostic::warning("W0901", span, message).help(help));
    }
}
