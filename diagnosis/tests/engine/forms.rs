//! Forms for which no term has a name: planted in the exact machine, and found with their numbers.
//!
//! In: recordings in which a term is multiplied with states of the machine, or in which something happened once. Out: the form, its
//! interval, and what is said of it.

use abbe_diagnosis::diagnosis::{Diagnosis, Estimate, Finding, Verdict};
use model_dsl::calibration::{CalibratedTerm, Factor};
use simulation::path::Shape;
use simulation::{Load, Path, Swing};

use crate::common::*;
use crate::recording::Recording;
use crate::testing::*;

/// Standard deviation of the noise, mm.
const SIGMA: f64 = 0.0005;

fn runs(path: Path, runs: u32) -> Path {
    Path { runs, ..path }
}

/// The diagnosis of a machine with concealed errors below those of a mill, or below none, on paths each of which is a recording.
fn concealed(machine: &str, known: &str, more: &str, paths: Vec<Path>, directions: &str) -> Diagnosis {
    let bench = Bench::of(machine);
    let known = bench.calibration(known);
    let truth = together(&known, &bench.calibration(more));
    let record = |(seed, path): (u64, Path)| {
        let mut scenario = noisy(path, position(directions), SIGMA, seed);
        if more.contains("scale") {
            scenario.temperatures = vec![warming("scale", 6.0, 300.0)];
        }
        if more.contains("spindle") {
            scenario.loads = vec![spindle()];
        }
        bench.record(&truth, &scenario)
    };
    let recordings: Vec<Recording> = (7..).zip(paths).map(record).collect();
    diagnosed(&bench, &known, &recordings.iter().collect::<Vec<_>>())
}

/// The speed of a spindle, which goes up and down by two fifths.
fn spindle() -> Load {
    let swing = Swing { amplitude: 40.0, period: 90.0, phase: 0.0 };
    Load {
        name: "spindle".to_owned(),
        unit: "count".to_owned(),
        base: 100.0,
        swing: Some(swing),
        ..Load::default()
    }
}

/// The finding that is a form.
#[track_caller]
fn composed(diagnosis: &Diagnosis) -> &Finding {
    let mut forms = diagnosis.findings.iter().filter(|finding| finding.form.is_some());
    let first = forms.next();
    assert_eq!(forms.count(), 0, "{:?}", found(diagnosis));
    first.unwrap_or_else(|| panic!("no form in {:?}, {:?}", found(diagnosis), diagnosis.unexplained))
}

#[track_caller]
fn holds(estimate: &Estimate, truth: f64) {
    let away = off(estimate, truth);
    assert!(away < 2.0, "{truth} is {away} half widths from {estimate:?}");
}

fn there_and_back() -> Path {
    Path { pause: 20.0, ..runs(path(line(0, 0.0, 300.0), 20.0, 8.0), 6) }
}

#[test]
fn a_play_that_grows_along_the_travel() {
    let more = "{EXX: [{backlash: {lost_motion: 3 um}}, {backlash: {lost_motion: 40 nm/mm, times: [{position: X}]}}]}";
    let diagnosis = concealed("FX", "{}", more, vec![there_and_back()], "x");
    assert_eq!(found(&diagnosis), ["EXX backlash", "EXX backlash"]);
    let form = composed(&diagnosis);
    holds(&numbers(form, "lost_motion")[0], 4e-5);
    assert!(matches!(form.calibrated.factors(), [Factor::Position { axis: 0, power: 1, .. }]), "{form:?}");
    let told = form.form.as_ref().unwrap();
    // With the play beside it: 3 um where X is 0, 15 um at 300 mm.
    assert!(told.words.starts_with("A backlash of X that grows from 3."), "{}", told.words);
    assert!(told.words.contains("to 15.") || told.words.contains("to 14."), "{}", told.words);
    assert!(told.equation.text.contains("d_X * [x]"), "{}", told.equation.text);
    let plain = diagnosis.findings.iter().find(|finding| finding.form.is_none()).unwrap();
    holds(&numbers(plain, "lost_motion")[0], 0.003);
}

#[test]
fn a_play_that_follows_a_temperature() {
    let more =
        "{EXX: [{backlash: {lost_motion: 2 um/K, times: [{temperature: scale, reference: 20 degC}]}}]}";
    let diagnosis = concealed("FX", "{}", more, vec![there_and_back()], "x");
    assert_eq!(found(&diagnosis), ["EXX backlash"]);
    let form = composed(&diagnosis);
    holds(&numbers(form, "lost_motion")[0], 0.002);
    assert_eq!(form.sensors, [(0, "scale".to_owned())]);
    assert!(form.compensable);
}

#[test]
fn a_wave_that_grows_along_the_travel() {
    let more =
        "{EXX: [{cyclic: {period: 10 mm, amplitude: 20 nm/mm, phase: 34 deg, times: [{position: X}]}}]}";
    // At one speed a wave that grows along the travel is one that grows in time.
    let fine = |feed: f64| runs(path(line(0, 0.0, 200.0), feed, 20.0), 3);
    let diagnosis = concealed("FX", "{}", more, vec![fine(20.0), fine(33.0)], "x");
    assert_eq!(found(&diagnosis), ["EXX cyclic"]);
    let form = composed(&diagnosis);
    holds(&numbers(form, "amplitude")[0], 2e-5);
    holds(&numbers(form, "period")[0], 10.0);
    holds(&numbers(form, "phase")[0], 34_f64.to_radians());
}

#[test]
fn an_error_that_is_the_product_of_two_positions() {
    let grid = Shape::Grid { plane: [0, 1], from: [20.0, 20.0], to: [420.0, 240.0], lines: 6 };
    let more = "{EYX: [{product: {value: 90 um/m^2, times: [{position: X}, {position: Y}]}}]}";
    let path = Path { at: vec![vec![250.0], vec![140.0], vec![-50.0]], ..runs(path(grid, 50.0, 5.0), 3) };
    let diagnosis = concealed("xyfz-mill", MILL, more, vec![path], "xyz");
    let form = composed(&diagnosis);
    assert_eq!(diagnosis.findings.len(), 1, "{:?}", found(&diagnosis));
    assert!(names(form).contains(&"EYX product".to_owned()), "{:?}", names(form));
    // Under another name of the same it has the other sign.
    let mut value = numbers(form, "value")[0].clone();
    if value.value < 0.0 {
        value = Estimate { value: -value.value, ci95: (-value.ci95.1, -value.ci95.0), ..value };
    }
    holds(&value, 9e-8);
    assert_eq!(form.calibrated.factors().len(), 2);
}

#[test]
fn a_screw_that_its_own_motion_warms() {
    let more = "{EXX: [{product: {value: 11e-6 1/K, times: [{warmth: X, time_constant: 200 s, rise: 0.08 K.s/mm}, {position: X}]}}]}";
    let long = runs(path(line(0, 0.0, 300.0), 30.0, 3.0), 24);
    let diagnosis = concealed("FX", "{}", more, vec![long], "x");
    let form = composed(&diagnosis);
    assert_eq!(diagnosis.findings.len(), 1, "{:?}", found(&diagnosis));
    // What a kelvin does and how many kelvins a speed makes are one number.
    holds(&numbers(form, "value")[0], 11e-6 * 0.08);
    let warmth = form.calibrated.factors().iter().find_map(|factor| match factor {
        Factor::Warmth { time_constant, .. } => Some(*time_constant),
        _ => None,
    });
    assert!(warmth.is_some_and(|time_constant| (time_constant - 200.0).abs() < 60.0), "{form:?}");
}

#[test]
fn a_crash_is_dated_and_told_from_a_drift() {
    let grid = Shape::Grid { plane: [0, 1], from: [20.0, 20.0], to: [420.0, 240.0], lines: 4 };
    let path = Path { at: vec![vec![250.0], vec![140.0], vec![-50.0]], ..runs(path(grid, 50.0, 5.0), 4) };
    let more = "{EC0Y: [{step: {time: 70 s, size: 60 urad}}], EXX: [{step: {time: 70 s, size: 8 um}}]}";
    let diagnosis = concealed("xyfz-mill", MILL, more, vec![path], "xyz");
    assert_eq!(diagnosis.findings.len(), 2, "{:?}", found(&diagnosis));
    let squareness = called(&diagnosis, "EC0Y step");
    holds(&numbers(squareness, "size")[0], 60e-6);
    let zero = called(&diagnosis, "EXX step");
    holds(&numbers(zero, "size")[0], 0.008);
    for finding in [squareness, zero] {
        assert!(!finding.compensable);
        let words = &finding.form.as_ref().unwrap().words;
        // To the row: five a second.
        assert!(words.contains("70.") || words.contains("69.9"), "{words}");
    }
}

/// A slide that goes to and fro six times in one run of 154 s, with concealed errors.
fn to_and_fro(more: &str) -> Diagnosis {
    let bench = Bench::of("FX");
    let truth = bench.calibration(more);
    let path = runs(path(line(0, 0.0, 300.0), 25.0, 20.0), 6);
    let mut recording = bench.record(&truth, &noisy(path, position("x"), SIGMA, 7));
    recording.run.fill(1);
    recording.holdout = None;
    diagnosed(&bench, &bench.calibration("{}"), &[&recording])
}

/// One event in each of the twelve blocks of the run, of which every fourth is held out. Each run of 24 s and a pause of 2 s is two blocks.
#[test]
fn an_event_is_found_in_whichever_block_it_happens() {
    for block in 0..12_u32 {
        let time = 26.0 * f64::from(block / 2) + if block.is_multiple_of(2) { 6.3 } else { 18.3 };
        let diagnosis = to_and_fro(&format!("{{EXX: [{{step: {{time: {time} s, size: 4 um}}}}]}}"));
        assert_eq!(diagnosis.findings.len(), 1, "{time}: {:?}", found(&diagnosis));
        let event = called(&diagnosis, "EXX step");
        holds(&numbers(event, "size")[0], 0.004);
        let dated = match event.calibrated {
            CalibratedTerm::Step { time, .. } => time,
            ref other => panic!("{other:?}"),
        };
        assert!((dated - time).abs() < 0.06, "{dated} for {time}, to the row: twenty a second");
    }
}

/// A backlash of the size of an event hides it, and is hidden by it.
#[test]
fn an_event_and_what_it_hides_are_found_together() {
    for time in [36.7, 60.2, 81.1] {
        let more = format!(
            "{{EXX: [{{step: {{time: {time} s, size: 5 um}}}}, {{backlash: {{lost_motion: 4 um}}}}, \
             {{polynomial: {{axis: X, per: mm, unit: um, coefficients: [0, 0.01]}}}}]}}"
        );
        let diagnosis = to_and_fro(&more);
        assert_eq!(diagnosis.findings.len(), 3, "{time}: {:?}", found(&diagnosis));
        holds(&numbers(called(&diagnosis, "EXX step"), "size")[0], 0.005);
        holds(&numbers(called(&diagnosis, "EXX backlash"), "lost_motion")[0], 0.004);
        called(&diagnosis, "EXX polynomial");
    }
}

/// Circles, which start and stop at once, at two feeds.
fn circles() -> Vec<Path> {
    let at = vec![vec![250.0], vec![140.0], vec![-50.0]];
    [20.0, 60.0].map(|feed| Path { at: at.clone(), ..runs(path(circle(50.0), feed, 50.0), 3) }).to_vec()
}

#[test]
fn an_axis_that_is_told_late_has_no_loop() {
    let diagnosis = concealed("xyfz-mill", MILL, "{EXX: [{delay: {time: 5 ms}}]}", circles(), "xy");
    assert_eq!(found(&diagnosis), ["EXX delay"]);
    holds(&numbers(&diagnosis.findings[0], "time")[0], 0.005);
}

#[test]
fn an_axis_that_is_told_late_and_follows_late() {
    let more = "{EXX: [{delay: {time: 6 ms}}, {lag: {gain: 60 1/s}}]}";
    let diagnosis = concealed("xyfz-mill", MILL, more, circles(), "xy");
    assert_eq!(diagnosis.findings.len(), 2, "{:?}", found(&diagnosis));
    holds(&numbers(called(&diagnosis, "EXX delay"), "time")[0], 0.006);
    holds(&numbers(called(&diagnosis, "EXX lag"), "gain")[0], 60.0);
}

#[test]
fn a_play_that_fades_with_speed() {
    // Most of what comes back is the play: such samples count for few, and still the form is found.
    let more = "{EXX: [{backlash: {lost_motion: 8 um, times: [{fading: X, over: 15 mm/s}]}}]}";
    let diagnosis = concealed("xyfz-mill", MILL, more, circles(), "x");
    assert_eq!(found(&diagnosis), ["EXX backlash"]);
    let form = composed(&diagnosis);
    holds(&numbers(form, "lost_motion")[0], 0.008);
    let over = form.calibrated.factors().iter().find_map(|factor| match factor {
        Factor::Fading { over, .. } => Some(*over),
        _ => None,
    });
    // Between the speeds that were driven the number is known to a fifth of itself: so far apart are those that are tried.
    assert!(over.is_some_and(|over| (over - 15.0).abs() < 3.0), "{form:?}");
}

#[test]
fn a_loop_whose_gain_differs_by_direction() {
    // 10 % of a gain of 50 1/s: 2 ms of the speed, whose sign does not change with the direction.
    let more = "{EXX: [{lag: {gain: 50 1/s}}, {product: {value: 2 ms, times: [{speed: X}]}}]}";
    let diagnosis = concealed("xyfz-mill", MILL, more, circles(), "xy");
    assert_eq!(diagnosis.findings.len(), 2, "{:?}", found(&diagnosis));
    holds(&numbers(called(&diagnosis, "EXX lag"), "gain")[0], 50.0);
    let form = composed(&diagnosis);
    assert!(matches!(form.calibrated.factors(), [Factor::Speed { axis: 0, .. }]), "{form:?}");
    holds(&numbers(form, "value")[0], 0.002);
}

#[test]
fn an_unbalance_that_follows_the_speed_of_a_spindle() {
    let more = "{EXX: [{backlash: {lost_motion: 4 um}}, \
        {product: {value: 2 um, times: [{spin: spindle, rate: 0.021 1/s/count, phase: 34 deg}]}}]}";
    let diagnosis = concealed("FX", "{}", more, vec![there_and_back()], "x");
    assert_eq!(found(&diagnosis), ["EXX backlash", "EXX product"]);
    let form = composed(&diagnosis);
    holds(&numbers(form, "value")[0], 0.002);
    let [Factor::Spin { load, rate, phase }] = form.calibrated.factors() else { panic!("{form:?}") };
    assert_eq!(load, "spindle");
    // Noise of a quarter of the amplitude in 1400 rows: the phase is known to a hundredth of a radian, and the rate to that much over the
    // whole recording, in which the spindle turns 360 times.
    assert!((rate - 0.021).abs() < 0.021 * 3e-5, "{rate}");
    assert!((phase - 34_f64.to_radians()).abs() < 0.05, "{phase}");
    let told = form.form.as_ref().unwrap();
    assert!(told.words.contains("0.02100 times per second for each unit of spindle"), "{}", told.words);
}

#[test]
fn what_has_a_name_is_told_by_it() {
    // Two plays, and a scale that follows a temperature: nothing is composed where the vocabulary reaches the noise.
    let more = "{EXX: [{backlash: {lost_motion: 6 um}}, {expansion: {sensor: scale, coefficient: 5 um/m/K, reference: 20 degC}}]}";
    let diagnosis = concealed("FX", "{}", more, vec![there_and_back()], "x");
    assert!(diagnosis.findings.iter().all(|finding| finding.form.is_none()), "{:?}", found(&diagnosis));
    let quiet = concealed("FX", "{}", "{}", vec![there_and_back()], "x");
    assert_eq!(quiet.verdict, Verdict::Adequate);
}
