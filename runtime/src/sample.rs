//! The state of the machine in one servo cycle.
//!
//! In: what the controller knows. Out: the argument of every term. It exists so that all terms read one state, the
//! same that the inverse evaluates at other positions.

mod readings;

use super::Direction;
use super::math::nothing;
use super::real::Real;

pub(crate) use self::readings::{OneSample, number};

/// The state of the machine in one servo cycle, borrowed from the caller.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Sample<'a> {
    /// Position of each axis in mm or rad: the position wanted, in machine coordinates.
    pub position: &'a [Real],
    /// Each free travel in mm; empty: each travel is the position of its axis, that of the compensated command included.
    pub travel: &'a [Real],
    /// Direction of each axis's last real motion, see [`DirectionTracker`](super::DirectionTracker).
    pub direction: &'a [Direction],
    /// Velocity of each axis in mm/s or rad/s; may be empty where no term reads one.
    pub velocity: &'a [Real],
    /// Temperature of each sensor in degC; may be empty where no term reads a sensor.
    pub temperature: &'a [Real],
    /// Time since the sample before this one, in s; not negative.
    pub time_step: Real,
}

impl Sample<'_> {
    /// Position of an axis; NaN where the slice is too short.
    #[inline]
    pub(crate) fn position(&self, axis: usize) -> Real {
        number(self.position, axis)
    }

    /// Temperature of a sensor; NaN where the slice is too short.
    #[inline]
    pub(crate) fn temperature(&self, sensor: usize) -> Real {
        number(self.temperature, sensor)
    }

    /// Direction of an axis; none where the slice is too short.
    pub(crate) fn direction(&self, axis: usize) -> Option<Direction> {
        self.direction.get(axis).copied()
    }

    /// Whether every number of the sample is finite.
    #[inline]
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let slices = [self.position, self.travel, self.velocity, self.temperature];
        slices.into_iter().fold(self.time_step * 0.0, nothing) == 0.0
    }
}
