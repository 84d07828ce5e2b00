//! The storage of a batch, and the rows that are in it.
//!
//! In: what a caller lends, and a batch. Out: the rows of a block as lanes. It exists because the runtime owns no memory:
//! three slices are lent, and each quantity has its place in them.

use super::input::{Batch, Row, chunk};
use crate::compensator::inverse::Reach;
use crate::compensator::{Refusal, same_length};
use crate::{Direction, Lanes};

/// How long the slices of a [`BatchWork`] are.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BatchSizes {
    /// The length of [`BatchWork::lanes`].
    pub lanes: usize,
    /// The length of [`BatchWork::numbers`].
    pub numbers: usize,
    /// The length of [`BatchWork::directions`].
    pub directions: usize,
    parts: Parts,
}

/// What there is of each quantity.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Parts {
    pub(super) axes: usize,
    pub(super) travels: usize,
    pub(super) motions: usize,
    pub(super) terms: usize,
    pub(super) sensors: usize,
}

impl BatchSizes {
    /// The storage for a machine.
    pub(super) const fn new(parts: Parts) -> Self {
        let Parts { axes, travels, motions, terms, sensors } = parts;
        // Saturated only where no such slice can exist.
        let others = travels.saturating_add(sensors);
        Self {
            lanes: axes
                .saturating_mul(6)
                .saturating_add(others)
                .saturating_add(motions)
                .saturating_add(terms),
            numbers: axes.saturating_mul(3).saturating_add(others),
            directions: axes.saturating_mul(Lanes::WIDTH.saturating_add(1)),
            parts,
        }
    }
}

/// The storage that a batch is worked in, borrowed from the caller; what it holds before does not matter. Its sizes are
/// those of [`Compensator::batch_sizes`](crate::Compensator::batch_sizes).
#[derive(Debug)]
pub struct BatchWork<'a> {
    /// Numbers side by side.
    pub lanes: &'a mut [Lanes],
    /// The numbers of one row.
    pub numbers: &'a mut [f64],
    /// Directions of motion.
    pub directions: &'a mut [Direction],
}

/// Rows side by side: for each axis, travel, sensor, error motion or term its lanes.
#[derive(Debug)]
pub(super) struct Block<'w> {
    pub(super) position: &'w mut [Lanes],
    pub(super) command: &'w mut [Lanes],
    pub(super) velocity: &'w mut [Lanes],
    pub(super) temperature: &'w mut [Lanes],
    pub(super) direction: &'w mut [[Direction; Lanes::WIDTH]],
    pub(super) travel: &'w mut [Lanes],
    /// Whether travels are given; else they follow the commands.
    pub(super) travels_given: bool,
    /// What the terms remember.
    pub(super) memory: &'w mut [Lanes],
    pub(super) motions: &'w mut [Lanes],
    /// The directions in which the axes move the tip.
    pub(super) columns: &'w mut [[Lanes; 3]],
    pub(super) reach: Reach<Lanes>,
    /// Whether the reach is that of the columns.
    pub(super) reach_known: bool,
    pub(super) row: Row<'w>,
    /// The command of one row.
    pub(super) row_command: &'w mut [f64],
}

impl<'w> Block<'w> {
    /// Gives each quantity its place in the storage.
    pub(super) fn new(work: BatchWork<'w>, sizes: &BatchSizes) -> Result<Self, Refusal> {
        same_length("work.lanes", sizes.lanes, work.lanes.len())?;
        same_length("work.numbers", sizes.numbers, work.numbers.len())?;
        same_length("work.directions", sizes.directions, work.directions.len())?;
        let Parts { axes, travels, motions, terms, sensors } = sizes.parts;
        let (mut lanes, mut numbers, mut directions) = (work.lanes, work.numbers, work.directions);
        Ok(Self {
            position: part(&mut lanes, axes),
            command: part(&mut lanes, axes),
            velocity: part(&mut lanes, axes),
            temperature: part(&mut lanes, sensors),
            travel: part(&mut lanes, travels),
            travels_given: false,
            memory: part(&mut lanes, terms),
            motions: part(&mut lanes, motions),
            columns: lanes.as_chunks_mut().0,
            row_command: part(&mut numbers, axes),
            reach: Reach::nothing(),
            reach_known: false,
            row: Row {
                position: part(&mut numbers, axes),
                travel: part(&mut numbers, travels),
                velocity: part(&mut numbers, axes),
                temperature: part(&mut numbers, sensors),
                direction: part(&mut directions, axes),
                time_step: 0.0,
            },
            direction: directions.as_chunks_mut().0,
        })
    }

    /// Takes the rows from `first` on; lanes past the last row hold zeros. The commands begin at the positions.
    pub(super) fn take(&mut self, batch: &Batch<'_>, first: usize) {
        fill(self.position, batch.position, first);
        fill(self.command, batch.position, first);
        fill(self.velocity, batch.velocity, first);
        fill(self.temperature, batch.temperature, first);
        fill(self.travel, batch.travel, first);
        self.travels_given = !batch.travel.is_empty();
        for (directions, column) in self.direction.iter_mut().zip(batch.direction) {
            *directions = chunk(column, first);
        }
    }

    /// Writes the positions of the block to `out`, so that they pass where nothing else is written.
    pub(super) fn pass(&self, batch: &Batch<'_>, first: usize, out: &mut [&mut [f64]]) {
        for (column, out) in batch.position.iter().zip(out) {
            let rows = out.iter_mut().skip(first).take(Lanes::WIDTH);
            for (out, position) in rows.zip(column.iter().skip(first)) {
                *out = *position;
            }
        }
    }
}

/// Cuts the next so many places off a slice.
fn part<'w, T>(rest: &mut &'w mut [T], places: usize) -> &'w mut [T] {
    let (part, others) = core::mem::take(rest).split_at_mut_checked(places).unwrap_or_default();
    *rest = others;
    part
}

/// Fills lanes from columns.
fn fill(lanes: &mut [Lanes], columns: &[&[f64]], first: usize) {
    for (lanes, column) in lanes.iter_mut().zip(columns) {
        *lanes = Lanes::new(chunk(column, first));
    }
}
