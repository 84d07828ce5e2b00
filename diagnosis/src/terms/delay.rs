//! `delay`: an axis that is told or answers later than the others. In: its position over time. Out: how far it is from where it was
//! told to be.

use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "Dead time: the axis gets its command later than the others, or responds later, by a time that \
    is the same at every speed. Plausible: one to ten cycles of the controller.";

pub(super) fn fill(rows: &Rows<'_>, axis: usize, time: f64, out: &mut Vec<f64>) {
    let earlier = rows.earlier(axis, time);
    out.extend(earlier.iter().zip(rows.axis(axis).position).map(|(earlier, now)| earlier - now));
}
