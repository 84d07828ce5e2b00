//! One term of an error motion, read from its item in the list.

use super::curve::read_table;
use super::fields::{Fields, parameters, word};
use super::parameters::{Context, Parameters};
use super::series::{read_coupling, read_polynomial};
use super::term::{CalibratedTerm, TERM_NAMES};
use crate::diagnostic::Diagnostic;
use crate::quantity::{self, Dimension};
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
            let message = format!("an item of {motion} is one term, found {}", item.kind_name());
            let help = "write `- backlash: {lost_motion: 10 um}`";
            context.diagnostics.push(Diagnostic::error("E0410", item.span, message).help(help));
            return None;
        }
        Some([_, (second, _), ..]) => {
            let message = format!("an item of {motion} holds two terms");
            let mistake = Diagnostic::error("E0410", second.span, message).label("a second term");
            let help = "begin each term with a `-` of its own, and keep its parameters in its own `{...}`";
            context.diagnostics.push(mistake.help(help));
            return None;
        }
    };
    read_named(name, parameters, context)
}

fn read_named(name: &Spanned<String>, node: &Node, context: &mut Context<'_>) -> Option<Item> {
    let Some(known) = parameters_of(&name.value) else {
        context.diagnostics.push(unknown_term(name));
        return None;
    };
    let what = format!("`{}` of {}", name.value, context.motion.name);
    let wording = parameters(&what);
    let fields = Fields::open(node, name.span, wording, known, context.diagnostics)?;
    let mut term = Parameters { fields, what: &what, context };
    let ramp = if known.contains(&"ramp") { term.not_negative("ramp", Dimension::TIME) } else { Some(0.0) };
    let inside_loop = if known.contains(&"inside_loop") { term.inside_loop() } else { Some(false) };
    let read = match name.value.as_str() {
        "constant" => read_constant(&mut term),
        "polynomial" => read_polynomial(&mut term),
        "table" => read_table(&mut term),
        "backlash" => read_backlash(&mut term),
        "reversal-spike" => read_spike(&mut term),
        "cyclic" => read_cyclic(&mut term),
        "lag" => read_lag(&mut term),
        "acceleration" => read_acceleration(&mut term),
        "expansion" => read_expansion(&mut term),
        "growth" => read_growth(&mut term),
        "drift" => read_drift(&mut term),
        "vibration" => read_vibration(&mut term),
        "coupling" => read_coupling(&mut term),
        "compliance" => read_compliance(&mut term),
        _ => None,
    };
    Some(Item { term: Spanned::new(read?, name.span), ramp: ramp?, inside_loop: inside_loop? })
}

/// The parameters that a term may have, the one that is its own first; nothing for an unknown term.
fn parameters_of(term: &str) -> Option<&'static [&'static str]> {
    let known: &[&str] = match term {
        "constant" => &["value"],
        "polynomial" => &["axis", "sensor", "per", "unit", "coefficients"],
        "table" => &["axis", "start", "step", "at", "per", "unit", "values", "forward", "reverse"],
        "backlash" => &["lost_motion", "wind_up", "ramp", "inside_loop", "axis"],
        "reversal-spike" => &["height", "decay", "axis"],
        "cyclic" => &["period", "amplitude", "phase", "axis"],
        "lag" => &["gain", "frequency", "axis"],
        "acceleration" => &["gain", "axis"],
        "expansion" => &["sensor", "coefficient", "reference", "axis"],
        "growth" => &["sensor", "coefficient", "reference", "time_constant"],
        "drift" => &["amplitude", "time_constant"],
        "vibration" => &["frequency", "amplitude", "phase"],
        "coupling" => &["axis", "per", "unit", "coefficients"],
        "compliance" => &["load", "coefficient", "inside_loop"],
        _ => return None,
    };
    Some(known)
}

fn unknown_term(name: &Spanned<String>) -> Diagnostic {
    let mistake = Diagnostic::error("E0409", name.span, format!("unknown term `{}`", name.value));
    match nearest(&name.value, TERM_NAMES) {
        Some(near) => mistake.suggest(Some(near)),
        None => mistake.help(format!("the terms are {}", TERM_NAMES.join(", "))),
    }
}

type Read<'r, 'p, 'n, 'a> = &'r mut Parameters<'p, 'n, 'a>;

fn read_constant(term: Read<'_, '_, '_, '_>) -> Option<CalibratedTerm> {
    let value = term.quantity("value", term.motion())?;
    Some(CalibratedTerm::Constant { value })
}

/// Reads a motion's value that stands alone, without a list: one constant term.
pub(super) fn read_plain(node: &Node, context: &mut Context<'_>) -> Option<Item> {
    let (kind, name) = (context.motion.dimension(), &context.motion.name);
    let value = quantity::read(node, kind, name, context.diagnostics)?;
    Some(Item { term: value.map(|value| CalibratedTerm::Constant { value }), ramp: 0.0, inside_loop: false })
}

fn read_backlash(term: Read<'_, '_, '_, '_>) -> Option<CalibratedTerm> {
    let axis = term.axis();
    let lost_motion = term.quantity("lost_motion", term.motion());
    let wind_up = term.not_negative("wind_up", term.position(axis));
    Some(CalibratedTerm::Backlash { axis: axis?, lost_motion: lost_motion?, wind_up: wind_up? })
}

fn read_spike(term: Read<'_, '_, '_, '_>) -> Option<CalibratedTerm> {
    let axis = term.axis();
    let height = term.quantity("height", term.motion());
    let decay = term.positive("decay", Dimension::TIME);
    Some(CalibratedTerm::ReversalSpike { axis: axis?, height: height?, decay: decay? })
}

fn read_cyclic(term: Read<'_, '_, '_, '_>) -> Option<CalibratedTerm> {
    let axis = term.axis();
    let period = term.positive("period", term.position(axis));
    let amplitude = term.quantity("amplitude", term.motion());
    let phase = term.quantity("phase", Dimension::ANGLE);
    Some(CalibratedTerm::Cyclic { axis: axis?, period: period?, amplitude: amplitude?, phase: phase? })
}

/// The kind of K in `-v/K`: 1/s where the axis and the motion are of one kind.
fn gain_kind(term: Read<'_, '_, '_, '_>, axis: Option<usize>) -> Dimension {
    match axis {
        Some(_) => term.position(axis).per(term.motion()).per(Dimension::TIME),
        None => Dimension::FREQUENCY,
    }
}

fn read_lag(term: Read<'_, '_, '_, '_>) -> Option<CalibratedTerm> {
    let axis = term.axis();
    let kind = gain_kind(term, axis);
    // Below zero the drive leads: there is no loop of second order that does.
    let (gain, frequency) = match term.fields.get("frequency") {
        Some(_) => (term.positive("gain", kind), term.positive("frequency", Dimension::FREQUENCY)),
        None => (term.not_zero("gain", kind), Some(0.0)),
    };
    Some(CalibratedTerm::Lag { axis: axis?, gain: gain?, frequency: frequency? })
}

fn read_acceleration(term: Read<'_, '_, '_, '_>) -> Option<CalibratedTerm> {
    let axis = term.axis();
    let kind = gain_kind(term, axis).per(Dimension::TIME);
    let gain = term.positive("gain", kind);
    Some(CalibratedTerm::Acceleration { axis: axis?, gain: gain? })
}

fn read_expansion(term: Read<'_, '_, '_, '_>) -> Option<CalibratedTerm> {
    let axis = term.axis();
    let sensor = term.sensor();
    let kind = match axis {
        Some(_) => term.motion().per(term.position(axis)).per(Dimension::TEMPERATURE),
        None => Dimension::NONE.per(Dimension::TEMPERATURE),
    };
    let coefficient = term.quantity("coefficient", kind);
    let reference = term.quantity("reference", Dimension::TEMPERATURE);
    let (axis, sensor) = (axis?, sensor?);
    Some(CalibratedTerm::Expansion { axis, sensor, coefficient: coefficient?, reference: reference? })
}

fn read_growth(term: Read<'_, '_, '_, '_>) -> Option<CalibratedTerm> {
    let sensor = term.sensor();
    let coefficient = term.quantity("coefficient", term.motion().per(Dimension::TEMPERATURE));
    let reference = term.quantity("reference", Dimension::TEMPERATURE);
    let time_constant = match term.fields.get("time_constant") {
        Some(_) => term.positive("time_constant", Dimension::TIME),
        None => Some(0.0),
    };
    let (sensor, coefficient) = (sensor?, coefficient?);
    Some(CalibratedTerm::Growth { sensor, coefficient, reference: reference?, time_constant: time_constant? })
}

fn read_drift(term: Read<'_, '_, '_, '_>) -> Option<CalibratedTerm> {
    let amplitude = term.quantity("amplitude", term.motion());
    let time_constant = term.positive("time_constant", Dimension::TIME);
    Some(CalibratedTerm::Drift { amplitude: amplitude?, time_constant: time_constant? })
}

fn read_vibration(term: Read<'_, '_, '_, '_>) -> Option<CalibratedTerm> {
    let frequency = term.positive("frequency", Dimension::FREQUENCY);
    let amplitude = term.quantity("amplitude", term.motion());
    let phase = term.quantity("phase", Dimension::ANGLE);
    Some(CalibratedTerm::Vibration { frequency: frequency?, amplitude: amplitude?, phase: phase? })
}

/// The kinds of loads that a deflection may be per.
const LOADS: [Dimension; 5] =
    [Dimension::FORCE, Dimension::VOLTAGE, Dimension::CURRENT, Dimension::PERCENT, Dimension::COUNT];

fn read_compliance(term: Read<'_, '_, '_, '_>) -> Option<CalibratedTerm> {
    let load = term.need("load");
    let load = load.and_then(|node| word(node, &term.words("load"), term.context.diagnostics));
    let coefficient = term.need("coefficient").and_then(|node| read_per_load(term, node));
    Some(CalibratedTerm::Compliance { load: load?.value, coefficient: coefficient? })
}

fn read_per_load(term: Read<'_, '_, '_, '_>, node: &Node) -> Option<f64> {
    let quantity = node.text().and_then(|text| quantity::parse_quantity(text).ok());
    let motion = term.motion();
    if let Some(quantity) = quantity.filter(|quantity| !quantity.is_bare()) {
        if LOADS.iter().any(|load| motion.per(*load) == quantity.dimension) {
            return Some(quantity.value);
        }
        let message = format!(
            "{} is {} per load, `{}` is {}",
            term.words("coefficient"),
            motion.name(),
            quantity.written_unit(),
            quantity.kind_name()
        );
        let unit = if motion == Dimension::ANGLE { "urad" } else { "um" };
        let help =
            format!("use a unit such as `{unit}/N`, `{unit}/V`, `{unit}/A`, `{unit}/%` or `{unit}/count`");
        term.report(Diagnostic::error("E0424", node.part(quantity.unit.clone()), message).help(help));
        return None;
    }
    term.quantity_in(node, "coefficient", motion.per(Dimension::FORCE)).map(|found| found.value)
}
