//! YAML text as a tree of nodes with spans.
//!
//! In: a file's text. Out: a tree in which every key and value knows its place, with scalars as they were written
//! (`0.10`, `+X`, `1e-3` and `yes` are words here: what they mean is the reader's to say), or findings E0001 to E0008.
//! `yaml/events.rs` is the only file that names the YAML crate. It is the event parser that serde-saphyr is built on; serde's
//! own data model cannot tell both places of a repeated key, quoted from plain words, or more than one mistake a run.
//!
//! The effort is bounded whatever the file holds: [`MAX_BYTES`], [`MAX_NODES`], [`MAX_DEPTH`], no aliases.

mod events;
mod tree;

pub use events::read;

use crate::source::{Span, Spanned};
use std::ops::Range;

/// Files larger than this many bytes are refused (E0003).
pub const MAX_BYTES: usize = 8 * 1024 * 1024;

/// Files with more values than this are refused (E0004).
pub const MAX_NODES: usize = 200_000;

/// Files in which values stand more than this deep in one another are refused (E0004).
pub const MAX_DEPTH: usize = 64;

/// One value of the file and the text that it was read from.
#[derive(Clone, PartialEq, Debug)]
pub struct Node {
    /// The value's own text, without its key, anchor or surrounding white space. A value that was left out stands
    /// at its key.
    pub span: Span,
    /// What it is.
    pub kind: NodeKind,
}

/// What a value is, before any meaning is given to it.
#[derive(Clone, PartialEq, Debug)]
pub enum NodeKind {
    /// Nothing was written, or a plain `~` or `null`.
    Null,
    /// A single word, number or sentence.
    Scalar(Scalar),
    /// A list.
    Sequence(Vec<Node>),
    /// Keys with their values, in the order of the file, each key once.
    Mapping(Vec<(Spanned<String>, Node)>),
}

/// A scalar as it was written: `0.10` stays `0.10`, `+X` stays `+X`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Scalar {
    /// The text, quotes and escapes resolved.
    pub text: String,
    /// Whether it stood in quotes or in a block.
    pub quoted: bool,
}

impl Node {
    /// The text of a scalar.
    pub fn text(&self) -> Option<&str> {
        match &self.kind {
            NodeKind::Scalar(scalar) => Some(&scalar.text),
            _ => None,
        }
    }

    /// The items of a list.
    pub fn items(&self) -> Option<&[Node]> {
        match &self.kind {
            NodeKind::Sequence(items) => Some(items),
            _ => None,
        }
    }

    /// The keys and values of a mapping.
    pub fn entries(&self) -> Option<&[(Spanned<String>, Node)]> {
        match &self.kind {
            NodeKind::Mapping(entries) => Some(entries),
            _ => None,
        }
    }

    /// The value of a key, where this is a mapping that has it.
    pub fn get(&self, key: &str) -> Option<&Node> {
        let mut entries = self.entries()?.iter();
        let found = entries.find(|(name, _)| name.value == key);
        found.map(|(_, node)| node)
    }

    /// What it is, in words for a message: "expected a list, found a single value".
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            NodeKind::Null => "nothing",
            NodeKind::Scalar(_) => "a single value",
            NodeKind::Sequence(_) => "a list",
            NodeKind::Mapping(_) => "a mapping",
        }
    }

    /// The place of a part of a scalar's text, given as a byte range of that text.
    ///
    /// Where escapes or folded lines make the text in the file differ from the text read, it is the whole scalar.
    pub fn part(&self, range: Range<usize>) -> Span {
        let NodeKind::Scalar(scalar) = &self.kind else {
            return self.span;
        };
        let quotes = if scalar.quoted { 1 } else { 0 };
        let written = self.span.end.saturating_sub(self.span.start);
        if written != scalar.text.len() + 2 * quotes || range.end > scalar.text.len() {
            return self.span;
        }
        let start = self.span.start + quotes;
        Span::new(start + range.start, start + range.end)
    }
}

#[cfg(test)]
mod tests;
