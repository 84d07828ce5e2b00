//! Values at equal steps, as most controllers keep them. In: a first place, a step, values. Out: the value between, by straight
//! lines, constant outside.

use abbe_runtime::{Direction, Table, Values};

/// A function of one axis at equal steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Even {
    /// The first place, in the unit of the file.
    pub first: f64,
    /// From one place to the next.
    pub step: f64,
    /// The values.
    pub values: Vec<f64>,
    /// Whether it begins again after the last place: a turn of a rotary axis.
    pub repeats: bool,
}

impl Even {
    /// The value at a place; 0 where there are none.
    pub(super) fn value(&self, place: f64) -> f64 {
        let held = Table::uniform(self.first, self.step, Values::Both(&self.values));
        let table = if self.repeats { held.and_then(Table::repeating) } else { held };
        table.map_or(0.0, |table| table.value(place, Direction::Positive))
    }
}
