//! The keys of one mapping: which there may be, which there must be.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};
use crate::suggest::nearest;
use crate::yaml::Node;

/// A mapping whose keys have been compared with those that it may have.
#[derive(Clone, Copy)]
pub(super) struct Fields<'n> {
    node: &'n Node,
    /// Where the mapping's own name stands, for keys that are missing.
    name: Span,
}

/// How a mapping speaks of its keys.
#[derive(Clone, Copy)]
pub(super) struct Wording<'w> {
    /// What the mapping is: "a calibration", "`backlash` of EXX".
    pub(super) what: &'w str,
    /// "key" or "parameter".
    pub(super) noun: &'w str,
    /// The code for a key that it may not have.
    pub(super) unknown: &'static str,
    /// The code for a key that it must have.
    pub(super) missing: &'static str,
}

impl<'w> Wording<'w> {
    pub(super) fn keys(what: &'w str) -> Self {
        Self { what, noun: "key", unknown: "E0403", missing: "E0401" }
    }

    pub(super) fn parameters(what: &'w str) -> Self {
        Self { what, noun: "parameter", unknown: "E0412", missing: "E0411" }
    }
}

impl<'n> Fields<'n> {
    /// Takes a mapping and reports every key that is not among the known ones; nothing where it is no mapping.
    pub(super) fn open(
        node: &'n Node,
        name: Span,
        wording: Wording<'_>,
        known: &[&str],
        diagnostics: &mut Diagnostics,
    ) -> Option<Self> {
        let Some(entries) = node.entries() else {
            let message = format!("{} is a mapping of keys, found {}", wording.what, node.kind_name());
            let help = format!("write `{{{}: ...}}`", known.first().unwrap_or(&"key"));
            diagnostics.push(Diagnostic::error("E0404", node.span, message).help(help));
            return None;
        };
        let unknown = entries.iter().filter(|(key, _)| !known.contains(&key.value.as_str()));
        diagnostics.extend(unknown.map(|(key, _)| unknown_key(key, wording, known)));
        Some(Self { node, name })
    }

    /// The value of a key that may be left out.
    pub(super) fn get(&self, key: &str) -> Option<&'n Node> {
        self.node.get(key)
    }

    /// The place of a key, or of the mapping's name where the key is missing.
    pub(super) fn key_span(&self, key: &str) -> Span {
        let mut keys = self.node.entries().unwrap_or(&[]).iter().map(|(name, _)| name);
        keys.find(|name| name.value == key).map_or(self.name, |name| name.span)
    }

    /// The value of a key that must be there; its absence is reported at the mapping's name.
    pub(super) fn need(
        &self,
        key: &str,
        wording: Wording<'_>,
        diagnostics: &mut Diagnostics,
    ) -> Option<&'n Node> {
        let found = self.get(key);
        if found.is_none() {
            let message = format!("{} needs the {} `{key}`", wording.what, wording.noun);
            let mistake = Diagnostic::error(wording.missing, self.name, message);
            diagnostics.push(mistake.help(format!("add `{key}: ...`")));
        }
        found
    }
}

fn unknown_key(key: &Spanned<String>, wording: Wording<'_>, known: &[&str]) -> Diagnostic {
    let message = format!("{} has no {} `{}`", wording.what, wording.noun, key.value);
    let mistake = Diagnostic::error(wording.unknown, key.span, message);
    match nearest(&key.value, known.iter().copied()) {
        Some(name) => mistake.suggest(Some(name)),
        None if known.is_empty() => mistake.help("leave it out"),
        None => mistake.help(format!("the {}s are {}", wording.noun, known.join(", "))),
    }
}

/// The text of a value that must be a word; `what` names it in the message.
pub(super) fn word(node: &Node, what: &str, diagnostics: &mut Diagnostics) -> Option<Spanned<String>> {
    let text = node.text().map(str::trim).filter(|text| !text.is_empty());
    match text {
        Some(text) => Some(Spanned::new(text.to_owned(), node.span)),
        None => {
            let found = if node.text().is_some() { "an empty text" } else { node.kind_name() };
            let message = format!("{what} is a name, found {found}");
            diagnostics.push(Diagnostic::error("E0404", node.span, message).help("write one word here"));
            None
        }
    }
}

/// The items of a value that must be a list with at least one entry.
pub(super) fn filled_list<'n>(
    node: &'n Node,
    what: &str,
    diagnostics: &mut Diagnostics,
) -> Option<&'n [Node]> {
    match node.items() {
        Some([]) => {
            let mistake = Diagnostic::error("E0417", node.span, format!("{what} has no entries"));
            diagnostics.push(mistake.help("write at least one number"));
            None
        }
        Some(items) => Some(items),
        None => {
            let message = format!("{what} is a list of numbers, found {}", node.kind_name());
            diagnostics.push(Diagnostic::error("E0404", node.span, message).help("write `[..., ...]`"));
            None
        }
    }
}
