//! Files and what stands for them. In: a path, or a dictionary that says what the file would. Out: the text of a file, with the folder
//! that the names in it are counted from.
//!
//! A dictionary is written as the file it stands for and read like one, so that both are checked by the same rules, and a mistake is
//! shown at its place.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use model_dsl::source::SourceFile;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};
use workshop::failure::Failure;
use workshop::load;

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
    value.extract()
}

/// Reads a file, or writes out a dictionary under the name `called`.
pub(crate) fn text(value: &Bound<'_, PyAny>, called: &str) -> PyResult<Text> {
    let py = value.py();
    if let Ok(entries) = value.cast::<PyDict>() {
        let source = SourceFile::new(format!("<{called}>"), written(entries)?);
        return Ok(Text { source, path: PathBuf::from(called) });
    }
    let path = path(value)?;
    let source: Result<SourceFile, Failure> = py.detach(|| load::read(&path));
    Ok(Text { source: source.map_err(|failure| raised(py, &failure))?, path })
}

/// A dictionary as YAML: a line for each of its keys, and for each key of those that hold dictionaries.
pub(crate) fn written(entries: &Bound<'_, PyDict>) -> PyResult<String> {
    let mut text = String::new();
    for (key, value) in entries {
        let key = scalar(&key)?;
        match value.cast::<PyDict>() {
            Ok(inner) if !inner.is_empty() => {
                // Writing into a string cannot fail.
                let _ = writeln!(text, "{key}:");
                for (key, value) in inner {
                    let _ = writeln!(text, "  {}: {}", scalar(&key)?, flow(&value, 0)?);
                }
            }
            _ => {
                let _ = writeln!(text, "{key}: {}", flow(&value, 0)?);
            }
        }
    }
    Ok(text)
}

/// Deeper than any file goes; a list that holds itself has no end.
const DEEPEST: usize = 32;

/// A value on one line.
fn flow(value: &Bound<'_, PyAny>, depth: usize) -> PyResult<String> {
    let py = value.py();
    if depth > DEEPEST {
        return Err(wrong(py, "a dictionary holds others too deeply to be a file"));
    }
    let depth = depth.saturating_add(1);
    if let Ok(entries) = value.cast::<PyDict>() {
        let parts: PyResult<Vec<String>> = entries
            .iter()
            .map(|(key, value)| Ok(format!("{}: {}", scalar(&key)?, flow(&value, depth)?)))
            .collect();
        return Ok(format!("{{{}}}", parts?.join(", ")));
    }
    if is_scalar(value) {
        return scalar(value);
    }
    // Numbers of NumPy, and its arrays, say what they are in Python.
    if let Ok(plain) = value.call_method0("tolist") {
        return flow(&plain, depth);
    }
    let items = value.try_iter().map_err(|_| {
        let kind = value.get_type().name().map_or_else(|_| String::new(), |name| name.to_string());
        wrong(
            py,
            format!(
                "a value of type {kind} has no place in a file\nhelp: write text, a number, a list or a dict"
            ),
        )
    })?;
    let items: PyResult<Vec<String>> = items.map(|item| flow(&item?, depth)).collect();
    Ok(format!("[{}]", items?.join(", ")))
}

fn is_scalar(value: &Bound<'_, PyAny>) -> bool {
    value.is_none()
        || value.is_instance_of::<PyString>()
        || value.is_instance_of::<PyBool>()
        || value.is_instance_of::<PyInt>()
        || value.is_instance_of::<PyFloat>()
        || value.hasattr("__fspath__").unwrap_or(false)
}

fn scalar(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if value.is_none() {
        return Ok("null".to_owned());
    }
    if let Ok(yes) = value.cast::<PyBool>() {
        return Ok(if yes.is_true() { "true" } else { "false" }.to_owned());
    }
    if value.is_instance_of::<PyInt>() || value.is_instance_of::<PyFloat>() {
        // As Python writes them: the shortest text that is this number again.
        return Ok(value.repr()?.to_string());
    }
    let text = if value.is_instance_of::<PyString>() {
        value.extract::<String>()?
    } else {
        value.extract::<PathBuf>()?.display().to_string()
    };
    Ok(quoted(&text))
}

/// Text as it is where YAML takes it for itself, and else in double quotes.
fn quoted(text: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "_-+./ ^".contains(letter);
    let first =
        text.chars().next().is_some_and(|letter| letter.is_ascii_alphanumeric() || "+-./_".contains(letter));
    if first && text.chars().all(plain) && !text.ends_with(' ') && !text.starts_with("- ") && text != "-" {
        return text.to_owned();
    }
    let mut quoted = String::from('"');
    for letter in text.chars() {
        match letter {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            '\t' => quoted.push_str("\\t"),
            letter if letter.is_control() => {
                let _ = write!(quoted, "\\u{:04x}", u32::from(letter));
            }
            letter => quoted.push(letter),
        }
    }
    quoted.push('"');
    quoted
}
