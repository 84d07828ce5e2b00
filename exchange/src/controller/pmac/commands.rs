//! Commands for a PMAC. In: effects. Out: text of `DEFINE COMP` and `DEFINE BLCOMP` with their entries; and back.

use std::fmt::Write;

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::SourceFile;

use super::super::effects::Effect;
use super::super::lines::{Line, lines};
use super::super::nodes::is_a_turn;
use super::super::refused::Refused;
use super::tables::{PARTS, Pmac, Rolling, Screw, TABLES, index_signed, number};

/// The form of a line, for findings.
const FORM: &str = "a table is `#1 DEFINE COMP 100,#1D,#2,1000000` or `#1 DEFINE BLCOMP 100,1000000` and as many whole numbers";

/// All commands, the tables of high motors first, as the controller wants them.
pub(super) fn text(pmac: &Pmac, screws: &[Effect], backlash: &[Effect]) -> Result<String, Refused> {
    let mut text =
        String::from("; leadscrew and backlash tables; entries in 1/16 count of the target motor\nI51=0\n");
    for (number, effect) in screws.iter().enumerate().rev() {
        let (source, target) = (motor(pmac, effect.source), motor(pmac, effect.target));
        let zero = at_zero(effect, &effect.forward);
        let values = match effect.source == effect.target {
            true => effect.forward.iter().map(|value| value - zero).collect(),
            false => less(&effect.mean(), at_zero(effect, &effect.mean())),
        };
        let (entries, length) = entries(pmac, effect, &values)?;
        let head = format!("DEFINE COMP {},#{source}D,#{target},{length}", entries.len());
        write_table(&mut text, &(number + 1).to_string(), &head, &entries);
    }
    for effect in backlash.iter().rev() {
        let own = motor(pmac, effect.source);
        let lost: Vec<f64> =
            effect.forward.iter().zip(&effect.reverse).map(|(forward, reverse)| forward - reverse).collect();
        let zero = at_zero(effect, &lost);
        let (entries, length) = entries(pmac, effect, &less(&lost, zero))?;
        write_table(&mut text, own, &format!("DEFINE BLCOMP {},{length}", entries.len()), &entries);
        let constant = counts(pmac, effect.source).map_or(0.0, |counts| (zero * counts * PARTS).round());
        let _ = writeln!(text, "I{own}86={constant}");
    }
    text.push_str("I51=1\n");
    Ok(text)
}

/// The value of an own effect at zero.
fn at_zero(effect: &Effect, values: &[f64]) -> f64 {
    let zero = effect.nodes.iter().position(|place| *place == 0.0);
    zero.and_then(|zero| values.get(zero)).copied().unwrap_or_default()
}

fn less(values: &[f64], zero: f64) -> Vec<f64> {
    values.iter().map(|value| value - zero).collect()
}

fn motor(pmac: &Pmac, axis: usize) -> &str {
    pmac.motors.get(axis).map_or("", |motor| motor.number.as_str())
}

fn counts(pmac: &Pmac, axis: usize) -> Option<f64> {
    pmac.motors.get(axis).and_then(|motor| motor.counts)
}

fn write_table(text: &mut String, motor: &str, head: &str, entries: &[i64]) {
    let _ = writeln!(text, "#{motor} {head}");
    for row in entries.chunks(10) {
        let row: Vec<String> = row.iter().map(ToString::to_string).collect();
        let _ = writeln!(text, "{}", row.join(" "));
    }
}

/// The entries from one spacing on, what lies below zero at the end, and the count length.
///
/// One spacing more than the range is long: over it the end of the range goes over into its beginning. The ends of a whole turn are
/// one place, and need no spacing between them.
fn entries(pmac: &Pmac, effect: &Effect, values: &[f64]) -> Result<(Vec<i64>, i64), Refused> {
    let (Some(from), Some(to)) = (counts(pmac, effect.source), counts(pmac, effect.target)) else {
        let help = "give the counts per degree: --counts C=10000";
        return Err(Refused::new("a rotary axis without counts has no table", help));
    };
    let below = effect.nodes.iter().filter(|place| **place < 0.0).count();
    let (negative, positive) = values.split_at(below.min(values.len()));
    let parts = |value: &f64| index_signed((value * to * PARTS).round());
    // The value at zero is zero, and stands last; the gap of one spacing takes the last value above.
    let (above, gap) = match positive.split_last() {
        Some((_, above)) if goes_round(pmac, effect) => (above, None),
        _ => (positive, positive.last()),
    };
    let above = above.iter().skip(1);
    let all: Vec<i64> = above.chain(gap).chain(negative).map(parts).chain([0]).collect();
    let step = effect.nodes.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let length = step * from * number(i64::try_from(all.len()).unwrap_or(i64::MAX));
    if (length - length.round()).abs() > 1e-6 {
        let what = "the length of a table is not a whole number of counts";
        return Err(Refused::new(
            what,
            "choose a step with a whole number of counts, with --points or --range",
        ));
    }
    Ok((all, index_signed(length.round())))
}

/// Whether an effect is over one whole turn of a rotary axis.
fn goes_round(pmac: &Pmac, effect: &Effect) -> bool {
    pmac.motors.get(effect.source).is_some_and(|motor| motor.turns) && is_a_turn(&effect.nodes)
}

/// Reads commands into the controller.
pub(super) fn load(pmac: &mut Pmac, source: &SourceFile, diagnostics: &mut Diagnostics) {
    let all: Vec<Line<'_>> = lines(source, ";").collect();
    let mut rest = all.as_slice();
    while let Some((line, after)) = rest.split_first() {
        rest = after;
        if let Some(head) = line.text.split_once("DEFINE ").map(|(_, head)| head) {
            let length = after.iter().position(|line| !is_entries(line.text)).unwrap_or(after.len());
            let (body, others) = after.split_at(length);
            rest = others;
            let entries: Vec<i64> =
                body.iter().flat_map(|line| line.words()).filter_map(|word| word.text.parse().ok()).collect();
            if define(pmac, line, head, entries).is_none() {
                line.malformed(FORM, diagnostics);
            }
        } else if assign(pmac, line.text).is_none() {
            line.malformed("besides tables, only I51=1 and Ixx86= are read", diagnostics);
        }
    }
    if pmac.screws.len() > TABLES {
        let message = format!("{} leadscrew tables; a controller has {TABLES}", pmac.screws.len());
        let place = all.first().map_or_else(Default::default, |line| line.span);
        diagnostics.push(Diagnostic::error("E0803", place, message).help("use one table for each motor"));
    }
}

fn is_entries(text: &str) -> bool {
    text.split_whitespace().all(|word| word.parse::<i64>().is_ok())
}

/// Takes a table; nothing where its head has another form or its entries another number.
fn define(pmac: &mut Pmac, line: &Line<'_>, head: &str, entries: Vec<i64>) -> Option<()> {
    let owner = line.text.strip_prefix('#')?.split_whitespace().next()?;
    let (kind, rest) = head.split_once(' ')?;
    let parts: Vec<&str> = rest.split(',').map(str::trim).collect();
    let axis = |pmac: &Pmac, number: &str| pmac.motors.iter().position(|motor| motor.number == number);
    let (count, length) = (parts.first()?.parse::<usize>().ok()?, parts.last()?.parse::<u32>().ok()?);
    let table = Rolling { length: f64::from(length), entries };
    if table.entries.len() != count || length == 0 {
        return None;
    }
    match (kind, parts.as_slice()) {
        ("COMP", [_, source, target, _]) => {
            let source = axis(pmac, source.strip_prefix('#')?.trim_end_matches('D'))?;
            let target = axis(pmac, target.strip_prefix('#')?)?;
            pmac.screws.push(Screw { source, target, table });
        }
        ("BLCOMP", [_, _]) => {
            let own = axis(pmac, owner)?;
            pmac.motors.get_mut(own)?.backlash = Some(table);
        }
        _ => return None,
    }
    Some(())
}

fn assign(pmac: &mut Pmac, text: &str) -> Option<()> {
    let (name, value) = text.split_once('=')?;
    let name = name.trim().strip_prefix('I')?;
    if name == "51" {
        return Some(());
    }
    let motor = name.strip_suffix("86")?;
    let slot = pmac.motors.iter_mut().find(|known| known.number == motor)?;
    slot.constant = value.trim().parse().ok().filter(|value: &f64| value.is_finite())?;
    Some(())
}
