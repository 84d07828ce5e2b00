//! Factors: states of the machine that a term is multiplied with.
//!
//! In: nothing. Out: the factors with their numbers, the kinds that they are of, and what a controller makes of them. It
//! exists because machines multiply states: a play that is larger where the screw is worn, a wave that grows along the
//! travel, a yaw that follows the warmth of a drive. What they are called in files stands in their [`vocabulary`].

mod parts;
pub mod vocabulary;

pub use abbe_runtime::Within;
pub use parts::FactorPart;
pub(super) use parts::FactorParts;
pub use vocabulary::FactorKind;

use abbe_runtime::{Factor as RuntimeFactor, Table, Values};

use super::names::MachineNames;
use super::sensors::Sensors;
use super::term::NotCompensable;
use crate::quantity::Dimension;

/// A state that a term is multiplied with, in mm, rad, s, degC and the unit of the load.
///
/// An `axis` is an index into the machine's axes, a `sensor` one into the calibration's sensors. q is the position of the
/// axis, v its velocity, a its acceleration, d its direction of motion (+1 or -1), t the time since the recording began. A
/// load is `L`: its channel's name in a calibration, a number where it is evaluated.
#[derive(Clone, PartialEq, Debug)]
pub enum Factor<L = String> {
    /// `q^power`.
    Position {
        /// The axis.
        axis: usize,
        /// 1, 2 or 3.
        power: u8,
        /// Where q was seen, mm or rad.
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
        /// Where v was seen, mm/s or rad/s.
        within: Within,
    },
    /// `|v|`.
    Speed {
        /// The axis.
        axis: usize,
        /// Where the speed was seen, mm/s or rad/s.
        within: Within,
    },
    /// `exp(-|v|/over)`.
    Fading {
        /// The axis.
        axis: usize,
        /// The speed at which a third is left, mm/s or rad/s, greater than zero.
        over: f64,
    },
    /// `a`.
    Acceleration {
        /// The axis.
        axis: usize,
        /// Where a was seen, mm/s^2 or rad/s^2.
        within: Within,
    },
    /// `T* - T0`, T* being T through a first-order filter that starts at the first T.
    Temperature {
        /// The sensor of T.
        sensor: usize,
        /// T0, degC.
        reference: f64,
        /// The filter's time constant, s, not negative; 0: no filter.
        time_constant: f64,
        /// Where T* was seen, degC.
        within: Within,
    },
    /// `T' - T0`, T' following T but staying up to half a width behind it.
    Play {
        /// The sensor of T.
        sensor: usize,
        /// T0, degC.
        reference: f64,
        /// The width, K, not negative.
        width: f64,
    },
    /// W, of `tau W' = rise |v| - W` from zero.
    Warmth {
        /// The axis.
        axis: usize,
        /// tau, s, greater than zero.
        time_constant: f64,
        /// How warm a lasting speed makes it, K s/mm or K s/rad.
        rise: f64,
    },
    /// `F`.
    Load {
        /// The load's channel.
        load: L,
        /// Where F was seen.
        within: Within,
    },
    /// `1/(1 + |F|/at)`.
    Half {
        /// The load's channel.
        load: L,
        /// The load at which half is left, greater than zero.
        at: f64,
    },
    /// `sin(2 pi q/P + f)`.
    Turn {
        /// The axis.
        axis: usize,
        /// P, mm or rad, greater than zero.
        period: f64,
        /// f, rad.
        phase: f64,
    },
    /// `sin(2 pi n + f)`, n being the turns that a channel of a speed has made.
    Spin {
        /// The speed's channel.
        load: L,
        /// The turns in a second for each unit of the channel.
        rate: f64,
        /// f, rad.
        phase: f64,
    },
    /// A curve over q, piecewise linear, held constant outside.
    Curve {
        /// The axis.
        axis: usize,
        /// The nodes, mm or rad, ascending.
        at: Vec<f64>,
        /// A value for each node.
        values: Vec<f64>,
    },
    /// 0 before a time, 1 from it on.
    After {
        /// The time, s.
        time: f64,
    },
}

impl<L> Factor<L> {
    /// Which factor of the vocabulary it is.
    pub fn kind(&self) -> FactorKind {
        match self {
            Self::Position { .. } => FactorKind::Position,
            Self::Direction { .. } => FactorKind::Direction,
            Self::Velocity { .. } => FactorKind::Velocity,
            Self::Speed { .. } => FactorKind::Speed,
            Self::Fading { .. } => FactorKind::Fading,
            Self::Acceleration { .. } => FactorKind::Acceleration,
            Self::Temperature { .. } => FactorKind::Temperature,
            Self::Play { .. } => FactorKind::Play,
            Self::Warmth { .. } => FactorKind::Warmth,
            Self::Load { .. } => FactorKind::Load,
            Self::Half { .. } => FactorKind::Half,
            Self::Turn { .. } => FactorKind::Turn,
            Self::Spin { .. } => FactorKind::Spin,
            Self::Curve { .. } => FactorKind::Curve,
            Self::After { .. } => FactorKind::After,
        }
    }

    /// Whether a controller knows it in time.
    pub fn compensable(&self) -> bool {
        self.kind().entry().not_compensable.is_none()
    }

    /// The number of the axis that it reads, if it reads one.
    pub fn axis(&self) -> Option<usize> {
        match *self {
            Self::Position { axis, .. }
            | Self::Direction { axis }
            | Self::Velocity { axis, .. }
            | Self::Speed { axis, .. }
            | Self::Fading { axis, .. }
            | Self::Acceleration { axis, .. }
            | Self::Warmth { axis, .. }
            | Self::Turn { axis, .. }
            | Self::Curve { axis, .. } => Some(axis),
            _ => None,
        }
    }

    /// The number of the sensor that it reads, if it reads one.
    pub fn sensor(&self) -> Option<usize> {
        match *self {
            Self::Temperature { sensor, .. } | Self::Play { sensor, .. } => Some(sensor),
            _ => None,
        }
    }

    /// The load that it reads, if it reads one.
    pub fn load(&self) -> Option<&L> {
        match self {
            Self::Load { load, .. } | Self::Half { load, .. } | Self::Spin { load, .. } => Some(load),
            _ => None,
        }
    }

    /// The factor reading another axis, where it reads one. Its numbers stay.
    #[must_use]
    pub fn with_axis(mut self, number: usize) -> Self {
        match &mut self {
            Self::Position { axis, .. }
            | Self::Direction { axis }
            | Self::Velocity { axis, .. }
            | Self::Speed { axis, .. }
            | Self::Fading { axis, .. }
            | Self::Acceleration { axis, .. }
            | Self::Warmth { axis, .. }
            | Self::Turn { axis, .. }
            | Self::Curve { axis, .. } => *axis = number,
            _ => {}
        }
        self
    }

    /// The factor reading another sensor, where it reads one.
    #[must_use]
    pub fn with_sensor(mut self, number: usize) -> Self {
        match &mut self {
            Self::Temperature { sensor, .. } | Self::Play { sensor, .. } => *sensor = number,
            _ => {}
        }
        self
    }

    /// The factor with its load under another name; nothing where there is no such load.
    pub fn with_load<M>(self, find: impl FnOnce(L) -> Option<M>) -> Option<Factor<M>> {
        Some(match self {
            Self::Position { axis, power, within } => Factor::Position { axis, power, within },
            Self::Direction { axis } => Factor::Direction { axis },
            Self::Velocity { axis, within } => Factor::Velocity { axis, within },
            Self::Speed { axis, within } => Factor::Speed { axis, within },
            Self::Fading { axis, over } => Factor::Fading { axis, over },
            Self::Acceleration { axis, within } => Factor::Acceleration { axis, within },
            Self::Temperature { sensor, reference, time_constant, within } => {
                Factor::Temperature { sensor, reference, time_constant, within }
            }
            Self::Play { sensor, reference, width } => Factor::Play { sensor, reference, width },
            Self::Warmth { axis, time_constant, rise } => Factor::Warmth { axis, time_constant, rise },
            Self::Load { load, within } => Factor::Load { load: find(load)?, within },
            Self::Half { load, at } => Factor::Half { load: find(load)?, at },
            Self::Turn { axis, period, phase } => Factor::Turn { axis, period, phase },
            Self::Spin { load, rate, phase } => Factor::Spin { load: find(load)?, rate, phase },
            Self::Curve { axis, at, values } => Factor::Curve { axis, at, values },
            Self::After { time } => Factor::After { time },
        })
    }

    /// The kind of quantity that its value is; that of a load counts as a force.
    pub fn dimension(&self, names: &MachineNames) -> Dimension {
        let position = self.axis().map_or(Dimension::LENGTH, |axis| names.axis_dimension(axis));
        match *self {
            Self::Position { power, .. } => position.power(i8::try_from(power).unwrap_or(1)),
            Self::Velocity { .. } | Self::Speed { .. } => position.per(Dimension::TIME),
            Self::Acceleration { .. } => position.per(Dimension::TIME.power(2)),
            Self::Temperature { .. } | Self::Play { .. } | Self::Warmth { .. } => Dimension::TEMPERATURE,
            Self::Load { .. } => Dimension::FORCE,
            Self::Direction { .. }
            | Self::Fading { .. }
            | Self::Half { .. }
            | Self::Turn { .. }
            | Self::Spin { .. }
            | Self::Curve { .. }
            | Self::After { .. } => Dimension::NONE,
        }
    }

    /// The factor as the runtime evaluates it, with the same indices of axes and sensors.
    ///
    /// # Errors
    ///
    /// [`NotCompensable::Factor`] for what [`Factor::compensable`] denies, [`NotCompensable::Table`].
    pub fn runtime(&self) -> Result<RuntimeFactor<'_>, NotCompensable> {
        Ok(match *self {
            Self::Position { axis, power, within } => RuntimeFactor::Position { axis, power, within },
            Self::Direction { axis } => RuntimeFactor::Direction { axis },
            Self::Velocity { axis, within } => RuntimeFactor::Velocity { axis, within },
            Self::Speed { axis, within } => RuntimeFactor::Speed { axis, within },
            Self::Fading { axis, over } => RuntimeFactor::Fading { axis, over },
            Self::Temperature { sensor, reference, time_constant, within } => {
                RuntimeFactor::Temperature { sensor, reference, time_constant, within }
            }
            Self::Play { sensor, reference, width } => RuntimeFactor::Play { sensor, reference, width },
            Self::Warmth { axis, time_constant, rise } => RuntimeFactor::Warmth { axis, time_constant, rise },
            Self::Turn { axis, period, phase } => RuntimeFactor::Turn { axis, period, phase },
            Self::Curve { axis, ref at, ref values } => {
                let table = Table::at(at, Values::Both(values)).map_err(NotCompensable::Table)?;
                RuntimeFactor::Curve { axis, table }
            }
            Self::Acceleration { .. }
            | Self::Load { .. }
            | Self::Half { .. }
            | Self::Spin { .. }
            | Self::After { .. } => return Err(NotCompensable::Factor(self.kind())),
        })
    }
}

/// What several factors are together: the kind of their product.
pub fn dimension_of<L>(factors: &[Factor<L>], names: &MachineNames) -> Dimension {
    factors.iter().fold(Dimension::NONE, |product, factor| product.times(factor.dimension(names)))
}

impl Factor {
    /// What it is in a few words: `position X`, `temperature bed`, `after 1200 s`.
    pub fn label(&self, names: &MachineNames, sensors: &Sensors) -> String {
        let of = match self.parts().first() {
            Some((_, FactorPart::Axis(axis))) => names.axes.get(*axis).map(|axis| axis.letter.clone()),
            Some((_, FactorPart::Sensor(sensor))) => {
                sensors.iter().nth(*sensor).map(|sensor| sensor.name.value.clone())
            }
            Some((_, FactorPart::Load(load))) => Some((*load).to_owned()),
            Some((_, FactorPart::Amount(time))) => Some(format!("{time} s")),
            _ => None,
        };
        let power = match self {
            Self::Position { power: power @ 2.., .. } => format!("^{power}"),
            _ => String::new(),
        };
        format!("{} {}{power}", self.kind().name(), of.as_deref().unwrap_or("?"))
    }
}
