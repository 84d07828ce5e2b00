//! Findings as text for people: the only place that knows a rendering library.
//!
//! In: a file and the findings about it. Out: for each of them the code, file, line, column, the line of the file with
//! the text marked, and what to write instead. Only the lines around the marks are handed to the library, and very
//! long lines only in part, so that the effort does not grow with the file.

use super::{Diagnostic, Diagnostics, Severity};
use crate::source::{SourceFile, Span};
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use std::ops::Range;

/// No more findings than this are shown; the rest is counted.
const MAX_SHOWN: usize = 100;

/// Lines are cut to about this many characters, `...` standing for the rest.
const WIDTH: usize = 140;

/// Marked texts longer than this many bytes are shown by their first line.
const LONG: usize = 2_000;

/// A line longer than this many bytes is cut around each mark.
const LONG_LINE: usize = 500;

/// Two places that are no more than this many bytes apart stand under one heading.
const NEAR: usize = 16_000;

/// What is left of a long line on each side of a mark, in bytes; enough for the library to cut on its own.
const CONTEXT: usize = 300;

/// In a line that is cut, no more than this many bytes are marked.
const LONG_MARK: usize = 400;

/// Shows every finding with its code, file, line, column, the text, a label and a help line.
///
/// Plain text without `color`, otherwise with the terminal's colour codes. Columns count characters from 1.
pub fn render(source: &SourceFile, diagnostics: &Diagnostics, color: bool) -> String {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    let renderer = renderer.term_width(WIDTH);
    let mut sorted = diagnostics.clone();
    sorted.sort();
    let shown = sorted.iter().take(MAX_SHOWN);
    let mut texts: Vec<String> = shown.map(|one| render_one(source, one, &renderer)).collect();
    if diagnostics.len() > MAX_SHOWN {
        let rest = diagnostics.len() - MAX_SHOWN;
        texts.push(format!("{rest} more findings are not shown"));
    }
    let mut text = texts.join("\n\n");
    if !text.is_empty() {
        text.push('\n');
    }
    text
}

fn render_one(source: &SourceFile, diagnostic: &Diagnostic, renderer: &Renderer) -> String {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(diagnostic.message.as_str()).id(diagnostic.code);
    let mut group = Group::with_title(title);
    let windows = windows(source, diagnostic);
    for window in &windows {
        if window.cut
            && let Some(mark) = window.marks.first()
        {
            let (line, column) = source.line_column(mark.span.start);
            group = group.element(Origin::path(source.name()).line(line).char_column(column));
        }
        group = group.element(window.snippet(source));
    }
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    let text = renderer.render(&[group]);
    if windows.iter().any(|window| window.cut) { without_empty_headings(&text) } else { text }
}

/// Takes out the `:::` that the library puts between a place and a snippet that has no name of its own.
fn without_empty_headings(text: &str) -> String {
    let heading = |line: &&str| !line.trim_end_matches([' ', '\u{1b}', '[', '0', 'm']).ends_with(":::");
    let lines: Vec<&str> = text.lines().filter(heading).collect();
    lines.join("\n")
}

/// A marked text and the words beside it.
struct Mark<'a> {
    span: Span,
    kind: AnnotationKind,
    label: Option<&'a str>,
}

/// A part of the file that is shown under one heading, with its marks.
struct Window<'a> {
    bytes: Range<usize>,
    first_line: usize,
    /// Whether it is a part of one long line.
    cut: bool,
    marks: Vec<Mark<'a>>,
}

/// The parts of the file to show: that of the finding first, then those that are not near to it.
fn windows<'a>(source: &SourceFile, diagnostic: &'a Diagnostic) -> Vec<Window<'a>> {
    let label = Some(diagnostic.label.as_str()).filter(|label| !label.is_empty());
    let kind = AnnotationKind::Primary;
    let span = diagnostic.span;
    let mut windows = vec![Window::around(source, Mark { span, kind, label })];
    for (span, label) in &diagnostic.secondary {
        let (span, label, kind) = (*span, Some(label.as_str()), AnnotationKind::Context);
        let other = Window::around(source, Mark { span, kind, label });
        match windows.iter_mut().find(|window| window.is_near(&other)) {
            Some(window) => window.absorb(other),
            None => windows.push(other),
        }
    }
    windows
}

impl<'a> Window<'a> {
    /// The lines that a mark touches, or the first of them, or a part of it, as their length demands.
    fn around(source: &SourceFile, mark: Mark<'a>) -> Self {
        let span = mark.span;
        let (first_line, _) = source.line_column(span.start);
        let (last_line, _) = source.line_column(span.end);
        let start = source.line_start(first_line);
        let mut bytes = start..source.line_start(last_line + 1);
        let line = start..source.line_start(first_line + 1);
        if bytes.len() > LONG {
            bytes = line.clone();
        }
        let cut = bytes == line && bytes.len() > LONG_LINE;
        if cut {
            let text = source.text();
            let from = span.start.saturating_sub(CONTEXT).max(bytes.start);
            let to = (span.start + LONG_MARK + CONTEXT).min(bytes.end);
            bytes = text.ceil_char_boundary(from)..text.floor_char_boundary(to);
        }
        Self { bytes, first_line, cut, marks: vec![mark] }
    }

    fn is_near(&self, other: &Self) -> bool {
        let both = self.bytes.start.min(other.bytes.start)..self.bytes.end.max(other.bytes.end);
        !self.cut && !other.cut && both.len() <= NEAR
    }

    fn absorb(&mut self, other: Self) {
        self.bytes.start = self.bytes.start.min(other.bytes.start);
        self.bytes.end = self.bytes.end.max(other.bytes.end);
        self.first_line = self.first_line.min(other.first_line);
        self.marks.extend(other.marks);
    }

    fn snippet<'t>(&self, source: &'t SourceFile) -> Snippet<'t, Annotation<'t>>
    where
        'a: 't,
    {
        let text = source.text().get(self.bytes.clone()).unwrap_or("");
        let snippet = Snippet::source(text).line_start(self.first_line);
        let path = Some(source.name()).filter(|_| !self.cut);
        let marks = self.marks.iter();
        snippet.path(path).annotations(marks.map(|mark| {
            let range = self.range(source, mark.span);
            mark.kind.span(range).label(mark.label)
        }))
    }

    /// Where a mark lies in this part, cut to what is shown.
    fn range(&self, source: &SourceFile, span: Span) -> Range<usize> {
        let longest = if self.cut { LONG_MARK } else { self.bytes.len() };
        let last = (span.start + longest).min(self.bytes.end);
        let text = source.text();
        let start = text.floor_char_boundary(span.start).max(self.bytes.start);
        let end = text.floor_char_boundary(span.end.min(last)).max(start);
        start - self.bytes.start..end - self.bytes.start
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    fn shown(text: &str, diagnostic: Diagnostic, color: bool) -> String {
        let source = SourceFile::new("machines/a.yaml", text);
        let mut diagnostics = Diagnostics::new();
        diagnostics.push(diagnostic);
        render(&source, &diagnostics, color)
    }

    fn at(text: &str, word: &str) -> Span {
        let start = text.find(word).expect("the word");
        Span::new(start, start + word.len())
    }

    const CHAIN: &str = "abbe: 1\nchain:\n  tool:\n    - slide: X\n      µ: 0, orgin: [0, 0, 0]   # µ\n";

    fn unknown_key() -> Diagnostic {
        Diagnostic::error("E0104", at(CHAIN, "orgin"), "unknown key `orgin`")
            .label("a slide has no such key")
            .suggest(Some("origin"))
    }

    #[test]
    fn shows_code_place_text_label_and_help() {
        let expected = "\
error[E0104]: unknown key `orgin`
 --> machines/a.yaml:5:13
  |
5 |       µ: 0, orgin: [0, 0, 0]   # µ
  |             ^^^^^ a slide has no such key
  |
  = help: did you mean `origin`?
";
        assert_eq!(shown(CHAIN, unknown_key(), false), expected);
    }

    #[test]
    fn shows_a_second_place_and_a_warning() {
        let warning = Diagnostic::warning("W0201", at(CHAIN, "tool"), "nothing sees it");
        let expected = "\
warning[W0201]: nothing sees it
 --> machines/a.yaml:3:3
  |
3 |   tool:
  |   ^^^^
4 |     - slide: X
  |       ----- this one
";
        assert_eq!(shown(CHAIN, warning.also(at(CHAIN, "slide"), "this one"), false), expected);
    }

    #[test]
    fn places_far_apart_stand_under_their_own_headings() {
        let text = format!("a: 1\n{}a: 2\n", "b: 3\n".repeat(30_000));
        let again = Span::new(150_005, 150_006);
        let finding = Diagnostic::error("E0005", again, "duplicate key `a`").label("again");
        let expected = "\
error[E0005]: duplicate key `a`
     --> machines/a.yaml:30002:1
      |
30002 | a: 2
      | ^ again
      |
     ::: machines/a.yaml:1:1
      |
    1 | a: 1
      | - first
";
        assert_eq!(shown(&text, finding.also(Span::new(0, 1), "first"), false), expected);
    }

    #[test]
    fn an_empty_file_has_a_place() {
        let expected = "\
error[E0002]: this file is empty
 --> machines/a.yaml:1:1
  |
1 |
  | ^
";
        let empty = Diagnostic::error("E0002", Span::default(), "this file is empty");
        assert_eq!(shown("", empty, false), expected);
    }

    #[test]
    fn a_long_line_is_cut_around_the_mark() {
        let text = format!("a: [{}bad, {}]\nb: 2\n", "1.25, ".repeat(3000), "µ, ".repeat(3000));
        let finding = Diagnostic::error("E0301", at(&text, "bad"), "not a number").label("here");
        for color in [false, true] {
            let report = shown(&text, finding.clone(), color);
            assert!(report.contains("1:18005"), "{report}");
            assert!(!report.contains(":::"), "{report}");
            assert!(report.contains("1.25, bad, µ, µ"), "{report}");
            assert!(report.lines().all(|line| line.chars().count() < 200), "{report}");
        }
    }

    #[test]
    fn two_places_in_a_long_line_are_cut_each_by_itself() {
        let text = format!("{{a: 1, {}a: 2}}\n", "b: 3, ".repeat(150));
        let again = Span::new(907, 908);
        let finding = Diagnostic::error("E0005", again, "duplicate key `a`").label("again");
        let report = shown(&text, finding.also(Span::new(1, 2), "first"), false);
        let lines: Vec<&str> = report.lines().collect();
        assert!(report.contains("1:908") && report.contains("1:2"), "{report}");
        let marked = |text, mark| {
            lines.windows(2).any(|two| two[0].contains(text) && two[1].trim_end().ends_with(mark))
        };
        assert!(marked("b: 3, a: 2}", "^ again") && marked("{a: 1, b: 3", "- first"), "{report}");
        assert!(lines.iter().all(|line| line.len() < 200), "{report}");
    }

    #[test]
    fn a_long_stretch_is_shown_by_its_first_line() {
        let text = "key: value\n".repeat(100_000);
        let report = shown(&text, Diagnostic::error("E0101", Span::new(5, 900_000), "no"), false);
        let expected = "\
error[E0101]: no
 --> machines/a.yaml:1:6
  |
1 | key: value
  |      ^^^^^
";
        assert_eq!(report, expected);
    }

    #[test]
    fn colour_only_where_it_is_wanted() {
        let report = shown(CHAIN, unknown_key(), true);
        assert!(report.contains('\u{1b}'));
        assert!(!shown(CHAIN, unknown_key(), false).contains('\u{1b}'));
    }

    #[test]
    fn many_findings_in_a_huge_line_cost_little() {
        let text = format!("[{}]", "µm, ".repeat(1_600_000));
        let source = SourceFile::new("a.yaml", text);
        let mut diagnostics = Diagnostics::new();
        for index in 0..5_000 {
            let place = Span::new(index * 1000 + 2, index * 1000 + 3);
            diagnostics.push(Diagnostic::error("E0301", place, "not a number"));
        }
        let start = Instant::now();
        let report = render(&source, &diagnostics, false);
        assert!(report.ends_with("4900 more findings are not shown\n"));
        assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
    }

    #[test]
    fn places_outside_the_file_are_harmless() {
        let report = shown("a", Diagnostic::error("E0001", Span::new(70, 90), "odd"), false);
        assert!(report.starts_with("error[E0001]: odd"), "{report}");
        let inside = Diagnostic::error("E0001", Span::new(1, 0), "odd").also(Span::new(9, 2), "x");
        assert!(shown("µ", inside, false).starts_with("error[E0001]: odd"));
    }
}
