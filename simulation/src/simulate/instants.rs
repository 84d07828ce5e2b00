//! Instants: those of the rows and those at which an instrument looks, in one order of time.
//!
//! In: commands at the rows, and commands at the instants of an instrument whose clock is off. Out: the commands that the
//! plant runs through, and what each of its instants is for.

use crate::commands::{Column, Commands};

/// What each instant of a merged run is for.
#[derive(Clone, Copy)]
pub(super) struct Purpose {
    /// The row that it is, where it is written down.
    pub(super) row: Option<usize>,
    /// The row whose reading is taken at it.
    pub(super) look: Option<usize>,
}

/// One for each instant of commands at whose rows the instrument looks.
pub(super) fn purposes_of(commands: &Commands) -> Vec<Purpose> {
    let mut next = 0;
    let purpose = |row: usize| {
        let row = commands.is_recorded(row).then(|| {
            next += 1;
            next - 1
        });
        Purpose { row, look: row }
    };
    (0..commands.time.len()).map(purpose).collect()
}

/// Merges the instants of the rows and those at which the instrument looks.
pub(super) fn merge(commands: &Commands, looks: &Commands) -> (Commands, Vec<Purpose>) {
    let mut order: Vec<(f64, bool, usize)> = Vec::new();
    order.extend(commands.time.iter().enumerate().map(|(row, time)| (*time, false, row)));
    order.extend(looks.time.iter().enumerate().map(|(row, time)| (*time, true, row)));
    order.sort_by(|left, right| left.0.total_cmp(&right.0));
    let rows = purposes_of(commands);
    let purpose = |&(_, look, row): &(f64, bool, usize)| {
        if look {
            Purpose { row: None, look: Some(row) }
        } else {
            Purpose { row: rows.get(row).and_then(|purpose| purpose.row), look: None }
        }
    };
    let purposes = order.iter().map(purpose).collect();
    let take = |own: &[f64], other: &[f64]| -> Vec<f64> {
        let value = |&(_, look, row): &(f64, bool, usize)| if look { other.get(row) } else { own.get(row) };
        order.iter().map(|entry| value(entry).copied().unwrap_or(f64::NAN)).collect()
    };
    let named = |own: &[Column], other: &[Column]| -> Vec<Column> {
        let pairs = own.iter().zip(other);
        pairs.map(|(own, other)| Column { values: take(&own.values, &other.values), ..own.clone() }).collect()
    };
    let run = |&(_, look, row): &(f64, bool, usize)| {
        let runs = if look { &looks.run } else { &commands.run };
        runs.get(row).copied().unwrap_or(1)
    };
    let (own_legs, other_legs) = (commands.numbered_legs(), looks.numbered_legs());
    let leg = |&(_, look, row): &(f64, bool, usize)| {
        let legs = if look { &other_legs } else { &own_legs };
        legs.get(row).copied().unwrap_or_default()
    };
    let positions = commands.positions.iter().zip(&looks.positions);
    let merged = Commands {
        time: order.iter().map(|(time, ..)| *time).collect(),
        run: order.iter().map(run).collect(),
        positions: positions.map(|(own, other)| take(own, other)).collect(),
        temperatures: named(&commands.temperatures, &looks.temperatures),
        loads: named(&commands.loads, &looks.loads),
        recorded: Vec::new(),
        legs: order.iter().map(leg).collect(),
    };
    (merged, purposes)
}
