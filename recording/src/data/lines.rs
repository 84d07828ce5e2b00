//! A text in lines, a line in cells, each with its exact place.
//!
//! In: bytes. Out: rows of cells that borrow the line; comments (`#`) and empty lines are passed over and counted. Cells
//! may stand in quotes, in which a separator is no separator; a line break inside quotes is not taken. (The records of a
//! CSV library do not know where their cells stand, and a message is to show the very characters.)

use std::io::{BufRead, Read};

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
        Self { name, reader, buffer: Vec::new(), number: 0, cells: Vec::new(), again: false, decimal_comma }
    }

    /// Passes over lines up to one that is to come next; false where the text ends before it.
    pub(super) fn skip_to(&mut self, number: u64) -> Result<bool, DataError> {
        while self.number + 1 < number {
            if !self.read_line()? {
                return Ok(false);
            }
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

    /// Lets the last line come again.
    pub(super) fn put_back(&mut self) {
        self.again = true;
    }

    /// The next line that is neither empty nor a comment, in cells.
    pub(super) fn next_row(&mut self, separator: u8) -> Result<Option<Row<'_>>, DataError> {
        loop {
            match self.next_line()? {
                None => return Ok(None),
                Some(line) if line.first() == Some(&b'#') => {}
                Some(_) => break,
            }
        }
        self.put_back();
        self.next_cells(separator)
    }

    /// The next line in cells, whatever it begins with.
    pub(super) fn next_cells(&mut self, separator: u8) -> Result<Option<Row<'_>>, DataError> {
        if self.next_line()?.is_none() {
            return Ok(None);
        }
        split(&self.buffer, separator, &mut self.cells);
        Ok(Some(Row {
            name: self.name,
            line: &self.buffer,
            cells: &self.cells,
            number: self.number,
            decimal_comma: self.decimal_comma,
        }))
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

/// Finds the cells of a line; a space as the separator stands for any number of spaces and tabs.
pub(super) fn split(line: &[u8], separator: u8, cells: &mut Vec<(usize, usize)>) {
    cells.clear();
    if separator == SPACES {
        return split_at_spaces(line, cells);
    }
    let mut start = 0;
    let mut quoted = false;
    for (at, &byte) in line.iter().enumerate() {
        if byte == b'"' {
            quoted = !quoted;
        } else if byte == separator && !quoted {
            cells.push((start, at));
            start = at + 1;
        }
    }
    cells.push((start, line.len()));
}

/// The separator that stands for any number of spaces and tabs.
pub(super) const SPACES: u8 = b' ';

fn split_at_spaces(line: &[u8], cells: &mut Vec<(usize, usize)>) {
    let mut start = None;
    let mut quoted = false;
    for (at, byte) in line.iter().enumerate() {
        quoted ^= *byte == b'"';
        match start {
            Some(begun) if byte.is_ascii_whitespace() && !quoted => {
                cells.push((begun, at));
                start = None;
            }
            None if !byte.is_ascii_whitespace() => start = Some(at),
            _ => {}
        }
    }
    cells.extend(start.map(|begun| (begun, line.len())));
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
                let message =
                    format!("the row has {found} cells, but {width} are needed: `{}`", shown(self.line));
                let help = "give each row all columns that the recording file names";
                return Some(self.error(found, message).help(help));
            }
            Width::Exactly(width) => width,
        };
        let message =
            format!("the row has {found} cells, but the header has {width}: `{}`", shown(self.line));
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

/// A cell without white space and quotes around it.
pub(super) fn unquoted(cell: &[u8]) -> &[u8] {
    let cell = cell.trim_ascii();
    let inner = cell.strip_prefix(b"\"").and_then(|rest| rest.strip_suffix(b"\""));
    inner.map_or(cell, <[u8]>::trim_ascii)
}
