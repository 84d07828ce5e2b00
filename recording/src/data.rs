//! The data of a recording: a table with a header row.
//!
//! In: a [`Header`] and a file (or any stream). Out: a [`Recording`]; or the first thing that is wrong, with its line
//! and column. One pass; what is kept are the numbers of the channels, 8 bytes each.

mod cell;
mod clock;
mod columns;
mod error;
mod layout;
mod lines;
mod numbers;
#[cfg(feature = "parquet")]
mod parquet;
mod separator;
mod settle;

pub use error::{DataError, Place};

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use super::{Header, Recording};
use columns::Columns;
use layout::Layout;
use lines::Lines;

/// The most numbers that a recording may hold: 2 GiB of them.
const MOST_NUMBERS: usize = 1 << 28;

/// Bytes that are read at once.
const BUFFER: usize = 1 << 18;

impl Header {
    /// Reads the data from a file: CSV, CSV packed by gzip (told by its first bytes), or with the feature `parquet`
    /// also Parquet (told by the name).
    ///
    /// # Errors
    ///
    /// The first thing that is wrong with the file or in it.
    pub fn read_data(&self, path: &Path) -> Result<Recording, DataError> {
        let name = path.display().to_string();
        let unreadable = |error: std::io::Error| DataError::new(&name, format!("it cannot be read: {error}"));
        if path.is_dir() {
            return Err(DataError::new(&name, "it is a folder, not a file of data"));
        }
        let file = File::open(path).map_err(unreadable)?;
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("parquet")) {
            return self.read_parquet(&name, file);
        }
        self.read_csv(&name, file)
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
            return self.read_lines(Lines::new(name, unpacked), MOST_NUMBERS);
        }
        if start.starts_with(b"PAR1") {
            return Err(
                DataError::new(name, "it is a Parquet file").help("give it a name that ends in `.parquet`")
            );
        }
        self.read_lines(Lines::new(name, input), MOST_NUMBERS)
    }

    /// `most`: how many numbers may come.
    fn read_lines(&self, mut lines: Lines<'_, impl BufRead>, most: usize) -> Result<Recording, DataError> {
        let layout = Layout::read(self, &mut lines)?;
        let mut columns = Columns::new(self, &layout.columns, layout.names.len(), lines.name(), most);
        while let Some(line) = lines.next_row(layout.separator)? {
            columns.take(&line)?;
        }
        settle::settle(self, columns.finish()?, lines.name(), layout.notes)
    }

    #[cfg(not(feature = "parquet"))]
    fn read_parquet(&self, name: &str, _file: File) -> Result<Recording, DataError> {
        let error = DataError::new(name, "Parquet files are not read by this build");
        Err(error.help("build with the feature `parquet`, or save the table as `.csv` or `.csv.gz`"))
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
        assert_eq!(header.read_lines(Lines::new("d.csv", data.as_bytes()), 9).unwrap().time.len(), 3);
        let error = header.read_lines(Lines::new("d.csv", data.as_bytes()), 8).unwrap_err();
        assert_eq!(error.place, Some(Place::Character { line: 4, column: 1 }));
        assert!(error.message.contains("more than 8 numbers"));
    }
}
