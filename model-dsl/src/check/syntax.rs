//! The lines of an equation file. In: its text. Out: sections of statements with their places; what a
//! statement means is not asked here.
//!
//! Comments are blanked in place, so that every byte keeps its offset.

use std::collections::BTreeMap;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{SourceFile, Span, Spanned};

/// One statement.
#[derive(Clone, Debug)]
pub(super) enum Statement {
    /// `left = right`.
    Equation(Spanned<String>, Spanned<String>),
    /// `let letter = value`.
    Let(Spanned<String>, Spanned<String>),
}

/// The statements under one header.
#[derive(Clone, Debug, Default)]
pub(super) struct Section {
    /// The words between the brackets; none before the first header.
    pub(super) name: Option<Spanned<String>>,
    /// In the file's order.
    pub(super) statements: Vec<Statement>,
}

/// Reads the lines of a file; sections of the same name are one.
pub(super) fn read(file: &SourceFile, diagnostics: &mut Diagnostics) -> Vec<Section> {
    let text = blanked(file.text());
    let mut sections = vec![Section::default()];
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    let mut current = 0;
    for span in statements(&text, diagnostics) {
        let part = trimmed(&text, span);
        if part.value.starts_with('[') {
            if let Some(name) = header(&part, diagnostics) {
                current = *places.entry(name.value.clone()).or_insert(sections.len());
                if current == sections.len() {
                    sections.push(Section { name: Some(name), statements: Vec::new() });
                }
            }
        } else if let (Some(statement), Some(section)) =
            (statement(&text, &part, diagnostics), sections.get_mut(current))
        {
            section.statements.push(statement);
        }
    }
    sections
}

/// The text with comments and a byte order mark replaced by as many blanks.
fn blanked(text: &str) -> String {
    let mut blanked = String::with_capacity(text.len());
    let mut comment = false;
    for character in text.chars() {
        comment = character != '\n' && (comment || character == '#');
        if comment || character == '\u{feff}' {
            blanked.push_str(&" ".repeat(character.len_utf8()));
        } else {
            blanked.push(character);
        }
    }
    blanked
}

/// The spans of the statements: a line with the indented lines that continue it.
fn statements(text: &str, diagnostics: &mut Diagnostics) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let span = Span::new(start, start + line.len());
        start = span.end;
        let content = line.trim();
        let begins = content.starts_with('[') || content.contains('=') || !line.starts_with([' ', '\t']);
        match spans.last_mut() {
            _ if content.is_empty() => {}
            Some(last) if !begins => last.end = span.end,
            None if !begins => diagnostics.push(
                Diagnostic::error("E0501", trimmed(text, span).span, "this indented line continues nothing")
                    .label("no equation precedes it")
                    .help("write `Px = expression`"),
            ),
            _ => spans.push(span),
        }
    }
    spans
}

/// The text of a span without the blanks around it.
fn trimmed(text: &str, span: Span) -> Spanned<String> {
    let whole = text.get(span.start..span.end).unwrap_or("");
    let start = span.start + (whole.len() - whole.trim_start().len());
    let content = whole.trim();
    Spanned::new(content.to_owned(), Span::new(start, start + content.len()))
}

fn header(part: &Spanned<String>, diagnostics: &mut Diagnostics) -> Option<Spanned<String>> {
    let inner = part.value.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    let name = inner.map(|inner| inner.split_whitespace().collect::<Vec<_>>().join(" "));
    match name {
        Some(name) if !name.is_empty() && !name.contains(['[', ']', '=']) => {
            Some(Spanned::new(name, part.span))
        }
        _ => {
            diagnostics.push(
                Diagnostic::error("E0508", part.span, "this is not a section header")
                    .label("a header must be alone on its line")
                    .help("write `[general]`, `[significant]` or `[carriage X]`"),
            );
            None
        }
    }
}

fn statement(text: &str, part: &Spanned<String>, diagnostics: &mut Diagnostics) -> Option<Statement> {
    let Some(equals) = part.value.find('=') else {
        diagnostics.push(
            Diagnostic::error("E0501", part.span, "this line is not an equation")
                .label("there is no `=`")
                .help("write `Px = expression`; indent a line that continues the one before it"),
        );
        return None;
    };
    let at = part.span.start + equals;
    let left = trimmed(text, Span::new(part.span.start, at));
    let right = trimmed(text, Span::new(at + 1, part.span.end));
    match left.value.strip_prefix("let").filter(|rest| rest.starts_with(char::is_whitespace)) {
        Some(_) => {
            let letter = trimmed(text, Span::new(left.span.start + "let".len(), at));
            Some(Statement::Let(letter, right))
        }
        None => Some(Statement::Equation(left, right)),
    }
}
