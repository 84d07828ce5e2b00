//! Beginnings: where an axis stands in the first row of a leg.
//!
//! In: the rows of a leg, what was programmed, what the drive's own feedback read, and the loop. Out: what the loop goes on from: at rest on
//! its command, or elsewhere, as in a recording that is cut out of a motion. The feedback shows other things too, so one reading is
//! no stand: its way back to the command must be seen. Without feedback a model says whether axes begin underway.

use std::ops::Range;

use super::{Driven, Given};
use crate::position_loop::{Follower, Stand, Start};
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

/// How an axis begins in the first of these rows, a leg.
pub(super) fn beginning(
    time: &[f64],
    axis: &AxisChannels,
    way: &Way<'_>,
    driven: Driven,
    rows: Range<usize>,
) -> Start {
    let Some(actual) = axis.actual.as_ref().and_then(|actual| actual.get(rows.clone())) else {
        return if driven.underway { underway(way, rows) } else { Start::AtRest };
    };
    let leg = Leg { way, first: rows.start, time: &time[rows], actual, driven };
    let Some(stand) = leg.first_reading() else { return Start::AtRest };
    let lag = driven.position_loop.time_constant * way.fastest();
    let is_away = (stand.position - way.command()[leg.first]).abs() > AWAY * lag;
    if is_away && leg.shows_way_from(stand) { Start::At(stand) } else { Start::AtRest }
}

/// The beginning of a leg that was cut out of a motion: its axis moved before as its command does in the first rows. At rest where that is
/// slow, or too few rows tell.
pub(super) fn underway(way: &Way<'_>, rows: Range<usize>) -> Start {
    let first = way.first_motion(rows).filter(|(velocity, _)| velocity.abs() > AWAY * way.fastest());
    first.map_or(Start::AtRest, |(velocity, acceleration)| Start::Underway { velocity, acceleration })
}

/// The rows within a time, s, from the beginning of each leg that begins underway: how the axis moved before is not known.
pub(super) fn unsettled(given: &Given, way: &Way<'_>, starts: &[Start], within: f64) -> Vec<bool> {
    let begins = |start: &Start| matches!(start, Start::Underway { .. });
    if !starts.iter().any(begins) {
        return Vec::new();
    }
    let mut unsettled = vec![false; given.time.len()];
    for (rows, _) in way.stretches().zip(starts).filter(|(_, start)| begins(start)) {
        let last = given.time[rows.start] + within;
        rows.filter(|row| given.time[*row] <= last).for_each(|row| unsettled[row] = true);
    }
    unsettled
}

impl Given {
    /// Whether the command of an axis moves where a leg begins, and changes its speed. Behind a command of one speed nothing shows a loop but
    /// a beginning at rest: underway it only moves the zero.
    pub(crate) fn may_begin_underway(&self, axis: usize) -> bool {
        let way = Way::new(&self.time, &self.programmed[axis], &self.legs);
        way.changes_speed()
            && way.stretches().any(|rows| matches!(underway(&way, rows), Start::Underway { .. }))
    }
}

/// The share of the lag at the highest speed beyond which an axis does not begin at rest: it is further from its command than friction
/// leaves it.
const AWAY: f64 = 0.05;

impl Leg<'_> {
    /// Where the feedback reads the axis in the first row, at the speed of the rows within the loop's time.
    fn first_reading(&self) -> Option<Stand> {
        let first = *self.actual.first().filter(|first| first.is_finite())?;
        let (mut moved, mut squares) = (0.0, 0.0);
        let rows = self.rows_within(self.driven.position_loop.time_constant);
        for row in (0..rows).filter(|row| self.actual[*row].is_finite()) {
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
        self.missed(Start::At(stand)) <= UNSEEN * self.missed(Start::AtRest)
    }

    /// What the way from a start leaves of the rows behind the first, while it shows: the sum of squares.
    fn missed(&self, start: Start) -> f64 {
        let mut follower = Follower::from(start);
        let left = (0..self.rows_within(SEEN * self.driven.position_loop.time_constant)).map(|row| {
            let stand = self.way.follow(self.driven.position_loop, &mut follower, self.first + row);
            self.actual[row] - self.driven.zero - stand.position
        });
        left.skip(1).filter(|left| left.is_finite()).map(|left| left * left).sum()
    }

    /// How many rows lie within a time, s, from the first.
    fn rows_within(&self, within: f64) -> usize {
        self.time.iter().take_while(|at| **at - self.time[0] <= within).count()
    }
}

/// The way from elsewhere is looked for in the first time constants of the loop's gain: the window of the sweep below. A loop that rings
/// takes longer to settle, but later rows also show other effects of the drive.
const SEEN: f64 = 5.0;

/// The share of the squares beside a start at rest that the way from elsewhere may leave. Taken for such a way, a constant leaves 0.7 and
/// a vibration of whatever frequency and phase 0.25 at least, sampled at any step: e^-x for sin(w x + p) over five time constants, by a
/// sweep of w and p. What is such a way leaves the noise.
const UNSEEN: f64 = 0.25;
