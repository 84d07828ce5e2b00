//! `abbe.export`. In: a calibration, and what the caller says of the controller. Out: the files that the controller loads.

use std::path::PathBuf;

use exchange::controller::{Geometry, Kind, Options, Sense, Space, Unit, Wanted};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use workshop::calibrated::Calibrated;
use workshop::exported::{self, FORMATS, TABLES};
use workshop::failure::Failure;

use crate::arguments::{self, Entries};
use crate::calibration::Calibration;
use crate::error::{raised, working, wrong};
use crate::file;
use crate::space;

/// The files that a controller loads: `files` holds their texts by name, `str()` is the report of `abbe export`: what each file is, how it
/// is loaded, and what it cannot carry.
#[pyclass(module = "abbe", frozen)]
pub(crate) struct Exported {
    files: Vec<(String, String)>,
    text: String,
}

#[pymethods]
impl Exported {
    /// The text of each file by its name.
    #[getter]
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let files = PyDict::new(py);
        for (name, text) in &self.files {
            files.set_item(name, text)?;
        }
        Ok(files)
    }

    /// The report of `abbe export`.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        let names: Vec<&str> = self.files.iter().map(|(name, _)| name.as_str()).collect();
        format!("<abbe.Exported: {}>", names.join(", "))
    }
}

/// Makes the files that a controller loads from a calibration: `format` is `linuxcnc`, `isg`, `etalon`, `sinumerik`, `heidenhain`, `pmac`,
/// `marlin`, `klipper` or `reprap`. They are written into the folder `output` where one is given, all of them or none; files that are
/// there are replaced only with `force`.
///
/// `ranges` says how far axes go, `{"X": (0, 500)}`, and `at` where they stand while the tables of others are made, mm or deg; `points` how
/// many points a table has; `value` what its numbers are where no public document says it, `error` or `correction`. `type` (0 or 1) and
/// `unit` (`mm` or `in`) are LinuxCNC's, `tables` is Sinumerik's, `name` (`{"X": "MX1"}`) and `counts` (`{"X": 10000}`) are the
/// controller's own.
///
/// >>> import abbe
/// >>> stage = abbe.Calibration({"calibration": 1, "machine": "FX",
/// ...     "errors": {"EXX": [{"table": {"axis": "X", "start": "0 mm", "step": "50 mm", "unit": "um", "values": [0, 3, 5]}}]}})
/// >>> list(abbe.export("linuxcnc", stage).files)
/// ['x.comp']
#[pyfunction]
#[pyo3(signature = (format, calibration, output = None, *, force = false, ranges = None, at = None, points = None, value = None,
                    r#type = None, unit = None, tables = None, name = None, counts = None, leave_out_uncompensable = false))]
#[expect(clippy::too_many_arguments, reason = "each is a name for the caller")]
pub(crate) fn export(
    py: Python<'_>,
    format: &str,
    calibration: &Bound<'_, PyAny>,
    output: Option<&Bound<'_, PyAny>>,
    force: bool,
    ranges: Option<Entries<'_>>,
    at: Option<Entries<'_>>,
    points: Option<usize>,
    value: Option<&str>,
    r#type: Option<u8>,
    unit: Option<&str>,
    tables: Option<usize>,
    name: Option<Entries<'_>>,
    counts: Option<Entries<'_>>,
    leave_out_uncompensable: bool,
) -> PyResult<Exported> {
    let Some((_, format)) = FORMATS.iter().find(|(known, _)| *known == format) else {
        let all: Vec<&str> = FORMATS.iter().map(|(known, _)| *known).collect();
        return Err(wrong(
            py,
            format!("there is no format `{format}`\nhelp: formats are {}", all.join(", ")),
        ));
    };
    let given = [
        ("type", r#type.is_some()),
        ("unit", unit.is_some()),
        ("value", value.is_some()),
        ("tables", tables.is_some()),
        ("name", name.is_some()),
        ("counts", counts.is_some()),
    ];
    let given: Vec<&str> = given.iter().filter(|(_, given)| *given).map(|(name, _)| *name).collect();
    let one_of = |what: &str, all: &str| wrong(py, format!("`{what}` is {all}"));
    let options = Options {
        points,
        kind: match r#type {
            None | Some(1) => Kind::Trim,
            Some(0) => Kind::Actual,
            Some(_) => return Err(one_of("type", "0 or 1")),
        },
        unit: match unit {
            None | Some("mm") => Unit::MM,
            Some("in") => Unit::INCH,
            Some(_) => return Err(one_of("unit", "mm or in")),
        },
        sense: match value {
            None => None,
            Some("error") => Some(Sense::Error),
            Some("correction") => Some(Sense::Correction),
            Some(_) => return Err(one_of("value", "error or correction")),
        },
        tables: tables.unwrap_or(TABLES),
        names: names(name.as_ref())?,
        counts: Entries::numbers(counts.as_ref(), "counts")?,
    };
    let calibration = Calibration::taken(calibration)?;
    let calibrated = calibration.get().calibrated();
    let equations = &calibrated.equations;
    let named = options.names.iter().map(|(axis, _)| axis).chain(options.counts.iter().map(|(axis, _)| axis));
    for axis in named {
        if !equations.axes.iter().any(|known| known.letter == *axis) {
            return Err(wrong(py, format!("{} has no axis {axis}", equations.machine)));
        }
    }
    if options.counts.iter().any(|(_, counts)| *counts <= 0.0) {
        return Err(one_of("counts", "above zero"));
    }
    let wanted = space::wanted(equations, ranges.as_ref(), at.as_ref())?;
    let folder = output.map(file::path).transpose()?;
    exported::check_options(*format, &given, "").map_err(|failure| raised(py, &failure))?;
    working(py, |heard| {
        if !leave_out_uncompensable {
            calibrated.refuse_uncompensable()?;
        }
        // What is left out is told as a compensation tells it.
        calibrated.terms(|left_out| heard.take(left_out));
        made(calibrated, *format, &options, &wanted, folder.as_ref().map(|folder| (folder, force)))
    })
}

fn made(
    calibrated: &Calibrated,
    format: exchange::controller::Format,
    options: &Options,
    wanted: &Wanted,
    folder: Option<(&PathBuf, bool)>,
) -> Result<Exported, Failure> {
    let geometry = Geometry::new(&calibrated.equations, &calibrated.calibration);
    let space =
        Space::new(&calibrated.equations, &calibrated.calibration, wanted).map_err(exported::refused)?;
    let export = exported::export(&geometry, &space, format, options)?;
    let targets = match folder {
        Some((folder, force)) => exported::write(&export, folder, force)?,
        None => export.files.iter().map(|file| PathBuf::from(&file.name)).collect(),
    };
    let text = exported::text(&export, &targets, &geometry, &space);
    Ok(Exported { files: export.files.into_iter().map(|file| (file.name, file.text)).collect(), text })
}

/// The controller's own names of axes: text, or the number of a motor.
fn names(given: Option<&Entries<'_>>) -> PyResult<Vec<(String, String)>> {
    let name = |(axis, name): (String, Bound<'_, PyAny>)| match name.extract::<i64>() {
        Ok(number) => Ok((axis, number.to_string())),
        Err(_) => {
            let name = arguments::text(&name, &format!("`name[\"{axis}\"]`"))?;
            Ok((axis, name))
        }
    };
    Entries::pairs(given, "name")?.into_iter().map(name).collect()
}
