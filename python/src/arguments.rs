//! What callers give: dictionaries, numbers and arrays. In: objects of Python. Out: the same as Rust has them; whatever is none of these is
//! refused by its name.

use std::path::PathBuf;

use numpy::{AllowTypeChange, IntoPyArray, PyArrayLikeDyn, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes, PyDict, PyMapping, PyString};

use crate::error::wrong;

/// The types that pandas uses for missing values.
const MISSING: [&str; 2] = ["NAType", "NaTType"];

/// A dictionary, or any other mapping.
pub(crate) struct Entries<'py>(pub(crate) Bound<'py, PyDict>);

impl<'a, 'py> FromPyObject<'a, 'py> for Entries<'py> {
    type Error = PyErr;

    fn extract(value: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(entries) = value.cast::<PyDict>() {
            return Ok(Self(entries.to_owned()));
        }
        let entries = PyDict::new(value.py());
        let mapping = value.cast::<PyMapping>()?.to_owned();
        entries.update(&mapping)?;
        Ok(Self(entries))
    }
}

impl<'py> Entries<'py> {
    /// The entries of an argument in their order; their keys are text.
    pub(crate) fn pairs(given: Option<&Self>, name: &str) -> PyResult<Vec<(String, Bound<'py, PyAny>)>> {
        let entries = given.into_iter().flat_map(|given| &given.0);
        entries.map(|(key, value)| Ok((text(&key, &format!("a key of `{name}`"))?, value))).collect()
    }

    /// The numbers of an argument by their names.
    pub(crate) fn numbers(given: Option<&Self>, name: &str) -> PyResult<Vec<(String, f64)>> {
        let number = |(key, value): (String, Bound<'py, PyAny>)| {
            let number = number(&value, &format!("`{name}[\"{key}\"]`"))?;
            Ok((key, number))
        };
        Self::pairs(given, name)?.into_iter().map(number).collect()
    }

    /// What stands at a name.
    pub(crate) fn at(given: Option<&Self>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        given.map_or(Ok(None), |given| given.0.get_item(name))
    }
}

/// The name of an object's type.
pub(crate) fn kind(value: &Bound<'_, PyAny>) -> String {
    value.get_type().name().map_or_else(|_| "unknown".to_owned(), |name| name.to_string())
}

/// Text; `what` tells in messages what it is.
pub(crate) fn text(value: &Bound<'_, PyAny>, what: &str) -> PyResult<String> {
    let py = value.py();
    let text = value.cast::<PyString>();
    let text = text.map_err(|_| wrong(py, format!("{what} is text, found {value} ({})", kind(value))))?;
    let told = |_| wrong(py, format!("{what} holds a letter that Unicode does not have alone: {text:?}"));
    Ok(text.to_str().map_err(told)?.to_owned())
}

/// A path: a string, or what `os.fspath` takes; `what` tells in messages what is expected.
pub(crate) fn path(value: &Bound<'_, PyAny>, what: &str) -> PyResult<PathBuf> {
    let refused = |_| wrong(value.py(), format!("{what}, found {}", kind(value)));
    value.extract().map_err(refused)
}

/// A number.
pub(crate) fn number(value: &Bound<'_, PyAny>, name: &str) -> PyResult<f64> {
    value.extract().map_err(|_| wrong(value.py(), format!("{name} is a number, found {}", kind(value))))
}

/// An array of numbers of any shape. What is masked or missing is NaN; an array of float64 is read where it lies.
pub(crate) fn array<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let py = value.py();
    let numpy = py.import("numpy")?;
    let refused = |error: PyErr| wrong(py, format!("`{name}` is no array of numbers: {}", error.value(py)));
    let given = numpy.call_method1("asanyarray", (value,)).map_err(refused)?;
    let dtype = given.getattr("dtype")?;
    let given = match dtype.getattr("kind")?.extract::<String>()?.as_str() {
        "b" | "i" | "u" | "f" if given.hasattr("mask")? => {
            given.call_method1("astype", ("float64",))?.call_method1("filled", (f64::NAN,))?
        }
        "b" | "i" | "u" | "f" => given,
        "O" => of_objects(&given, name)?,
        _ => return Err(wrong(py, format!("`{name}` holds {dtype}, not numbers"))),
    };
    // Some arrays lie across the places where a processor looks for numbers, or have the bytes of another one: these are copied.
    let ready = numpy.call_method1("require", (given, "float64", "A"))?;
    let ready: PyArrayLikeDyn<'py, f64, AllowTypeChange> = ready.extract()?;
    Ok((*ready).clone())
}

/// The numbers of an array of objects, each of which may be any number of Python, or none.
fn of_objects<'py>(given: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let (py, shape) = (given.py(), given.getattr("shape")?);
    let numbers = given.call_method0("ravel")?.call_method0("tolist")?.try_iter()?.enumerate();
    let numbers = numbers.map(|(place, value)| {
        let value = value?;
        let not_a_number = || {
            let what = format!("{} ({})", value.repr()?, kind(&value));
            Err(wrong(py, format!("`{name}` holds objects: number {place}, counted from 0, is {what}")))
        };
        match value.extract::<f64>() {
            _ if is_missing(&value) => Ok(f64::NAN),
            Ok(number) if !is_text(&value) => Ok(number),
            _ => not_a_number(),
        }
    });
    numbers.collect::<PyResult<Vec<f64>>>()?.into_pyarray(py).call_method1("reshape", (shape,))
}

/// Whether an object says that there is no value.
pub(crate) fn is_missing(value: &Bound<'_, PyAny>) -> bool {
    value.is_none() || MISSING.contains(&kind(value).as_str())
}

/// Whether it is text or bytes.
pub(crate) fn is_text(value: &Bound<'_, PyAny>) -> bool {
    value.is_instance_of::<PyString>()
        || value.is_instance_of::<PyBytes>()
        || value.is_instance_of::<PyByteArray>()
}

/// A number for each row, or one for all of them.
pub(crate) fn column(value: &Bound<'_, PyAny>, name: &str, rows: usize) -> PyResult<Vec<f64>> {
    let array = array(value, name)?;
    let array = array.as_array();
    match (array.ndim(), array.len()) {
        (0, _) => Ok(vec![array.first().copied().unwrap_or(f64::NAN); rows]),
        (1, length) if length == rows => Ok(array.iter().copied().collect()),
        _ => {
            let found = shape(array.shape());
            Err(wrong(value.py(), format!("`{name}` has the shape {found}, not ({rows},)")))
        }
    }
}

/// A shape as Python writes it.
pub(crate) fn shape(lengths: &[usize]) -> String {
    match lengths {
        [one] => format!("({one},)"),
        all => format!("({})", all.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// An answer for each row; where the question was one row alone, the answer of that.
pub(crate) fn answered(answers: Bound<'_, PyAny>, alone: bool) -> PyResult<Bound<'_, PyAny>> {
    if alone { answers.get_item(0) } else { Ok(answers) }
}
