//! Commands: what a machine is told and exposed to over time.
//!
//! In: columns from a path or from a recording. Out: the same, checked to fit together. Everything is in mm, rad, s,
//! degC and the units of the loads.

use crate::legs::legs;
use crate::plant::error::PlantError;

/// A named column, such as a temperature or a load.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// The name: `spindle` of the channel `temperature.spindle`.
    pub name: String,
    /// The unit as files write it: `degC`, `N`.
    pub unit: String,
    /// One value a sample.
    pub values: Vec<f64>,
}

/// What a machine is told and exposed to. All columns are of one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Commands {
    /// Time since the recording began, s, ascending.
    pub time: Vec<f64>,
    /// The repeat that each sample belongs to.
    pub run: Vec<i64>,
    /// The programmed position of each axis, in the order of the machine's axes.
    pub positions: Vec<Vec<f64>>,
    /// Temperatures as they truly are, degC.
    pub temperatures: Vec<Column>,
    /// Loads as they truly are.
    pub loads: Vec<Column>,
    /// Which samples are written down; all of them where it is empty. The machine goes through the others too.
    pub recorded: Vec<bool>,
    /// The number of the leg of each sample: from leg to leg nothing is driven, and the axes begin at rest where the first sample
    /// stands. Where it is empty, gaps and runs tell.
    pub legs: Vec<i64>,
}

impl Commands {
    /// The number of the leg of each sample.
    pub(crate) fn numbered_legs(&self) -> Vec<i64> {
        if self.legs.is_empty() { legs(&self.time, &self.run, &self.positions) } else { self.legs.clone() }
    }

    /// Whether a sample is written down.
    pub fn is_recorded(&self, row: usize) -> bool {
        self.recorded.is_empty() || self.recorded.get(row) == Some(&true)
    }

    /// Checks that all columns are as long as the time and that there is one for each axis.
    ///
    /// # Errors
    ///
    /// [`PlantError::Length`] with the name of the column.
    pub fn check(&self, axes: usize) -> Result<(), PlantError> {
        let rows = self.time.len();
        let wrong = |what: &str| Err(PlantError::Length(what.to_owned()));
        if self.run.len() != rows {
            return wrong("the column of runs");
        }
        if self.positions.len() != axes || self.positions.iter().any(|column| column.len() != rows) {
            return wrong("the position of an axis");
        }
        if !self.recorded.is_empty() && self.recorded.len() != rows {
            return wrong("the list of recorded samples");
        }
        if !self.legs.is_empty() && self.legs.len() != rows {
            return wrong("the list of legs");
        }
        let named = self.temperatures.iter().chain(&self.loads);
        match named.into_iter().find(|column| column.values.len() != rows) {
            Some(column) => wrong(&format!("`{}`", column.name)),
            None => Ok(()),
        }
    }

    /// The commands at other times, linear between samples and held before the first and after the last.
    #[must_use]
    pub fn at(&self, times: &[f64]) -> Self {
        let column =
            |values: &Vec<f64>| times.iter().map(|time| between(&self.time, values, *time)).collect();
        let named = |column: &Column| Column {
            values: times.iter().map(|time| between(&self.time, &column.values, *time)).collect(),
            ..column.clone()
        };
        let run = |time: &f64| {
            let after = self.time.partition_point(|known| known <= time);
            self.run.get(after.saturating_sub(1)).copied().unwrap_or(1)
        };
        Self {
            time: times.to_vec(),
            run: times.iter().map(run).collect(),
            positions: self.positions.iter().map(column).collect(),
            temperatures: self.temperatures.iter().map(named).collect(),
            loads: self.loads.iter().map(named).collect(),
            recorded: Vec::new(),
            legs: Vec::new(),
        }
    }
}

/// The value of a column at a time, linear between samples.
fn between(time: &[f64], values: &[f64], at: f64) -> f64 {
    let after = time.partition_point(|known| *known <= at);
    let value = |row: usize| values.get(row).copied().unwrap_or(f64::NAN);
    if after == 0 || after == time.len() {
        return value(after.saturating_sub(1));
    }
    let start = time.get(after - 1).copied().unwrap_or(f64::NAN);
    let end = time.get(after).copied().unwrap_or(f64::NAN);
    let share = (at - start) / (end - start);
    // At a sample the next one does not count, even where it is missing.
    if share == 0.0 { value(after - 1) } else { value(after - 1) * (1.0 - share) + value(after) * share }
}
