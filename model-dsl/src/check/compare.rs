//! The comparison itself. In: printed equations and derived ones. Out: a verdict for each error motion in
//! each equation.

use std::collections::{BTreeMap, BTreeSet};

use super::read::{Printed, Section, WHOLE_ERROR};
use super::{Comparison, Finding, Nominal, Report, Target, Verdict};
use crate::algebra::{Axis, Monomial, Polynomial, Rational, Symbol};
use crate::derivation::link_matrix;
use crate::equations::{Equations, Row};
use crate::machine::Machine;
use crate::source::SourceFile;

/// One side of an equation: what has no error motion, and the lever arm of each motion by its ISO name.
#[derive(Default)]
struct Side {
    nominal: Polynomial,
    arms: BTreeMap<String, Polynomial>,
    second_order: Polynomial,
}

/// Compares all sections.
pub(super) fn report(
    machine: &Machine,
    equations: &Equations,
    file: &SourceFile,
    sections: &[Section],
) -> Report {
    let compared = sections.iter().flat_map(|section| {
        let printed: Vec<Side> = section.equations.iter().map(|one| split(&one.value)).collect();
        let chosen: BTreeSet<String> = printed.iter().flat_map(|side| side.arms.keys().cloned()).collect();
        let left_out = move |name: &str| section.selection && !chosen.contains(name);
        let pairs: Vec<_> = section.equations.iter().zip(printed).collect();
        pairs.into_iter().map(move |(equation, mut side)| {
            let mut derived = derived(machine, equations, &equation.target);
            error_stands_apart(&mut derived, &mut side);
            let line = file.line_column(equation.left.span.start).0;
            let found = findings(machine, &derived, &side, &left_out);
            comparison(section, equation, line, derived.nominal, side, found)
        })
    });
    let compared: Vec<Comparison> = compared.collect();
    let unchecked = unchecked(equations, &compared);
    Report { machine: machine.name.clone(), file: file.name().to_owned(), equations: compared, unchecked }
}

fn comparison(
    section: &Section,
    equation: &Printed,
    line: usize,
    derived: Polynomial,
    printed: Side,
    findings: Vec<Finding>,
) -> Comparison {
    Comparison {
        section: section.name.clone(),
        left: equation.left.value.clone(),
        target: equation.target.clone(),
        span: equation.left.span,
        line,
        nominal: Nominal { derived, printed: printed.nominal },
        findings,
        second_order: printed.second_order,
    }
}

/// Directions without an equation, in a file that has equations of directions.
fn unchecked(equations: &Equations, compared: &[Comparison]) -> Vec<Axis> {
    let direction = |one: &Comparison| match one.target {
        Target::Position(axis) | Target::Error(axis) => Some(axis),
        Target::Direction(_) | Target::DirectionError(_) | Target::Entry { .. } => None,
    };
    let covered: BTreeSet<Axis> = compared.iter().filter_map(direction).collect();
    let rows = equations.rows.iter().map(|row| row.direction);
    rows.filter(|axis| !covered.is_empty() && !covered.contains(axis)).collect()
}

/// Splits a printed expression by its degree in error motions.
fn split(value: &Polynomial) -> Side {
    let mut side = Side { nominal: value.part(|monomial| degree(monomial) == 0), ..Side::default() };
    side.second_order = value.part(|monomial| degree(monomial) > 1);
    for (monomial, coefficient) in value.terms().filter(|(monomial, _)| degree(monomial) == 1) {
        let motion = monomial.factors().iter().find(|(symbol, _)| matches!(symbol, Symbol::Motion(_)));
        let Some((symbol, _)) = motion else { continue };
        let Some(rest) = monomial.without_one(symbol) else { continue };
        let slot = side.arms.entry(symbol.name().to_string()).or_default();
        *slot = &*slot + &Polynomial::monomial(rest, coefficient.clone());
    }
    side
}

/// `Px = ... + dPx` says nothing of the error motion by motion: only the rest is compared here.
fn error_stands_apart(derived: &mut Side, printed: &mut Side) {
    match printed.arms.remove(WHOLE_ERROR) {
        Some(arm) if arm.is_one() => derived.arms.clear(),
        // Any other multiple of the error is no position.
        Some(arm) => printed.nominal = &printed.nominal + &arm,
        None => {}
    }
}

/// How many error motions a monomial multiplies.
fn degree(monomial: &Monomial) -> u32 {
    let motions = monomial.factors().iter().filter(|(symbol, _)| matches!(symbol, Symbol::Motion(_)));
    motions.map(|(_, power)| *power).sum()
}

fn derived(machine: &Machine, equations: &Equations, target: &Target) -> Side {
    match target {
        Target::Position(axis) => whole(equations, equations.row(*axis)),
        Target::Error(axis) => error(equations, equations.row(*axis)),
        Target::Direction(axis) => whole(equations, equations.orientation_row(*axis)),
        Target::DirectionError(axis) => error(equations, equations.orientation_row(*axis)),
        Target::Entry { link, row, column } => {
            entry(machine, *link, row.wrapping_sub(1), column.wrapping_sub(1))
        }
    }
}

/// A row with its nominal part.
fn whole(equations: &Equations, row: Option<&Row>) -> Side {
    let nominal = row.map(|row| row.nominal.clone()).unwrap_or_default();
    Side { nominal, ..error(equations, row) }
}

/// The error of a row alone.
fn error(equations: &Equations, row: Option<&Row>) -> Side {
    let terms = row.map(|row| row.terms.as_slice()).unwrap_or_default();
    let arm = |term: &crate::equations::Term| {
        equations.motions.get(term.motion).map(|motion| (motion.name.clone(), term.arm.clone()))
    };
    Side { arms: terms.iter().filter_map(arm).collect(), ..Side::default() }
}

fn entry(machine: &Machine, link: usize, row: usize, column: usize) -> Side {
    let entry = link_matrix(machine, link).entry(row, column).unwrap_or_default();
    let arm = |(number, arm): (usize, &Polynomial)| {
        machine.motions.get(number).map(|motion| (motion.name.clone(), arm.clone()))
    };
    Side {
        nominal: entry.nominal_part().clone(),
        arms: entry.error_part().filter_map(arm).collect(),
        ..Side::default()
    }
}

fn findings(
    machine: &Machine,
    derived: &Side,
    printed: &Side,
    left_out: &impl Fn(&str) -> bool,
) -> Vec<Finding> {
    let arm = |side: &Side, name: &str| side.arms.get(name).cloned().unwrap_or_default();
    let motions = machine.motions.iter().map(|motion| {
        let (derived, printed) = (arm(derived, &motion.name), arm(printed, &motion.name));
        let verdict = match Verdict::on(&derived, &printed) {
            Verdict::Missing if left_out(&motion.name) => Verdict::LeftOut,
            verdict => verdict,
        };
        let of_symbol = |arm: Polynomial| if motion.sign < 0 { -&arm } else { arm };
        let (derived, printed) = (of_symbol(derived), of_symbol(printed));
        Finding { name: motion.name.clone(), symbol: motion.symbol.clone(), derived, printed, verdict }
    });
    motions.filter(|finding| !(finding.derived.is_zero() && finding.printed.is_zero())).collect()
}

/// Where two polynomials differ, monomial by monomial.
pub(super) fn differences(derived: &Polynomial, printed: &Polynomial) -> Vec<(Verdict, Polynomial)> {
    let in_derived = derived.terms().map(|(monomial, _)| monomial);
    let in_printed = printed.terms().map(|(monomial, _)| monomial);
    let monomials: BTreeSet<&Monomial> = in_derived.chain(in_printed).collect();
    let part = |side: &Polynomial, monomial: &Monomial| {
        let found: Option<&Rational> = side.terms().find(|(own, _)| *own == monomial).map(|(_, value)| value);
        found.map(|value| Polynomial::monomial(monomial.clone(), value.clone())).unwrap_or_default()
    };
    let compared = monomials.into_iter().map(|monomial| {
        let (derived, printed) = (part(derived, monomial), part(printed, monomial));
        let verdict = Verdict::on(&derived, &printed);
        (verdict, if verdict == Verdict::Extra { printed } else { derived })
    });
    compared.filter(|(verdict, _)| verdict.disagrees()).collect()
}
