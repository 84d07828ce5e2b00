//! The laws of the table. In: its entries. Out: what holds for all of them.

use std::collections::BTreeSet;

use super::*;
use crate::calibration::{CalibratedTerm, Curve, CurveNodes, CurveValues, Factor, Part, SeriesInput};
use crate::quantity::{Dimension, parse_unit};

/// A term of each kind, whatever its numbers; those with several forms in each of them.
fn terms() -> Vec<CalibratedTerm> {
    let (axis, sensor) = (0, 0);
    let nodes = [CurveNodes::Uniform { start: 0.0, step: 1.0 }, CurveNodes::At(vec![0.0, 1.0])];
    let values = [
        CurveValues::Both(vec![1.0, 2.0]),
        CurveValues::Directed { forward: vec![1.0, 2.0], reverse: vec![3.0, 4.0] },
    ];
    let curves =
        nodes.iter().flat_map(|nodes| values.iter().map(|values| Curve::new(nodes.clone(), values.clone())));
    let curves = curves.flat_map(|curve| [Curve { repeats: true, ..curve.clone() }, curve]);
    let tables = curves.map(|curve| CalibratedTerm::Table { axis, curve });
    let inputs = [SeriesInput::Axis(axis), SeriesInput::Sensor(sensor)];
    let polynomials = inputs.map(|input| CalibratedTerm::Polynomial { input, coefficients: vec![1.0, 2.0] });
    let others = [
        CalibratedTerm::Constant { value: 1.0 },
        CalibratedTerm::Backlash { axis, lost_motion: 1.0, wind_up: 2.0 },
        CalibratedTerm::ReversalSpike { axis, height: 1.0, decay: 2.0 },
        CalibratedTerm::Cyclic { axis, period: 1.0, amplitude: 2.0, phase: 3.0 },
        CalibratedTerm::Lag { axis, gain: 1.0, frequency: 2.0 },
        CalibratedTerm::Acceleration { axis, gain: 1.0 },
        CalibratedTerm::Expansion { axis, sensor, coefficient: 1.0, reference: 2.0 },
        CalibratedTerm::Growth { sensor, coefficient: 1.0, reference: 2.0, time_constant: 3.0 },
        CalibratedTerm::Drift { amplitude: 1.0, time_constant: 2.0 },
        CalibratedTerm::Vibration { frequency: 1.0, amplitude: 2.0, phase: 3.0 },
        CalibratedTerm::Coupling { axis, coefficients: vec![1.0] },
        CalibratedTerm::Compliance { load: "f".to_owned(), coefficient: 1.0 },
        CalibratedTerm::Delay { axis, time: 1.0 },
        CalibratedTerm::Step { time: 1.0, size: 2.0 },
        CalibratedTerm::Constant { value: 1.0 }.times(vec![Factor::Direction { axis }]),
    ];
    others.into_iter().chain(polynomials).chain(tables).collect()
}

#[test]
fn terms_are_found_by_their_names() {
    for kind in TermKind::all() {
        assert_eq!(TermKind::of_name(kind.name()), Some(kind));
        assert_eq!(TERM_NAMES[kind as usize], kind.name());
    }
    assert_eq!(TermKind::of_name("play"), None);
    assert_eq!(TERM_NAMES.iter().collect::<BTreeSet<_>>().len(), TERM_NAMES.len());
}

/// All keys of the table, settings apart, are those of the terms, and what stands behind them is what the table says.
#[test]
fn the_parts_of_a_term_are_its_keys() {
    for kind in TermKind::all() {
        let of_kind: Vec<_> = terms().into_iter().filter(|term| term.kind() == kind).collect();
        let parts = of_kind.iter().flat_map(CalibratedTerm::parts);
        let mut seen = BTreeSet::new();
        for (name, part) in parts {
            let key = kind.entry().key(name).unwrap_or_else(|| panic!("{name} of {}", kind.name()));
            let fits = match part {
                Part::Number(_) => matches!(key.holds, Holds::Quantity(_)),
                Part::Numbers(_) => matches!(key.holds, Holds::Numbers | Holds::Quantities(_)),
                Part::Axis(_) => matches!(key.holds, Holds::OwnAxis | Holds::OtherAxis),
                Part::Sensor(_) => key.holds == Holds::Sensor,
                Part::Load(_) => key.holds == Holds::Load,
                Part::Unit => matches!(key.holds, Holds::Unit(_)),
                Part::Factors(_) => key.holds == Holds::Factors,
            };
            assert!(fits, "{name} of {}: {part:?}", kind.name());
            seen.insert(name);
        }
        let keys = kind.entry().keys.iter().filter(|key| key.role != Role::Setting);
        assert_eq!(seen, keys.map(|key| key.name).collect(), "{}", kind.name());
    }
}

/// What is linear by the table can be changed, and nothing else.
#[test]
fn linear_numbers_are_those_of_the_table() {
    for mut term in terms() {
        let parts: Vec<(&str, Vec<f64>)> = term
            .parts()
            .into_iter()
            .filter(|(name, _)| {
                let role = term.kind().entry().key(name).unwrap().role;
                matches!(role, Role::Value | Role::Linear)
            })
            .map(|(name, part)| match part {
                Part::Number(value) => (name, vec![value]),
                Part::Numbers(values) => (name, values.to_vec()),
                other => panic!("{name}: {other:?}"),
            })
            .collect();
        let changeable: Vec<(&str, Vec<f64>)> =
            term.linear_mut().into_iter().map(|(name, values)| (name, values.to_vec())).collect();
        assert_eq!(changeable, parts, "{}", term.name());
    }
}

#[test]
fn what_is_compensable_has_a_formula_in_the_runtime() {
    for term in terms() {
        assert_eq!(term.runtime().is_ok(), term.compensable(), "{}", term.name());
    }
}

/// The unit in which a number is written is of the dimension in which it is read, for each sort of motion and of axis.
#[test]
fn units_are_of_their_dimensions() {
    let sorts = [("mm", Dimension::LENGTH), ("rad", Dimension::ANGLE)];
    let keys = || TermKind::all().flat_map(|kind| kind.entry().keys).filter_map(Key::kind);
    for kind in keys() {
        for (motion, of_motion) in sorts {
            for (position, of_position) in sorts {
                let unit = kind.unit(motion, position);
                let dimension = kind.dimension(of_motion, Some(of_position));
                assert_eq!(parse_unit(&unit).unwrap().dimension, dimension, "{unit}");
                assert_eq!(parse_unit(&unit).unwrap().factor, 1.0, "{unit}");
            }
        }
    }
}
