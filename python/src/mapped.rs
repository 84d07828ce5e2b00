//! Maps: the error over a plane of two axes. In: a calibrated machine, the axes and from where to where they go. Out: arrays of positions
//! and of errors there.

use exchange::controller::Space;
use numpy::IntoPyArray;
use numpy::ndarray::Array3;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use workshop::calibrated::Calibrated;
use workshop::failure::Failure;
use workshop::rows::field;
use workshop::rows::table::Wanted;

use crate::arguments::{self, Entries};
use crate::error::{raised, working, wrong};
use crate::positions::temperatures;
use crate::space;

/// Places of an axis where nothing else is said.
const POINTS: usize = 21;

/// The most places of a map.
const MOST: usize = 10_000_000;

/// A plane of two axes.
pub(crate) struct Plane {
    axes: [usize; 2],
    /// The places of both, mm or rad.
    places: [Vec<f64>; 2],
    /// Where all axes stand, mm or rad.
    middle: Vec<f64>,
}

impl Plane {
    /// Reads what the caller says of it.
    pub(crate) fn read(
        py: Python<'_>,
        calibrated: &Calibrated,
        plane: &str,
        points: Option<&Bound<'_, PyAny>>,
        ranges: Option<&Entries<'_>>,
        at: Option<&Entries<'_>>,
    ) -> PyResult<Self> {
        let equations = &calibrated.equations;
        let axis = |letter: char| equations.axes.iter().position(|axis| axis.letter == letter.to_string());
        let letters: Vec<char> = plane.chars().collect();
        let axes = match letters.as_slice() {
            [one, other] if one != other => [*one, *other].map(axis),
            _ => [None, None],
        };
        let [Some(one), Some(other)] = axes else {
            let all: Vec<&str> = equations.axes.iter().map(|axis| axis.letter.as_str()).collect();
            let help = format!("help: write two of the machine's axes, {}", all.join(", "));
            return Err(wrong(py, format!("`{plane}` is no plane of two axes\n{help}")));
        };
        let wanted = space::wanted(equations, ranges, at)?;
        let space = Space::new(equations, &calibrated.calibration, &wanted)
            .map_err(|refused| raised(py, &Failure::wrong(refused.to_string())))?;
        let points = points.map_or(Ok([POINTS; 2]), both)?;
        if points.contains(&0)
            || points.into_iter().try_fold(1, usize::checked_mul).is_none_or(|all| all > MOST)
        {
            return Err(wrong(py, format!("`points` are from 1 on, and all together not more than {MOST}")));
        }
        let range = |axis: usize| space.ranges.get(axis).copied().unwrap_or_default();
        let [columns, rows] = points;
        let places = [spread(range(one), columns), spread(range(other), rows)];
        Ok(Self { axes: [one, other], places, middle: space.reference })
    }

    /// The error over it.
    pub(crate) fn map<'py>(
        &self,
        py: Python<'py>,
        calibrated: &Calibrated,
        given: Option<&Entries<'_>>,
        wanted: &Wanted,
    ) -> PyResult<Bound<'py, PyDict>> {
        let inputs: Vec<f64> = temperatures(py, calibrated, given, 1)?.into_iter().flatten().collect();
        let [columns, rows] = &self.places;
        let [one, other] = self.axes;
        let moved =
            rows.iter().flat_map(|row| columns.iter().map(move |column| [(one, *column), (other, *row)]));
        let moved: Vec<[(usize, f64); 2]> = moved.collect();
        let errors = working(py, |heard| {
            field::errors(calibrated, wanted, (&self.middle, &inputs), &moved, &mut |text| heard.take(text))
        })?;
        let width = errors.first().map_or(0, Vec::len);
        let shape = (rows.len(), columns.len(), width);
        let of = |(row, column, part): (usize, usize, usize)| {
            let place = row.saturating_mul(columns.len()).saturating_add(column);
            errors.get(place).and_then(|error| error.get(part)).copied().unwrap_or(f64::NAN)
        };
        let map = PyDict::new(py);
        for (axis, places) in self.axes.into_iter().zip(&self.places) {
            let Some(axis) = calibrated.equations.axes.get(axis) else { continue };
            let shown = |place: &f64| if axis.rotary { place.to_degrees() } else { *place };
            map.set_item(&axis.letter, places.iter().map(shown).collect::<Vec<f64>>().into_pyarray(py))?;
        }
        map.set_item("error", Array3::from_shape_fn(shape, of).into_pyarray(py))?;
        Ok(map)
    }
}

/// How many places two axes have: a number for both, or one for each.
fn both(points: &Bound<'_, PyAny>) -> PyResult<[usize; 2]> {
    let refused = |_| {
        let found = arguments::kind(points);
        wrong(points.py(), format!("`points` is a whole number, or two of them, found {points} ({found})"))
    };
    points.extract().or_else(|_| points.extract().map(|one| [one; 2])).map_err(refused)
}

/// Places from one end to the other, evenly.
fn spread([from, to]: [f64; 2], points: usize) -> Vec<f64> {
    let last = points.saturating_sub(1).max(1) as f64;
    (0..points).map(|point| from + (to - from) * (point as f64) / last).collect()
}
