//! Parameters with their intervals. In: the parameters of a term or of a setting. Out: a line each.

use super::figure::{Kind, Scale, arcseconds, estimate, given};
use crate::diagnosis::{Estimate, Finding, OverTravel, Parameter, ParameterValue};

/// The parameters of a finding; first how far it goes over the travel, where none of them says that.
pub(super) fn of_finding(finding: &Finding) -> Vec<String> {
    let first = finding.over_travel.as_ref().map(over_travel);
    first.into_iter().chain(lines(&finding.parameters, finding.kind().first_power())).collect()
}

/// How far a finding goes over the travel.
pub(super) fn over_travel(over: &OverTravel) -> String {
    format!("{} over the travel of {}", estimate(&over.range, Kind::Error), over.axis)
}

/// One line for each number; the coefficients of a polynomial are numbered from the power `first`.
pub(super) fn lines(parameters: &[Parameter], first: usize) -> Vec<String> {
    parameters.iter().flat_map(|parameter| one(parameter, first)).collect()
}

fn one(parameter: &Parameter, first: usize) -> Vec<String> {
    let name = parameter.name.replace('_', " ");
    let kind = kind(parameter.name);
    match &parameter.value {
        ParameterValue::Name(word) => vec![format!("{name} {word}")],
        ParameterValue::Places(places, unit) => vec![format!("{name}: {}", stretch(places, unit))],
        ParameterValue::Given(value, unit) => vec![format!("{name} {} (given)", given(*value, unit, kind))],
        ParameterValue::Fitted(fitted) => vec![format!("{name} {}", fitted_number(fitted, kind))],
        ParameterValue::List(list) if parameter.name == "coefficients" => {
            let powers = list.iter().enumerate();
            powers.map(|(k, fitted)| format!("c_{} {}", first + k, fitted_number(fitted, kind))).collect()
        }
        ParameterValue::List(list) => vec![format!("{name}: {}", span(list, kind))],
    }
}

fn fitted_number(fitted: &Estimate, kind: Kind) -> String {
    let number = estimate(fitted, kind);
    match arcseconds(fitted).filter(|_| kind == Kind::Error) {
        Some(arcseconds) => format!("{number} = {arcseconds}"),
        None => number,
    }
}

/// Many numbers in a few words; the JSON has them all.
fn span(list: &[Estimate], kind: Kind) -> String {
    let values = || list.iter().map(|fitted| fitted.value).filter(|value| value.is_finite());
    let (low, high) = values()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    let Some(first) = list.first().filter(|_| low <= high) else { return "unknown".to_owned() };
    let widest = list.iter().map(|fitted| (fitted.ci95.1 - fitted.ci95.0).abs() / 2.0).fold(0.0, f64::max);
    let scale = Scale::of(&first.unit, kind, low.abs().max(high.abs()));
    format!("{} numbers, {}", list.len(), scale.between(low, high, widest))
}

/// Where the nodes of a table stand.
fn stretch(places: &[f64], unit: &str) -> String {
    let Some((first, last)) = places.first().zip(places.last()) else { return "none".to_owned() };
    let given = |place: f64| given(place, unit, Kind::Travel);
    format!("{} nodes, {} to {}", places.len(), given(*first), given(*last))
}

/// How a parameter's unit is read.
fn kind(name: &str) -> Kind {
    match name {
        "gain" | "factor" => Kind::Plain,
        "period" | "wind_up" | "phase" | "frequency" | "start" | "step" | "at" | "shift" => Kind::Travel,
        _ => Kind::Error,
    }
}
