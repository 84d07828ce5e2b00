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
    let over = |of: &dyn Fn(&Effect) -> Option<f64>| {
        let numbers: Vec<f64> = effects.iter().filter_map(of).collect();
        let low = numbers.iter().copied().reduce(f64::min)?;
        let high = numbers.iter().copied().reduce(f64::max)?;
        Some((low, high))
    };
    let rotary = |axis: usize| base.names.axes.get(axis).is_some_and(|axis| axis.rotary);
    let along = |effect: &Effect| match *effect {
        Effect::Table { axis, .. } | Effect::Backlash { axis, .. } | Effect::Cyclic { axis, .. } => {
            rotary(axis)
        }
        _ => false,
    };
    let (way, per) = if effects.first().is_some_and(along) { ("deg", 360.0 / TAU) } else { ("mm", 1.0) };
    let named: [(&str, &str, f64, &dyn Fn(&Effect) -> Option<f64>); 6] = [
        ("wound up over", way, per, &|effect| match *effect {
            Effect::Backlash { wind_up, .. } if wind_up > 0.0 => Some(wind_up),
            _ => None,
        }),
        ("width", way, per, &|effect| match *effect {
            Effect::Table { width, .. } => Some(width),
            _ => None,
        }),
        ("decay", "s", 1.0, &|effect| match *effect {
            Effect::ReversalSpike { decay, .. } => Some(decay),
            _ => None,
        }),
        ("period", way, per, &|effect| match *effect {
            Effect::Cyclic { period, .. } => Some(period),
            _ => None,
        }),
        ("time constant", "s", 1.0, &|effect| match *effect {
            Effect::Growth { time_constant, .. } | Effect::Drift { time_constant, .. } => Some(time_constant),
            _ => None,
        }),
        ("frequency", "Hz", 1.0, &|effect| match *effect {
            Effect::Vibration { frequency, .. } => Some(frequency),
            _ => None,
        }),
    ];
    let told = named.iter().filter_map(|(name, unit, factor, of)| {
        let (low, high) = over(*of)?;
        Some(format!("{name} {} to {} {unit}", short(low * factor), short(high * factor)))
    });
    told.collect::<Vec<_>>().join(", ")
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
