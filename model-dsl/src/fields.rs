//! Reading YAML values of a known form: mappings with known keys, words, lists.
//!
//! In: a node and how the file speaks of it. Out: its parts; or what is wrong with it, at its place,
//! with what to write instead. Every kind of file has its own codes for the same mistakes.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};
use crate::suggest::nearest;
use crate::yaml::Node;

/// A mapping whose keys have been compared with those that it may have.
#[derive(Clone, Copy)]
pub struct Fields<'n> {
    node: &'n Node,
    /// Where the mapping's own name stands, for keys that are missing.
    name: Span,
}

/// How a mapping speaks of its keys.
#[derive(Clone, Copy)]
pub struct Wording<'w> {
    /// What the mapping is: "a calibration", "`backlash` of EXX".
    pub what: &'w str,
    /// "key" or "parameter".
    pub noun: &'w str,
    /// The code for a key that it may not have.
    pub unknown: &'static str,
    /// The code for a key that it must have.
    pub missing: &'static str,
    /// The code for a value of the wrong form.
    pub form: &'static str,
}

impl<'n> Fields<'n> {
    /// Takes a mapping and reports every key that is not among the known ones; nothing where it is no mapping.
    pub fn open(
        node: &'n Node,
        name: Span,
        wording: Wording<'_>,
        known: &[&str],
        diagnostics: &mut Diagnostics,
    ) -> Option<Self> {
        let Some(entries) = node.entries() else {
            let message = format!("{} must be a mapping of keys, found {}", wording.what, node.kind_name());
            let help =
                format!("write `key: value` pairs, such as `{}: ...`", known.first().unwrap_or(&"key"));
            diagnostics.push(Diagnostic::error(wording.form, node.span, message).help(help));
            return None;
        };
        let unknown = entries.iter().filter(|(key, _)| !known.contains(&key.value.as_str()));
        diagnostics.extend(unknown.map(|(key, _)| unknown_key(key, wording, known)));
        Some(Self { node, name })
    }

    /// The value of a key that may be left out.
    pub fn get(&self, key: &str) -> Option<&'n Node> {
        self.node.get(key)
    }

    /// A key that may be left out, with its value.
    pub fn entry(&self, key: &str) -> Option<(&'n Spanned<String>, &'n Node)> {
        let mut entries = self.node.entries().unwrap_or(&[]).iter();
        entries.find(|(name, _)| name.value == key).map(|(name, value)| (name, value))
    }

    /// The place of a key, or of the mapping's name where the key is missing.
    pub fn key_span(&self, key: &str) -> Span {
        let mut keys = self.node.entries().unwrap_or(&[]).iter().map(|(name, _)| name);
        keys.find(|name| name.value == key).map_or(self.name, |name| name.span)
    }

    /// The value of a key that must be there; its absence is reported at the mapping's name.
    pub fn need(&self, key: &str, wording: Wording<'_>, diagnostics: &mut Diagnostics) -> Option<&'n Node> {
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

/// The text of a value that must be a word; `what` names it in the message, `code` is that of a wrong form.
pub fn word<'n>(
    node: &'n Node,
    what: &str,
    code: &'static str,
    diagnostics: &mut Diagnostics,
) -> Option<Spanned<&'n str>> {
    let text = node.text().map(str::trim).filter(|text| !text.is_empty());
    match text {
        Some(text) => Some(Spanned::new(text, node.span)),
        None => {
            let found = if node.text().is_some() { "an empty text" } else { node.kind_name() };
            let message = format!("{what} must be one word or number, found {found}");
            diagnostics
                .push(Diagnostic::error(code, node.span, message).help("write a single word or number here"));
            None
        }
    }
}

/// The items of a value that must be a list; `what` names it in the message, `code` is that of a wrong form.
pub fn list<'n>(
    node: &'n Node,
    what: &str,
    code: &'static str,
    diagnostics: &mut Diagnostics,
) -> Option<&'n [Node]> {
    let items = node.items();
    if items.is_none() {
        let message = format!("{what} must be a list, found {}", node.kind_name());
        let help = "write `[a, b, c]`, or each item on its own line after `- `";
        diagnostics.push(Diagnostic::error(code, node.span, message).help(help));
    }
    items
}
