//! `table`: any curve along an axis, by direction of motion where it differs. In: positions. Out: a hat function for each
//! node (forward nodes first, then reverse), or the interpolated value, held constant outside.

use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "A curve along the axis that no smooth polynomial describes: a measured error of a screw or \
    guide, or a damaged place.";

/// Where the values stand, in rising order, and whether they begin again after the last.
#[derive(Clone, Copy)]
pub(super) struct Nodes<'n> {
    pub(super) nodes: &'n [f64],
    pub(super) repeats: bool,
}

impl Nodes<'_> {
    /// A position without the whole turns of a table that repeats.
    fn within(self, position: f64) -> f64 {
        match (self.nodes.first(), self.nodes.last()) {
            (Some(first), Some(last)) if self.repeats => first + (position - first).rem_euclid(last - first),
            _ => position,
        }
    }
}

pub(super) fn fill(rows: &Rows<'_>, axis: usize, nodes: Nodes<'_>, directed: bool, out: &mut [Vec<f64>]) {
    for column in out.iter_mut() {
        column.clear();
        column.resize(rows.len(), 0.0);
    }
    visit(rows, axis, nodes, directed, |row, node, weight| {
        if let Some(column) = out.get_mut(node) {
            column[row] += weight;
        }
    });
}

pub(super) fn add(
    rows: &Rows<'_>,
    axis: usize,
    nodes: Nodes<'_>,
    directed: bool,
    values: &[f64],
    sum: &mut [f64],
) {
    visit(rows, axis, nodes, directed, |row, node, weight| {
        sum[row] += weight * values.get(node).copied().unwrap_or(f64::NAN);
    });
}

/// Calls `each(row, node, weight)` for the one or two nodes on which a row depends.
fn visit(
    rows: &Rows<'_>,
    axis: usize,
    all: Nodes<'_>,
    directed: bool,
    mut each: impl FnMut(usize, usize, f64),
) {
    let axis = rows.axis(axis);
    let nodes = all.nodes;
    for (row, (position, direction)) in axis.position.iter().zip(axis.direction).enumerate() {
        let shift = if directed && *direction < 0.0 { nodes.len() } else { 0 };
        let position = &all.within(*position);
        let upper = nodes.partition_point(|node| node <= position);
        if position.is_nan() {
            each(row, shift, f64::NAN);
        } else if upper == 0 || upper == nodes.len() {
            each(row, shift + upper.saturating_sub(1), 1.0);
        } else {
            let (low, high) = (nodes[upper - 1], nodes[upper]);
            let weight = (position - low) / (high - low);
            each(row, shift + upper - 1, 1.0 - weight);
            each(row, shift + upper, weight);
        }
    }
}
