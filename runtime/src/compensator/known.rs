//! What is known of a machine before it runs.
//!
//! In: the equations of a machine. Out: what it has, and what its axes reach as far as the machine itself tells. It exists since most
//! machines have no motors, and no axis that corrects itself or the tool: where the code of a machine is known when a program is compiled,
//! so are these answers, and nothing is left of what hangs on them.

use super::super::Kinematics;
use super::super::real::Real;
use super::inverse::{Columns, Reach};

/// What a compensator asks a machine first.
pub(super) trait Known: Kinematics {
    /// Whether some of its axes are motors that follow others.
    #[inline(always)]
    fn has_motors(&self) -> bool {
        !self.following().is_empty()
    }

    /// Whether motors correct error motions by themselves.
    #[inline(always)]
    fn motors_correct(&self) -> bool {
        !self.squaring().is_empty()
    }

    /// Whether rotary axes correct their own angles.
    #[inline(always)]
    fn axes_turn(&self) -> bool {
        !self.turning().is_empty()
    }

    /// Whether rotary axes correct the direction of the tool.
    #[inline(always)]
    fn axes_aim(&self) -> bool {
        !self.aiming().is_empty()
    }

    /// The directions of the axes: those that are known, or else these.
    #[inline(always)]
    fn columns<'c>(&'c self, found: &'c [[Real; 3]]) -> Columns<'c> {
        match self.fixed_directions() {
            Some(known) => Columns::Known(known),
            None => Columns::Found { columns: found, resting: self.resting() },
        }
    }

    /// What the axes reach at every position, where they are at right angles.
    #[inline(always)]
    fn reach(&self) -> Option<Reach> {
        self.fixed_directions().and_then(Reach::at_right_angles)
    }
}

impl<K: Kinematics + ?Sized> Known for K {}
