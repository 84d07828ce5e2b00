//! Error parameters over a grid. In: nodes of each argument and values. Out: the value between them, by straight lines along
//! every argument, constant outside.

use abbe_runtime::{Direction, Table, Values};

/// A function of some axes, given on a full grid; a constant where it has none.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    /// The axes, and the nodes of each, ascending: mm or rad.
    pub arguments: Vec<(usize, Vec<f64>)>,
    /// The values, the last argument running fastest: mm or rad.
    pub values: Vec<f64>,
}

impl Grid {
    /// The value at a position of all axes; NaN where the position lacks an axis.
    pub(super) fn value(&self, position: &[f64]) -> f64 {
        let mut values = self.values.clone();
        for (axis, nodes) in self.arguments.iter().rev() {
            let place = position.get(*axis).copied().unwrap_or(f64::NAN);
            values = values.chunks(nodes.len().max(1)).map(|row| between(nodes, row, place)).collect();
        }
        values.first().copied().unwrap_or(f64::NAN)
    }
}

fn between(nodes: &[f64], values: &[f64], place: f64) -> f64 {
    Table::at(nodes, Values::Both(values)).map_or(f64::NAN, |table| table.value(place, Direction::Positive))
}

impl Grid {
    /// The place of each argument in a record, the last argument running fastest.
    pub(super) fn places(&self, record: usize) -> Vec<f64> {
        let mut rest = record;
        let mut places: Vec<f64> = self
            .arguments
            .iter()
            .rev()
            .map(|(_, nodes)| {
                let count = nodes.len().max(1);
                let place = nodes.get(rest % count).copied().unwrap_or(f64::NAN);
                rest /= count;
                place
            })
            .collect();
        places.reverse();
        places
    }

    /// The grid that records make, in any order: `places` holds a column for each argument. Nothing where a combination is
    /// missing or stands twice.
    pub(super) fn from_records(axes: &[usize], places: &[Vec<f64>], values: &[f64]) -> Option<Self> {
        let nodes = |column: &Vec<f64>| {
            let mut nodes = column.clone();
            nodes.sort_by(f64::total_cmp);
            nodes.dedup();
            nodes
        };
        let arguments: Vec<(usize, Vec<f64>)> = axes.iter().copied().zip(places.iter().map(nodes)).collect();
        let size = arguments.iter().try_fold(1_usize, |size, (_, nodes)| size.checked_mul(nodes.len()))?;
        if size != values.len() {
            return None;
        }
        let mut slots = vec![None; size];
        for (record, value) in values.iter().enumerate() {
            let number = arguments.iter().zip(places).try_fold(0, |number, ((_, nodes), column)| {
                let place = column.get(record)?;
                Some(number * nodes.len() + nodes.iter().position(|node| node == place)?)
            })?;
            let slot = slots.get_mut(number)?;
            if slot.replace(*value).is_some() {
                return None;
            }
        }
        Some(Self { arguments, values: slots.into_iter().collect::<Option<_>>()? })
    }
}
