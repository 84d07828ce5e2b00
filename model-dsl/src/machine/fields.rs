//! Mappings, words and lists of machine files, with their codes.

use crate::diagnostic::{Diagnostic, Diagnostics};
pub(super) use crate::fields::Fields;
use crate::fields::{self, Wording};
use crate::source::Span;
use crate::suggest::nearest;
use crate::yaml::Node;

/// The code for a value of the wrong form.
const FORM: &str = "E0103";

/// How a mapping speaks of its keys.
pub(super) fn keys(what: &str) -> Wording<'_> {
    Wording { what, noun: "key", unknown: "E0101", missing: "E0102", form: FORM }
}

/// Opens a mapping; a key that is missing in it is reported at its first key.
pub(super) fn open<'n>(
    node: &'n Node,
    what: &str,
    known: &[&str],
    diagnostics: &mut Diagnostics,
) -> Option<Fields<'n>> {
    Fields::open(node, place(node), keys(what), known, diagnostics)
}

/// Where a mapping begins.
pub(super) fn place(node: &Node) -> Span {
    node.entries().and_then(|entries| entries.first()).map_or(node.span, |(key, _)| key.span)
}

/// The text of a value that must be a word.
pub(super) fn text<'n>(node: &'n Node, what: &str, diagnostics: &mut Diagnostics) -> Option<&'n str> {
    fields::word(node, what, FORM, diagnostics).map(|word| word.value)
}

/// The items of a value that must be a list.
pub(super) fn items<'n>(node: &'n Node, what: &str, diagnostics: &mut Diagnostics) -> Option<&'n [Node]> {
    fields::list(node, what, FORM, diagnostics)
}

/// One of a few words; anything else is an error that lists them.
pub(super) fn choice<'c>(
    node: &Node,
    what: &str,
    words: &[&'c str],
    diagnostics: &mut Diagnostics,
) -> Option<&'c str> {
    let written = text(node, what, diagnostics)?;
    let found = words.iter().copied().find(|word| *word == written);
    if found.is_none() {
        let help = match nearest(written, words.iter().copied()) {
            Some(word) => format!("did you mean `{word}`?"),
            None => format!("write one of: {}", words.join(", ")),
        };
        diagnostics.push(
            Diagnostic::error("E0104", node.span, format!("`{written}` is not {what}"))
                .label("not one of the words allowed here")
                .help(help),
        );
    }
    found
}

/// Reads `true` or `false`; none for any other word, which is reported.
pub(super) fn truth(node: &Node, diagnostics: &mut Diagnostics) -> Option<bool> {
    choice(node, "`true` or `false`", &["true", "false"], diagnostics).map(|word| word == "true")
}
