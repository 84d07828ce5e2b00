//! Factors: states of the machine that a term is multiplied with.
//!
//! In: parameters of a calibration in mm, rad, s, degC, and the [`Sample`] of this cycle. Out: a number that the next term
//! is multiplied with. It exists because machines multiply states: a play that is larger where the screw is worn, a wave
//! that grows along the travel, a yaw that follows the warmth of a drive.

use super::math::{exp_m1, sin};
use super::real::{Real, angle};
use super::sample::OneSample;
use super::term::check::{FINE, not_negative};
use super::term::memory::{advance_filter, advance_warmth, advance_width};
use super::{Sample, Table, TermState};

/// The range in which a state was seen. Outside, a factor holds the value that it has at the end, as a table does.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Within {
    /// The lower end, in the unit of the state.
    pub from: Real,
    /// The upper end, not below the lower one.
    pub to: Real,
}

impl Within {
    /// No range: nothing is held.
    pub const EVERYWHERE: Self = Self { from: Real::NEG_INFINITY, to: Real::INFINITY };

    /// The state, or the end of the range beyond which it lies; NaN at NaN.
    #[must_use]
    #[inline]
    pub fn hold(self, state: Real) -> Real {
        let below = if state > self.to { self.to } else { state };
        if self.from > below { self.from } else { below }
    }

    const fn is_usable(self) -> bool {
        self.from <= self.to
    }
}

impl Default for Within {
    fn default() -> Self {
        Self::EVERYWHERE
    }
}

/// A state that the term behind it is multiplied with.
///
/// q is the position of the axis, v its velocity, d its direction of motion and T the temperature of the sensor. Axes and
/// sensors are indices into the slices of a [`Sample`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Factor<'a> {
    /// `q^power`.
    Position {
        /// The axis.
        axis: usize,
        /// 1, 2 or 3.
        power: u8,
        /// Where q was seen.
        within: Within,
    },
    /// `d`.
    Direction {
        /// The axis.
        axis: usize,
    },
    /// `v`.
    Velocity {
        /// The axis.
        axis: usize,
        /// Where v was seen.
        within: Within,
    },
    /// `|v|`.
    Speed {
        /// The axis.
        axis: usize,
        /// Where the speed was seen.
        within: Within,
    },
    /// `exp(-|v|/over)`: what is there at rest and fades with speed, as dry friction does.
    Fading {
        /// The axis.
        axis: usize,
        /// The speed at which a third is left, in mm/s or rad/s, greater than zero.
        over: Real,
    },
    /// `T* - T0`. T* is T behind a first-order filter that starts at the first T.
    Temperature {
        /// The sensor.
        sensor: usize,
        /// T0, in degC.
        reference: Real,
        /// Time constant of the filter, in s; 0: no filter.
        time_constant: Real,
        /// Where T* was seen, in degC.
        within: Within,
    },
    /// `T' - T0`. T' follows T, but stays up to half a width behind it, as a joint does that slips.
    Play {
        /// The sensor.
        sensor: usize,
        /// T0, in degC.
        reference: Real,
        /// The width, in K, not negative.
        width: Real,
    },
    /// W, of `tau W' = rise |v| - W` from zero: how warm the motion of an axis has made it.
    Warmth {
        /// The axis.
        axis: usize,
        /// tau, in s, greater than zero.
        time_constant: Real,
        /// How warm a lasting speed makes it, in K for each mm/s or rad/s.
        rise: Real,
    },
    /// `sin(2 pi q/P + f)`.
    Turn {
        /// The axis.
        axis: usize,
        /// Period P, in mm or rad, greater than zero.
        period: Real,
        /// Phase f, in rad.
        phase: Real,
    },
    /// A curve over q, piecewise linear, held constant outside.
    Curve {
        /// The axis.
        axis: usize,
        /// The curve.
        table: Table<'a>,
    },
}

impl Factor<'_> {
    /// The value in what is read; `memory` is what the factor remembers, none before its first cycle.
    #[inline(always)]
    pub(crate) fn read(&self, from: &mut OneSample<'_>, memory: Option<&Real>) -> Real {
        match *self {
            Self::Position { axis, power, within } => {
                let position = within.hold(from.position(axis));
                (1..power).fold(position, |value, _| value * position)
            }
            Self::Direction { axis } => from.sign(axis),
            Self::Velocity { axis, within } => within.hold(from.velocity(axis)),
            Self::Speed { axis, within } => within.hold(magnitude(from.velocity(axis))),
            Self::Fading { axis, over } => {
                let speed = magnitude(from.velocity(axis));
                1.0 + exp_m1(-speed / over)
            }
            Self::Temperature { sensor, reference, time_constant, within } => {
                let now = from.temperature(sensor);
                let filtered = if time_constant > 0.0 { memory.copied().unwrap_or(now) } else { now };
                within.hold(filtered) - reference
            }
            Self::Play { sensor, reference, .. } => {
                memory.copied().unwrap_or(from.temperature(sensor)) - reference
            }
            Self::Warmth { .. } => memory.copied().unwrap_or(0.0),
            Self::Turn { axis, period, phase } => sin(angle(from.position(axis) / period, phase)),
            Self::Curve { axis, ref table } => from.table(table, axis),
        }
    }

    /// Takes the factor's memory over to the cycle of this sample: see [`Term::advance`](super::Term::advance).
    pub(crate) fn advance(&self, sample: &Sample<'_>, state: &mut TermState) {
        match *self {
            Self::Temperature { sensor, time_constant, .. } if time_constant > 0.0 => {
                advance_filter(sample, sensor, time_constant, state);
            }
            Self::Play { sensor, width, .. } => advance_width(sample, sensor, width, state),
            Self::Warmth { axis, time_constant, rise } => {
                advance_warmth(sample, axis, time_constant, rise, state);
            }
            _ => {}
        }
    }

    /// Whether it remembers anything from cycle to cycle.
    pub(crate) const fn remembers(&self) -> bool {
        match *self {
            Self::Temperature { time_constant, .. } => time_constant > 0.0,
            Self::Play { .. } | Self::Warmth { .. } => true,
            _ => false,
        }
    }

    /// Index of the axis that it reads.
    pub(crate) const fn axis(&self) -> Option<usize> {
        match *self {
            Self::Position { axis, .. }
            | Self::Direction { axis }
            | Self::Velocity { axis, .. }
            | Self::Speed { axis, .. }
            | Self::Fading { axis, .. }
            | Self::Warmth { axis, .. }
            | Self::Turn { axis, .. }
            | Self::Curve { axis, .. } => Some(axis),
            Self::Temperature { .. } | Self::Play { .. } => None,
        }
    }

    /// Index of the sensor that it reads.
    pub(crate) const fn sensor(&self) -> Option<usize> {
        match *self {
            Self::Temperature { sensor, .. } | Self::Play { sensor, .. } => Some(sensor),
            _ => None,
        }
    }

    /// Whether it reads a velocity.
    pub(crate) const fn reads_velocity(&self) -> bool {
        matches!(self, Self::Velocity { .. } | Self::Speed { .. } | Self::Fading { .. } | Self::Warmth { .. })
    }

    /// The name of the first parameter that is not finite or out of its range.
    pub(crate) fn bad_parameter(&self) -> Option<&'static str> {
        let checks = match *self {
            Self::Position { power, within, .. } => {
                [("power", matches!(power, 1..=3)), ("within", within.is_usable()), FINE]
            }
            Self::Direction { .. } | Self::Curve { .. } => [FINE; 3],
            Self::Velocity { within, .. } | Self::Speed { within, .. } => {
                [("within", within.is_usable()), FINE, FINE]
            }
            Self::Fading { over, .. } => [("over", positive(over)), FINE, FINE],
            Self::Temperature { reference, time_constant, within, .. } => [
                ("reference", reference.is_finite()),
                ("time_constant", not_negative(time_constant)),
                ("within", within.is_usable()),
            ],
            Self::Play { reference, width, .. } => {
                [("reference", reference.is_finite()), ("width", not_negative(width)), FINE]
            }
            Self::Warmth { time_constant, rise, .. } => {
                [("time_constant", positive(time_constant)), ("rise", rise.is_finite()), FINE]
            }
            Self::Turn { period, phase, .. } => {
                [("period", positive(period)), ("phase", phase.is_finite()), FINE]
            }
        };
        checks.iter().find(|(_, usable)| !usable).map(|(name, _)| *name)
    }
}

/// The size of a velocity.
fn magnitude(velocity: Real) -> Real {
    if velocity > 0.0 { velocity } else { -velocity }
}

/// Finite and above zero.
fn positive(value: Real) -> bool {
    value.is_finite() && value > 0.0
}
