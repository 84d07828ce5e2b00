//! How long the errors are without compensation and with it, over all rows, in a few words; and how far the tool leans, where its
//! direction is derived.

use std::fmt;

use abbe_runtime::Outcome;
use abbe_runtime::math::length;
use workshop::rows::Lean;

/// Lengths of errors over the rows so far: mm; and of those of the tool's direction, rad.
#[derive(Default)]
pub(crate) struct Summary {
    rows: u64,
    without: Range,
    with: Range,
    leaning: Option<(Range, Range)>,
}

#[derive(Default)]
struct Range {
    least: Option<f64>,
    most: f64,
}

impl Summary {
    /// Takes the outcome of one row, and the error of the tool's direction where that is derived.
    pub(crate) fn take(&mut self, outcome: &Outcome, lean: Option<&Lean>) {
        self.rows += 1;
        self.without.take(length(outcome.error));
        self.with.take(length(outcome.remaining));
        if let Some(lean) = lean {
            let (without, with) = self.leaning.get_or_insert_default();
            without.take(length(lean.without));
            with.take(length(lean.with));
        }
    }

    /// Takes what other rows come to.
    pub(crate) fn add(&mut self, other: &Self) {
        self.rows += other.rows;
        self.without.add(&other.without);
        self.with.add(&other.with);
        if let Some((without, with)) = &other.leaning {
            let own = self.leaning.get_or_insert_default();
            own.0.add(without);
            own.1.add(with);
        }
    }
}

impl Range {
    fn take(&mut self, value: f64) {
        self.least = Some(self.least.map_or(value, |least| least.min(value)));
        self.most = self.most.max(value);
    }

    fn add(&mut self, other: &Self) {
        let least = [self.least, other.least].into_iter().flatten();
        self.least = least.reduce(f64::min);
        self.most = self.most.max(other.most);
    }

    /// In a unit of which so many are one of its own; of both units whose tenth no machine tool repeats.
    fn written(&self, unit: &str, factor: f64) -> String {
        format!("{:5.1} to {:5.1} {unit}", self.least.unwrap_or_default() * factor, self.most * factor)
    }
}

/// Both ranges under a sentence.
fn both(f: &mut fmt::Formatter<'_>, without: &Range, with: &Range, unit: &str, factor: f64) -> fmt::Result {
    writeln!(f, "  without compensation {}", without.written(unit, factor))?;
    write!(f, "  with compensation    {}", with.written(unit, factor))
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = if self.rows == 1 { "" } else { "s" };
        let rows = self.rows;
        if rows == 0 {
            return write!(f, "No position was compensated.");
        }
        writeln!(f, "Distance of the tool tip from its target at {rows} position{plural}, by the model:")?;
        both(f, &self.without, &self.with, "um", 1e3)?;
        let Some((without, with)) = &self.leaning else { return Ok(()) };
        writeln!(f, "\nAngle of the tool's direction from its target, by the model:")?;
        both(f, without, with, "arcsec", 1.0_f64.to_degrees() * 3600.0)
    }
}
