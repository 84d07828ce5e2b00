//! One term of an error motion, read from its item in the list.

use super::curve::read_table;
use super::fields::{Fields, parameters};
use super::parameters::{Context, Parameters};
use super::read_factor::read_factors;
use super::series::read_powers;
use super::term::{CalibratedTerm, PlainParts};
use super::vocabulary::{FREQUENCY, Form, Holds, INSIDE_LOOP, RAMP, Role, TERM_NAMES, TIMES, TermKind};
use crate::diagnostic::Diagnostic;
use crate::quantity;
use crate::source::Spanned;
use crate::suggest::nearest;
use crate::yaml::Node;

/// An item of a motion's list.
pub(super) struct Item {
    /// The term, at the place of its name.
    pub(super) term: Spanned<CalibratedTerm>,
    /// The time over which its correction follows a reversal, s; 0: at once.
    pub(super) ramp: f64,
    /// Whether the axis's position loop answers it.
    pub(super) inside_loop: bool,
}

/// Reads an item of a motion's list: a mapping of exactly one term's name to its parameters.
pub(super) fn read_item(item: &Node, context: &mut Context<'_>) -> Option<Item> {
    let motion = &context.motion.name;
    let (name, parameters) = match item.entries() {
        Some([(name, parameters)]) => (name, parameters),
        Some([]) | None => {
            let message = format!("an item of {motion} must be one term, found {}", item.kind_name());
            let help = "write `- backlash: {lost_motion: 10 um}`";
            context.diagnostics.push(Diagnostic::error("E0410", item.span, message).help(help));
            return None;
        }
        Some([_, (second, _), ..]) => {
            let message = format!("an item of {motion} holds two terms");
            let mistake = Diagnostic::error("E0410", second.span, message).label("a second term");
            let help = "begin each term with its own `-`, and put its parameters into its own `{...}`";
            context.diagnostics.push(mistake.help(help));
            return None;
        }
    };
    read_named(name, parameters, context)
}

fn read_named(name: &Spanned<String>, node: &Node, context: &mut Context<'_>) -> Option<Item> {
    let Some(kind) = TermKind::of_name(&name.value) else {
        context.diagnostics.push(unknown_term(name));
        return None;
    };
    let entry = kind.entry();
    let what = format!("`{}` of {}", entry.name, context.motion.name);
    let mut known = entry.key_names();
    known.extend(kind.takes_factors().then_some(TIMES));
    let fields = Fields::open(node, name.span, parameters(&what), &known, context.diagnostics)?;
    let factors = match fields.get(TIMES).filter(|_| kind.takes_factors()) {
        Some(times) => read_factors(times, &what, context)?,
        None => Vec::new(),
    };
    let mut term = Parameters { fields, what: &what, factors: &factors, context };
    refuse_loop_with_factors(kind, &mut term)?;
    refuse_loop_of_motor(kind, name, term.context)?;
    let ramp = entry.key(RAMP).map_or(Some(0.0), |key| term.number(key, None));
    let inside_loop = entry.key(INSIDE_LOOP).map_or(Some(false), |_| term.inside_loop());
    let read = match entry.form {
        Form::Plain => read_plain_term(kind, &mut term),
        Form::Powers { first } => read_powers(kind, first, &mut term),
        Form::Curve => read_table(&mut term),
    };
    let term = read?.times(factors);
    Some(Item { term: Spanned::new(term, name.span), ramp: ramp?, inside_loop: inside_loop? })
}

/// A position loop moves its axis. That of a motor moves several, whose loops are then not their own.
fn refuse_loop_of_motor(kind: TermKind, name: &Spanned<String>, context: &mut Context<'_>) -> Option<()> {
    let axis = context.names.own_axis(context.motion).and_then(|axis| context.names.axes.get(axis));
    let Some(motor) = axis.filter(|axis| axis.is_motor() && matches!(kind, TermKind::Lag | TermKind::Delay))
    else {
        return Some(());
    };
    let message = format!("`{}` of {} is not that of an axis", name.value, context.motion.name);
    let names = &context.names.axes;
    let axes: Vec<&str> = motor
        .follows
        .iter()
        .filter_map(|(axis, _)| names.get(*axis))
        .map(|axis| axis.letter.as_str())
        .collect();
    context.diagnostics.push(
        Diagnostic::error("E0431", name.span, message)
            .label("a motor moves several axes, and each axis has its own position loop here")
            .help(format!("give it to the axes that the motor moves: {}", axes.join(", "))),
    );
    None
}

/// A loop of second order answers its command as a whole: only the steady state of a lag has factors.
fn refuse_loop_with_factors(kind: TermKind, term: &mut Parameters<'_, '_, '_>) -> Option<()> {
    let rings = kind == TermKind::Lag && term.fields.get(FREQUENCY).is_some();
    if term.factors.is_empty() || !rings {
        return Some(());
    }
    let message = format!("{} has both a natural frequency and factors", term.what);
    let mistake = Diagnostic::error("E0416", term.key_span(TIMES), message);
    let mistake = mistake.also(term.key_span(FREQUENCY), "the frequency is here");
    term.report(mistake.help("leave one of the two out; factors multiply the steady state -v/K"));
    None
}

fn unknown_term(name: &Spanned<String>) -> Diagnostic {
    let mistake = Diagnostic::error("E0409", name.span, format!("unknown term `{}`", name.value));
    match nearest(&name.value, TERM_NAMES) {
        Some(near) => mistake.suggest(Some(near)),
        None => mistake.help(format!("the terms are {}", TERM_NAMES.join(", "))),
    }
}

/// Reads a term each of whose keys says one thing. All are read, so that each mistake is told.
fn read_plain_term(kind: TermKind, term: &mut Parameters<'_, '_, '_>) -> Option<CalibratedTerm> {
    let keys = || kind.entry().keys.iter().filter(|key| key.role != Role::Setting);
    // The kinds of the numbers follow from the axis.
    let axis = keys().find(|key| key.holds == Holds::OwnAxis).map(|_| term.axis());
    let mut parts = PlainParts { axis: axis.flatten(), ..PlainParts::default() };
    let mut complete = axis.is_none_or(|axis| axis.is_some());
    for key in keys() {
        complete &= match key.holds {
            Holds::Sensor => {
                parts.sensor = term.sensor();
                parts.sensor.is_some()
            }
            Holds::Load => {
                parts.load = term.load();
                parts.load.is_some()
            }
            Holds::Quantity(_) => {
                let number = term.number(key, parts.axis);
                parts.numbers.extend(number.map(|number| (key.name, number)));
                number.is_some()
            }
            Holds::Factors => term.need(key.name).is_some(),
            _ => true,
        };
    }
    complete.then(|| parts.term(kind)).flatten()
}

/// Reads a motion's value that stands alone, without a list: one constant term.
pub(super) fn read_plain(node: &Node, context: &mut Context<'_>) -> Option<Item> {
    let (kind, name) = (context.motion.dimension(), &context.motion.name);
    let value = quantity::read(node, kind, name, context.diagnostics)?;
    Some(Item { term: value.map(|value| CalibratedTerm::Constant { value }), ramp: 0.0, inside_loop: false })
}
