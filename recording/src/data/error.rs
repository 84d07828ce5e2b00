//! What is wrong with the data: a sentence, a place and what to write instead.

use std::fmt;

use model_dsl::source::Span;

/// Why a table of data cannot be used.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DataError {
    /// The file's name.
    pub file: String,
    /// Where in the file, where it is a matter of one place.
    pub place: Option<Place>,
    /// What is wrong, in one sentence without a full stop.
    pub message: String,
    /// What to write instead.
    pub help: Option<String>,
    /// Where the recording file is wrong, where it is not the table: the code of the finding and its place there.
    pub recording: Option<Box<(&'static str, Span)>>,
}

/// A place in a table of data, counted from 1.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Place {
    /// A line of a text and a character in it.
    Character {
        /// The line; the header row is counted, and so are comments and empty lines.
        line: u64,
        /// The character in the line.
        column: u64,
    },
    /// A row of a table that has no lines.
    Row(u64),
    /// A cell of a sheet.
    Cell {
        /// The row.
        row: u64,
        /// The column: 1 is A.
        column: u64,
    },
}

impl DataError {
    pub(super) fn new(file: &str, message: impl Into<String>) -> Self {
        Self { file: file.to_owned(), place: None, message: message.into(), help: None, recording: None }
    }

    pub(super) fn unreadable(file: &str, line: Option<u64>, error: &std::io::Error) -> Self {
        match line {
            None => Self::new(file, format!("it cannot be read: {error}")),
            Some(line) => Self::new(file, format!("it cannot be read after line {line}: {error}")),
        }
    }

    #[must_use]
    pub(super) fn at(mut self, place: Place) -> Self {
        self.place = Some(place);
        self
    }

    /// The same as a mistake in the recording file, where a place there is known.
    #[must_use]
    pub(super) fn in_recording(mut self, place: Option<(&'static str, Span)>) -> Self {
        self.recording = place.map(Box::new);
        self
    }

    #[must_use]
    pub(super) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

impl fmt::Display for DataError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}", self.file)?;
        match self.place {
            Some(Place::Character { line, column }) => write!(f, ":{line}:{column}")?,
            Some(Place::Row(row)) => write!(f, ", row {row}")?,
            Some(Place::Cell { row, column }) => write!(f, ", cell {}{row}", letters(column))?,
            None => {}
        }
        write!(f, ": {}", self.message)?;
        match &self.help {
            Some(help) => write!(f, "\nhelp: {help}"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for DataError {}

/// The letters of a column of a sheet: A, Z, AA.
fn letters(column: u64) -> String {
    let mut letters = Vec::new();
    let mut left = column;
    while let Some(before) = left.checked_sub(1) {
        let digit = u8::try_from(before % 26).unwrap_or_default();
        letters.push(char::from(b'A' + digit));
        left = before / 26;
    }
    letters.iter().rev().collect()
}

/// The user's text for a message: printable and short.
pub(super) fn shown(bytes: &[u8]) -> String {
    const MOST: usize = 40;
    let head = bytes.get(..4 * MOST).unwrap_or(bytes);
    let text = String::from_utf8_lossy(head);
    let mut shown: String = text.trim().chars().take(MOST).flat_map(char::escape_debug).collect();
    if text.trim().chars().nth(MOST).is_some() || head.len() < bytes.len() {
        shown.push('\u{2026}');
    }
    shown
}
