//! `compliance`: deflection under a load. In: the load's channel. Out: the load.

use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "The structure yields to the load. Plausible: hundredths to tenths of a micrometre per \
    newton.";

pub(super) fn fill(rows: &Rows<'_>, load: usize, out: &mut Vec<f64>) {
    out.extend_from_slice(rows.load(load));
}
