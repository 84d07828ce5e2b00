//! The parameters of one term. In: its mapping. Out: quantities of the kinds that the term needs, or what is wrong.

use super::factor::{Factor, dimension_of};
use super::fields::{Fields, parameters, word};
use super::names::{MachineNames, MotionName};
use super::sensors::Sensors;
use super::vocabulary::{Base, Bound, Given, INSIDE_LOOP, Key};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::quantity::{self, Dimension};
use crate::source::{Span, Spanned};
use crate::suggest::nearest;
use crate::yaml::Node;

/// The kinds of loads that a deflection may be per.
const LOADS: [Dimension; 5] =
    [Dimension::FORCE, Dimension::VOLTAGE, Dimension::CURRENT, Dimension::PERCENT, Dimension::COUNT];

/// What the terms of one error motion are read against.
pub(super) struct Context<'a> {
    pub(super) names: &'a MachineNames,
    pub(super) motion: &'a MotionName,
    pub(super) sensors: &'a mut Sensors,
    pub(super) diagnostics: &'a mut Diagnostics,
}

/// The parameters of one term, with what is needed to read them.
pub(super) struct Parameters<'p, 'n, 'a> {
    pub(super) fields: Fields<'n>,
    /// The term in words: "`backlash` of EXX".
    pub(super) what: &'p str,
    /// What the term is multiplied with: none of most terms.
    pub(super) factors: &'p [Factor],
    pub(super) context: &'p mut Context<'a>,
}

impl<'n> Parameters<'_, 'n, '_> {
    /// The kind of quantity that the term itself is: with its factors that of the error motion.
    pub(super) fn motion(&self) -> Dimension {
        self.context.motion.dimension().per(self.scale())
    }

    /// The kind of quantity that its factors are together.
    fn scale(&self) -> Dimension {
        dimension_of(self.factors, self.context.names)
    }

    pub(super) fn report(&mut self, mistake: Diagnostic) {
        self.context.diagnostics.push(mistake);
    }

    /// A parameter that must be there.
    pub(super) fn need(&mut self, key: &str) -> Option<&'n Node> {
        self.fields.need(key, parameters(self.what), self.context.diagnostics)
    }

    /// A parameter in words: "`step` of `table` of EXX" in short.
    pub(super) fn words(&self, key: &str) -> String {
        format!("`{key}` of {}", self.context.motion.name)
    }

    /// A quantity that must be there.
    pub(super) fn quantity(&mut self, key: &str, kind: Dimension) -> Option<f64> {
        let node = self.need(key)?;
        self.quantity_in(node, key, kind).map(|found| found.value)
    }

    pub(super) fn quantity_in(&mut self, node: &Node, key: &str, kind: Dimension) -> Option<Spanned<f64>> {
        let words = self.words(key);
        quantity::read(node, kind, &words, self.context.diagnostics)
    }

    /// The number of a key, which the vocabulary says the kind and the bound of; 0 where it may be left out and is.
    pub(super) fn number(&mut self, key: &Key, axis: Option<usize>) -> Option<f64> {
        let kind = key.kind()?;
        let node = match (key.given, self.fields.get(key.name)) {
            (Given::Optional(_), None) => return Some(0.0),
            _ => self.need(key.name)?,
        };
        if kind.per.contains(&Base::Load) && self.factors.is_empty() {
            return self.per_load(node, key.name);
        }
        let position = axis.map(|axis| self.context.names.axis_dimension(axis));
        let dimension = kind.dimension(self.motion(), position);
        let found = if kind.is_of_motion() && !self.factors.is_empty() {
            self.scaled(node, key.name, dimension)?
        } else {
            self.quantity_in(node, key.name, dimension)?
        };
        let must = match key.bound {
            Bound::Positive if found.value <= 0.0 => "greater than zero",
            Bound::NotNegative if found.value < 0.0 => "zero or greater",
            Bound::PositiveBeside(other) if found.value <= 0.0 && self.fields.get(other).is_some() => {
                "greater than zero"
            }
            Bound::NotZero | Bound::PositiveBeside(_) if found.value == 0.0 => "other than zero",
            _ => return Some(found.value),
        };
        let message = format!("{} must be {must}", self.words(key.name));
        let help = format!("write a value that is {must}, or leave the term out");
        self.report(Diagnostic::error("E0419", found.span, message).help(help));
        None
    }

    /// A number of a term with factors, which make it a quantity of the error motion.
    fn scaled(&mut self, node: &Node, key: &str, expected: Dimension) -> Option<Spanned<f64>> {
        let quantity = node.text().and_then(|text| quantity::parse_quantity(text).ok());
        let found = quantity.as_ref().filter(|found| !found.is_bare());
        let differs = |found: &&quantity::Quantity| found.dimension.loads_as_forces() != expected;
        let Some(wrong) = found.filter(differs) else {
            let words = self.words(key);
            return quantity::read_per_load(node, expected, &words, self.context.diagnostics);
        };
        let (scale, unit) = (self.scale(), expected.usual_unit());
        let message = format!(
            "{} must be {} with these factors, but `{}` is {}",
            self.words(key),
            expected.name(),
            wrong.written_unit(),
            wrong.kind_name()
        );
        let help = format!(
            "use a unit such as `{unit}`: its factors together are in `{}` and {} is {}",
            scale.internal_unit(),
            self.context.motion.name,
            self.context.motion.dimension().name(),
        );
        self.report(Diagnostic::error("E0429", node.part(wrong.unit.clone()), message).help(help));
        None
    }

    /// A size for each unit of a load, whatever kind of load.
    fn per_load(&mut self, node: &Node, key: &str) -> Option<f64> {
        let quantity = node.text().and_then(|text| quantity::parse_quantity(text).ok());
        let motion = self.motion();
        if let Some(quantity) = quantity.filter(|quantity| !quantity.is_bare()) {
            if LOADS.iter().any(|load| motion.per(*load) == quantity.dimension) {
                return Some(quantity.value);
            }
            let message = format!(
                "{} must be {} per load, but `{}` is {}",
                self.words(key),
                motion.name(),
                quantity.written_unit(),
                quantity.kind_name()
            );
            let unit = if motion == Dimension::ANGLE { "urad" } else { "um" };
            let help = format!(
                "use a unit such as `{unit}/N`, `{unit}/V`, `{unit}/A`, `{unit}/%` or `{unit}/count`"
            );
            self.report(Diagnostic::error("E0424", node.part(quantity.unit.clone()), message).help(help));
            return None;
        }
        self.quantity_in(node, key, motion.per(Dimension::FORCE)).map(|found| found.value)
    }

    /// Whether the position loop of the motion's axis answers the term; left out, it does not.
    pub(super) fn inside_loop(&mut self) -> Option<bool> {
        let Some(node) = self.fields.get(INSIDE_LOOP) else { return Some(false) };
        let inside = match node.text() {
            Some("true") => true,
            Some("false") => false,
            _ => {
                let message = format!("{} is `true` or `false`", self.words(INSIDE_LOOP));
                let help = "write `inside_loop: true` if the axis's own position loop responds to the term";
                self.report(Diagnostic::error("E0427", node.span, message).help(help));
                return None;
            }
        };
        let own = self.context.names.own_axis(self.context.motion);
        if inside && own.is_none() {
            let motion = &self.context.motion.name;
            let message =
                format!("{motion} is not the motion of an axis along itself, so no position loop holds it");
            let help = "remove `inside_loop`; only motions such as EXX of X and ECC of C are inside a loop";
            self.report(Diagnostic::error("E0427", node.span, message).help(help));
            return None;
        }
        Some(inside)
    }

    /// The axis that is named, or the link's own where none is.
    pub(super) fn axis(&mut self) -> Option<usize> {
        if let Some(node) = self.fields.get("axis") {
            return self.named_axis(node);
        }
        let own = self.context.motion.axis.as_deref();
        let own = own.and_then(|letter| self.context.names.axis(letter));
        if own.is_none() {
            let message =
                format!("{} needs the parameter `axis`, because its link is not an axis", self.what);
            let help = format!("add `axis: ...`, one of {}", self.context.names.axis_letters());
            let name = self.fields.key_span("axis");
            self.report(Diagnostic::error("E0415", name, message).help(help));
        }
        own
    }

    pub(super) fn named_axis(&mut self, node: &Node) -> Option<usize> {
        let words = self.words("axis");
        find_axis(node, &words, self.context)
    }

    /// The kind of position of an axis; a length where the axis itself was wrong.
    pub(super) fn position(&self, axis: Option<usize>) -> Dimension {
        axis.map_or(Dimension::LENGTH, |axis| self.context.names.axis_dimension(axis))
    }

    /// The sensor that must be named.
    pub(super) fn sensor(&mut self) -> Option<usize> {
        let node = self.need("sensor")?;
        self.named_sensor(node)
    }

    pub(super) fn named_sensor(&mut self, node: &Node) -> Option<usize> {
        let name = word(node, &self.words("sensor"), self.context.diagnostics)?;
        Some(self.context.sensors.reference(&name))
    }

    /// The load that must be named.
    pub(super) fn load(&mut self) -> Option<String> {
        let node = self.need("load")?;
        word(node, &self.words("load"), self.context.diagnostics).map(|load| load.value)
    }

    /// Where a key stands, or the term's name where it is missing.
    pub(super) fn key_span(&self, key: &str) -> Span {
        self.fields.key_span(key)
    }
}

/// The axis that a value names; `words` say what the value is.
pub(super) fn find_axis(node: &Node, words: &str, context: &mut Context<'_>) -> Option<usize> {
    let letter = word(node, words, context.diagnostics)?;
    let names = context.names;
    let found = names.axis(&letter.value);
    if found.is_none() {
        let message = format!("{} has no axis `{}`", names.machine, letter.value);
        let mistake = Diagnostic::error("E0414", letter.span, message);
        let near = nearest(&letter.value, names.axes.iter().map(|axis| axis.letter.as_str()));
        context.diagnostics.push(match near {
            Some(near) => mistake.suggest(Some(near)),
            None => mistake.help(format!("its axes are {}", names.axis_letters())),
        });
    }
    found
}
