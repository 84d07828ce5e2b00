//! Rows that wait for their answers. In: samples, row by row. Out: a batch of the runtime, and its answers, row by row.

use std::ops::Range;

use abbe_runtime::{Batch, BatchWork, Compensator, Direction, Kinematics, Lanes, Outcome, Refusal, Sample};
use csv::ByteRecord;

use super::{Column, Layout};
use crate::map::Map;

/// Rows that are answered at once: enough that lanes are full, and few enough that all of them stay in a cache.
const ROWS: usize = 256;

/// A batch of rows, a vector for each quantity, and the storage that the runtime works in.
#[derive(Default)]
pub(crate) struct Pending {
    axes: Vec<Column>,
    records: Vec<(ByteRecord, u64)>,
    position: Vec<Vec<f64>>,
    travel: Vec<Vec<f64>>,
    direction: Vec<Vec<Direction>>,
    velocity: Vec<Vec<f64>>,
    temperature: Vec<Vec<f64>>,
    time_step: Vec<f64>,
    commands: Vec<Vec<f64>>,
    answers: Vec<Result<Outcome, Refusal>>,
    lanes: Vec<Lanes>,
    numbers: Vec<f64>,
    directions: Vec<Direction>,
}

impl Pending {
    /// No rows, and room for those of a machine.
    pub(crate) fn new<K: Kinematics>(layout: &Layout, compensator: &Compensator<'_, K>) -> Self {
        let sizes = compensator.batch_sizes();
        let axes = compensator.axes();
        Self {
            axes: layout.axes.clone(),
            records: vec![(ByteRecord::new(), 0); ROWS],
            position: vec![Vec::new(); axes],
            direction: vec![Vec::new(); axes],
            commands: vec![Vec::new(); axes],
            lanes: vec![Lanes::default(); sizes.lanes],
            numbers: vec![0.0; sizes.numbers],
            directions: vec![Direction::default(); sizes.directions],
            ..Self::default()
        }
    }

    /// How many rows wait.
    pub(crate) fn len(&self) -> usize {
        self.time_step.len()
    }

    /// Whether there is no room for another row.
    pub(crate) fn is_full(&self) -> bool {
        self.len() == self.records.len()
    }

    /// Takes a row; leaves another record in its place.
    pub(crate) fn push(&mut self, record: &mut ByteRecord, number: u64, sample: &Sample<'_>) {
        if let Some(slot) = self.records.get_mut(self.time_step.len()) {
            std::mem::swap(&mut slot.0, record);
            slot.1 = number;
        }
        push(&mut self.position, sample.position);
        push(&mut self.travel, sample.travel);
        push(&mut self.direction, sample.direction);
        push(&mut self.velocity, sample.velocity);
        push(&mut self.temperature, sample.temperature);
        self.time_step.push(sample.time_step);
    }

    /// Answers these rows, which follow those that were answered before.
    pub(crate) fn compensate<K: Kinematics>(
        &mut self,
        rows: Range<usize>,
        compensator: &mut Compensator<'_, K>,
    ) -> Result<(), Refusal> {
        self.answers.resize(rows.end, Err(Refusal::NotFinite));
        self.commands.iter_mut().for_each(|column| column.resize(rows.end, 0.0));
        let batch = Batch {
            position: &slices(&self.position, &rows),
            travel: &slices(&self.travel, &rows),
            direction: &slices(&self.direction, &rows),
            velocity: &slices(&self.velocity, &rows),
            temperature: &slices(&self.temperature, &rows),
            time_step: &self.time_step[rows.clone()],
        };
        let work = BatchWork {
            lanes: &mut self.lanes,
            numbers: &mut self.numbers,
            directions: &mut self.directions,
        };
        let mut commands: Vec<&mut [f64]> =
            self.commands.iter_mut().map(|column| &mut column[rows.clone()]).collect();
        compensator.compensate_batch(&batch, work, &mut commands, &mut self.answers[rows])
    }

    /// A row as it was read, and its number.
    pub(crate) fn record(&self, row: usize) -> (&ByteRecord, u64) {
        let (record, number) = &self.records[row];
        (record, *number)
    }

    /// What a row is answered.
    pub(crate) fn answer(&self, row: usize) -> Result<Outcome, Refusal> {
        self.answers[row]
    }

    /// The command of a row for each axis, in the unit of its column.
    pub(crate) fn commands(&self, row: usize) -> impl Iterator<Item = f64> {
        // Motors have no column, and are told in mm.
        let scales = self.axes.iter().map(|column| (column.factor, column.offset));
        let axes = self.commands.iter().zip(scales.chain(std::iter::repeat((1.0, 0.0))));
        axes.map(move |(commands, (factor, offset))| commands[row] / factor - offset)
    }

    /// Shows a row to a map.
    pub(crate) fn show(&self, row: usize, map: &mut Map<'_>) {
        let of = |columns: &[Vec<f64>]| columns.iter().map(|column| column[row]).collect::<Vec<_>>();
        map.take(&of(&self.position), of(&self.temperature));
    }

    /// Forgets all rows.
    pub(crate) fn clear(&mut self) {
        for columns in [
            &mut self.position,
            &mut self.travel,
            &mut self.velocity,
            &mut self.temperature,
            &mut self.commands,
        ] {
            columns.iter_mut().for_each(Vec::clear);
        }
        self.direction.iter_mut().for_each(Vec::clear);
        self.time_step.clear();
        self.answers.clear();
    }
}

/// Adds a row to columns; the first row makes them.
fn push<T: Copy>(columns: &mut Vec<Vec<T>>, row: &[T]) {
    columns.resize_with(row.len(), Vec::new);
    columns.iter_mut().zip(row).for_each(|(column, value)| column.push(*value));
}

fn slices<'c, T>(columns: &'c [Vec<T>], rows: &Range<usize>) -> Vec<&'c [T]> {
    columns.iter().map(|column| &column[rows.clone()]).collect()
}
