//! How long the errors are without compensation and with it, over all rows, in a few words.

use std::fmt;

use abbe_runtime::Outcome;
use abbe_runtime::math::length;

/// Lengths of errors over the rows so far: mm.
#[derive(Default)]
pub(crate) struct Summary {
    rows: u64,
    without: Range,
    with: Range,
}

#[derive(Default)]
struct Range {
    least: Option<f64>,
    most: f64,
}

impl Summary {
    /// Takes the outcome of one row.
    pub(crate) fn take(&mut self, outcome: &Outcome) {
        self.rows += 1;
        self.without.take(length(outcome.error));
        self.with.take(length(outcome.remaining));
    }
}

impl Range {
    fn take(&mut self, value: f64) {
        self.least = Some(self.least.map_or(value, |least| least.min(value)));
        self.most = self.most.max(value);
    }
}

impl fmt::Display for Range {
    /// In micrometres, whose tenth no machine tool repeats.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:5.1} to {:5.1} um", self.least.unwrap_or_default() * 1e3, self.most * 1e3)
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = if self.rows == 1 { "" } else { "s" };
        let rows = self.rows;
        if rows == 0 {
            return write!(f, "No position was compensated.");
        }
        writeln!(f, "Distance of the tool tip from its target at {rows} position{plural}, by the model:")?;
        writeln!(f, "  without compensation {}", self.without)?;
        write!(f, "  with compensation    {}", self.with)
    }
}
