//! `acceleration`: missing feed-forward and structural inertia. In: the acceleration of an axis. Out: -a.

use crate::states::Rows;

pub(super) fn fill(rows: &Rows<'_>, axis: usize, out: &mut Vec<f64>) {
    out.extend(rows.axis(axis).acceleration.iter().map(|acceleration| -acceleration));
}
