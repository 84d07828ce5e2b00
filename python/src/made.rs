//! `abbe.simulate`, `abbe.calibrate` and `abbe.update`: what makes recordings and calibrations. In: calibrations, paths, set-ups,
//! recordings. Out: a recording; a report with a calibration.

use std::path::{Path, PathBuf};

use ::update::{Method, Options};
use exchange::instrument::report as instruments;
use model_dsl::source::SourceFile;
use pyo3::prelude::*;
use simulation::Simulated;
use simulation::write::{self, Head};
use workshop::failure::Failure;
use workshop::recorded::{self, Recorded};
use workshop::set_up::SetUp;
use workshop::simulated::{self, Output};
use workshop::updated;
use workshop::written::{self, check_folder, check_new, folder};

use crate::calibration::Calibration;
use crate::error::{Heard, raised, working, wrong};
use crate::file::{self, Text};
use crate::recording::Recording;
use crate::report::Report;

/// What a calibration predicts: the recording that would be read along a path, with the noise of its instrument, or in place of a recording,
/// without noise.
///
/// `path` is a path file, a dictionary that says the same, or a `Recording`. `seed` is that of the noise, in place of the path's; the same
/// seed gives the same numbers. `known` is the file of the calibration that the new recording counts on; what it lacks is concealed.
/// `output` is the folder that `recording.yaml` and `data.csv` are written into, or the recording's own file; without it nothing is
/// written. Numbers have the nine decimal places of the file.
///
/// >>> import abbe
/// >>> stage = abbe.Calibration({"calibration": 1, "machine": "FX", "errors": {"EXX": [{"backlash": {"lost_motion": "10 um"}}]}})
/// >>> path = {"path": 1, "line": {"axis": "X", "from": "0 mm", "to": "20 mm"}, "feed": "1000 mm/min", "rate": "100 Hz",
/// ...         "instrument": "position", "noise": "0.2 um", "seed": 1}
/// >>> recording = abbe.simulate(stage, path)
/// >>> recording.channels
/// ['time', 'run', 'command.x', 'measured.x', 'measured.y', 'measured.z']
#[pyfunction]
#[pyo3(signature = (calibration, path, *, seed = None, known = None, output = None, force = false))]
pub(crate) fn simulate(
    calibration: &Bound<'_, PyAny>,
    path: &Bound<'_, PyAny>,
    seed: Option<u64>,
    known: Option<&Bound<'_, PyAny>>,
    output: Option<&Bound<'_, PyAny>>,
    force: bool,
) -> PyResult<Recording> {
    let py = calibration.py();
    let calibration = Calibration::taken(calibration)?;
    let one = calibration.get();
    let (calibrated, calibration_path) = (one.calibrated(), one.path());
    let known = known.map(file::path).transpose()?;
    let known = known.map(|path| {
        working(py, |heard| simulated::known_calibration(&path, &calibrated.equations.names(), heard))
    });
    let known = known.transpose()?;
    let output = output.map(file::path).transpose()?.map(|path| Output::of(&path));
    let driven = Driven::read(path)?;
    if let Some(output) = &output {
        let source = driven.source();
        let of_path = (source, Path::new(source.name()));
        let read = simulated::files_read((calibrated, calibration_path), known.as_deref(), of_path);
        output.check(&read, force).map_err(|failure| raised(py, &failure))?;
    }
    let predicted = match driven {
        Driven::Path(source) => working(py, |heard| simulated::driven(&source, calibrated, seed, heard))?,
        Driven::Recording(_) if seed.is_some() => {
            return Err(wrong(
                py,
                "the path is a recording\nhelp: leave seed out: what a calibration predicts for a recording has no noise",
            ));
        }
        Driven::Recording(recorded) => {
            working(py, |heard| simulated::replayed(&recorded, (calibrated, calibration_path), heard))?
        }
    };
    if let Some(output) = output {
        working(py, |_| {
            let folder = output.folder()?;
            let head = output.head((calibrated, calibration_path), known.as_deref(), &folder)?;
            output.write(&predicted, &head)
        })?;
        return Recording::of_file(py, output.recording);
    }
    let folder = folder(calibration_path);
    let head = Output::of(&folder).head((calibrated, calibration_path), known.as_deref(), &folder);
    let head = head.map_err(|failure| raised(py, &failure))?;
    let text = Text {
        source: SourceFile::new("<simulated>", write::recording(&predicted, &head)),
        path: folder.join("recording"),
    };
    let recorded = working(py, |heard| read_again(&text, &predicted, &head, heard))?;
    Ok(Recording::of_recorded(recorded, text))
}

/// What the files of a simulated recording say, without the files.
fn read_again(text: &Text, predicted: &Simulated, head: &Head, heard: &Heard) -> Result<Recorded, Failure> {
    let mut table = Vec::new();
    write::table(predicted, &head.axes, &mut table)
        .map_err(|error| Failure::io("cannot write the table", &error))?;
    let data = |header: &::recording::Header| header.read_csv("<simulated>", table.as_slice());
    recorded::of(text.source.clone(), text.folder(), data, heard)
}

/// What is driven.
enum Driven {
    Path(SourceFile),
    Recording(Box<Recorded>),
}

impl Driven {
    fn read(path: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(recording) = path.cast::<Recording>() {
            return Ok(Self::Recording(Box::new(recording.get().recorded().clone())));
        }
        let text = file::text(path, "path")?;
        if simulated::is_recording(&text.source) {
            let recording = Recording::of_file(path.py(), text.path)?;
            return Ok(Self::Recording(Box::new(recording.recorded().clone())));
        }
        Ok(Self::Path(text.source))
    }

    fn source(&self) -> &SourceFile {
        match self {
            Self::Path(source) => source,
            Self::Recording(recorded) => &recorded.source,
        }
    }
}

/// Makes a calibration from instruments' files (lasers, levels, straightedges), or from what a controller corrects already, as `abbe
/// calibrate` does. `setup` is a set-up file, or a dictionary that says the same, whose names are counted from the current folder; `output`
/// is the calibration file to write, which replaces one that is there only with `force`. The report's `calibration` is the new one.
///
/// >>> import abbe, pathlib, tempfile
/// >>> folder = tempfile.TemporaryDirectory()
/// >>> data = pathlib.Path(folder.name, "x.csv")
/// >>> _ = data.write_text("target,deviation\n0,0\n100,2\n200,5\n")
/// >>> setup = {"setup": 1, "machine": "FX", "measurements": [{"motion": "EXX", "data": str(data),
/// ...     "targets": {"origin": "0 mm", "sign": +1, "unit": "mm"}, "deviations": {"sign": +1, "unit": "um"}}]}
/// >>> made = abbe.calibrate(setup)
/// >>> made.calibration.error([[200.0]])[0, 0]
/// np.float64(0.005)
#[pyfunction]
#[pyo3(signature = (setup, output = None, *, force = false))]
pub(crate) fn calibrate(
    setup: &Bound<'_, PyAny>,
    output: Option<&Bound<'_, PyAny>>,
    force: bool,
) -> PyResult<Report> {
    let py = setup.py();
    let text = file::text(setup, "setup")?;
    let output = output.map(file::path).transpose()?;
    let (report, calibration) = working(py, |heard| {
        let read = SetUp::read(text.source.clone(), &text.path, heard)?;
        if let Some(target) = &output {
            check_folder(target, "output")?;
            check_new(target, ("output", "calibration.yaml"), &read.files(), force)?;
        }
        let outcome = read.outcome(heard)?;
        let target = output.clone().unwrap_or_else(|| text.path.with_file_name("calibration"));
        let calibration = read.calibration(&target, &outcome)?;
        if output.is_some() {
            written::calibration(&target, &calibration, &read.equations)?;
        }
        let told =
            (instruments::text(&outcome, &read.equations), instruments::json(&outcome, &read.equations));
        Ok((told, made(target, calibration)))
    })?;
    told(py, "calibrate", report, calibration)
}

/// Changes the coefficients of a calibration to what measured parts show, as `abbe update` does: `recordings` are those of the parts, by a
/// probe with normals or as positions.
///
/// `method` is `svd`, `ridge` or `select`; `tolerance` the share of the matrix's norm up to which singular values count as zero; `datum`
/// says in which directions the zero of a part is free: `free`, `turned` (and turned too), `none`, or some such as `z` or `x,z`;
/// `compensated` that the parts were made with this calibration's compensation switched on. `output` is the calibration file to write.
/// The report's `calibration` is the new one.
///
/// >>> import abbe, numpy as np
/// >>> known = {"calibration": 1, "machine": "FX", "errors": {"EXX": [{"polynomial": {"axis": "X", "per": "mm", "unit": "um",
/// ...          "coefficients": [0, 0.01]}}]}}
/// >>> x = np.linspace(0, 200, 41)
/// >>> table = {"time": np.arange(41.0), "command.x": x, "measured.x": x + 20e-6 * x}
/// >>> part = abbe.Recording(table, machine="FX", units={"time": "s", "command.x": "mm", "measured.x": "mm"})
/// >>> updated = abbe.update(abbe.Calibration(known), part)
/// >>> updated.data["schema"]
/// 'abbe-update/1'
#[pyfunction]
#[pyo3(signature = (calibration, recordings, output = None, *, force = false, method = "svd", tolerance = None, datum = "free",
                    compensated = false))]
#[expect(clippy::too_many_arguments, reason = "each is a name for the caller")]
pub(crate) fn update(
    calibration: &Bound<'_, PyAny>,
    recordings: &Bound<'_, PyAny>,
    output: Option<&Bound<'_, PyAny>>,
    force: bool,
    method: &str,
    tolerance: Option<f64>,
    datum: &str,
    compensated: bool,
) -> PyResult<Report> {
    let py = calibration.py();
    let datum = updated::datum(datum).map_err(|reason| wrong(py, reason))?;
    let method = match method {
        "svd" => Method::Svd,
        "ridge" => Method::Ridge,
        "select" => Method::Select,
        other => {
            return Err(wrong(
                py,
                format!("there is no method `{other}`\nhelp: methods are svd, ridge, select"),
            ));
        }
    };
    let options = Options { method, tolerance, datum: datum.displaced, compensated };
    let mut parts = Vec::new();
    let all = Recording::all_taken(recordings)?;
    for one in &all {
        recorded::add(&mut parts, one.get().recorded().clone()).map_err(|failure| raised(py, &failure))?;
    }
    if datum.turned {
        parts.iter_mut().for_each(|part| part.recording.datum = ::recording::PartDatum::Free);
    }
    let calibration = Calibration::taken(calibration)?;
    let one = calibration.get();
    let (known, path) = (one.calibrated(), one.path());
    let output = output.map(file::path).transpose()?;
    let paths: Vec<PathBuf> = all.iter().map(|one| one.get().text_file().path.clone()).collect();
    let read = updated::files((known, path), parts.iter().zip(paths.iter().map(PathBuf::as_path)));
    let (report, calibration) = working(py, |heard| {
        updated::check_machine((known, path), &parts, heard)?;
        if let Some(target) = &output {
            check_folder(target, "output")?;
            check_new(target, ("output", "calibration.yaml"), &read, force)?;
        }
        let done = updated::update(known, &parts, &options, heard)?;
        let target = output.clone().unwrap_or_else(|| path.with_file_name("calibration"));
        let text = updated::text(&target, (known, path), &done)?;
        if output.is_some() {
            written::calibration(&target, &text, &known.equations)?;
        }
        Ok(((::update::report::text(&done), ::update::report::json(&done)), made(target, text)))
    })?;
    told(py, "update", report, calibration)
}

/// A calibration that was made and stands, or would stand, at a place.
fn made(target: PathBuf, text: String) -> Text {
    let name = if target.is_file() { target.display().to_string() } else { "<calibration>".to_owned() };
    Text { source: SourceFile::new(name, text), path: target }
}

fn told(
    py: Python<'_>,
    title: &'static str,
    (text, json): (String, String),
    calibration: Text,
) -> PyResult<Report> {
    let calibration = Some(Py::new(py, Calibration::of(py, calibration)?)?);
    Ok(Report { title, text, json, html: None, calibration })
}
