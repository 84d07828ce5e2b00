//! The direction of a tool by name. In: `direction` of the `tool`, three names, and the constants of the machine. Out: three constants more,
//! pure numbers, which each tool of a calibration gives; or what is wrong with the names.
//!
//! It exists because the tools of a turret point in several ways, and a machine is compiled once. So the direction of the tool is made of
//! constants, as its length is, and each tool of a calibration gives their values.

use super::constants::Constant;
use super::draft::Chain;
use super::fields::items;
use super::link::Along;
use super::words::is_name;
use crate::algebra::{Axis, Name};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};
use crate::yaml::Node;

/// The names of the three parts of a direction.
pub(super) type Parts = [Spanned<Name>; 3];

/// Reads the three names.
pub(super) fn read(node: &Node, diagnostics: &mut Diagnostics) -> Option<Parts> {
    let parts = items(node, "the direction of the tool", diagnostics)?.iter();
    let named = |part: &Node| {
        let name = part.text().map(str::trim).filter(|text| is_name(text))?;
        Some(Spanned::new(Name::from(name), part.span))
    };
    let found = parts.map(named).collect::<Option<Vec<_>>>().and_then(|parts| parts.try_into().ok());
    if found.is_none() {
        diagnostics.push(
            Diagnostic::error("E0152", node.span, "the direction of the tool must be three names")
                .label("each tool of a calibration gives their values")
                .help("write `direction: [It, Jt, Kt]`; put a tool that always has one direction on a `fixed` link that is `turned`"),
        );
    }
    found
}

/// Appends the components of the direction to the constants. By default they are those of `tool_axis`: a calibration may have no tools.
pub(super) fn settle(
    mut constants: Vec<Constant>,
    chain: &Chain<'_>,
    (tool_axis, is_derived): (Along, bool),
    diagnostics: &mut Diagnostics,
) -> Vec<Constant> {
    let parts = chain.links.iter().find_map(|drafted| drafted.direction.as_ref());
    let Some(parts) = parts else { return constants };
    if !is_derived {
        diagnostics.push(not_derived(parts));
    }
    let mut found: Vec<Constant> = Vec::new();
    for (part, axis) in parts.iter().zip(Axis::ALL) {
        let earlier = found.iter().find(|known| known.name == part.value).map(|known| known.span);
        if let Some(other) = used_in_an_offset(&part.value, chain).or(earlier) {
            diagnostics.push(used_twice(part, other));
            continue;
        }
        let declared = constants.iter().position(|known| known.name == part.value);
        let declared = declared.map(|place| constants.remove(place));
        if let Some(length) = declared.as_ref().filter(|known| known.default.is_some()) {
            diagnostics.push(given_a_length(length, part));
        }
        let component = match axis == tool_axis.axis {
            true if tool_axis.sign < 0 => -1.0,
            true => 1.0,
            false => 0.0,
        };
        found.push(Constant {
            name: part.value.clone(),
            meaning: declared.and_then(|known| known.meaning),
            default: Some(component),
            direction: Some(axis),
            span: part.span,
        });
    }
    constants.extend(found);
    constants
}

/// Where an offset of the chain mentions a name.
fn used_in_an_offset(name: &Name, chain: &Chain<'_>) -> Option<Span> {
    let offsets =
        chain.links.iter().flat_map(|drafted| drafted.link.origin.iter().zip(&drafted.origin_spans));
    let mut mentioning =
        offsets.filter(|(offset, _)| offset.symbols().iter().any(|symbol| symbol.name() == name));
    mentioning.next().map(|(_, span)| *span)
}

fn not_derived([first, ..]: &Parts) -> Diagnostic {
    Diagnostic::error("E0152", first.span, "the machine does not derive the direction of the tool")
        .label("no equation would contain it")
        .help("add `orientation: true` to the machine file, or remove the direction")
}

fn used_twice(part: &Spanned<Name>, other: Span) -> Diagnostic {
    Diagnostic::error("E0152", part.span, format!("`{}` has two meanings", part.value))
        .label("a component of the tool's direction here")
        .also(other, "and something else here")
        .help("give each component a name of its own: `direction: [It, Jt, Kt]`")
}

fn given_a_length(length: &Constant, part: &Spanned<Name>) -> Diagnostic {
    Diagnostic::error("E0152", length.span, format!("`{}` is not a length", part.value))
        .label("a length here")
        .also(part.span, "a component of the tool's direction here")
        .help("remove the value: the tools of a calibration give the direction")
}
