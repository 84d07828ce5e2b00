//! The time of each row: counted from the first row, strictly increasing, runs one after another.
//!
//! Within a run time must increase. A run that begins at an earlier time than the one before it ended was recorded with
//! a clock of its own: it is laid behind that one, at its mean step.

use std::collections::BTreeSet;

use super::stamp::Stamp;

/// Makes times in s of time stamps in the unit of their column.
pub(super) struct Clock {
    factor: f64,
    last: Option<Last>,
    /// The time stamp and the time at which the present clock began, and its rows so far.
    origin: (Stamp, f64, f64),
    step: f64,
    seen: BTreeSet<i64>,
    /// The first run that had a clock of its own, and how many had.
    pub(super) restarted: Option<(i64, usize)>,
}

#[derive(Clone, Copy)]
struct Last {
    stamp: Stamp,
    time: f64,
    run: i64,
}

/// The time stamp is not later than the one before it.
pub(super) struct NotLater {
    /// The time stamp before it.
    pub(super) before: Stamp,
    /// Whether its run has rows further up, with another run between.
    pub(super) returned: bool,
    /// Whether they differ in the file and not in the number.
    pub(super) same: bool,
    /// Whether one of them has a zone and the other has none, or they are otherwise not of one clock.
    pub(super) other_clock: bool,
}

impl Clock {
    /// `factor`: seconds in one of the column's unit.
    pub(super) fn new(factor: f64) -> Self {
        Self {
            factor,
            last: None,
            origin: (Stamp::whole(0), 0.0, 0.0),
            step: 1.0,
            seen: BTreeSet::new(),
            restarted: None,
        }
    }

    /// Seconds in one of the column's unit.
    pub(super) fn factor(&self) -> f64 {
        self.factor
    }

    /// The time of the next row in s.
    pub(super) fn take(&mut self, stamp: Stamp, run: i64) -> Result<f64, NotLater> {
        let Some(last) = self.last else {
            self.seen.insert(run);
            self.origin = (stamp, 0.0, 1.0);
            self.last = Some(Last { stamp, time: 0.0, run });
            return Ok(0.0);
        };
        let since = stamp.since(last.stamp);
        let begins = run != last.run && self.seen.insert(run);
        if since <= 0.0 && begins {
            let elapsed = last.time - self.origin.1;
            if self.origin.2 > 1.0 {
                self.step = elapsed / (self.origin.2 - 1.0);
            }
            self.origin = (stamp, last.time + self.step, 0.0);
            let (first, count) = self.restarted.unwrap_or((run, 0));
            self.restarted = Some((first, count + 1));
        }
        let time = self.origin.1 + stamp.since(self.origin.0) * self.factor;
        // Not `<=`: it must also hold for what is no number any more.
        let other_clock = stamp.differs_in_kind(last.stamp);
        if other_clock || !(time > last.time && time.is_finite()) {
            let returned = run != last.run && !begins;
            return Err(NotLater { before: last.stamp, returned, same: since == 0.0, other_clock });
        }
        self.origin.2 += 1.0;
        self.last = Some(Last { stamp, time, run });
        Ok(time)
    }
}
