//! Axes. In: a quantity and the unit of its numbers. Out: the scale that covers them, in a unit chosen by their size.

use super::scale::Scale;
use super::ticks::{self, Ticks};
use super::unit::Unit;

/// What an axis shows.
#[derive(Clone, Debug)]
pub struct Axis {
    quantity: String,
    unit: String,
    by_size: bool,
    logarithmic: bool,
    counted: bool,
    with: Vec<f64>,
    within: Option<(f64, f64)>,
}

impl Axis {
    /// An axis of a quantity whose numbers are given in `unit` (`mm`, `rad`, `deg`, `s`, ...); it shows them in a unit that
    /// suits their size, and states it. A quantity without a unit has an empty one.
    pub fn new(quantity: &str, unit: &str) -> Self {
        Self {
            quantity: quantity.to_owned(),
            unit: unit.to_owned(),
            by_size: true,
            logarithmic: false,
            counted: false,
            within: None,
            with: Vec::new(),
        }
    }

    /// The same with its numbers in the given unit whatever their size.
    pub fn exactly(quantity: &str, unit: &str) -> Self {
        Self { by_size: false, ..Self::new(quantity, unit) }
    }

    /// Equal factors take equal room; numbers that are not positive cannot be shown.
    pub fn logarithmic(self) -> Self {
        Self { logarithmic: true, ..self }
    }

    /// Whole numbers, such as those of runs.
    pub fn counted(self) -> Self {
        Self { counted: true, ..self }
    }

    /// The axis ends here even where numbers lie beyond, which the plot then tells; for a few that would press all others
    /// together.
    pub fn within(self, low: f64, high: f64) -> Self {
        Self { within: (low < high).then_some((low, high)), ..self }
    }

    /// The axis reaches to this number in any case; several plots with the same ends can be compared.
    pub fn reaching(mut self, value: f64) -> Self {
        self.with.push(value);
        self
    }

    /// The unit and the ticks for these numbers; `most` is how many ticks there is room for.
    pub(super) fn cover(&self, values: impl Iterator<Item = f64>, most: usize) -> Covered {
        let all = values.chain(self.with.iter().copied());
        let ends = ticks::ends(all.filter(|value| !self.logarithmic || *value > 0.0));
        let (low, high) = ends.unwrap_or(if self.logarithmic { (1.0, 10.0) } else { (0.0, 1.0) });
        let (low, high) = match self.within {
            Some((from, to)) if low < to && high > from => (low.max(from), high.min(to)),
            _ => (low, high),
        };
        let size = low.abs().max(high.abs());
        let unit = if self.by_size { Unit::of(&self.unit, size) } else { Unit::exactly(&self.unit) };
        let (low, high) = (low * unit.factor, high * unit.factor);
        let ticks = if self.logarithmic {
            ticks::decades(low, high)
        } else if self.counted {
            ticks::whole_steps(low, high, most)
        } else if unit.name == "°" {
            ticks::degrees(low, high, most)
        } else {
            ticks::round(low, high, most)
        };
        let comma = if self.quantity.is_empty() || unit.name.is_empty() { "" } else { ", " };
        let title = format!("{}{comma}{}", self.quantity, unit.name);
        Covered { title, unit, ticks, logarithmic: self.logarithmic, empty: ends.is_none() }
    }
}

/// An axis that has been fitted to its numbers.
pub(super) struct Covered {
    /// Quantity and unit.
    pub(super) title: String,
    pub(super) unit: Unit,
    pub(super) ticks: Ticks,
    /// There was no number.
    pub(super) empty: bool,
    logarithmic: bool,
}

impl Covered {
    /// How far the axis reaches from end to end, in the unit of the given numbers.
    pub(super) fn extent(&self) -> f64 {
        let (first, last) = (self.ticks.values.first(), self.ticks.values.last());
        first.zip(last).map_or(1.0, |(first, last)| (last - first) / self.unit.factor)
    }

    /// Whether a number is known and has no place on the axis.
    pub(super) fn beyond(&self, value: f64) -> bool {
        value.is_finite() && self.scale(0.0, 1.0).place(value).is_none()
    }

    /// The scale from given numbers to a stretch of the drawing.
    pub(super) fn scale(&self, from: f64, to: f64) -> Scale {
        Scale::new(self.ticks.ends, (from, to), self.unit.factor, self.logarithmic)
    }
}
