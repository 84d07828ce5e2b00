//! Tables in Apache Parquet: flat columns of numbers and dates, one group of rows after the other.

use std::sync::Arc;

use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ParquetMetaDataReader, RowGroupMetaData};
use parquet::file::reader::ChunkReader;
use parquet::schema::types::{ColumnDescriptor, SchemaDescriptor};

use super::super::{ChannelKind, ChannelPlace, Header, Names, Recording};
use super::cell::BadCell;
use super::columns::{Columns, Width};
use super::error::DataError;
use super::layout::{find_columns, notes_of_extra};
use super::numbers::{Group, Values};
use super::pages::pages_of;
use super::stamp::Stamp;
use super::{ColumnNames, MOST_NUMBERS, settle};

/// How many values are asked for at once.
const BATCH: usize = 1 << 16;

/// The names of the columns of a file in Parquet.
pub(super) fn names<R: ChunkReader>(name: &str, file: &R) -> Result<ColumnNames, DataError> {
    let metadata =
        ParquetMetaDataReader::new().parse_and_finish(file).map_err(|error| broken(name, &error))?;
    let schema = metadata.file_metadata().schema_descr();
    let dates = schema.columns().iter().map(|column| date_of(column).is_ok()).collect();
    Ok(ColumnNames { names: names_of(schema), line: None, units: Vec::new(), dates })
}

fn names_of(schema: &SchemaDescriptor) -> Vec<String> {
    schema.columns().iter().map(|column| column.path().parts().join(".")).collect()
}

fn broken(name: &str, error: &ParquetError) -> DataError {
    let told = error.to_string();
    let broken = DataError::new(name, format!("it cannot be read: {told}"));
    // The reader knows this packing and was built without it.
    if told.contains("Disabled feature") {
        return broken.help("write it with zstd, snappy, gzip or lz4, or without compression");
    }
    broken
}

impl Header {
    /// Reads the data from a file in Parquet.
    pub(super) fn read_parquet<R: ChunkReader + 'static>(
        &self,
        name: &str,
        file: R,
    ) -> Result<Recording, DataError> {
        let broken = |error: ParquetError| broken(name, &error);
        self.refuse_form(name)?;
        let metadata = ParquetMetaDataReader::new().parse_and_finish(&file).map_err(broken)?;
        let file = Arc::new(file);
        let schema = metadata.file_metadata().schema_descr();
        let names = names_of(schema);
        let columns = find_columns(self, &names).map_err(|misfit| misfit.of_file(name))?;
        let mut wanted = Vec::new();
        for (channel, places) in self.channels.iter().zip(&columns) {
            for &index in places {
                let Some(column) = schema.columns().get(index) else { continue };
                let dates = matches!(channel.place, ChannelPlace::Dates(_));
                let form = if dates { date_of(column) } else { number_of(column) };
                let form = form.map_err(|bad| {
                    let column = names.get(index).map_or("", String::as_str);
                    DataError::new(name, format!("column `{column}` contains {}", bad.message)).help(bad.help)
                })?;
                wanted.push(Wanted { index, form, time: channel.kind == ChannelKind::Time });
            }
        }
        let notes = notes_of_extra(self, name, &names);
        let mut table = Columns::new(self, &columns, Width::Exactly(names.len()), name, MOST_NUMBERS);
        let mut before = 0;
        for group in metadata.row_groups() {
            let group = Group {
                name,
                before,
                columns: read_group(&file, group, &wanted, names.len()).map_err(broken)?,
            };
            before += group.send_to(&mut table)?;
        }
        settle::settle(self, table.finish()?, name, notes)
    }

    /// Parquet says itself how it is written.
    fn refuse_form(&self, name: &str) -> Result<(), DataError> {
        let header = (self.form.names != Names::FirstRow).then_some("header");
        let sheet = self.form.sheet.is_some().then_some("sheet");
        let Some(key) = self.form.of_text().or(header).or(sheet) else { return Ok(()) };
        let error = DataError::new(name, format!("it is a Parquet file, for which `{key}` has no meaning"));
        let error = error.in_recording(self.form.unsuited(key));
        Err(error.help(format!("remove `{key}` from the recording file")))
    }
}

/// A column that is read.
struct Wanted {
    index: usize,
    form: Form,
    /// Whether it holds times.
    time: bool,
}

/// What the values of a column are.
#[derive(Clone, Copy)]
enum Form {
    /// Numbers.
    Number,
    /// Whole numbers without a sign.
    Unsigned,
    /// Ticks since 1970, so many of which are a second, in universal time or on a clock on a wall.
    Date { in_second: i64, universal: bool },
}

/// How the numbers of a column are written, or why there are none.
fn number_of(column: &ColumnDescriptor) -> Result<Form, BadCell> {
    let bad = |message: String| BadCell { message, help: "save it as a column of plain numbers".to_owned() };
    if date_of(column).is_ok() {
        return Err(BadCell {
            message: "dates".to_owned(),
            help: "write `unit: date` for this channel in the recording file; only times can be dates"
                .to_owned(),
        });
    }
    if column.max_rep_level() > 0 {
        return Err(bad("lists".to_owned()));
    }
    let unsigned = match column.logical_type_ref() {
        None => matches!(
            column.converted_type(),
            ConvertedType::UINT_8 | ConvertedType::UINT_16 | ConvertedType::UINT_32 | ConvertedType::UINT_64
        ),
        Some(LogicalType::Integer(integer)) => !integer.is_signed,
        Some(kind) => return Err(bad(kind_of(column, kind))),
    };
    if column.converted_type() == ConvertedType::DECIMAL {
        return Err(bad("decimals".to_owned()));
    }
    match column.physical_type() {
        Type::BOOLEAN | Type::INT32 | Type::INT64 if unsigned => Ok(Form::Unsigned),
        Type::BOOLEAN | Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE => Ok(Form::Number),
        Type::BYTE_ARRAY => Err(bad("text".to_owned())),
        other => Err(bad(other.to_string())),
    }
}

fn kind_of(column: &ColumnDescriptor, kind: &LogicalType) -> String {
    match (column.physical_type(), kind) {
        (_, LogicalType::Decimal(_)) => "decimals".to_owned(),
        (Type::BYTE_ARRAY, _) => "text".to_owned(),
        _ => format!("{kind:?}"),
    }
}

/// How the dates of a column are written, or why there are none.
fn date_of(column: &ColumnDescriptor) -> Result<Form, BadCell> {
    let ticks = |in_second: i64, universal: bool| Ok(Form::Date { in_second, universal });
    match (column.logical_type_ref(), column.converted_type(), column.physical_type()) {
        (Some(LogicalType::Timestamp(kind)), _, Type::INT64) => match kind.unit {
            TimeUnit::MILLIS => ticks(1_000, kind.is_adjusted_to_u_t_c),
            TimeUnit::MICROS => ticks(1_000_000, kind.is_adjusted_to_u_t_c),
            TimeUnit::NANOS => ticks(1_000_000_000, kind.is_adjusted_to_u_t_c),
        },
        (None, ConvertedType::TIMESTAMP_MILLIS, Type::INT64) => ticks(1_000, true),
        (None, ConvertedType::TIMESTAMP_MICROS, Type::INT64) => ticks(1_000_000, true),
        (None, _, Type::INT96) => ticks(1_000_000_000, false),
        _ => Err(BadCell {
            message: "no dates".to_owned(),
            help: "write the unit of the times, `unit: s`, instead of `unit: date` in the recording file; convert text to dates with `pandas.to_datetime`".to_owned(),
        }),
    }
}

fn read_group<R: ChunkReader + 'static>(
    file: &Arc<R>,
    group: &RowGroupMetaData,
    wanted: &[Wanted],
    width: usize,
) -> Result<Vec<Values>, ParquetError> {
    let mut columns: Vec<Values> = (0..width).map(|_| Values::Numbers(Vec::new())).collect();
    let rows =
        usize::try_from(group.num_rows()).map_err(|_| general("a group has a negative number of rows"))?;
    for one in wanted {
        let Some(slot) = columns.get_mut(one.index) else { continue };
        let found = group.columns().get(one.index);
        let chunk = found.ok_or_else(|| general("a group lacks a column"))?;
        let pages = pages_of(file, chunk, rows)?;
        let reader = get_column_reader(chunk.column_descr_ptr(), pages);
        if slot.len() == 0 {
            *slot = read_column(reader, one, chunk.column_descr().max_def_level())?;
        }
        if slot.len() != rows {
            return Err(general(
                "the number of values of a column differs from the number of rows of its group",
            ));
        }
    }
    Ok(columns)
}

fn general(why: &str) -> ParquetError {
    ParquetError::General(why.to_owned())
}

/// `present` is the level of a value that is there.
fn read_column(reader: ColumnReader, wanted: &Wanted, present: i16) -> Result<Values, ParquetError> {
    let form = wanted.form;
    match (reader, form) {
        (ColumnReader::Int64ColumnReader(reader), Form::Date { in_second, universal }) => {
            let stamp = |ticks: &i64| Stamp::ticks(*ticks, in_second, universal);
            values(reader, present, Stamp::MISSING, stamp).map(Values::Stamps)
        }
        (ColumnReader::Int96ColumnReader(reader), Form::Date { in_second, universal }) => {
            values(reader, present, Stamp::MISSING, |ticks| {
                Stamp::ticks(ticks.to_nanos(), in_second, universal)
            })
            .map(Values::Stamps)
        }
        // A whole number of ns since 1970 has more digits than a number in floating point.
        (ColumnReader::Int64ColumnReader(reader), _) if wanted.time => {
            values(reader, present, Stamp::MISSING, |ticks| Stamp::whole(*ticks)).map(Values::Stamps)
        }
        (reader, _) => read_numbers(reader, matches!(form, Form::Unsigned), present).map(Values::Numbers),
    }
}

fn read_numbers(reader: ColumnReader, unsigned: bool, present: i16) -> Result<Vec<f64>, ParquetError> {
    match reader {
        ColumnReader::BoolColumnReader(reader) => {
            values(reader, present, f64::NAN, |value| if *value { 1.0 } else { 0.0 })
        }
        ColumnReader::Int32ColumnReader(reader) if unsigned => {
            values(reader, present, f64::NAN, |value| f64::from(value.cast_unsigned()))
        }
        ColumnReader::Int32ColumnReader(reader) => {
            values(reader, present, f64::NAN, |value| f64::from(*value))
        }
        // Whole numbers beyond 2^53 lose their last digits, as they do in the text of a table.
        ColumnReader::Int64ColumnReader(reader) if unsigned => {
            values(reader, present, f64::NAN, |value| value.cast_unsigned() as f64)
        }
        ColumnReader::Int64ColumnReader(reader) => values(reader, present, f64::NAN, |value| *value as f64),
        ColumnReader::FloatColumnReader(reader) => {
            values(reader, present, f64::NAN, |value| f64::from(*value))
        }
        ColumnReader::DoubleColumnReader(reader) => values(reader, present, f64::NAN, |value| *value),
        _ => Err(general("a column does not contain numbers")),
    }
}

/// All values of a column; `missing` where there is none.
fn values<T: DataType, V: Copy>(
    mut reader: ColumnReaderImpl<T>,
    present: i16,
    missing: V,
    value: impl Fn(&T::T) -> V,
) -> Result<Vec<V>, ParquetError> {
    let mut all = Vec::new();
    let (mut found, mut levels) = (Vec::new(), Vec::new());
    loop {
        found.clear();
        levels.clear();
        let (records, _, _) = reader.read_records(BATCH, Some(&mut levels), None, &mut found)?;
        if records == 0 {
            return Ok(all);
        }
        if all.len() > MOST_NUMBERS {
            return Err(general("a group has too many rows"));
        }
        // A column whose values must be there has no levels.
        let mut found = found.iter().map(&value);
        if levels.is_empty() {
            all.extend(found);
        } else {
            let of_level = |level: &i16| if *level == present { found.next() } else { None };
            all.extend(levels.iter().map(of_level).map(|value| value.unwrap_or(missing)));
        }
    }
}
