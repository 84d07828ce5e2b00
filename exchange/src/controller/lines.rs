//! Text files line by line. In: a source. Out: its lines with their places, without comments; and numbers in them.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::{SourceFile, Span};

/// A line and where it stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'s> {
    /// The line without what surrounds it.
    pub text: &'s str,
    /// Its place in the file.
    pub span: Span,
}

/// The lines of a file that hold more than space and a comment, which begins with `comment` and ends with the line.
pub(super) fn lines<'s>(source: &'s SourceFile, comment: &'static str) -> impl Iterator<Item = Line<'s>> {
    let text = source.text();
    text.split_inclusive('\n').filter_map(move |line| {
        let told = Line::of(text, line.split(comment).next().unwrap_or_default().trim());
        (!told.text.is_empty()).then_some(told)
    })
}

impl<'s> Line<'s> {
    /// A part of a whole text, with its place in it.
    pub(super) fn of(whole: &'s str, part: &'s str) -> Self {
        let from = part.as_ptr().addr().saturating_sub(whole.as_ptr().addr());
        Self { text: part, span: Span::new(from, from + part.len()) }
    }

    /// A part of the line, with its place.
    pub(super) fn part(self, part: &'s str) -> Self {
        let Self { span, .. } = Self::of(self.text, part);
        Self { text: part, span: Span::new(self.span.start + span.start, self.span.start + span.end) }
    }

    /// Its words, each with its place.
    pub(super) fn words(self) -> impl Iterator<Item = Line<'s>> {
        self.text.split_whitespace().map(move |word| self.part(word))
    }

    /// What stands between separators, without the space around it, each with its place.
    pub(super) fn cells(self, separator: char) -> impl Iterator<Item = Line<'s>> {
        self.text.split(separator).map(move |cell| self.part(cell.trim()))
    }

    /// A finite number, or a finding.
    pub(super) fn number(self, diagnostics: &mut Diagnostics) -> Option<f64> {
        let number = self.text.parse().ok().filter(|number: &f64| number.is_finite());
        if number.is_none() {
            let message = format!("`{}` is not a number", self.text);
            diagnostics
                .push(Diagnostic::error("E0801", self.span, message).help("write a number such as -0.0125"));
        }
        number
    }

    /// A finding: the line has not the form of its file.
    pub(super) fn malformed(self, form: &str, diagnostics: &mut Diagnostics) {
        let message = format!("`{}` is not allowed here", self.text);
        diagnostics.push(Diagnostic::error("E0802", self.span, message).help(form));
    }
}
