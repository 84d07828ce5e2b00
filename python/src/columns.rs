//! Columns of a table in memory. In: a dictionary of arrays, or a table of another library. Out: names, and numbers in the units of the
//! channels that read them.

use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;
use pyo3::types::PyDelta;
use recording::{ChannelKind, DataError, Header};

use crate::arguments::{Entries, array, is_missing, kind, shape};
use crate::arrow;
use crate::error::wrong;

/// Nanoseconds of a second.
const NANOSECONDS: f64 = 1e9;

/// Nanoseconds of a microsecond, a second and a day.
const EACH: [i128; 3] = [1_000, 1_000_000_000, 86_400_000_000_000];

/// What a column holds.
pub(crate) enum Values {
    /// Numbers, NaN where there is none.
    Numbers(Vec<f64>),
    /// Times or spans of time, ns from anywhere; none where there is none.
    Times(Vec<Option<i128>>),
    /// Neither: what it holds instead.
    Other(String),
}

/// One column. It is read when a channel wants it.
struct Column<'py> {
    name: String,
    source: Source<'py>,
}

enum Source<'py> {
    Array(Bound<'py, PyAny>),
    Arrow(arrow::Part),
}

/// The columns of a table.
pub(crate) struct Table<'py> {
    columns: Vec<Column<'py>>,
}

impl<'py> Table<'py> {
    /// Takes a dictionary of arrays, whatever has `__arrow_c_stream__`, or an array with named fields.
    pub(crate) fn read(table: &Bound<'py, PyAny>) -> PyResult<Self> {
        let py = table.py();
        let columns: Vec<Column<'_>> = if let Ok(columns) = table.extract() {
            let columns = Entries::pairs(Some(&columns), "source")?.into_iter();
            columns.map(|(name, values)| Column::new(&name, Source::Array(values))).collect()
        } else if table.hasattr("__arrow_c_stream__")? {
            match arrow::read(table) {
                Ok(parts) => {
                    parts.into_iter().map(|(name, part)| Column::new(&name, Source::Arrow(part))).collect()
                }
                // pandas hands its tables over by pyarrow, which need not be there; its columns are arrays as well.
                Err(error) if error.is_instance_of::<PyImportError>(py) => {
                    arrays(table, &table.getattr("columns")?)?
                }
                Err(error) => return Err(error),
            }
        } else {
            match table.getattr("dtype").and_then(|dtype| dtype.getattr("names")) {
                Ok(names) if !names.is_none() => arrays(table, &names)?,
                _ => {
                    let what =
                        "a recording is a path, a dictionary of arrays, or a table such as a DataFrame";
                    return Err(wrong(py, format!("{what}, found {}", kind(table))));
                }
            }
        };
        if columns.is_empty() {
            return Err(wrong(py, "the table has no columns"));
        }
        Ok(Self { columns })
    }

    /// The names of the columns, without blanks around them, as recording files name them.
    pub(crate) fn names(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.name.clone()).collect()
    }

    /// The numbers of a column in the unit of the channel that reads it.
    pub(crate) fn column(&self, index: usize, header: &Header, called: &str) -> Result<Vec<f64>, DataError> {
        let Some(column) = self.columns.get(index) else { return Ok(Vec::new()) };
        let refused = |message: String, help: Option<&str>| DataError {
            file: called.to_owned(),
            place: None,
            message,
            help: help.map(str::to_owned),
            recording: None,
        };
        let wrong =
            |what: &str, help: &str| Err(refused(format!("column `{}` {what}", column.name), Some(help)));
        let times = match column.values().map_err(|message| refused(message, None))? {
            Values::Numbers(numbers) => return Ok(numbers),
            Values::Other(what) => return wrong(&what, "make it a column of numbers"),
            Values::Times(times) => times,
        };
        let mut reading = header
            .channels
            .iter()
            .filter(|channel| channel.columns().iter().any(|own| own.value == column.name));
        match reading.next() {
            Some(channel) if channel.kind == ChannelKind::Time => {
                let unit = channel.unit.map_or(1.0, |unit| unit.value.factor);
                let first = times.iter().flatten().next().copied().unwrap_or_default();
                // Counted from the first: so near to it a number of 64 bits tells nanoseconds apart.
                let since = |time: i128| time.saturating_sub(first) as f64 / NANOSECONDS / unit;
                Ok(times.into_iter().map(|time| time.map_or(f64::NAN, since)).collect())
            }
            _ => wrong("holds times, not numbers", "times are for the channel `time` alone"),
        }
    }
}

/// The columns of a table that gives each by its name as an array.
fn arrays<'py>(table: &Bound<'py, PyAny>, names: &Bound<'py, PyAny>) -> PyResult<Vec<Column<'py>>> {
    let columns = names.try_iter()?.map(|name| {
        let name = name?;
        Ok(Column::new(&name.str()?.to_string(), Source::Array(table.get_item(&name)?)))
    });
    columns.collect()
}

impl<'py> Column<'py> {
    fn new(name: &str, source: Source<'py>) -> Self {
        Self { name: name.trim().to_owned(), source }
    }

    /// What it holds, or why it cannot be read.
    fn values(&self) -> Result<Values, String> {
        let reason = |error: PyErr, py| error.value(py).to_string().trim_start_matches("error: ").to_owned();
        match &self.source {
            Source::Arrow(part) => Ok(part.values()),
            Source::Array(values) => of_array(values, &self.name).map_err(|error| reason(error, values.py())),
        }
    }
}

/// What an array of NumPy holds, or whatever becomes one.
fn of_array(values: &Bound<'_, PyAny>, name: &str) -> PyResult<Values> {
    let array = values.py().import("numpy")?.call_method1("asanyarray", (values,))?;
    let lengths: Vec<usize> = array.getattr("shape")?.extract()?;
    if lengths.len() != 1 {
        let found = shape(&lengths);
        return Ok(Values::Other(format!("has the shape {found}; a column has a number for each row")));
    }
    let dtype = array.getattr("dtype")?;
    match dtype.getattr("kind")?.extract::<String>()?.as_str() {
        kind @ ("M" | "m") => times(&array, if kind == "M" { "datetime64[ns]" } else { "timedelta64[ns]" }),
        "b" | "i" | "u" | "f" => numbers(&array, name),
        "O" => of_objects(&array, name),
        _ => Ok(Values::Other(format!("holds {dtype}, not numbers"))),
    }
}

fn numbers(values: &Bound<'_, PyAny>, name: &str) -> PyResult<Values> {
    Ok(Values::Numbers(array(values, name)?.as_array().iter().copied().collect()))
}

fn times(array: &Bound<'_, PyAny>, nanoseconds: &str) -> PyResult<Values> {
    let counts = array.call_method1("astype", (nanoseconds,))?.call_method1("astype", ("int64",))?;
    let counts: Vec<i64> = counts.call_method0("tolist")?.extract()?;
    // NumPy's time that is none is the least number.
    let time = |count: i64| (count != i64::MIN).then(|| i128::from(count));
    Ok(Values::Times(counts.into_iter().map(time).collect()))
}

/// Numbers, or dates and times with or without a time zone; some may be missing.
fn of_objects(array: &Bound<'_, PyAny>, name: &str) -> PyResult<Values> {
    let objects = array.call_method0("tolist")?.try_iter()?.collect::<PyResult<Vec<_>>>()?;
    let Some(first) = objects.iter().find(|object| !is_missing(object)) else {
        return Ok(Values::Numbers(vec![f64::NAN; objects.len()]));
    };
    if first.sub(first).is_ok_and(|span| span.is_instance_of::<PyDelta>()) {
        let since = |object: &Bound<'_, PyAny>| match is_missing(object) {
            true => Ok(None),
            false => span(&object.sub(first)?).map(Some),
        };
        return objects.iter().map(since).collect::<PyResult<Vec<_>>>().map(Values::Times);
    }
    numbers(array, name)
}

/// A span of time of Python, ns; those of pandas tell nanoseconds too.
fn span(span: &Bound<'_, PyAny>) -> PyResult<i128> {
    let part = |name: &str| -> PyResult<i128> { span.getattr(name)?.extract() };
    let [microseconds, seconds, days] = EACH;
    let parts = [
        part("days")?.saturating_mul(days),
        part("seconds")?.saturating_mul(seconds),
        part("microseconds")?.saturating_mul(microseconds),
        part("nanoseconds").unwrap_or_default(),
    ];
    Ok(parts.into_iter().sum())
}
