//! The workspace of a map or an export. In: how far axes go and where they stand, as callers say it. Out: the same in mm and rad.

use exchange::controller::Wanted;
use model_dsl::equations::Equations;
use pyo3::prelude::*;

use crate::arguments::{self, Entries, number};
use crate::error::wrong;

/// What the caller says of the workspace, mm or deg, in mm and rad.
pub(crate) fn wanted(
    equations: &Equations,
    ranges: Option<&Entries<'_>>,
    at: Option<&Entries<'_>>,
) -> PyResult<Wanted> {
    let mut wanted = Wanted::default();
    for (letter, ends) in Entries::pairs(ranges, "ranges")? {
        let ends = range(&ends, &letter)?.map(|end| internal(equations, &letter, end));
        wanted.ranges.push((letter, ends));
    }
    for (letter, place) in Entries::numbers(at, "at")? {
        let place = internal(equations, &letter, place);
        wanted.reference.push((letter, place));
    }
    Ok(wanted)
}

fn internal(equations: &Equations, letter: &str, place: f64) -> f64 {
    let rotary = equations.axes.iter().any(|axis| axis.letter == letter && axis.rotary);
    if rotary { place.to_radians() } else { place }
}

fn range(ends: &Bound<'_, PyAny>, letter: &str) -> PyResult<[f64; 2]> {
    let name = format!("`ranges[\"{letter}\"]`");
    let both: Vec<Bound<'_, PyAny>> = ends.extract().unwrap_or_default();
    match both.as_slice() {
        [from, to] => Ok([number(from, &name)?, number(to, &name)?]),
        _ => {
            let found = arguments::kind(ends);
            Err(wrong(ends.py(), format!("{name} is two numbers, from where to where, found {found}")))
        }
    }
}
