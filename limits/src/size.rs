//! Sizes in the units in which people speak of them. In: the strength of an effect in mm, rad, s, K. Out: a number with its unit and what
//! it is the size of.

use std::f64::consts::TAU;

use crate::injection::base::Base;
use crate::injection::effect::Effect;

/// What the strength of an effect means.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// What it is the size of: `lost motion`, `range over the travel`.
    pub of: &'static str,
    /// The unit: `um`, `urad`, `1/s`, ...
    pub unit: String,
    /// The told number for a strength of 1; of a gain for one over it.
    factor: f64,
    /// Whether the told number is one over the strength: of a gain the *smaller* ones are found.
    pub is_gain: bool,
}

impl Scale {
    /// That of an effect in a motion.
    pub fn of(base: &Base, motion: usize, effect: &Effect) -> Self {
        let turns = base.names.motions[motion].angular;
        let (unit, factor) = if turns { ("urad", 1e6) } else { ("um", 1e3) };
        let range = |axis: usize| base.path.axes.get(axis).and_then(|axis| Some(axis.as_ref()?.travel()));
        let plain = |of: &'static str| Self { of, unit: unit.to_owned(), factor, is_gain: false };
        let gain = |unit: &str| Self { of: "gain", unit: unit.to_owned(), factor: 1.0, is_gain: true };
        match *effect {
            Effect::Constant { .. } => plain("size"),
            Effect::Polynomial { axis, .. } => {
                plain("range over the travel").times(range(axis).unwrap_or(1.0))
            }
            Effect::Coupling { axis, .. } => {
                plain("height of the bow").times((0.5 * range(axis).unwrap_or(1.0)).powi(2))
            }
            Effect::Table { .. } => plain("height of the bump"),
            Effect::Backlash { .. } => plain("lost motion"),
            Effect::ReversalSpike { .. } => plain("height"),
            Effect::Cyclic { .. } | Effect::Vibration { .. } => plain("amplitude"),
            Effect::Drift { .. } => plain("final value"),
            Effect::Lag { .. } => gain("1/s"),
            Effect::Acceleration { .. } => gain("1/s^2"),
            Effect::Expansion { .. } => {
                Self { of: "coefficient", unit: "um/(m K)".to_owned(), factor: 1e6, is_gain: false }
            }
            Effect::Growth { .. } => plain("coefficient").per("K"),
            Effect::Compliance { load, .. } => {
                let of = base.recording.loads.get(load).map_or("1", |load| load.unit.as_str());
                plain("coefficient").per(of)
            }
        }
    }

    fn times(self, by: f64) -> Self {
        Self { factor: self.factor * by, ..self }
    }

    fn per(self, unit: &str) -> Self {
        Self { unit: format!("{}/{unit}", self.unit), ..self }
    }

    /// A strength as it is told.
    pub fn told(&self, strength: f64) -> f64 {
        if self.is_gain { self.factor / strength } else { self.factor * strength }
    }

    /// Half of an interval of the strength as it is told.
    pub fn half(&self, strength: f64, half: f64) -> f64 {
        self.told(strength) * half / strength
    }
}

/// What else was drawn for the trials, from the least to the most: `period 21 to 34 mm`. Empty where an effect has nothing but its size.
pub fn drawn(base: &Base, effects: &[Effect]) -> String {
    let all: Vec<Drawn> = effects.iter().filter_map(|effect| Drawn::of(base, effect)).collect();
    let Some(first) = all.first() else { return String::new() };
    let low = all.iter().map(|one| one.value).fold(f64::INFINITY, f64::min);
    let high = all.iter().map(|one| one.value).fold(f64::NEG_INFINITY, f64::max);
    format!("{} {} to {} {}", first.name, short(low), short(high), first.unit)
}

/// The number that was drawn for an effect besides its size.
struct Drawn {
    name: &'static str,
    value: f64,
    unit: &'static str,
}

impl Drawn {
    fn of(base: &Base, effect: &Effect) -> Option<Self> {
        let along = |name: &'static str, axis: usize, value: f64| match base.names.axes.get(axis) {
            Some(axis) if axis.rotary => Self { name, value: value * 360.0 / TAU, unit: "deg" },
            _ => Self { name, value, unit: "mm" },
        };
        let time = |name: &'static str, value: f64| Self { name, value, unit: "s" };
        match *effect {
            Effect::Backlash { axis, wind_up, .. } if wind_up > 0.0 => {
                Some(along("wind-up of", axis, wind_up))
            }
            Effect::Table { axis, width, .. } => Some(along("width", axis, width)),
            Effect::Cyclic { axis, period, .. } => Some(along("period", axis, period)),
            Effect::ReversalSpike { decay, .. } => Some(time("decay", decay)),
            Effect::Growth { time_constant, .. } | Effect::Drift { time_constant, .. } => {
                Some(time("time constant", time_constant))
            }
            Effect::Vibration { frequency, .. } => {
                Some(Self { name: "frequency", value: frequency, unit: "Hz" })
            }
            _ => None,
        }
    }
}

/// A number with three significant digits, and no more than it needs.
pub fn short(value: f64) -> String {
    significant(value, 3)
}

/// A number with so many significant digits, without zeros at its end.
pub fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { "not known".to_owned() };
    }
    let first = crate::whole(value.abs().log10().floor());
    let places = usize::try_from(digits - 1 - first).unwrap_or(0);
    let scale = 10.0_f64.powi((first - digits + 1).max(0));
    let rounded = if scale > 1.0 { (value / scale).round() * scale } else { value };
    let text = format!("{rounded:.places$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_count() {
        let told: Vec<String> = [0.000_123_44, 1.2, 12.345, 1234.0, 99_999.0, 0.0].map(short).to_vec();
        assert_eq!(told, ["0.000123", "1.2", "12.3", "1230", "100000", "0"]);
    }
}
