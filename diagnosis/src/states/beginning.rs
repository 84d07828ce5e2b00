//! Beginnings: where an axis stands in the first row of a leg.
//!
//! In: the rows of a leg, what was programmed, what the drive's own feedback read, and the loop. Out: the stand that the loop goes on from,
//! where the axis does not begin at rest on its command, as in a recording that is cut out of a motion. The feedback shows other
//! things too, so one reading is no stand: its way back to the command must be seen.

use std::ops::Range;

use super::Driven;
use crate::position_loop::{Follower, Stand};
use crate::recording::AxisChannels;
use crate::way::Way;

/// The rows of a leg: their times, what was programmed and what the feedback read.
struct Leg<'l> {
    way: &'l Way<'l>,
    first: usize,
    time: &'l [f64],
    actual: &'l [f64],
    driven: Driven,
}

/// Where an axis stands in the first of these rows, a leg; `None` where it begins at rest on its command, or nobody knows.
pub(super) fn beginning(
    time: &[f64],
    axis: &AxisChannels,
    way: &Way<'_>,
    driven: Driven,
    rows: Range<usize>,
) -> Option<Stand> {
    let actual = axis.actual.as_ref()?.get(rows.clone())?;
    let leg = Leg { way, first: rows.start, time: &time[rows], actual, driven };
    let stand = leg.first_reading()?;
    let lag = driven.position_loop.time_constant * way.fastest();
    let is_away = (stand.position - way.command()[leg.first]).abs() > AWAY * lag;
    (is_away && leg.shows_way_from(stand)).then_some(stand)
}

/// The share of the lag at the highest speed beyond which an axis does not begin at rest: it is further from its command than friction
/// leaves it.
const AWAY: f64 = 0.05;

impl Leg<'_> {
    /// Where the feedback reads the axis in the first row, at the speed of the rows within the loop's time.
    fn first_reading(&self) -> Option<Stand> {
        let first = *self.actual.first().filter(|first| first.is_finite())?;
        let (mut moved, mut squares) = (0.0, 0.0);
        for row in (0..self.rows_within(1.0)).filter(|row| self.actual[*row].is_finite()) {
            let since = self.time[row] - self.time[0];
            moved += since * (self.actual[row] - first);
            squares += since * since;
        }
        let velocity = if squares > 0.0 { moved / squares } else { 0.0 };
        Some(Stand { position: first - self.driven.zero, velocity })
    }

    /// Whether the rows behind the first show the way from a stand. What the feedback shows in the first row beyond where the axis is, a
    /// vibration or a play, stays or comes back, and does not fade with the loop. Where no row is near enough nothing speaks
    /// against it.
    fn shows_way_from(&self, stand: Stand) -> bool {
        self.missed(Some(stand)) <= UNSEEN * self.missed(None)
    }

    /// What the way from a start leaves of the rows behind the first until the loop has settled: the sum of squares.
    fn missed(&self, start: Option<Stand>) -> f64 {
        let mut follower = Follower::from(start);
        let left = (0..self.rows_within(SETTLED)).map(|row| {
            let stand = self.way.follow(self.driven.position_loop, &mut follower, self.first + row);
            self.actual[row] - self.driven.zero - stand.position
        });
        left.skip(1).filter(|left| left.is_finite()).map(|left| left * left).sum()
    }

    /// How many rows lie within this many time constants of the loop.
    fn rows_within(&self, constants: f64) -> usize {
        let within = constants * self.driven.position_loop.time_constant;
        self.time.iter().take_while(|at| **at - self.time[0] <= within).count()
    }
}

/// After this many time constants less than 1 % of the distance from the command is left.
const SETTLED: f64 = 5.0;

/// The share of the squares beside a start at rest that the way from elsewhere may leave. Taken for such a way, a constant leaves 0.7 and
/// a vibration of whatever frequency and phase 0.25 at least, sampled at any step: e^-x for sin(w x + p) over five time constants, by a
/// sweep of w and p. What is such a way leaves the noise.
const UNSEEN: f64 = 0.25;
