//! The text of one file and places in it.
//!
//! In: a file's name and text. Out: byte spans and, for people, lines and columns. Every later stage carries
//! these spans along, so that each message can point at the words it speaks of.

use std::fmt;
use std::fs::File;
use std::hash::{Hash, Hasher};
use std::io::Read;
use std::path::Path;

/// No byte beyond this one is read: a larger file is refused, and a device may have no end.
const MOST_BYTES: u64 = 8 * 1024 * 1024;

/// One file as it was read: its name, as the user gave it, and its whole text.
#[derive(Clone, Debug)]
pub struct SourceFile {
    name: String,
    text: String,
    line_starts: Vec<usize>,
}

impl SourceFile {
    /// Takes a file's name (a path as the user wrote it, or any label) and its text.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let text = text.into();
        let after_breaks = text.bytes().enumerate();
        let after_breaks = after_breaks.filter(|&(_, byte)| byte == b'\n');
        let line_starts = std::iter::once(0).chain(after_breaks.map(|(offset, _)| offset + 1)).collect();
        Self { name: name.into(), text, line_starts }
    }

    /// Reads a file whole.
    ///
    /// # Errors
    /// Says in words that it cannot be read, is not UTF-8 or is larger than 8 MiB.
    pub fn open(path: &Path) -> Result<Self, String> {
        let cannot = |why: String| format!("error: cannot read {}: {why}", path.display());
        let mut text = String::new();
        let file = File::open(path).map_err(|error| cannot(error.to_string()))?;
        file.take(MOST_BYTES + 1).read_to_string(&mut text).map_err(|error| cannot(error.to_string()))?;
        if u64::try_from(text.len()).is_ok_and(|length| length > MOST_BYTES) {
            return Err(cannot(format!("it is larger than {} MiB", MOST_BYTES >> 20)));
        }
        Ok(Self::new(path.display().to_string(), text))
    }

    /// The file's name as given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The whole text, byte order mark and line endings included.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text under a span; empty where the span does not fit this file.
    pub fn slice(&self, span: Span) -> &str {
        self.text.get(span.start..span.end).unwrap_or("")
    }

    /// Line and column of a byte offset, both counted from 1, the column in characters.
    ///
    /// An offset past the end stands for the end; one inside a character stands for that character.
    pub fn line_column(&self, offset: usize) -> (usize, usize) {
        let offset = self.text.floor_char_boundary(offset);
        let line = self.line_starts.partition_point(|&start| start <= offset);
        let start = self.line_start(line);
        let column = self.text.get(start..offset).map_or(0, count_columns);
        (line, column + 1)
    }

    /// The byte offset at which a line, counted from 1, begins; the text's length for a line past the last.
    pub fn line_start(&self, line: usize) -> usize {
        let index = line.saturating_sub(1);
        *self.line_starts.get(index).unwrap_or(&self.text.len())
    }
}

/// Counts characters, leaving out a byte order mark, which no editor shows.
fn count_columns(text: &str) -> usize {
    text.chars().filter(|&character| character != '\u{feff}').count()
}

/// A stretch of a file's text: byte offsets, `end` not included.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, PartialOrd, Ord, Hash)]
pub struct Span {
    /// Offset of the first byte.
    pub start: usize,
    /// Offset just after the last byte.
    pub end: usize,
}

impl Span {
    /// The span from `start` up to `end`, which is not included.
    pub fn new(start: usize, end: usize) -> Self {
        Self { start, end }
    }

    /// The smallest span that covers both.
    pub fn to(self, other: Self) -> Self {
        Self::new(self.start.min(other.start), self.end.max(other.end))
    }
}

/// A value and the place that it was read from.
///
/// Two of them are equal when their values are, wherever they stand, so that tests need not care for places.
#[derive(Clone, Copy, Default)]
pub struct Spanned<T> {
    /// What was read.
    pub value: T,
    /// Where it stands.
    pub span: Span,
}

impl<T> Spanned<T> {
    /// Puts a value and its place together.
    pub fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }

    /// Changes the value and keeps the place.
    pub fn map<U>(self, change: impl FnOnce(T) -> U) -> Spanned<U> {
        Spanned::new(change(self.value), self.span)
    }

    /// The same place with the value borrowed.
    pub fn as_ref(&self) -> Spanned<&T> {
        Spanned::new(&self.value, self.span)
    }
}

impl<T: PartialEq> PartialEq for Spanned<T> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<T: Eq> Eq for Spanned<T> {}

impl<T: PartialOrd> PartialOrd for Spanned<T> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<T: Ord> Ord for Spanned<T> {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.value.cmp(&other.value)
    }
}

impl<T: Hash> Hash for Spanned<T> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.value.hash(state);
    }
}

impl<T: fmt::Debug> fmt::Debug for Spanned<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Span { start, end } = self.span;
        write!(formatter, "{:?} @ {start}..{end}", self.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_not_bytes() {
        let source = SourceFile::new("a.yaml", "a\nµm: 1\r\nx");
        assert_eq!(source.line_column(0), (1, 1));
        assert_eq!(source.line_column(2), (2, 1));
        assert_eq!(source.line_column(4), (2, 2));
        assert_eq!(source.line_column(3), (2, 1));
        assert_eq!(source.line_column(10), (3, 1));
        assert_eq!(source.line_column(999), (3, 2));
    }

    #[test]
    fn a_byte_order_mark_takes_no_column() {
        let source = SourceFile::new("a.yaml", "\u{feff}abbe: 1");
        assert_eq!(source.line_column(3), (1, 1));
        assert_eq!(source.line_column(9), (1, 7));
    }

    #[test]
    fn an_empty_file_has_one_line() {
        assert_eq!(SourceFile::new("a", "").line_column(0), (1, 1));
    }

    #[test]
    fn spanned_values_are_equal_by_value() {
        let here = Spanned::new("x", Span::new(0, 1));
        let there = Spanned::new("x", Span::new(7, 8));
        assert_eq!(here, there);
        assert_eq!(here.map(str::len).value, 1);
        assert_eq!(Span::new(3, 5).to(Span::new(1, 4)), Span::new(1, 5));
    }

    #[test]
    fn a_span_of_another_file_shows_nothing() {
        let source = SourceFile::new("a", "µ");
        assert_eq!(source.slice(Span::new(1, 2)), "");
        assert_eq!(source.slice(Span::new(0, 2)), "µ");
    }
}
