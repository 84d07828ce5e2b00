//! Mappings, words and lists of calibration files, with their codes.

use crate::diagnostic::{Diagnostic, Diagnostics};
pub(super) use crate::fields::Fields;
use crate::fields::{self, Wording};
use crate::source::Spanned;
use crate::yaml::Node;

/// The code for a value of the wrong form.
const FORM: &str = "E0404";

/// How a mapping speaks of its keys.
pub(super) fn keys(what: &str) -> Wording<'_> {
    Wording { what, noun: "key", unknown: "E0403", missing: "E0401", form: FORM }
}

/// How a term speaks of its parameters.
pub(super) fn parameters(what: &str) -> Wording<'_> {
    Wording { what, noun: "parameter", unknown: "E0412", missing: "E0411", form: FORM }
}

/// The text of a value that must be a word.
pub(super) fn word(node: &Node, what: &str, diagnostics: &mut Diagnostics) -> Option<Spanned<String>> {
    fields::word(node, what, FORM, diagnostics).map(|word| word.map(str::to_owned))
}

/// The items of a value that must be a list with at least one entry.
pub(super) fn filled_list<'n>(
    node: &'n Node,
    what: &str,
    diagnostics: &mut Diagnostics,
) -> Option<&'n [Node]> {
    let items = fields::list(node, what, FORM, diagnostics)?;
    if items.is_empty() {
        let mistake = Diagnostic::error("E0417", node.span, format!("{what} has no entries"));
        diagnostics.push(mistake.help("write at least one number"));
        return None;
    }
    Some(items)
}
