//! Many samples at once.
//!
//! In: a slice for each quantity of many samples. Out: for each of them what [`Compensator::compensate`] answers, bit for
//! bit. It exists because maps, paths and files hold millions of positions, and a processor works on several side by side.

mod block;
mod input;
mod search;

use self::block::{Block, Parts};
use super::{Compensator, Outcome, Prediction, Refusal, same_length};
use crate::{ErrorMotions, Kinematics, Lanes};

pub use self::block::{BatchSizes, BatchWork};
pub use self::input::Batch;

/// The rows of a block that are still to be answered.
type Open = [bool; Lanes::WIDTH];

/// What each row is answered.
type Answers<'a> = &'a mut [Result<Outcome, Refusal>];

impl<K: Kinematics + ?Sized, M: ErrorMotions + ?Sized> Compensator<'_, K, M> {
    /// The storage that [`compensate_batch`](Self::compensate_batch) works in.
    #[must_use]
    pub fn batch_sizes(&self) -> BatchSizes {
        let Prediction { kinematics, motions, states, needs, .. } = &self.prediction;
        BatchSizes::new(Parts {
            axes: kinematics.axes(),
            travels: kinematics.travels().len(),
            motions: motions.motions().len(),
            terms: states.len(),
            sensors: needs.sensors,
        })
    }

    /// As many cycles as `answers` has places: for each row what [`compensate`](Self::compensate) gives, one row after the
    /// other, memories included.
    ///
    /// `out` holds a slice for each axis, into which the commands go; a row that is refused keeps its position there. Rows
    /// are taken side by side, [`Lanes::WIDTH`] of them, where the machine has
    /// [`error_lanes`](Kinematics::error_lanes), no correction is ramped, no rotary axis corrects anything and no motor follows axes; what remembers
    /// goes row by row.
    ///
    /// # Errors
    /// Refuses the whole batch for a slice of the wrong length; nothing is written then. All other refusals stand in
    /// `answers`.
    pub fn compensate_batch(
        &mut self,
        batch: &Batch<'_>,
        work: BatchWork<'_>,
        out: &mut [&mut [f64]],
        answers: &mut [Result<Outcome, Refusal>],
    ) -> Result<(), Refusal> {
        self.check_batch(batch, out, answers.len())?;
        let mut block = Block::new(work, &self.batch_sizes())?;
        let mut first = 0_usize;
        for answers in answers.chunks_mut(Lanes::WIDTH) {
            if self.goes_row_by_row() {
                self.rows(batch, first, &mut block, out, answers);
            } else {
                self.block(batch, first, &mut block, out, answers);
            }
            first = first.saturating_add(Lanes::WIDTH);
        }
        Ok(())
    }

    /// Whether no rows are answered side by side.
    fn goes_row_by_row(&self) -> bool {
        let Prediction { kinematics, needs, .. } = &self.prediction;
        let turns = !needs.turns.is_empty() || !kinematics.aiming().is_empty();
        needs.ramp || turns || !kinematics.following().is_empty()
    }

    /// Checks every length of a batch of so many rows.
    fn check_batch(&self, batch: &Batch<'_>, out: &[&mut [f64]], rows: usize) -> Result<(), Refusal> {
        let Prediction { kinematics, needs, .. } = &self.prediction;
        let axes = kinematics.axes();
        same_length("out", axes, out.len())?;
        out.iter().try_for_each(|column| same_length("out", rows, column.len()))?;
        same_length("position", axes, batch.position.len())?;
        same_length("direction", axes, batch.direction.len())?;
        if batch.velocity.len() != needs.velocities {
            same_length("velocity", axes, batch.velocity.len())?;
        }
        if !batch.travel.is_empty() {
            same_length("travel", kinematics.travels().len(), batch.travel.len())?;
        }
        if batch.temperature.len() < needs.sensors {
            same_length("temperature", needs.sensors, batch.temperature.len())?;
        }
        batch.check(rows)
    }

    /// A block of rows, one after the other.
    fn rows(
        &mut self,
        batch: &Batch<'_>,
        first: usize,
        block: &mut Block<'_>,
        out: &mut [&mut [f64]],
        answers: Answers<'_>,
    ) {
        for ((row, answer), check) in (first..).zip(answers).zip(batch.check_rows(first)) {
            block.row.take(batch, row);
            *answer = check.and_then(|()| self.compensate(&block.row.sample(batch), block.row_command));
            let written = if answer.is_ok() { &*block.row_command } else { &*block.row.position };
            for (out, number) in out.iter_mut().zip(written) {
                if let Some(out) = out.get_mut(row) {
                    *out = *number;
                }
            }
        }
    }

    /// A block of rows, side by side.
    fn block(
        &mut self,
        batch: &Batch<'_>,
        first: usize,
        block: &mut Block<'_>,
        out: &mut [&mut [f64]],
        answers: Answers<'_>,
    ) {
        block.take(batch, first);
        block.pass(batch, first, out);
        let mut open = [false; Lanes::WIDTH];
        for ((open, answer), check) in open.iter_mut().zip(&mut *answers).zip(batch.check_rows(first)) {
            *answer = check.map(|()| Outcome::default());
            *open = answer.is_ok();
        }
        self.remember(batch, first, block, &open);
        let error = self.error_in_lanes(block, None);
        self.begin_lanes(error, &mut open, answers);
        if self.enabled {
            self.reach_lanes(batch, first, block, &mut open, answers);
            self.search_lanes(first, block, error, open, out, answers);
        }
    }

    /// Takes the memories over to each row in its turn, and keeps what they are there.
    fn remember(&mut self, batch: &Batch<'_>, first: usize, block: &mut Block<'_>, open: &Open) {
        if !self.prediction.needs.memory {
            return;
        }
        let prediction = &mut self.prediction;
        for ((row, lane), _) in (first..).zip(0_usize..).zip(open).filter(|(_, open)| **open) {
            block.row.take(batch, row);
            prediction.advance(&block.row.sample(batch));
            let terms = prediction.motions.motions().iter().flat_map(|motion| motion.terms);
            for ((term, state), memory) in terms.zip(&*prediction.states).zip(&mut *block.memory) {
                if term.remembers() {
                    memory.set(lane, state.remembered().copied().unwrap_or(f64::NAN));
                }
            }
        }
    }
}
