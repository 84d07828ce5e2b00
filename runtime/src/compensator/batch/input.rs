//! The samples of a batch.
//!
//! In: a slice for each quantity. Out: whether the slices belong together and whether a row can be used. It exists so that a
//! row is refused for the same reasons, in the same order, as a single sample.

use crate::compensator::{Refusal, same_length};
use crate::{Direction, Lanes, Sample};

/// The states of the machine in many cycles: a slice for each quantity, a row for each cycle, borrowed from the caller.
///
/// Units, and what may be empty, are those of a [`Sample`]; what is not empty has a slice for each axis, travel or sensor.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Batch<'a> {
    /// For each axis its positions in mm or rad.
    pub position: &'a [&'a [f64]],
    /// For each free travel its values in mm; empty: each travel is the position of its axis.
    pub travel: &'a [&'a [f64]],
    /// For each axis the directions of its last real motion.
    pub direction: &'a [&'a [Direction]],
    /// For each axis its velocities in mm/s or rad/s; may be empty where no term reads one.
    pub velocity: &'a [&'a [f64]],
    /// For each sensor its temperatures in degC; may be empty where no term reads a sensor.
    pub temperature: &'a [&'a [f64]],
    /// The time since the row before, in s; not negative.
    pub time_step: &'a [f64],
}

impl Batch<'_> {
    /// Checks that every slice has so many rows.
    pub(super) fn check(&self, rows: usize) -> Result<(), Refusal> {
        let columns = [
            ("position", self.position),
            ("travel", self.travel),
            ("velocity", self.velocity),
            ("temperature", self.temperature),
            ("time_step", &[self.time_step]),
        ];
        for (slice, columns) in columns {
            columns.iter().try_for_each(|column| same_length(slice, rows, column.len()))?;
        }
        self.direction.iter().try_for_each(|column| same_length("direction", rows, column.len()))
    }

    /// Checks the numbers of the rows from `first` on.
    pub(super) fn check_rows(&self, first: usize) -> [Result<(), Refusal>; Lanes::WIDTH] {
        let time_step = Lanes::new(chunk(self.time_step, first));
        let columns = [self.position, self.travel, self.velocity, self.temperature];
        // Nothing times a finite number is nothing, and NaN times any other.
        let nothing = columns
            .iter()
            .flat_map(|columns| columns.iter())
            .fold(time_step * Lanes::from(0.0), |sum, column| {
                sum + Lanes::new(chunk(column, first)) * Lanes::from(0.0)
            });
        let mut checks = [Ok(()); Lanes::WIDTH];
        let numbers = nothing.numbers().into_iter().zip(time_step.numbers());
        for (check, (nothing, time_step)) in checks.iter_mut().zip(numbers) {
            if nothing.is_nan() {
                *check = Err(Refusal::NotFinite);
            } else if time_step < 0.0 {
                *check = Err(Refusal::NegativeTimeStep { time_step });
            }
        }
        checks
    }
}

/// The rows of a column from `first` on, with defaults past its end.
pub(super) fn chunk<T: Copy + Default>(column: &[T], first: usize) -> [T; Lanes::WIDTH] {
    let rest = column.get(first..).unwrap_or_default();
    match rest.first_chunk() {
        Some(whole) => *whole,
        None => {
            let mut chunk = [T::default(); Lanes::WIDTH];
            chunk.iter_mut().zip(rest).for_each(|(slot, given)| *slot = *given);
            chunk
        }
    }
}

/// One row of a batch, as a sample has it.
#[derive(Debug)]
pub(super) struct Row<'w> {
    pub(super) position: &'w mut [f64],
    pub(super) travel: &'w mut [f64],
    pub(super) velocity: &'w mut [f64],
    pub(super) temperature: &'w mut [f64],
    pub(super) direction: &'w mut [Direction],
    pub(super) time_step: f64,
}

impl Row<'_> {
    /// Gathers a row.
    pub(super) fn take(&mut self, batch: &Batch<'_>, row: usize) {
        self.take_position(batch, row);
        gather(self.travel, batch.travel, row);
        gather(self.velocity, batch.velocity, row);
        gather(self.temperature, batch.temperature, row);
        for (slot, column) in self.direction.iter_mut().zip(batch.direction) {
            *slot = column.get(row).copied().unwrap_or_default();
        }
        self.time_step = number(batch.time_step, row);
    }

    /// Gathers the positions of a row alone.
    pub(super) fn take_position(&mut self, batch: &Batch<'_>, row: usize) {
        gather(self.position, batch.position, row);
    }

    /// The row as a sample; what the batch leaves out is empty here too.
    pub(super) fn sample(&self, batch: &Batch<'_>) -> Sample<'_> {
        fn given<'s>(numbers: &'s [f64], columns: &[&[f64]]) -> &'s [f64] {
            if columns.is_empty() { &[] } else { numbers }
        }
        Sample {
            position: self.position,
            travel: given(self.travel, batch.travel),
            direction: self.direction,
            velocity: given(self.velocity, batch.velocity),
            temperature: given(self.temperature, batch.temperature),
            time_step: self.time_step,
        }
    }
}

/// One row of several columns; what has no column is left.
fn gather(row_of: &mut [f64], columns: &[&[f64]], row: usize) {
    for (slot, column) in row_of.iter_mut().zip(columns) {
        *slot = number(column, row);
    }
}

/// The number in a row; NaN where there is none.
fn number(column: &[f64], row: usize) -> f64 {
    column.get(row).copied().unwrap_or(f64::NAN)
}
