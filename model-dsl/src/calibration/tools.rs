//! The tools of a calibration: constants of the machine that are other ones with each tool.
//!
//! In: the mapping behind `tools`, and the values of all constants without a tool. Out: the constants with each of them. It exists
//! because a machining centre has sixty tools and one calibration.

use super::Tool;
use super::document::check_constant;
use super::names::MachineNames;
use super::tool_direction;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::quantity::{self, Dimension};
use crate::source::Spanned;
use crate::yaml::Node;

/// Reads all tools; every mistake is told.
pub(super) fn read_tools(
    node: &Node,
    names: &MachineNames,
    constants: &[f64],
    diagnostics: &mut Diagnostics,
) -> Vec<Tool> {
    let Some(entries) = node.entries() else {
        let message = format!("`tools` must be a mapping of names to constants, found {}", node.kind_name());
        let mistake = Diagnostic::error("E0404", node.span, message);
        diagnostics.push(mistake.help("write one line `T1: {Zt: -120 mm}` for each tool"));
        return Vec::new();
    };
    let read = |(name, value): &(Spanned<String>, Node)| Tool {
        name: name.clone(),
        constants: read_tool(&name.value, value, names, constants, diagnostics),
    };
    entries.iter().map(read).collect()
}

/// The machine's constants with a tool; those that it does not name are as without it.
fn read_tool(
    tool: &str,
    node: &Node,
    names: &MachineNames,
    constants: &[f64],
    diagnostics: &mut Diagnostics,
) -> Vec<f64> {
    let mut values = constants.to_vec();
    let Some(entries) = node.entries() else {
        let message = format!(
            "the tool `{tool}` must be a mapping of constants to lengths, found {}",
            node.kind_name()
        );
        let mistake = Diagnostic::error("E0404", node.span, message);
        diagnostics
            .push(mistake.help("write the constants that differ with this tool, such as `{Zt: -120 mm}`"));
        return values;
    };
    let is_constant = |(key, _): &&(Spanned<String>, Node)| {
        let known = names.offsets().any(|(known, _)| *known == key.value);
        known || !tool_direction::KEYS.contains(&key.value.as_str())
    };
    for (name, value) in entries.iter().filter(is_constant) {
        check_constant(name, names, diagnostics);
        let words = format!("`{}` of the tool `{tool}`", name.value);
        let length = quantity::read(value, Dimension::LENGTH, &words, diagnostics);
        let place = names.constants.iter().position(|(known, _)| *known == name.value);
        if let (Some(place), Some(length)) = (place.and_then(|place| values.get_mut(place)), length) {
            *place = length.value;
        }
    }
    // Behind all lengths, which the holder turns.
    for entry in entries.iter().filter(|entry| !is_constant(entry)) {
        tool_direction::take(entry, tool, names, &mut values, diagnostics);
    }
    tool_direction::check(entries, diagnostics);
    values
}
