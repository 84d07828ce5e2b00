//! A sheet of a workbook in rows. In: its cells, in the order of the file. Out: rows, each cell with its place.

use std::io::{Read, Seek};

use calamine::{DataRef, XlsxCellReader};

use super::super::cells::{BELOW_THE_NAMES, may_be_units};
use super::super::form::{Form, Names};
use super::ColumnNames;
use super::cell::{self, BadCell};
use super::columns::{Cells, Width};
use super::error::{DataError, Place, shown};
use super::stamp::Stamp;

/// No sheet has more columns.
const MOST_COLUMNS: usize = 1 << 14;

/// Names stand among the first rows.
const MOST_TITLES: usize = 100;

/// The days from the first one of a workbook to 1970. Workbooks that count from 1904 say so elsewhere: times count from the
/// first row, and the difference is in all of them.
const DAYS_TO_1970: f64 = 25_569.0;

/// The rows of a sheet.
pub(super) struct Rows<'n, 'b, R: Read + Seek> {
    name: &'n str,
    cells: XlsxCellReader<'b, R>,
    decimal_comma: bool,
    /// The first cell of the next row: row, column and what it holds.
    next: Option<(u32, u32, Value)>,
    /// A row that was looked at and is to come again.
    again: Option<Row<'n>>,
    /// The row in which the names of the columns stand, counted from 0.
    names_row: Option<u32>,
    /// Whether all cells were read: behind them there is nothing to ask for.
    ended: bool,
}

/// A row: its cells that hold something, by their columns, in ascending order.
pub(super) struct Row<'n> {
    name: &'n str,
    /// Counted from 0.
    row: u32,
    cells: Vec<(u32, Value)>,
    decimal_comma: bool,
}

/// What a cell holds.
enum Value {
    Number(f64),
    Text(String),
    Date(Stamp),
    /// What a formula came to that has no value: `#DIV/0!`.
    Error(String),
}

impl<'n, 'b, R: Read + Seek> Rows<'n, 'b, R> {
    pub(super) fn new(name: &'n str, cells: XlsxCellReader<'b, R>, decimal_comma: bool) -> Self {
        Self { name, cells, decimal_comma, next: None, again: None, names_row: None, ended: false }
    }

    /// The names of the columns, from the row in which they stand; or their numbers.
    pub(super) fn names(&mut self, form: &Form) -> Result<Vec<String>, DataError> {
        let name = self.name;
        let row = loop {
            let Some(row) = self.next_row()? else {
                return Err(DataError::new(name, "the sheet has no row of column names").help(
                    "begin with a row of column names, or name another `sheet` in the recording file",
                ));
            };
            match form.names {
                Names::Line(line) if u64::from(row.row) + 1 < line => {}
                Names::Line(line) if u64::from(row.row) + 1 > line => {
                    let error =
                        DataError::new(name, format!("row {line} should be the header row, but it is empty"));
                    return Err(error.help("count all rows, including empty ones"));
                }
                _ => break row,
            }
        };
        let width = row.cells.last().map_or(0, |(column, _)| column.saturating_add(1));
        if form.names == Names::Nowhere {
            self.again = Some(row);
            return Ok((1..=width).map(|number| number.to_string()).collect());
        }
        self.names_row = Some(row.row);
        Ok(row.names())
    }

    /// Where the name of a column stands.
    pub(super) fn place(&self, column: usize) -> Option<Place> {
        let column = u64::try_from(column).ok()?.saturating_add(1);
        self.names_row.map(|row| Place::Cell { row: u64::from(row) + 1, column })
    }

    /// The names of the columns, from the last row above the first one that has mostly numbers: above them stand titles, below them the
    /// row of units.
    pub(super) fn names_above_numbers(&mut self) -> Result<ColumnNames, DataError> {
        let mut above: Vec<Row<'n>> = Vec::new();
        let (mut units, mut numbers) = (None, None);
        while numbers.is_none()
            && above.len() < MOST_TITLES
            && let Some(row) = self.read_row()?
        {
            match &row {
                row if row.is_of_units() => units = Some(row.names().split_off(row.first_column() + 1)),
                row if row.is_comment() => {}
                row if row.is_of_numbers() => numbers = Some(row.dates()),
                _ => {
                    units = None;
                    above.push(row);
                }
            }
        }
        let first = above.first().map(|row| row.row);
        let Some((row, dates)) = above.pop().zip(numbers) else {
            let error = DataError::new(self.name, "the sheet has no row of column names above its numbers");
            return Err(error.help(
                "write the names above the first row of numbers, or write `data: {file: ..., header: 7}` in the recording file if they are in row 7",
            ));
        };
        let line = (first != Some(row.row)).then(|| u64::from(row.row) + 1);
        Ok(ColumnNames { names: row.names(), line, units: units.unwrap_or_default(), dates })
    }

    /// The row of units, `#unit` and a unit for each column, where the next row is one.
    pub(super) fn units(&mut self) -> Result<Option<Row<'n>>, DataError> {
        if self.again.is_some() {
            return Ok(None);
        }
        while let Some(row) = self.read_row()? {
            if row.is_of_units() {
                return Ok(Some(row));
            }
            if !row.is_comment() {
                self.again = Some(row);
                break;
            }
        }
        Ok(None)
    }

    /// The next row in which anything stands and that is no comment. A row of units is a mistake there: what stands above it was read
    /// without it.
    pub(super) fn next_row(&mut self) -> Result<Option<Row<'n>>, DataError> {
        if let Some(row) = self.again.take() {
            return Ok(Some(row));
        }
        while let Some(row) = self.read_row()? {
            if row.is_of_units() {
                let message = "the row of units does not stand below the names of the columns".to_owned();
                return Err(row.error(row.first_column(), message).help(BELOW_THE_NAMES));
            }
            if !row.is_comment() {
                return Ok(Some(row));
            }
        }
        Ok(None)
    }

    fn read_row(&mut self) -> Result<Option<Row<'n>>, DataError> {
        let first = match self.next.take() {
            Some(first) => Some(first),
            None => self.read_cell()?,
        };
        let Some((row, column, value)) = first else { return Ok(None) };
        let mut cells = vec![(column, value)];
        while let Some((next, column, value)) = self.read_cell()? {
            if next != row {
                self.next = Some((next, column, value));
                break;
            }
            cells.push((column, value));
            if cells.len() > MOST_COLUMNS {
                return Err(self.disordered(row));
            }
        }
        let ascending = cells.is_sorted_by(|(one, _), (next, _)| one < next);
        let later = self.next.as_ref().is_none_or(|(next, ..)| *next > row);
        if !ascending || !later {
            return Err(self.disordered(row));
        }
        Ok(Some(Row { name: self.name, row, cells, decimal_comma: self.decimal_comma }))
    }

    fn disordered(&self, row: u32) -> DataError {
        let error = DataError::new(self.name, "it cannot be read: its cells are out of order");
        error.at(Place::Row(u64::from(row) + 1))
    }

    /// The next cell that holds something: its row, its column and what it holds.
    fn read_cell(&mut self) -> Result<Option<(u32, u32, Value)>, DataError> {
        while !self.ended {
            let cell = self
                .cells
                .next_cell()
                .map_err(|error| DataError::new(self.name, format!("it cannot be read: {error}")))?;
            let Some(cell) = cell else {
                self.ended = true;
                break;
            };
            let (row, column) = cell.get_position();
            if let Some(value) = value_of(cell.get_value()) {
                return Ok(Some((row, column, value)));
            }
        }
        Ok(None)
    }
}

fn value_of(cell: &DataRef<'_>) -> Option<Value> {
    let text = |text: &str| (!text.trim().is_empty()).then(|| Value::Text(text.trim().to_owned()));
    match cell {
        DataRef::Int(value) => Some(Value::Number(*value as f64)),
        DataRef::Float(value) => Some(Value::Number(*value)),
        DataRef::Bool(value) => Some(Value::Number(f64::from(u8::from(*value)))),
        DataRef::String(value) | DataRef::DateTimeIso(value) | DataRef::DurationIso(value) => text(value),
        DataRef::SharedString(value) => text(value),
        DataRef::DateTime(date) => {
            // What lies within a day is a time of day, which is added to a date.
            let days = date.as_f64();
            let time_of_day = date.is_duration() || days.abs() < 1.0;
            Some(Value::Date(Stamp::days(if time_of_day { days } else { days - DAYS_TO_1970 })))
        }
        DataRef::Error(error) => Some(Value::Error(error.to_string())),
        DataRef::Empty => None,
    }
}

impl Value {
    fn text(&self) -> String {
        match self {
            Self::Number(value) => value.to_string(),
            Self::Text(text) | Self::Error(text) => text.clone(),
            Self::Date(stamp) => stamp.to_string(),
        }
    }
}

impl Row<'_> {
    /// Whether it begins with `#`; so do errors of a sheet (`#DIV/0!`), which are none.
    fn is_comment(&self) -> bool {
        let first = self.cells.first().filter(|(_, value)| !matches!(value, Value::Error(_)));
        first.is_some_and(|(_, value)| value.text().starts_with('#'))
    }

    /// Whether its first cell marks it as the row of units.
    fn is_of_units(&self) -> bool {
        // In a sheet each cell stands for itself, as if a comma stood behind it.
        let mark = |value: &Value| may_be_units(format!("{},", value.text()).as_bytes());
        self.is_comment() && self.cells.first().is_some_and(|(_, value)| mark(value))
    }

    /// The number of the first column in which anything stands.
    fn first_column(&self) -> usize {
        self.cells.first().and_then(|(column, _)| usize::try_from(*column).ok()).unwrap_or_default()
    }

    /// Whether most of its cells are numbers or dates.
    fn is_of_numbers(&self) -> bool {
        let number = |value: &Value| match value {
            Value::Number(_) | Value::Date(_) => true,
            Value::Text(text) => text.replace(',', ".").parse::<f64>().is_ok(),
            Value::Error(_) => false,
        };
        let numbers = self.cells.iter().filter(|(_, value)| number(value)).count();
        numbers > 0 && numbers.saturating_mul(2) >= self.cells.len() && self.cells.len() > 1
    }

    /// Which of its cells are dates, or texts that are.
    fn dates(&self) -> Vec<bool> {
        let width = self.cells.last().map_or(0, |(column, _)| column.saturating_add(1));
        let is_date = |value: &Value| match value {
            Value::Date(_) => true,
            Value::Text(text) => Stamp::date(text).is_ok(),
            Value::Number(_) | Value::Error(_) => false,
        };
        (0..width).map(|column| self.get(column).is_some_and(is_date)).collect()
    }

    /// Its texts, from the first column to the last in which anything stands.
    fn names(&self) -> Vec<String> {
        let width = self.cells.last().map_or(0, |(column, _)| column.saturating_add(1));
        (0..width).map(|column| self.get(column).map(Value::text).unwrap_or_default()).collect()
    }

    fn get(&self, column: u32) -> Option<&Value> {
        let found = self.cells.binary_search_by_key(&column, |(column, _)| *column).ok()?;
        self.cells.get(found).map(|(_, value)| value)
    }

    fn at(&self, index: usize) -> Option<&Value> {
        self.get(u32::try_from(index).ok()?)
    }
}

fn no_value(error: &str) -> BadCell {
    BadCell {
        message: format!("the cell contains `{}`", shown(error.as_bytes())),
        help: "leave the cell empty if nothing was measured".to_owned(),
    }
}

impl Cells for Row<'_> {
    /// Cells behind the last name are notes of people; those that are not there are empty.
    fn ragged(&self, _width: Width) -> Option<DataError> {
        None
    }

    fn number(&self, index: usize) -> Result<f64, BadCell> {
        match self.at(index) {
            None => Ok(f64::NAN),
            Some(Value::Number(value)) => Ok(*value),
            Some(Value::Text(text)) => cell::number(text.as_bytes(), self.decimal_comma),
            Some(Value::Date(stamp)) => Err(cell::is_date(&format!("`{stamp}`"))),
            Some(Value::Error(error)) => Err(no_value(error)),
        }
    }

    fn stamp(&self, index: usize) -> Result<Stamp, BadCell> {
        match self.at(index) {
            Some(Value::Text(text)) => cell::stamp(text.as_bytes(), self.decimal_comma),
            _ => self
                .number(index)
                .map(|value| if value.is_nan() { Stamp::MISSING } else { Stamp::number(value) }),
        }
    }

    fn date(&self, indices: &[usize]) -> Result<Stamp, BadCell> {
        // Of a date in two cells both must be there.
        if indices.iter().any(|index| self.at(*index).is_none()) {
            return Ok(Stamp::MISSING);
        }
        let mut texts = Vec::new();
        let mut sum: Option<Stamp> = None;
        for index in indices {
            match self.at(*index) {
                None => {}
                Some(Value::Date(stamp)) => sum = Some(sum.map_or(*stamp, |date| date.plus(*stamp))),
                Some(Value::Text(text)) => texts.push(text.as_bytes()),
                Some(Value::Number(number)) => return Err(cell::is_no_date(&format!("`{number}`"))),
                Some(Value::Error(error)) => return Err(no_value(error)),
            }
        }
        match sum {
            Some(sum) if texts.is_empty() => Ok(sum),
            Some(_) => Err(BadCell {
                message: "one cell is a date, the other text".to_owned(),
                help: "format both as a date or a time in the sheet".to_owned(),
            }),
            None => cell::date(&texts),
        }
    }

    fn run(&self, index: usize) -> Result<i64, BadCell> {
        cell::run(self.text(index).as_bytes())
    }

    fn text(&self, index: usize) -> String {
        self.at(index).map(Value::text).map(|text| shown(text.as_bytes())).unwrap_or_default()
    }

    fn error(&self, index: usize, message: String) -> DataError {
        let column = u64::try_from(index).unwrap_or(u64::MAX).saturating_add(1);
        DataError::new(self.name, message).at(Place::Cell { row: u64::from(self.row) + 1, column })
    }
}
