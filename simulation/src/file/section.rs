//! Sections: mappings of a path file, with its codes, and the values in them.

use model_dsl::calibration::MachineNames;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::fields::{self, Fields, Wording};
use model_dsl::machine::Machine;
use model_dsl::quantity::{self, Dimension};
use model_dsl::source::{Span, Spanned};
use model_dsl::suggest::nearest;
use model_dsl::yaml::{Node, NodeKind};

/// The code for a value of the wrong form.
pub(super) const FORM: &str = "E0704";

/// What the reading of every part needs.
pub(super) struct Context<'c> {
    pub(super) machine: &'c Machine,
    pub(super) names: &'c MachineNames,
    pub(super) diagnostics: &'c mut Diagnostics,
}

impl Context<'_> {
    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// The kind of position that an axis has.
    pub(super) fn dimension(&self, axis: usize) -> Dimension {
        if self.rotary(axis) { Dimension::ANGLE } else { Dimension::LENGTH }
    }

    pub(super) fn rotary(&self, axis: usize) -> bool {
        self.names.axes.get(axis).is_some_and(|axis| axis.rotary)
    }

    /// The axis that a letter names (E0705).
    pub(super) fn axis(&mut self, letter: &str, span: Span) -> Option<usize> {
        let programmed = || self.names.axes.iter().filter(|axis| !axis.is_motor());
        let found = self.names.axis(letter).filter(|_| programmed().any(|axis| axis.letter == letter));
        if found.is_none() {
            let known: Vec<&str> = programmed().map(|axis| axis.letter.as_str()).collect();
            let message = format!("{} has no axis `{letter}`", self.names.machine);
            let mistake = Diagnostic::error("E0705", span, message);
            let upper = letter.to_ascii_uppercase();
            self.report(match known.iter().find(|known| **known == upper) {
                Some(known) => mistake.suggest(Some(known)),
                None => mistake.help(format!("its axes are {}", known.join(", "))),
            });
        }
        found
    }

    /// A word among those that are possible (E0716).
    pub(super) fn choice(&mut self, node: &Node, what: &str, words: &[&'static str]) -> Option<&'static str> {
        let word = fields::word(node, what, FORM, self.diagnostics)?;
        let found = words.iter().find(|known| **known == word.value);
        if found.is_none() {
            let mistake = Diagnostic::error("E0716", word.span, format!("`{}` is not {what}", word.value));
            let help = format!("write one of {}", words.join(", "));
            self.report(match nearest(word.value, words.iter().copied()) {
                Some(near) => mistake.suggest(Some(near)),
                None => mistake.help(help),
            });
        }
        found.copied()
    }

    /// A whole number from a least value on (E0708).
    pub(super) fn whole(&mut self, node: &Node, what: &str, least: u32) -> Option<u32> {
        let number = quantity::read_number(node, what, self.diagnostics)?;
        let found = node.text().and_then(|text| text.trim().parse::<u32>().ok());
        let found = found.filter(|found| *found >= least);
        if found.is_none() {
            let (bound, help) = if number.value > f64::from(u32::MAX) {
                (format!("at most {}", u32::MAX), format!("write `{}` or less", u32::MAX))
            } else {
                (format!("at least {least}"), format!("write `{least}` or more"))
            };
            let message = format!("{what} must be a whole number, {bound}");
            self.report(Diagnostic::error("E0708", number.span, message).help(help));
        }
        found
    }

    /// A share: `0.5 %`, or a bare number from 0 to 1 (E0708).
    pub(super) fn share(&mut self, node: &Node, what: &str) -> Option<f64> {
        let percent = node.text().and_then(|text| quantity::parse_quantity(text).ok());
        let percent = percent.filter(|quantity| quantity.dimension == Dimension::PERCENT);
        let share = match percent {
            Some(percent) => percent.value / 100.0,
            None => quantity::read_number(node, what, self.diagnostics)?.value,
        };
        if (0.0..=1.0).contains(&share) {
            return Some(share);
        }
        let message = format!("{what} must be a share from 0 % to 100 %");
        self.report(Diagnostic::error("E0708", node.span, message).help("write a share such as `0.5 %`"));
        None
    }

    /// A quantity of one kind; a temperature is taken as a difference, so that `0.1 K` is a tenth of a degree.
    pub(super) fn size(&mut self, node: &Node, dimension: Dimension, what: &str) -> Option<f64> {
        let absolute = quantity::read(node, dimension, what, self.diagnostics)?.value;
        if dimension != Dimension::TEMPERATURE {
            return Some(absolute);
        }
        let written = quantity::parse_quantity(node.text()?).ok()?;
        let number = quantity::parse_number(written.written_number()).ok()?;
        let unit = quantity::parse_unit(written.written_unit()).ok()?;
        Some(number * unit.factor)
    }

    /// Reports a value that must be greater than zero, or not negative (E0708).
    pub(super) fn bounded(&mut self, value: f64, span: Span, what: &str, zero: bool) -> Option<f64> {
        if value > 0.0 || zero && value == 0.0 {
            return Some(value);
        }
        let bound = if zero { "must not be negative" } else { "must be greater than zero" };
        let mistake = Diagnostic::error("E0708", span, format!("{what} {bound}"));
        self.report(mistake.help("write a larger value, or leave the key out if it is optional"));
        None
    }
}

/// One mapping of the file.
#[derive(Clone, Copy)]
pub(super) struct Section<'n, 'w> {
    fields: Fields<'n>,
    what: &'w str,
}

impl<'n, 'w> Section<'n, 'w> {
    pub(super) fn open(
        node: &'n Node,
        name: Span,
        what: &'w str,
        known: &[&str],
        context: &mut Context<'_>,
    ) -> Option<Self> {
        let fields = Fields::open(node, name, wording(what), known, context.diagnostics)?;
        Some(Self { fields, what })
    }

    /// The value of a key, where there is the key and anything behind it.
    pub(super) fn get(&self, key: &str) -> Option<&'n Node> {
        self.fields.get(key).filter(|node| node.kind != NodeKind::Null)
    }

    pub(super) fn entry(&self, key: &str) -> Option<(&'n Spanned<String>, &'n Node)> {
        self.fields.entry(key)
    }

    pub(super) fn key_span(&self, key: &str) -> Span {
        self.fields.key_span(key)
    }

    pub(super) fn need(&self, key: &str, context: &mut Context<'_>) -> Option<&'n Node> {
        self.fields.need(key, wording(self.what), context.diagnostics)
    }

    /// How messages speak of a key.
    pub(super) fn words(&self, key: &str) -> String {
        format!("`{key}` of {}", self.what)
    }

    /// A quantity that must be there.
    pub(super) fn quantity(&self, key: &str, dimension: Dimension, context: &mut Context<'_>) -> Option<f64> {
        let node = self.need(key, context)?;
        context.size(node, dimension, &self.words(key))
    }

    /// A quantity that must be there and greater than zero.
    pub(super) fn positive(&self, key: &str, dimension: Dimension, context: &mut Context<'_>) -> Option<f64> {
        let value = self.quantity(key, dimension, context)?;
        context.bounded(value, self.value_span(key), &self.words(key), false)
    }

    /// A quantity that may be left out and is not negative.
    pub(super) fn not_negative(
        &self,
        key: &str,
        dimension: Dimension,
        default: f64,
        context: &mut Context<'_>,
    ) -> Option<f64> {
        let value = self.quantity_or(key, dimension, default, context)?;
        context.bounded(value, self.value_span(key), &self.words(key), true)
    }

    /// A quantity that may be left out.
    pub(super) fn quantity_or(
        &self,
        key: &str,
        dimension: Dimension,
        default: f64,
        context: &mut Context<'_>,
    ) -> Option<f64> {
        match self.get(key) {
            Some(node) => context.size(node, dimension, &self.words(key)),
            None => Some(default),
        }
    }

    /// A whole number that may be left out.
    pub(super) fn whole_or(
        &self,
        key: &str,
        least: u32,
        default: u32,
        context: &mut Context<'_>,
    ) -> Option<u32> {
        match self.get(key) {
            Some(node) => context.whole(node, &self.words(key), least),
            None => Some(default),
        }
    }

    /// A part that may be left out; an outer nothing stands for findings.
    pub(super) fn part<T>(
        &self,
        key: &str,
        read: impl FnOnce(&'n Node, Span) -> Option<T>,
    ) -> Option<Option<T>> {
        match self.get(key) {
            Some(node) => read(node, self.key_span(key)).map(Some),
            None => Some(None),
        }
    }

    fn value_span(&self, key: &str) -> Span {
        self.get(key).map_or_else(|| self.key_span(key), |node| node.span)
    }
}

fn wording(what: &str) -> Wording<'_> {
    Wording { what, noun: "key", unknown: "E0703", missing: "E0701", form: FORM }
}

/// The items of a value that must be a list.
pub(super) fn list<'n>(node: &'n Node, what: &str, context: &mut Context<'_>) -> Option<&'n [Node]> {
    fields::list(node, what, FORM, context.diagnostics)
}

/// The word that a value must be.
pub(super) fn word<'n>(node: &'n Node, what: &str, context: &mut Context<'_>) -> Option<Spanned<&'n str>> {
    fields::word(node, what, FORM, context.diagnostics)
}

/// The keys and values of a value that must be a mapping of names.
pub(super) fn named<'n>(
    node: &'n Node,
    what: &str,
    example: &str,
    context: &mut Context<'_>,
) -> Option<&'n [(Spanned<String>, Node)]> {
    let entries = node.entries();
    if entries.is_none() {
        let message = format!("{what} must be a mapping, found {}", node.kind_name());
        context.report(Diagnostic::error(FORM, node.span, message).help(format!("write `{example}`")));
    }
    entries
}
