//! Outputs of loops, and loads from outside.

use super::*;
use crate::recording::{Named, Recording};
use crate::testing::{Bench, line, normals, path, position, scenario};

/// A carriage with a loop of second order that goes there and back, the load being made of error and velocity of each row.
fn recorded(load: impl Fn(f64, f64, usize) -> f64) -> Recording {
    let bench = Bench::of("FX");
    let truth = bench.calibration("{EXX: [{lag: {gain: 40 1/s, frequency: 6 Hz}}, {backlash: {lost_motion: 20 um, inside_loop: true}}]}");
    let mut scenario = scenario(path(line(0, 0.0, 60.0), 20.0, 200.0), position("x"));
    scenario.path.acceleration = Some(200.0);
    scenario.measurement.drives = vec![0];
    let mut recording = bench.record(&truth, &scenario);
    let axis = &recording.axes[0];
    let (command, actual) = (axis.command.clone().unwrap(), axis.actual.clone().unwrap());
    let velocity = slope(&recording.time, &actual);
    let values = (0..command.len()).map(|row| load(command[row] - actual[row], velocity[row], row)).collect();
    recording.loads = vec![Named { name: "motor".to_owned(), unit: "V".to_owned(), values }];
    recording
}

fn of(recording: &Recording) -> Vec<Answer> {
    let bench = Bench::of("FX");
    answers(&Study::new(bench.equations(), None, &[recording]))
}

#[test]
fn what_error_and_velocity_give_is_an_answer() {
    // A cascade: a velocity loop inside the position loop, and a little noise of the converter.
    let noise = normals(3, 10_000);
    let recording =
        recorded(|error, velocity, row| 0.24 * (35.0 * error - 0.4 * velocity) + 0.002 * noise[row]);
    let found = of(&recording);
    assert_eq!(found.iter().map(|answer| (answer.axis, answer.load)).collect::<Vec<_>>(), [(0, 0)]);
    assert!(found[0].share > 0.99 && found[0].share < 1.0, "{found:?}");
}

#[test]
fn an_output_that_follows_the_motion_is_an_answer_although_the_law_does_not_give_it() {
    let noise = normals(4, 10_000);
    let recording =
        recorded(|error, velocity, row| 0.24 * (35.0 * error - 0.4 * velocity) + 0.5 * noise[row]);
    let found = of(&recording);
    assert_eq!(found.len(), 1);
    assert!(found[0].share > MOSTLY && found[0].share < GIVEN, "{found:?}");
}

#[test]
fn a_load_from_outside_is_none() {
    let time = |row: usize| 0.005 * crate::number(row);
    assert_eq!(of(&recorded(|_, _, row| 5.0 * (7.0 * time(row)).sin())), []);
    // Nor is one that pushes from time to time.
    assert_eq!(of(&recorded(|_, _, row| if row % 300 < 120 { 5.0 } else { 0.0 })), []);
}

#[test]
fn a_load_that_makes_the_error_is_none_although_the_error_gives_it() {
    let bench = Bench::of("FX");
    let truth = bench.calibration(
        "{EXX: [{lag: {gain: 40 1/s}}, {compliance: {load: force, coefficient: 2 um/N, inside_loop: true}}]}",
    );
    let mut scenario = scenario(path(line(0, 0.0, 60.0), 20.0, 200.0), position("x"));
    scenario.measurement.drives = vec![0];
    scenario.loads = vec![simulation::Load {
        name: "force".to_owned(),
        unit: "N".to_owned(),
        base: 0.0,
        pulses: None,
        swing: Some(simulation::Swing { amplitude: 30.0, period: 3.0, phase: 0.0 }),
        noise: simulation::noise::Noise::default(),
    }];
    let recording = bench.record(&truth, &scenario);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let (given, carried) = shares(&study.scenes[0], 0, 0).unwrap();
    assert!(given > GIVEN && carried < CARRIES, "{given} {carried}");
    assert_eq!(answers(&study), []);
}
