//! `reversal-spike`: stick-slip and static friction where an axis turns round. In: the time since each reversal. Out:
//! -d exp(-(t - t_reversal) / decay).

use super::plausible::{Body, Range};
use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "Static friction: for a moment after each reversal the axis sticks before the loop pulls it \
    free. It appears as a spike at the quadrants of a circle and grows with feed. Plausible: a few micrometres, gone within a \
    tenth of a second.";

/// The plausible height. Twenty micrometres is ten times what a circle shows of a good machine; as a rotation it moves what is a
/// metre away by as much.
pub(super) fn plausible(body: Body) -> Option<Range> {
    match body {
        Body::Displaced => Some((0.0, 0.02)),
        Body::Tilted => Some((0.0, 2e-5)),
        Body::Rotary | Body::Aligned => None,
    }
}

pub(super) fn fill(rows: &Rows<'_>, axis: usize, decay: f64, out: &mut Vec<f64>) {
    let axis = rows.axis(axis);
    let spike = |(since, direction): (&f64, &f64)| -direction * (-since / decay).exp();
    out.extend(axis.since_reversal.iter().zip(axis.direction).map(spike));
}
