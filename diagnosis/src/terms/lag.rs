//! `lag`: the following error of the position loop q' = K (q_cmd - q), started at rest. In: the position behind the loop,
//! which the states hold. Out: how the position changes with the loop's time constant 1/K: -v in the steady state. Below zero the
//! drive leads, by -v/K at once: its feed-forward is too large.

use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "The following error of a position loop, velocity over gain. Loops of equal gain trace a circle \
    that is too small; loops of unequal gain trace an ellipse at 45 degrees. Plausible gains: 10 to 200 1/s.";

/// Gains of position loops, 1/s.
pub(super) const PLAUSIBLE: (f64, f64) = (10.0, 200.0);

pub(super) fn fill(rows: &Rows<'_>, axis: usize, out: &mut Vec<f64>) {
    out.extend_from_slice(rows.axis(axis).lag_slope);
}
