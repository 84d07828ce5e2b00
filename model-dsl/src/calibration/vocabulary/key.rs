//! The keys of terms. In: nothing. Out: what a key holds, of which kind its quantity is, and what follows where it is left out.

use super::TIMES;
use crate::quantity::Dimension;

/// A key of a term.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// The key in calibration files.
    pub name: &'static str,
    /// What stands behind it.
    pub holds: Holds,
    /// Whether it must be there.
    pub given: Given,
    /// Which values it may have.
    pub bound: Bound,
    /// What its numbers are in the value of the term.
    pub role: Role,
}

/// What stands behind a key.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Holds {
    /// A number with its unit.
    Quantity(Kind),
    /// A list of such; bare numbers where one unit is given for all.
    Quantities(Kind),
    /// A list of bare numbers, whose units stand beside it.
    Numbers,
    /// A unit of this kind.
    Unit(Base),
    /// An axis, the link's own where none is named.
    OwnAxis,
    /// An axis that is not the link's own.
    OtherAxis,
    /// The name of a temperature sensor.
    Sensor,
    /// The name of a load.
    Load,
    /// `true` or `false`.
    Flag,
    /// A list of [factors](crate::calibration::factor).
    Factors,
}

/// Whether a key must be there.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Given {
    /// Always.
    Required,
    /// In one of several ways to write the term.
    OneOf,
    /// It may be left out; a number is 0 then, which means this.
    Optional(&'static str),
}

/// Which values a quantity may have.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Bound {
    /// All.
    None,
    /// Greater than zero.
    Positive,
    /// Zero or greater.
    NotNegative,
    /// Any but zero.
    NotZero,
    /// Any but zero, and greater than zero where the key of this name stands beside it.
    PositiveBeside(&'static str),
}

/// What the numbers of a key are in the value of the term.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Role {
    /// The term is linear in them, and nothing else in it needs a name beside theirs.
    Value,
    /// The term is linear in them.
    Linear,
    /// The term is not linear in them.
    Shape,
    /// The term is not linear in them, and only its transients show them: a controller compensates the term without.
    Transient,
    /// They say where the others belong, or how they are written.
    Place,
    /// It stands beside the term and says how the term is used: see [`CalibratedMotion`](crate::calibration::CalibratedMotion).
    Setting,
}

/// The kind of a quantity, relative to the error motion and the axis of its term.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Kind {
    /// What it is.
    pub of: Base,
    /// What it is for each unit of.
    pub per: &'static [Base],
}

/// What kinds are made of.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Base {
    /// The error motion: a length or an angle.
    Motion,
    /// The position of the term's axis: a length, or an angle for a rotary axis.
    Position,
    /// An angle.
    Angle,
    /// A time.
    Time,
    /// A frequency.
    Frequency,
    /// A temperature.
    Temperature,
    /// A load: a force, or what a drive tells in its place.
    Load,
}

impl Kind {
    /// That of the error motion.
    pub const MOTION: Self = Self::plain(Base::Motion);
    /// That of the position of the term's axis.
    pub const POSITION: Self = Self::plain(Base::Position);
    /// An angle.
    pub const ANGLE: Self = Self::plain(Base::Angle);
    /// A time.
    pub const TIME: Self = Self::plain(Base::Time);
    /// A frequency.
    pub const FREQUENCY: Self = Self::plain(Base::Frequency);
    /// A temperature.
    pub const TEMPERATURE: Self = Self::plain(Base::Temperature);

    const fn plain(of: Base) -> Self {
        Self { of, per: &[] }
    }

    /// The dimension for an error motion and a position of these dimensions.
    ///
    /// Where nothing is known of the axis, since it was wrong, its position counts as a length, and beside the motion as of the
    /// motion's own dimension.
    pub(in crate::calibration) fn dimension(
        self,
        motion: Dimension,
        position: Option<Dimension>,
    ) -> Dimension {
        let unknown = if self.per.is_empty() { Dimension::LENGTH } else { motion };
        let position = position.unwrap_or(unknown);
        let of = |base: Base| match base {
            Base::Motion => motion,
            Base::Position => position,
            Base::Angle => Dimension::ANGLE,
            Base::Time => Dimension::TIME,
            Base::Frequency => Dimension::FREQUENCY,
            Base::Temperature => Dimension::TEMPERATURE,
            Base::Load => Dimension::FORCE,
        };
        self.per.iter().fold(of(self.of), |found, base| found.per(of(*base)))
    }

    /// Whether the error motion is in it, so that factors of the term are too.
    pub(in crate::calibration) fn is_of_motion(self) -> bool {
        self.of == Base::Motion || self.per.contains(&Base::Motion)
    }

    /// The unit in which its values are kept, for an error motion and a position in these units: `1/s` or `mm/rad/s`.
    pub(in crate::calibration) fn unit(self, motion: &str, position: &str) -> String {
        let unit = |base: Base, alone: bool| match base {
            Base::Motion => motion.to_owned(),
            Base::Position => position.to_owned(),
            Base::Angle => "rad".to_owned(),
            Base::Time => "s".to_owned(),
            Base::Frequency => "Hz".to_owned(),
            // A temperature has a zero, a step of it has none.
            Base::Temperature => if alone { "degC" } else { "K" }.to_owned(),
            Base::Load => "N".to_owned(),
        };
        let mut above = unit(self.of, self.per.is_empty());
        let mut below: Vec<String> = self.per.iter().map(|base| unit(*base, false)).collect();
        if let Some(cancels) = below.iter().position(|unit| *unit == above) {
            below.remove(cancels);
            "1".clone_into(&mut above);
        }
        let powers = below.chunk_by(|one, next| one == next).filter_map(|alike| {
            let unit = alike.first()?;
            Some(if alike.len() == 1 { format!("/{unit}") } else { format!("/{unit}^{}", alike.len()) })
        });
        above + &powers.collect::<String>()
    }
}

/// The axis of the link that the motion belongs to, or another that is named.
pub(super) const OWN_AXIS: Key = Key::new("axis", Holds::OwnAxis).or("the link's own");

/// An axis that is not the link's own.
pub(super) const OTHER_AXIS: Key = Key::new("axis", Holds::OtherAxis);

/// The sensor whose temperature the term reads.
pub(super) const SENSOR: Key = Key::new("sensor", Holds::Sensor);

/// The load that the term reads.
pub(super) const LOAD: Key = Key::new("load", Holds::Load);

/// The unit of bare positions.
pub(super) const PER: Key = Key::new("per", Holds::Unit(Base::Position));

/// The unit of bare values.
pub(super) const UNIT: Key = Key::new("unit", Holds::Unit(Base::Motion));

/// Factors that must be there.
pub(super) const FACTORS: Key = Key::new(TIMES, Holds::Factors);

/// Bare numbers.
pub(super) const NUMBERS: Key = Key::new("", Holds::Numbers);

/// A number with its unit; the term is not linear in it.
pub(super) const fn quantity(name: &'static str, kind: Kind) -> Key {
    Key { role: Role::Shape, ..Key::new(name, Holds::Quantity(kind)) }
}

/// Numbers with their units.
pub(super) const fn list(name: &'static str, kind: Kind) -> Key {
    Key::new(name, Holds::Quantities(kind))
}

/// `true` or `false`.
pub(super) const fn flag(name: &'static str) -> Key {
    Key::new(name, Holds::Flag)
}

impl Key {
    const fn new(name: &'static str, holds: Holds) -> Self {
        Self { name, holds, given: Given::Required, bound: Bound::None, role: Role::Place }
    }

    pub(super) const fn named(self, name: &'static str) -> Self {
        Self { name, ..self }
    }

    pub(super) const fn or(self, absent: &'static str) -> Self {
        Self { given: Given::Optional(absent), ..self }
    }

    pub(super) const fn one_of(self) -> Self {
        Self { given: Given::OneOf, ..self }
    }

    pub(super) const fn bound(self, bound: Bound) -> Self {
        Self { bound, ..self }
    }

    pub(super) const fn role(self, role: Role) -> Self {
        Self { role, ..self }
    }

    /// The kind of its quantities, where it holds such.
    pub fn kind(&self) -> Option<Kind> {
        match self.holds {
            Holds::Quantity(kind) | Holds::Quantities(kind) => Some(kind),
            _ => None,
        }
    }
}
