//! Motion: which way an axis went, and when it turned.
//!
//! In: times, legs and positions of the rows. Out: the direction of the last real motion, and the time since the last reversal. How an axis came to the place where a leg begins elsewhere than the last one ended, nobody knows: that is
//! no motion and no reversal, and its direction there is that of the leg's own first motion.

use std::sync::Arc;

use super::Shared;
use crate::legs::{reach, stretches};

/// What an axis did in each row.
pub(super) struct Motion {
    pub(super) direction: Shared,
    /// Whether it begins a leg elsewhere than where it ended the last one; empty where it never does.
    pub(super) displaced: Arc<[bool]>,
    pub(super) since_reversal: Shared,
    /// Whether it moves at all.
    pub(super) moves: bool,
}

/// The motion so far.
struct Tracker {
    direction: f64,
    moved: bool,
    reversed: f64,
    /// The furthest place in the present direction.
    extreme: Option<f64>,
}

impl Tracker {
    fn take(&mut self, time: f64, position: f64, resolution: f64) {
        if !position.is_finite() {
            return;
        }
        let gone = position - *self.extreme.get_or_insert(position);
        if gone.abs() > resolution && (!self.moved || gone * self.direction < 0.0) {
            if self.moved {
                self.reversed = time;
            }
            self.direction = gone.signum();
            self.moved = true;
        }
        if gone * self.direction > 0.0 {
            self.extreme = Some(position);
        }
    }
}

impl Motion {
    /// Follows an axis with its position behind the loop; to go back by no more than `resolution` is no motion. Where a leg begins is
    /// a matter of what was programmed: what a loop had left to go is not asked.
    pub(super) fn of(
        time: &[f64],
        legs: &[usize],
        programmed: &[f64],
        position: &[f64],
        resolution: f64,
    ) -> Self {
        let mut tracker =
            Tracker { direction: 1.0, moved: false, reversed: f64::NEG_INFINITY, extreme: None };
        let mut directions = Vec::with_capacity(position.len());
        let mut since = Vec::with_capacity(position.len());
        let mut displaced: Vec<bool> = Vec::new();
        let mut moves = false;
        let near = reach(legs, programmed).max(resolution);
        let mut last: Option<f64> = None;
        for rows in stretches(legs) {
            let known = || programmed[rows.clone()].iter().copied().filter(|place| place.is_finite());
            let way = known().next().zip(last).map_or(0.0, |(first, last)| first - last);
            if way.abs() > near {
                displaced.resize(position.len(), false);
                displaced[rows.start] = true;
                // Where it does not move any more, it is likeliest to stand as it came.
                let direction = first_motion(known(), resolution).unwrap_or(way).signum();
                tracker = Tracker { direction, moved: false, reversed: f64::NEG_INFINITY, extreme: None };
                moves = true;
            }
            for row in rows.clone() {
                tracker.take(time[row], position[row], resolution);
                directions.push(tracker.direction);
                since.push(time[row] - tracker.reversed);
            }
            moves |= tracker.moved;
            last = known().next_back().or(last);
        }
        Self {
            direction: directions.into(),
            displaced: displaced.into(),
            since_reversal: since.into(),
            moves,
        }
    }
}

/// The first real motion through known positions, with its sign.
fn first_motion(mut known: impl Iterator<Item = f64>, resolution: f64) -> Option<f64> {
    let first = known.next()?;
    known.map(|position| position - first).find(|gone| gone.abs() > resolution)
}
