//! The compensator: from the state of the machine to the command that puts the tool where it was wanted.
//!
//! In: the equations of a machine, its error motions and, every cycle, a [`Sample`]. Out: the predicted error, and the
//! command whose own error cancels. It exists because the error belongs to where the axes are, not to where they were
//! asked to be: subtracting the error at the target leaves the difference of the two.

mod batch;
mod inverse;
mod report;
mod setup;

use self::inverse::{Reach, spread, tip};
use self::setup::Needs;
use crate::math::{add_scaled, dot};
use crate::{ErrorMotion, ErrorMotions, Kinematics, MotionReader, Sample, TermState};

pub use self::batch::{Batch, BatchSizes, BatchWork};
pub use self::report::{Convergence, Limits, Outcome, Refusal, SetupError, Work};
pub use self::setup::states_needed;

/// Predicts the error of a machine and compensates it, one sample a servo cycle.
///
/// Each call of [`error`](Self::error) or [`compensate`](Self::compensate) is one cycle: it takes the memory of the terms over to the
/// sample once. A controller calls one of the two in a cycle; the outcome of `compensate` holds the error too.
///
/// `K` is the machine, and `M` its error motions: a slice, or a calibration that was compiled in.
#[derive(Debug)]
pub struct Compensator<'a, K: Kinematics + ?Sized, M: ErrorMotions + ?Sized = [ErrorMotion<'a>]> {
    /// Whether positions are compensated. Switched off, they pass unchanged while errors and memories are still followed.
    pub enabled: bool,
    /// What a correction must not exceed.
    pub limits: Limits,
    /// When the search for the compensated position ends.
    pub convergence: Convergence,
    kinematics: &'a K,
    motions: &'a M,
    states: &'a mut [TermState],
    work: Work<'a>,
    needs: Needs,
    /// What the axes reach, once that is known and where it is the same everywhere.
    reach: Option<Reach>,
}

impl<'a, K: Kinematics + ?Sized> Compensator<'a, K> {
    /// A compensator, switched on and without a limit. `motions` holds the error motions in the order of the kinematics,
    /// `states` one state for each term of each ([`states_needed`]), as left by an earlier compensator or default.
    ///
    /// # Errors
    /// Tells the first slice of a wrong length, axis that the machine lacks or parameter out of its range.
    pub fn new(
        kinematics: &'a K,
        motions: &'a [ErrorMotion<'a>],
        states: &'a mut [TermState],
        work: Work<'a>,
    ) -> Result<Self, SetupError> {
        Self::with_calibration(kinematics, motions, states, work)
    }
}

impl<'a, K: Kinematics + ?Sized, M: ErrorMotions + ?Sized> Compensator<'a, K, M> {
    /// [`new`](Compensator::new) with any error motions, such as a calibration that was compiled in.
    ///
    /// # Errors
    /// As [`new`](Compensator::new).
    pub fn with_calibration(
        kinematics: &'a K,
        motions: &'a M,
        states: &'a mut [TermState],
        work: Work<'a>,
    ) -> Result<Self, SetupError> {
        let needs = setup::check(kinematics, motions.motions(), states, &work)?;
        Ok(Self {
            enabled: true,
            limits: Limits::default(),
            convergence: Convergence::default(),
            kinematics,
            motions,
            states,
            work,
            needs,
            reach: None,
        })
    }

    /// The number of axes of the machine.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.kinematics.axes()
    }

    /// The least number of temperatures that a sample must hold.
    #[must_use]
    pub const fn sensors(&self) -> usize {
        self.needs.sensors
    }

    /// Forgets what the terms remember, as if the machine had just started.
    pub fn restart(&mut self) {
        self.states.fill(TermState::default());
    }

    /// One cycle without compensation: the first-order error of the tool tip relative to the part at the position of the
    /// sample, actual minus commanded, in mm in the frame of the part.
    ///
    /// # Errors
    /// Refuses slices of the wrong length and numbers that are not finite; memories then stay as they were, unless it is
    /// the error itself that is not finite.
    pub fn error(&mut self, sample: &Sample<'_>) -> Result<[f64; 3], Refusal> {
        self.check_position(sample)?;
        self.begin(sample)
    }

    /// One cycle: writes to `out` the command c that puts the tool tip where the position of the sample would put it on a
    /// machine without errors.
    ///
    /// The command solves `J (c - target) + E(c) = 0` as far as the axes reach, J being the directions of the axes, by
    /// `c <- target - J^+ E(c)` from `c = target` on. Direction, velocity, temperature and memories are those of the sample
    /// throughout. What no axis reaches is left in [`Outcome::remaining`], and so is what the ramp of a backlash leaves for
    /// later cycles: E is then [`Term::corrected`](crate::Term::corrected).
    ///
    /// # Errors
    /// Every [`Refusal`] leaves the position of the sample in `out`, and nothing of a correction.
    pub fn compensate(&mut self, sample: &Sample<'_>, out: &mut [f64]) -> Result<Outcome, Refusal> {
        self.check_lengths(sample, out)?;
        copy(sample.position, out);
        let error = self.begin(sample)?;
        if !self.enabled {
            return Ok(Outcome { error, remaining: error, iterations: 0 });
        }
        let outcome = self.search(sample, error, out);
        if outcome.is_err() {
            copy(sample.position, out);
        }
        outcome
    }

    /// Begins a cycle: checks the sample, takes the memories over to it, and gives the error at its position.
    fn begin(&mut self, sample: &Sample<'_>) -> Result<[f64; 3], Refusal> {
        self.check(sample)?;
        self.advance(sample);
        let error = self.error_at(sample);
        if error.iter().all(|part| part.is_finite()) { Ok(error) } else { Err(Refusal::NotFinite) }
    }

    /// Checks that there is a position, and room for a command, for each axis.
    pub(crate) fn check_lengths(&self, sample: &Sample<'_>, out: &[f64]) -> Result<(), Refusal> {
        same_length("out", self.kinematics.axes(), out.len())?;
        self.check_position(sample)
    }

    /// Checks that there is a position for each axis.
    fn check_position(&self, sample: &Sample<'_>) -> Result<(), Refusal> {
        same_length("position", self.kinematics.axes(), sample.position.len())
    }

    /// Checks the rest of the sample.
    fn check(&self, sample: &Sample<'_>) -> Result<(), Refusal> {
        let axes = self.kinematics.axes();
        same_length("direction", axes, sample.direction.len())?;
        if self.needs.velocity || !sample.velocity.is_empty() {
            same_length("velocity", axes, sample.velocity.len())?;
        }
        if !sample.travel.is_empty() {
            same_length("travel", self.kinematics.travels().len(), sample.travel.len())?;
        }
        if sample.temperature.len() < self.needs.sensors {
            same_length("temperature", self.needs.sensors, sample.temperature.len())?;
        }
        if !sample.is_finite() {
            return Err(Refusal::NotFinite);
        }
        if sample.time_step < 0.0 {
            return Err(Refusal::NegativeTimeStep { time_step: sample.time_step });
        }
        Ok(())
    }

    /// Takes the memory of every term over to the sample.
    fn advance(&mut self, sample: &Sample<'_>) {
        if !self.needs.memory {
            return;
        }
        let mut rest = &mut *self.states;
        for motion in self.motions.motions() {
            let Some((states, others)) = rest.split_at_mut_checked(motion.terms.len()) else { return };
            motion.advance(sample, states);
            rest = others;
        }
    }

    /// The error in a state of the machine; memories are read only.
    fn error_at(&mut self, sample: &Sample<'_>) -> [f64; 3] {
        self.motions.read(MotionReader::new(*sample, self.states), self.work.motions);
        self.sum_at(sample)
    }

    /// The part of the error in a state of the machine that is corrected in this cycle; memories are read only.
    fn corrected_at(&mut self, sample: &Sample<'_>) -> [f64; 3] {
        if !self.needs.ramp {
            return self.error_at(sample);
        }
        self.motions.read(MotionReader::of_corrected(*sample, self.states), self.work.motions);
        self.sum_at(sample)
    }

    /// The sum of lever arms times the error motions that were read.
    fn sum_at(&mut self, sample: &Sample<'_>) -> [f64; 3] {
        let travel = if sample.travel.is_empty() {
            for (travel, &axis) in self.work.travel.iter_mut().zip(self.kinematics.travels()) {
                *travel = sample.position(axis);
            }
            &*self.work.travel
        } else {
            sample.travel
        };
        self.kinematics.error(sample.position, travel, self.work.motions)
    }

    /// Searches for the command, from the error at the target on, and holds it against the limit.
    fn search(&mut self, sample: &Sample<'_>, error: [f64; 3], out: &mut [f64]) -> Result<Outcome, Refusal> {
        let reach = match self.reach {
            Some(reach) => reach,
            None => self.reach_at(sample.position)?,
        };
        let start = if self.needs.ramp { self.corrected_at(sample) } else { error };
        let (pull, remaining, iterations) = self.iterate(sample, start, &reach, out)?;
        self.check_limit(spread(self.work.directions, pull))?;
        Ok(Outcome { error, remaining, iterations })
    }

    /// Finds in which directions the axes move the tip, and what they reach.
    fn reach_at(&mut self, position: &[f64]) -> Result<Reach, Refusal> {
        self.kinematics.directions(position, self.work.directions);
        if !self.work.directions.iter().flatten().all(|part| part.is_finite()) {
            return Err(Refusal::NotFinite);
        }
        let reach = Reach::new(self.work.directions);
        self.reach = Some(reach).filter(|_| !self.kinematics.directions_vary());
        Ok(reach)
    }

    /// The fixed point, from the corrected error at the target on: returns `A^+ E` there, the error that it leaves, and
    /// the steps taken.
    fn iterate(
        &mut self,
        sample: &Sample<'_>,
        start: [f64; 3],
        reach: &Reach,
        out: &mut [f64],
    ) -> Result<([f64; 3], [f64; 3], u32), Refusal> {
        let mut distance = f64::INFINITY;
        let mut here = start;
        let mut pull = [0.0; 3];
        for iterations in 1..=self.convergence.iterations {
            let next = reach.apply(here);
            distance = spread(self.work.directions, add_scaled(next, -1.0, pull));
            pull = next;
            self.correct(sample, pull, out);
            if distance <= self.convergence.tolerance {
                let made = tip(self.work.directions, pull);
                if self.needs.ramp {
                    here = self.error_at(&Sample { position: out, ..*sample });
                }
                return Ok((pull, add_scaled(here, -1.0, made), iterations));
            }
            if !distance.is_finite() {
                return Err(Refusal::NotConverging { iterations, distance: f64::INFINITY });
            }
            here = self.corrected_at(&Sample { position: out, ..*sample });
        }
        Err(Refusal::NotConverging { iterations: self.convergence.iterations, distance })
    }

    /// Writes the position of the sample less each axis's share of the pull.
    fn correct(&self, sample: &Sample<'_>, pull: [f64; 3], out: &mut [f64]) {
        let columns = self.work.directions.iter();
        for ((command, &target), &column) in out.iter_mut().zip(sample.position).zip(columns) {
            *command = target - dot(column, pull);
        }
    }

    /// Refuses a correction over the limit.
    fn check_limit(&self, correction: f64) -> Result<(), Refusal> {
        match self.limits.compensation {
            // Also at NaN, which no comparison lets through.
            Some(limit) if correction.partial_cmp(&limit).is_none_or(core::cmp::Ordering::is_gt) => {
                Err(Refusal::OverLimit { correction, limit })
            }
            _ => Ok(()),
        }
    }
}

/// Copies as many numbers as both hold; unlike `copy_from_slice` it has no way to panic.
fn copy(from: &[f64], to: &mut [f64]) {
    for (to, &from) in to.iter_mut().zip(from) {
        *to = from;
    }
}

/// Refuses a slice that has not the length it needs.
fn same_length(slice: &'static str, expected: usize, found: usize) -> Result<(), Refusal> {
    if expected == found { Ok(()) } else { Err(Refusal::Length { slice, expected, found }) }
}
