//! What the axes have done: directions and velocities.
//!
//! In: the positions of one cycle after another, and the corrections made. Out: for each axis the direction of its last real
//! motion and its velocity. It exists because controllers command positions, and terms ask for more.
//!
//! A screw turns with the command that it is sent, correction included. Where a program lets an axis stand, a correction still
//! moves it, there and back, through its play. So the direction is that of the corrected command, with one exception: a
//! change of correction that a reversal causes never counts as another reversal.

use abbe_runtime::Direction;

use super::Inputs;
use crate::status::Status;

/// How far an axis must move back before its direction counts as turned, unless it is told: mm, or deg for a rotary axis.
const HYSTERESIS: f64 = 0.001;

/// The axes' last motions.
pub(super) struct Tracks {
    axes: Vec<Track>,
    /// The longest time that a correction needs to reach its new value after a reversal, s.
    transition: f64,
    /// Time since the last reversal of any axis, s.
    since_reversal: f64,
    /// Positions of the last cycle whose numbers were all finite; empty before it.
    last_position: Vec<f64>,
    /// Time since `last_position`, s.
    since_last_position: f64,
    direction: Vec<Direction>,
    velocity: Vec<f64>,
}

/// The last motion of one axis.
#[derive(Clone, Copy)]
struct Track {
    /// How far it must move back before its direction turns.
    threshold: f64,
    direction: Direction,
    /// None before the first cycle.
    last: Option<Last>,
}

/// What an axis did until the last cycle.
#[derive(Clone, Copy)]
struct Last {
    /// The furthest corrected command in its direction, shifted by the changes of correction that reversals cause.
    furthest: f64,
    /// Its correction.
    correction: f64,
}

impl Track {
    const fn new(threshold: f64) -> Self {
        Self { threshold, direction: Direction::Positive, last: None }
    }

    /// Takes the position of this cycle and the correction found in the previous cycle. Returns whether the axis has reversed. While
    /// corrections still change because of a reversal, their changes are no motion.
    fn follow(&mut self, position: f64, correction: f64, reversing: bool) -> bool {
        let sent = position + correction;
        let last = self.last.unwrap_or(Last { furthest: sent, correction });
        let added = if reversing { correction - last.correction } else { 0.0 };
        let furthest = last.furthest + added;
        let turned = (sent - furthest) * self.direction.sign() < -self.threshold;
        if turned {
            self.direction = self.direction.reversed();
        }
        let furthest = if turned { sent } else { self.further(furthest, sent) };
        self.last = Some(Last { furthest, correction });
        turned
    }

    /// The one of two places that lies further in the axis's direction.
    const fn further(&self, one: f64, other: f64) -> f64 {
        match self.direction {
            Direction::Positive => one.max(other),
            Direction::Negative => one.min(other),
        }
    }
}

impl Tracks {
    /// Axes that have not moved yet, rotary or not; `transition` tells how long corrections may be on their way
    /// after a reversal, s.
    pub(super) fn new(rotary: impl Iterator<Item = bool>, transition: f64) -> Self {
        let threshold = |rotary| if rotary { HYSTERESIS.to_radians() } else { HYSTERESIS };
        let axes: Vec<_> = rotary.map(|rotary| Track::new(threshold(rotary))).collect();
        let count = axes.len();
        Self {
            axes,
            transition,
            since_reversal: f64::INFINITY,
            last_position: Vec::with_capacity(count),
            since_last_position: 0.0,
            direction: vec![Direction::default(); count],
            velocity: vec![0.0; count],
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

    /// Sets the threshold of an axis and forgets its motion: its direction starts again as positive.
    pub(super) fn set_hysteresis(&mut self, axis: usize, threshold: f64) -> Status {
        match self.axes.get_mut(axis) {
            Some(track) if threshold.is_finite() && threshold >= 0.0 => {
                *track = Track::new(threshold);
                Status::Done
            }
            _ => Status::OutOfRange,
        }
    }

    /// Forgets all motion.
    pub(super) fn restart(&mut self) {
        for track in &mut self.axes {
            *track = Track::new(track.threshold);
        }
        self.since_reversal = f64::INFINITY;
        self.last_position.clear();
        self.since_last_position = 0.0;
        self.velocity.fill(0.0);
    }

    /// Takes the positions of a cycle, with the corrections of the one before it. A direction that is given is taken; all are
    /// followed, so that one may be given in some cycles only.
    pub(super) fn follow(&mut self, inputs: &Inputs<'_>, corrections: &[f64]) {
        let reversing = self.since_reversal <= self.transition;
        let mut turned = false;
        let axes = self.axes.iter_mut().zip(&mut self.direction);
        let commands = inputs.position.iter().zip(corrections);
        for (axis, ((track, direction), (&position, &correction))) in axes.zip(commands).enumerate() {
            if position.is_finite() {
                turned |= track.follow(position, correction, reversing);
            }
            *direction = match inputs.direction.get(axis) {
                Some(&given) if given > 0.0 => Direction::Positive,
                Some(&given) if given < 0.0 => Direction::Negative,
                _ => track.direction,
            };
        }
        // A negative time step, or one that is no number, counts as 0.
        let time_step = if inputs.time_step > 0.0 { inputs.time_step } else { 0.0 };
        // 0 in the cycle of the reversal: its correction comes back one cycle later.
        self.since_reversal = if turned { 0.0 } else { self.since_reversal + time_step };
        self.follow_velocity(inputs.position, inputs.time_step);
    }

    /// Takes the velocities from the last finite positions on, however long ago these were.
    fn follow_velocity(&mut self, position: &[f64], time_step: f64) {
        if time_step.is_finite() && time_step > 0.0 {
            self.since_last_position += time_step;
        }
        if !position.iter().all(|position| position.is_finite()) {
            return;
        }
        if self.since_last_position > 0.0 {
            for ((velocity, to), from) in self.velocity.iter_mut().zip(position).zip(&self.last_position) {
                *velocity = (to - from) / self.since_last_position;
            }
        }
        if self.since_last_position > 0.0 || self.last_position.is_empty() {
            self.last_position.clear();
            self.last_position.extend_from_slice(position);
            self.since_last_position = 0.0;
        }
    }
}
