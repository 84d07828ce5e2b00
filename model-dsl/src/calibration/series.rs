//! Polynomials: of an axis, of a sensor, of another axis.

use super::fields::filled_list;
use super::parameters::Parameters;
use super::term::{CalibratedTerm, SeriesInput};
use super::vocabulary::{Holds, TermKind};
use crate::diagnostic::Diagnostic;
use crate::quantity::{self, Dimension, Unit};
use crate::source::Spanned;
use crate::yaml::Node;

/// Reads a list of coefficients, the first of them of this power: of another axis where the term is of one.
pub(super) fn read_powers(
    kind: TermKind,
    first: u8,
    term: &mut Parameters<'_, '_, '_>,
) -> Option<CalibratedTerm> {
    let of_another = kind.entry().keys.iter().any(|key| key.holds == Holds::OtherAxis);
    if of_another { read_coupling(first, term) } else { read_polynomial(first, term) }
}

fn read_polynomial(first: u8, term: &mut Parameters<'_, '_, '_>) -> Option<CalibratedTerm> {
    let of_sensor = term.fields.get("sensor");
    if of_sensor.is_some() && term.fields.get("axis").is_some() {
        let message = format!("{} reads an axis or a sensor, not both", term.what);
        let mistake = Diagnostic::error("E0416", term.key_span("sensor"), message);
        let mistake = mistake.also(term.key_span("axis"), "the axis is here");
        term.report(mistake.help("leave one of the two out, or write two polynomials"));
        return None;
    }
    let (input, per) = match of_sensor {
        Some(node) => (term.named_sensor(node).map(SeriesInput::Sensor), sensor_scale(term)),
        None => {
            let axis = term.axis();
            (axis.map(SeriesInput::Axis), axis_scale(term, axis))
        }
    };
    let coefficients = read_coefficients(term, per, first);
    Some(CalibratedTerm::Polynomial { input: input?, coefficients: coefficients? })
}

fn read_coupling(first: u8, term: &mut Parameters<'_, '_, '_>) -> Option<CalibratedTerm> {
    let node = term.need("axis");
    let axis = node.and_then(|node| other_axis(term, node));
    let per = axis_scale(term, axis);
    let coefficients = read_coefficients(term, per, first);
    Some(CalibratedTerm::Coupling { axis: axis?, coefficients: coefficients? })
}

fn other_axis(term: &mut Parameters<'_, '_, '_>, node: &Node) -> Option<usize> {
    let axis = term.named_axis(node)?;
    let own = term.context.motion.axis.as_deref();
    if own.is_some_and(|own| term.context.names.axis(own) == Some(axis)) {
        let message = format!("{} must name another axis than that of its own link", term.what);
        let mistake = Diagnostic::error("E0420", node.span, message);
        term.report(mistake.help("use `polynomial` for the link's own axis"));
        return None;
    }
    Some(axis)
}

/// Internal units of the axis in one `per`, which must be given; 0 stands for one already reported.
fn axis_scale(term: &mut Parameters<'_, '_, '_>, axis: Option<usize>) -> Option<f64> {
    let node = term.need("per")?;
    let words = term.words("per");
    let per = quantity::read_unit(node, &words, term.context.diagnostics)?;
    let expected = term.position(axis);
    if axis.is_some() && per.value.dimension != expected {
        let subject = format!("the position that {} is of", term.what);
        wrong_unit(term, node, per, &subject, expected);
        return None;
    }
    Some(per.value.factor)
}

/// Degrees Celsius in one `per`: 1, since only degC and its step K have the zero that the coefficients assume.
fn sensor_scale(term: &mut Parameters<'_, '_, '_>) -> Option<f64> {
    let Some(node) = term.fields.get("per") else {
        return Some(1.0);
    };
    let words = term.words("per");
    let per = quantity::read_unit(node, &words, term.context.diagnostics)?;
    if per.value.dimension != Dimension::TEMPERATURE {
        let subject = format!("the temperature that {} is of", term.what);
        wrong_unit(term, node, per, &subject, Dimension::TEMPERATURE);
        return None;
    }
    if per.value.factor != 1.0 {
        let message = format!("{} cannot be in powers of degF", term.what);
        let help = "convert the coefficients to powers of degC, since degF and degC have different zeros";
        term.report(Diagnostic::error("E0421", node.span, message).help(help));
        return None;
    }
    Some(1.0)
}

/// Reads the parameter `unit`, which must be of the motion's kind: internal units in one of it.
pub(super) fn read_motion_unit(term: &mut Parameters<'_, '_, '_>) -> Option<f64> {
    let node = term.need("unit")?;
    let words = term.words("unit");
    let unit = quantity::read_unit(node, &words, term.context.diagnostics)?;
    let expected = term.motion();
    if unit.value.dimension.loads_as_forces() != expected {
        let subject = match term.factors {
            [] => term.context.motion.name.clone(),
            _ => format!("{} with its factors", term.what),
        };
        wrong_unit(term, node, unit, &subject, expected);
        return None;
    }
    Some(unit.value.factor)
}

/// Reports a unit of the wrong kind: "EXX is a length, `arcsec` is an angle".
pub(super) fn wrong_unit(
    term: &mut Parameters<'_, '_, '_>,
    node: &Node,
    unit: Spanned<Unit>,
    subject: &str,
    expected: Dimension,
) {
    let written = node.text().unwrap_or("").trim();
    let found = unit.value.dimension.name();
    let message = format!("{subject} must be {}, but `{written}` is {found}", expected.name());
    let mistake = Diagnostic::error("E0413", unit.span, message);
    term.report(mistake.help(format!("use a unit such as `{}`", expected.usual_unit())));
}

/// Reads `unit` and `coefficients` and converts them: c_k unit / per^k, k from `first`.
fn read_coefficients(term: &mut Parameters<'_, '_, '_>, per: Option<f64>, first: u8) -> Option<Vec<f64>> {
    let unit = read_motion_unit(term);
    let words = term.words("coefficients");
    let node = term.need("coefficients")?;
    let items = filled_list(node, &words, term.context.diagnostics)?;
    let entry = format!("an entry of {words}");
    let numbers: Vec<Option<Spanned<f64>>> =
        items.iter().map(|item| quantity::read_number(item, &entry, term.context.diagnostics)).collect();
    let (unit, per) = (unit?, per?);
    let powers = (i32::from(first)..).map(|power| per.powi(power));
    let converted: Vec<Option<f64>> =
        numbers.into_iter().zip(powers).map(|(number, power)| scaled(term, number?, unit / power)).collect();
    converted.into_iter().collect()
}

fn scaled(term: &mut Parameters<'_, '_, '_>, number: Spanned<f64>, factor: f64) -> Option<f64> {
    let value = if number.value == 0.0 { 0.0 } else { number.value * factor };
    if value.is_finite() {
        return Some(value);
    }
    let mistake =
        Diagnostic::error("E0302", number.span, "this coefficient is too large in mm, rad and degC");
    term.report(mistake.help("leave out powers this high"));
    None
}
