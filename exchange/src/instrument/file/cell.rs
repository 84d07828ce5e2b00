//! Pieces of a text with their places. In: a line. Out: words or cells, and the numbers in them.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::quantity::{QuantityError, parse_number, parse_quantity};
use model_dsl::source::Span;
use recording::cells;

/// A piece of a text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece<'t> {
    pub(super) text: &'t str,
    pub(super) span: Span,
}

impl<'t> Piece<'t> {
    /// A part of a text whose first byte stands at `start` in the file.
    pub(super) fn new(text: &'t str, start: usize) -> Self {
        Self { text, span: Span::new(start, start + text.len()) }
    }

    /// The piece without the white space around it.
    pub(super) fn trimmed(self) -> Self {
        let start = self.span.start + (self.text.len() - self.text.trim_start().len());
        Self::new(self.text.trim(), start)
    }

    /// The pieces between separators, empty ones too.
    pub(super) fn split(self, separator: char) -> impl Iterator<Item = Self> {
        let mut start = self.span.start;
        self.text.split(separator).map(move |text| {
            let piece = Self::new(text, start);
            start += text.len() + separator.len_utf8();
            piece
        })
    }

    /// The pieces between white space.
    pub(super) fn words(self) -> impl Iterator<Item = Self> {
        let base = self.text.as_ptr().addr();
        self.text
            .split_ascii_whitespace()
            .map(move |word| Self::new(word, self.span.start + (word.as_ptr().addr() - base)))
    }

    /// What stands before and after the first such character.
    pub(super) fn split_once(self, separator: char) -> Option<(Self, Self)> {
        let (before, after) = self.text.split_once(separator)?;
        let after_start = self.span.start + before.len() + separator.len_utf8();
        Some((Self::new(before, self.span.start), Self::new(after, after_start)))
    }

    /// Its cells, between separators that do not stand in quotes, each without the white space and the quotes around it.
    pub(super) fn cells(self, separator: u8) -> Vec<Self> {
        let mut ranges = Vec::new();
        cells::split(self.text.as_bytes(), separator, &mut ranges);
        ranges.into_iter().filter_map(|range| self.part(range)).map(Self::unquoted).collect()
    }

    /// The mark and the units of a row of units for this number of columns. `None` if the line is another one.
    pub(super) fn units(self, separator: u8, columns: usize) -> Option<Vec<Self>> {
        let mut ranges = Vec::new();
        let found = cells::split_units(self.text.as_bytes(), separator, columns, &mut ranges);
        found.then(|| ranges.into_iter().filter_map(|range| self.part(range)).map(Self::unquoted).collect())
    }

    /// The bytes from one place to another.
    fn part(self, (start, end): (usize, usize)) -> Option<Self> {
        Some(Self::new(self.text.get(start..end)?, self.span.start.saturating_add(start)))
    }

    /// The piece without white space and quotes around it.
    fn unquoted(self) -> Self {
        let cell = self.trimmed();
        let inner = cell.text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
        inner.map_or(cell, |inner| Self::new(inner, cell.span.start.saturating_add(1)).trimmed())
    }

    /// Its finite number; or E0925 at its place, `what` naming it.
    pub(super) fn number(self, what: &str, diagnostics: &mut Diagnostics) -> Option<f64> {
        self.number_or(what, "write a number such as `-0.5` or `1e-3`, with a point", diagnostics)
    }

    /// The same, with what to write in place of a text that is nothing like a number.
    pub(super) fn number_or(self, what: &str, instead: &str, diagnostics: &mut Diagnostics) -> Option<f64> {
        match parse_number(self.text) {
            Ok(number) => Some(number),
            Err(error) => {
                let message = format!("{what} must be a finite number, found `{}`", shown(self.text));
                let help = self.help(error).unwrap_or_else(|| instead.to_owned());
                diagnostics.push(Diagnostic::error("E0925", self.span, message).help(help));
                None
            }
        }
    }

    /// What to write in place of a number with a comma, another minus sign or a unit.
    fn help(self, error: QuantityError) -> Option<String> {
        if parse_quantity(self.text).is_ok() {
            return Some(
                "write the number alone, and its unit behind the name of the column, as in `deviation [um]`"
                    .to_owned(),
            );
        }
        if let Some(help) = cells::thousands(self.text.trim()) {
            return Some(help);
        }
        let written = error.code == "E0303" || self.text.trim().starts_with(['\u{2212}', '\u{2013}']);
        error.help.filter(|_| written)
    }

    /// Its whole number from 1; or E0926 at its place, `what` naming it.
    pub(super) fn ordinal(self, what: &str, diagnostics: &mut Diagnostics) -> Option<u32> {
        // Tables that passed through floating point have `1.0`.
        let whole = self.text.strip_suffix(".0").unwrap_or(self.text);
        let number = whole.parse::<u32>().ok().filter(|number| *number >= 1);
        if number.is_none() {
            let message = format!("{what} must be a whole number from 1, found `{}`", shown(self.text));
            let mistake = Diagnostic::error("E0926", self.span, message);
            diagnostics.push(mistake.help("number runs and targets 1, 2, 3"));
        }
        number
    }
}

/// The lines of a text without their ends.
pub(super) fn lines(text: &str) -> impl Iterator<Item = Piece<'_>> {
    let start = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    let whole = Piece::new(text.get(start..).unwrap_or_default(), start);
    whole
        .split('\n')
        .map(|line| Piece::new(line.text.strip_suffix('\r').unwrap_or(line.text), line.span.start))
}

/// The user's text for a message: printable and short.
pub(super) fn shown(text: &str) -> String {
    const MOST: usize = 40;
    let mut shown: String = text.trim().chars().take(MOST).flat_map(char::escape_debug).collect();
    if text.trim().chars().nth(MOST).is_some() {
        shown.push('\u{2026}');
    }
    shown
}
