//! `abbe.diagnose`. In: recordings of one machine. Out: what the model leaves out, in tables, arrays and words, as a page, and as a better
//! calibration.

use std::path::{Path, PathBuf};

use ::diagnosis::Progress;
use ::diagnosis::diagnosis::{Diagnosis as Found, Finding, Parameter, ParameterValue};
use ::diagnosis::report::{self, Origin};
use ::diagnosis::traces::Trace;
use model_dsl::source::SourceFile;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use workshop::diagnosed::{self, Keep};
use workshop::improved::{self, Improved};
use workshop::named::{self, Files};
use workshop::origin;
use workshop::recorded::{self, Recorded};

use crate::calibration::Calibration;
use crate::error::{raised, working, wrong};
use crate::file::{self, Text};
use crate::page::framed;
use crate::recording::Recording;
use crate::report::loads;
use crate::running;

/// Finds what the model of a machine leaves out, from recordings of the real one, which are fitted together; `holdout` is one more that is
/// not fitted, on which the findings are tested. `watch` is called with what is being done and the share that is done, 0 to 1.
///
/// `abbe.diagnose` calls it with a bar where a person watches.
///
/// >>> import abbe, numpy as np
/// >>> t = np.arange(4000) * 0.01
/// >>> x = 50 - 50 * np.cos(np.pi * t / 4)
/// >>> noise = np.random.default_rng(1).normal(0, 0.0003, len(t))
/// >>> table = {"time": t, "command.x": x, "measured.x": x - 0.005 * np.sign(np.sin(np.pi * t / 4)) + noise}
/// >>> stage = abbe.Recording(table, machine="FX", units={"time": "s", "command.x": "mm", "measured.x": "mm"})
/// >>> found = abbe.diagnose(stage, progress=False)
/// >>> found.verdict, found.findings["term"]
/// ('left-out-physics', ['backlash'])
#[pyfunction]
#[pyo3(signature = (recordings, holdout = None, watch = None))]
pub(crate) fn diagnose(
    py: Python<'_>,
    recordings: &Bound<'_, PyAny>,
    holdout: Option<&Bound<'_, PyAny>>,
    watch: Option<&Bound<'_, PyAny>>,
) -> PyResult<Diagnosis> {
    let mut all = Recording::all_taken(recordings)?;
    let fitted = all.len();
    all.extend(holdout.map(Recording::taken).transpose()?);
    if fitted == 0 {
        return Err(wrong(py, "there is no recording to diagnose"));
    }
    let mut together: Vec<Recorded> = Vec::new();
    for one in &all {
        recorded::add(&mut together, one.get().recorded().clone()).map_err(|failure| raised(py, &failure))?;
    }
    let inputs: Vec<Text> = all.iter().map(|one| one.get().text_file().clone()).collect();
    let job = move |show: &mut dyn FnMut(Progress)| {
        let (fit, held) = together.split_at(fitted.min(together.len()));
        let found = diagnosed::diagnose(fit, held.first(), Keep::Traces, show);
        (together, found)
    };
    let (recorded, found) = running::run(py, watch, job)?;
    let mut found = found.map_err(|failure| raised(py, &failure))?;
    let traces = std::mem::take(&mut found.traces).into_iter().map(|trace| Arrays::of(py, trace)).collect();
    Ok(Diagnosis { found, traces, recorded, inputs, fitted })
}

/// What was found in recordings.
///
/// Tables (`findings`, `parameters`, `returns`) are dicts of columns of one length, which `pandas.DataFrame` and `polars.DataFrame` take as
/// they are. Arrays of samples are as long as the recording, mm or rad, NaN where nothing was measured or a row is left out. `str()` is
/// the text of `abbe diagnose`; a notebook shows its page.
///
/// In the examples of its methods `found` is what the example of `abbe.diagnose` has found.
#[pyclass(module = "abbe", frozen)]
pub(crate) struct Diagnosis {
    found: Found,
    traces: Vec<Arrays>,
    recorded: Vec<Recorded>,
    inputs: Vec<Text>,
    /// How many of the recordings were fitted; the one after them was held out.
    fitted: usize,
}

/// A number with its interval and unit.
type Number<'d> = (f64, (f64, f64), &'d str);

/// A row of the table of parameters.
type ParameterRow<'d> = (usize, &'d Finding, String, f64, (f64, f64), &'d str);

/// One channel of one recording.
struct Arrays {
    recording: usize,
    channel: String,
    unit: &'static str,
    time: Py<PyArray1<f64>>,
    run: Py<PyArray1<i64>>,
    measured: Py<PyArray1<f64>>,
    before: Py<PyArray1<f64>>,
    after: Py<PyArray1<f64>>,
    held_out: Py<PyArray1<bool>>,
    outlier: Py<PyArray1<bool>>,
}

impl Arrays {
    fn of(py: Python<'_>, trace: Trace) -> Self {
        Self {
            recording: trace.recording,
            channel: trace.channel,
            unit: trace.unit,
            time: trace.time.into_pyarray(py).unbind(),
            run: trace.run.into_pyarray(py).unbind(),
            measured: trace.measured.into_pyarray(py).unbind(),
            before: trace.before.into_pyarray(py).unbind(),
            after: trace.after.into_pyarray(py).unbind(),
            held_out: trace.held_out.into_pyarray(py).unbind(),
            outlier: trace.outlier.into_pyarray(py).unbind(),
        }
    }
}

#[pymethods]
impl Diagnosis {
    /// The verdict: `undecided`, `adequate`, `left-out-physics`, `unexplained` or `not-repeatable`.
    #[getter]
    fn verdict(&self) -> &'static str {
        self.found.verdict.word()
    }

    /// The verdict as a sentence.
    #[getter]
    fn sentence(&self) -> String {
        report::verdict(&self.found)
    }

    /// The findings, in order of share: a table with the columns `motion`, `meaning`, `term`, `link`, `side`, `state`, `detail`, `share`
    /// (of the explainable held-out variance), `rms_with` and `rms_without` (of held-out samples, in `unit`), `unit`, `compensable`,
    /// `explanation`.
    #[getter]
    fn findings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = &self.found.findings;
        let table = PyDict::new(py);
        let text = |of: &dyn Fn(&Finding) -> String| all.iter().map(of).collect::<Vec<String>>();
        let number = |of: &dyn Fn(&Finding) -> f64| all.iter().map(of).collect::<Vec<f64>>().into_pyarray(py);
        table.set_item("motion", text(&|one| one.motion.clone()))?;
        table.set_item("meaning", text(&|one| one.motion_meaning.clone()))?;
        table.set_item("term", text(&|one| one.term.to_owned()))?;
        table.set_item("link", text(&|one| one.location.link.clone()))?;
        table.set_item("side", text(&|one| one.location.side.to_owned()))?;
        table.set_item("state", text(&|one| one.location.state.to_owned()))?;
        table.set_item("detail", text(&|one| one.location.detail.clone()))?;
        table.set_item("share", number(&|one| one.share))?;
        table.set_item("rms_with", number(&|one| one.evidence.with))?;
        table.set_item("rms_without", number(&|one| one.evidence.without))?;
        table.set_item("unit", text(&|one| one.evidence.unit.to_owned()))?;
        let compensable: Vec<bool> = all.iter().map(|one| one.compensable).collect();
        table.set_item("compensable", compensable.into_pyarray(py))?;
        table.set_item("explanation", text(&|one| one.explanation.clone()))?;
        Ok(table)
    }

    /// The numbers of the findings, a row each: a table with the columns `finding` (its row in `findings`), `motion`, `term`, `parameter`,
    /// `value`, `low`, `high` (the 95 % interval) and `unit`. A parameter that is a list has a row for each of its numbers.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mut rows: Vec<ParameterRow<'_>> = Vec::new();
        for (number, finding) in self.found.findings.iter().enumerate() {
            for Parameter { name, value } in &finding.parameters {
                let fitted: Vec<Number<'_>> = match value {
                    ParameterValue::Name(_) | ParameterValue::Places(..) => Vec::new(),
                    ParameterValue::Given(value, unit) => vec![(*value, (*value, *value), unit.as_str())],
                    ParameterValue::Fitted(one) => vec![(one.value, one.ci95, one.unit.as_str())],
                    ParameterValue::List(list) => {
                        list.iter().map(|one| (one.value, one.ci95, one.unit.as_str())).collect()
                    }
                };
                rows.extend(fitted.into_iter().map(|(value, (one, other), unit)| {
                    (number, finding, (*name).to_owned(), value, (one.min(other), one.max(other)), unit)
                }));
            }
        }
        let table = PyDict::new(py);
        table.set_item("finding", rows.iter().map(|row| row.0).collect::<Vec<_>>())?;
        table.set_item("motion", rows.iter().map(|row| row.1.motion.as_str()).collect::<Vec<_>>())?;
        table.set_item("term", rows.iter().map(|row| row.1.term).collect::<Vec<_>>())?;
        table.set_item("parameter", rows.iter().map(|row| row.2.as_str()).collect::<Vec<_>>())?;
        table.set_item("value", rows.iter().map(|row| row.3).collect::<Vec<_>>().into_pyarray(py))?;
        table.set_item("low", rows.iter().map(|row| row.4.0).collect::<Vec<_>>().into_pyarray(py))?;
        table.set_item("high", rows.iter().map(|row| row.4.1).collect::<Vec<_>>().into_pyarray(py))?;
        table.set_item("unit", rows.iter().map(|row| row.5).collect::<Vec<_>>())?;
        Ok(table)
    }

    /// What comes back in units that were not fitted, before any name: a table with the columns `recording` (its number), `channel`,
    /// `state`, `share`, `left` (the rms that no function of the state takes away) and `unit`.
    #[getter]
    fn returns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = &self.found.returns;
        let table = PyDict::new(py);
        table.set_item("recording", all.iter().map(|one| one.recording).collect::<Vec<_>>())?;
        table.set_item("channel", all.iter().map(|one| one.channel.as_str()).collect::<Vec<_>>())?;
        table.set_item("state", all.iter().map(|one| one.state.as_str()).collect::<Vec<_>>())?;
        table.set_item("share", all.iter().map(|one| one.share).collect::<Vec<_>>().into_pyarray(py))?;
        table.set_item("left", all.iter().map(|one| one.left).collect::<Vec<_>>().into_pyarray(py))?;
        table.set_item("unit", all.iter().map(|one| one.unit).collect::<Vec<_>>())?;
        Ok(table)
    }

    /// The whole diagnosis as plain lists, dicts and numbers: the object `abbe-diagnosis/1`, with `noise`, `before`, `after`, `findings`,
    /// `instrument`, `unexplained` and the rest.
    #[getter]
    fn data<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        loads(py, &self.json())
    }

    /// The same as JSON, byte for byte what `abbe diagnose --format json` prints.
    #[getter]
    fn json(&self) -> String {
        report::json(&self.found)
    }

    /// The text of `abbe diagnose`.
    #[getter]
    fn text(&self) -> String {
        report::text(&self.found)
    }

    /// The page of `abbe diagnose --format html`.
    #[getter]
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        let (Some(first), Some(text)) = (self.recorded.first(), self.inputs.first()) else {
            return Ok(String::new());
        };
        let change = improved::change(first, &Files::of(first, &text.path), &self.found);
        let held_out = self.inputs.get(self.fitted).map(|held| held.path.as_path());
        let command =
            origin::diagnose(self.inputs.iter().take(self.fitted).map(|one| one.path.as_path()), held_out);
        let files = self.inputs.iter().all(|one| one.path.is_file());
        Ok(report::html(
            &self.found,
            &Origin {
                command: if files { &command } else { "" },
                program: concat!("abbe ", env!("CARGO_PKG_VERSION")),
                change: &change.map_err(|failure| raised(py, &failure))?,
            },
        ))
    }

    /// The names of the channels of a recording that the diagnosis looked at, with their units, mm or rad.
    ///
    /// >>> found.units()
    /// {'measured.x': 'mm'}
    #[pyo3(signature = (recording = 0))]
    fn units<'py>(&self, py: Python<'py>, recording: usize) -> PyResult<Bound<'py, PyDict>> {
        self.each(py, recording, |arrays| Ok(arrays.unit.into_pyobject(py)?.into_any()))
    }

    /// Measured minus predicted: a dict with an array for each channel of a recording, `before` (the calibration alone, the free settings of
    /// the instrument fitted) or `after` (with the findings). The recording that is held out as a whole is the last.
    ///
    /// >>> before, after = (found.residual(when)["measured.x"] for when in ("before", "after"))
    /// >>> before.shape, bool(after.std() < 0.1 * before.std())
    /// ((4000,), True)
    #[pyo3(signature = (when = "after", recording = 0))]
    fn residual<'py>(&self, py: Python<'py>, when: &str, recording: usize) -> PyResult<Bound<'py, PyDict>> {
        let after = is_after(py, when)?;
        self.each(py, recording, |arrays| Ok(arrays.left(after).bind(py).clone().into_any()))
    }

    /// What the model predicts in place of what was measured: a dict with an array for each channel of a recording, `before` or `after`.
    ///
    /// >>> bool(abs(found.model()["measured.x"] + found.residual()["measured.x"] - found.measured()["measured.x"]).max() < 1e-12)
    /// True
    #[pyo3(signature = (when = "after", recording = 0))]
    fn model<'py>(&self, py: Python<'py>, when: &str, recording: usize) -> PyResult<Bound<'py, PyDict>> {
        let after = is_after(py, when)?;
        self.each(py, recording, |arrays| arrays.measured.bind(py).as_any().sub(arrays.left(after).bind(py)))
    }

    /// What was measured: a dict with an array for each channel of a recording.
    ///
    /// >>> found.measured()["measured.x"].dtype
    /// dtype('float64')
    #[pyo3(signature = (recording = 0))]
    fn measured<'py>(&self, py: Python<'py>, recording: usize) -> PyResult<Bound<'py, PyDict>> {
        self.each(py, recording, |arrays| Ok(arrays.measured.bind(py).clone().into_any()))
    }

    /// The samples that were left out as outliers: a dict with an array of bool for each channel of a recording.
    ///
    /// >>> found.outliers()["measured.x"].dtype
    /// dtype('bool')
    #[pyo3(signature = (recording = 0))]
    fn outliers<'py>(&self, py: Python<'py>, recording: usize) -> PyResult<Bound<'py, PyDict>> {
        self.each(py, recording, |arrays| Ok(arrays.outlier.bind(py).clone().into_any()))
    }

    /// The rows of a recording: a dict of the arrays `time` (s since its first row), `run` and `held_out` (nothing was fitted to them).
    ///
    /// >>> sorted(found.states())
    /// ['held_out', 'run', 'time']
    #[pyo3(signature = (recording = 0))]
    fn states<'py>(&self, py: Python<'py>, recording: usize) -> PyResult<Bound<'py, PyDict>> {
        let states = PyDict::new(py);
        if let Some(arrays) = self.of_recording(py, recording)?.next() {
            states.set_item("time", arrays.time.bind(py))?;
            states.set_item("run", arrays.run.bind(py))?;
            states.set_item("held_out", arrays.held_out.bind(py))?;
        }
        Ok(states)
    }

    /// The known calibration with what was found: faults of the files mended, findings added. With `path` it is written there, as `abbe
    /// diagnose --write-calibration` does; a file that is there is replaced as a whole.
    ///
    /// >>> better = found.calibration()
    /// >>> (better.error([[0.0], [50.0], [20.0]])[:, 0] * 1000).round()
    /// array([-5., -5.,  5.])
    #[pyo3(signature = (path = None))]
    fn calibration(&self, py: Python<'_>, path: Option<&Bound<'_, PyAny>>) -> PyResult<Calibration> {
        let (Some(first), Some(text)) = (self.recorded.first(), self.inputs.first()) else {
            return Err(wrong(py, "there is no recording"));
        };
        let files = Files::of(first, &text.path);
        match path {
            Some(path) => {
                let target = file::path(path)?;
                working(py, |heard| {
                    let inputs = self.recorded.iter().zip(&self.inputs);
                    let inputs: Vec<(Files, &Recorded)> =
                        inputs.map(|(recorded, text)| (Files::of(recorded, &text.path), recorded)).collect();
                    named::check_target(&target, &inputs)?;
                    improved::write(&target, first, &files, &self.found, heard)
                })?;
                Calibration::of(py, file::text(path, "calibration")?)
            }
            None => {
                let target = beside(&text.path);
                let Improved { text, machine } = improved::calibration(&target, first, &files, &self.found)
                    .map_err(|failure| raised(py, &failure))?;
                if machine.is_some() {
                    return Err(wrong(
                        py,
                        "the machine's chain has another order than its file says: both are new files\nhelp: give a path, beside which the machine file is written too",
                    ));
                }
                Calibration::of(py, Text { source: SourceFile::new("<calibration>", text), path: target })
            }
        }
    }

    fn __str__(&self) -> String {
        self.text()
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        Ok(framed(&self.html(py)?))
    }

    fn __repr__(&self) -> String {
        let findings = self.found.findings.iter().map(|one| format!("{} of {}", one.term, one.motion));
        let findings = findings.collect::<Vec<String>>().join(", ");
        format!(
            "<abbe.Diagnosis of {}: {}{}{findings}>",
            self.found.machine,
            self.verdict(),
            if findings.is_empty() { "" } else { ": " }
        )
    }
}

impl Diagnosis {
    fn of_recording(&self, py: Python<'_>, recording: usize) -> PyResult<impl Iterator<Item = &Arrays>> {
        if recording >= self.recorded.len() {
            let last = self.recorded.len().saturating_sub(1);
            return Err(wrong(py, format!("there is no recording {recording}: they are 0 to {last}")));
        }
        Ok(self.traces.iter().filter(move |arrays| arrays.recording == recording))
    }

    fn each<'py>(
        &self,
        py: Python<'py>,
        recording: usize,
        of: impl Fn(&Arrays) -> PyResult<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        for arrays in self.of_recording(py, recording)? {
            all.set_item(&arrays.channel, of(arrays)?)?;
        }
        Ok(all)
    }
}

impl Arrays {
    fn left(&self, after: bool) -> &Py<PyArray1<f64>> {
        if after { &self.after } else { &self.before }
    }
}

fn is_after(py: Python<'_>, when: &str) -> PyResult<bool> {
    match when {
        "before" => Ok(false),
        "after" => Ok(true),
        other => Err(wrong(py, format!("`before` or `after`, not `{other}`"))),
    }
}

/// A file beside another that is not there.
fn beside(path: &Path) -> PathBuf {
    path.with_file_name("calibration")
}
