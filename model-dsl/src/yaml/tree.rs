//! Nodes put together into a tree, under the limits of this module, with every repeated or unusable key told.

use super::{MAX_DEPTH, MAX_NODES, Node, NodeKind, Scalar};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};
use std::collections::BTreeMap;

/// After this many mistakes the rest of the file is not read: it is hardly a file of ours.
const MAX_MISTAKES: usize = 100;

/// A tree under construction. Each method but [`Tree::finish`] is one event of the text, in its order.
pub(super) struct Tree<'a> {
    diagnostics: &'a mut Diagnostics,
    open: Vec<Open>,
    root: Option<Node>,
    nodes: usize,
    mistakes: usize,
    unusable: bool,
}

/// A list or mapping whose end has not come yet.
struct Open {
    span: Span,
    content: Content,
}

enum Content {
    Sequence(Vec<Node>),
    Mapping(OpenMapping),
}

#[derive(Default)]
struct OpenMapping {
    entries: Vec<(Spanned<String>, Node)>,
    first_places: BTreeMap<String, Span>,
    key: Option<Key>,
}

/// A key that waits for its value.
enum Key {
    Usable(Spanned<String>),
    /// It may be the decimals of a number with a decimal comma: then no value follows.
    Decimals(Spanned<String>),
    /// Already reported; its value is read and dropped.
    Refused,
}

impl<'a> Tree<'a> {
    pub(super) fn new(diagnostics: &'a mut Diagnostics) -> Self {
        Self { diagnostics, open: Vec::new(), root: None, nodes: 0, mistakes: 0, unusable: false }
    }

    /// The finished tree; nothing where a mistake makes it unusable or there is no value in the text.
    pub(super) fn finish(self) -> Option<Node> {
        if self.unusable { None } else { self.root }
    }

    /// Whether reading on is of no use.
    pub(super) fn stopped(&self) -> bool {
        self.mistakes >= MAX_MISTAKES
    }

    /// The innermost bracket that is open, if the innermost list or mapping has one.
    pub(super) fn open_bracket(&self) -> Option<Span> {
        let innermost = self.open.last()?.span;
        (innermost.start != innermost.end).then_some(innermost)
    }

    /// Reports a mistake that leaves the tree with a hole, so that no later stage may speak of it.
    pub(super) fn refuse(&mut self, diagnostic: Diagnostic) {
        self.unusable = true;
        self.report(diagnostic);
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.mistakes += 1;
        self.diagnostics.push(diagnostic);
    }

    fn stop(&mut self, diagnostic: Diagnostic) {
        self.refuse(diagnostic);
        self.mistakes = MAX_MISTAKES;
    }

    pub(super) fn scalar(&mut self, text: &str, quoted: bool, span: Span) {
        if !self.count(span) {
            return;
        }
        let left_out = span.start == span.end || text == "~" || text == "null";
        let kind = if left_out && !quoted {
            NodeKind::Null
        } else {
            let text = text.to_owned();
            NodeKind::Scalar(Scalar { text, quoted })
        };
        self.place(Node { span, kind });
    }

    pub(super) fn begin_sequence(&mut self, span: Span) {
        self.begin(span, Content::Sequence(Vec::new()));
    }

    pub(super) fn begin_mapping(&mut self, span: Span) {
        self.begin(span, Content::Mapping(OpenMapping::default()));
    }

    /// Ends the innermost list or mapping; `end` is the span of its closing bracket, empty where it has none.
    pub(super) fn end(&mut self, end: Span) {
        let Some(Open { mut span, content }) = self.open.pop() else {
            return;
        };
        let (kind, last) = match content {
            Content::Sequence(items) => {
                let last = items.last().map(|node| node.span);
                (NodeKind::Sequence(items), last)
            }
            Content::Mapping(mapping) => {
                let last = mapping.entries.last().map(|(key, node)| key.span.to(node.span));
                (NodeKind::Mapping(mapping.entries), last)
            }
        };
        let bracketed = end.start != end.end;
        span.end = match last {
            Some(last) if !bracketed => last.end,
            _ => end.end,
        };
        self.place(Node { span, kind });
    }

    fn begin(&mut self, span: Span, content: Content) {
        if !self.count(span) {
            return;
        }
        if self.open.len() >= MAX_DEPTH {
            self.stop(too_deep(span));
            return;
        }
        self.open.push(Open { span, content });
    }

    fn count(&mut self, span: Span) -> bool {
        self.nodes += 1;
        if self.nodes > MAX_NODES {
            let message = format!("this file has more than {MAX_NODES} values");
            self.stop(
                Diagnostic::error("E0004", span, message).help("split the file, or thin out its tables"),
            );
        }
        !self.stopped()
    }

    fn place(&mut self, node: Node) {
        let Some(parent) = self.open.last_mut() else {
            self.root.get_or_insert(node);
            return;
        };
        match &mut parent.content {
            Content::Sequence(items) => items.push(node),
            Content::Mapping(mapping) => {
                if let Some(mistake) = mapping.place(node) {
                    self.report(mistake);
                }
            }
        }
    }
}

impl OpenMapping {
    /// Takes a key or, after a key, its value.
    fn place(&mut self, node: Node) -> Option<Diagnostic> {
        match self.key.take() {
            None => {
                let (key, mistake) = self.key_of(node);
                self.key = Some(key);
                mistake
            }
            Some(Key::Refused) => None,
            Some(Key::Usable(key)) => {
                self.enter(key, node);
                None
            }
            Some(Key::Decimals(decimals)) if node.kind == NodeKind::Null => {
                self.give_back(&decimals);
                None
            }
            Some(Key::Decimals(key)) => {
                let (key, mistake) = self.once(key);
                if let Key::Usable(key) = key {
                    self.enter(key, node);
                }
                mistake
            }
        }
    }

    fn enter(&mut self, key: Spanned<String>, mut node: Node) {
        if node.span.start == node.span.end {
            node.span = key.span;
        }
        self.entries.push((key, node));
    }

    fn key_of(&mut self, node: Node) -> (Key, Option<Diagnostic>) {
        let span = node.span;
        let NodeKind::Scalar(Scalar { text, .. }) = node.kind else {
            let message = format!("a key must be a name, found {}", node.kind_name());
            let mistake =
                Diagnostic::error("E0006", span, message).help("write a plain name, as in `name: value`");
            return (Key::Refused, Some(mistake));
        };
        let key = Spanned::new(text, span);
        if self.follows_comma(&key) {
            return (Key::Decimals(key), None);
        }
        self.once(key)
    }

    /// A key that must not be there yet (E0005).
    fn once(&mut self, key: Spanned<String>) -> (Key, Option<Diagnostic>) {
        if let Some(&first) = self.first_places.get(&key.value) {
            let message = format!("duplicate key `{}`", key.value);
            let mistake = Diagnostic::error("E0005", key.span, message);
            let mistake = mistake.label("given again here").also(first, "first given here");
            return (Key::Refused, Some(mistake.help("keep one of the two")));
        }
        self.first_places.insert(key.value.clone(), key.span);
        (Key::Usable(key), None)
    }

    /// Whether a key begins with a digit, right behind the comma behind a whole number, as in `{size: 8,5 um}`.
    fn follows_comma(&self, key: &Spanned<String>) -> bool {
        let Some((_, before)) = self.entries.last() else { return false };
        let NodeKind::Scalar(Scalar { text, quoted: false }) = &before.kind else { return false };
        let whole = text.strip_prefix(['-', '+']).unwrap_or(text);
        let digits = |text: &str| text.bytes().all(|letter| letter.is_ascii_digit());
        let touches = before.span.end.saturating_add(1) == key.span.start;
        touches && !whole.is_empty() && digits(whole) && key.value.get(..1).is_some_and(digits)
    }

    /// Gives what stands behind a decimal comma back to the value before it: who reads that as a number tells what is wrong with the whole.
    fn give_back(&mut self, decimals: &Spanned<String>) {
        if let Some((_, Node { span, kind: NodeKind::Scalar(Scalar { text, .. }) })) = self.entries.last_mut()
        {
            *text += &format!(",{}", decimals.value);
            span.end = decimals.span.end;
        }
    }
}

/// Values stand too deep in one another.
pub(super) fn too_deep(span: Span) -> Diagnostic {
    let message = format!("values are nested more than {MAX_DEPTH} levels deep here");
    Diagnostic::error("E0004", span, message)
        .help("reduce the nesting; no file of this kind needs more than a few levels")
}
