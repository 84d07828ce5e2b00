//! The factors of one term, read from its `times`.

use super::factor::vocabulary::{FACTOR_NAMES, FactorHolds, FactorKey, FactorKind, Limit, Measure};
use super::factor::{Factor, FactorParts, Within};
use super::fields::{Fields, filled_list, parameters, word};
use super::parameters::{Context, find_axis};
use super::vocabulary::TIMES;
use crate::diagnostic::Diagnostic;
use crate::fields::list;
use crate::quantity::{self, Dimension};
use crate::source::{Span, Spanned};
use crate::suggest::nearest;
use crate::yaml::Node;

/// Reads a list of factors; `what` is the term in words. Nothing where one of them is wrong.
pub(super) fn read_factors(node: &Node, what: &str, context: &mut Context<'_>) -> Option<Vec<Factor>> {
    let items = filled_list(node, &format!("`{TIMES}` of {what}"), context.diagnostics)?;
    // All are read, so that each mistake is told.
    let read: Vec<Option<Factor>> = items.iter().map(|item| read_factor(item, what, context)).collect();
    read.into_iter().collect()
}

/// Reads a mapping in which exactly one key is the name of a factor.
fn read_factor(item: &Node, of: &str, context: &mut Context<'_>) -> Option<Factor> {
    let entries = item.entries().unwrap_or(&[]);
    let mut named = entries.iter().filter_map(|(key, _)| Some((key, FactorKind::of_name(&key.value)?)));
    let (name, kind) = match (named.next(), named.next()) {
        (Some(found), None) => found,
        (Some(_), Some((second, _))) => {
            let message = format!("an item of `{TIMES}` of {of} holds two factors");
            let mistake = Diagnostic::error("E0428", second.span, message).label("a second factor");
            context.diagnostics.push(mistake.help("give each factor its own `{...}`"));
            return None;
        }
        (None, _) => {
            context.diagnostics.push(no_factor(item, of));
            return None;
        }
    };
    let entry = kind.entry();
    let what = format!("the factor `{}` of {of}", entry.name);
    let fields = Fields::open(item, name.span, parameters(&what), &entry.key_names(), context.diagnostics)?;
    FactorReader { fields, what: &what, context }.read(kind)
}

fn no_factor(item: &Node, of: &str) -> Diagnostic {
    let first = item.entries().and_then(|entries| entries.first());
    let help = format!("the factors are {}", FACTOR_NAMES.join(", "));
    let Some((key, _)) = first else {
        let message = format!("an item of `{TIMES}` of {of} must be one factor, found {}", item.kind_name());
        return Diagnostic::error("E0428", item.span, message).help("write `{position: X}`");
    };
    let mistake = Diagnostic::error("E0428", key.span, format!("unknown factor `{}`", key.value));
    match nearest(&key.value, FACTOR_NAMES) {
        Some(near) => mistake.suggest(Some(near)),
        None => mistake.help(help),
    }
}

/// The keys of one factor, with what is needed to read them.
struct FactorReader<'p, 'n, 'a> {
    fields: Fields<'n>,
    /// The factor in words.
    what: &'p str,
    context: &'p mut Context<'a>,
}

impl<'n> FactorReader<'_, 'n, '_> {
    fn read(mut self, kind: FactorKind) -> Option<Factor> {
        let mut parts = FactorParts::default();
        let mut complete = true;
        for key in kind.entry().keys {
            let node = match (self.fields.get(key.name), key.or) {
                (Some(node), _) => Some(node),
                (None, Some(_)) => None,
                (None, None) => {
                    complete &= self.need(key).is_some();
                    continue;
                }
            };
            complete &= self.take(key, node, &mut parts).is_some();
        }
        self.check_curve(&parts)?;
        complete.then(|| parts.factor(kind)).flatten()
    }

    fn need(&mut self, key: &FactorKey) -> Option<&'n Node> {
        self.fields.need(key.name, parameters(self.what), self.context.diagnostics)
    }

    /// Takes what stands behind a key, or what its absence means.
    fn take(&mut self, key: &FactorKey, node: Option<&'n Node>, parts: &mut FactorParts) -> Option<()> {
        let words = format!("`{}` of {}", key.name, self.what);
        let Some(node) = node else {
            if let FactorHolds::Amount(..) = key.holds {
                parts.amounts.push((key.name, 0.0));
            }
            return Some(());
        };
        match key.holds {
            FactorHolds::Axis => {
                parts.axis = Some(find_axis(node, &words, self.context)?);
            }
            FactorHolds::Sensor => {
                let name = word(node, &words, self.context.diagnostics)?;
                parts.sensor = Some(self.context.sensors.reference(&name));
            }
            FactorHolds::Load => {
                parts.load = Some(word(node, &words, self.context.diagnostics)?.value);
            }
            FactorHolds::Power => parts.power = Some(self.power(node, &words)?),
            FactorHolds::Amount(measure, limit) => {
                let found = self.amount(node, measure, parts.axis, &words)?;
                self.check_limit(found, limit, &words)?;
                parts.amounts.push((key.name, found.value));
            }
            FactorHolds::Range(measure) => parts.within = self.range(node, measure, parts.axis, &words)?,
            FactorHolds::Nodes(measure) => {
                let at = self.nodes(node, measure, parts.axis, &words)?;
                parts.lists.push((key.name, at));
            }
            FactorHolds::Ratios => {
                let items = filled_list(node, &words, self.context.diagnostics)?;
                let entry = format!("an entry of {words}");
                let read: Vec<_> = items
                    .iter()
                    .map(|item| quantity::read_number(item, &entry, self.context.diagnostics))
                    .collect();
                let values: Option<Vec<f64>> = read.into_iter().map(|one| Some(one?.value)).collect();
                parts.lists.push((key.name, values?));
            }
        }
        Some(())
    }

    /// The kind of position of the factor's axis; a length where the axis itself was wrong.
    fn position(&self, axis: Option<usize>) -> Dimension {
        axis.map_or(Dimension::LENGTH, |axis| self.context.names.axis_dimension(axis))
    }

    fn amount(
        &mut self,
        node: &Node,
        measure: Measure,
        axis: Option<usize>,
        words: &str,
    ) -> Option<Spanned<f64>> {
        let dimension = measure.dimension(self.position(axis));
        match measure {
            Measure::Step => quantity::read_temperature_step(node, words, self.context.diagnostics),
            Measure::Load | Measure::Rate => {
                quantity::read_per_load(node, dimension, words, self.context.diagnostics)
            }
            _ => quantity::read(node, dimension, words, self.context.diagnostics),
        }
    }

    fn check_limit(&mut self, found: Spanned<f64>, limit: Limit, words: &str) -> Option<()> {
        let must = match limit {
            Limit::Positive if found.value <= 0.0 => "greater than zero",
            Limit::NotNegative if found.value < 0.0 => "zero or greater",
            _ => return Some(()),
        };
        let mistake = Diagnostic::error("E0419", found.span, format!("{words} must be {must}"));
        self.report(mistake.help(format!("write a value that is {must}")))
    }

    fn power(&mut self, node: &Node, words: &str) -> Option<u8> {
        let read = quantity::read_number(node, words, self.context.diagnostics)?;
        let powers = [(1.0, 1), (2.0, 2), (3.0, 3)];
        let found = powers.iter().find(|(number, _)| *number == read.value).map(|(_, power)| *power);
        if found.is_none() {
            let mistake = Diagnostic::error("E0419", read.span, format!("{words} must be 1, 2 or 3"));
            return self.report(mistake.help("write `power: 2`, or a `curve` for any other dependence"));
        }
        found
    }

    fn range(&mut self, node: &Node, measure: Measure, axis: Option<usize>, words: &str) -> Option<Within> {
        let items = list(node, words, "E0404", self.context.diagnostics)?;
        let [from, to] = items else {
            let message = format!("{words} must have two ends, found {}", items.len());
            let mistake = Diagnostic::error("E0417", node.span, message);
            return self.report(mistake.help("write the lower and the upper end: `[0 mm, 350 mm]`"));
        };
        let entry = format!("an end of {words}");
        let from = self.amount(from, measure, axis, &entry);
        let to = self.amount(to, measure, axis, &entry);
        let (from, to) = (from?, to?);
        if from.value > to.value {
            let mistake =
                Diagnostic::error("E0418", to.span, format!("the upper end of {words} is below the lower"));
            return self.report(mistake.also(from.span, "the lower end").help("write the lower end first"));
        }
        Some(Within { from: from.value, to: to.value })
    }

    fn nodes(&mut self, node: &Node, measure: Measure, axis: Option<usize>, words: &str) -> Option<Vec<f64>> {
        let items = filled_list(node, words, self.context.diagnostics)?;
        let entry = format!("an entry of {words}");
        let read: Vec<_> = items.iter().map(|item| self.amount(item, measure, axis, &entry)).collect();
        let at: Vec<Spanned<f64>> = read.into_iter().collect::<Option<_>>()?;
        let mut pairs = at.iter().zip(at.iter().skip(1));
        if let Some((before, next)) = pairs.find(|(before, next)| next.value <= before.value) {
            let message = format!("this entry of {words} is not above the one before it");
            let mistake =
                Diagnostic::error("E0418", next.span, message).also(before.span, "the one before it");
            return self.report(
                mistake.help(
                    "sort the nodes in rising order together with their values, and list each node once",
                ),
            );
        }
        Some(at.into_iter().map(|node| node.value).collect())
    }

    /// One value belongs to each node of a curve.
    fn check_curve(&mut self, parts: &FactorParts) -> Option<()> {
        if let [(_, at), (key, values)] = parts.lists.as_slice()
            && at.len() != values.len()
        {
            let span = self.key_span(key);
            let message = format!("{} has {} nodes and {} values", self.what, at.len(), values.len());
            return self
                .report(Diagnostic::error("E0417", span, message).help("one value belongs to each node"));
        }
        Some(())
    }

    fn key_span(&self, key: &str) -> Span {
        self.fields.key_span(key)
    }

    /// Reports a mistake, and has nothing to give.
    fn report<T>(&mut self, mistake: Diagnostic) -> Option<T> {
        self.context.diagnostics.push(mistake);
        None
    }
}
