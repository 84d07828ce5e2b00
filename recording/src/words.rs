//! Mappings and words of recording files, with their codes.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::fields::{self, Wording};
use model_dsl::source::{Span, Spanned};
use model_dsl::suggest::nearest;
use model_dsl::yaml::Node;

/// The code for a value of the wrong form.
pub(super) const FORM: &str = "E0604";

/// How a mapping speaks of its keys.
pub(super) fn keys(what: &str) -> Wording<'_> {
    Wording { what, noun: "key", unknown: "E0603", missing: "E0601", form: FORM }
}

/// The text of a value that must be a word.
pub(super) fn word(node: &Node, what: &str, diagnostics: &mut Diagnostics) -> Option<Spanned<String>> {
    fields::word(node, what, FORM, diagnostics).map(|word| word.map(str::to_owned))
}

/// Where a file speaks for the first time.
pub(super) fn first_key(root: &Node) -> Span {
    let first = root.entries().and_then(<[_]>::first);
    first.map_or(root.span, |(key, _)| key.span)
}

/// "did you mean ...?", or what there is.
pub(super) fn near_or_all(mistake: Diagnostic, word: &str, what: &str, known: &[&str]) -> Diagnostic {
    match nearest(word, known.iter().copied()) {
        Some(near) => mistake.suggest(Some(near)),
        None if known.is_empty() => mistake.help(format!("{what} none")),
        None => mistake.help(format!("{what} {}", known.join(", "))),
    }
}
