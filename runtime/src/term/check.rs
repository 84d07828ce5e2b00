//! What a term reads and whether its parameters can be used.
//!
//! In: a term. Out: its axis, its sensor, the name of a parameter that is out of range. It exists so that a compensator
//! refuses a bad term once, when it is built, and not in every cycle.

use super::super::real::Real;
use super::{Input, Term};

impl Term<'_> {
    /// Index of the axis whose position, velocity or direction the term reads; none where it reads no axis.
    #[must_use]
    pub const fn axis(&self) -> Option<usize> {
        match *self {
            Self::Polynomial { input: Input::Axis(axis), .. }
            | Self::Coupling { axis, .. }
            | Self::Table { axis, .. }
            | Self::Backlash { axis, .. }
            | Self::Cyclic { axis, .. }
            | Self::Expansion { axis, .. }
            | Self::Lag { axis, .. } => Some(axis),
            Self::Polynomial { input: Input::Sensor(_), .. }
            | Self::Constant { .. }
            | Self::Growth { .. } => None,
            Self::Factor(ref factor) => factor.axis(),
        }
    }

    /// Index of the sensor that the term reads.
    pub(crate) const fn sensor(&self) -> Option<usize> {
        match *self {
            Self::Polynomial { input: Input::Sensor(sensor), .. }
            | Self::Expansion { sensor, .. }
            | Self::Growth { sensor, .. } => Some(sensor),
            Self::Factor(ref factor) => factor.sensor(),
            _ => None,
        }
    }

    /// Whether the term reads a velocity.
    pub(crate) const fn reads_velocity(&self) -> bool {
        match *self {
            Self::Lag { .. } => true,
            Self::Factor(ref factor) => factor.reads_velocity(),
            _ => false,
        }
    }

    /// Whether the next term is multiplied with it.
    #[inline]
    pub(crate) const fn is_factor(&self) -> bool {
        matches!(*self, Self::Factor(_))
    }

    /// Whether the correction of the term is spread over time.
    pub(crate) fn is_ramped(&self) -> bool {
        matches!(*self, Self::Backlash { ramp, .. } if ramp > 0.0)
    }

    /// Whether the term remembers anything from cycle to cycle: what [`Term::advance`] changes.
    pub(crate) fn remembers(&self) -> bool {
        match *self {
            Self::Backlash { wind_up, ramp, .. } => wind_up > 0.0 || ramp > 0.0,
            Self::Growth { time_constant, .. } => time_constant > 0.0,
            Self::Factor(ref factor) => factor.remembers(),
            _ => false,
        }
    }

    /// The name of the first parameter that is not finite or out of its range.
    pub(crate) fn bad_parameter(&self) -> Option<&'static str> {
        let checks = match *self {
            Self::Constant { value } => [("value", value.is_finite()), FINE, FINE],
            Self::Polynomial { coefficients, .. } | Self::Coupling { coefficients, .. } => {
                let finite = coefficients.iter().all(|coefficient| coefficient.is_finite());
                [("coefficients", finite), FINE, FINE]
            }
            Self::Table { .. } => [FINE, FINE, FINE],
            Self::Backlash { lost_motion, wind_up, ramp, .. } => [
                ("lost_motion", lost_motion.is_finite()),
                ("wind_up", not_negative(wind_up)),
                ("ramp", not_negative(ramp)),
            ],
            Self::Cyclic { period, amplitude, phase, .. } => [
                ("period", divisor(period)),
                ("amplitude", amplitude.is_finite()),
                ("phase", phase.is_finite()),
            ],
            Self::Expansion { coefficient, reference, .. } => {
                [("coefficient", coefficient.is_finite()), ("reference", reference.is_finite()), FINE]
            }
            Self::Growth { coefficient, reference, time_constant, .. } => [
                ("coefficient", coefficient.is_finite()),
                ("reference", reference.is_finite()),
                ("time_constant", not_negative(time_constant)),
            ],
            Self::Lag { gain, .. } => [("gain", divisor(gain)), FINE, FINE],
            Self::Factor(ref factor) => return factor.bad_parameter(),
        };
        checks.iter().find(|(_, usable)| !usable).map(|(name, _)| *name)
    }
}

/// A place in the list of checks where a term has no further parameter.
pub(crate) const FINE: (&str, bool) = ("", true);

/// Finite and not below zero.
pub(crate) fn not_negative(value: Real) -> bool {
    value.is_finite() && value >= 0.0
}

/// Finite and not zero.
fn divisor(value: Real) -> bool {
    value.is_finite() && value != 0.0
}
