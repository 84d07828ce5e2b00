//! Files and what stands for them. In: a path, or a dictionary that says what the file would. Out: the text of a file, with the folder
//! that the names in it are counted from.
//!
//! A dictionary is written as the file it stands for and read like one, so that both are checked by the same rules, and a mistake is
//! shown at its place.

use std::fmt::{self, Display, Formatter, Write as _};
use std::path::{Path, PathBuf};

use model_dsl::quoted;
use model_dsl::source::SourceFile;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PySequence, PyString};
use workshop::failure::Failure;
use workshop::load;

use crate::arguments::{self, Entries, is_text, kind};
use crate::error::{raised, wrong};

/// The text of a file and where it stands.
#[derive(Clone)]
pub(crate) struct Text {
    pub(crate) source: SourceFile,
    /// The file; of a dictionary a name in the current folder.
    pub(crate) path: PathBuf,
}

impl Text {
    pub(crate) fn folder(&self) -> Option<&Path> {
        self.path.parent()
    }
}

/// A path: a string, or what `os.fspath` takes.
pub(crate) fn path(value: &Bound<'_, PyAny>) -> PyResult<PathBuf> {
    arguments::path(value, "a file is named by a path")
}

/// Reads a file, or writes out a dictionary under the name `called`.
pub(crate) fn text(value: &Bound<'_, PyAny>, called: &str) -> PyResult<Text> {
    let py = value.py();
    if let Ok(Entries(entries)) = value.extract() {
        let source = SourceFile::new(format!("<{called}>"), written(&entries, called)?);
        return Ok(Text { source, path: PathBuf::from(called) });
    }
    let path = arguments::path(value, &format!("a {called} is given by a path or a dictionary"))?;
    let source: Result<SourceFile, Failure> = py.detach(|| load::read(&path));
    Ok(Text { source: source.map_err(|failure| raised(py, &failure))?, path })
}

/// A dictionary as YAML: a line for each of its keys, and for each key of those that hold dictionaries.
pub(crate) fn written(entries: &Bound<'_, PyDict>, called: &str) -> PyResult<String> {
    let top = Place { outer: None, step: Step::Key(called), depth: 0 };
    let mut text = String::new();
    for (key, value) in entries {
        let key = top.key(&key)?;
        let place = top.inside(Step::Key(&key));
        // Writing into a string cannot fail.
        match value.extract() {
            Ok(Entries(inner)) if !inner.is_empty() => {
                let _ = writeln!(text, "{}:", spelled(&key));
                for (key, value) in inner {
                    let _ = writeln!(text, "  {}", entry(&key, &value, &place)?);
                }
            }
            _ => {
                let _ = writeln!(text, "{}: {}", spelled(&key), flow(&value, &place)?);
            }
        }
    }
    Ok(text)
}

/// Deeper than any file goes; a list that holds itself has no end.
const DEEPEST: usize = 32;

/// Where a value stands in a dictionary, from the outside: `calibration.errors.EXX[0]`.
struct Place<'a> {
    outer: Option<&'a Place<'a>>,
    step: Step<'a>,
    depth: usize,
}

enum Step<'a> {
    Key(&'a str),
    Item(usize),
}

impl Place<'_> {
    fn key(&self, key: &Bound<'_, PyAny>) -> PyResult<String> {
        arguments::text(key, &format!("a key of {self}"))
    }

    fn inside<'a>(&'a self, step: Step<'a>) -> Place<'a> {
        Place { outer: Some(self), step, depth: self.depth.saturating_add(1) }
    }
}

impl Display for Place<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if let Some(outer) = self.outer {
            write!(f, "{outer}")?;
        }
        match self.step {
            Step::Key(key) if self.outer.is_none() => write!(f, "{key}"),
            Step::Key(key) => write!(f, ".{key}"),
            Step::Item(number) => write!(f, "[{number}]"),
        }
    }
}

fn entry(key: &Bound<'_, PyAny>, value: &Bound<'_, PyAny>, place: &Place<'_>) -> PyResult<String> {
    let key = place.key(key)?;
    Ok(format!("{}: {}", spelled(&key), flow(value, &place.inside(Step::Key(&key)))?))
}

/// A value on one line.
fn flow(value: &Bound<'_, PyAny>, place: &Place<'_>) -> PyResult<String> {
    let py = value.py();
    if place.depth > DEEPEST {
        return Err(wrong(py, "a dictionary holds others too deeply to be a file"));
    }
    if let Some(plain) = scalar(value, place)? {
        return Ok(plain);
    }
    if let Ok(Entries(entries)) = value.extract() {
        let entries: PyResult<Vec<String>> =
            entries.iter().map(|(key, value)| entry(&key, &value, place)).collect();
        return Ok(format!("{{{}}}", entries?.join(", ")));
    }
    if let Some(plain) = plain(value)? {
        return flow(&plain, place);
    }
    if value.is_instance_of::<PySequence>() && !is_text(value) {
        let items = value.try_iter()?.enumerate();
        let items: PyResult<Vec<String>> =
            items.map(|(number, item)| flow(&item?, &place.inside(Step::Item(number)))).collect();
        return Ok(format!("[{}]", items?.join(", ")));
    }
    // Any other number of Python: a fraction, a decimal one.
    match value.extract::<f64>() {
        Ok(number) => float(py, number),
        Err(_) => {
            let message = format!("{place} is of type {}, which has no place in a file", kind(value));
            Err(wrong(py, format!("{message}\nhelp: write text, a number, a list or a dictionary")))
        }
    }
}

/// What is written as it is: nothing, yes and no, text, paths, numbers.
fn scalar(value: &Bound<'_, PyAny>, place: &Place<'_>) -> PyResult<Option<String>> {
    let py = value.py();
    if value.is_none() {
        return Ok(Some("null".to_owned()));
    }
    if let Ok(yes) = value.cast::<PyBool>() {
        return Ok(Some(if yes.is_true() { "true" } else { "false" }.to_owned()));
    }
    if value.is_instance_of::<PyInt>() {
        // The number alone: some kinds of whole numbers have names, which they show.
        return Ok(Some(py.get_type::<PyInt>().call_method1("__repr__", (value,))?.to_string()));
    }
    if value.is_instance_of::<PyFloat>() {
        return float(py, value.extract()?).map(Some);
    }
    let path = value.hasattr("__fspath__")?.then(|| value.call_method0("__fspath__")).transpose()?;
    let text = path.as_ref().unwrap_or(value);
    if path.is_none() && !text.is_instance_of::<PyString>() {
        return Ok(None);
    }
    Ok(Some(spelled(&arguments::text(text, &place.to_string())?)))
}

/// As Python writes it: the shortest text that is this number again.
fn float(py: Python<'_>, number: f64) -> PyResult<String> {
    Ok(PyFloat::new(py, number).repr()?.to_string())
}

/// The plain objects that an array or a number of another library stands for; none where it is no such thing, or where there are none of
/// its kind, as for times.
fn plain<'py>(value: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
    let array = match value.hasattr("tolist")? {
        true => value.clone(),
        false if value.hasattr("__array__")? => {
            value.py().import("numpy")?.call_method1("asarray", (value,))?
        }
        false => return Ok(None),
    };
    let kind = array.getattr("dtype").and_then(|dtype| dtype.getattr("kind")?.extract::<String>());
    if !kind.is_ok_and(|kind| ["b", "i", "u", "f", "U", "O"].contains(&kind.as_str())) {
        return Ok(None);
    }
    let plain = array.call_method0("tolist")?;
    Ok((!plain.get_type().is(value.get_type())).then_some(plain))
}

/// Words that some version of YAML takes for something else than text.
const WORDS: [&str; 9] = ["null", "true", "false", "yes", "no", "on", "off", "y", "n"];

/// Text as it is where every YAML takes it for itself, a name or a number with its unit, and else in double quotes.
fn spelled(text: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "_-+./ ^".contains(letter);
    let is_name = text.starts_with(|letter: char| letter.is_ascii_alphabetic())
        && !WORDS.iter().any(|word| text.eq_ignore_ascii_case(word));
    let number = text.trim_start_matches(['+', '-', '.']);
    let is_quantity = number.starts_with(|digit: char| digit.is_ascii_digit()) && text.contains(' ');
    if (is_name || is_quantity) && text.chars().all(plain) && text.trim() == text {
        return text.to_owned();
    }
    quoted(text)
}
