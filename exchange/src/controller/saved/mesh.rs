//! The heights of a bed. In: rows of heights over a rectangle. Out: the height between, as firmware interpolates it, and as terms
//! of a calibration.
//!
//! All firmware here adds the height to the command of Z (`z' = z + h(x, y)`: Klipper's `MoveSplitter`, Marlin's
//! `Planner::apply_leveling`, RepRapFirmware's `Move::BedTransform`): where the bed is high, the tool goes up. So the error of the
//! machine is minus the height: commanded to z, the tool is nearer to the bed by h.
//!
//! Between four points all of them interpolate bilinearly, and hold the edge outside. That is a sum over the rows: for each a hat
//! function of y, 1 at its row and 0 at the next ones, times the table over x along it.

use model_dsl::calibration::{CalibratedTerm, Curve, CurveNodes, CurveValues, Factor};

use crate::controller::grid::Grid;

/// Heights over two axes.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::controller) struct Mesh {
    /// The letters of the axes, that along a row first.
    pub(in crate::controller) axes: [char; 2],
    /// Heights, mm: the first argument, of number 1, is that from row to row, the other, of number 0, that along a row.
    grid: Grid,
}

impl Mesh {
    /// A mesh of places along a row, places of the rows, and heights row by row. Nothing where these do not fit together, or places
    /// do not rise.
    pub(in crate::controller) fn new(
        axes: [char; 2],
        [along, rows]: [Vec<f64>; 2],
        heights: Vec<f64>,
    ) -> Option<Self> {
        let rises = |nodes: &[f64]| nodes.len() > 1 && nodes.windows(2).all(|pair| pair[0] < pair[1]);
        let fits = rises(&along) && rises(&rows) && along.len() * rows.len() == heights.len();
        fits.then(|| Self { axes, grid: Grid { arguments: vec![(1, rows), (0, along)], values: heights } })
    }

    /// The height at a place, mm.
    pub(in crate::controller) fn height(&self, place: [f64; 2]) -> f64 {
        self.grid.value(&place)
    }

    /// The places along a row, and those of the rows.
    pub(in crate::controller) fn nodes(&self) -> [&[f64]; 2] {
        let of = |number: usize| self.grid.arguments.get(number).map_or(&[][..], |(_, nodes)| nodes);
        [of(1), of(0)]
    }

    /// The rows of heights.
    pub(in crate::controller) fn rows(&self) -> impl Iterator<Item = &[f64]> {
        let [along, _] = self.nodes();
        self.grid.values.chunks(along.len().max(1))
    }

    /// Heights times a factor as terms of one error motion: `axes` are the numbers of the axis along a row and of that from row to
    /// row.
    pub(super) fn terms(&self, [along, across]: [usize; 2], factor: f64) -> Vec<CalibratedTerm> {
        let [places, rows] = self.nodes();
        let values: Vec<f64> = self.grid.values.iter().map(|height| factor * height + 0.0).collect();
        over_two([(across, rows), (along, places)], &values)
    }
}

/// A grid over two axes as terms, the second axis running fastest: for each row a table over the second axis times a hat of the
/// first one. Rows of zeros need none.
pub(in crate::controller) fn over_two(
    [(across, rows), (along, places)]: [(usize, &[f64]); 2],
    values: &[f64],
) -> Vec<CalibratedTerm> {
    let term = |(number, row): (usize, &[f64])| {
        let curve = Curve::new(nodes(places), CurveValues::Both(row.to_vec()));
        let (at, values) = hat(rows, number);
        let hat = Factor::Curve { axis: across, at, values };
        CalibratedTerm::Table { axis: along, curve }.times(vec![hat])
    };
    let all = values.chunks(places.len().max(1)).enumerate();
    all.filter(|(_, row)| row.iter().any(|value| *value != 0.0)).map(term).collect()
}

/// 1 at a node, 0 at its neighbours.
fn hat(nodes: &[f64], number: usize) -> (Vec<f64>, Vec<f64>) {
    let near = nodes.iter().enumerate().filter(|(other, _)| other.abs_diff(number) <= 1);
    near.map(|(other, place)| (*place, if other == number { 1.0 } else { 0.0 })).unzip()
}

/// Nodes, as a start and a step where they are evenly spaced.
fn nodes(places: &[f64]) -> CurveNodes {
    match crate::instrument::even(places) {
        Some((start, step)) => CurveNodes::Uniform { start, step },
        None => CurveNodes::At(places.to_vec()),
    }
}

/// Evenly spaced places from one end to the other, rounded to a millionth of a millimetre.
pub(super) fn spread([from, to]: [f64; 2], count: usize) -> Vec<f64> {
    let last = number(count.saturating_sub(1).max(1));
    (0..count).map(|place| millionth(from + (to - from) * number(place) / last)).collect()
}

/// Places at equal steps from a first one on.
pub(super) fn stepped(from: f64, step: f64, count: usize) -> Vec<f64> {
    (0..count).map(|place| millionth(from + step * number(place))).collect()
}

/// A place without the last bits of its arithmetic.
fn millionth(place: f64) -> f64 {
    const STEPS: f64 = 1e6;
    let rounded = (place * STEPS).round() / STEPS;
    if rounded.is_finite() { rounded + 0.0 } else { place }
}

/// A count as a number; exact below 2^32.
fn number(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}
