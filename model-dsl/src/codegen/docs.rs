//! The words of generated code: what each item means, its unit and its equation.

use crate::equations::{Equations, Motion, Names, Row};
fn infix(p: &crate::algebra::Polynomial) -> String { format!("{}", p.len()) }
fn sum_of_motions(_: &Equations, r: &Row, _: Names) -> String { format!("{}", r.terms.len()) }

/// What a machine is, in a line.
pub(super) fn machine(equations: &Equations) -> String {
    let title = equations.title.as_deref().unwrap_or(&equations.machine);
    match &equations.source {
        Some(source) => format!("{title}. Model: {source}."),
        None => format!("{title}."),
    }
}

/// An error motion with its symbol, meaning and unit.
pub(super) fn motion(motion: &Motion) -> String {
    let unit = if motion.angular { "rad" } else { "mm" };
    let symbol = if motion.symbol == motion.name { String::new() } else { format!(" (`{}`)", motion.symbol) };
    let sense = if motion.against_iso { ", counted against the sense of ISO 230-1" } else { "" };
    format!("{}{symbol}: {}{sense} \\[{unit}\\].", motion.name, motion.meaning)
}

/// The equations of the error, one line a direction.
pub(super) fn error_equations(equations: &Equations) -> String {
    block(equations, "dP", |row| sum_of_motions(equations, row, Names::Symbols))
}

/// The equations of the nominal position, one line a direction.
pub(super) fn nominal_equations(equations: &Equations) -> String {
    block(equations, "P", |row| infix(&row.nominal))
}

fn block(equations: &Equations, left: &str, right: impl Fn(&Row) -> String) -> String {
    let mut text = String::from("```text\n");
    for row in &equations.rows {
        let direction = row.direction.letter().to_ascii_lowercase();
        text.push_str(&format!("{left}{direction} = {}\n", right(row)));
    }
    text.push_str("```");
    text
}
