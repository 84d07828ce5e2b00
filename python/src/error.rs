//! What went wrong, for Python. In: a failure of the workshop, warnings. Out: `abbe.Error` with codes and places; warnings of Python.

use std::sync::{Mutex, PoisonError};

use model_dsl::diagnostic::{Diagnostic, Severity};
use model_dsl::source::SourceFile;
use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyUserWarning};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use workshop::failure::Failure;
use workshop::told::{Listener, Part, Words};

create_exception!(
    abbe,
    Error,
    PyException,
    "A file, an argument or the data are wrong.\n\n\
     `str(error)` is the text that the command line shows, with arguments in place of its options: the place, the words\n\
     there, what to write instead.\n\
     `error.text` is the same text; `error.code` the code of the first finding (`\"E0422\"`; `abbe.explain`\n\
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
    let text = failure.words().map(spoken).unwrap_or_default();
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

/// Options of the command line, and what a caller of Python writes in their place.
const OPTIONS: [(&str, &str); 12] = [
    ("--at", "at"),
    ("--counts", "counts"),
    ("--force", "force=True"),
    ("--known", "known"),
    ("--leave-out-uncompensable", "leave_out_uncompensable=True"),
    ("--name", "name"),
    ("--output", "output"),
    ("--points", "points"),
    ("--range", "ranges"),
    ("--tables", "tables"),
    ("--value", "value"),
    ("--write-calibration", "path"),
];

/// Words of the workshop as text: those of the command line, but that options are arguments.
fn spoken(words: &Words) -> String {
    let part = |part: &Part| match part {
        Part::Plain(text) => {
            OPTIONS.iter().fold(text.clone(), |text, (option, own)| text.replace(option, own))
        }
        Part::Marked { source, found } => Words::marked(source, found).text(false),
    };
    let parts: Vec<String> = words.parts().map(part).filter(|text| !text.is_empty()).collect();
    parts.join("\n")
}

fn told(py: Python<'_>, error: &PyErr, failure: &Failure, text: &str) -> PyResult<()> {
    let mut spans = Vec::new();
    for part in failure.words().into_iter().flat_map(Words::parts) {
        let Part::Marked { source, found } = part else { continue };
        for diagnostic in found.iter().filter(|one| one.severity == Severity::Error) {
            spans.push((diagnostic.code, place(py, source, diagnostic)?));
        }
    }
    let value = error.value(py);
    value.setattr("code", spans.first().map(|(code, _)| *code))?;
    value.setattr("spans", spans.into_iter().map(|(_, place)| place).collect::<Vec<_>>())?;
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
        self.take(spoken(words));
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
