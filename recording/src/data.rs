//! The data of a recording: a table with a header row.
//!
//! In: a [`Header`] and a file (or any stream). Out: a [`Recording`]; or the first thing that is wrong, with its line
//! and column. One pass; what is kept are the numbers of the channels, 8 bytes each.

mod cell;
mod clock;
mod columns;
mod contained;
mod error;
mod foreign;
mod layout;
mod lines;
mod numbers;
mod pages;
mod parquet;
mod separator;
mod settle;
mod stamp;
mod wide;
mod workbook;
mod worksheet;

pub use error::{DataError, Place};
pub use foreign::foreign;

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read, Seek};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use super::{Header, Recording};
use columns::Columns;
use contained::contained;
use layout::Layout;
use lines::Lines;

/// The most numbers that a recording may hold: 2 GiB of them.
const MOST_NUMBERS: usize = 1 << 28;

/// Bytes that are read at once.
const BUFFER: usize = 1 << 18;

/// What is asked of a file to know its format: none begins with more.
const MOST_BEGINNING: u64 = 256;

/// What Parquet begins with.
const PARQUET: &[u8] = b"PAR1";

/// What a workbook begins with, and all other packed folders.
const ZIP: &[u8] = b"PK\x03\x04";

/// The names of the columns of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnNames {
    /// The names.
    pub names: Vec<String>,
    /// The row of a sheet in which they stand, counted from 1, where it is not the first that is no comment.
    pub line: Option<u64>,
    /// The unit of each column, empty where it has none, where the table has a row of units.
    pub units: Vec<String>,
    /// Whether each column holds dates.
    pub dates: Vec<bool>,
}

/// Whether a text is a date with a time of day, as the channel `time` has it where its unit is `date`.
pub fn is_date(text: &str) -> bool {
    stamp::Stamp::date(text).is_ok()
}

/// The names of the columns of a table that says itself which they are: Parquet, or the first sheet of a workbook. Nothing of a text.
///
/// # Errors
///
/// A file that cannot be read, and one of a format that is not read.
pub fn column_names(path: &Path) -> Result<Option<ColumnNames>, DataError> {
    let name = path.display().to_string();
    let unreadable = |error: std::io::Error| DataError::new(&name, format!("it cannot be read: {error}"));
    let mut file = File::open(path).map_err(unreadable)?;
    let mut start = Vec::new();
    file.by_ref().take(MOST_BEGINNING).read_to_end(&mut start).map_err(unreadable)?;
    if let Some((what, help)) = foreign(&start) {
        return Err(DataError::new(&name, format!("it is {what}, which Abbe does not read")).help(help));
    }
    if !start.starts_with(PARQUET) && !start.starts_with(ZIP) {
        return Ok(None);
    }
    file.rewind().map_err(unreadable)?;
    let names = contained(&name, || match start.starts_with(PARQUET) {
        true => parquet::names(&name, &file),
        false => workbook::names(&name, BufReader::with_capacity(BUFFER, &file)),
    });
    names.map(Some)
}

impl Header {
    /// Reads the data from a file: CSV, CSV packed by gzip, Parquet or a workbook (`.xlsx`), told by its first bytes.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong with the file or in it.
    pub fn read_data(&self, path: &Path) -> Result<Recording, DataError> {
        let name = path.display().to_string();
        let unreadable = |error: std::io::Error| DataError::new(&name, format!("it cannot be read: {error}"));
        if path.is_dir() {
            return Err(DataError::new(&name, "it is a folder, not a data file"));
        }
        let mut file = File::open(path).map_err(unreadable)?;
        // What is no file of its own, a pipe, can be read once: it is CSV.
        if file.rewind().is_err() {
            return self.read_csv(&name, file);
        }
        let mut start = Vec::new();
        file.by_ref().take(4).read_to_end(&mut start).map_err(unreadable)?;
        file.rewind().map_err(unreadable)?;
        match start.as_slice() {
            PARQUET => contained(&name, || self.read_parquet(&name, file)),
            ZIP => contained(&name, || self.read_workbook(&name, BufReader::with_capacity(BUFFER, file))),
            _ => self.read_csv(&name, file),
        }
    }

    /// Reads the data from the bytes of a file, as [`Header::read_data`] does; `name` is its name for people.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong in it.
    pub fn read_bytes(&self, name: &str, bytes: Vec<u8>) -> Result<Recording, DataError> {
        match bytes.get(..4) {
            Some(PARQUET) => contained(name, || self.read_parquet(name, bytes::Bytes::from(bytes))),
            Some(ZIP) => contained(name, || self.read_workbook(name, Cursor::new(bytes))),
            _ => self.read_csv(name, bytes.as_slice()),
        }
    }

    /// Reads the data from a stream of CSV, packed by gzip or not; `name` is its name for people.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong in it.
    pub fn read_csv(&self, name: &str, input: impl Read) -> Result<Recording, DataError> {
        let mut input = BufReader::with_capacity(BUFFER, input);
        let start = input.fill_buf().map_err(|error| DataError::unreadable(name, None, &error))?;
        if start.starts_with(&[0x1f, 0x8b]) {
            let unpacked = BufReader::with_capacity(BUFFER, MultiGzDecoder::new(input));
            return self.read_lines(name, unpacked, MOST_NUMBERS);
        }
        if start.starts_with(PARQUET) || start.starts_with(ZIP) {
            let error = DataError::new(
                name,
                "it is a Parquet file or a workbook, which cannot be read from a stream",
            );
            return Err(error.help("give the name of the file"));
        }
        if let Some((what, help)) = foreign(start) {
            return Err(DataError::new(name, format!("it is {what}, which Abbe does not read")).help(help));
        }
        self.read_lines(name, input, MOST_NUMBERS)
    }

    /// `most`: how many numbers may come.
    fn read_lines(&self, name: &str, text: impl BufRead, most: usize) -> Result<Recording, DataError> {
        if self.form.sheet.is_some() {
            let error = DataError::new(name, "it is not a workbook, but the recording file names a sheet");
            let error = error.in_recording(self.form.unsuited("sheet"));
            return Err(error.help("remove `sheet` from the recording file"));
        }
        let mut lines = Lines::new(name, text, self.form.decimal_comma);
        let layout = Layout::read(self, &mut lines)?;
        let mut columns = Columns::new(self, &layout.columns, layout.width, name, most);
        while let Some(line) = lines.next_row(layout.separator, layout.names.len())? {
            columns.take(&line)?;
        }
        settle::settle(self, columns.finish()?, name, layout.notes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_header;
    use model_dsl::diagnostic::Diagnostics;
    use model_dsl::source::SourceFile;
    use model_dsl::{compile_word, yaml};

    #[test]
    fn a_table_that_is_too_large_is_refused_while_it_is_read() {
        let text = "{recording: 1, machine: FX, instrument: position, data: d.csv,
            channels: {time: {column: t, unit: s}, measured.x: {column: x, unit: mm}}}";
        let mut diagnostics = Diagnostics::new();
        let root = yaml::read(&SourceFile::new("r.yaml", text), &mut diagnostics).unwrap();
        let stage = compile_word("FX", &mut diagnostics).unwrap();
        let header = read_header(&root, &stage.equations, &mut diagnostics).unwrap();
        let data = "t,x\n0,1\n1,2\n2,3\n";
        // A row is its time, its run and one channel.
        assert_eq!(header.read_lines("d.csv", data.as_bytes(), 9).unwrap().time.len(), 3);
        let error = header.read_lines("d.csv", data.as_bytes(), 8).unwrap_err();
        assert_eq!(error.place, Some(Place::Character { line: 4, column: 1 }));
        assert!(error.message.contains("more than 8 numbers"));
    }
}
