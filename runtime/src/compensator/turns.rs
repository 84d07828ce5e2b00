//! The commands of rotary axes that correct their own angle.
//!
//! In: the error motions of those angles, and the state of the machine in one cycle. Out: the command of each such axis, at which
//! it stands at the angle wanted. It exists apart from the search for the slides, since an angle that is right on its own axis moves
//! the tip nowhere and leaves its direction right; the slides then correct what is left.

use super::super::math::sqrt;
use super::super::real::{COARSE, Real};
use super::super::sample::{OneSample, number};
use super::super::{ErrorMotion, Kinematics, Sample, TermState, Turning};
use super::report::{Convergence, Refusal, SetupError};
use super::tilts::AXES;

/// The greatest number of error motions of own angles: for each rotary axis its positioning error and its zero.
pub(super) const MOST: usize = 6;

/// The error motion of an axis's own angle, and the number of terms before its own.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Own {
    turning: Turning,
    first_term: usize,
}

/// The error motions of own angles that have terms, in the order of their axes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct Turns {
    own: [Option<Own>; MOST],
}

/// The commands of the rotary axes that correct their own angle.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct Turned {
    commands: [Option<(usize, Real)>; AXES],
}

impl Turns {
    /// Those of a machine, but for what its calibration leaves without terms.
    ///
    /// # Errors
    /// Tells the first entry that names an axis or an error motion which the machine lacks, or is one too many.
    pub(super) fn new<K: Kinematics + ?Sized>(
        kinematics: &K,
        motions: &[ErrorMotion<'_>],
    ) -> Result<Self, SetupError> {
        let mut turns = Self::default();
        let mut free = turns.own.iter_mut();
        for (number, &turning) in kinematics.turning().iter().enumerate() {
            let mistake = SetupError::Turning { turning: number };
            let motion = motions.get(turning.motion).ok_or(mistake)?;
            if turning.axis >= kinematics.axes() || !is_in_order(kinematics.turning(), number) {
                return Err(mistake);
            }
            let place = free.next().ok_or(mistake)?;
            if !motion.terms.is_empty() {
                let before = motions.iter().take(turning.motion);
                let first_term = before.fold(0_usize, |sum, motion| sum.saturating_add(motion.terms.len()));
                *place = Some(Own { turning, first_term });
            }
        }
        Ok(turns)
    }

    /// Whether there is nothing to correct.
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.own.iter().all(Option::is_none)
    }

    /// The error motions of own angles.
    #[inline]
    pub(super) fn motions(&self) -> impl Iterator<Item = usize> {
        self.own.iter().flatten().map(|own| own.turning.motion)
    }

    /// What is corrected of an error motion in this cycle, at a position; zero where it is that of no own angle.
    pub(super) fn corrected(
        &self,
        motion: usize,
        motions: &[ErrorMotion<'_>],
        states: &[TermState],
        sample: &Sample<'_>,
        position: &[Real],
    ) -> Real {
        let own = self.own.iter().flatten().find(|own| own.turning.motion == motion);
        own.map_or(0.0, |own| own.corrected(motions, states, sample, position))
    }

    /// Searches for the commands c for which `c + e(c)` is the angle wanted, e being the error of an axis's own angle, and writes
    /// them to `out`, which holds the position of the sample.
    pub(super) fn search(
        &self,
        motions: &[ErrorMotion<'_>],
        states: &[TermState],
        sample: &Sample<'_>,
        convergence: &Convergence,
        out: &mut [Real],
    ) -> Result<Turned, Refusal> {
        let bound = convergence.tolerance_squared();
        let mut square = Real::INFINITY;
        for _ in 0..convergence.iterations {
            let turned = self.step(motions, states, sample, out);
            square = turned.step_squared(out);
            if !square.is_finite() {
                return Err(Refusal::NotFinite);
            }
            turned.write(out);
            if square <= bound {
                return Ok(turned);
            }
        }
        Err(Refusal::AngleNotConverging { iterations: convergence.iterations, angle: sqrt(square) })
    }

    /// The commands that undo the errors at these positions.
    fn step(
        &self,
        motions: &[ErrorMotion<'_>],
        states: &[TermState],
        sample: &Sample<'_>,
        position: &[Real],
    ) -> Turned {
        let mut turned = Turned::default();
        for own in self.own.iter().flatten() {
            let axis = own.turning.axis;
            turned.add(
                axis,
                number(sample.position, axis),
                -own.corrected(motions, states, sample, position),
            );
        }
        turned
    }
}

impl Own {
    /// The part of the error that is corrected in this cycle, rad; NaN where there are no such terms.
    fn corrected(
        &self,
        motions: &[ErrorMotion<'_>],
        states: &[TermState],
        sample: &Sample<'_>,
        position: &[Real],
    ) -> Real {
        let Some(motion) = motions.get(self.turning.motion) else { return Real::NAN };
        let last_term = self.first_term.saturating_add(motion.terms.len());
        let states = states.get(self.first_term..last_term).unwrap_or_default();
        motion.read(&mut OneSample::at(sample, position), states, true)
    }
}

impl Turned {
    /// Adds to the command of an axis, which is the target before.
    pub(super) fn add(&mut self, axis: usize, target: Real, correction: Real) {
        let known = self.commands.iter_mut().find(|known| known.is_none_or(|(known, _)| known == axis));
        if let Some(command) = known {
            let (_, before) = command.unwrap_or((axis, target));
            *command = Some((axis, before + correction));
        }
    }

    /// How far the axes turn, over all of them, where commands are corrections: rad.
    pub(super) fn length(&self) -> Real {
        sqrt(self.iter().fold(0.0, |sum, (_, command)| sum + command * command))
    }

    /// The axes that have a command, and these commands.
    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, Real)> {
        self.commands.iter().flatten().copied()
    }

    /// The square of the way from these positions to the commands, over all axes that have one.
    pub(super) fn distance_squared(&self, position: &[Real]) -> Real {
        self.commands.iter().flatten().fold(0.0, |sum, &(axis, command)| {
            let part = command - number(position, axis);
            sum + part * part
        })
    }

    /// [`distance_squared`](Self::distance_squared) as a step of a search: where commands are coarse, one between neighbours is none.
    #[inline]
    pub(super) fn step_squared(&self, position: &[Real]) -> Real {
        if !COARSE {
            return self.distance_squared(position);
        }
        self.commands.iter().flatten().fold(0.0, |sum, &(axis, command)| {
            let part = command - number(position, axis);
            // A number of this size has steps of half as much, or as much.
            let neighbours = part.abs() <= Real::EPSILON * command.abs();
            if neighbours { sum } else { sum + part * part }
        })
    }

    /// How far the axes turn from their targets, over all of them: rad.
    pub(super) fn correction(&self, target: &[Real]) -> Real {
        sqrt(self.distance_squared(target))
    }

    /// Writes the commands.
    #[inline]
    pub(super) fn write(&self, out: &mut [Real]) {
        for &(axis, command) in self.commands.iter().flatten() {
            set(out, axis, command);
        }
    }

    /// Writes in their place where the axes really stand with them: at the angles wanted.
    #[inline]
    pub(super) fn stand(&self, target: &[Real], out: &mut [Real]) {
        for &(axis, _) in self.commands.iter().flatten() {
            set(out, axis, number(target, axis));
        }
    }
}

/// Writes one number, where there is a place for it.
fn set(out: &mut [Real], axis: usize, number: Real) {
    if let Some(out) = out.get_mut(axis) {
        *out = number;
    }
}

/// Whether the entries of an axis stand together: none of it before its neighbour of another axis.
fn is_in_order(turning: &[Turning], number: usize) -> bool {
    let (before, rest) = turning.split_at_checked(number).unwrap_or_default();
    match (before.last(), rest.first()) {
        (Some(before), Some(own)) => before.axis <= own.axis,
        _ => true,
    }
}
