//! What refutes a claim, and what does not.

use model_dsl::calibration::{CalibratedTerm, SeriesInput};

use super::*;
use crate::diagnosis::Evidence;

fn finding(with: f64, without: f64, parameters: Vec<Parameter>) -> Finding {
    Finding {
        motion: "EXX".to_owned(),
        motion_number: 0,
        motion_meaning: String::new(),
        term: "cyclic",
        parameters,
        over_travel: None,
        share: 0.5,
        location: crate::diagnosis::Location::default(),
        evidence: Evidence { with, without, unit: "mm", drive: None },
        alternatives: Vec::new(),
        explanation: String::new(),
        repeats_with: Vec::new(),
        compensable: true,
        calibrated: CalibratedTerm::Constant { value: 1.0 },
        form: None,
        sensors: Vec::new(),
    }
}

fn estimate(value: f64, half: f64, unit: &str) -> Estimate {
    Estimate { value, ci95: (value - half, value + half), unit: unit.to_owned() }
}

fn one(name: &'static str, value: f64, half: f64) -> Vec<Parameter> {
    vec![Parameter { name, value: ParameterValue::Fitted(estimate(value, half, "mm")) }]
}

#[test]
fn held_out_readings_must_lie_nearer() {
    assert!(!refuted(&finding(1.0, 2.0, one("amplitude", 1.0, 0.1))));
    for with in [2.0, 1.9999, 2.5, f64::NAN] {
        assert!(refuted(&finding(with, 2.0, one("amplitude", 1.0, 0.1))), "{with}");
    }
}

#[test]
fn a_size_must_be_told_from_nothing_whatever_its_sign() {
    for name in SIZES {
        assert!(!refuted(&finding(1.0, 2.0, one(name, -3.0, 2.9))), "{name}");
        assert!(refuted(&finding(1.0, 2.0, one(name, -3.0, 3.1))), "{name}");
    }
    assert!(!refuted(&finding(1.0, 2.0, one("time_constant", 3.0, 3.1))), "no size");
}

#[test]
fn a_phase_must_be_known_within_a_quarter_turn() {
    let phase = |half: f64, unit: &str| {
        vec![Parameter { name: "phase", value: ParameterValue::Fitted(estimate(0.0, half, unit)) }]
    };
    assert!(!refuted(&finding(1.0, 2.0, phase(0.78, "rad"))));
    assert!(refuted(&finding(1.0, 2.0, phase(0.79, "rad"))));
    assert!(!refuted(&finding(1.0, 2.0, phase(44.0, "deg"))));
    assert!(refuted(&finding(1.0, 2.0, phase(46.0, "deg"))));
}

#[test]
fn one_power_of_a_polynomial_that_stands_apart_is_enough() {
    let powers = |halves: [f64; 3]| {
        let list = halves.map(|half| estimate(1.0, half, "mm")).to_vec();
        let parameters = vec![Parameter { name: "coefficients", value: ParameterValue::List(list) }];
        let calibrated =
            CalibratedTerm::Polynomial { input: SeriesInput::Axis(0), coefficients: vec![1.0; 3] };
        Finding { calibrated, ..finding(1.0, 2.0, parameters) }
    };
    assert!(!refuted(&powers([2.0, 0.5, 2.0])));
    // The recordings say nothing of the power 0 where a zero of the channel is free.
    assert!(!refuted(&powers([0.0, 0.5, 2.0])));
    assert!(refuted(&powers([0.5, 2.0, 2.0])), "the power 0 is the zero of a channel");
    assert!(refuted(&powers([0.0, 2.0, 2.0])));
}

#[test]
fn a_coupling_begins_with_a_power_that_counts() {
    let list = [0.5, 2.0].map(|half| estimate(1.0, half, "mm")).to_vec();
    let parameters = vec![Parameter { name: "coefficients", value: ParameterValue::List(list) }];
    let calibrated = CalibratedTerm::Coupling { axis: 1, coefficients: vec![1.0; 2] };
    assert!(!refuted(&Finding { calibrated, ..finding(1.0, 2.0, parameters) }));
}

#[test]
fn of_several_that_of_the_least_share_goes_first() {
    let good = || finding(1.0, 2.0, one("height", 1.0, 0.1));
    let bad = || finding(2.0, 2.0, one("height", 1.0, 0.1));
    assert_eq!(weakest(&[bad(), good(), bad(), good()]), Some(2));
    assert_eq!(weakest(&[good(), good()]), None);
}
