//! Files and terms without mistakes, and what they become in internal units.

use super::*;
use std::f64::consts::PI;

const ARCSEC: f64 = PI / 648_000.0;

#[test]
fn the_whole_file_is_read() {
    let text = "\
calibration: 1
machine: test-mill
source: measured with a laser, µm
constants: {Xt: 1 in, Zt: 100 mm}
limits: {compensation: 0.2 mm, rotation: 1 mrad, rate: 120 mm/min, rotation_rate: 60 mrad/min, hold: 0 s, fade: 500 ms}
sensors: {start: {initial: body}, body: {mean: [T10, T21]}}
errors:
  EXX:
    - table: {axis: X, start: 0 mm, step: 55 mm, unit: um, values: [-0.5, 5, 11.5]}
    - backlash: {lost_motion: 10 um}
    - growth: {sensor: start, coefficient: 3 um/K, reference: 20 degC}
  EBX: [{polynomial: {axis: X, per: mm, unit: arcsec, coefficients: [-0.349, 5.29e-2]}}]
  C0Y: 272 urad
";
    let (calibration, findings) = read_file(text);
    assert_eq!(findings, []);
    let calibration = calibration.expect("a calibration");
    assert_eq!(calibration.machine.value, "test-mill");
    assert_eq!(calibration.source.as_deref(), Some("measured with a laser, µm"));
    assert_eq!(calibration.constants, [25.4, 100.0]);
    assert_eq!(
        calibration.limits.of_compensator(),
        abbe_runtime::Limits { compensation: Some(0.2), rotation: Some(1e-3) }
    );
    let transition =
        abbe_runtime::Transition { rate: Some(2.0), rotation_rate: Some(1e-3), hold: 0.0, fade: 0.5 };
    assert_eq!(calibration.limits.transition(), transition);
    let listed: Vec<_> =
        calibration.motions.iter().map(|listed| (listed.motion, listed.terms.len())).collect();
    assert_eq!(listed, [(0, 3), (1, 1), (3, 1)]);
    assert_eq!(calibration.terms(3)[0].value, CalibratedTerm::Constant { value: 272.0 * 1e-6 });
    assert_eq!(calibration.terms(2), []);
    let source = SourceFile::new("a", text);
    assert_eq!(source.slice(calibration.terms(0)[1].span), "backlash");
    assert_eq!(source.slice(calibration.terms(3)[0].span), "272 urad");
    let names: Vec<_> = calibration.sensors.iter().map(|sensor| sensor.name.value.as_str()).collect();
    assert_eq!(names, ["T10", "T21", "body", "start"]);
    let inputs: Vec<_> = calibration.sensors.inputs().map(|(index, _)| index).collect();
    assert_eq!(inputs, [0, 1]);
}

#[test]
fn little_is_required() {
    for errors in ["", "errors:\n", "errors: {}\n"] {
        let text = format!("calibration: 1\nmachine: m\nconstants: {{Xt: 0 mm}}\n{errors}");
        let (calibration, findings) = read_file(&text);
        assert_eq!(findings, []);
        assert_eq!(calibration.expect("a calibration").constants, [0.0, 120.0]);
    }
}

#[test]
fn the_machine_can_be_read_first() {
    let source = SourceFile::new("a", "machine: mill\nnonsense: 1\n");
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(&source, &mut diagnostics).expect("a tree");
    let machine = machine_of(&root, &mut diagnostics).expect("a machine");
    assert!(diagnostics.is_empty());
    assert_eq!((machine.value.as_str(), source.slice(machine.span)), ("mill", "mill"));
}

#[test]
fn constants_and_plain_quantities_are_the_same() {
    let value = CalibratedTerm::Constant { value: 0.01 };
    assert_eq!(term("EXX: 10 um"), value);
    assert_eq!(term("EXX: [{constant: {value: 10 um}}]"), value);
    for name in ["EC0Y", "C0Y", "COY", "ECOY"] {
        assert_eq!(term(&format!("{name}: 1 mrad")), CalibratedTerm::Constant { value: 1e-3 });
    }
}

#[test]
fn polynomials_are_converted_by_their_powers() {
    let coefficients = |errors: &str| match term(errors) {
        CalibratedTerm::Polynomial { input, coefficients } => (input, coefficients),
        other => panic!("{other:?}"),
    };
    let close = |found: Vec<f64>, expected: &[f64]| {
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() <= expected.abs() * 1e-14, "{found} {expected}");
        }
    };
    let (input, found) =
        coefficients("EBX: [{polynomial: {per: m, unit: arcsec, coefficients: [1, 2, 3e0]}}]");
    assert_eq!(input, SeriesInput::Axis(0));
    close(found, &[ARCSEC, 2e-3 * ARCSEC, 3e-6 * ARCSEC]);
    let (input, found) =
        coefficients("EXY: [{polynomial: {axis: C, per: deg, unit: um, coefficients: [0, 1]}}]");
    assert_eq!(input, SeriesInput::Axis(2));
    close(found, &[0.0, 1e-3 * 180.0 / PI]);
    for per in ["", "per: degC, ", "per: K, "] {
        let errors = format!("EZS: [{{polynomial: {{sensor: T39, {per}unit: um, coefficients: [1, 2]}}}}]");
        let (input, found) = coefficients(&errors);
        assert_eq!(input, SeriesInput::Sensor(0));
        close(found, &[1e-3, 2e-3]);
    }
    let many = format!("EXX: [{{polynomial: {{per: m, unit: um, coefficients: [{}0]}}}}]", "0, ".repeat(300));
    close(coefficients(&many).1, &[0.0; 301]);
}

#[test]
fn couplings_begin_at_the_first_power() {
    let found = term("EXX: [{coupling: {axis: Y, per: m, unit: um, coefficients: [1000]}}]");
    assert_eq!(found, CalibratedTerm::Coupling { axis: 1, coefficients: vec![1e-3] });
}

#[test]
fn tables_keep_their_nodes_ascending() {
    let curve = |errors: &str| match term(errors) {
        CalibratedTerm::Table { axis, curve } => (axis, curve),
        other => panic!("{other:?}"),
    };
    let (axis, uniform) = curve("EXX: [{table: {start: 0 mm, step: -1 in, unit: mm, values: [1, 2]}}]");
    assert_eq!((axis, &uniform.nodes), (0, &CurveNodes::Uniform { start: 0.0, step: -25.4 }));
    let at = CurveNodes::At(vec![0.0, 10.0, 25.4]);
    let (axis, up) = curve("EXX: [{table: {axis: Y, at: [0 mm, 10 mm, 1 in], unit: mm, values: [1, 2, 3]}}]");
    assert_eq!((axis, &up.nodes, &up.values), (1, &at, &CurveValues::Both(vec![1.0, 2.0, 3.0])));
    let (_, down) = curve(
        "EXX: [{table: {at: [25.4, 10, 0], per: mm, unit: mm, forward: [1, 2, 3], reverse: [4, 5, 6]}}]",
    );
    let (forward, reverse) = (vec![3.0, 2.0, 1.0], vec![6.0, 5.0, 4.0]);
    assert_eq!((&down.nodes, &down.values), (&at, &CurveValues::Directed { forward, reverse }));
    let (axis, rotary) = curve("ECC: [{table: {at: [0, 180], per: deg, unit: arcsec, values: [0, 1]}}]");
    assert_eq!((axis, &rotary.nodes), (2, &CurveNodes::At(vec![0.0, PI])));
    for curve in [uniform, up, down, rotary] {
        curve.runtime().expect("a table of the runtime");
    }
}

#[test]
fn every_other_term_is_read() {
    let cases = [
        (
            "EXX: [{backlash: {lost_motion: -64 uin, wind_up: 1 mm}}]",
            CalibratedTerm::Backlash { axis: 0, lost_motion: -64.0 * 25.4e-6, wind_up: 1.0 },
        ),
        (
            "EXX: [{reversal-spike: {height: 5 um, decay: 20 ms}}]",
            CalibratedTerm::ReversalSpike { axis: 0, height: 0.005, decay: 0.02 },
        ),
        (
            "EXX: [{cyclic: {period: 5 mm, amplitude: 1 um, phase: 1 rad}}]",
            CalibratedTerm::Cyclic { axis: 0, period: 5.0, amplitude: 1e-3, phase: 1.0 },
        ),
        ("EXX: [{lag: {gain: 16.28 1/s}}]", CalibratedTerm::Lag { axis: 0, gain: 16.28, frequency: 0.0 }),
        ("EXX: [{lag: {gain: -80 1/s}}]", CalibratedTerm::Lag { axis: 0, gain: -80.0, frequency: 0.0 }),
        ("EXX: [{acceleration: {gain: 400 1/s^2}}]", CalibratedTerm::Acceleration { axis: 0, gain: 400.0 }),
        ("EXX: [{acceleration: {gain: -400 1/s^2}}]", CalibratedTerm::Acceleration { axis: 0, gain: -400.0 }),
        (
            "EXX: [{drift: {amplitude: 2 um, time_constant: 10 min}}]",
            CalibratedTerm::Drift { amplitude: 0.002, time_constant: 600.0 },
        ),
        (
            "EXX: [{vibration: {frequency: 60 Hz, amplitude: 1 um, phase: 0 deg}}]",
            CalibratedTerm::Vibration { frequency: 60.0, amplitude: 1e-3, phase: 0.0 },
        ),
        (
            "EXX: [{growth: {sensor: spindle, coefficient: 3 um/K, reference: 68 degF, time_constant: 1 min}}]",
            CalibratedTerm::Growth { sensor: 0, coefficient: 0.003, reference: 20.0, time_constant: 60.0 },
        ),
        (
            "EXX: [{expansion: {sensor: scale, coefficient: 10 um/m/K, reference: 20 degC}}]",
            CalibratedTerm::Expansion {
                axis: 0,
                sensor: 0,
                coefficient: 10.0 * (1e-3 / 1000.0),
                reference: 20.0,
            },
        ),
        (
            "EZS: [{compliance: {load: spindle, coefficient: 2 um/N}}]",
            CalibratedTerm::Compliance { load: "spindle".to_owned(), coefficient: 0.002 },
        ),
        (
            "EZS: [{compliance: {load: drive, coefficient: 2 um/%}}]",
            CalibratedTerm::Compliance { load: "drive".to_owned(), coefficient: 0.002 },
        ),
        (
            "EZS: [{lag: {axis: Y, gain: 10 1/s}}]",
            CalibratedTerm::Lag { axis: 1, gain: 10.0, frequency: 0.0 },
        ),
    ];
    for (errors, expected) in cases {
        let found = term(errors);
        let written = errors.split(['{', ':']).nth(2).map(str::trim);
        assert_eq!(Some(found.name()), written);
        assert_eq!(format!("{found:?}"), format!("{expected:?}"), "{errors}");
        assert_eq!(found.runtime().is_ok(), found.compensable(), "{errors}");
    }
}

/// The ramp is the correction's: it reaches the runtime, and the term beside it is the same without it.
#[test]
fn a_ramp_stands_beside_its_term() {
    let text = with_error_motions("EXX: [{constant: {value: 1 um}}, {backlash: {lost_motion: 3 um}}]");
    let ramped = text.replace("lost_motion: 3 um", "lost_motion: 3 um, ramp: 50 ms");
    let (plain, ..) = read_with_diagnostics(&text);
    let (ramped, ..) = read_with_diagnostics(&ramped);
    let (plain, ramped) = (plain.unwrap(), ramped.unwrap());
    assert_eq!(plain.terms(0), ramped.terms(0));
    assert_ne!(plain, ramped);
    let ramps = |calibration: &Calibration| -> Vec<f64> {
        let terms = calibration.runtime(0).map(|term| match term.unwrap()[0] {
            Term::Backlash { ramp, .. } => ramp,
            _ => -1.0,
        });
        terms.collect()
    };
    assert_eq!((ramps(&plain), ramps(&ramped)), (vec![-1.0, 0.0], vec![-1.0, 0.05]));
    assert_eq!(ramped.with(&[(0, CalibratedTerm::Constant { value: 1.0 })]).motions[0].ramp(1), 0.05);
}

#[test]
fn angles_have_their_own_coefficients() {
    term("EBX: [{growth: {sensor: a, coefficient: 3 urad/K, reference: 20 degC}}]");
    term("EBX: [{expansion: {sensor: a, coefficient: 3 urad/m/K, reference: 20 degC}}]");
    term("EBX: [{backlash: {lost_motion: 3 urad, wind_up: 1 mm}}]");
    term("ECC: [{lag: {gain: 30 1/s}}]");
    term("ECC: [{cyclic: {period: 1 deg, amplitude: 3 arcsec, phase: 0 rad}}]");
    term("EBX: [{compliance: {load: f, coefficient: 3 urad/V}}]");
}

#[test]
fn terms_that_cannot_be_compensated_are_named() {
    let text = with_error_motions(
        "EXX: [{drift: {amplitude: 2 um, time_constant: 10 min}}, {backlash: {lost_motion: 1 um}}]",
    );
    let (calibration, _, source) = read_with_diagnostics(&text);
    let mut diagnostics = Diagnostics::new();
    calibration.expect("a calibration").refuse_uncompensable(&names(), &mut diagnostics);
    let found: Vec<_> =
        diagnostics.iter().map(|one| (one.code, source.slice(one.span), one.message.as_str())).collect();
    assert_eq!(found, [("E0425", "drift", "`drift` of EXX cannot be compensated in real time")]);
}

#[test]
fn derived_sensors_follow_their_sources() {
    let text = "\
calibration: 1
machine: m
constants: {Xt: 0 mm}
sensors: {rise: {mean: [start, body]}, start: {initial: body}, body: {mean: [T1, T2]}}
errors: {EZS: [{growth: {sensor: rise, coefficient: 1 um/K, reference: 20 degC}}]}
";
    let (calibration, findings) = read_file(text);
    assert_eq!(findings, []);
    let sensors = calibration.expect("a calibration").sensors;
    let index = |name: &str| sensors.index(name).expect("a sensor");
    let mut readings = SensorReadings::new(&sensors);
    let mut update = |first: f64, second: f64| {
        let inputs = [(index("T1"), first), (index("T2"), second)];
        let values = readings
            .update(|wanted| inputs.iter().find(|(at, _)| *at == wanted).map_or(f64::NAN, |one| one.1));
        [values[index("body")], values[index("start")], values[index("rise")]]
    };
    assert!(update(f64::NAN, 20.0).iter().all(|value| value.is_nan()));
    assert_eq!(update(20.0, 22.0), [21.0, 21.0, 21.0]);
    assert_eq!(update(30.0, 32.0), [31.0, 21.0, 26.0]);
}
