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
        let start = line.as_ptr().addr() - text.as_ptr().addr();
        let told = line.split(comment).next().unwrap_or_default();
        let trimmed = told.trim();
        let from = start + told.find(trimmed).unwrap_or_default();
        (!trimmed.is_empty()).then_some(Line { text: trimmed, span: Span::new(from, from + trimmed.len()) })
    })
}

impl<'s> Line<'s> {
    /// Its words, each with its place.
    pub(super) fn words(self) -> impl Iterator<Item = Line<'s>> {
        self.text.split_whitespace().map(move |word| {
            let from = self.span.start + (word.as_ptr().addr() - self.text.as_ptr().addr());
            Line { text: word, span: Span::new(from, from + word.len()) }
        })
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
        let message = format!("`{}` has no place here", self.text);
        diagnostics.push(Diagnostic::error("E0802", self.span, message).help(form));
    }
}
