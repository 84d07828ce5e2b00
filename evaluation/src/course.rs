//! The course of a recording: where the program sent the axes, and where the tool tip should have been.
//!
//! In: a recording and the equations of its machine. Out: positions of the axes in every row, the nominal tool tip, and what
//! was read of it.

use model_dsl::equations::Equations;
use model_dsl::program::Interpreter;
use recording::Recording;

use crate::Inputs;
use crate::figure::Sensor;

/// Two programmed positions of an axis that are closer than this share of its range in the recording are one place: tables are
/// rounded, and a step counter in place of a program flickers. Each deviation counts from its own command all the same.
const SAME_PLACE: f64 = 1e-4;

/// The least tolerance of a programmed position, mm or rad.
const LEAST: f64 = 1e-9;

/// A recording on its way.
pub(crate) struct Course<'c> {
    pub(crate) equations: &'c Equations,
    pub(crate) recording: &'c Recording,
    /// The programmed position of every axis; zero for an axis without a command. A deviation counts from a target, and only a
    /// command is one: what a drive or the instrument has would bring its noise into the places that are told apart.
    pub(crate) positions: Vec<Vec<f64>>,
    /// Which axes have a command.
    pub(crate) commanded: Vec<bool>,
    /// How far two programmed positions of one place may lie apart, for every axis.
    pub(crate) tolerance: Vec<f64>,
    /// The nominal tool tip, part frame.
    pub(crate) tip: [Vec<f64>; 3],
    /// Whether the place of the nominal tip is known, and not only its motion.
    pub(crate) absolute: bool,
    interpreter: Interpreter,
}

impl<'c> Course<'c> {
    /// The course of a recording; or why there is none.
    pub(crate) fn of(inputs: &Inputs<'c>) -> Result<Self, String> {
        let Inputs { equations, calibration, recording } = *inputs;
        let rows = recording.time.len();
        let command = |axis: usize| recording.axes.get(axis).and_then(|channels| channels.command.as_ref());
        let axes = 0..equations.axes.len();
        // A motor goes where its axes do, and is no axis that a line runs along.
        let programmed = |axis: usize| equations.programs(axis) && command(axis).is_some();
        let commanded: Vec<bool> = axes.clone().map(programmed).collect();
        if !commanded.contains(&true) {
            return Err("it has no channel `command.<axis>`, so the targets are unknown".to_owned());
        }
        let positions: Vec<Vec<f64>> =
            axes.map(|axis| command(axis).cloned().unwrap_or_else(|| vec![0.0; rows])).collect();
        let tolerance = positions.iter().map(|column| (SAME_PLACE * range(column)).max(LEAST)).collect();
        let defaults = equations.constants.iter().map(|constant| constant.default);
        let absolute = calibration.is_some() || defaults.clone().all(|default| default.is_some());
        let defaults: Vec<f64> = defaults.map(Option::unwrap_or_default).collect();
        let constants = calibration.map_or(&defaults, |calibration| &calibration.constants);
        let interpreter = Interpreter::new(equations, &recording.constants(constants));
        let columns: Vec<&[f64]> = positions.iter().map(Vec::as_slice).collect();
        let tip = interpreter.nominal_columns(&columns);
        Ok(Self { equations, recording, positions, commanded, tolerance, tip, absolute, interpreter })
    }

    /// The programmed positions in a row.
    pub(crate) fn position(&self, row: usize) -> Vec<f64> {
        self.positions.iter().map(|column| cell(column, row)).collect()
    }

    /// The nominal tool tip at some positions.
    pub(crate) fn nominal(&self, position: &[f64]) -> [f64; 3] {
        self.interpreter.nominal(position)
    }

    /// Whether all programmed positions of a row are there.
    pub(crate) fn complete(&self, row: usize) -> bool {
        self.positions.iter().all(|column| cell(column, row).is_finite())
    }

    pub(crate) fn letter(&self, axis: usize) -> &str {
        self.equations.axes.get(axis).map_or("", |axis| axis.letter.as_str())
    }

    pub(crate) fn rotary(&self, axis: usize) -> bool {
        self.equations.axes.get(axis).is_some_and(|axis| axis.rotary)
    }

    /// The drive's own feedback of an axis.
    pub(crate) fn actual(&self, axis: usize) -> Option<&Vec<f64>> {
        self.recording.axes.get(axis)?.actual.as_ref()
    }

    /// The tool tip as it was read in two directions of the part's frame: by the instrument, or else by the drives, whose
    /// positions stand in for the programmed ones.
    pub(crate) fn seen(&self, directions: [usize; 2]) -> Result<([Vec<f64>; 2], Sensor), String> {
        let measured = |direction: usize| self.recording.measured.get(direction).and_then(Option::as_ref);
        let [first, second] = directions;
        match (measured(first), measured(second)) {
            (Some(one), Some(other)) => return Ok(([one.clone(), other.clone()], Sensor::Instrument)),
            (None, None) => {}
            (one, _) => {
                let lacking = if one.is_some() { second } else { first };
                return Err(format!(
                    "the channel `measured.{}` is missing",
                    LETTERS.get(lacking).unwrap_or(&"")
                ));
            }
        }
        let fed_back = |axis: usize| self.actual(axis).is_some() || is_still(self.positions.get(axis));
        if let Some(axis) = (0..self.positions.len()).find(|axis| !fed_back(*axis)) {
            let letter = self.letter(axis).to_lowercase();
            return Err(format!("it has neither the tool tip nor `actual.{letter}`"));
        }
        let columns: Vec<&[f64]> = self
            .positions
            .iter()
            .enumerate()
            .map(|(axis, column)| self.actual(axis).unwrap_or(column).as_slice())
            .collect();
        let tip = self.interpreter.nominal_columns(&columns);
        let column = |direction: usize| tip.get(direction).cloned().unwrap_or_default();
        Ok(([column(first), column(second)], Sensor::Feedback))
    }
}

/// The directions as channels have them.
pub(crate) const LETTERS: [&str; 3] = ["x", "y", "z"];

fn is_still(column: Option<&Vec<f64>>) -> bool {
    column.is_none_or(|column| range(column) <= LEAST)
}

/// Greatest minus least of the numbers that are there.
pub(crate) fn range(column: &[f64]) -> f64 {
    let there = || column.iter().copied().filter(|value| value.is_finite());
    let range = there().fold(f64::NEG_INFINITY, f64::max) - there().fold(f64::INFINITY, f64::min);
    range.max(0.0)
}

/// The number in a row; NaN where there is none.
pub(crate) fn cell(column: &[f64], row: usize) -> f64 {
    column.get(row).copied().unwrap_or(f64::NAN)
}

/// The inner product.
pub(crate) fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}
