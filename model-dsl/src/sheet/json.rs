//! JSON of schema `abbe-equations/1`. In: equations. Out: one object whose expressions are plain infix text.
//!
//! An arm is that of the motion under its ISO name. A term holds `"symbol_sign": -1` where the symbol is counted against the
//! ISO sense: its arm is the opposite one.
//!
//! Where the direction of the tool is derived, `orientation` holds it as `directions` holds the tip: I, J, K.
//!
//! Where the machine has rotary axes, `brackets` gives names to what occurs more than once, and `factored` says the same as the
//! expression before it, in these names; an expression without it is the shortest one already.

use super::brackets::Brackets;
use super::text::Plain;
use super::tree::Expression;
use super::{infix, line, taken_names};
use crate::algebra::Axis;
use crate::equations::{Equations, Names, Row, Term};
use crate::quoted;

/// The whole object, with a line end after it.
pub fn object(equations: &Equations) -> String {
    let written = Brackets::new(equations, taken_names(equations, &[Names::Iso, Names::Symbols]));
    let rows = |rows: &[Row], letter: fn(Axis) -> char| {
        let rows = rows.iter().map(|one| row(one, letter(one.direction), equations, &written));
        rows.collect::<Vec<_>>().join(", ")
    };
    let orientation = match equations.orientation.as_slice() {
        [] => String::new(),
        own => format!(",\n  \"orientation\": [{}]", rows(own, Axis::direction_letter)),
    };
    format!(
        "{{\n  \"schema\": \"abbe-equations/1\",\n  \"machine\": {},\n{}  \"directions\": [{}]{orientation}\n}}\n",
        quoted(&equations.machine),
        brackets(&written),
        rows(&equations.rows, Axis::letter)
    )
}

/// The named brackets, each before those in which it stands; no line where there are none.
fn brackets(written: &Brackets) -> String {
    let bracket = |(letter, value): (&super::letter::Letter, Expression)| {
        let value = quoted(&line(&Plain, &value));
        format!("\n    {{\"name\": {}, \"value\": {value}}}", quoted(&letter.plain))
    };
    let brackets: Vec<String> = written.definitions().map(bracket).collect();
    if brackets.is_empty() {
        String::new()
    } else {
        format!("  \"brackets\": [{}\n  ],\n", brackets.join(","))
    }
}

fn row(row: &Row, letter: char, equations: &Equations, written: &Brackets) -> String {
    let terms: Vec<String> = row.terms.iter().filter_map(|one| term(one, equations, written)).collect();
    let nominal = infix(&row.nominal);
    let factored = factored("\n    \"nominal_factored\"", &nominal, &written.sum(&row.nominal));
    format!(
        "{{\n    \"direction\": {},\n    \"nominal\": {}{factored},\n    \"terms\": [{}]\n  }}",
        quoted(&letter.to_string()),
        quoted(&nominal),
        terms.join(",")
    )
}

fn term(term: &Term, equations: &Equations, written: &Brackets) -> Option<String> {
    let motion = equations.motions.get(term.motion)?;
    let sign = if motion.symbol_against_iso { ", \"symbol_sign\": -1" } else { "" };
    let arm = infix(&term.arm);
    let factored = factored(" \"factored\"", &arm, &written.expression(&term.arm));
    Some(format!(
        "\n      {{\"motion\": {}, \"symbol\": {}, \"arm\": {}{factored}{sign}}}",
        quoted(&motion.name),
        quoted(&motion.symbol),
        quoted(&arm)
    ))
}

/// A key with the factored form of an expression, where that differs from the expanded one.
fn factored(key: &str, expanded: &str, factored: &Expression) -> String {
    let factored = line(&Plain, factored);
    if factored == expanded { String::new() } else { format!(",{key}: {}", quoted(&factored)) }
}
