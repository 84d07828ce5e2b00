//! Plays: where a body with free play stands, and when what jumps at a reversal has jumped.
//!
//! In: position and direction of an axis in each row, and how its plays act. Out: at which flank of its play it is, and which way it
//! jumped last. Both are its direction where plays act at once.

use super::motion::Motion;
use super::{AxisStates, Given};

/// How the plays of an axis act after a reversal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Crossing {
    /// At once, as a controller corrects them.
    #[default]
    AtOnce,
    /// While its drive goes so far, mm or rad, the body stands: so wide are the plays together.
    Over(f64),
    /// All at once, when the axis has gone back so far, mm or rad: it sticks, and lets go.
    After(f64),
}

impl Crossing {
    /// Over the width of plays, mm or rad; at once where that is 0 or less.
    pub(crate) fn over(width: f64) -> Self {
        if width > 0.0 { Self::Over(width) } else { Self::AtOnce }
    }
}

/// Lets the plays of an axis act so; to go back by no more than `resolution` is no motion.
pub(super) fn cross(
    given: &Given,
    programmed: &[f64],
    crossing: Crossing,
    resolution: f64,
    states: &mut AxisStates,
) {
    match crossing {
        Crossing::AtOnce => {}
        // From flank to flank the body stands while its drive goes as far as the play is wide.
        Crossing::Over(width) => {
            let (position, direction) = (&states.position, &states.direction);
            let mut play = Play::default();
            states.flank = followed(position, direction, &states.displaced, &mut play, width).into();
        }
        // Less than so far back is no reversal.
        Crossing::After(way) => {
            let back = way.max(resolution);
            let motion = Motion::of(&given.time, &given.legs, programmed, &states.position, back);
            states.flank = motion.direction.clone();
            states.jumped = motion.direction;
        }
    }
}

/// Where a play stands in each row.
pub(super) fn followed(
    position: &[f64],
    direction: &[f64],
    displaced: &[bool],
    play: &mut Play,
    width: f64,
) -> Vec<f64> {
    let anew = |row: usize| displaced.get(row) == Some(&true);
    let rows = position.iter().zip(direction).enumerate();
    rows.map(|(row, (position, direction))| {
        if anew(row) {
            *play = Play::default();
        }
        play.follow(*position, *direction, width)
    })
    .collect()
}

/// The play operator: where within [-1, 1] something stands that follows a position by 2 dq / width.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Play {
    /// The last position that is known, and where it stood there.
    last: Option<(f64, f64)>,
}

impl Play {
    /// Where it stands at the next position; before anything is known, where the direction leaves it.
    pub(crate) fn follow(&mut self, position: f64, direction: f64, width: f64) -> f64 {
        let stands = match self.last {
            None => direction,
            Some((last, stood)) if position.is_finite() => {
                (stood + 2.0 * (position - last) / width).clamp(-1.0, 1.0)
            }
            Some((_, stood)) => stood,
        };
        if position.is_finite() {
            self.last = Some((position, stands));
        }
        stands
    }
}
