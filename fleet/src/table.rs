//! Tables on the disk. In: rows of named cells. Out: an Apache Parquet file of them, the same bytes for the same rows; and the rows of one.
//!
//! Flat columns of text, numbers and times, of which any may be missing in a row: what every reader of the format takes.

use std::collections::HashMap;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, TimeUnit, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::record::Field;
use parquet::schema::types::Type;

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Text,
    Number,
    Count,
    Flag,
    /// Milliseconds since 1970, in no zone.
    Time,
}

/// What a row has in one column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    None,
    Text(String),
    Number(f64),
    Count(i64),
    Flag(bool),
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<Option<String>> for Cell {
    fn from(text: Option<String>) -> Self {
        text.map_or(Self::None, Self::Text)
    }
}

impl From<f64> for Cell {
    /// What is not finite is missing.
    fn from(number: f64) -> Self {
        if number.is_finite() { Self::Number(number) } else { Self::None }
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        i64::try_from(count).map_or(Self::None, Self::Count)
    }
}

impl From<bool> for Cell {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}

/// The columns of a table, by name.
pub(crate) type Columns = &'static [(&'static str, Kind)];

/// One row as it was read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Row(HashMap<String, Field>);

impl Row {
    /// The text of a column; empty where it is missing.
    pub(crate) fn text(&self, column: &str) -> &str {
        match self.0.get(column) {
            Some(Field::Str(text)) => text,
            _ => "",
        }
    }

    /// The number of a column.
    pub(crate) fn number(&self, column: &str) -> Option<f64> {
        match self.0.get(column) {
            Some(Field::Double(number)) => Some(*number),
            _ => None,
        }
    }

    /// The count of a column.
    pub(crate) fn count(&self, column: &str) -> Option<i64> {
        match self.0.get(column) {
            Some(Field::Long(count) | Field::TimestampMillis(count)) => Some(*count),
            _ => None,
        }
    }

    /// Whether a column says yes.
    pub(crate) fn flag(&self, column: &str) -> bool {
        matches!(self.0.get(column), Some(Field::Bool(true)))
    }
}

/// Who wrote a file, whatever the version: the version is in the rows.
const WRITER: &str = "abbe";

/// The file of some rows, each with a cell for each column.
pub(crate) fn written(columns: Columns, rows: &[Vec<Cell>]) -> Result<Vec<u8>, ParquetError> {
    let properties = WriterProperties::builder()
        .set_created_by(WRITER.to_owned())
        .set_compression(Compression::SNAPPY)
        .build();
    let mut file = SerializedFileWriter::new(Vec::new(), Arc::new(schema(columns)?), Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    for (number, (_, kind)) in columns.iter().enumerate() {
        let cells = rows.iter().map(|row| row.get(number).unwrap_or(&Cell::None));
        write_column(&mut group, *kind, cells)?;
    }
    group.close()?;
    file.into_inner()
}

fn schema(columns: Columns) -> Result<Type, ParquetError> {
    let field = |(name, kind): &(&str, Kind)| {
        let (physical, logical) = match kind {
            Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Kind::Number => (Physical::DOUBLE, None),
            Kind::Count => (Physical::INT64, None),
            Kind::Flag => (Physical::BOOLEAN, None),
            Kind::Time => (Physical::INT64, Some(LogicalType::timestamp(false, TimeUnit::MILLIS))),
        };
        let builder = Type::primitive_type_builder(name, physical).with_logical_type(logical);
        builder.with_repetition(Repetition::OPTIONAL).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<Vec<_>, _>>()?;
    Type::group_type_builder("rows").with_fields(fields).build()
}

fn write_column<'c>(
    group: &mut SerializedRowGroupWriter<'_, Vec<u8>>,
    kind: Kind,
    cells: impl Iterator<Item = &'c Cell>,
) -> Result<(), ParquetError> {
    match kind {
        Kind::Text => write_values::<ByteArrayType>(group, cells, |cell| match cell {
            Cell::Text(text) => Some(ByteArray::from(text.as_str())),
            _ => None,
        }),
        Kind::Number => write_values::<DoubleType>(group, cells, |cell| match cell {
            Cell::Number(number) => Some(*number),
            _ => None,
        }),
        Kind::Count | Kind::Time => write_values::<Int64Type>(group, cells, |cell| match cell {
            Cell::Count(count) => Some(*count),
            _ => None,
        }),
        Kind::Flag => write_values::<BoolType>(group, cells, |cell| match cell {
            Cell::Flag(flag) => Some(*flag),
            _ => None,
        }),
    }
}

fn write_values<'c, T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, Vec<u8>>,
    cells: impl Iterator<Item = &'c Cell>,
    value: impl Fn(&Cell) -> Option<T::T>,
) -> Result<(), ParquetError> {
    let values: Vec<Option<T::T>> = cells.map(value).collect();
    let there: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let values: Vec<T::T> = values.into_iter().flatten().collect();
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    column.typed::<T>().write_batch(&values, Some(&there), None)?;
    column.close()
}

fn rows(reader: &SerializedFileReader<File>) -> Result<Vec<Row>, String> {
    let rows = reader.get_row_iter(None).map_err(|error| error.to_string())?;
    let row = |row: Result<parquet::record::Row, ParquetError>| {
        let row = row.map_err(|error| error.to_string())?;
        Ok(Row(row.into_columns().into_iter().collect()))
    };
    rows.map(row).collect()
}

/// The rows of a file that must have these columns; why it cannot be read.
pub(crate) fn read(path: &Path, columns: Columns) -> Result<Vec<Row>, String> {
    let file = File::open(path).map_err(|error| error.to_string())?;
    let reader = SerializedFileReader::new(file).map_err(|error| error.to_string())?;
    let schema = reader.metadata().file_metadata().schema_descr().columns().iter();
    if !schema.map(|column| column.name()).eq(columns.iter().map(|(name, _)| *name)) {
        return Err("its columns are others than those of this table".to_owned());
    }
    rows(&reader)
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: Columns = &[
        ("name", Kind::Text),
        ("value", Kind::Number),
        ("rows", Kind::Count),
        ("claimed", Kind::Flag),
        ("time", Kind::Time),
    ];

    #[test]
    fn rows_come_back_and_the_same_rows_are_the_same_bytes() {
        let rows = [
            vec![Cell::from("a"), Cell::from(1.5), Cell::from(3), Cell::from(true), Cell::Count(86_400_000)],
            vec![Cell::None, Cell::from(f64::NAN), Cell::None, Cell::from(false), Cell::None],
        ];
        let bytes = written(COLUMNS, &rows).unwrap();
        assert_eq!(bytes, written(COLUMNS, &rows).unwrap());
        let path = std::env::temp_dir().join(format!("abbe-table-{}.parquet", std::process::id()));
        std::fs::write(&path, bytes).unwrap();
        let read = read(&path, COLUMNS).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(read.len(), 2);
        assert_eq!(
            (read[0].text("name"), read[0].number("value"), read[0].count("rows")),
            ("a", Some(1.5), Some(3))
        );
        assert_eq!((read[0].flag("claimed"), read[0].count("time")), (true, Some(86_400_000)));
        assert_eq!(
            (read[1].text("name"), read[1].number("value"), read[1].flag("claimed")),
            ("", None, false)
        );
    }

    #[test]
    fn no_rows_are_a_file_too_and_no_file_is_a_reason() {
        let path = std::env::temp_dir().join(format!("abbe-table-empty-{}.parquet", std::process::id()));
        std::fs::write(&path, written(COLUMNS, &[]).unwrap()).unwrap();
        assert!(read(&path, COLUMNS).unwrap().is_empty());
        std::fs::write(&path, "PAR1").unwrap();
        assert!(read(&path, COLUMNS).is_err());
        std::fs::remove_file(&path).unwrap();
        assert!(read(&path, COLUMNS).is_err());
    }
}
