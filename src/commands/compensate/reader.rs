//! Rows of standard input. In: its bytes. Out: the header, the row of units and the rows below, each with its line; comments are passed over.

use std::cell::RefCell;
use std::rc::Rc;

use csv::ByteRecord;
use recording::cells::{BELOW_THE_NAMES, split_units, told_separator, unquoted};
use workshop::failure::Failure;

use super::CAPACITY;
use super::answering::Answering;
use super::input::{Chunks, Input};
use super::separator::Separator;
use crate::positions::Wanted;

/// The rows of standard input.
pub(super) struct Reader<'s, 'c> {
    rows: csv::Reader<Input<'s, 'c>>,
    answering: Rc<RefCell<Answering<'s, 'c>>>,
    separator: Separator,
    /// Whether the reader of rows counts a line when it ends, not when the next one begins.
    ends_are_counted: bool,
    /// Whether the first line tells the separator and is no row.
    told: bool,
}

/// Which rows are comments.
pub(super) struct Comments {
    /// How many cells a row has.
    pub(super) width: usize,
    /// Whether numbers stand in the first column.
    numbers_first: bool,
}

impl<'s, 'c> Reader<'s, 'c> {
    pub(super) fn new(
        chunks: Chunks,
        answering: &Rc<RefCell<Answering<'s, 'c>>>,
        separator: Separator,
    ) -> Self {
        let first = chunks.rest().split(|byte| *byte == b'\n').next().unwrap_or_default();
        let (told, ends_are_counted) = (told_separator(first).is_some(), !first.ends_with(b"\r"));
        let input = Input::new(chunks, Rc::clone(answering));
        let mut builder = csv::ReaderBuilder::new();
        builder.has_headers(false).flexible(true).delimiter(separator.byte()).buffer_capacity(CAPACITY);
        let rows = builder.from_reader(input);
        Self { rows, answering: Rc::clone(answering), separator, ends_are_counted, told }
    }

    /// Reads the header, which comments may stand above.
    pub(super) fn header(&mut self) -> Result<ByteRecord, Failure> {
        let mut header = ByteRecord::new();
        if std::mem::take(&mut self.told) {
            self.next(&mut header)?;
        }
        let mut units = None;
        while let Some(line) = self.next(&mut header)? {
            let width = header.len().saturating_sub(1);
            units = self.units_of(&header, width).map(|_| line).or(units);
            // `#` alone may be the name of a column of numbers.
            let alone = header.get(0).is_some_and(|cell| cell.trim_ascii() == b"#");
            if units != Some(line) && (alone || !is_marked(&header)) {
                return match units {
                    Some(line) => Err(units_above(line)),
                    None => Ok(header),
                };
            }
        }
        Err(Failure::no(
            "error: standard input is empty; it must begin with a header such as `x,y,z`".to_owned(),
        ))
    }

    /// Reads the row of units, where there is one; else the first row below the header and its line.
    #[expect(clippy::type_complexity, reason = "one of the two, which are taken apart at once")]
    pub(super) fn units(
        &mut self,
        columns: usize,
        comments: &Comments,
    ) -> Result<(Option<Vec<String>>, Option<(ByteRecord, u64)>), Failure> {
        let mut row = ByteRecord::new();
        while let Some(line) = self.next(&mut row)? {
            if let Some(units) = self.units_of(&row, columns) {
                return Ok((Some(units), None));
            }
            if !comments.is_one(&row) {
                return Ok((None, Some((row, line))));
            }
        }
        Ok((None, None))
    }

    /// The units, if the row is the row of units of a table with this number of columns.
    pub(super) fn units_of(&self, row: &ByteRecord, columns: usize) -> Option<Vec<String>> {
        if !is_marked(row) {
            return None;
        }
        let cells: Vec<&[u8]> = row.iter().collect();
        let line = cells.join(&self.separator.byte());
        let mut places = Vec::new();
        if !split_units(&line, self.separator.byte(), columns, &mut places) {
            return None;
        }
        let units = places.into_iter().skip(1).filter_map(|(start, end)| line.get(start..end));
        Some(units.map(|unit| String::from_utf8_lossy(unquoted(unit)).into_owned()).collect())
    }

    /// Reads the next row and tells the line in which it begins; nothing at the end.
    pub(super) fn next(&mut self, row: &mut ByteRecord) -> Result<Option<u64>, Failure> {
        self.answering.borrow_mut().begun = self.rows.position().byte();
        let read = self.rows.read_byte_record(row).map_err(|error| {
            match (self.answering.borrow_mut().failure.take(), error.into_kind()) {
                (Some(failure), _) => failure,
                (None, csv::ErrorKind::Io(error)) => Failure::io("cannot read standard input", &error),
                (None, other) => Failure::no(format!("error: cannot read standard input: {other:?}")),
            }
        })?;
        Ok(read.then(|| self.line(row)))
    }

    /// The line in which the row begins that was read last.
    fn line(&self, row: &ByteRecord) -> u64 {
        let position = self.rows.position();
        let within = row.as_slice().iter().filter(|byte| **byte == b'\n').count();
        let ended = self.ends_are_counted && !self.rows.get_ref().broke_off(row, position.byte());
        position
            .line()
            .saturating_sub(u64::try_from(within).unwrap_or(u64::MAX))
            .saturating_sub(u64::from(ended))
    }
}

impl Comments {
    /// The comments below a header.
    pub(super) fn new(header: &ByteRecord, wanted: &Wanted<'_>) -> Self {
        let first = header.get(0).unwrap_or_default();
        Self { width: header.len(), numbers_first: wanted.reads_number(first) }
    }

    /// Whether a row is a comment: `# text`. Where words stand in the first column, a row of that many cells is none: `#1` may be a name.
    pub(super) fn is_one(&self, row: &ByteRecord) -> bool {
        is_marked(row) && (self.numbers_first || row.len() != self.width)
    }
}

/// A row of units that stands above the names.
fn units_above(line: u64) -> Failure {
    Failure::wrong(format!(
        "error: standard input, line {line}: the row of units stands above the names of the columns\nhelp: {BELOW_THE_NAMES}"
    ))
}

/// Whether a row begins with `#`, and is one line: an open quote in a comment must not hide rows.
fn is_marked(row: &ByteRecord) -> bool {
    row.get(0).is_some_and(|cell| cell.trim_ascii_start().starts_with(b"#"))
        && !row.as_slice().contains(&b'\n')
}
