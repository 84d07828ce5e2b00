//! What a compensator is told and what it answers.
//!
//! In and out: limits and accuracy, outcomes, refusals, mistakes in the set-up. It exists so that a controller can tell
//! every reason for which a position was not compensated.

use core::fmt;

use super::super::math::sqrt;
use super::super::real::{Real, TOLERANCE};

/// What a correction must not exceed.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Limits {
    /// Greatest length of a correction over all slides, and over what motors of a beam correct by themselves beside the slide that they
    /// carry, in mm; none: no limit. A NaN refuses every correction.
    pub compensation: Option<Real>,
    /// Greatest correction of rotary axes, over all of them, in rad; none: no limit. A NaN refuses every correction. What an axis that lies
    /// nearly along the tool would turn for its direction is cut to it, and not refused.
    pub rotation: Option<Real>,
}

impl Limits {
    /// Refuses a correction over the limit; its length over all axes is asked for where there is one.
    #[inline]
    pub(super) fn check(&self, length: impl FnOnce() -> Real) -> Result<(), Refusal> {
        let Some(limit) = self.compensation else { return Ok(()) };
        let correction = length();
        // Not `>`: also at NaN, which no comparison lets through.
        if correction <= limit { Ok(()) } else { Err(Refusal::OverLimit { correction, limit }) }
    }

    /// Refuses a correction of rotary axes over the limit.
    pub(super) fn check_rotation(&self, correction: Real) -> Result<(), Refusal> {
        match self.rotation {
            None => Ok(()),
            Some(limit) if correction <= limit => Ok(()),
            Some(limit) => Err(Refusal::OverRotationLimit { correction, limit }),
        }
    }
}

/// The axes may move at most this many times as far as the tip is to move: a correction that needs more is refused.
///
/// In front of a pose in which two slides move the tip in the same direction, they have to move ever farther against one another to
/// move it in another one. A hundredth of a radian from there it is a hundred times as far: what is wrong with the error by 1 um moves
/// an axis by 0.1 mm, and what the slides themselves are wrong by over that way is no longer small beside the error.
///
/// Rotary axes that correct the direction of the tool turn at most this many times as far as the direction is to turn. A rotary axis that
/// lies along the tool turns it nowhere, and many machines cut most of the time in that pose or near it: there nothing is refused, and
/// what the axes do not correct is told in [`DirectionOutcome::remaining`].
pub const GREATEST_AMPLIFICATION: Real = 100.0;

/// Refuses a correction for which the axes would move too far beside the tip, from the squares of both ways.
#[inline]
pub(super) fn check_amplification([moved, corrected]: [Real; 2]) -> Result<(), Refusal> {
    if moved > GREATEST_AMPLIFICATION * GREATEST_AMPLIFICATION * corrected {
        return Err(Refusal::NearSingular { amplification: sqrt(moved / corrected) });
    }
    Ok(())
}

/// When the search for the compensated position ends.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Convergence {
    /// Greatest number of steps; a search that needs more is refused. Where rotary axes correct the direction of the tool as well, three
    /// times as many.
    pub iterations: u32,
    /// Length over all slides below which a step ends the search, in mm; for the angles of rotary axes, in rad.
    pub tolerance: Real,
}

impl Convergence {
    /// The square of the tolerance, below zero where that is: no step is then small enough.
    ///
    /// Squares are compared: a root would be worked out at every step.
    #[inline]
    pub(super) const fn tolerance_squared(&self) -> Real {
        self.tolerance * self.tolerance.abs()
    }
}

impl Default for Convergence {
    /// 20 steps, 1e-10 mm or rad; in `single` 1e-6 mm or rad.
    fn default() -> Self {
        Self { iterations: 20, tolerance: TOLERANCE }
    }
}

/// The storage that a compensator works in, borrowed from the caller; what it holds before does not matter.
#[derive(Debug)]
pub struct Work<'a> {
    /// One vector for each axis.
    pub directions: &'a mut [[Real; 3]],
    /// One number for each error motion.
    pub motions: &'a mut [Real],
    /// One number for each free travel.
    pub travel: &'a mut [Real],
}

/// What was found for one sample.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Outcome {
    /// Error of the tool tip relative to the part at the position of the sample, without compensation: mm, part frame.
    pub error: [Real; 3],
    /// Error that stays at the position written, since no axis can correct it or a ramp leaves it for later cycles: mm,
    /// part frame. All of it when switched off.
    pub remaining: [Real; 3],
    /// Steps that the search took; 0 when switched off.
    pub iterations: u32,
}

/// What was found of the direction of the tool for one sample, on a machine that [corrects](super::super::Kinematics::aiming) it.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct DirectionOutcome {
    /// Error of the direction at the position of the sample, without compensation: I, J, K in rad, part frame.
    pub error: [Real; 3],
    /// Error that stays at the position written: no axis turns the direction that way, or it would have to turn too far (see
    /// [`GREATEST_AMPLIFICATION`]), or a ramp leaves it for later cycles. All of it when switched off.
    pub remaining: [Real; 3],
}

/// Why a sample was not compensated. The position written is then that of the sample.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Refusal {
    /// A slice of the sample, or `out`, has the wrong length. Nothing is written where `out` or the position has it.
    Length {
        /// The name of the slice.
        slice: &'static str,
        /// The length it needs; the least length for temperatures.
        expected: usize,
        /// The length it has.
        found: usize,
    },
    /// The sample, or the error that follows from it, holds NaN or an infinite number.
    NotFinite,
    /// The time step is below zero.
    NegativeTimeStep {
        /// The time step, in s.
        time_step: Real,
    },
    /// A motor does not stand where its axes put it, see [`Kinematics::following`](super::super::Kinematics::following).
    Motor {
        /// Index of the motor among the axes.
        axis: usize,
        /// Where its axes put it, in mm.
        expected: Real,
        /// Where the sample has it, in mm.
        found: Real,
    },
    /// The search did not settle: the error changes about as fast as the position, or faster.
    NotConverging {
        /// Steps taken.
        iterations: u32,
        /// Length of the last step over all slides, in mm.
        distance: Real,
    },
    /// The search for the angles of the rotary axes did not settle: the error of an angle changes about as fast as the angle.
    AngleNotConverging {
        /// Steps taken.
        iterations: u32,
        /// The last step over all rotary axes, in rad.
        angle: Real,
    },
    /// The correction is longer than the limit.
    OverLimit {
        /// Length of the correction over all slides, in mm.
        correction: Real,
        /// The limit, in mm.
        limit: Real,
    },
    /// The correction of the rotary axes is greater than its limit.
    OverRotationLimit {
        /// The correction over all rotary axes, in rad.
        correction: Real,
        /// The limit, in rad.
        limit: Real,
    },
    /// The axes would have to move far against one another to move the tip a little: in this pose they move it in nearly the same
    /// direction, see [`GREATEST_AMPLIFICATION`].
    NearSingular {
        /// How many times as far as the tip the axes would move.
        amplification: Real,
    },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { slice, expected, found } => {
                write!(f, "{slice}: {expected} entries needed, {found} given")
            }
            Self::NotFinite => write!(f, "a number of the sample or its error is not finite"),
            Self::NegativeTimeStep { time_step } => write!(f, "time step {time_step} s is negative"),
            Self::Motor { axis, expected, found } => {
                write!(
                    f,
                    "axis {axis} is a motor: its axes require {expected} mm, but the sample has {found} mm"
                )
            }
            Self::NotConverging { iterations, distance } => write!(
                f,
                "the compensated position was not found: step {iterations} still moves by {distance:.6} mm"
            ),
            Self::AngleNotConverging { iterations, angle } => write!(
                f,
                "the compensated angle was not found: step {iterations} still rotates by {angle:.9} rad"
            ),
            Self::NearSingular { amplification } => write!(
                f,
                "axes would have to move {amplification:.0} times as far as the tip: here two of them move it in nearly the same direction"
            ),
            Self::OverLimit { correction, limit } => {
                write!(f, "the correction of {correction:.6} mm exceeds the limit of {limit} mm")
            }
            Self::OverRotationLimit { correction, limit } => write!(
                f,
                "the correction of {correction:.9} rad of the rotary axes exceeds the limit of {limit} rad"
            ),
        }
    }
}

impl core::error::Error for Refusal {}

/// Why a compensator could not be built.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SetupError {
    /// A slice has the wrong length.
    Length {
        /// The name of the slice.
        slice: &'static str,
        /// The length it needs.
        expected: usize,
        /// The length it has.
        found: usize,
    },
    /// A travel of the machine names an axis that the machine lacks.
    TravelAxis {
        /// Index of the travel.
        travel: usize,
        /// The axis it names.
        axis: usize,
    },
    /// An entry of [`Kinematics::turning`](super::super::Kinematics::turning) names an axis or an error motion that the machine lacks,
    /// stands before one of an earlier axis, or is more than three rotary axes have.
    Turning {
        /// Index of the entry.
        turning: usize,
    },
    /// A share of [`Kinematics::following`](super::super::Kinematics::following) or, counted on behind these, of
    /// [`Kinematics::squaring`](super::super::Kinematics::squaring) names what the machine lacks, is not finite, or is one too many; or a motor
    /// follows another one.
    Share {
        /// Index of the share.
        share: usize,
    },
    /// An entry of [`Kinematics::aiming`](super::super::Kinematics::aiming) names an axis that the machine lacks, or is with those of own
    /// angles one more than three rotary axes.
    Aiming {
        /// Index of the entry.
        aiming: usize,
    },
    /// A term names an axis that the machine lacks.
    TermAxis {
        /// Index of the error motion.
        motion: usize,
        /// Index of the term in it.
        term: usize,
        /// The axis it names.
        axis: usize,
    },
    /// A parameter of a term is not finite or out of its range.
    Parameter {
        /// Index of the error motion.
        motion: usize,
        /// Index of the term in it.
        term: usize,
        /// The name of the parameter.
        parameter: &'static str,
    },
    /// A factor stands last in its list: there is no term that it could be multiplied with.
    LoneFactor {
        /// Index of the error motion.
        motion: usize,
        /// Index of the factor in it.
        term: usize,
    },
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { slice, expected, found } => {
                write!(f, "{slice}: {expected} entries needed, {found} given")
            }
            Self::TravelAxis { travel, axis } => {
                write!(f, "travel {travel} names axis {axis}, which the machine lacks")
            }
            Self::Turning { turning } => {
                write!(f, "entry {turning} of the angles that rotary axes correct is wrong")
            }
            Self::Share { share } => write!(f, "share {share} of the motors is wrong"),
            Self::Aiming { aiming } => {
                write!(f, "entry {aiming} of the axes that correct the direction of the tool is wrong")
            }
            Self::TermAxis { motion, term, axis } => {
                write!(f, "term {term} of error motion {motion} names axis {axis}, which the machine lacks")
            }
            Self::Parameter { motion, term, parameter } => {
                write!(f, "term {term} of error motion {motion}: {parameter} is out of range")
            }
            Self::LoneFactor { motion, term } => {
                write!(f, "term {term} of error motion {motion} is a factor without a term after it")
            }
        }
    }
}

impl core::error::Error for SetupError {}
