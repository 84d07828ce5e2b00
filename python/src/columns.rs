//! Columns of a table in memory. In: a dictionary of arrays, or a table of another library. Out: names, and numbers in the units of the
//! channels that read them.

use numpy::{AllowTypeChange, PyArrayLike1};
use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use recording::{ChannelKind, DataError, Header};

use crate::arrow;
use crate::error::wrong;

/// Nanoseconds of a second.
const NANOSECONDS: f64 = 1e9;

/// What a column holds.
pub(crate) trait Numbers {
    /// Times or spans of time, ns; nothing where they are none of these.
    fn times(&self) -> Option<Vec<Option<i128>>>;

    /// Numbers, NaN where there is none; or what it holds instead.
    fn numbers(&self) -> Result<Vec<f64>, String>;
}

/// One column.
pub(crate) struct Column {
    name: String,
    values: Box<dyn Numbers>,
}

impl Column {
    pub(crate) fn new(name: &str, values: impl Numbers + 'static) -> Self {
        Self { name: name.to_owned(), values: Box::new(values) }
    }
}

/// The columns of a table.
pub(crate) struct Table {
    columns: Vec<Column>,
}

impl Table {
    /// Takes a dictionary of arrays, or whatever has `__arrow_c_stream__`.
    pub(crate) fn read(table: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = table.py();
        if let Ok(columns) = table.cast::<PyDict>() {
            let columns = columns.iter().map(|(name, value)| array(&name.extract::<String>()?, &value));
            return Ok(Self { columns: columns.collect::<PyResult<_>>()? });
        }
        match arrow::read(table) {
            Ok(columns) => Ok(Self { columns }),
            // pandas hands its tables over by pyarrow, which need not be there; its columns are arrays as well.
            Err(error) if error.is_instance_of::<PyImportError>(py) => {
                let names = table.getattr("columns")?.try_iter()?;
                let columns = names.map(|name| {
                    let name = name?;
                    array(&name.str()?.to_string(), &table.get_item(&name)?)
                });
                Ok(Self { columns: columns.collect::<PyResult<_>>()? })
            }
            Err(error) => Err(error),
        }
    }

    /// The names of the columns.
    pub(crate) fn names(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.name.clone()).collect()
    }

    /// The numbers of a column in the unit of the channel that reads it.
    pub(crate) fn column(&self, index: usize, header: &Header, called: &str) -> Result<Vec<f64>, DataError> {
        let Some(column) = self.columns.get(index) else { return Ok(Vec::new()) };
        let wrong = |what: &str, help: &str| DataError {
            file: called.to_owned(),
            place: None,
            message: format!("column `{}` {what}", column.name),
            help: Some(help.to_owned()),
        };
        let Some(times) = column.values.times() else {
            return column.values.numbers().map_err(|what| wrong(&what, "make it a column of numbers"));
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
            _ => Err(wrong("holds times, not numbers", "times are for the channel `time` alone")),
        }
    }
}

/// A column that is an array of NumPy, or what becomes one.
fn array(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Column> {
    let py = value.py();
    let array = py.import("numpy")?.call_method1("asarray", (value,))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    let read = |array: &Bound<'_, PyAny>| -> PyResult<Vec<f64>> {
        let numbers: PyArrayLike1<'_, f64, AllowTypeChange> = array.extract()?;
        Ok(numbers.as_array().iter().copied().collect())
    };
    let known = match kind.as_str() {
        "M" | "m" => {
            let nanoseconds = if kind == "M" { "datetime64[ns]" } else { "timedelta64[ns]" };
            let counts = array.call_method1("astype", (nanoseconds,))?.call_method1("astype", ("int64",))?;
            let counts: PyArrayLike1<'_, i64, AllowTypeChange> = counts.extract()?;
            // NumPy's time that is none is the least number.
            let time = |count: &i64| (*count != i64::MIN).then(|| i128::from(*count));
            Known::Times(counts.as_array().iter().map(time).collect())
        }
        "b" | "i" | "u" | "f" => Known::Numbers(read(&array)?),
        // None and missing values of pandas make an array of objects of numbers.
        "O" => match array.call_method1("astype", ("float64",)).and_then(|array| read(&array)) {
            Ok(numbers) => Known::Numbers(numbers),
            Err(_) => Known::Other("holds objects, not numbers".to_owned()),
        },
        _ => Known::Other(format!("holds {}, not numbers", array.getattr("dtype")?)),
    };
    if array.getattr("ndim")?.extract::<usize>()? != 1 {
        return Err(wrong(py, format!("column `{name}` is no array of one dimension")));
    }
    Ok(Column::new(name, known))
}

/// The values of an array.
enum Known {
    Numbers(Vec<f64>),
    Times(Vec<Option<i128>>),
    Other(String),
}

impl Numbers for Known {
    fn times(&self) -> Option<Vec<Option<i128>>> {
        match self {
            Self::Times(times) => Some(times.clone()),
            _ => None,
        }
    }

    fn numbers(&self) -> Result<Vec<f64>, String> {
        match self {
            Self::Numbers(numbers) => Ok(numbers.clone()),
            Self::Times(_) => Err("holds times, not numbers".to_owned()),
            Self::Other(what) => Err(what.clone()),
        }
    }
}
