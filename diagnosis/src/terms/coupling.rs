//! `coupling`: the rigid body that is not: sag and cross-talk. In: the position of another axis. Out: its powers from 1 on.

use super::polynomial;
use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "The body is not rigid: the position of another axis bends or tilts this link, such as the \
    weight of a table at the end of its travel.";

pub(super) fn fill(rows: &Rows<'_>, axis: usize, scale: f64, out: &mut [Vec<f64>]) {
    polynomial::fill(rows.axis(axis).position, 0.0, scale, 1, out);
}
