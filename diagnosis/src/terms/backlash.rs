//! `backlash`: play, reversal error, pre-sliding hysteresis. In: direction and travel of an axis. Out: -d/2, or -u/2 of
//! the play operator, where u within [-1, 1] follows q by 2 dq / w.

use super::Memory;
use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "Play between the drive and what it moves, or friction that gives way only after the axis has \
    turned: after each reversal the axis stays behind by the lost motion. Plausible: up to some tens \
    of micrometres on a slide.";

pub(super) fn fill(rows: &Rows<'_>, axis: usize, wind_up: f64, memory: &mut Memory, out: &mut Vec<f64>) {
    let axis = rows.axis(axis);
    if wind_up <= 0.0 {
        out.extend(axis.direction.iter().map(|direction| -0.5 * direction));
        return;
    }
    for (position, direction) in axis.position.iter().zip(axis.direction) {
        let u = match memory.value {
            None => *direction,
            Some(u) if position.is_finite() => {
                (u + 2.0 * (position - memory.last) / wind_up).clamp(-1.0, 1.0)
            }
            Some(u) => u,
        };
        if position.is_finite() {
            memory.value = Some(u);
            memory.last = *position;
        }
        out.push(-0.5 * u);
    }
}
