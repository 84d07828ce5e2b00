//! One term as it is written. In: a term and the names of its machine. Out: its parameters, in mm, rad, s and degC.

use super::factor::vocabulary::{FactorHolds, FactorKey};
use super::factor::{Factor, FactorPart, Within, dimension_of};
use super::names::{MachineNames, MotionName};
use super::sensors::Sensors;
use super::spelling::{Item, braces, brackets, number, quantity, word};
use super::term::{CalibratedTerm, Part};
use super::vocabulary::{Base, Form, Given, Holds, Key, Kind, TIMES};
use crate::quantity::Dimension;

/// What stands for a motion or an axis that the machine lacks; no machine has one of this name.
pub(super) const UNKNOWN: &str = "?";

type Parameters = Vec<(&'static str, Item)>;

/// What the terms of one error motion are written against.
pub(super) struct Context<'a> {
    pub(super) names: &'a MachineNames,
    pub(super) sensors: &'a Sensors,
    pub(super) motion: Option<&'a MotionName>,
}

/// The parameters of a term, in the order in which the manual lists them, its factors last.
pub(super) fn parameters(term: &CalibratedTerm, context: &Context<'_>) -> Parameters {
    let (entry, parts, axis) = (term.kind().entry(), term.core().parts(), term.axis());
    let scale = dimension_of(term.factors(), context.names);
    // A list has its axis beside it always: its units are that of the axis.
    let own = axis.is_some_and(|axis| entry.form == Form::Plain && context.is_own(axis));
    let written = entry.keys.iter().filter(|key| !(own && key.holds == Holds::OwnAxis)).filter_map(|key| {
        let (_, part) = parts.iter().find(|(name, _)| *name == key.name)?;
        Some((key.name, context.item(key, *part, axis, scale)?))
    });
    let factors = term.factors().iter().map(|factor| context.factor(factor)).collect::<Vec<_>>();
    let times = (!factors.is_empty()).then_some((TIMES, Item::List(factors)));
    written.chain(times).collect()
}

impl Context<'_> {
    /// The unit of the error motion.
    pub(super) fn motion_unit(&self) -> &'static str {
        unit(self.motion.is_some_and(|motion| motion.angular))
    }

    fn axis_unit(&self, axis: usize) -> &'static str {
        unit(self.names.axes.get(axis).is_some_and(|axis| axis.rotary))
    }

    fn axis(&self, axis: usize) -> Item {
        one(word(self.letter(axis)))
    }

    fn letter(&self, axis: usize) -> &str {
        self.names.axes.get(axis).map_or(UNKNOWN, |axis| axis.letter.as_str())
    }

    /// What stands behind a key of a term whose factors are of this kind together; nothing for a number that says what its absence
    /// says.
    fn item(&self, key: &Key, part: Part<'_>, axis: Option<usize>, scale: Dimension) -> Option<Item> {
        let motion = self.motion_unit();
        let position = axis.map_or("mm", |axis| self.axis_unit(axis));
        match (part, key.holds) {
            (Part::Number(0.0), _) if matches!(key.given, Given::Optional(_)) => None,
            (Part::Number(value), _) => {
                let unit = key.kind().map(|kind| match scale == Dimension::NONE || !kind.is_of_motion() {
                    true => kind.unit(motion, position),
                    false => self.scaled(kind, axis, scale),
                });
                Some(one(quantity(value, &unit.unwrap_or_default())))
            }
            (Part::Numbers(values), _) => Some(numbers(values)),
            (Part::Unit, Holds::Unit(Base::Position)) => Some(one(position.to_owned())),
            (Part::Unit, _) if scale == Dimension::NONE => Some(one(motion.to_owned())),
            (Part::Unit, _) => Some(one(self.scaled(Kind::MOTION, axis, scale))),
            (Part::Axis(axis), _) => Some(self.axis(axis)),
            (Part::Sensor(sensor), _) => Some(self.sensor(sensor)),
            (Part::Load(load), _) => Some(one(word(load))),
            (Part::Factors(_), _) => None,
        }
    }

    /// The unit of a number that makes the error motion only with factors of this kind.
    fn scaled(&self, kind: Kind, axis: Option<usize>, scale: Dimension) -> String {
        let motion = self.motion.map_or(Dimension::LENGTH, MotionName::dimension).per(scale);
        let position = axis.map(|axis| self.names.axis_dimension(axis));
        match kind.dimension(motion, position) {
            Dimension::NONE => "mm/mm".to_owned(),
            known => known.internal_unit(),
        }
    }

    /// A factor: a mapping in braces.
    fn factor(&self, factor: &Factor) -> String {
        let position = factor.axis().map_or(Dimension::LENGTH, |axis| self.names.axis_dimension(axis));
        let parts = factor.parts();
        let written = factor.kind().entry().keys.iter().filter_map(|key| {
            let (_, part) = parts.iter().find(|(name, _)| *name == key.name)?;
            Some((key.name.to_owned(), self.factor_part(key, part, position)?))
        });
        braces(written)
    }

    /// What stands behind a key of a factor; nothing for what its absence says.
    fn factor_part(&self, key: &FactorKey, part: &FactorPart<'_>, position: Dimension) -> Option<String> {
        let unit = match key.holds {
            FactorHolds::Amount(measure, _) | FactorHolds::Range(measure) | FactorHolds::Nodes(measure) => {
                measure.unit(position)
            }
            _ => String::new(),
        };
        match *part {
            FactorPart::Axis(axis) => Some(word(self.letter(axis))),
            FactorPart::Sensor(sensor) => Some(self.sensor_word(sensor)),
            FactorPart::Load(load) => Some(word(load)),
            FactorPart::Power(1) => None,
            FactorPart::Power(power) => Some(power.to_string()),
            FactorPart::Amount(0.0) if key.or.is_some() => None,
            FactorPart::Amount(value) => Some(quantity(value, &unit)),
            FactorPart::Range(Within::EVERYWHERE) => None,
            FactorPart::Range(within) => {
                Some(brackets(&[quantity(within.from, &unit), quantity(within.to, &unit)]))
            }
            FactorPart::List(values) => {
                let spelled = |value: &f64| match unit.as_str() {
                    "" => number(*value),
                    unit => quantity(*value, unit),
                };
                Some(brackets(&values.iter().map(spelled).collect::<Vec<_>>()))
            }
        }
    }

    /// Whether an axis is that of the motion's own link.
    fn is_own(&self, axis: usize) -> bool {
        self.motion.and_then(|motion| motion.axis.as_deref()) == Some(self.letter(axis))
    }

    /// A sensor by its name.
    fn sensor(&self, sensor: usize) -> Item {
        one(self.sensor_word(sensor))
    }

    /// A sensor by its name. Any word would name one, so that what is not there is an empty list.
    fn sensor_word(&self, sensor: usize) -> String {
        let known = self.sensors.iter().nth(sensor);
        known.map_or_else(|| "[]".to_owned(), |known| word(&known.name.value))
    }
}

fn unit(angular: bool) -> &'static str {
    if angular { "rad" } else { "mm" }
}

fn one(text: String) -> Item {
    Item::One(text)
}

fn numbers(values: &[f64]) -> Item {
    Item::List(values.iter().map(|value| number(*value)).collect())
}
