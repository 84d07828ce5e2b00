//! The compensator: from the state of the machine to the command that puts the tool where it was wanted.
//!
//! In: the equations of a machine, its error motions and, every cycle, a [`Sample`]. Out: the predicted error, and the
//! command whose own error cancels. It exists because the error belongs to where the axes are, not to where they were
//! asked to be: subtracting the error at the target leaves the difference of the two.

mod aim;
mod fixed_point;
mod inverse;
mod known;
mod motors;
mod prediction;
mod report;
mod seen;
mod setup;
mod tilts;
mod turns;

use self::fixed_point::{Search, Settled};
use self::inverse::Reach;
use self::known::Known;
use self::motors::Corrected;
use self::prediction::{FIRST, Prediction};
use self::setup::Needs;
use super::math::{add_scaled, all_finite, sqrt};
use super::real::Real;
use super::{ErrorMotion, ErrorMotions, Kinematics, MotionReader, Sample, Share, Sines, TermState};

pub use self::report::{
    Convergence, DirectionOutcome, GREATEST_AMPLIFICATION, Limits, Outcome, Refusal, SetupError, Work,
};
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
    prediction: Prediction<'a, K, M>,
    /// The directions in which the axes move the tip.
    directions: &'a mut [[Real; 3]],
    /// What the axes reach, once that is known and where it is the same everywhere.
    reach: Option<Reach>,
    /// What the last cycle found of the direction of the tool, where rotary axes correct it.
    direction: Option<DirectionOutcome>,
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
        let Work { directions, motions: values, travel } = work;
        Ok(Self {
            enabled: true,
            limits: Limits::default(),
            convergence: Convergence::default(),
            prediction: Prediction {
                kinematics,
                motions,
                states,
                values,
                travel,
                sines: Sines::default(),
                by_motors: Corrected::NONE,
                needs,
            },
            directions,
            reach: None,
            direction: None,
        })
    }

    /// The number of axes of the machine.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.prediction.kinematics.axes()
    }

    /// Whether a correction turns an axis: its own angle is wrong, or the direction of the tool.
    pub(crate) fn turns(&self, axis: usize) -> bool {
        let Prediction { kinematics, .. } = self.prediction;
        kinematics.turning().iter().any(|turning| turning.axis == axis) || kinematics.aiming().contains(&axis)
    }

    /// What the last call of [`compensate`](Self::compensate) found of the direction of the tool. None before the first, after a
    /// refusal, and on a machine whose rotary axes do not [correct](Kinematics::aiming) it.
    #[must_use]
    pub const fn direction(&self) -> Option<DirectionOutcome> {
        self.direction
    }

    /// The axes that are motors, by the axes that they follow.
    pub(crate) fn following(&self) -> &'a [Share] {
        self.prediction.kinematics.following()
    }

    /// The least number of temperatures that a sample must hold.
    #[must_use]
    pub const fn sensors(&self) -> usize {
        self.prediction.needs.sensors
    }

    /// Forgets what the terms remember, as if the machine had just started.
    pub fn restart(&mut self) {
        self.prediction.states.fill(TermState::default());
    }

    /// One cycle without compensation: the first-order error of the tool tip relative to the part at the position of the
    /// sample, actual minus commanded, in mm in the frame of the part.
    ///
    /// # Errors
    /// Refuses slices of the wrong length and numbers that are not finite; memories then stay as they were, unless it is
    /// the error itself that is not finite.
    pub fn error(&mut self, sample: &Sample<'_>) -> Result<[Real; 3], Refusal> {
        self.prediction.begin(sample)
    }

    /// The error motions at the position of the sample, in the order of the kinematics: mm or rad. Terms remember what the last cycle has
    /// left. None where the sample is not of such a machine.
    pub fn motions(&mut self, sample: &Sample<'_>) -> Option<M::Values<'_>> {
        let Prediction { motions, states, values, .. } = &mut self.prediction;
        motions.read(MotionReader::new(sample, sample.position, states), values)
    }

    /// One cycle: writes to `out` the command c that puts the tool tip where the position of the sample would put it on a
    /// machine without errors.
    ///
    /// The command solves `J (c - target) + E(c) = 0` as far as the slides reach, J being the directions of the axes, by
    /// `c <- target - J^+ E(c)` from `c = target` on; a rotary axis has the command at which its [own
    /// angle](Kinematics::turning) is the one wanted, which is no part of that E, and whose lever arms are those of the angle wanted.
    /// Where rotary axes [correct the direction of the tool](Kinematics::aiming), they turn by
    /// the shortest angles that undo its error in the pose in which they then stand, no axis by more than [`GREATEST_AMPLIFICATION`]
    /// times that error, and E is that of the tip in this pose, less where the tip was wanted.
    /// Direction, velocity, temperature and memories are those of the sample
    /// throughout. What no axis reaches is left in [`Outcome::remaining`], and so is what the ramp of a backlash leaves for
    /// later cycles: E is then [`Term::corrected`](super::Term::corrected).
    ///
    /// # Errors
    /// Every [`Refusal`] leaves the position of the sample in `out`, and nothing of a correction.
    pub fn compensate(&mut self, sample: &Sample<'_>, out: &mut [Real]) -> Result<Outcome, Refusal> {
        self.direction = None;
        self.check_lengths(sample, out)?;
        let outcome = self.cycle(sample, out);
        if outcome.is_err() {
            self.direction = None;
            copy(sample.position, out);
        }
        outcome
    }

    /// [`compensate`](Self::compensate), where all is as long as it must be; a refusal leaves anything in `out`.
    #[inline]
    fn cycle(&mut self, sample: &Sample<'_>, out: &mut [Real]) -> Result<Outcome, Refusal> {
        let error = self.prediction.begin(sample)?;
        if self.prediction.kinematics.axes_aim() {
            return self.cycle_aimed(sample, error, out);
        }
        if self.enabled {
            self.search(sample, error, out)
        } else {
            copy(sample.position, out);
            Ok(Outcome { error, remaining: error, iterations: 0 })
        }
    }

    /// Checks that there is a position, and room for a command, for each axis.
    pub(crate) fn check_lengths(&self, sample: &Sample<'_>, out: &[Real]) -> Result<(), Refusal> {
        let axes = self.axes();
        same_length("out", axes, out.len())?;
        same_length("position", axes, sample.position.len())
    }

    /// Searches for the command, from the error at the target on, and holds it against the limit.
    #[inline]
    fn search(
        &mut self,
        sample: &Sample<'_>,
        error: [Real; 3],
        out: &mut [Real],
    ) -> Result<Outcome, Refusal> {
        let reach = self.reach_at(sample.position)?;
        let Self { prediction, convergence, limits, directions, .. } = self;
        let (kinematics, ramp) = (prediction.kinematics, prediction.needs.ramp);
        same_length("work.directions", kinematics.axes(), directions.len())?;
        let columns = kinematics.columns(directions);
        let turned = prediction.turn(sample, convergence, out)?;
        let start = match &turned {
            Some(turned) => {
                limits.check_rotation(turned.correction(sample.position))?;
                prediction.left_to_slides::<FIRST>(sample, turned, out)?
            }
            None if ramp || kinematics.motors_correct() => prediction.corrected_at_target(sample)?,
            None => error,
        };
        if reach.may_amplify() {
            report::check_amplification(reach.moved_and_corrected(columns, start))?;
        }
        let turned = turned.as_ref();
        let search = Search { prediction, convergence, sample, columns, reach, turned };
        let Settled { pull, error: mut left, iterations } = search.run(start, out)?;
        limits.check(|| sqrt(reach.distance_squared(left) + prediction.by_motors_squared()))?;
        if ramp {
            left = prediction.error_behind_ramp(sample, turned, out)?;
            if !all_finite(&left) {
                return Err(Refusal::NotConverging { iterations, distance: Real::INFINITY });
            }
        }
        let remaining = add_scaled(left, -1.0, reach.tip(columns, pull));
        Ok(Outcome { error, remaining, iterations })
    }

    /// What the axes reach; finds in which directions they move the tip, but where that is known.
    #[inline(always)]
    fn reach_at(&mut self, position: &[Real]) -> Result<Reach, Refusal> {
        let kinematics = self.prediction.kinematics;
        if let Some(squares) = kinematics.squares() {
            self.find_directions(position)?;
            return Ok(Reach::straight(squares));
        }
        match kinematics.reach().or(self.reach) {
            Some(reach) => Ok(reach),
            None => self.find_reach(position),
        }
    }

    /// Finds what the axes reach, in the directions in which they move the tip.
    fn find_reach(&mut self, position: &[Real]) -> Result<Reach, Refusal> {
        self.find_directions(position)?;
        let reach = Reach::new(self.directions);
        self.reach = Some(reach).filter(|_| !self.prediction.kinematics.directions_vary());
        Ok(reach)
    }

    /// Finds in which directions the axes move the tip.
    #[inline]
    fn find_directions(&mut self, position: &[Real]) -> Result<(), Refusal> {
        self.prediction.kinematics.directions_with(&self.prediction.sines, position, self.directions);
        if all_finite(self.directions.as_flattened()) { Ok(()) } else { Err(Refusal::NotFinite) }
    }
}

/// Copies as many numbers as both hold; unlike `copy_from_slice` it has no way to panic.
fn copy(from: &[Real], to: &mut [Real]) {
    for (to, &from) in to.iter_mut().zip(from) {
        *to = from;
    }
}

/// Refuses a slice that has not the length it needs.
fn same_length(slice: &'static str, expected: usize, found: usize) -> Result<(), Refusal> {
    if expected == found { Ok(()) } else { Err(Refusal::Length { slice, expected, found }) }
}
