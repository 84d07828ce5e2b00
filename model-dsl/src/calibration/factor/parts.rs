//! A factor by its keys. In: a factor. Out: what stands behind each of its keys, and the other way. It exists so that whoever
//! reads, writes or prints factors needs no list of them.

use super::{Factor, FactorKind, Within};

/// What stands behind a key of a factor, in mm, rad, s and degC.
#[derive(Clone, PartialEq, Debug)]
pub enum FactorPart<'f> {
    /// An axis, by its number.
    Axis(usize),
    /// A sensor, by its number.
    Sensor(usize),
    /// A load, by its name.
    Load(&'f str),
    /// A power.
    Power(u8),
    /// A number. One that may be left out is 0 there.
    Amount(f64),
    /// A range.
    Range(Within),
    /// A list of numbers.
    List(&'f [f64]),
}

/// What was read of a factor.
#[derive(Debug, Default)]
pub(in crate::calibration) struct FactorParts {
    pub(in crate::calibration) axis: Option<usize>,
    pub(in crate::calibration) sensor: Option<usize>,
    pub(in crate::calibration) load: Option<String>,
    pub(in crate::calibration) power: Option<u8>,
    pub(in crate::calibration) within: Within,
    pub(in crate::calibration) amounts: Vec<(&'static str, f64)>,
    pub(in crate::calibration) lists: Vec<(&'static str, Vec<f64>)>,
}

impl FactorParts {
    /// The factor of these parts; nothing where one is missing.
    pub(in crate::calibration) fn factor(mut self, kind: FactorKind) -> Option<Factor> {
        let amount =
            |key: &str| self.amounts.iter().find(|(known, _)| *known == key).map(|(_, value)| *value);
        let (axis, sensor, within) = (self.axis, self.sensor, self.within);
        Some(match kind {
            FactorKind::Position => Factor::Position { axis: axis?, power: self.power.unwrap_or(1), within },
            FactorKind::Direction => Factor::Direction { axis: axis? },
            FactorKind::Velocity => Factor::Velocity { axis: axis?, within },
            FactorKind::Speed => Factor::Speed { axis: axis?, within },
            FactorKind::Fading => Factor::Fading { axis: axis?, over: amount("over")? },
            FactorKind::Acceleration => Factor::Acceleration { axis: axis?, within },
            FactorKind::Temperature => Factor::Temperature {
                sensor: sensor?,
                reference: amount("reference")?,
                time_constant: amount("time_constant")?,
                within,
            },
            FactorKind::Play => {
                Factor::Play { sensor: sensor?, reference: amount("reference")?, width: amount("width")? }
            }
            FactorKind::Warmth => {
                Factor::Warmth { axis: axis?, time_constant: amount("time_constant")?, rise: amount("rise")? }
            }
            FactorKind::Load => Factor::Load { load: self.load?, within },
            FactorKind::Half => Factor::Half { at: amount("at")?, load: self.load? },
            FactorKind::Turn => {
                Factor::Turn { axis: axis?, period: amount("period")?, phase: amount("phase")? }
            }
            FactorKind::Spin => {
                Factor::Spin { rate: amount("rate")?, phase: amount("phase")?, load: self.load? }
            }
            FactorKind::Curve => {
                let mut list = |key: &str| {
                    let place = self.lists.iter().position(|(known, _)| *known == key)?;
                    Some(self.lists.swap_remove(place).1)
                };
                Factor::Curve { axis: axis?, at: list("at")?, values: list("values")? }
            }
            FactorKind::After => Factor::After { time: amount("after")? },
        })
    }
}

impl Factor {
    /// What stands behind each key of the vocabulary that this factor has.
    pub fn parts(&self) -> Vec<(&'static str, FactorPart<'_>)> {
        use FactorPart::{Amount, Axis, List, Load, Power, Range, Sensor};
        let name = self.kind().name();
        match self {
            Self::Position { axis, power, within } => {
                vec![(name, Axis(*axis)), ("power", Power(*power)), ("within", Range(*within))]
            }
            Self::Direction { axis } => vec![(name, Axis(*axis))],
            Self::Velocity { axis, within }
            | Self::Speed { axis, within }
            | Self::Acceleration { axis, within } => {
                vec![(name, Axis(*axis)), ("within", Range(*within))]
            }
            Self::Fading { axis, over } => vec![(name, Axis(*axis)), ("over", Amount(*over))],
            Self::Temperature { sensor, reference, time_constant, within } => vec![
                (name, Sensor(*sensor)),
                ("reference", Amount(*reference)),
                ("time_constant", Amount(*time_constant)),
                ("within", Range(*within)),
            ],
            Self::Play { sensor, reference, width } => {
                vec![(name, Sensor(*sensor)), ("reference", Amount(*reference)), ("width", Amount(*width))]
            }
            Self::Warmth { axis, time_constant, rise } => {
                vec![(name, Axis(*axis)), ("time_constant", Amount(*time_constant)), ("rise", Amount(*rise))]
            }
            Self::Load { load, within } => vec![(name, Load(load)), ("within", Range(*within))],
            Self::Half { load, at } => vec![(name, Load(load)), ("at", Amount(*at))],
            Self::Turn { axis, period, phase } => {
                vec![(name, Axis(*axis)), ("period", Amount(*period)), ("phase", Amount(*phase))]
            }
            Self::Spin { load, rate, phase } => {
                vec![(name, Load(load)), ("rate", Amount(*rate)), ("phase", Amount(*phase))]
            }
            Self::Curve { axis, at, values } => {
                vec![(name, Axis(*axis)), ("at", List(at)), ("values", List(values))]
            }
            Self::After { time } => vec![(name, Amount(*time))],
        }
    }
}
