//! A text in lines, a line in cells, each with its exact place.
//!
//! In: bytes. Out: rows of cells that borrow the line; comments (`#`) and empty lines are passed over and counted. Cells
//! may stand in quotes, in which a separator is no separator; a line break inside quotes is not taken. (The records of a
//! CSV library do not know where their cells stand, and a message is to show the very characters.)

use std::io::{BufRead, Read};

use super::super::cells::{self, counted, split, split_units, unquoted};
use super::cell::{self, BadCell};
use super::columns::{Cells, Width};
use super::error::{DataError, Place, shown};
use super::stamp::Stamp;

/// Longer lines are refused: no row of numbers has them.
const LONGEST_LINE: usize = 1 << 20;

/// The lines of a text.
pub(super) struct Lines<'n, R> {
    name: &'n str,
    reader: R,
    buffer: Vec<u8>,
    number: u64,
    cells: Vec<(usize, usize)>,
    /// A line that was looked at and is to come again.
    again: bool,
    /// The last line above the first row that may be a row of units, and its number.
    above: Option<(Vec<u8>, u64)>,
    decimal_comma: bool,
}

/// One row: a line and where its cells stand in it.
pub(super) struct Row<'l> {
    name: &'l str,
    line: &'l [u8],
    cells: &'l [(usize, usize)],
    number: u64,
    decimal_comma: bool,
}

impl<'n, R: BufRead> Lines<'n, R> {
    pub(super) fn new(name: &'n str, reader: R, decimal_comma: bool) -> Self {
        Self {
            name,
            reader,
            buffer: Vec::new(),
            number: 0,
            cells: Vec::new(),
            again: false,
            above: None,
            decimal_comma,
        }
    }

    /// Passes over lines up to one that is to come next; false where the text ends before it.
    pub(super) fn skip_to(&mut self, number: u64) -> Result<bool, DataError> {
        while self.number + 1 < number {
            if !self.read_line()? {
                return Ok(false);
            }
            self.keep_units();
        }
        Ok(true)
    }

    /// The file's name.
    pub(super) fn name(&self) -> &'n str {
        self.name
    }

    /// The next line that is not empty, without its end; its number is [`Lines::number`].
    pub(super) fn next_line(&mut self) -> Result<Option<&[u8]>, DataError> {
        if std::mem::take(&mut self.again) {
            return Ok(Some(&self.buffer));
        }
        while self.read_line()? {
            if !self.buffer.trim_ascii().is_empty() {
                return Ok(Some(&self.buffer));
            }
        }
        Ok(None)
    }

    /// The number of the last line, from 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Where a cell stands in the line that was read last, which is given.
    pub(super) fn place(&self, line: &[u8], separator: u8, cell: usize) -> Place {
        let mut cells = Vec::new();
        split(line, separator, &mut cells);
        let (name, number, decimal_comma) = (self.name, self.number, self.decimal_comma);
        Row { name, line, cells: &cells, number, decimal_comma }.place(cell)
    }

    /// Lets the last line come again.
    pub(super) fn put_back(&mut self) {
        self.again = true;
    }

    /// Keeps the last line where it may be a row of units, above the first row.
    pub(super) fn keep_units(&mut self) {
        if cells::may_be_units(&self.buffer) {
            self.above = Some((self.buffer.clone(), self.number));
        }
    }

    /// The row of units above the first row of a table with this number of columns.
    pub(super) fn units_above(&mut self, separator: u8, columns: usize) -> Option<Row<'_>> {
        let (line, number) = self.above.as_ref()?;
        let found = split_units(line, separator, columns, &mut self.cells);
        let (name, cells, decimal_comma) = (self.name, &self.cells, self.decimal_comma);
        found.then_some(Row { name, line, cells, number: *number, decimal_comma })
    }

    /// The next line that is neither empty nor a comment, in cells. A row of units is a mistake there: what stands above it was read
    /// without it.
    pub(super) fn next_row(&mut self, separator: u8, columns: usize) -> Result<Option<Row<'_>>, DataError> {
        loop {
            match self.next_line()? {
                None => return Ok(None),
                Some(line) if line.first() != Some(&b'#') => break,
                Some(line) if cells::is_row_of_units(line, separator, columns) => {
                    return Err(self.late_units());
                }
                Some(_) => {}
            }
        }
        split(&self.buffer, separator, &mut self.cells);
        Ok(Some(self.row()))
    }

    /// The row of units, where the next line that is not empty is one, comments aside.
    pub(super) fn next_units(&mut self, separator: u8, columns: usize) -> Result<Option<Row<'_>>, DataError> {
        loop {
            match self.next_line()? {
                None => return Ok(None),
                Some(line) if cells::is_row_of_units(line, separator, columns) => break,
                Some(line) if line.first() == Some(&b'#') => {}
                Some(_) => {
                    self.put_back();
                    return Ok(None);
                }
            }
        }
        Ok(split_units(&self.buffer, separator, columns, &mut self.cells).then(|| self.row()))
    }

    /// The line that was read last, in the cells that were found in it.
    fn row(&self) -> Row<'_> {
        Row {
            name: self.name,
            line: &self.buffer,
            cells: &self.cells,
            number: self.number,
            decimal_comma: self.decimal_comma,
        }
    }

    fn late_units(&self) -> DataError {
        let error = DataError::new(self.name, "a row of units stands below rows of numbers");
        let help = "write it directly below the names of the columns, once, or remove it";
        error.at(Place::Character { line: self.number, column: 1 }).help(help)
    }

    /// Reads one line into the buffer; false at the end of the text.
    fn read_line(&mut self) -> Result<bool, DataError> {
        self.buffer.clear();
        let most = u64::try_from(LONGEST_LINE).unwrap_or(u64::MAX);
        let read = self.reader.by_ref().take(most).read_until(b'\n', &mut self.buffer);
        let length = read.map_err(|error| DataError::unreadable(self.name, Some(self.number), &error))?;
        if length == 0 {
            return Ok(false);
        }
        self.number += 1;
        if length == LONGEST_LINE {
            let error = DataError::new(self.name, "the line is longer than 1 MiB");
            let help = "write a header row, then one row of numbers per line";
            return Err(error.at(Place::Character { line: self.number, column: 1 }).help(help));
        }
        for end in *b"\n\r" {
            if self.buffer.last() == Some(&end) {
                self.buffer.pop();
            }
        }
        if self.number == 1 && self.buffer.starts_with(b"\xef\xbb\xbf") {
            self.buffer.drain(..3);
        }
        Ok(true)
    }
}

impl<'l> Row<'l> {
    /// A cell without white space and quotes around it; empty where the row has none.
    pub(super) fn cell(&self, index: usize) -> &'l [u8] {
        let cell = self.cells.get(index).and_then(|&(start, end)| self.line.get(start..end));
        unquoted(cell.unwrap_or_default())
    }

    /// How many cells it has.
    pub(super) fn width(&self) -> usize {
        self.cells.len()
    }

    /// Where a cell's text begins; the end of the line for a cell that is not there.
    fn place(&self, index: usize) -> Place {
        let (start, end) = self.cells.get(index).copied().unwrap_or((self.line.len(), self.line.len()));
        let cell = self.line.get(start..end).unwrap_or_default();
        let blank = cell.len() - cell.trim_ascii_start().len();
        let before = self.line.get(..start + if blank < cell.len() { blank } else { 0 }).unwrap_or_default();
        let characters = String::from_utf8_lossy(before).chars().count();
        Place::Character {
            line: self.number,
            column: u64::try_from(characters).unwrap_or(u64::MAX).saturating_add(1),
        }
    }
}

impl Cells for Row<'_> {
    fn ragged(&self, width: Width) -> Option<DataError> {
        let found = self.width();
        let width = match width {
            Width::Exactly(width) | Width::AtLeast(width) if found == width => return None,
            Width::AtLeast(width) if found > width => return None,
            Width::AtLeast(width) => {
                let message = format!(
                    "the row has {}, but {width} are needed: `{}`",
                    counted(found, "cell"),
                    shown(self.line)
                );
                let help = "give each row all columns that the recording file names";
                return Some(self.error(found, message).help(help));
            }
            Width::Exactly(width) => width,
        };
        let message = format!(
            "the row has {}, but the header has {width}: `{}`",
            counted(found, "cell"),
            shown(self.line)
        );
        let commas = found > width && self.line.contains(&b',') && !self.decimal_comma;
        let error = self.error(found.min(width), message);
        Some(error.help(match commas {
            // With a comma in most numbers there are nearly two cells for each.
            true if found > width + width / 2 => {
                "if the numbers have decimal commas, write points and separate the numbers with commas, or separate the columns with semicolons and write `decimal: \",\"` in the recording file"
            }
            true => "write one cell for each column, empty if nothing was measured; a decimal comma splits a number into two cells",
            false => "write one cell for each column, empty if nothing was measured",
        }))
    }

    fn number(&self, index: usize) -> Result<f64, BadCell> {
        cell::number(self.cell(index), self.decimal_comma)
    }

    fn stamp(&self, index: usize) -> Result<Stamp, BadCell> {
        cell::stamp(self.cell(index), self.decimal_comma)
    }

    fn date(&self, indices: &[usize]) -> Result<Stamp, BadCell> {
        let cells: Vec<&[u8]> = indices.iter().map(|index| self.cell(*index)).collect();
        cell::date(&cells)
    }

    fn run(&self, index: usize) -> Result<i64, BadCell> {
        cell::run(self.cell(index))
    }

    fn text(&self, index: usize) -> String {
        shown(self.cell(index))
    }

    fn error(&self, index: usize, message: String) -> DataError {
        DataError::new(self.name, message).at(self.place(index))
    }
}
