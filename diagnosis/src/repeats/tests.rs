//! Runs with zeros of their own, and of which it is told that they do not repeat.

use super::*;
use crate::model::Fitted;
use crate::terms::Setting;
use crate::testing::{Bench, line, noisy, path, position};
use simulation::Path;

/// How far the second of two runs of X lies from the first one, mm.
const JUMP: f64 = 0.02;

/// Two runs there and back over 100 mm, read to 0.3 um: the second begins so far from the first one, mm, and reads `JUMP` more.
fn second_run_off_by(shift: f64) -> Option<Scatter> {
    let bench = Bench::of("FX");
    let truth = bench.calibration("{}");
    let runs = Path { runs: 2, ..path(line(0, 0.0, 100.0), 20.0, 50.0) };
    let mut recording = bench.record(&truth, &noisy(runs, position("x"), 0.000_3, 4));
    let second: Vec<bool> = recording.run.iter().map(|run| *run == 2).collect();
    let moved = |values: &mut Vec<f64>, by: f64| {
        let rows = values.iter_mut().zip(&second).filter(|(_, second)| **second);
        rows.for_each(|(value, _)| *value += by);
    };
    recording
        .axes
        .iter_mut()
        .filter_map(|axis| axis.command.as_mut())
        .for_each(|command| moved(command, shift));
    recording.measured.iter_mut().flatten().for_each(|read| moved(read, shift + JUMP));
    let study = Study::new(bench.equations(), None, std::slice::from_ref(&&recording));
    let zero = Effect::setting(0, Setting::Offset { channel: 0 });
    let model = Model::of([Fitted { effect: zero, coefficients: vec![0.01] }]);
    scatter(&study, &model).pop()
}

#[test]
fn runs_at_the_same_places_that_differ_do_not_repeat() {
    let scatter = second_run_off_by(0.0).unwrap();
    assert!(scatter.is_told);
    // Of two runs the standard deviation is the difference over the square root of two.
    assert!((scatter.between - JUMP / 2.0_f64.sqrt()).abs() < 1e-4, "{}", scatter.between);
    assert!((scatter.within - 0.000_3).abs() < 5e-5, "{}", scatter.within);
}

#[test]
fn of_runs_at_different_places_nothing_is_told() {
    assert!(!second_run_off_by(150.0).unwrap().is_told);
    // Most of each stroke is the same.
    assert!(second_run_off_by(30.0).unwrap().is_told);
}

#[test]
fn an_axis_that_stands_need_only_be_within_the_way_of_the_other_run() {
    let range = |low: f64, high: f64| Range { low, high };
    assert!(range(5.0, 5.0).shares(&range(0.0, 10.0)) && range(5.0, 5.0).shares(&range(5.0, 5.0)));
    assert!(!range(15.0, 15.0).shares(&range(0.0, 10.0)) && !range(5.0, 5.0).shares(&range(6.0, 6.0)));
    assert!(range(0.0, 10.0).shares(&range(4.0, 14.0)) && !range(0.0, 10.0).shares(&range(6.0, 16.0)));
}
