//! Tables in Apache Parquet: flat columns of numbers, one group of rows after the other.

use std::fs::File;

use parquet::basic::{ConvertedType, LogicalType};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use super::super::{Header, Recording};
use super::columns::Columns;
use super::error::DataError;
use super::layout::{find_columns, notes_of_extra};
use super::numbers::Group;
use super::{MOST_NUMBERS, settle};

/// How many values are asked for at once.
const BATCH: usize = 1 << 16;

impl Header {
    pub(super) fn read_parquet(&self, name: &str, file: File) -> Result<Recording, DataError> {
        let broken = |error: ParquetError| DataError::new(name, format!("it cannot be read: {error}"));
        let reader = SerializedFileReader::new(file).map_err(broken)?;
        let schema = reader.metadata().file_metadata().schema_descr();
        let names: Vec<String> =
            schema.columns().iter().map(|column| column.path().parts().join(".")).collect();
        let columns =
            find_columns(self, &names).map_err(|(message, help)| DataError::new(name, message).help(help))?;
        for &index in &columns {
            if let Some(problem) = schema.columns().get(index).and_then(|column| not_plain(column)) {
                let message =
                    format!("column `{}` holds {problem}", names.get(index).map_or("", String::as_str));
                return Err(DataError::new(name, message).help("save it as a column of plain numbers"));
            }
        }
        let notes = notes_of_extra(self, name, &names);
        let mut table = Columns::new(self, &columns, names.len(), name, MOST_NUMBERS);
        let mut before = 0;
        for group in 0..reader.num_row_groups() {
            let rows = reader.get_row_group(group).map_err(broken)?;
            let numbers =
                Group { name, before, columns: read_group(&*rows, &columns, names.len()).map_err(broken)? };
            before += numbers.send_to(&mut table)?;
        }
        settle::settle(self, table.finish()?, name, notes)
    }
}

/// Why a column is not one of plain numbers.
fn not_plain(column: &ColumnDescriptor) -> Option<String> {
    use parquet::basic::Type;
    if column.max_rep_level() > 0 {
        return Some("lists".to_owned());
    }
    let plain_kind = matches!(column.logical_type_ref(), None | Some(LogicalType::Integer { .. }))
        && !matches!(column.converted_type(), ConvertedType::DECIMAL);
    let plain_type = matches!(
        column.physical_type(),
        Type::BOOLEAN | Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE
    );
    let kind = || match (column.physical_type(), column.logical_type_ref()) {
        (Type::BYTE_ARRAY, _) => "text".to_owned(),
        (_, Some(kind)) => format!("{kind:?}"),
        (physical, None) => physical.to_string(),
    };
    (!plain_kind || !plain_type).then(kind)
}

fn read_group(
    rows: &dyn RowGroupReader,
    wanted: &[usize],
    width: usize,
) -> Result<Vec<Vec<f64>>, ParquetError> {
    let mut columns = vec![Vec::new(); width];
    for &index in wanted {
        if let Some(column) = columns.get_mut(index).filter(|column| column.is_empty()) {
            let present = rows.metadata().column(index).column_descr().max_def_level();
            *column = read_column(rows.get_column_reader(index)?, present)?;
        }
    }
    Ok(columns)
}

/// `present` is the level of a value that is there.
fn read_column(reader: ColumnReader, present: i16) -> Result<Vec<f64>, ParquetError> {
    match reader {
        ColumnReader::BoolColumnReader(reader) => {
            values(reader, present, |value| if *value { 1.0 } else { 0.0 })
        }
        ColumnReader::Int32ColumnReader(reader) => values(reader, present, |value| f64::from(*value)),
        // Whole numbers beyond 2^53 lose their last digits, as they do in the text of a table.
        ColumnReader::Int64ColumnReader(reader) => values(reader, present, |value| *value as f64),
        ColumnReader::FloatColumnReader(reader) => values(reader, present, |value| f64::from(*value)),
        ColumnReader::DoubleColumnReader(reader) => values(reader, present, |value| *value),
        _ => Err(ParquetError::General("a column does not hold numbers".to_owned())),
    }
}

/// All values of a column; NaN where there is none.
fn values<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    present: i16,
    number: impl Fn(&T::T) -> f64,
) -> Result<Vec<f64>, ParquetError> {
    let mut all = Vec::new();
    let (mut found, mut levels) = (Vec::new(), Vec::new());
    loop {
        found.clear();
        levels.clear();
        let (records, _, _) = reader.read_records(BATCH, Some(&mut levels), None, &mut found)?;
        if records == 0 {
            return Ok(all);
        }
        // A column whose values must be there has no levels.
        let mut found = found.iter().map(&number);
        if levels.is_empty() {
            all.extend(found);
        } else {
            all.extend(
                levels
                    .iter()
                    .map(|level| if *level == present { found.next().unwrap_or(f64::NAN) } else { f64::NAN }),
            );
        }
    }
}
