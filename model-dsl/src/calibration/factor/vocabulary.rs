//! The vocabulary of factors: the table of all states that a term may be multiplied with.
//!
//! In: nothing. Out: for each factor its name, its keys and their kinds, what it says, and whether a controller knows it in
//! time. Readers, writers, schemas and the reference speak of factors from here alone.

use crate::calibration::vocabulary::State;
use crate::quantity::Dimension;

/// A factor of the vocabulary, without its numbers.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum FactorKind {
    /// Where an axis stands.
    Position,
    /// Which way it moves.
    Direction,
    /// How fast, with the sign.
    Velocity,
    /// How fast, without.
    Speed,
    /// What is there at rest and fades with speed.
    Fading,
    /// How its speed changes.
    Acceleration,
    /// How warm a sensor is.
    Temperature,
    /// How warm, up to a slip.
    Play,
    /// How warm the motion of an axis has made it.
    Warmth,
    /// A load.
    Load,
    /// What a load takes away.
    Half,
    /// A wave over the position of an axis.
    Turn,
    /// A wave over the turns of a channel of a speed.
    Spin,
    /// A curve over the position of an axis.
    Curve,
    /// From a moment on.
    After,
}

/// What the vocabulary says of a factor.
#[derive(Clone, Copy, Debug)]
pub struct FactorEntry {
    /// The factor.
    pub kind: FactorKind,
    /// Its name in calibration files, which is its first key.
    pub name: &'static str,
    /// What it depends on.
    pub state: State,
    /// Its value as a formula.
    pub value: &'static str,
    /// What a machine has that depends on it.
    pub physics: &'static str,
    /// Its keys, its name first.
    pub keys: &'static [FactorKey],
    /// Why no controller knows it in time; nothing where one does.
    pub not_compensable: Option<&'static str>,
}

/// A key of a factor.
#[derive(Clone, Copy, Debug)]
pub struct FactorKey {
    /// The key in calibration files.
    pub name: &'static str,
    /// What stands behind it.
    pub holds: FactorHolds,
    /// What follows where it is left out; nothing where it must be there.
    pub or: Option<&'static str>,
}

/// What stands behind a key of a factor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FactorHolds {
    /// The letter of an axis.
    Axis,
    /// The name of a temperature sensor.
    Sensor,
    /// The name of a load.
    Load,
    /// 1, 2 or 3.
    Power,
    /// A number with its unit.
    Amount(Measure, Limit),
    /// Two of them, the lower first: where the state was seen.
    Range(Measure),
    /// A list of them in rising order.
    Nodes(Measure),
    /// A list of bare numbers.
    Ratios,
}

/// Which values an amount may have.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Limit {
    /// All.
    None,
    /// Greater than zero.
    Positive,
    /// Zero or greater.
    NotNegative,
}

/// The kind of an amount, relative to the axis of its factor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Measure {
    /// A position of the axis.
    Position,
    /// A speed of the axis.
    Speed,
    /// An acceleration of the axis.
    Acceleration,
    /// A temperature.
    Temperature,
    /// A difference of temperatures.
    Step,
    /// A difference of temperatures for each unit of speed of the axis.
    Rise,
    /// A time.
    Time,
    /// An angle.
    Angle,
    /// A load.
    Load,
    /// A frequency for each unit of a load.
    Rate,
}

impl Measure {
    /// The dimension, for an axis whose positions are of this one; a load counts as a force.
    pub fn dimension(self, position: Dimension) -> Dimension {
        let speed = position.per(Dimension::TIME);
        match self {
            Self::Position => position,
            Self::Speed => speed,
            Self::Acceleration => speed.per(Dimension::TIME),
            Self::Temperature | Self::Step => Dimension::TEMPERATURE,
            Self::Rise => Dimension::TEMPERATURE.per(speed),
            Self::Time => Dimension::TIME,
            Self::Angle => Dimension::ANGLE,
            Self::Load => Dimension::FORCE,
            Self::Rate => Dimension::FREQUENCY.per(Dimension::FORCE),
        }
    }

    /// The unit in which it is kept and written.
    pub fn unit(self, position: Dimension) -> String {
        match self {
            // A temperature has a zero, a step of it has none.
            Self::Temperature => "degC".to_owned(),
            other => other.dimension(position).internal_unit(),
        }
    }
}

/// All factors, in the order of [`FactorKind`].
pub const FACTORS: [FactorEntry; 15] = [
    FactorEntry {
        kind: FactorKind::Position,
        name: "position",
        state: State::Position,
        value: "q^power",
        physics: "wear or sag along a travel, a carriage beyond its support",
        keys: &[
            key("position", FactorHolds::Axis),
            key("power", FactorHolds::Power).or("1"),
            WITHIN_POSITION,
        ],
        not_compensable: None,
    },
    FactorEntry {
        kind: FactorKind::Direction,
        name: "direction",
        state: State::Direction,
        value: "d",
        physics: "an effect that differs forwards and backwards: a belt, a weight, two flanks",
        keys: &[key("direction", FactorHolds::Axis)],
        not_compensable: None,
    },
    FactorEntry {
        kind: FactorKind::Velocity,
        name: "velocity",
        state: State::Velocity,
        value: "v",
        physics: "drag of a motion: oil, a hose, a cover",
        keys: &[key("velocity", FactorHolds::Axis), WITHIN_SPEED],
        not_compensable: None,
    },
    FactorEntry {
        kind: FactorKind::Speed,
        name: "speed",
        state: State::Velocity,
        value: "|v|",
        physics: "a table that rises on its oil film",
        keys: &[key("speed", FactorHolds::Axis), WITHIN_SPEED],
        not_compensable: None,
    },
    FactorEntry {
        kind: FactorKind::Fading,
        name: "fading",
        state: State::Velocity,
        value: "exp(-|v|/over)",
        physics: "dry friction that gives way to an oil film (Stribeck)",
        keys: &[key("fading", FactorHolds::Axis), key("over", POSITIVE_SPEED)],
        not_compensable: None,
    },
    FactorEntry {
        kind: FactorKind::Acceleration,
        name: "acceleration",
        state: State::Acceleration,
        value: "a",
        physics: "a column that bends when a saddle is accelerated",
        keys: &[
            key("acceleration", FactorHolds::Axis),
            key("within", FactorHolds::Range(Measure::Acceleration)).or("everywhere"),
        ],
        not_compensable: Some("the correction would itself accelerate the axis"),
    },
    FactorEntry {
        kind: FactorKind::Temperature,
        name: "temperature",
        state: State::Temperature,
        value: "T* - T0",
        physics: "a backlash, a squareness or a stiffness that follows a temperature",
        keys: &[
            key("temperature", FactorHolds::Sensor),
            REFERENCE,
            key("time_constant", FactorHolds::Amount(Measure::Time, Limit::Positive)).or("no filter"),
            key("within", FactorHolds::Range(Measure::Temperature)).or("everywhere"),
        ],
        not_compensable: None,
    },
    FactorEntry {
        kind: FactorKind::Play,
        name: "play",
        state: State::Temperature,
        value: "T' - T0",
        physics: "a joint that slips before it follows a temperature",
        keys: &[
            key("play", FactorHolds::Sensor),
            REFERENCE,
            key("width", FactorHolds::Amount(Measure::Step, Limit::NotNegative)),
        ],
        not_compensable: None,
    },
    FactorEntry {
        kind: FactorKind::Warmth,
        name: "warmth",
        state: State::Velocity,
        value: "W of tau W' = rise |v| - W",
        physics: "a screw or a bearing warmed by its own motion",
        keys: &[
            key("warmth", FactorHolds::Axis),
            key("time_constant", FactorHolds::Amount(Measure::Time, Limit::Positive)),
            key("rise", FactorHolds::Amount(Measure::Rise, Limit::None)),
        ],
        not_compensable: None,
    },
    FactorEntry {
        kind: FactorKind::Load,
        name: "load",
        state: State::Load,
        value: "F",
        physics: "an effect that a load increases: a wind-up, a deflection along a travel",
        keys: &[
            key("load", FactorHolds::Load),
            key("within", FactorHolds::Range(Measure::Load)).or("everywhere"),
        ],
        not_compensable: Some("a controller does not know the load in time"),
    },
    FactorEntry {
        kind: FactorKind::Half,
        name: "half",
        state: State::Load,
        value: "1/(1 + |F|/at)",
        physics: "an effect that a load removes: a gap that closes",
        keys: &[
            key("half", FactorHolds::Load),
            key("at", FactorHolds::Amount(Measure::Load, Limit::Positive)),
        ],
        not_compensable: Some("a controller does not know the load in time"),
    },
    FactorEntry {
        kind: FactorKind::Turn,
        name: "turn",
        state: State::Position,
        value: "sin(2 pi q/period + phase)",
        physics: "a screw or a worm with runout",
        keys: &[
            key("turn", FactorHolds::Axis),
            key("period", FactorHolds::Amount(Measure::Position, Limit::Positive)),
            PHASE,
        ],
        not_compensable: None,
    },
    FactorEntry {
        kind: FactorKind::Spin,
        name: "spin",
        state: State::Load,
        value: "sin(2 pi n + phase), n' = rate F",
        physics: "an unbalance that follows the speed of a spindle",
        keys: &[
            key("spin", FactorHolds::Load),
            key("rate", FactorHolds::Amount(Measure::Rate, Limit::None)),
            PHASE,
        ],
        not_compensable: Some("a controller does not know its phase"),
    },
    FactorEntry {
        kind: FactorKind::Curve,
        name: "curve",
        state: State::Position,
        value: "piecewise linear in q, held constant outside",
        physics: "a change along a travel that is not a power of the position: a worn zone",
        keys: &[
            key("curve", FactorHolds::Axis),
            key("at", FactorHolds::Nodes(Measure::Position)),
            key("values", FactorHolds::Ratios),
        ],
        not_compensable: None,
    },
    FactorEntry {
        kind: FactorKind::After,
        name: "after",
        state: State::Time,
        value: "0 before a time, then 1",
        physics: "an effect since an event",
        keys: &[key("after", FactorHolds::Amount(Measure::Time, Limit::None))],
        not_compensable: Some("a controller does not know when it happened"),
    },
];

const POSITIVE_SPEED: FactorHolds = FactorHolds::Amount(Measure::Speed, Limit::Positive);
const WITHIN_POSITION: FactorKey = key("within", FactorHolds::Range(Measure::Position)).or("everywhere");
const WITHIN_SPEED: FactorKey = key("within", FactorHolds::Range(Measure::Speed)).or("everywhere");
const REFERENCE: FactorKey = key("reference", FactorHolds::Amount(Measure::Temperature, Limit::None));
const PHASE: FactorKey = key("phase", FactorHolds::Amount(Measure::Angle, Limit::None)).or("0");

const fn key(name: &'static str, holds: FactorHolds) -> FactorKey {
    FactorKey { name, holds, or: None }
}

impl FactorKey {
    const fn or(self, absent: &'static str) -> Self {
        Self { or: Some(absent), ..self }
    }
}

/// The names of all factors.
pub const FACTOR_NAMES: [&str; FACTORS.len()] = {
    let mut names = [""; FACTORS.len()];
    let mut number = 0;
    while number < names.len() {
        // A factor is found by its number.
        assert!(FACTORS[number].kind as usize == number);
        names[number] = FACTORS[number].name;
        number += 1;
    }
    names
};

/// The table at one place, so that what is taken from it stays.
static TABLE: [FactorEntry; FACTORS.len()] = FACTORS;

impl FactorKind {
    /// All of them, in the order of the vocabulary.
    pub fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|entry| entry.kind)
    }

    /// The factor of a name in calibration files.
    pub fn of_name(name: &str) -> Option<Self> {
        TABLE.iter().find(|entry| entry.name == name).map(|entry| entry.kind)
    }

    /// What the vocabulary says of it.
    pub fn entry(self) -> &'static FactorEntry {
        &TABLE[self as usize]
    }

    /// Its name in calibration files.
    pub fn name(self) -> &'static str {
        self.entry().name
    }
}

impl FactorEntry {
    /// The names of its keys, in order.
    pub fn key_names(&self) -> Vec<&'static str> {
        self.keys.iter().map(|key| key.name).collect()
    }
}
