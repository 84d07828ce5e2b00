//! The fixed point: the command whose own error brings the tool to the target.
//!
//! In: the error at the target. Out: the command for which `command = target - J^+ error(command)`. It exists by itself so that the search
//! can be read at a glance: what an error is, and what the axes reach, is told around it.

use super::super::math::{add_scaled, sqrt};
use super::super::real::Real;
use super::super::{ErrorMotions, Kinematics, Sample};
use super::inverse::{Columns, Reach};
use super::prediction::{AGAIN, Prediction};
use super::turns::Turned;
use super::{Convergence, Refusal};

/// A search for the commands of the slides in one cycle.
pub(super) struct Search<'s, 'a, K: Kinematics + ?Sized, M: ErrorMotions + ?Sized> {
    pub(super) prediction: &'s mut Prediction<'a, K, M>,
    pub(super) convergence: &'s Convergence,
    pub(super) sample: &'s Sample<'s>,
    /// The directions of the axes.
    pub(super) columns: Columns<'s>,
    /// What they reach.
    pub(super) reach: Reach,
    /// The commands of the rotary axes that correct their own angles.
    pub(super) turned: Option<&'s Turned>,
}

/// Where a search has ended.
pub(super) struct Settled {
    /// `A^+ E`, of which each axis has its share.
    pub(super) pull: [Real; 3],
    /// The error that was corrected with it, E.
    pub(super) error: [Real; 3],
    pub(super) iterations: u32,
}

impl<K: Kinematics + ?Sized, M: ErrorMotions + ?Sized> Search<'_, '_, K, M> {
    /// Searches from the error at the target on, and writes the command to `out`.
    #[inline(always)]
    pub(super) fn run(mut self, at_target: [Real; 3], out: &mut [Real]) -> Result<Settled, Refusal> {
        let tolerance = self.convergence.tolerance_squared();
        let (mut error, mut undone) = (at_target, [0.0; 3]);
        let mut step = Real::INFINITY;
        for before in 0..self.convergence.iterations {
            let iterations = before.saturating_add(1);
            let pull = self.command(error, out);
            step = self.step_squared(error, undone);
            if step <= tolerance {
                return Ok(Settled { pull, error, iterations });
            }
            let finite = step < Real::INFINITY;
            if !finite {
                return Err(Refusal::NotConverging { iterations, distance: Real::INFINITY });
            }
            undone = error;
            error = self.error(out)?;
        }
        Err(Refusal::NotConverging { iterations: self.convergence.iterations, distance: sqrt(step) })
    }

    /// Writes the command that undoes an error: `target - J^+ error`.
    #[inline(always)]
    fn command(&self, error: [Real; 3], out: &mut [Real]) -> [Real; 3] {
        let pull = self.reach.apply(error);
        self.columns.correct(self.sample.position, pull, out);
        if let Some(turned) = self.turned {
            turned.write(out);
        }
        self.prediction.let_motors_follow(self.sample.position, out);
        pull
    }

    /// The error at a command, which is there to be undone.
    #[inline(always)]
    fn error(&mut self, out: &mut [Real]) -> Result<[Real; 3], Refusal> {
        match self.turned {
            None => self.prediction.corrected::<AGAIN>(self.sample, out),
            Some(turned) => self.prediction.left_to_slides::<AGAIN>(self.sample, turned, out),
        }
    }

    /// The square of how far the axes go from one command to the next. It is taken from the errors: far from the origin, commands are too
    /// coarse to tell when a search ends.
    #[inline(always)]
    fn step_squared(&self, error: [Real; 3], undone: [Real; 3]) -> Real {
        self.reach.distance_squared(add_scaled(error, -1.0, undone)) + self.prediction.motors_moved()
    }
}
