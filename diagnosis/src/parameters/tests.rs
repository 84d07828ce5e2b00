//! Parameters against finite differences and random draws, their units, and the way back from the calibration's terms.

use std::f64::consts::PI;

use nalgebra::DMatrix;

use super::*;
use crate::model::{Effect, Place};
use crate::recording::{AngleUnit, Recording};
use crate::side::Side;
use crate::states::Driven;
use crate::states::States;
use crate::terms::{Memory, known};
use crate::testing::{Bench, normals, peak, programmed, uneven};
use crate::travel::Travel;

fn recording(axes: usize) -> Recording {
    let time = uneven(51, 90, 0.1);
    let wave =
        |axis: usize| time.iter().map(|t| 70.0 * (t * (0.7 + crate::number(axis))).sin() + 40.0).collect();
    let commands: Vec<Vec<f64>> = (0..axes).map(wave).collect();
    let mut recording = programmed(&time, &commands);
    let named = |name: &str, unit: &str, values: Vec<f64>| crate::recording::Named {
        name: name.to_owned(),
        unit: unit.to_owned(),
        values,
    };
    recording.temperatures = vec![named("spindle", "degC", time.iter().map(|t| 20.0 + t).collect())];
    recording.loads = vec![named("force", "N", time.iter().map(|t| 90.0 * t.sin()).collect())];
    recording
}

fn fitted(study: &Study<'_>, motion: &str, shape: Shape, coefficients: &[f64]) -> Fitted {
    let motion = study.equations.motions.iter().position(|known| known.name == motion).unwrap();
    let place = Place::Motion { motion, side: Side::After };
    Fitted { effect: Effect { place, shape }, coefficients: coefficients.to_vec() }
}

/// A covariance of full rank whose deviations are this share of the values.
fn covariance(values: &[f64], share: f64) -> DMatrix<f64> {
    let size = values.len();
    let numbers = normals(52, size * size);
    let mixed = DMatrix::from_fn(size, size, |row, column| {
        share
            * values[row].abs()
            * (numbers[row * size + column] * 0.4 + if row == column { 1.0 } else { 0.0 })
    });
    &mixed * mixed.transpose()
}

/// All numbers of the parameters that are fitted, in order.
fn estimates(parameters: &[Parameter]) -> Vec<Estimate> {
    let of = |parameter: &Parameter| match &parameter.value {
        ParameterValue::Fitted(estimate) => vec![estimate.clone()],
        ParameterValue::List(list) => list.clone(),
        _ => Vec::new(),
    };
    parameters.iter().flat_map(of).collect()
}

fn cases(study: &Study<'_>) -> Vec<Fitted> {
    let fitted =
        |motion: &str, shape: Shape, coefficients: &[f64]| fitted(study, motion, shape, coefficients);
    let (center, scale) = (40.0, 70.0);
    vec![
        fitted("EC0Y", Shape::Constant, &[4e-5]),
        fitted("EXX", Shape::Polynomial { axis: 0, degree: 3, center, scale }, &[0.01, -0.02, 0.004, 0.003]),
        fitted(
            "EZZ",
            Shape::SensorPolynomial { sensor: 0, degree: 2, center: 24.0, scale: 4.0 },
            &[0.01, -0.02, 0.004],
        ),
        fitted("EBX", Shape::Coupling { axis: 1, degree: 2, scale: 110.0 }, &[3e-5, -2e-5]),
        fitted(
            "EXX",
            Shape::Table { axis: 0, nodes: vec![-30.0, 40.0, 110.0], directed: true, repeats: false },
            &[1e-3, 2e-3, 0.0, 1e-3, -2e-3, 5e-3],
        ),
        fitted(
            "EXX",
            Shape::Table { axis: 0, nodes: vec![-30.0, 40.0, 110.0], directed: false, repeats: false },
            &[1e-3, 2e-3, -4e-3],
        ),
        fitted("EXX", Shape::Backlash { axis: 0, wind_up: 0.0 }, &[0.01]),
        fitted("EXX", Shape::Backlash { axis: 0, wind_up: 4.0 }, &[0.01]),
        fitted("EXX", Shape::ReversalSpike { axis: 0, decay: 0.2 }, &[0.01]),
        fitted("EXX", Shape::Cyclic { axis: 0, period: 9.0, order: 1, center: 0.0 }, &[0.003, -0.004]),
        fitted("EBX", Shape::Vibration { frequency: 2.2 }, &[-3e-5, 1e-5]),
        fitted("EXX", Shape::Lag { axis: 0, inertia: 0.0 }, &[0.03]),
        fitted("EXX", Shape::Acceleration { axis: 0 }, &[0.002]),
        fitted("EXX", Shape::Expansion { axis: 0, sensor: 0, reference: 20.0 }, &[1.1e-5]),
        fitted("EZZ", Shape::Growth { sensor: 0, reference: 20.0, time_constant: 0.0 }, &[0.002]),
        fitted("EZZ", Shape::Growth { sensor: 0, reference: 20.0, time_constant: 3.0 }, &[0.002]),
        fitted("EZZ", Shape::Drift { time_constant: 5.0 }, &[0.02]),
        fitted("EZZ", Shape::Compliance { load: 0 }, &[2e-5]),
    ]
}

/// Coefficients, then the nonlinear parameter where there is one.
fn numbers(fitted: &Fitted) -> Vec<f64> {
    let nonlinear = fitted.effect.shape.nonlinear().map(|parameter| parameter.value);
    fitted.coefficients.iter().copied().chain(nonlinear).collect()
}

fn with_numbers(fitted: &Fitted, numbers: &[f64]) -> Fitted {
    let (coefficients, rest) = numbers.split_at(fitted.coefficients.len());
    let shape =
        rest.first().map_or(fitted.effect.shape.clone(), |value| fitted.effect.shape.with_nonlinear(*value));
    Fitted { effect: Effect { place: fitted.effect.place, shape }, coefficients: coefficients.to_vec() }
}

#[test]
fn intervals_are_those_of_random_draws() {
    let bench = Bench::of("XYFZ");
    let recording = recording(3);
    let study = Study::new(bench.equations(), None, &[&recording]);
    for fitted in cases(&study) {
        let truth = numbers(&fitted);
        let covariance = covariance(&truth.iter().map(|v| v.abs().max(1e-4)).collect::<Vec<f64>>(), 0.01);
        let root = covariance.clone().cholesky().unwrap().l();
        let told =
            estimates(&Described::new(&study, &fitted, &Certainty::linear(covariance.clone())).parameters());
        assert!(!told.is_empty());
        let draws = 2000;
        let deviates = normals(53, draws * truth.len());
        let mut sums = vec![(0.0, 0.0); told.len()];
        for draw in deviates.chunks(truth.len()) {
            let moved = &root * DVector::from_column_slice(draw);
            let values: Vec<f64> = truth.iter().zip(&moved).map(|(value, by)| value + by).collect();
            let drawn = with_numbers(&fitted, &values);
            let drawn = estimates(
                &Described::new(&study, &drawn, &Certainty::linear(covariance.clone())).parameters(),
            );
            for ((sum, drawn), told) in sums.iter_mut().zip(drawn).zip(&told) {
                let off = drawn.value - told.value;
                *sum = (sum.0 + off, sum.1 + off * off);
            }
        }
        for ((sum, squares), told) in sums.iter().zip(&told) {
            let count = crate::number(draws);
            let deviation = (squares / count - (sum / count).powi(2)).max(0.0).sqrt();
            let half = (told.ci95.1 - told.ci95.0) / 2.0;
            // 2000 draws tell a deviation to 1.6 %.
            assert!(
                (half - 1.96 * deviation).abs() <= 0.08 * half,
                "{:?}: {told:?}, drawn {deviation}",
                fitted.effect.shape
            );
            assert!(told.ci95.0 <= told.value && told.value <= told.ci95.1);
        }
    }
}

#[test]
fn names_and_units_are_those_of_calibration_files() {
    let bench = Bench::of("XYFZ");
    let recording = recording(3);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let expected: [&[(&str, &str)]; 18] = [
        &[("value", "rad")],
        &[
            ("axis", "X"),
            ("coefficients", "mm"),
            ("coefficients", ""),
            ("coefficients", "1/mm"),
            ("coefficients", "1/mm^2"),
        ],
        &[
            ("sensor", "spindle"),
            ("coefficients", "mm"),
            ("coefficients", "mm/K"),
            ("coefficients", "mm/K^2"),
        ],
        &[("axis", "Y"), ("coefficients", "rad/mm"), ("coefficients", "rad/mm^2")],
        &[
            ("axis", "X"),
            ("at", "mm"),
            ("forward", "mm"),
            ("forward", "mm"),
            ("forward", "mm"),
            ("reverse", "mm"),
            ("reverse", "mm"),
            ("reverse", "mm"),
        ],
        &[("axis", "X"), ("at", "mm"), ("values", "mm"), ("values", "mm"), ("values", "mm")],
        &[("lost_motion", "mm")],
        &[("lost_motion", "mm"), ("wind_up", "mm")],
        &[("height", "mm"), ("decay", "s")],
        &[("period", "mm"), ("amplitude", "mm"), ("phase", "rad")],
        &[("frequency", "Hz"), ("amplitude", "rad"), ("phase", "rad")],
        &[("gain", "1/s")],
        &[("gain", "1/s^2")],
        &[("sensor", "spindle"), ("coefficient", "1/K"), ("reference", "degC")],
        &[("sensor", "spindle"), ("coefficient", "mm/K"), ("reference", "degC")],
        &[("sensor", "spindle"), ("coefficient", "mm/K"), ("reference", "degC"), ("time_constant", "s")],
        &[("amplitude", "mm"), ("time_constant", "s")],
        &[("load", "force"), ("coefficient", "mm/N")],
    ];
    for (fitted, expected) in cases(&study).iter().zip(expected) {
        let covariance = covariance(&numbers(fitted), 0.01);
        let parameters = Described::new(&study, fitted, &Certainty::linear(covariance.clone())).parameters();
        let words = |parameter: &Parameter| -> Vec<(&'static str, String)> {
            let words = match &parameter.value {
                ParameterValue::Name(name) => vec![name.clone()],
                ParameterValue::Given(_, unit) => vec![unit.clone()],
                ParameterValue::Places(_, unit) => vec![(*unit).to_owned()],
                ParameterValue::Fitted(estimate) => vec![estimate.unit.clone()],
                ParameterValue::List(list) => list.iter().map(|estimate| estimate.unit.clone()).collect(),
            };
            words.into_iter().map(|word| (parameter.name, word)).collect()
        };
        let found: Vec<(&str, String)> = parameters.iter().flat_map(words).collect();
        let found: Vec<(&str, &str)> = found.iter().map(|(name, word)| (*name, word.as_str())).collect();
        assert_eq!(found, expected, "{:?}", fitted.effect.shape);
    }
}

#[test]
fn waves_have_an_amplitude_and_a_phase_and_loops_a_gain() {
    let bench = Bench::of("XYFZ");
    let recording = recording(3);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let wave = fitted(
        &study,
        "EXX",
        Shape::Cyclic { axis: 0, period: 9.0, order: 1, center: 0.0 },
        &[-0.003, 0.004],
    );
    let told =
        estimates(&Described::new(&study, &wave, &Certainty::linear(DMatrix::zeros(3, 3))).parameters());
    // A sin(x + f) = A cos f sin x + A sin f cos x.
    let (amplitude, phase) = (told[1].value, told[2].value);
    assert!((amplitude - 0.005).abs() < 1e-15);
    assert!(
        (amplitude * phase.cos() + 0.003).abs() < 1e-15 && (amplitude * phase.sin() - 0.004).abs() < 1e-15
    );
    let lag = fitted(&study, "EXX", Shape::Lag { axis: 0, inertia: 0.0 }, &[0.02]);
    let told = estimates(
        &Described::new(&study, &lag, &Certainty::linear(DMatrix::from_element(1, 1, 1e-6))).parameters(),
    );
    assert!((told[0].value - 50.0).abs() < 1e-12);
    // The interval is that of the time constant turned over, 0.02 -+ 1.96 * 0.001.
    assert!((told[0].ci95.0 - 1.0 / 0.02196).abs() < 1e-3 && (told[0].ci95.1 - 1.0 / 0.01804).abs() < 1e-3);
}

#[test]
fn angles_of_a_rotary_axis_are_told_in_the_unit_of_the_recording() {
    let bench = Bench::of("FC");
    let mut recording = recording(1);
    recording.angle_unit = AngleUnit::Degree;
    let study = Study::new(bench.equations(), None, &[&recording]);
    let degree = PI / 180.0;
    let wave = fitted(
        &study,
        "ECC",
        Shape::Cyclic { axis: 0, period: 30.0 * degree, order: 1, center: 0.0 },
        &[1e-3 * degree, 0.0],
    );
    let told =
        estimates(&Described::new(&study, &wave, &Certainty::linear(DMatrix::zeros(3, 3))).parameters());
    assert!((told[0].value - 30.0).abs() < 1e-9 && told[0].unit == "deg");
    assert!((told[1].value - 1e-3).abs() < 1e-12 && told[1].unit == "deg");
    let scale = fitted(
        &study,
        "ECC",
        Shape::Polynomial { axis: 0, degree: 2, center: 0.0, scale: 1.0 },
        &[0.0, 1e-4, 2e-5],
    );
    let told =
        estimates(&Described::new(&study, &scale, &Certainty::linear(DMatrix::zeros(3, 3))).parameters());
    assert!((told[1].value - 1e-4).abs() < 1e-15 && told[1].unit.is_empty());
    // 2e-5 rad/rad^2 is 2e-5 * (180/pi) / (180/pi)^2 deg/deg^2.
    assert!((told[2].value - 2e-5 * degree).abs() < 1e-15 && told[2].unit == "1/deg", "{:?}", told[2]);
}

#[test]
fn what_is_written_into_the_calibration_is_what_was_fitted() {
    let bench = Bench::of("XYFZ");
    let recording = recording(3);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let scene = &study.scenes[0];
    let states = States::new(&recording, &scene.given, &[Driven::default(); 3], 0.0);
    let rows = states.rows(0..recording.time.len());
    let value = |shape: &Shape, coefficients: &[f64]| {
        let mut columns = vec![Vec::new(); shape.columns()];
        shape.fill(&rows, &mut Memory::default(), &mut columns);
        (0..rows.len())
            .map(|row| columns.iter().zip(coefficients).map(|(c, k)| c[row] * k).sum())
            .collect::<Vec<f64>>()
    };
    for fitted in cases(&study) {
        let covariance = covariance(&numbers(&fitted), 0.01);
        let term = Described::new(&study, &fitted, &Certainty::linear(covariance.clone())).calibrated();
        assert_eq!(term.name(), fitted.effect.shape.name());
        let (shape, coefficients) = known(&term, &|name: &str| (name == "force").then_some(0)).unwrap();
        let (before, after) =
            (value(&fitted.effect.shape, &fitted.coefficients), value(&shape, &coefficients));
        assert!(crate::testing::distance(&before, &after) < 1e-12 * peak(&before).max(1e-3), "{term:?}");
    }
}

#[test]
fn a_power_that_the_free_zero_holds_is_not_told() {
    let bench = Bench::of("XYFZ");
    let recording = recording(3);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let shape = Shape::Polynomial { axis: 0, degree: 1, center: 200.0, scale: 100.0 };
    let scale = fitted(&study, "EXX", shape, &[0.0, 0.01]);
    let covariance = DMatrix::from_diagonal(&DVector::from_vec(vec![0.0, 1e-8]));
    let told =
        estimates(&Described::new(&study, &scale, &Certainty::linear(covariance.clone())).parameters());
    assert_eq!((told[0].value, told[0].ci95), (0.0, (0.0, 0.0)));
    assert!((told[1].value - 1e-4).abs() < 1e-15);
    assert!((told[1].ci95.1 - told[1].ci95.0 - 2.0 * 1.96e-6).abs() < 1e-9);
}

/// 3 (q/10)^2 um over -20 to 20 mm goes from 0 to 12 um, wherever the powers are taken from. What its numbers have in common counts: the
/// square alone is as uncertain.
#[test]
fn a_polynomial_goes_as_far_as_its_highest_and_lowest_value_are_apart() {
    let bench = Bench::of("FX");
    let recording = recording(1);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let travels = [Travel { low: -20.0, high: 20.0, moves: true, ..Travel::default() }];
    let over = |center: f64, coefficients: &[f64], covariance: DMatrix<f64>| {
        let shape = Shape::Polynomial { axis: 0, degree: 2, center, scale: 10.0 };
        let fitted = fitted(&study, "EXX", shape, coefficients);
        let certainty = Certainty { covariance, nonlinear: None, richer: None };
        Described::new(&study, &fitted, &certainty).over_travel(&travels).unwrap()
    };
    let alone = DMatrix::from_fn(3, 3, |row, column| if row == 2 && column == 2 { 1e-8 } else { 0.0 });
    let over_zero = over(0.0, &[0.0, 0.0, 3e-3], alone);
    assert!((over_zero.range.value - 12e-3).abs() < 1e-15, "{:?}", over_zero.range);
    let half = (over_zero.range.ci95.1 - over_zero.range.ci95.0) / 2.0;
    assert!((half - WIDTH_95 * 4e-4).abs() < 1e-12, "{half}");
    assert_eq!(over_zero.axis, "X");
    // The same curve about 1 m away: 3 (x + 100)^2.
    let together = [1e4, 200.0, 1.0].map(|share| 1e-4 * share);
    let covariance = DMatrix::from_fn(3, 3, |row, column| together[row] * together[column]);
    let far = over(1000.0, &[30.0, 0.6, 3e-3], covariance);
    assert!((far.range.value - 12e-3).abs() < 1e-9, "{:?}", far.range);
    let half = (far.range.ci95.1 - far.range.ci95.0) / 2.0;
    assert!((half - WIDTH_95 * 4e-4).abs() < 1e-9, "{half}");
}
