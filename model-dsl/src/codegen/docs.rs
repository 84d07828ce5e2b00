//! The words of generated code: what each item means, its unit and its equation.

use proc_macro2::TokenStream;
use quote::quote;

use crate::equations::{Equations, Motion, Names, Row};
use crate::sheet::{direction_error_lines, error_lines, infix};

/// Documentation as attributes, one a line, so that it is printed as `///` lines.
pub(super) fn attributes(text: &str) -> TokenStream {
    let lines = text.lines().map(|line| if line.is_empty() { String::new() } else { format!(" {line}") });
    lines.map(|line| quote! { #[doc = #line] }).collect()
}

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
    let symbol = match &motion.symbol {
        symbol if *symbol == motion.name => String::new(),
        symbol if motion.symbol_against_iso => format!(" (`-{symbol}`)"),
        symbol => format!(" (`{symbol}`)"),
    };
    format!("{}{symbol}: {} \\[{unit}\\].", motion.name, motion.meaning)
}

/// The equations of the error, one line a direction.
pub(super) fn error_equations(equations: &Equations) -> String {
    block(&error_lines(equations, Names::Symbols))
}

/// The equations of the nominal position, one line a direction.
pub(super) fn nominal_equations(equations: &Equations) -> String {
    let line =
        |row: &Row| format!("P{} = {}", row.direction.letter().to_ascii_lowercase(), infix(&row.nominal));
    block(&equations.rows.iter().map(line).collect::<Vec<_>>())
}

/// The equations of the tool's direction without errors, one line a direction.
pub(super) fn direction_equations(equations: &Equations) -> String {
    let line = |row: &Row| format!("{} = {}", row.direction.direction_letter(), infix(&row.nominal));
    block(&equations.orientation.iter().map(line).collect::<Vec<_>>())
}

/// The equations of its error, one line a direction.
pub(super) fn direction_error_equations(equations: &Equations) -> String {
    block(&direction_error_lines(equations, Names::Symbols))
}

fn block(lines: &[String]) -> String {
    format!("```text\n{}\n```", lines.join("\n"))
}
