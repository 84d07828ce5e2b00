//! `acceleration`: missing feed-forward and structural inertia. In: the acceleration of an axis. Out: -a.

use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "An effect of acceleration: missing feed-forward in the drive, or a column or table that yields \
    to inertia. Plausible: gains from some hundreds to tens of thousands 1/s^2.";

/// Gains, 1/s^2.
pub(super) const PLAUSIBLE: (f64, f64) = (100.0, 1e5);

pub(super) fn fill(rows: &Rows<'_>, axis: usize, out: &mut Vec<f64>) {
    out.extend(rows.axis(axis).acceleration.iter().map(|acceleration| -acceleration));
}
