//! Motors that move several axes, or that share a beam: what one of them does wrong is one finding of that motor, with its own size, below
//! larger errors of the axes that are known.

use simulation::Path;
use simulation::path::Shape;

use crate::common::*;
use crate::testing::*;

/// Standard deviation of the noise, mm.
const SIGMA: f64 = 0.001;

/// Known errors of the axes, some ten times what is concealed below them.
const AXES: &str = "EXX: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.4, -8e-4]}}], \
    EYY: [{polynomial: {per: mm, unit: um, coefficients: [0, -0.3, 6e-4]}}], EC0Y: 300 urad";

fn bench(crossed: bool) -> Bench {
    if crossed {
        return Bench::file("topology: FXYZ\ntransmission: {A: X + Y, B: X - Y}\n");
    }
    Bench::file(
        "chain:\n  tool:\n    - {slide: Y, along: +Y, drives: {Y1: {x: -400 mm}, Y2: {x: 600 mm}}}\n    - {slide: X, along: +X}\n    \
         - {slide: Z, along: +Z}\n    - {tool: tip}\n",
    )
}

/// What is found of an error beside those that are known, with its lost motion or amplitude and the half width of its interval.
fn searched(crossed: bool, concealed: &str, seed: u64) -> Vec<(String, f64, f64)> {
    let bench = bench(crossed);
    let shape = match crossed {
        true => circle(80.0),
        false => Shape::Grid { plane: [0, 1], from: [-300.0, 0.0], to: [500.0, 400.0], lines: 5 },
    };
    let path = Path { at: vec![vec![150.0], vec![150.0]], runs: 3, ..path(shape, 50.0, 20.0) };
    let known = bench.calibration(&format!("{{{AXES}}}"));
    let truth = together(&known, &bench.calibration(&format!("{{{concealed}}}")));
    let recording = bench.record(&truth, &noisy(path, position("xyz"), SIGMA, seed));
    let diagnosis = diagnosed(&bench, &known, &[&recording]);
    let sizes = |finding: &abbe_diagnosis::diagnosis::Finding| {
        let name = if finding.term == "cyclic" { "amplitude" } else { "lost_motion" };
        numbers(finding, name).first().map(|size| (size.value, size.ci95)).unwrap()
    };
    let found = found(&diagnosis).into_iter().zip(&diagnosis.findings);
    found
        .map(|(name, finding)| {
            let (value, (low, high)) = sizes(finding);
            (name, value, 0.5 * (high - low))
        })
        .collect()
}

/// Asserts that this is the only finding, and that its size is right within `FAR` times its interval.
#[track_caller]
fn alone(found: &[(String, f64, f64)], name: &str, size: f64) {
    let [(known, value, half)] = found else { panic!("{found:?}") };
    assert_eq!(known, name);
    assert!((value - size).abs() < FAR * half, "{value} +- {half} is not {size}");
}

#[test]
fn the_play_of_a_crossed_motor_is_one_finding_and_not_two_of_axes() {
    let found = searched(true, "EA: [{backlash: {lost_motion: 20 um}}]", 31);
    alone(&found, "EA backlash", 0.020);
}

/// The play of a slide is not taken for that of a motor.
#[test]
fn the_play_of_a_slide_behind_crossed_motors_is_its_own() {
    let found = searched(true, "EXX: [{backlash: {lost_motion: 20 um}}]", 32);
    alone(&found, "EXX backlash", 0.020);
}

#[test]
fn the_pulley_of_a_crossed_motor_is_one_wave() {
    let found = searched(true, "EB: [{cyclic: {period: 40 mm, amplitude: 12 um, phase: 20 deg}}]", 33);
    alone(&found, "EB cyclic", 0.012);
}

#[test]
fn the_play_of_one_drive_of_a_beam_is_that_of_the_drive() {
    let found = searched(false, "EY2: [{backlash: {lost_motion: 15 um}}]", 34);
    alone(&found, "EY2 backlash", 0.015);
}

/// Both drives together, in opposite senses, are the racking of the beam.
#[test]
fn racking_is_told_as_the_rotation_of_the_beam() {
    let found = searched(false, "ECY: [{backlash: {lost_motion: 20 urad}}]", 35);
    alone(&found, "ECY backlash", 20e-6);
}
