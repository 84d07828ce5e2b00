//! The way between rows: where an axis was a little earlier than a row says.
//!
//! In: times and programmed positions of the rows of a recording, its legs, and the time constant of the position loop. Out:
//! positions at the rows, or a clock's offset before them. Without a loop the way is a smooth curve through the rows, straight at
//! corners; behind a loop it is the loop's own solution for a command that is straight between rows, or bends there. No way leads
//! from one leg to the next: before the first row of a leg and behind its last the axis rests.

mod bends;

use std::ops::Range;

use crate::legs::stretches;
use crate::position_loop::{Follower, Piece, PositionLoop, Stand, Start};

/// The way of one axis.
pub(crate) struct Way<'w> {
    time: &'w [f64],
    command: &'w [f64],
    legs: &'w [usize],
    fastest: f64,
    /// The acceleration of the command in the step that begins at each row; empty where it goes straight.
    accelerations: Vec<f64>,
}

/// The way as a smooth curve through the rows, for an axis without a loop.
pub(crate) struct Curve<'w> {
    way: &'w Way<'w>,
    /// The slope of the curve at each row.
    slopes: Vec<f64>,
    /// Whether the path turns sharply at a row.
    corners: Vec<bool>,
}

/// The change of speed, as a share of the highest, from which on a path turns sharply.
pub(crate) const CORNER: f64 = 0.3;

impl<'w> Way<'w> {
    /// The way of a programmed axis.
    pub(crate) fn new(time: &'w [f64], command: &'w [f64], legs: &'w [usize]) -> Self {
        let mut way = Self { time, command, legs, fastest: 0.0, accelerations: Vec::new() };
        way.fastest = way.velocities().map(f64::abs).fold(0.0, f64::max);
        way
    }

    /// The velocity in each step within a leg, where it is known.
    fn velocities(&self) -> impl Iterator<Item = f64> {
        let driven = (1..self.time.len()).filter(|row| self.legs[*row] == self.legs[*row - 1]);
        driven.map(|row| self.chord(row - 1).1).filter(|velocity| velocity.is_finite())
    }

    /// Whether the velocity is not the same everywhere: a reversal is the largest change.
    pub(crate) fn changes_speed(&self) -> bool {
        let ends = |(low, high): (f64, f64), velocity: f64| (low.min(velocity), high.max(velocity));
        let (low, high) = self.velocities().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
        high - low > CORNER * self.fastest
    }

    /// The same way where the command bends between rows, for a loop that follows it.
    pub(crate) fn bending(mut self) -> Self {
        self.accelerations = bends::accelerations(self.time, self.command, self.legs);
        self
    }

    fn acceleration(&self, from: usize) -> f64 {
        self.accelerations.get(from).copied().unwrap_or(0.0)
    }

    /// Where the axis stands in a row behind a loop that has followed the rows before.
    pub(crate) fn follow(&self, position_loop: PositionLoop, follower: &mut Follower, row: usize) -> Stand {
        let acceleration = row.checked_sub(1).map_or(0.0, |from| self.acceleration(from));
        position_loop.follow(follower, self.time[row], self.command[row], acceleration)
    }

    /// The curve through the rows; `slopes` are the derivatives of the way there.
    pub(crate) fn curve(&'w self, slopes: Vec<f64>) -> Curve<'w> {
        let corners = (0..self.time.len()).map(|row| self.turns_sharply(row)).collect();
        Curve { way: self, slopes, corners }
    }

    fn turns_sharply(&self, row: usize) -> bool {
        // Nothing is known of the way before the first row, behind the last and through a gap.
        let inside = row > 0 && row + 1 < self.time.len() && self.legs[row - 1] == self.legs[row + 1];
        if !inside {
            return true;
        }
        let change = (self.chord(row).1 - self.chord(row - 1).1).abs();
        change.is_nan() || change > CORNER * self.fastest
    }

    /// The programmed positions.
    pub(crate) fn command(&self) -> &[f64] {
        self.command
    }

    /// The highest programmed speed.
    pub(crate) fn fastest(&self) -> f64 {
        self.fastest
    }

    /// The rows of each leg.
    pub(crate) fn stretches(&self) -> impl Iterator<Item = Range<usize>> {
        stretches(self.legs)
    }

    /// Velocity and acceleration of the command in the first of some rows; `None` where too few rows tell.
    pub(crate) fn first_motion(&self, rows: Range<usize>) -> Option<(f64, f64)> {
        bends::first_motion(&self.time[rows.clone()], &self.command[rows])
    }

    /// Where the axis stands behind a loop, a clock's offset before each row; `starts` tells for each leg how it begins.
    pub(crate) fn behind_loop(
        &self,
        position_loop: PositionLoop,
        starts: &[Start],
        clock: f64,
    ) -> Vec<Stand> {
        let mut followed: Vec<Stand> = Vec::with_capacity(self.time.len());
        for (rows, start) in self.stretches().zip(starts) {
            let mut follower = Follower::from(*start);
            followed.extend(rows.map(|row| self.follow(position_loop, &mut follower, row)));
        }
        if clock == 0.0 {
            return followed;
        }
        self.each_earlier(clock, |from, share| {
            if share == 0.0 {
                return followed[from];
            }
            let (step, _) = self.chord(from);
            let acceleration = self.acceleration(from);
            let beside = 0.5 * acceleration * step * step * share * (share - 1.0);
            let to = self.straight(from, share) + beside;
            let piece = Piece { from: self.command[from], to, time: share * step, acceleration };
            position_loop.step(followed[from], piece)
        })
    }

    /// For each row the step in which the wanted instant lies: its first row, and the share of the step; before the first
    /// row of its leg and behind the last the axis rests.
    fn each_earlier<T>(&self, clock: f64, value: impl Fn(usize, f64) -> T) -> Vec<T> {
        let time = self.time;
        let mut values = Vec::with_capacity(time.len());
        for rows in self.stretches() {
            let mut from = rows.start;
            values.extend(rows.clone().map(|row| {
                let wanted = time[row] - clock;
                while from + 1 < rows.end && time[from + 1] <= wanted {
                    from += 1;
                }
                while from > rows.start && time[from] > wanted {
                    from -= 1;
                }
                if from + 1 == rows.end || wanted <= time[from] {
                    return value(from, 0.0);
                }
                value(from, (wanted - time[from]) / (time[from + 1] - time[from]))
            }));
        }
        values
    }

    /// The time of the step that begins at a row, and the speed in it.
    fn chord(&self, from: usize) -> (f64, f64) {
        let step = self.time[from + 1] - self.time[from];
        (step, (self.command[from + 1] - self.command[from]) / step)
    }

    fn straight(&self, from: usize, share: f64) -> f64 {
        self.command[from] + share * (self.command[from + 1] - self.command[from])
    }

    /// The way in the step that begins at a row, if the corner of the path lies within it: along the line of the step before, and from
    /// where it meets that of the step behind along that one.
    fn around_corner(&self, from: usize, share: f64) -> Option<f64> {
        let of_one_leg = from > 0 && from + 2 < self.time.len() && self.legs[from - 1] == self.legs[from + 2];
        if !of_one_leg {
            return None;
        }
        let [(_, before), (step, _), (_, behind)] = [from - 1, from, from + 1].map(|row| self.chord(row));
        let [first, last] = [self.command[from], self.command[from + 1]];
        let meet = (last - behind * step - first) / ((before - behind) * step);
        if !(0.0..=1.0).contains(&meet) {
            return None;
        }
        if share < meet {
            Some(first + before * share * step)
        } else {
            Some(last - behind * (1.0 - share) * step)
        }
    }
}

impl Curve<'_> {
    /// The position a clock's offset before each row.
    pub(crate) fn earlier(&self, clock: f64) -> Vec<f64> {
        if clock == 0.0 {
            return self.way.command.to_vec();
        }
        self.way.each_earlier(clock, |from, share| self.between(from, share))
    }

    /// The cubic with the slopes at both rows; straight lines where one of them is a corner.
    fn between(&self, from: usize, share: f64) -> f64 {
        if share == 0.0 {
            return self.way.command[from];
        }
        if self.corners[from] && self.corners[from + 1] {
            return self.way.around_corner(from, share).unwrap_or_else(|| self.way.straight(from, share));
        }
        if self.corners[from] || self.corners[from + 1] {
            return self.way.straight(from, share);
        }
        let (step, slope) = self.way.chord(from);
        let (first, last) = (self.slopes[from] - slope, self.slopes[from + 1] - slope);
        let rest = 1.0 - share;
        self.way.straight(from, share) + step * share * rest * (first * rest - last * share)
    }
}
