//! `step`: an event, as a crash, a slip or a clamp that moved. In: time. Out: 0 before it, 1 from it on.

use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "Something moved once and stayed: a collision, a slip, a clamp. The recording's clock gives its \
    time. Plausible: micrometres to tenths of a millimetre.";

pub(super) fn fill(rows: &Rows<'_>, time: f64, out: &mut Vec<f64>) {
    out.extend(rows.time.iter().map(|now| f64::from(u8::from(*now >= time))));
}
