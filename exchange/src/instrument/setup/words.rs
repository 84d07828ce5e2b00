//! Mappings and words of set-up files, with their codes.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::fields::{self, Wording};
use model_dsl::quantity::{self, Dimension, Unit};
use model_dsl::source::{Span, Spanned};
use model_dsl::yaml::Node;

/// The code for a value of the wrong form.
pub(super) const FORM: &str = "E0904";

/// How a mapping speaks of its keys.
pub(super) fn keys(what: &str) -> Wording<'_> {
    Wording { what, noun: "key", unknown: "E0903", missing: "E0901", form: FORM }
}

/// The text of a value that must be a word.
pub(super) fn word<'n>(
    node: &'n Node,
    what: &str,
    diagnostics: &mut Diagnostics,
) -> Option<Spanned<&'n str>> {
    fields::word(node, what, FORM, diagnostics)
}

/// One of some words with its meaning; or E0907, which lists them.
pub(super) fn choice<T: Copy>(
    node: &Node,
    what: &str,
    known: &[(&str, T)],
    diagnostics: &mut Diagnostics,
) -> Option<T> {
    let written = word(node, what, diagnostics)?;
    let found = known.iter().find(|(name, _)| *name == written.value);
    if found.is_none() {
        let names: Vec<String> = known.iter().map(|(name, _)| format!("`{name}`")).collect();
        let message = format!("{what} must be {}, found `{}`", names.join(" or "), written.value);
        let help = "write one of these, or leave the key out";
        diagnostics.push(Diagnostic::error("E0907", written.span, message).help(help));
    }
    found.map(|(_, meaning)| *meaning)
}

/// The unit of a length or an angle; or E0908.
pub(super) fn unit(
    node: &Node,
    what: &str,
    dimension: Dimension,
    diagnostics: &mut Diagnostics,
) -> Option<Spanned<Unit>> {
    let unit = quantity::read_unit(node, what, diagnostics)?;
    let read = as_dimension(unit.value, dimension);
    if read.dimension == dimension {
        return Some(Spanned::new(read, unit.span));
    }
    let message = format!("{what} must be that of {}", dimension.name());
    let help = format!("write a unit such as `{}`", dimension.usual_unit());
    diagnostics.push(Diagnostic::error("E0908", unit.span, message).help(help));
    None
}

/// A unit where one of a dimension is asked for: a length for each length, such as the mm/m of a level or of a Renishaw file, is a small
/// angle, 1 mm/m being 1 mrad.
pub(in crate::instrument) fn as_dimension(unit: Unit, dimension: Dimension) -> Unit {
    let is_angle = dimension == Dimension::ANGLE && unit.dimension == Dimension::NONE;
    if is_angle { Unit { dimension, ..unit } } else { unit }
}

/// Where a file speaks for the first time.
pub(super) fn first_key(root: &Node) -> Span {
    let first = root.entries().and_then(<[_]>::first);
    first.map_or(root.span, |(key, _)| key.span)
}
