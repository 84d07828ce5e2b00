//! `abbe.evaluate`, `abbe.explain`, and reports in general. In: recordings, names. Out: figures and words.

use evaluation::Inputs;
use pyo3::prelude::*;
use workshop::explain as pages;
use workshop::origin;

use crate::calibration::Calibration;
use crate::error::wrong;
use crate::page::framed;
use crate::recording::Recording;

/// What a command of Abbe reports: `str()` is its text, `data` the same as plain lists, dicts and numbers, `json` as JSON; `calibration` is
/// the calibration that it made, or None. A notebook shows its page, where it has one.
#[pyclass(module = "abbe", frozen)]
pub(crate) struct Report {
    pub(crate) title: &'static str,
    pub(crate) text: String,
    pub(crate) json: String,
    pub(crate) html: Option<String>,
    pub(crate) calibration: Option<Py<Calibration>>,
}

#[pymethods]
impl Report {
    /// The report as text, as the command prints it.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// The report as JSON, byte for byte what the command prints.
    #[getter]
    fn json(&self) -> &str {
        &self.json
    }

    /// The report as plain lists, dicts and numbers.
    #[getter]
    fn data<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        loads(py, &self.json)
    }

    /// The report as a page, or None.
    #[getter]
    fn html(&self) -> Option<&str> {
        self.html.as_deref()
    }

    /// The calibration that was made, or None.
    #[getter]
    fn calibration(&self, py: Python<'_>) -> Option<Py<Calibration>> {
        self.calibration.as_ref().map(|calibration| calibration.clone_ref(py))
    }

    fn _repr_html_(&self) -> Option<String> {
        self.html.as_deref().map(framed)
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        format!("<abbe.Report of {}>", self.title)
    }
}

/// JSON as objects of Python.
pub(crate) fn loads<'py>(py: Python<'py>, json: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (json,))
}

/// The standard figures of positioning and of circles in a recording (ISO 230-2, ISO 230-4, ISO 230-6), as `abbe evaluate` gives them.
///
/// >>> import abbe, numpy as np
/// >>> x = np.tile(np.repeat([0.0, 50.0, 100.0, 100.0, 50.0, 0.0], 3), 5)
/// >>> table = {"time": np.arange(len(x)) * 1.0, "command.x": x, "deviation": x * 1e-5}
/// >>> stage = abbe.Recording(table, machine="FX", instrument="linear", setup={"axis": "X", "direction": "+X"},
/// ...                        units={"time": "s", "command.x": "mm", "deviation": "mm"})
/// >>> abbe.evaluate(stage).data["schema"]
/// 'abbe-evaluation/1'
#[pyfunction]
pub(crate) fn evaluate(py: Python<'_>, recording: &Bound<'_, PyAny>) -> PyResult<Report> {
    let recording = Recording::taken(recording)?;
    let one = recording.get();
    let (recorded, path) = (one.recorded(), &one.text_file().path);
    let evaluation = py.detach(|| {
        evaluation::evaluate(&Inputs {
            equations: &recorded.equations,
            calibration: recorded.calibration.as_ref().map(|known| &known.calibration),
            recording: &recorded.recording,
        })
    });
    Ok(Report {
        title: "evaluate",
        text: evaluation::report::text(&evaluation),
        json: evaluation::report::json(&evaluation),
        html: Some(evaluation::report::html(&evaluation, &origin::evaluate(path))),
        calibration: None,
    })
}

/// What a diagnostic, a term, a factor or the name of an error motion means; without a name the list of all.
///
/// >>> import abbe
/// >>> print(abbe.explain("backlash").splitlines()[0])
/// backlash: a term of an error motion
#[pyfunction]
#[pyo3(signature = (name = None))]
pub(crate) fn explain(py: Python<'_>, name: Option<&str>) -> PyResult<String> {
    let Some(name) = name else { return Ok(pages::overview()) };
    pages::page(name).map_err(|near| {
        let help = match near.as_slice() {
            [] => "abbe.explain() alone lists all codes and terms".to_owned(),
            near => format!("did you mean {}?", near.join(" or ")),
        };
        wrong(
            py,
            format!("`{}` is no diagnostic, no term and no error motion\nhelp: {help}", name.escape_debug()),
        )
    })
}
