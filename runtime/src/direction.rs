//! The direction of an axis's last real motion.
//!
//! In: positions, one a cycle. Out: a [`Direction`], which chooses the curve of a table and the sign of a backlash. It
//! exists because the sign of the velocity is no direction: at rest an encoder dithers by a count or two, and a table
//! that flipped with it would shake the axis by the whole lost motion.

use super::real::Real;

/// The direction of the last real motion of an axis.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Direction {
    /// Towards greater positions; also the direction before the first motion.
    #[default]
    Positive,
    /// Towards smaller positions.
    Negative,
}

impl Direction {
    /// +1.0 or -1.0.
    #[must_use]
    pub const fn sign(self) -> Real {
        match self {
            Self::Positive => 1.0,
            Self::Negative => -1.0,
        }
    }

    /// The other direction.
    #[must_use]
    pub const fn reversed(self) -> Self {
        match self {
            Self::Positive => Self::Negative,
            Self::Negative => Self::Positive,
        }
    }
}

/// Follows the positions of one axis and tells the direction of its last real motion, with hysteresis.
///
/// The direction turns when the axis has moved back by more than `threshold` from the furthest point that it reached.
/// Before the first real motion the direction is positive.
///
/// ```
/// use abbe_runtime::{Direction, DirectionTracker};
/// let mut tracker = DirectionTracker::new(0.001);
/// tracker.update(10.0);
/// assert_eq!(tracker.update(9.9995), Direction::Positive); // half a threshold: dither
/// assert_eq!(tracker.update(9.9980), Direction::Negative);
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct DirectionTracker {
    threshold: Real,
    furthest: Option<Real>,
    direction: Direction,
}

impl DirectionTracker {
    /// A tracker that has seen no position yet. `threshold` is in the unit of the axis (mm or rad); a negative one or
    /// NaN counts as zero, which turns at every step back.
    #[must_use]
    pub const fn new(threshold: Real) -> Self {
        let threshold = if threshold > 0.0 { threshold } else { 0.0 };
        Self { threshold, furthest: None, direction: Direction::Positive }
    }

    /// The distance back, in mm or rad, that must be exceeded before the direction turns.
    #[must_use]
    pub const fn threshold(&self) -> Real {
        self.threshold
    }

    /// The direction after the positions seen so far.
    #[must_use]
    pub const fn direction(&self) -> Direction {
        self.direction
    }

    /// Takes the position of this cycle and returns the direction after it. A position that is not finite is ignored.
    pub fn update(&mut self, position: Real) -> Direction {
        if position.is_finite() {
            let onward = (position - self.furthest.unwrap_or(position)) * self.direction.sign();
            if onward < -self.threshold {
                self.direction = self.direction.reversed();
                self.furthest = Some(position);
            } else if onward > 0.0 || self.furthest.is_none() {
                self.furthest = Some(position);
            }
        }
        self.direction
    }
}
