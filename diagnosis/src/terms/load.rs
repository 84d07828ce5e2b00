//! `compliance`: deflection under a load. In: the load's channel. Out: the load.

use crate::states::Rows;

pub(super) fn fill(rows: &Rows<'_>, load: usize, out: &mut Vec<f64>) {
    out.extend_from_slice(rows.load(load));
}
