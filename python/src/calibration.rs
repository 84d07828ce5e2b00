//! `abbe.Calibration`. In: a calibration file, or a dictionary that says the same. Out: errors, compensated positions and maps as arrays,
//! and the file again.

use std::path::Path;

use model_dsl::calibration;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use workshop::calibrated::{self, Calibrated};
use workshop::failure::Failure;
use workshop::named::machine_name;
use workshop::rows::error_columns;
use workshop::rows::table::{self, Answers, Wanted};
use workshop::written::{self, check_folder, check_new, folder};

use crate::arguments::Entries;
use crate::error::{working, wrong};
use crate::file::{self, Text};
use crate::machine::Machine;
use crate::mapped;
use crate::positions::{Given, Rows};

/// A machine with the numbers of one specimen.
///
/// `Calibration("mill-7.yaml")` reads a file; `Calibration({...})` takes what a file says as a dictionary, whose names of files are
/// counted from the current folder.
///
/// Positions are arrays of the shape (n, axes), float64, mm and deg, the axes in the order of `axes`; one position alone has the shape
/// (axes,). A table whose columns have the letters of the axes as names (a DataFrame, a dict of arrays) is taken by these. Rows follow each other in time: an axis that is not told its direction has that of its last motion, and what remembers
/// (a wind-up, a filter) remembers the rows before.
///
/// >>> import abbe
/// >>> stage = abbe.Calibration({"calibration": 1, "machine": "FX", "errors": {"EXX": [{"backlash": {"lost_motion": "10 um"}}]}})
/// >>> stage.error([[0.0], [5.0], [2.0]])[:, 0] * 1000
/// array([-5., -5.,  5.])
#[pyclass(module = "abbe", frozen)]
pub(crate) struct Calibration {
    calibrated: Calibrated,
    text: Text,
}

#[pymethods]
impl Calibration {
    #[new]
    fn new(calibration: &Bound<'_, PyAny>) -> PyResult<Self> {
        let text = file::text(calibration, "calibration")?;
        Self::of(calibration.py(), text)
    }

    /// The machine that it is for.
    #[getter]
    fn machine(&self, py: Python<'_>) -> PyResult<Machine> {
        let name = &self.calibrated.calibration.machine.value;
        Machine::named(py, name, self.text.folder())
    }

    /// The letters of the axes, in the order of arrays of positions; motors that have none of their own follow, in what `compensate` gives.
    #[getter]
    fn axes(&self) -> Vec<&str> {
        self.calibrated.equations.axes.iter().map(|axis| axis.letter.as_str()).collect()
    }

    /// The columns of `error`: `error_x` ... in mm, and the error of the tool's direction, `error_i` ... in rad, where it is derived.
    #[getter]
    fn columns(&self) -> Vec<String> {
        error_columns(&self.calibrated.equations)
    }

    /// The values of the machine's constants, mm, by name.
    #[getter]
    fn constants<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let constants = PyDict::new(py);
        let Calibrated { equations, calibration, .. } = &self.calibrated;
        for (constant, value) in equations.constants.iter().zip(&calibration.constants) {
            constants.set_item(&*constant.name, value)?;
        }
        Ok(constants)
    }

    /// The names of the temperature sensors that rows must give.
    #[getter]
    fn sensors(&self) -> Vec<&str> {
        self.calibrated.calibration.sensors.inputs().map(|(_, sensor)| sensor.name.value.as_str()).collect()
    }

    /// The names of the tools.
    #[getter]
    fn tools(&self) -> Vec<&str> {
        self.calibrated.calibration.tools.iter().map(|tool| tool.name.value.as_str()).collect()
    }

    /// The calibration file as text.
    #[getter]
    fn text(&self) -> &str {
        self.text.source.text()
    }

    /// The predicted error of the tool tip relative to the part, actual minus commanded, in the part's frame: an array of the shape
    /// (n, columns), mm, and rad for the tool's direction.
    ///
    /// `direction`: +1 or -1, shape (n, axes) or (axes,), the direction in which each axis came; without it, it follows from the
    /// positions, an axis turning when it has moved back by `hysteresis` (mm or deg). `temperatures`: for each sensor a number or an
    /// array (n,), degC. `time`: an array (n,), s, where a term needs it. `tool`: the name of a tool. `travels`: the machine's free
    /// travels, mm. `leave_out_uncompensable` leaves out the terms that no controller can compensate in real time, with a warning,
    /// where they would be refused.
    ///
    /// All processors work on it, and other threads of Python go on meanwhile.
    ///
    /// >>> import abbe
    /// >>> stage = abbe.Calibration({"calibration": 1, "machine": "FX", "errors": {"EXX": "3 um"}})
    /// >>> stage.columns
    /// ['error_x', 'error_y', 'error_z']
    /// >>> stage.error([[0.0], [250.0]])
    /// array([[0.003, 0.   , 0.   ],
    ///        [0.003, 0.   , 0.   ]])
    #[pyo3(signature = (positions, *, direction = None, temperatures = None, time = None, tool = None, travels = None,
                        hysteresis = 0.001, leave_out_uncompensable = false))]
    #[expect(clippy::too_many_arguments, reason = "each is a name for the caller")]
    fn error<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
        direction: Option<&Bound<'py, PyAny>>,
        temperatures: Option<Entries<'py>>,
        time: Option<&Bound<'py, PyAny>>,
        tool: Option<&str>,
        travels: Option<Entries<'py>>,
        hysteresis: f64,
        leave_out_uncompensable: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (temperatures, travels) = (temperatures.as_ref(), travels.as_ref());
        let given = Given { positions, direction, temperatures, time, travels };
        let wanted = self.wanted(py, tool, hysteresis, leave_out_uncompensable)?;
        let (rows, answers) = self.answer(py, &given, &wanted)?;
        rows.errors(py, &self.calibrated, &answers)
    }

    /// The positions to command so that the tool tip goes where `positions` say: an array of the same shape, mm and deg; a machine whose
    /// motors drive several axes together has a column more for each motor.
    ///
    /// The arguments are those of `error`. A correction beyond the calibration's limit is refused, with the number of its row.
    ///
    /// >>> import abbe
    /// >>> stage = abbe.Calibration({"calibration": 1, "machine": "FX", "errors": {"EXX": "3 um"}})
    /// >>> stage.compensate([[250.0]])
    /// array([[249.997]])
    #[pyo3(signature = (positions, *, direction = None, temperatures = None, time = None, tool = None, travels = None,
                        hysteresis = 0.001, leave_out_uncompensable = false))]
    #[expect(clippy::too_many_arguments, reason = "each is a name for the caller")]
    fn compensate<'py>(
        &self,
        py: Python<'py>,
        positions: &Bound<'py, PyAny>,
        direction: Option<&Bound<'py, PyAny>>,
        temperatures: Option<Entries<'py>>,
        time: Option<&Bound<'py, PyAny>>,
        tool: Option<&str>,
        travels: Option<Entries<'py>>,
        hysteresis: f64,
        leave_out_uncompensable: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (temperatures, travels) = (temperatures.as_ref(), travels.as_ref());
        let given = Given { positions, direction, temperatures, time, travels };
        let wanted = self.wanted(py, tool, hysteresis, leave_out_uncompensable)?;
        let (rows, answers) = self.answer(py, &given, &Wanted { compensated: true, ..wanted })?;
        rows.commands(py, &answers)
    }

    /// The predicted error over a plane of two axes, each axis at rest after a motion forward: a dict with the positions of both axes,
    /// `{"X": (n,), "Y": (m,)}`, mm or deg, and `"error"`, an array of the shape (m, n, columns), mm and rad.
    ///
    /// `plane` names the axes, as in `"XY"`; `points` says how many places each has (one number, or two); `ranges` from where to where
    /// an axis goes, `{"X": (0, 500)}`, by default over the calibration's tables; `at` where the others stand, by default in the middle.
    ///
    /// >>> import abbe
    /// >>> mill = abbe.Calibration({"calibration": 1, "machine": "XYFZ", "constants": {"Xt": "0 mm", "Yt": "0 mm", "Zt": "0 mm"},
    /// ...                          "errors": {"EC0Y": "100 urad"}})
    /// >>> drawn = mill.map("XY", points=3, ranges={"X": (0, 100), "Y": (0, 200), "Z": (0, 50)})
    /// >>> drawn["error"].shape, (drawn["error"][:, 0, 0] * 1000).round(6)
    /// ((3, 3, 3), array([  0., -10., -20.]))
    #[pyo3(signature = (plane, *, points = None, ranges = None, at = None, temperatures = None, tool = None,
                        leave_out_uncompensable = false))]
    #[expect(clippy::too_many_arguments, reason = "each is a name for the caller")]
    fn map<'py>(
        &self,
        py: Python<'py>,
        plane: &str,
        points: Option<&Bound<'py, PyAny>>,
        ranges: Option<Entries<'py>>,
        at: Option<Entries<'py>>,
        temperatures: Option<Entries<'py>>,
        tool: Option<&str>,
        leave_out_uncompensable: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let plane = mapped::Plane::read(py, &self.calibrated, plane, points, ranges.as_ref(), at.as_ref())?;
        let wanted = self.wanted(py, tool, 0.0, leave_out_uncompensable)?;
        plane.map(py, &self.calibrated, temperatures.as_ref(), &wanted)
    }

    /// Writes the calibration file, its machine named from the new file's folder; a file that is there is replaced only with `force`.
    ///
    /// >>> import abbe, tempfile, pathlib
    /// >>> stage = abbe.Calibration({"calibration": 1, "machine": "FX", "errors": {"EXX": "3 um"}})
    /// >>> folder = tempfile.TemporaryDirectory()
    /// >>> stage.write(pathlib.Path(folder.name, "stage.yaml"))
    /// >>> abbe.Calibration(folder.name + "/stage.yaml").error([[0.0]])[0, 0]
    /// np.float64(0.003)
    #[pyo3(signature = (path, *, force = false))]
    fn write(&self, path: &Bound<'_, PyAny>, force: bool) -> PyResult<()> {
        let target = file::path(path)?;
        working(path.py(), |_| self.write_to(&target, force))
    }

    fn __repr__(&self) -> String {
        format!("<abbe.Calibration of {}: {}>", self.calibrated.equations.machine, self.text.source.name())
    }
}

impl Calibration {
    /// The calibration that a file says.
    pub(crate) fn of(py: Python<'_>, text: Text) -> PyResult<Self> {
        let (source, folder) = (text.source.clone(), text.folder());
        let calibrated = working(py, |heard| calibrated::of(source, folder, heard))?;
        Ok(Self { calibrated, text })
    }

    /// A calibration, or one that is read from its file or dictionary.
    pub(crate) fn taken<'py>(given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, Self>> {
        match given.cast::<Self>() {
            Ok(calibration) => Ok(calibration.clone()),
            Err(_) => Bound::new(given.py(), Self::new(given)?),
        }
    }

    /// What was read of it.
    pub(crate) fn calibrated(&self) -> &Calibrated {
        &self.calibrated
    }

    /// Its file.
    pub(crate) fn path(&self) -> &Path {
        &self.text.path
    }

    fn wanted(
        &self,
        py: Python<'_>,
        tool: Option<&str>,
        hysteresis: f64,
        left_out: bool,
    ) -> PyResult<Wanted> {
        let Calibrated { equations, calibration, .. } = &self.calibrated;
        let unknown = |name: &str| {
            let all = self.tools().join(", ");
            let help = if all.is_empty() {
                "help: it has none".to_owned()
            } else {
                format!("help: there are {all}")
            };
            wrong(py, format!("the calibration has no tool `{name}`\n{help}"))
        };
        let tool = tool.map(|name| calibration.tool(name).ok_or_else(|| unknown(name))).transpose()?;
        if !(hysteresis >= 0.0 && hysteresis.is_finite()) {
            return Err(wrong(py, "`hysteresis` is a number of mm or deg, not below zero"));
        }
        let of_axis = |rotary: bool| if rotary { hysteresis.to_radians() } else { hysteresis };
        let hysteresis = equations.axes.iter().map(|axis| of_axis(axis.rotary)).collect();
        Ok(Wanted { tool, hysteresis, compensated: false, left_out })
    }

    fn answer(&self, py: Python<'_>, given: &Given<'_, '_>, wanted: &Wanted) -> PyResult<(Rows, Answers)> {
        let rows = Rows::read(py, &self.calibrated, given)?;
        let answers = working(py, |heard| {
            let mut answers = table::answer(&self.calibrated, &rows.table, wanted)?;
            answers.warnings.drain(..).for_each(|text| heard.take(text));
            Ok(answers)
        })?;
        Ok((rows, answers))
    }

    fn write_to(&self, target: &Path, force: bool) -> Result<(), Failure> {
        check_folder(target, "write")?;
        check_new(target, ("write", "calibration.yaml"), &[], force)?;
        let Calibrated { equations, calibration, .. } = &self.calibrated;
        let machine = machine_name(&calibration.machine.value, &self.text.path, &folder(target))?;
        if machine == calibration.machine.value {
            return written::calibration(target, self.text.source.text(), equations);
        }
        let mut renamed = calibration.clone();
        renamed.machine.value = machine;
        written::calibration(target, &calibration::write(&renamed, &equations.names()), equations)
    }
}
