//! What the axes have done: directions and velocities.
//!
//! In: the positions of one cycle after another. Out: for each axis the direction of its last real motion and its velocity.
//! It exists because controllers command positions, and terms ask for more.

use abbe_runtime::{Direction, DirectionTracker};

use super::Inputs;
use crate::status::Status;

/// How far an axis must move back before its direction counts as turned, unless it is told: mm, or deg for a rotary axis.
const HYSTERESIS: f64 = 0.001;

/// The axes' last motions.
pub(super) struct Tracks {
    trackers: Vec<DirectionTracker>,
    /// Positions of the last cycle whose numbers were all finite; empty before it.
    from: Vec<f64>,
    /// Time since then, s.
    since: f64,
    direction: Vec<Direction>,
    velocity: Vec<f64>,
}

impl Tracks {
    /// Axes that have not moved yet, rotary or not.
    pub(super) fn new(rotary: impl Iterator<Item = bool>) -> Self {
        let threshold = |rotary| if rotary { HYSTERESIS.to_radians() } else { HYSTERESIS };
        let trackers: Vec<_> = rotary.map(|rotary| DirectionTracker::new(threshold(rotary))).collect();
        let axes = trackers.len();
        Self {
            trackers,
            from: Vec::with_capacity(axes),
            since: 0.0,
            direction: vec![Direction::default(); axes],
            velocity: vec![0.0; axes],
        }
    }

    /// The direction of each axis's last real motion.
    pub(super) fn direction(&self) -> &[Direction] {
        &self.direction
    }

    /// The velocity of each axis, mm/s or rad/s.
    pub(super) fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Sets the threshold of an axis.
    pub(super) fn set_hysteresis(&mut self, axis: usize, threshold: f64) -> Status {
        match self.trackers.get_mut(axis) {
            Some(tracker) if threshold.is_finite() && threshold >= 0.0 => {
                *tracker = DirectionTracker::new(threshold);
                Status::Done
            }
            _ => Status::OutOfRange,
        }
    }

    /// Forgets all motion.
    pub(super) fn restart(&mut self) {
        for tracker in &mut self.trackers {
            *tracker = DirectionTracker::new(tracker.threshold());
        }
        self.from.clear();
        self.since = 0.0;
        self.velocity.fill(0.0);
    }

    /// Takes the positions of a cycle. A direction that is given is taken; all are followed, so that one may be given in some
    /// cycles only.
    pub(super) fn follow(&mut self, inputs: &Inputs<'_>) {
        let axes = self.trackers.iter_mut().zip(&mut self.direction);
        for (axis, ((tracker, direction), &position)) in axes.zip(inputs.position).enumerate() {
            let found = tracker.update(position);
            *direction = match inputs.direction.get(axis) {
                Some(&given) if given > 0.0 => Direction::Positive,
                Some(&given) if given < 0.0 => Direction::Negative,
                _ => found,
            };
        }
        self.follow_velocity(inputs.position, inputs.time_step);
    }

    /// Takes the velocities from the last finite positions on, however long ago these were.
    fn follow_velocity(&mut self, position: &[f64], time_step: f64) {
        if time_step.is_finite() && time_step > 0.0 {
            self.since += time_step;
        }
        if !position.iter().all(|position| position.is_finite()) {
            return;
        }
        if self.since > 0.0 {
            for ((velocity, to), from) in self.velocity.iter_mut().zip(position).zip(&self.from) {
                *velocity = (to - from) / self.since;
            }
        }
        if self.since > 0.0 || self.from.is_empty() {
            self.from.clear();
            self.from.extend_from_slice(position);
            self.since = 0.0;
        }
    }
}
