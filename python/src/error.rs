//! What went wrong, for Python. In: a failure of the workshop, warnings. Out: `abbe.Error` with codes and places; warnings of Python.

use std::sync::{Mutex, PoisonError};

use model_dsl::diagnostic::{Diagnostic, Severity};
use model_dsl::source::SourceFile;
use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyUserWarning};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use workshop::failure::Failure;
use workshop::told::{Listener, Part, Words};

create_exception!(
    abbe,
    Error,
    PyException,
    "A file, an argument or the data are wrong.\n\n\
     `str(error)` is the text that the command line shows: the place, the words there, what to write instead.\n\
     `error.text` is the same text; `error.code` the code of the first finding that has one (`\"E0422\"`; `abbe.explain`\n\
     tells more) or None; `error.spans` a list of places, a dict each with `code`, `message`, `help`, `file`, `line`,\n\
     `column`, `start`, `end` (lines and columns counted from 1, start and end in bytes of the file); `error.status` the\n\
     exit status of the command line: 1 where the data say no, 2 where a file or an argument is wrong."
);

create_exception!(
    abbe,
    AbbeWarning,
    PyUserWarning,
    "What a file probably does not mean, and what a reader of results should know."
);

/// A failure as an error of Python.
pub(crate) fn raised(py: Python<'_>, failure: &Failure) -> PyErr {
    let text = failure.words().map(|words| words.text(false)).unwrap_or_default();
    let error = Error::new_err(text.clone());
    match told(py, &error, failure, &text) {
        Ok(()) => error,
        Err(other) => other,
    }
}

/// A mistake in an argument.
pub(crate) fn wrong(py: Python<'_>, text: impl Into<String>) -> PyErr {
    raised(py, &Failure::wrong(format!("error: {}", text.into())))
}

fn told(py: Python<'_>, error: &PyErr, failure: &Failure, text: &str) -> PyResult<()> {
    let spans = PyList::empty(py);
    let mut code = None;
    for part in failure.words().into_iter().flat_map(Words::parts) {
        let Part::Marked { source, found } = part else { continue };
        for diagnostic in found.iter().filter(|one| one.severity == Severity::Error) {
            // What an outer file says comes first; the reason stands below, and has the code that helps.
            code = Some(diagnostic.code);
            spans.append(place(py, source, diagnostic)?)?;
        }
    }
    let first = spans.get_item(0).ok().map(|span| span.get_item("code")).transpose()?;
    let value = error.value(py);
    value.setattr("code", first.map_or_else(|| code.into_pyobject(py).map(Bound::into_any), Ok)?)?;
    value.setattr("spans", spans)?;
    value.setattr("text", text)?;
    value.setattr("status", if matches!(failure, Failure::No(_)) { 1 } else { 2 })
}

fn place<'py>(py: Python<'py>, source: &SourceFile, diagnostic: &Diagnostic) -> PyResult<Bound<'py, PyDict>> {
    let (line, column) = source.line_column(diagnostic.span.start);
    let place = PyDict::new(py);
    place.set_item("code", diagnostic.code)?;
    place.set_item("message", &diagnostic.message)?;
    place.set_item("help", diagnostic.help.as_deref())?;
    place.set_item("file", source.name())?;
    place.set_item("line", line)?;
    place.set_item("column", column)?;
    place.set_item("start", diagnostic.span.start)?;
    place.set_item("end", diagnostic.span.end)?;
    Ok(place)
}

/// Hears warnings while Python need not be there, and says them afterwards.
#[derive(Default)]
pub(crate) struct Heard {
    words: Mutex<Vec<String>>,
}

impl Heard {
    /// Takes a sentence.
    pub(crate) fn take(&self, text: String) {
        if !text.is_empty() {
            // What a thread left that panicked is as good as any other state.
            self.words.lock().unwrap_or_else(PoisonError::into_inner).push(text);
        }
    }

    /// Says all that was heard as warnings of Python; one that is turned into an error ends the call.
    pub(crate) fn say(self, py: Python<'_>) -> PyResult<()> {
        let words = self.words.into_inner().unwrap_or_else(PoisonError::into_inner);
        if words.is_empty() {
            return Ok(());
        }
        let warn = py.import("warnings")?.getattr("warn")?;
        for text in words {
            warn.call1((text, py.get_type::<AbbeWarning>()))?;
        }
        Ok(())
    }
}

impl Listener for Heard {
    fn hear(&self, words: &Words) {
        self.take(words.text(false));
    }
}

/// Does some work without holding Python, and says what was heard meanwhile.
pub(crate) fn working<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&Heard) -> Result<T, Failure> + Send,
) -> PyResult<T> {
    let heard = Heard::default();
    let done = py.detach(|| work(&heard));
    heard.say(py)?;
    done.map_err(|failure| raised(py, &failure))
}
