//! One term as it is written. In: a term and the names of its machine. Out: its parameters, in mm, rad, s and degC.

use super::names::{MachineNames, MotionName};
use super::sensors::Sensors;
use super::spelling::{Item, number, quantity, word};
use super::term::{CalibratedTerm, Part};
use super::vocabulary::{Base, Form, Given, Holds, Key};

/// What stands for a motion or an axis that the machine lacks; no machine has one of this name.
pub(super) const UNKNOWN: &str = "?";

type Parameters = Vec<(&'static str, Item)>;

/// What the terms of one error motion are written against.
pub(super) struct Context<'a> {
    pub(super) names: &'a MachineNames,
    pub(super) sensors: &'a Sensors,
    pub(super) motion: Option<&'a MotionName>,
}

/// The parameters of a term, in the order in which the manual lists them.
pub(super) fn parameters(term: &CalibratedTerm, context: &Context<'_>) -> Parameters {
    let (entry, parts, axis) = (term.kind().entry(), term.parts(), term.axis());
    // A list has its axis beside it always: its units are that of the axis.
    let own = axis.is_some_and(|axis| entry.form == Form::Plain && context.is_own(axis));
    let written = entry.keys.iter().filter(|key| !(own && key.holds == Holds::OwnAxis)).filter_map(|key| {
        let (_, part) = parts.iter().find(|(name, _)| *name == key.name)?;
        Some((key.name, context.item(key, *part, axis)?))
    });
    written.collect()
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

    /// What stands behind a key; nothing for a number that says what its absence says.
    fn item(&self, key: &Key, part: Part<'_>, axis: Option<usize>) -> Option<Item> {
        let motion = self.motion_unit();
        let position = axis.map_or("mm", |axis| self.axis_unit(axis));
        match (part, key.holds) {
            (Part::Number(0.0), _) if matches!(key.given, Given::Optional(_)) => None,
            (Part::Number(value), _) => {
                let unit = key.kind().map(|kind| kind.unit(motion, position)).unwrap_or_default();
                Some(one(quantity(value, &unit)))
            }
            (Part::Numbers(values), _) => Some(numbers(values)),
            (Part::Unit, Holds::Unit(Base::Position)) => Some(one(position.to_owned())),
            (Part::Unit, _) => Some(one(motion.to_owned())),
            (Part::Axis(axis), _) => Some(self.axis(axis)),
            (Part::Sensor(sensor), _) => Some(self.sensor(sensor)),
            (Part::Load(load), _) => Some(one(word(load))),
        }
    }

    /// Whether an axis is that of the motion's own link.
    fn is_own(&self, axis: usize) -> bool {
        self.motion.and_then(|motion| motion.axis.as_deref()) == Some(self.letter(axis))
    }

    /// A sensor by its name. Any word would name one, so that what is not there is a list.
    fn sensor(&self, sensor: usize) -> Item {
        match self.sensors.iter().nth(sensor) {
            Some(known) => one(word(&known.name.value)),
            None => Item::List(Vec::new()),
        }
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
