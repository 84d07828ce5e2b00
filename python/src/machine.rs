//! `abbe.Machine`. In: a topology word, the name of a shipped machine or a file. Out: its equations in the notations of the compiler,
//! and its lever arms as arrays.

use std::path::Path;

use model_dsl::equations::{Equations, Names};
use model_dsl::program::Interpreter;
use notation::Format;
use numpy::IntoPyArray;
use numpy::ndarray::Array3;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use workshop::load::{self, Loaded};

use crate::arguments::{self, Entries, array};
use crate::error::{raised, working, wrong};
use crate::page::framed;

/// A machine: a chain of links, and the equations that follow from it.
///
/// `Machine("XYFZ")` takes a topology word (the letters from the part to the tool, F the bed), `Machine("postech-mill")` a machine that
/// comes with Abbe, `Machine("lathe.yaml")` a machine file.
///
/// >>> import abbe
/// >>> stage = abbe.Machine("FX")
/// >>> stage.axes, stage.motions
/// (['X'], ['EXX', 'EYX', 'EZX', 'EAX', 'EBX', 'ECX'])
#[pyclass(module = "abbe", frozen)]
pub(crate) struct Machine {
    loaded: Loaded,
    /// The word, name or path that it was made from.
    given: String,
}

#[pymethods]
impl Machine {
    #[new]
    fn new(machine: &Bound<'_, PyAny>) -> PyResult<Self> {
        let name = Self::name_of(machine)?;
        let loaded = working(machine.py(), |heard| load::machine(&name, None, heard))?;
        Ok(Self { loaded, given: name })
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.derived().machine
    }

    /// Its title, or None.
    #[getter]
    fn title(&self) -> Option<&str> {
        self.derived().title.as_deref()
    }

    /// The letters of its axes, in the order in which arrays of positions hold them.
    #[getter]
    fn axes(&self) -> Vec<&str> {
        self.derived().axes.iter().map(|axis| axis.letter.as_str()).collect()
    }

    /// The unit of each axis in arrays of positions: `mm`, or `deg` for a rotary axis.
    #[getter]
    fn units(&self) -> Vec<&'static str> {
        self.derived().axes.iter().map(|axis| if axis.rotary { "deg" } else { "mm" }).collect()
    }

    /// The directions of the equations, `X`, `Y`, `Z`, in the order of the middle index of `levers`.
    #[getter]
    fn directions(&self) -> Vec<String> {
        self.derived().rows.iter().map(|row| row.direction.letter().to_string()).collect()
    }

    /// The names of its constants: offsets, mm.
    #[getter]
    fn constants(&self) -> Vec<&str> {
        self.derived().constants.iter().map(|constant| &*constant.name).collect()
    }

    /// The names of its error motions, in the order of the last index of `levers`.
    #[getter]
    fn motions(&self) -> Vec<&str> {
        self.derived().motions.iter().map(|motion| motion.name.as_str()).collect()
    }

    /// What each error motion is, in words, by its name.
    #[getter]
    fn meanings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let meanings = PyDict::new(py);
        for motion in &self.derived().motions {
            meanings.set_item(&motion.name, &motion.meaning)?;
        }
        Ok(meanings)
    }

    /// The equations as text, as `abbe derive` prints them.
    #[getter]
    fn equations(&self) -> String {
        self.print(Format::Text)
    }

    /// The equations as a LaTeX document.
    #[getter]
    fn latex(&self) -> String {
        self.print(Format::Latex)
    }

    /// The page of the machine, as `abbe derive --format html` writes it.
    #[getter]
    fn html(&self) -> String {
        self.loaded.page(Names::Symbols)
    }

    /// The equations in a notation of `abbe derive`: `text`, `latex`, `html`, `json`, `maxima` or `python`, or the drawing of the chain (`svg`); with the names of ISO 230-1
    /// (`iso`) or the machine file's symbols.
    ///
    /// >>> import abbe, json
    /// >>> json.loads(abbe.Machine("FX").derive("json"))["schema"]
    /// 'abbe-equations/1'
    #[pyo3(signature = (format = "text", names = "symbols"))]
    fn derive(&self, py: Python<'_>, format: &str, names: &str) -> PyResult<String> {
        let names = match names {
            "iso" => Names::Iso,
            "symbols" => Names::Symbols,
            other => return Err(wrong(py, format!("names are `iso` or `symbols`, not `{other}`"))),
        };
        let format = match format {
            "html" => return Ok(self.loaded.page(names)),
            "text" => Format::Text,
            "latex" => Format::Latex,
            "json" => Format::Json,
            "maxima" => Format::Maxima,
            "python" => Format::Python,
            "svg" => Format::Svg,
            other => {
                let help = "help: formats are text, latex, html, json, maxima, python, svg";
                return Err(wrong(py, format!("there is no format `{other}`\n{help}")));
            }
        };
        Ok(notation::print(self.derived(), format, names))
    }

    /// The lever arms at positions: for each axis a number or an array, mm or deg, by its letter in lower case; an axis that is not named
    /// stands at zero. `constants` gives the machine's offsets, mm; those that it does not name have their default, or are zero.
    ///
    /// The array has the shape (n, directions, motions), and (directions, motions) where all positions are numbers. A lever of a
    /// displacement is a pure number, that of an angle is in mm.
    ///
    /// >>> import abbe
    /// >>> stage = abbe.Machine("FX")
    /// >>> stage.levers(x=[0, 100], constants={"Zt": 50}).shape
    /// (2, 3, 6)
    /// >>> float(stage.levers(constants={"Zt": 50})[0, stage.motions.index("EBX")])
    /// 50.0
    #[pyo3(signature = (*, constants = None, **positions))]
    fn levers<'py>(
        &self,
        py: Python<'py>,
        constants: Option<Entries<'py>>,
        positions: Option<Entries<'py>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let constants = self.constant_values(py, constants.as_ref())?;
        let places = Places::read(py, self.derived(), positions.as_ref())?;
        let equations = self.derived();
        let levers = py.detach(|| {
            let positions: Vec<&[f64]> = places.columns.iter().map(Vec::as_slice).collect();
            let travels = equations.travels.iter().filter_map(|travel| positions.get(travel.axis).copied());
            Interpreter::new(equations, &constants).lever_columns(&positions, &travels.collect::<Vec<_>>())
        });
        let rows: Vec<usize> = equations.rows.iter().map(|row| row.direction.index()).collect();
        let shape = (places.rows, rows.len(), levers.len());
        let array = Array3::from_shape_fn(shape, |(row, direction, motion)| {
            let direction = rows.get(direction).copied().unwrap_or_default();
            levers.get(motion).and_then(|lever| lever.get(direction)?.get(row).copied()).unwrap_or(f64::NAN)
        });
        arguments::answered(array.into_pyarray(py).into_any(), places.alone)
    }

    fn _repr_html_(&self) -> String {
        framed(&self.html())
    }

    fn _repr_latex_(&self) -> String {
        notation::latex_equations(self.derived(), Names::Symbols)
    }

    fn __repr__(&self) -> String {
        format!("<abbe.Machine {}: {} error motions>", self.name(), self.derived().motions.len())
    }
}

impl Machine {
    /// The machine of a recording or a calibration, which name it from a folder.
    pub(crate) fn named(py: Python<'_>, name: &str, folder: Option<&Path>) -> PyResult<Self> {
        let loaded = load::machine(name, folder, &()).map_err(|failure| raised(py, &failure))?;
        let file = folder.map(|folder| folder.join(name)).filter(|file| file.is_file());
        Ok(Self { loaded, given: file.map_or_else(|| name.to_owned(), |file| file.display().to_string()) })
    }

    /// What names a machine: a word, a name or a path; of a machine the one that it was made from.
    pub(crate) fn name_of(machine: &Bound<'_, PyAny>) -> PyResult<String> {
        match machine.cast::<Self>() {
            Ok(machine) => Ok(machine.get().given.clone()),
            Err(_) => {
                let what = "a machine is given by a topology word, the name of a shipped machine or a path";
                Ok(arguments::path(machine, what)?.display().to_string())
            }
        }
    }

    fn derived(&self) -> &Equations {
        &self.loaded.compiled.equations
    }

    fn print(&self, format: Format) -> String {
        notation::print(self.derived(), format, Names::Symbols)
    }

    fn constant_values(&self, py: Python<'_>, given: Option<&Entries<'_>>) -> PyResult<Vec<f64>> {
        let given = Entries::numbers(given, "constants")?;
        let known = &self.derived().constants;
        if let Some((stray, _)) = given.iter().find(|(name, _)| !known.iter().any(|one| *one.name == **name))
        {
            let help = format!("help: its constants are {}", self.constants().join(", "));
            return Err(wrong(py, format!("{} has no constant `{stray}`\n{help}", self.name())));
        }
        let value = |name: &str| given.iter().find(|(known, _)| known == name).map(|(_, value)| *value);
        Ok(known.iter().map(|one| value(&one.name).or(one.default).unwrap_or_default()).collect())
    }
}

/// Positions by name, as long as one another: mm, rad.
struct Places {
    columns: Vec<Vec<f64>>,
    rows: usize,
    /// Whether all are numbers.
    alone: bool,
}

impl Places {
    fn read(py: Python<'_>, equations: &Equations, given: Option<&Entries<'_>>) -> PyResult<Self> {
        let mut columns: Vec<Vec<f64>> = vec![vec![0.0]; equations.axes.len()];
        let (mut rows, mut alone) = (1, true);
        for (key, value) in Entries::pairs(given, "positions")? {
            let known = equations.axes.iter().zip(&mut columns).find(|(axis, _)| *axis.variable == *key);
            let Some((axis, column)) = known else {
                let all: Vec<&str> = equations.axes.iter().map(|axis| &*axis.variable).collect();
                let help = format!("help: its axes are {}", all.join(", "));
                return Err(wrong(py, format!("{} has no axis `{key}`\n{help}", equations.machine)));
            };
            let numbers = array(&value, &key)?;
            let numbers = numbers.as_array();
            let (dimensions, length) = (numbers.ndim(), numbers.len());
            if dimensions > 1 || dimensions == 1 && !alone && length != rows {
                let found = arguments::shape(numbers.shape());
                let wanted = if alone { "(n,)".to_owned() } else { format!("({rows},), as others have") };
                return Err(wrong(py, format!("`{key}` has the shape {found}, not {wanted}")));
            }
            if dimensions == 1 {
                (rows, alone) = (length, false);
            }
            let internal = |place: &f64| if axis.rotary { place.to_radians() } else { *place };
            *column = numbers.iter().map(internal).collect();
        }
        for column in columns.iter_mut().filter(|column| column.len() != rows) {
            *column = vec![column.first().copied().unwrap_or_default(); rows];
        }
        Ok(Self { columns, rows, alone })
    }
}
