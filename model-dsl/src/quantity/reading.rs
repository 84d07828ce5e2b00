//! Quantities, numbers and units read from nodes, with findings at the exact part of the text.
//!
//! Findings beside those of the texts themselves: E0306 a bare number where a unit is needed, E0307 a quantity of the
//! wrong kind (at its unit), E0308 a list, a mapping or nothing in place of a value, E0309 a unit where a bare number is
//! needed.

use super::unit::meant;
use super::{Dimension, Quantity, QuantityError, Unit, parse_number, parse_quantity, parse_unit};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::Spanned;
use crate::yaml::Node;

/// Reads a quantity of one kind; `what` names it in messages: "the step", "`Zt`".
///
/// The value is in internal units. Nothing is returned where a finding was made.
pub fn read(
    node: &Node,
    expected: Dimension,
    what: &str,
    diagnostics: &mut Diagnostics,
) -> Option<Spanned<f64>> {
    let example = format!("{} such as `10 {}`", expected.name(), expected.usual_unit());
    let text = scalar(node, &format!("{what} must be {example}"), diagnostics)?;
    let quantity = parse_quantity(text).map_err(|error| of_kind(error, text, expected));
    let quantity = located(quantity, node, diagnostics)?;
    if let Some(mistake) = wrong_kind(&quantity, expected, what, node) {
        diagnostics.push(mistake);
        return None;
    }
    Some(Spanned::new(quantity.value, node.span))
}

/// Reads a quantity in which a load may be a force, or what a drive tells in its place: V, A, % or count. `expected` has it as
/// a force.
pub fn read_per_load(
    node: &Node,
    expected: Dimension,
    what: &str,
    diagnostics: &mut Diagnostics,
) -> Option<Spanned<f64>> {
    let quantity = node.text().and_then(|text| parse_quantity(text).ok());
    match quantity {
        Some(found) if !found.is_bare() && found.dimension.loads_as_forces() == expected => {
            Some(Spanned::new(found.value, node.span))
        }
        _ => read(node, expected, what, diagnostics),
    }
}

/// Reads a difference of temperatures: `0.5 K` and `0.5 degC` are the same, and no zero is taken off.
pub fn read_temperature_step(node: &Node, what: &str, diagnostics: &mut Diagnostics) -> Option<Spanned<f64>> {
    let absolute = read(node, Dimension::TEMPERATURE, what, diagnostics)?;
    let quantity = parse_quantity(node.text()?).ok()?;
    let (number, unit) =
        parse_number(quantity.written_number()).ok().zip(parse_unit(quantity.written_unit()).ok())?;
    Some(absolute.map(|_| number * unit.factor))
}

/// Reads a number that has no unit.
pub fn read_number(node: &Node, what: &str, diagnostics: &mut Diagnostics) -> Option<Spanned<f64>> {
    let text = scalar(node, &format!("{what} must be a bare number"), diagnostics)?;
    let value = match parse_quantity(text) {
        Ok(quantity) if !quantity.is_bare() => {
            let message = format!("{what} takes no unit here");
            let mistake = Diagnostic::error("E0309", node.part(quantity.unit.clone()), message);
            diagnostics.push(mistake.help(format!("write `{}`", quantity.written_number())));
            return None;
        }
        _ => located(parse_number(text), node, diagnostics)?,
    };
    Some(Spanned::new(value, node.span))
}

/// Reads a unit of any kind; the caller compares its dimension.
pub fn read_unit(node: &Node, what: &str, diagnostics: &mut Diagnostics) -> Option<Spanned<Unit>> {
    let text = scalar(node, &format!("{what} must be a unit such as `um`"), diagnostics)?;
    let unit = located(parse_unit(text), node, diagnostics)?;
    Some(Spanned::new(unit, node.span))
}

fn scalar<'n>(node: &'n Node, expected: &str, diagnostics: &mut Diagnostics) -> Option<&'n str> {
    let text = node.text();
    if text.is_none() {
        let message = format!("{expected}, found {}", node.kind_name());
        diagnostics.push(Diagnostic::error("E0308", node.span, message).help("write one value here"));
    }
    text
}

/// An unknown unit with the help for the kind that is expected, where it stands alone behind its number and not in a ratio.
fn of_kind(error: QuantityError, text: &str, expected: Dimension) -> QuantityError {
    let unit = text.get(error.range.clone()).unwrap_or_default();
    let before = text.get(..error.range.start).unwrap_or_default();
    let alone = text.trim_end().len() == error.range.end && parse_number(before).is_ok();
    if error.code != "E0304" || !alone {
        return error;
    }
    match meant(unit, expected) {
        Some(meant) => error.help(format!("did you mean `{meant}`?")),
        None => error.help(format!("use a unit such as `{}`", expected.usual_unit())),
    }
}

fn located<T>(result: Result<T, QuantityError>, node: &Node, diagnostics: &mut Diagnostics) -> Option<T> {
    result
        .map_err(|error| {
            let span = node.part(error.range.clone());
            diagnostics.push(error.diagnostic(span));
        })
        .ok()
}

fn wrong_kind(quantity: &Quantity, expected: Dimension, what: &str, node: &Node) -> Option<Diagnostic> {
    let unit = expected.usual_unit();
    if quantity.is_bare() {
        let message = format!("{what} needs a unit: it is {}", expected.name());
        let help = format!("write `{} {unit}` if that is the unit", quantity.written_number());
        return Some(Diagnostic::error("E0306", node.part(quantity.number.clone()), message).help(help));
    }
    if quantity.dimension == expected {
        return None;
    }
    let message = format!(
        "{what} must be {}, but `{}` is {}",
        expected.name(),
        quantity.written_unit(),
        quantity.kind_name()
    );
    let mistake = Diagnostic::error("E0307", node.part(quantity.unit.clone()), message);
    Some(mistake.label(format!("expected {}", expected.name())).help(format!("use a unit such as `{unit}`")))
}
