//! Reading mappings key by key. In: a YAML node. Out: its values, taken by name; what nobody
//! took is an unknown key and is reported with the nearest known one.

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};
use crate::suggest::nearest;
use crate::yaml::{Node, NodeKind};

/// A mapping being read: keys taken so far, and those not yet taken.
pub(crate) struct Fields<'n> {
    what: &'static str,
    span: Span,
    entries: Vec<(&'n Spanned<String>, &'n Node)>,
    asked: Vec<&'static str>,
}

impl<'n> Fields<'n> {
    /// Opens a mapping; anything else is an error that says what was expected.
    pub(crate) fn open(node: &'n Node, what: &'static str, diagnostics: &mut Diagnostics) -> Option<Self> {
        let NodeKind::Mapping(entries) = &node.kind else {
            diagnostics.push(
                Diagnostic::error("E0103", node.span, format!("{what} is a mapping of keys to values"))
                    .label("this is not a mapping")
                    .help("write one `key: value` a line, all indented alike"),
            );
            return None;
        };
        let entries = entries.iter().map(|(key, value)| (key, value)).collect();
        Some(Self { what, span: node.span, entries, asked: Vec::new() })
    }

    /// Takes the value of a key, where it stands.
    pub(crate) fn take(&mut self, key: &'static str) -> Option<&'n Node> {
        self.take_entry(key).map(|(_, value)| value)
    }

    /// Takes a key with its value, where it stands.
    pub(crate) fn take_entry(&mut self, key: &'static str) -> Option<(&'n Spanned<String>, &'n Node)> {
        self.asked.push(key);
        let at = self.entries.iter().position(|(own, _)| own.value == key)?;
        Some(self.entries.remove(at))
    }

    /// Takes a value that must stand; its absence is an error.
    pub(crate) fn require(&mut self, key: &'static str, diagnostics: &mut Diagnostics) -> Option<&'n Node> {
        let value = self.take(key);
        if value.is_none() {
            let message = format!("{} needs the key `{key}`", self.what);
            diagnostics.push(
                Diagnostic::error("E0102", self.span, message)
                    .label("it is missing here")
                    .help(format!("add a line `{key}: ...`")),
            );
        }
        value
    }

    /// Where the mapping stands.
    pub(crate) fn span(&self) -> Span {
        self.span
    }

    /// Reports every key that nobody asked for.
    pub(crate) fn finish(self, diagnostics: &mut Diagnostics) {
        for (key, _) in &self.entries {
            let mut error =
                Diagnostic::error("E0101", key.span, format!("unknown key `{}` in {}", key.value, self.what))
                    .label("this key means nothing here");
            error = match nearest(&key.value, self.asked.iter().copied()) {
                Some(known) => error.help(format!("did you mean `{known}`?")),
                None => error.help(format!("known keys: {}", self.asked.join(", "))),
            };
            diagnostics.push(error);
        }
    }
}

/// The text of a scalar; anything else is an error that says what was expected.
pub(crate) fn text<'n>(node: &'n Node, what: &str, diagnostics: &mut Diagnostics) -> Option<&'n str> {
    match &node.kind {
        NodeKind::Scalar(scalar) => Some(&scalar.text),
        NodeKind::Null => {
            diagnostics.push(
                Diagnostic::error("E0103", node.span, format!("{what} is missing"))
                    .label("nothing stands behind the key")
                    .help("write a value, or take the key out"),
            );
            None
        }
        _ => {
            diagnostics.push(
                Diagnostic::error("E0103", node.span, format!("{what} is one word or number"))
                    .label("this is a list or a mapping")
                    .help("write it in one piece, without brackets or braces"),
            );
            None
        }
    }
}

/// The items of a list; anything else is an error that says what was expected.
pub(crate) fn items<'n>(node: &'n Node, what: &str, diagnostics: &mut Diagnostics) -> Option<&'n [Node]> {
    match &node.kind {
        NodeKind::Sequence(items) => Some(items),
        _ => {
            diagnostics.push(
                Diagnostic::error("E0103", node.span, format!("{what} is a list"))
                    .label("this is not a list")
                    .help("write `[a, b, c]`, or one item a line behind `- `"),
            );
            None
        }
    }
}

/// One of a few words; anything else is an error that lists them.
pub(crate) fn choice<'c>(
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
                .label("not one of the words possible here")
                .help(help),
        );
    }
    found
}
