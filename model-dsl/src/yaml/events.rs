//! The YAML crate's events turned into tree steps, and its errors into findings.

use super::tree::{Tree, too_deep};
use super::{MAX_BYTES, Node};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{SourceFile, Span};
use granit_parser::{ErrorKind, Event, Parser, ScalarStyle, ScanError, options};

/// Reads a file's text into a tree.
///
/// Findings: E0001 not YAML, E0002 nothing in the file, E0003 too large, E0004 too deep, too many values or an alias,
/// E0005 a key given twice (both places), E0006 a key that is not a name, E0007 more than one document, E0008 a tag.
/// There is a tree beside E0005 and E0006 (the first of equal keys counts), and none beside the others.
pub fn read(source: &SourceFile, diagnostics: &mut Diagnostics) -> Option<Node> {
    let length = source.text().len();
    if length > MAX_BYTES {
        let message = format!("this file is too large: {length} bytes, the limit is {MAX_BYTES}");
        diagnostics.push(
            Diagnostic::error("E0003", Span::default(), message)
                .help("split the file, or thin out its tables"),
        );
        return None;
    }
    let before = diagnostics.len();
    let mut tree = Tree::new(diagnostics);
    feed(source, &mut tree);
    let root = tree.finish().filter(|node| node.kind != super::NodeKind::Null);
    if root.is_none() && diagnostics.len() == before {
        let empty = Diagnostic::error("E0002", Span::default(), "this file is empty");
        diagnostics.push(empty.help(
            "begin with the kind of file and the version of its format, such as `abbe: 1` (a machine), `calibration: 1`, `recording: 1`, `path: 1` or `setup: 1`",
        ));
    }
    root
}

fn feed(source: &SourceFile, tree: &mut Tree<'_>) {
    let options = options! { emit_unresolved_aliases: true };
    let mut documents = 0;
    for next in Parser::new_from_str_with_options(source.text(), options) {
        match next {
            Ok((event, span)) => {
                let tag = span.tag_span().map(place_of);
                step(event, place_of(span), tag, &mut documents, tree);
            }
            Err(error) => {
                let mut mistake = not_yaml(source, &error);
                if let Some(bracket) = tree.open_bracket().filter(|&open| open != mistake.span) {
                    mistake = mistake.also(bracket, "opened here and not closed yet");
                }
                tree.refuse(mistake);
                return;
            }
        }
        if tree.stopped() || documents > 1 {
            return;
        }
    }
}

fn step(event: Event<'_>, span: Span, tag: Option<Span>, documents: &mut usize, tree: &mut Tree<'_>) {
    if let Some(tag) = tag {
        let refused = Diagnostic::error("E0008", tag, "tags such as `!name` have no meaning here");
        tree.refuse(refused.help("remove the tag"));
    }
    match event {
        Event::DocumentStart(..) => {
            *documents += 1;
            if *documents > 1 {
                let second = Diagnostic::error("E0007", span, "a second document begins here");
                tree.refuse(second.help("write one document per file; move the rest to another file"));
            }
        }
        Event::Scalar(text, style, ..) => tree.scalar(&text, style != ScalarStyle::Plain, span),
        Event::SequenceStart(..) => tree.begin_sequence(span),
        Event::MappingStart(..) => tree.begin_mapping(span),
        Event::SequenceEnd | Event::MappingEnd => tree.end(span),
        Event::Alias(_) | Event::UnresolvedAlias(_) => {
            let refused = Diagnostic::error("E0004", span, "aliases (`*name`) are not allowed");
            tree.refuse(refused.help("write the value here, or quote it if it is not an alias"));
            tree.scalar("~", false, span);
        }
        _ => {}
    }
}

fn place_of(span: granit_parser::Span) -> Span {
    let range = span.byte_range().unwrap_or_default();
    Span::new(range.start, range.end)
}

fn not_yaml(source: &SourceFile, error: &ScanError) -> Diagnostic {
    let start = error.marker().byte_offset().unwrap_or_default();
    let rest = source.text().get(start..).unwrap_or("");
    let width = rest.chars().next().filter(|&next| next != '\n' && next != '\r');
    let span = Span::new(start, start + width.map_or(0, char::len_utf8));
    if *error.kind() == ErrorKind::RecursionLimitExceeded {
        return too_deep(span);
    }
    let in_brackets = matches!(
        error.kind(),
        ErrorKind::UnexpectedEofFlowSequence
            | ErrorKind::UnexpectedEofFlowMapping
            | ErrorKind::UnexpectedEofImplicitFlowMapping
    );
    if in_brackets && rest.starts_with(',') {
        let diagnostic =
            Diagnostic::error("E0001", span, "this is not YAML: nothing is given before this comma");
        return diagnostic.help("remove the comma, or write the missing value");
    }
    let diagnostic = Diagnostic::error("E0001", span, format!("this is not YAML: {}", error.kind()));
    let otherwise = "check brackets, quotes and indentation here and on the line above";
    diagnostic.help(help(error.kind()).unwrap_or_else(|| otherwise.to_owned()))
}

fn help(kind: &ErrorKind) -> Option<String> {
    let text = match kind {
        ErrorKind::TabNotAllowed
        | ErrorKind::TabInBlockIndentation
        | ErrorKind::TabInIndentation
        | ErrorKind::TabInPlainScalar => "indent with spaces instead of tabs",
        ErrorKind::UnclosedFlowCollection { open: '[' } => "close it with `]`",
        ErrorKind::UnclosedFlowCollection { .. } => "close it with `}`",
        ErrorKind::InvalidIndentation
        | ErrorKind::ExpectedBlockMappingKey
        | ErrorKind::ExpectedBlockSequenceEntry => {
            "begin all keys of a mapping, and every `-` of a list, in the same column"
        }
        ErrorKind::InvalidSimpleKey | ErrorKind::SimpleKeyExpected | ErrorKind::MappingValueNotAllowed => {
            "write each `key: value` on its own line, in the same column; put a value that contains `: ` into quotes"
        }
        ErrorKind::UnclosedQuotedScalar | ErrorKind::InvalidQuotedScalarIndent => "close the quotes",
        ErrorKind::UnexpectedCharacter { .. } => "put the value into quotes",
        _ => return None,
    };
    Some(text.to_owned())
}
