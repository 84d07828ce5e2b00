//! Arrays of positions. In: arrays of shape (n, axes), mm and deg, and what else is known in each row. Out: the columns that the workshop
//! answers, and its answers as arrays.

use abbe_runtime::Direction;
use model_dsl::equations::Equations;
use model_dsl::quantity::parse_unit;
use numpy::ndarray::{Array2, ArrayView2, ArrayViewD, Axis};
use numpy::{IntoPyArray, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use workshop::calibrated::Calibrated;
use workshop::rows::table::{Answers, Table};
use workshop::rows::{Timed, timed};

use crate::arguments::{self, Entries, column, shape};
use crate::error::wrong;

/// What a caller says of rows.
pub(crate) struct Given<'a, 'py> {
    pub(crate) positions: &'a Bound<'py, PyAny>,
    pub(crate) direction: Option<&'a Bound<'py, PyAny>>,
    pub(crate) temperatures: Option<&'a Entries<'py>>,
    pub(crate) time: Option<&'a Bound<'py, PyAny>>,
    pub(crate) travels: Option<&'a Entries<'py>>,
}

/// Rows in columns, and whether they came as one position without rows.
pub(crate) struct Rows {
    pub(crate) table: Table,
    pub(crate) alone: bool,
    /// For each axis, mm or rad in one of its unit.
    factors: Vec<f64>,
}

impl Rows {
    /// Reads the arrays.
    pub(crate) fn read(py: Python<'_>, calibrated: &Calibrated, given: &Given<'_, '_>) -> PyResult<Self> {
        let axes = calibrated.equations.programmed();
        let array = by_axis(given.positions, "positions", &calibrated.equations)?;
        let array = array.as_array();
        let (positions, alone) = rows_of(py, "positions", &array, axes)?;
        let rows = positions.nrows();
        // The same factors as those of the columns that the command line reads.
        let factor =
            |rotary: bool| parse_unit(if rotary { "deg" } else { "mm" }).map_or(1.0, |unit| unit.factor);
        let factors: Vec<f64> = calibrated.equations.axes.iter().map(|axis| factor(axis.rotary)).collect();
        let position = positions.columns().into_iter().zip(&factors);
        let position = position.map(|(column, factor)| column.iter().map(|place| place * factor).collect());
        let table = Table {
            position: position.collect(),
            travel: travels(py, calibrated, given.travels, rows)?,
            direction: directions(py, given.direction, rows, &calibrated.equations)?,
            time: given.time.map(|time| column(time, "time", rows)).transpose()?,
            temperature: temperatures(py, calibrated, given.temperatures, rows)?,
        };
        if let (Some(Timed::Memory(why)), None) = (timed(&calibrated.calibration), &table.time) {
            return Err(wrong(
                py,
                format!(
                    "there is no `time`, which {why} needs\nhelp: time=... takes a number for each row, in s"
                ),
            ));
        }
        Ok(Self { table, alone, factors })
    }

    /// The errors: in each sensitive direction, mm, then of the tool's direction where it is derived, rad.
    pub(crate) fn errors<'py>(
        &self,
        py: Python<'py>,
        calibrated: &Calibrated,
        answers: &Answers,
    ) -> PyResult<Bound<'py, PyAny>> {
        let directions: Vec<usize> =
            calibrated.equations.rows.iter().map(|row| row.direction.index()).collect();
        let leans = calibrated.equations.orientation.len();
        let shape = (answers.outcomes.len(), directions.len().saturating_add(leans));
        let error = |(row, place): (usize, usize)| match directions.get(place) {
            Some(direction) => answers.outcomes.get(row).and_then(|outcome| outcome.error.get(*direction)),
            None => answers.leans.get(row).and_then(|lean| lean.get(place.checked_sub(directions.len())?)),
        };
        self.array(py, Array2::from_shape_fn(shape, |at| error(at).copied().unwrap_or(f64::NAN)))
    }

    /// The compensated positions, mm and deg.
    pub(crate) fn commands<'py>(&self, py: Python<'py>, answers: &Answers) -> PyResult<Bound<'py, PyAny>> {
        let shape = (answers.outcomes.len(), self.factors.len());
        let command = |(row, axis): (usize, usize)| {
            let command = answers.commands.get(axis).and_then(|column| column.get(row));
            command.zip(self.factors.get(axis)).map_or(f64::NAN, |(command, factor)| command / factor)
        };
        self.array(py, Array2::from_shape_fn(shape, command))
    }

    fn array<'py>(&self, py: Python<'py>, array: Array2<f64>) -> PyResult<Bound<'py, PyAny>> {
        arguments::answered(array.into_pyarray(py).into_any(), self.alone)
    }
}

/// An array with a column for each axis; of a table, whose columns have names, those that have the names of the axes.
fn by_axis<'py>(
    given: &Bound<'py, PyAny>,
    name: &str,
    equations: &Equations,
) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let py = given.py();
    if !given.is_instance_of::<PyMapping>() && !given.hasattr("columns")? {
        return arguments::array(given, name);
    }
    let columns = equations.axes.iter().filter(|axis| !axis.is_motor()).map(|axis| {
        let named = |letter: &str| given.get_item(letter).ok();
        named(&axis.letter).or_else(|| named(&axis.letter.to_lowercase())).ok_or_else(|| {
            let help =
                "help: its columns have the letters of the axes as names; an array has them in that order";
            wrong(py, format!("`{name}` has no column `{}`\n{help}", axis.letter))
        })
    });
    let columns: Vec<Bound<'_, PyAny>> = columns.collect::<PyResult<_>>()?;
    let table = py.import("numpy")?.call_method1("column_stack", (columns,));
    arguments::array(&table.map_err(|error| wrong(py, format!("`{name}`: {}", error.value(py))))?, name)
}

/// An array of rows, or of one position alone.
fn rows_of<'a>(
    py: Python<'_>,
    name: &str,
    array: &'a ArrayViewD<'_, f64>,
    width: usize,
) -> PyResult<(ArrayView2<'a, f64>, bool)> {
    let alone = array.ndim() == 1;
    let found = shape(array.shape());
    let view = if alone { array.view().insert_axis(Axis(0)) } else { array.view() };
    let view = view.into_dimensionality().ok().filter(|view: &ArrayView2<'_, f64>| view.ncols() == width);
    let view = view.ok_or_else(|| {
        let help =
            format!("help: it has a row for each position, and in it a number for each of {width} axes");
        wrong(py, format!("`{name}` has the shape {found}, not (n, {width})\n{help}"))
    })?;
    Ok((view, alone))
}

fn directions(
    py: Python<'_>,
    given: Option<&Bound<'_, PyAny>>,
    rows: usize,
    equations: &Equations,
) -> PyResult<Vec<Vec<Direction>>> {
    let Some(given) = given else { return Ok(Vec::new()) };
    let array = by_axis(given, "direction", equations)?;
    let array = array.as_array();
    let (view, _) = rows_of(py, "direction", &array, equations.programmed())?;
    if view.nrows() != rows && view.nrows() != 1 {
        return Err(wrong(py, format!("`direction` has {} rows, `positions` has {rows}", view.nrows())));
    }
    let told = |sign: f64| match sign {
        1.0 => Ok(Direction::Positive),
        -1.0 => Ok(Direction::Negative),
        other => Err(wrong(py, format!("`direction` holds {other}, which is not a direction, +1 or -1"))),
    };
    let all = view.columns().into_iter().map(|column| {
        let signs = column.iter().map(|sign| told(*sign)).collect::<PyResult<Vec<Direction>>>()?;
        Ok(if signs.len() == rows { signs } else { signs.into_iter().cycle().take(rows).collect() })
    });
    all.collect()
}

pub(crate) fn temperatures(
    py: Python<'_>,
    calibrated: &Calibrated,
    given: Option<&Entries<'_>>,
    rows: usize,
) -> PyResult<Vec<Vec<f64>>> {
    let sensors = &calibrated.calibration.sensors;
    let names: Vec<&str> = sensors.inputs().map(|(_, sensor)| sensor.name.value.as_str()).collect();
    let all: Vec<&str> = sensors.iter().map(|sensor| sensor.name.value.as_str()).collect();
    named(py, "temperatures", given, &all)?;
    let read = |name: &&str| {
        let value = Entries::at(given, name)?.ok_or_else(|| {
            let help = format!(
                "help: temperatures={{\"{name}\": ...}} takes a number, or one for each row, in degC"
            );
            wrong(py, format!("there is no temperature of sensor {name}, which the calibration uses\n{help}"))
        })?;
        column(&value, &format!("temperatures[\"{name}\"]"), rows)
    };
    names.iter().map(read).collect()
}

fn travels(
    py: Python<'_>,
    calibrated: &Calibrated,
    given: Option<&Entries<'_>>,
    rows: usize,
) -> PyResult<Vec<Vec<f64>>> {
    if given.is_none() {
        return Ok(Vec::new());
    }
    let names: Vec<&str> = calibrated.equations.travels.iter().map(|travel| &*travel.name).collect();
    named(py, "travels", given, &names)?;
    let read = |name: &&str| {
        let value = Entries::at(given, name)?
            .ok_or_else(|| wrong(py, format!("there is no travel `{name}`; give all travels or none")))?;
        column(&value, &format!("travels[\"{name}\"]"), rows)
    };
    names.iter().map(read).collect()
}

/// Refuses names that mean nothing.
fn named(py: Python<'_>, what: &str, given: Option<&Entries<'_>>, known: &[&str]) -> PyResult<()> {
    for (key, _) in Entries::pairs(given, what)? {
        if !known.contains(&key.as_str()) {
            let all = if known.is_empty() {
                "there are none".to_owned()
            } else {
                format!("there are {}", known.join(", "))
            };
            return Err(wrong(
                py,
                format!("`{what}` names `{key}`, which this calibration does not know\nhelp: {all}"),
            ));
        }
    }
    Ok(())
}
