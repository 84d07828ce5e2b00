//! What is wrong with a file, as data: a code, a place, a sentence and what to write instead.
//!
//! In: the findings of every reading and checking stage. Out: one ordered collection that a caller may count, show
//! or compare. Mistakes of the user are collected here and never stop the stage that finds them, so that one run
//! shows them all. How they look on a terminal is [`render`]'s matter alone.

mod render;

pub use render::render;

use crate::source::Span;

/// How grave a finding is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Severity {
    /// The file cannot be used as it is.
    Error,
    /// The file can be used, but probably does not mean what was meant.
    Warning,
}

/// One finding at one place of a file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Diagnostic {
    /// A stable name of the kind of mistake, such as `E0104` or `W0201`.
    pub code: &'static str,
    /// Error or warning.
    pub severity: Severity,
    /// What is wrong, in one sentence without a full stop.
    pub message: String,
    /// The text that is wrong.
    pub span: Span,
    /// A few words to stand beside the text; may be empty.
    pub label: String,
    /// Other places that belong to the mistake, such as the first of two equal keys, with a few words each.
    pub secondary: Vec<(Span, String)>,
    /// What to write instead.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error at a place.
    pub fn error(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, span, message.into())
    }

    /// A warning at a place.
    pub fn warning(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, span, message.into())
    }

    fn new(severity: Severity, code: &'static str, span: Span, mut message: String) -> Self {
        shorten(&mut message);
        Self { code, severity, message, span, label: String::new(), secondary: Vec::new(), help: None }
    }

    /// Adds the words that stand beside the text.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// Adds another place that belongs to the mistake.
    #[must_use]
    pub fn also(mut self, span: Span, label: impl Into<String>) -> Self {
        self.secondary.push((span, label.into()));
        self
    }

    /// Adds what to write instead.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Adds "did you mean `...`?" where a near name is known.
    #[must_use]
    pub fn suggest(self, nearest: Option<&str>) -> Self {
        match nearest {
            Some(name) => self.help(format!("did you mean `{name}`?")),
            None => self,
        }
    }
}

/// Messages quote the user's text, which may be of any length.
fn shorten(message: &mut String) {
    const MOST: usize = 240;
    if let Some((end, _)) = message.char_indices().nth(MOST) {
        message.truncate(end);
        message.push('\u{2026}');
    }
}

/// The findings of a run, in the order in which they were made until [`Diagnostics::sort`] is called.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Diagnostics(Vec<Diagnostic>);

impl Diagnostics {
    /// No findings.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one finding.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.0.push(diagnostic);
    }

    /// Whether one of the findings is an error.
    pub fn has_errors(&self) -> bool {
        let mut severities = self.0.iter().map(|diagnostic| diagnostic.severity);
        severities.any(|severity| severity == Severity::Error)
    }

    /// The findings in their present order.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.0.iter()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Puts them in the order of their places in the file, then of their codes; equals keep their order.
    pub fn sort(&mut self) {
        self.0.sort_by(|left, right| (left.span.start, left.code).cmp(&(right.span.start, right.code)));
    }
}

impl Extend<Diagnostic> for Diagnostics {
    fn extend<I: IntoIterator<Item = Diagnostic>>(&mut self, diagnostics: I) {
        self.0.extend(diagnostics);
    }
}

impl IntoIterator for Diagnostics {
    type Item = Diagnostic;
    type IntoIter = std::vec::IntoIter<Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl<'a> IntoIterator for &'a Diagnostics {
    type Item = &'a Diagnostic;
    type IntoIter = std::slice::Iter<'a, Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorts_by_place_then_code() {
        let mut all = Diagnostics::new();
        all.push(Diagnostic::error("E0002", Span::new(9, 10), "last"));
        all.push(Diagnostic::error("E0002", Span::new(1, 10), "second"));
        all.push(Diagnostic::warning("E0001", Span::new(1, 3), "first"));
        all.sort();
        let order: Vec<_> = all.iter().map(|one| one.message.as_str()).collect();
        assert_eq!(order, ["first", "second", "last"]);
    }

    #[test]
    fn warnings_are_not_errors() {
        let mut all = Diagnostics::new();
        assert!(!all.has_errors());
        all.push(Diagnostic::warning("W0001", Span::default(), "careful"));
        assert!(!all.has_errors());
        all.extend([Diagnostic::error("E0001", Span::default(), "wrong")]);
        assert!(all.has_errors());
        assert_eq!(all.len(), 2);
    }

    #[test]
    fn a_suggestion_becomes_the_help() {
        let plain = Diagnostic::error("E0001", Span::default(), "wrong");
        assert_eq!(plain.clone().suggest(None).help, None);
        let helped = plain.suggest(Some("origin"));
        assert_eq!(helped.help.as_deref(), Some("did you mean `origin`?"));
    }
}
