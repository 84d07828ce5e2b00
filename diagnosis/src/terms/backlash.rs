//! `backlash`: lost motion, reversal error, pre-sliding hysteresis. In: direction and travel of an axis. Out: -d/2, or -u/2 of
//! the play operator, where u within [-1, 1] follows q by 2 dq / w.

use super::Memory;
use super::plausible::{Body, Range};
use crate::side::Side;
use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "A gap between the drive and the body that it moves, or friction that yields only after the \
    axis has reversed. After each reversal the axis stays behind by the lost motion. Plausible: up to some tens of micrometres \
    on a slide, or a degree on a rotary axis.";

/// The plausible lost motion. A tenth of a millimetre is a slide whose nut is worn out; as a rotation it moves what is a metre
/// away by as much. A rotary axis on gears may lose a degree.
pub(super) fn plausible(body: Body) -> Option<Range> {
    match body {
        Body::Displaced => Some((0.0, 0.1)),
        Body::Rotary => Some((0.0, 1f64.to_radians())),
        Body::Tilted => Some((0.0, 1e-4)),
        Body::Aligned => None,
    }
}

pub(super) fn fill(rows: &Rows<'_>, axis: usize, wind_up: f64, memory: &mut Memory, out: &mut Vec<f64>) {
    let axis = rows.axis(axis);
    if wind_up > 0.0 {
        out.extend(axis.followed(&mut memory.play, wind_up).iter().map(|stands| -0.5 * stands));
    } else {
        out.extend(axis.direction.iter().map(|direction| -0.5 * direction));
    }
}

/// That of a play which comes in on a side, at once or as the axis crosses it: -u/2 of where it is between its flanks, or of which way
/// it jumped last.
pub(super) fn fill_crossed(rows: &Rows<'_>, axis: usize, side: Side, out: &mut Vec<f64>) {
    let axis = rows.axis(axis);
    let stands = if side == Side::After { axis.flank } else { axis.jumped };
    out.extend(stands.iter().map(|stands| -0.5 * stands));
}
