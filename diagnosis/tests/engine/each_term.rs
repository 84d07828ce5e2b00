//! Every term alone, as large as a few standard deviations of the noise, in a recording that can show it: found by name,
//! with intervals that hold the truth.

use abbe_diagnosis::diagnosis::Verdict;
use simulation::path::Shape;
use simulation::{Load, Path, Pulses, Scenario};

use crate::common::*;
use crate::testing::*;

/// Standard deviation of the noise, mm.
const SIGMA: f64 = 0.001;

/// One term to be found.
struct Case {
    machine: &'static str,
    path: Path,
    /// The directions that are measured.
    directions: &'static str,
    concealed: &'static str,
    name: &'static str,
    /// Parameters with their true numbers; NaN where a free zero hides one.
    truth: &'static [(&'static str, &'static [f64])],
}

fn runs(path: Path, runs: u32) -> Path {
    Path { runs, ..path }
}

fn cases() -> Vec<Case> {
    let stage = |path: Path, concealed, name, truth| Case {
        machine: "FX",
        path,
        directions: "x",
        concealed,
        name,
        truth,
    };
    let mill = |path: Path, directions, concealed, name, truth| Case {
        machine: "xyfz-mill",
        path: Path { at: vec![vec![250.0], vec![140.0], vec![-50.0]], ..path },
        directions,
        concealed,
        name,
        truth,
    };
    let there_and_back = || runs(path(line(0, 0.0, 300.0), 20.0, 8.0), 3);
    let fine = || runs(path(line(0, 0.0, 120.0), 20.0, 20.0), 3);
    let round = || runs(path(circle(100.0), 25.0, 6.0), 3);
    let jerky = Path { acceleration: Some(100.0), ..runs(path(line(0, 0.0, 200.0), 50.0, 25.0), 4) };
    let warm = || Path { pause: 40.0, ..runs(path(line(0, 0.0, 300.0), 30.0, 3.0), 10) };
    let grid = Shape::Grid { plane: [0, 1], from: [100.0, 40.0], to: [400.0, 240.0], lines: 5 };
    vec![
        mill(round(), "xy", "{EC0Y: 30 urad}", "EC0Y constant", &[("value", &[30e-6])]),
        stage(
            there_and_back(),
            "{EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, -0.08, 2.6667e-4]}}]}",
            "EXX polynomial",
            &[("coefficients", &[f64::NAN, -0.08e-3, 2.6667e-7])],
        ),
        stage(
            there_and_back(),
            "{EXX: [{backlash: {lost_motion: 6 um}}]}",
            "EXX backlash",
            &[("lost_motion", &[0.006])],
        ),
        stage(
            there_and_back(),
            "{EXX: [{backlash: {lost_motion: 6 um, wind_up: 60 mm}}]}",
            "EXX backlash",
            &[("lost_motion", &[0.006]), ("wind_up", &[60.0])],
        ),
        mill(
            runs(path(circle(60.0), 40.0, 25.0), 4),
            "xy",
            "{EYY: [{reversal-spike: {height: 4 um, decay: 0.3 s}}]}",
            "EYY reversal-spike",
            &[("height", &[0.004]), ("decay", &[0.3])],
        ),
        stage(
            fine(),
            "{EXX: [{cyclic: {period: 10 mm, amplitude: 3 um, phase: 1 rad}}]}",
            "EXX cyclic",
            &[("period", &[10.0]), ("amplitude", &[0.003]), ("phase", &[1.0])],
        ),
        mill(round(), "xy", "{EXX: [{lag: {gain: 5000 1/s}}]}", "EXX lag", &[("gain", &[5000.0])]),
        stage(
            jerky,
            "{EXX: [{acceleration: {gain: 25000 1/s^2}}]}",
            "EXX acceleration",
            &[("gain", &[25_000.0])],
        ),
        stage(
            warm(),
            "{EXX: [{expansion: {sensor: scale, coefficient: 1.2e-6 1/K, reference: 20 degC}}]}",
            "EXX expansion",
            &[("coefficient", &[1.2e-6])],
        ),
        mill(
            warm(),
            "xz",
            "{EZZ: [{growth: {sensor: scale, coefficient: 0.4 um/K, reference: 20 degC}}]}",
            "EZZ growth",
            &[("coefficient", &[0.4e-3])],
        ),
        mill(
            warm(),
            "xz",
            "{EZZ: [{growth: {sensor: scale, coefficient: 0.5 um/K, reference: 20 degC, time_constant: 120 s}}]}",
            "EZZ growth",
            &[("coefficient", &[0.5e-3]), ("time_constant", &[120.0])],
        ),
        mill(
            warm(),
            "xz",
            "{EZZ: [{drift: {amplitude: 5 um, time_constant: 120 s}}]}",
            "EZZ drift",
            &[("amplitude", &[0.005]), ("time_constant", &[120.0])],
        ),
        stage(
            fine(),
            "{EXX: [{vibration: {frequency: 1.7 Hz, amplitude: 3 um, phase: 0.4 rad}}]}",
            "EXX vibration",
            &[("frequency", &[1.7]), ("amplitude", &[0.003]), ("phase", &[0.4])],
        ),
        mill(
            runs(path(grid, 50.0, 5.0), 3),
            "xyz",
            "{EBX: [{coupling: {axis: Y, per: mm, unit: urad, coefficients: [0.1]}}]}",
            "EBX coupling",
            &[("coefficients", &[0.1e-6])],
        ),
        stage(
            there_and_back(),
            "{EXX: [{compliance: {load: force, coefficient: 0.03 um/N}}]}",
            "EXX compliance",
            &[("coefficient", &[0.03e-3])],
        ),
    ]
}

fn recorded(case: &Case, seed: u64) -> Scenario {
    let mut scenario = noisy(case.path.clone(), position(case.directions), SIGMA, seed);
    if case.concealed.contains("scale") {
        scenario.temperatures = vec![warming("scale", 10.0, 150.0)];
    }
    if case.concealed.contains("drift") {
        // The last run hardly drifts any more and would bear out nothing.
        scenario.holdout = vec![3];
    }
    if case.concealed.contains("force") {
        let pulses = Pulses { height: 100.0, period: 7.3, width: 3.1, start: 1.0 };
        let pulses = Some(pulses);
        scenario.loads =
            vec![Load { name: "force".to_owned(), unit: "N".to_owned(), pulses, ..Load::default() }];
    }
    scenario
}

/// Every case under one seed; the numbers' distances from the truth in half widths.
fn distances(seed: u64) -> Vec<f64> {
    let mut distances = Vec::new();
    let mut wrong = Vec::new();
    for case in cases() {
        let bench = Bench::of(case.machine);
        let known = bench.calibration(if case.machine == "FX" { STAGE } else { MILL });
        let truth = together(&known, &bench.calibration(case.concealed));
        let recording = bench.record(&truth, &recorded(&case, seed));
        let diagnosis = diagnosed(&bench, &known, &[&recording]);
        if diagnosis.verdict != Verdict::LeftOutPhysics || found(&diagnosis) != [case.name] {
            let others: Vec<_> = diagnosis.findings.iter().map(names).collect();
            wrong.push(format!(
                "{} ({seed}): {:?} {others:?} {:?}",
                case.concealed, diagnosis.verdict, diagnosis.settings
            ));
            continue;
        }
        // What remains of the held-out data is the noise.
        let held_out = diagnosis.after.holdout_rms.unwrap();
        let samples =
            recording.run.iter().filter(|run| recording.holdout.as_ref().unwrap().contains(run)).count();
        // Four deviations of so many samples, and what the uncertainty of the fit adds.
        let scatter = 4.0 / (2.0 * f64::from(u32::try_from(samples).unwrap())).sqrt();
        if (held_out / SIGMA - 1.0).abs() > scatter + 0.03 {
            wrong.push(format!("{} ({seed}): held-out rms {held_out}", case.name));
        }
        for (name, truth) in case.truth {
            let estimates = numbers(&diagnosis.findings[0], name);
            assert_eq!(estimates.len(), truth.len(), "{name} of {}", case.name);
            for (estimate, truth) in estimates.iter().zip(*truth).filter(|(_, truth)| truth.is_finite()) {
                let off = off(estimate, *truth);
                if off.is_nan() || off >= FAR {
                    wrong.push(format!("{name} of {} ({seed}): {truth} but {estimate:?}", case.name));
                }
                distances.push(off);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    distances
}

#[test]
fn every_term_alone_is_found_by_name_with_its_parameters() {
    let distances: Vec<f64> = (1..=3).flat_map(distances).collect();
    let inside = distances.iter().filter(|off| **off <= 1.0).count();
    // 95 % of some 70 numbers; no fewer than 85 % by any luck.
    assert!(distances.len() > 60);
    assert!(inside * 100 >= 85 * distances.len(), "{inside} of {} intervals hold the truth", distances.len());
}

#[test]
fn a_curve_that_no_smooth_term_follows_is_a_table() {
    let bench = Bench::of("FX");
    let known = bench.calibration(STAGE);
    let concealed = "{EXX: [{table: {axis: X, at: [0, 40, 70, 100, 120, 170, 200, 260, 300], per: mm, unit: um, \
        values: [0, 4, -5, -6, 5, 6, -4, -5, 2]}}]}";
    let truth = together(&known, &bench.calibration(concealed));
    let path = runs(path(line(0, 0.0, 300.0), 20.0, 8.0), 5);
    let recording = bench.record(&truth, &noisy(path, position("x"), SIGMA, 4));
    let diagnosis = diagnosed(&bench, &known, &[&recording]);
    assert_eq!(found(&diagnosis), ["EXX table"], "{:?}", diagnosis.unexplained);
    assert_eq!(diagnosis.verdict, Verdict::LeftOutPhysics);
    let interval = diagnosis.findings[0].location.interval.clone().unwrap();
    assert!(interval.from < 40.0 && interval.to > 260.0, "{interval:?}");
}
