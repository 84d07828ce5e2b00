//! Rows beyond what was measured. In: the tables of a calibration, and the positions of rows. Out: how many rows lie outside the range
//! that the tables of an axis cover together, and how far. It exists because a table holds its last value there, which is mostly not the error of the machine.

use model_dsl::calibration::{CalibratedTerm, Calibration};
use model_dsl::equations::Equations;

/// The tables of all axes, and the rows outside of them.
pub(crate) struct Reach {
    axes: Vec<Axis>,
}

/// An axis that has tables.
struct Axis {
    number: usize,
    letter: String,
    /// Its unit, and how many of it are one mm or rad.
    unit: (&'static str, f64),
    /// From the least node of its tables to the greatest.
    measured: [f64; 2],
    /// How many rows are outside.
    outside: u64,
    /// The position of the row that is farthest outside.
    farthest: f64,
}

impl Reach {
    /// The axes that have tables. An axis with a table that repeats is left out, even if another of its tables ends.
    pub(crate) fn new(equations: &Equations, calibration: &Calibration) -> Self {
        let axes = equations.axes.iter().enumerate().filter_map(|(number, axis)| {
            let terms =
                || calibration.motions.iter().flat_map(|motion| &motion.terms).map(|term| &term.value);
            let repeats = terms().any(|term| is_repeating_over(term, number));
            let nodes = terms().flat_map(|term| term.nodes(number));
            let measured = nodes.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], node| {
                [low.min(node), high.max(node)]
            });
            (!repeats && measured[0] < measured[1]).then(|| Axis {
                number,
                letter: axis.letter.clone(),
                unit: if axis.rotary { ("deg", 1.0_f64.to_degrees()) } else { ("mm", 1.0) },
                measured,
                outside: 0,
                farthest: measured[0],
            })
        });
        Self { axes: axes.collect() }
    }

    /// Takes the position of a row: mm or rad, one for each axis.
    pub(crate) fn take(&mut self, position: &[f64]) {
        for axis in &mut self.axes {
            if let Some(place) = position.get(axis.number) {
                axis.take(*place);
            }
        }
    }

    /// What is to be said of rows outside, a sentence for each axis.
    pub(crate) fn told(&self) -> impl Iterator<Item = String> {
        self.axes.iter().filter(|axis| axis.outside > 0).map(Axis::told)
    }
}

impl Axis {
    fn take(&mut self, place: f64) {
        let beyond = self.beyond(place);
        if beyond > 0.0 {
            self.outside = self.outside.saturating_add(1);
            if beyond > self.beyond(self.farthest) {
                self.farthest = place;
            }
        }
    }

    /// How far a place is outside; not above zero where it is not. A thousandth of the tables' length is none: a program often goes as far
    /// as the last node, and comes there rounded.
    fn beyond(&self, place: f64) -> f64 {
        let [low, high] = self.measured;
        (low - place).max(place - high) - 1e-3 * (high - low)
    }

    fn told(&self) -> String {
        let Self { letter, unit: (unit, factor), measured: [low, high], outside, farthest, .. } = self;
        let rows = if *outside == 1 { "1 row is".to_owned() } else { format!("{outside} rows are") };
        let [low, high, farthest] = [low, high, farthest].map(|place| rounded(place * factor));
        format!(
            "warning: {rows} outside the measured range of {letter}, {low} to {high} {unit}, as far as {farthest} {unit}; tables keep their last value there"
        )
    }
}

/// A position with as many digits as a person needs.
fn rounded(place: f64) -> f64 {
    (place * 1e3).round() / 1e3
}

fn is_repeating_over(term: &CalibratedTerm, axis: usize) -> bool {
    matches!(term.core(), CalibratedTerm::Table { axis: over, curve } if *over == axis && curve.repeats)
}
