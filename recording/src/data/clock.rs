//! The time of each row: counted from the first row, strictly increasing, runs one after another.
//!
//! Within a run time must increase. A run that begins at an earlier time than the one before it ended was recorded with
//! a clock of its own: it is laid behind that one, at its mean step.

use std::collections::BTreeSet;

/// Makes times in s of time stamps in the unit of their column.
pub(super) struct Clock {
    factor: f64,
    last: Option<Last>,
    /// The time stamp and the time at which the present clock began, and its rows so far.
    origin: (f64, f64, f64),
    step: f64,
    seen: BTreeSet<i64>,
    /// The first run that had a clock of its own, and how many had.
    pub(super) restarted: Option<(i64, usize)>,
}

#[derive(Clone, Copy)]
struct Last {
    stamp: f64,
    time: f64,
    run: i64,
}

/// The time stamp is not later than the one before it.
pub(super) struct NotLater {
    /// The time stamp before it.
    pub(super) before: f64,
    /// Whether its run has rows further up, with another run between.
    pub(super) returned: bool,
    /// Whether they differ in the file and not in the number.
    pub(super) same: bool,
}

impl Clock {
    /// `factor`: seconds in one of the column's unit.
    pub(super) fn new(factor: f64) -> Self {
        Self {
            factor,
            last: None,
            origin: (0.0, 0.0, 0.0),
            step: 1.0,
            seen: BTreeSet::new(),
            restarted: None,
        }
    }

    /// The time of the next row in s.
    pub(super) fn take(&mut self, stamp: f64, run: i64) -> Result<f64, NotLater> {
        let Some(last) = self.last else {
            self.seen.insert(run);
            self.origin = (stamp, 0.0, 1.0);
            self.last = Some(Last { stamp, time: 0.0, run });
            return Ok(0.0);
        };
        let begins = run != last.run && self.seen.insert(run);
        if stamp <= last.stamp && begins {
            let elapsed = last.time - self.origin.1;
            if self.origin.2 > 1.0 {
                self.step = elapsed / (self.origin.2 - 1.0);
            }
            self.origin = (stamp, last.time + self.step, 0.0);
            let (first, count) = self.restarted.unwrap_or((run, 0));
            self.restarted = Some((first, count + 1));
        }
        let time = self.origin.1 + (stamp - self.origin.0) * self.factor;
        // Not `<=`: it must also hold for what is no number any more.
        if !(time > last.time && time.is_finite()) {
            let returned = run != last.run && !begins;
            return Err(NotLater { before: last.stamp, returned, same: stamp == last.stamp });
        }
        self.origin.2 += 1.0;
        self.last = Some(Last { stamp, time, run });
        Ok(time)
    }
}
