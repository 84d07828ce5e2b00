//! The way between rows: where an axis was a little earlier than a row says.
//!
//! In: times and programmed positions of the rows of a recording, and the time constant of the position loop. Out: positions
//! at the rows, or a clock's offset before them. Without a loop the way is a smooth curve through the rows, straight at
//! corners; behind a loop it is the loop's own solution for a command that is straight between rows.

use crate::position_loop::{Follower, PositionLoop, Stand};

/// The way of one axis.
pub(crate) struct Way<'w> {
    time: &'w [f64],
    command: &'w [f64],
    /// The slope of the curve at each row.
    slopes: Vec<f64>,
    /// Whether the path turns sharply at a row.
    corners: Vec<bool>,
    fastest: f64,
}

/// The change of speed, as a share of the highest, from which on a path turns sharply.
pub(crate) const CORNER: f64 = 0.3;

impl<'w> Way<'w> {
    /// The way of a programmed axis; `slopes` are its derivatives at the rows.
    pub(crate) fn new(time: &'w [f64], command: &'w [f64], slopes: Vec<f64>) -> Self {
        let chord = |row: usize| (command[row] - command[row - 1]) / (time[row] - time[row - 1]);
        let fastest =
            (1..time.len()).map(|row| chord(row).abs()).filter(|v| v.is_finite()).fold(0.0, f64::max);
        let corner = |row: usize| {
            let inside = row > 0 && row + 1 < time.len();
            // A gap is a corner: nothing is known of the way through it.
            !inside || {
                let change = (chord(row + 1) - chord(row)).abs();
                change.is_nan() || change > CORNER * fastest
            }
        };
        let corners = (0..time.len()).map(corner).collect();
        Self { time, command, slopes, corners, fastest }
    }

    /// The highest programmed speed.
    pub(crate) fn fastest(&self) -> f64 {
        self.fastest
    }

    /// Where it begins; NaN where that is not known.
    pub(crate) fn first(&self) -> f64 {
        self.command.first().copied().unwrap_or(f64::NAN)
    }

    /// The position a clock's offset before each row.
    pub(crate) fn earlier(&self, clock: f64) -> Vec<f64> {
        if clock == 0.0 {
            return self.command.to_vec();
        }
        self.each_earlier(clock, |from, share| self.between(from, share))
    }

    /// Where the axis stands behind a loop, a clock's offset before each row.
    pub(crate) fn behind_loop(
        &self,
        position_loop: PositionLoop,
        start: Option<Stand>,
        clock: f64,
    ) -> Vec<Stand> {
        let mut follower = Follower::from(start);
        let rows = self.time.iter().zip(self.command);
        let followed: Vec<Stand> =
            rows.map(|(time, command)| position_loop.follow(&mut follower, *time, *command)).collect();
        if clock == 0.0 {
            return followed;
        }
        self.each_earlier(clock, |from, share| {
            if share == 0.0 {
                return followed[from];
            }
            let (step, _) = self.chord(from);
            position_loop.step(followed[from], self.command[from], self.straight(from, share), share * step)
        })
    }

    /// For each row the step in which the wanted instant lies: its first row, and the share of the step; before the first
    /// row and behind the last the axis rests.
    fn each_earlier<T>(&self, clock: f64, value: impl Fn(usize, f64) -> T) -> Vec<T> {
        let time = self.time;
        let mut from = 0;
        (0..time.len())
            .map(|row| {
                let wanted = time[row] - clock;
                while from + 1 < time.len() && time[from + 1] <= wanted {
                    from += 1;
                }
                while from > 0 && time[from] > wanted {
                    from -= 1;
                }
                if from + 1 == time.len() || wanted <= time[from] {
                    return value(from, 0.0);
                }
                value(from, (wanted - time[from]) / (time[from + 1] - time[from]))
            })
            .collect()
    }

    fn chord(&self, from: usize) -> (f64, f64) {
        let step = self.time[from + 1] - self.time[from];
        (step, (self.command[from + 1] - self.command[from]) / step)
    }

    fn straight(&self, from: usize, share: f64) -> f64 {
        self.command[from] + share * (self.command[from + 1] - self.command[from])
    }

    /// The cubic with the slopes at both rows; a straight line where one of them is a corner.
    fn between(&self, from: usize, share: f64) -> f64 {
        if share == 0.0 {
            return self.command[from];
        }
        if self.corners[from] || self.corners[from + 1] {
            return self.straight(from, share);
        }
        let (step, slope) = self.chord(from);
        let (first, last) = (self.slopes[from] - slope, self.slopes[from + 1] - slope);
        let rest = 1.0 - share;
        self.straight(from, share) + step * share * rest * (first * rest - last * share)
    }
}
