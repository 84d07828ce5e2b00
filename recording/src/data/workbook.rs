//! Workbooks (`.xlsx`): a packed folder, in which the sheets are.
//!
//! In: the file. Out: a [`Recording`] from one of its sheets; or what is wrong. What it holds unpacked is counted before
//! any of it is kept, so that a small file cannot become a large one in memory.

use std::io::{self, Read, Seek};

use calamine::{Reader, Xlsx, XlsxError};
use zip::ZipArchive;

use super::super::{Header, Recording};
use super::columns::{Cells, Columns, Width};
use super::error::DataError;
use super::layout::{ONE_UNIT, find_columns, notes_of_extra, same_units};
use super::worksheet::Rows;
use super::{ColumnNames, MOST_NUMBERS, settle};

/// What a workbook may hold unpacked: a sheet with all rows that there can be, 2^20, and some ten columns.
const LARGEST: u64 = 1 << 28;

/// The names of the columns of the first sheet.
pub(super) fn names(name: &str, mut file: impl Read + Seek) -> Result<ColumnNames, DataError> {
    check_size(name, &mut file)?;
    let mut book = Xlsx::new(&mut file).map_err(|error| broken(name, &error))?;
    let sheets = book.sheet_names();
    let sheet = sheets.first().ok_or_else(|| DataError::new(name, "it has no sheet"))?;
    let cells = book.worksheet_cells_reader(sheet).map_err(|error| broken(name, &error))?;
    Rows::new(name, cells, false).names_above_numbers()
}

fn broken(name: &str, error: &XlsxError) -> DataError {
    DataError::new(name, format!("it cannot be read: {error}")).help("save the table as `.xlsx` or as CSV")
}

impl Header {
    /// Reads the data from the first sheet of a workbook, or from the one that the recording file names.
    pub(super) fn read_workbook(
        &self,
        name: &str,
        mut file: impl Read + Seek,
    ) -> Result<Recording, DataError> {
        if self.form.separator.is_some() {
            let error = DataError::new(name, "it is a workbook, for which `separator` has no meaning");
            let error = error.in_recording(self.form.unsuited("separator"));
            return Err(error.help("remove `separator` from the recording file"));
        }
        check_size(name, &mut file)?;
        let broken = |error: XlsxError| broken(name, &error);
        let mut book = Xlsx::new(&mut file).map_err(broken)?;
        let sheet = self.sheet_of(name, &book.sheet_names())?;
        let cells = book.worksheet_cells_reader(&sheet).map_err(broken)?;
        let mut rows = Rows::new(name, cells, self.form.decimal_comma);
        let names = rows.names(&self.form)?;
        let columns = find_columns(self, &names).map_err(|misfit| {
            let place = misfit.column.and_then(|column| rows.place(column));
            let message = format!("sheet `{sheet}`: {}", misfit.message);
            DataError { message, place, ..misfit.of_file(name) }
        })?;
        if let Some(units) = rows.units()? {
            same_units(self, (&names, &columns), |cell| units.text(cell))
                .map_err(|(cell, message)| units.error(cell, message).help(ONE_UNIT))?;
        }
        let notes = notes_of_extra(self, name, &names);
        let mut table = Columns::new(self, &columns, Width::Exactly(names.len()), name, MOST_NUMBERS);
        while let Some(row) = rows.next_row()? {
            table.take(&row)?;
        }
        settle::settle(self, table.finish()?, name, notes)
    }

    fn sheet_of(&self, name: &str, sheets: &[String]) -> Result<String, DataError> {
        let wanted = self.form.sheet.as_ref();
        let found = wanted.map_or(sheets.first(), |wanted| sheets.iter().find(|sheet| *sheet == wanted));
        found.cloned().ok_or_else(|| {
            let error = match wanted {
                Some(wanted) => DataError::new(name, format!("there is no sheet `{wanted}`")),
                None => DataError::new(name, "it has no sheet"),
            };
            let error = error.in_recording(wanted.and_then(|_| self.form.unsuited("sheet")));
            error.help(format!("its sheets are {}", sheets.join(", ")))
        })
    }
}

/// Unpacks all of it once and keeps nothing: what stands in it of its own size need not be true.
fn check_size(name: &str, file: impl Read + Seek) -> Result<(), DataError> {
    let broken = |why: String| DataError::new(name, format!("it cannot be read: {why}"));
    let mut folder = ZipArchive::new(file).map_err(|error| broken(error.to_string()))?;
    let mut size = 0_u64;
    for number in 0..folder.len() {
        let packed = folder.by_index(number).map_err(|error| broken(error.to_string()))?;
        let left = LARGEST.saturating_sub(size);
        let read = io::copy(&mut packed.take(left.saturating_add(1)), &mut io::sink());
        size = size.saturating_add(read.map_err(|error| broken(error.to_string()))?);
        if size > LARGEST {
            let error = DataError::new(name, "it has more than 256 MiB when unpacked");
            return Err(error.help("save the table as CSV or Parquet"));
        }
    }
    Ok(())
}
