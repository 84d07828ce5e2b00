//! The search for commands, side by side.
//!
//! In: a block of rows. Out: their commands and answers. It exists as the counterpart of `Compensator::search`: the same
//! operations in the same order in every lane. A row is answered in the step that ends its own search; what its lane holds
//! after that, nobody reads.

use super::block::Block;
use super::input::Batch;
use super::{Answers, Open};
use crate::compensator::inverse::{Reach, set};
use crate::compensator::report::check_amplification;
use crate::compensator::{Compensator, Outcome, Prediction, Refusal};
use crate::math::{add_scaled, all_finite};
use crate::sample::{LaneSample, lanes};
use crate::{ErrorMotions, Kinematics, Lanes, Real};

/// A step of the search.
struct Step {
    iterations: u32,
    /// The error that this step corrects, and `A^+` of it.
    here: [Lanes; 3],
    pull: [Lanes; 3],
    /// The error that the step before corrected.
    corrected: [Lanes; 3],
    /// The square of the length of the step over all axes.
    square: Lanes,
}

impl<K: Kinematics + ?Sized, M: ErrorMotions + ?Sized> Compensator<'_, K, M> {
    /// Takes the errors at the positions as what remains: all of it, until a search takes some away.
    pub(super) fn begin_lanes(&self, error: [Lanes; 3], open: &mut Open, answers: Answers<'_>) {
        for (lane, (open, answer)) in open.iter_mut().zip(answers).enumerate().filter(|(_, (open, _))| **open)
        {
            let error = row(&error, lane);
            *answer = if all_finite(&error) {
                Ok(Outcome { error, remaining: error, iterations: 0 })
            } else {
                *open = false;
                Err(Refusal::NotFinite)
            };
        }
    }

    /// Finds in which directions the axes of each row move the tip, and what they reach; once, where these are the same
    /// everywhere.
    pub(super) fn reach_lanes(
        &mut self,
        batch: &Batch<'_>,
        first: usize,
        block: &mut Block<'_>,
        open: &mut Open,
        answers: Answers<'_>,
    ) {
        let vary = self.prediction.kinematics.directions_vary();
        if block.reach_known && !vary {
            return;
        }
        self.directions_lanes(batch, first, block, open, answers);
        if !open.contains(&true) {
            return;
        }
        if !vary {
            for (lanes, &column) in block.columns.iter_mut().zip(&*self.directions) {
                *lanes = column.map(Lanes::from);
            }
        }
        if !block.reach_known {
            let known = self.prediction.kinematics.squares();
            block.reach = match known {
                Some(squares) => Reach::straight(squares.map(Lanes::from)),
                None => Reach::new(block.columns),
            };
            block.reach_known = true;
        }
    }

    /// Finds the directions at the position of each row.
    fn directions_lanes(
        &mut self,
        batch: &Batch<'_>,
        first: usize,
        block: &mut Block<'_>,
        open: &mut Open,
        answers: Answers<'_>,
    ) {
        for (lane, (open, answer)) in open.iter_mut().zip(answers).enumerate().filter(|(_, (open, _))| **open)
        {
            block.row.take_position(batch, first.saturating_add(lane));
            self.prediction.kinematics.directions(block.row.position, self.directions);
            if !all_finite(self.directions.as_flattened()) {
                (*open, *answer) = (false, Err(Refusal::NotFinite));
                continue;
            }
            for (lanes, &column) in block.columns.iter_mut().zip(&*self.directions) {
                let known = lanes.each_ref().map(|part| part.lane(lane).to_bits());
                block.reach_known &= known == column.map(f64::to_bits);
                set(lanes, lane, column);
            }
        }
    }

    /// The fixed point in every lane, from the errors at the positions on.
    pub(super) fn search_lanes(
        &mut self,
        first: usize,
        block: &mut Block<'_>,
        start: [Lanes; 3],
        mut open: Open,
        out: &mut [&mut [f64]],
        answers: Answers<'_>,
    ) {
        self.refuse_amplified(block, start, &mut open, answers);
        let zero = [Lanes::from(0.0); 3];
        let mut step =
            Step { iterations: 0, here: start, pull: zero, corrected: zero, square: f64::INFINITY.into() };
        while open.contains(&true) {
            if step.iterations >= self.convergence.iterations {
                return give_up(&step, open, answers);
            }
            if step.iterations > 0 {
                let resting = self.prediction.kinematics.resting();
                (step.corrected, step.here) = (step.here, self.error_in_lanes(block, Some(resting)));
            }
            step.iterations = step.iterations.saturating_add(1);
            step.pull = block.reach.apply(step.here);
            let change = add_scaled(step.here, Lanes::from(-1.0), step.corrected);
            step.square = block.reach.distance_squared(change);
            self.prediction.columns(block.columns).correct(block.position, step.pull, block.command);
            self.settle(first, block, &step, &mut open, out, answers);
        }
    }

    /// Refuses the rows in which the axes would move too far beside the tip.
    fn refuse_amplified(&self, block: &Block<'_>, start: [Lanes; 3], open: &mut Open, answers: Answers<'_>) {
        if !block.reach.may_amplify() {
            return;
        }
        let columns = self.prediction.columns(block.columns);
        let [moved, corrected] = block.reach.moved_and_corrected(columns, start);
        for (lane, (open, answer)) in open.iter_mut().zip(answers).enumerate().filter(|(_, (open, _))| **open)
        {
            if let Err(refusal) = check_amplification([moved.lane(lane), corrected.lane(lane)]) {
                (*open, *answer) = (false, Err(refusal));
            }
        }
    }

    /// Answers the rows whose search ends with this step.
    fn settle(
        &self,
        first: usize,
        block: &Block<'_>,
        step: &Step,
        open: &mut Open,
        out: &mut [&mut [f64]],
        answers: Answers<'_>,
    ) {
        let bound = self.convergence.tolerance_squared();
        let settled = |square: f64| square <= bound;
        let ends = |square: f64| settled(square) || !square.is_finite();
        if !open.iter().zip(step.square.numbers()).any(|(open, square)| *open && ends(square)) {
            return;
        }
        let columns = self.prediction.columns(block.columns);
        let correction = block.reach.distance_squared(step.here).sqrt();
        let remaining = add_scaled(step.here, Lanes::from(-1.0), block.reach.tip(columns, step.pull));
        for (lane, (open, answer)) in open.iter_mut().zip(answers).enumerate() {
            let square = step.square.lane(lane);
            if !*open || !ends(square) {
                continue;
            }
            *open = false;
            if !settled(square) {
                let iterations = step.iterations;
                *answer = Err(Refusal::NotConverging { iterations, distance: f64::INFINITY });
                continue;
            }
            let (iterations, remaining) = (step.iterations, row(&remaining, lane));
            if let Err(refusal) = self.limits.check(|| correction.lane(lane)) {
                *answer = Err(refusal);
            } else if let Ok(outcome) = answer {
                (outcome.remaining, outcome.iterations) = (remaining, iterations);
                block.write(lane, first.saturating_add(lane), out);
            }
        }
    }

    /// The error at the commands; once more in the same block, axes have moved but for these that rest.
    pub(super) fn error_in_lanes(&mut self, block: &mut Block<'_>, once_more: Option<&[bool]>) -> [Lanes; 3] {
        let mut at = LaneSample {
            position: block.command,
            velocity: block.velocity,
            temperature: block.temperature,
            direction: block.direction,
            place: None,
        };
        let Prediction { kinematics, motions, .. } = &self.prediction;
        let mut rest = &*block.memory;
        for (motion, value) in motions.motions().iter().zip(&mut *block.motions) {
            let (memory, others) = rest.split_at_checked(motion.terms.len()).unwrap_or_default();
            if once_more.is_none_or(|resting| motion.moves(resting)) {
                *value = motion.read_lanes(&mut at, memory);
            }
            rest = others;
        }
        if !block.travels_given {
            for (travel, &axis) in block.travel.iter_mut().zip(kinematics.travels()) {
                *travel = lanes(block.command, axis);
            }
        }
        kinematics
            .error_lanes(block.command, block.travel, block.motions)
            .unwrap_or_else(|| self.error_lane_by_lane(block))
    }

    /// The error at the commands of a machine that answers row by row.
    fn error_lane_by_lane(&mut self, block: &mut Block<'_>) -> [Lanes; 3] {
        let Prediction { kinematics, values, travel, .. } = &mut self.prediction;
        let mut error = [Lanes::default(); 3];
        for lane in 0..Lanes::WIDTH {
            extract(block.row_command, block.command, lane);
            extract(travel, block.travel, lane);
            extract(values, block.motions, lane);
            let row = kinematics.error(block.row_command, travel, values);
            set(&mut error, lane, row);
        }
        error
    }
}

/// Refuses the rows whose search has taken all the steps that it may.
fn give_up(step: &Step, open: Open, answers: Answers<'_>) {
    for ((open, answer), distance) in open.into_iter().zip(answers).zip(step.square.sqrt().numbers()) {
        if open {
            *answer = Err(Refusal::NotConverging { iterations: step.iterations, distance });
        }
    }
}

/// The vector of one lane.
fn row(vector: &[Lanes; 3], lane: usize) -> [f64; 3] {
    vector.each_ref().map(|part| part.lane(lane))
}

/// The numbers of one lane.
fn extract(numbers: &mut [f64], lanes: &[Lanes], lane: usize) {
    for (number, lanes) in numbers.iter_mut().zip(lanes) {
        *number = lanes.lane(lane);
    }
}

impl Block<'_> {
    /// Writes the commands of a lane to its row.
    fn write(&self, lane: usize, row: usize, out: &mut [&mut [f64]]) {
        for (out, command) in out.iter_mut().zip(&*self.command) {
            if let Some(out) = out.get_mut(row) {
                *out = command.lane(lane);
            }
        }
    }
}
