//! Verdicts: nothing left out, runs that do not repeat, something that no term describes, and recordings that tell nothing.

use std::sync::Arc;

use abbe_diagnosis::diagnosis::{Diagnosis, IntervalOf, Verdict};
use simulation::noise::{Correlated, Missing, Noise, Outliers, Walk};
use simulation::path::Shape;
use simulation::{Path, Scenario};

use crate::common::*;
use crate::recording::Recording;
use crate::testing::*;

fn stage_path() -> Path {
    Path { runs: 4, ..path(line(0, 0.0, 300.0), 20.0, 8.0) }
}

fn mill_path() -> Path {
    Path { at: vec![vec![250.0], vec![140.0], vec![-50.0]], runs: 3, ..path(circle(100.0), 25.0, 6.0) }
}

fn quiet(seed: u64, noise: Noise, stage: bool) -> Diagnosis {
    let bench = Bench::of(if stage { "FX" } else { "xyfz-mill" });
    let known = bench.calibration(if stage { STAGE } else { MILL });
    let (path, instrument) =
        if stage { (stage_path(), position("x")) } else { (mill_path(), position("xy")) };
    let mut scenario = noisy(path, instrument, 0.001, seed);
    scenario.measurement.noise = noise;
    diagnosed(&bench, &known, &[&bench.record(&known, &scenario)])
}

#[test]
fn where_nothing_is_left_out_nothing_is_found() {
    let mut claimed = Vec::new();
    for seed in 0..6 {
        for stage in [true, false] {
            let white = Noise::white(0.001);
            let correlated = Some(Correlated { sigma: 0.001, time_constant: 2.0 });
            for noise in [white, Noise { correlated, ..white }, Noise { resolution: 0.0005, ..white }] {
                let diagnosis = quiet(seed, noise, stage);
                if diagnosis.verdict != Verdict::Adequate || !diagnosis.findings.is_empty() {
                    claimed.push((seed, stage, diagnosis.verdict, found(&diagnosis), diagnosis.unexplained));
                }
                let (before, after) = (diagnosis.before.rms, diagnosis.after.rms);
                assert!(after <= 1.02 * before && diagnosis.noise.unit == "mm");
            }
        }
    }
    assert!(claimed.is_empty(), "{claimed:#?}");
}

#[test]
fn a_sensor_that_walks_makes_no_wave() {
    let mut claimed = Vec::new();
    for seed in 0..8 {
        for stage in [true, false] {
            let duration = if stage { 130.0 } else { 160.0 };
            let walk = Some(Walk { sigma: 0.004, after: duration });
            let diagnosis = quiet(seed, Noise { walk, ..Noise::white(0.0005) }, stage);
            if !diagnosis.findings.is_empty() {
                claimed.push((seed, stage, found(&diagnosis)));
            }
        }
    }
    assert!(claimed.is_empty(), "{claimed:?}");
}

#[test]
fn a_sensor_that_walks_takes_no_play_back() {
    // The zero that allows for a walk may lie farther from the rows that are held out than their mean does.
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration(MILL);
    let truth = together(&known, &bench.calibration("{EXX: [{backlash: {lost_motion: 4 um}}]}"));
    for seed in 0..12 {
        let mut scenario = noisy(mill_path(), position("xy"), 0.001, seed);
        let walk = Some(Walk { sigma: 0.006, after: 160.0 });
        scenario.measurement.noise = Noise { walk, ..Noise::white(0.0003) };
        let diagnosis = diagnosed(&bench, &known, &[&bench.record(&truth, &scenario)]);
        assert_eq!(found(&diagnosis), ["EXX backlash"], "{seed}");
        let lost = &numbers(&diagnosis.findings[0], "lost_motion")[0];
        assert!(off(lost, 0.004) < FAR, "{seed}: {lost:?}");
        assert!(diagnosis.after.holdout_rms <= diagnosis.before.holdout_rms, "{seed}");
    }
}

#[test]
fn the_noise_is_told_with_its_parts() {
    let correlated = Some(Correlated { sigma: 0.002, time_constant: 1.5 });
    let diagnosis = quiet(3, Noise { correlated, ..Noise::white(0.001) }, true);
    let noise = diagnosis.noise;
    assert!((noise.white / 0.001 - 1.0).abs() < 0.4, "{noise:?}");
    assert!((noise.wander / 0.002 - 1.0).abs() < 0.4, "{noise:?}");
    assert!((noise.value - noise.white.hypot(noise.wander)).abs() < 1e-12);
    assert!((0.6..4.0).contains(&noise.time_constant), "{noise:?}");
}

#[test]
fn runs_that_do_not_repeat_are_called_so() {
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration(MILL);
    let lines = Path {
        runs: 6,
        at: vec![vec![], vec![140.0], vec![-50.0]],
        ..path(line(0, 100.0, 400.0), 25.0, 5.0)
    };
    let mut scenario = noisy(lines, position("xy"), 0.001, 5);
    scenario.measurement.fixture = 0.008;
    let diagnosis = diagnosed(&bench, &known, &[&bench.record(&known, &scenario)]);
    assert_eq!(diagnosis.verdict, Verdict::NotRepeatable);
    let repeatability = diagnosis.repeatability.unwrap();
    assert!((0.003..0.02).contains(&repeatability.between_runs), "{repeatability:?}");
    assert!(repeatability.expected < 0.002);
    // The scatter of the runs is no term of the machine.
    assert!(diagnosis.findings.is_empty());
}

#[test]
fn an_effect_is_found_below_runs_that_do_not_repeat() {
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration(MILL);
    let truth = together(&known, &bench.calibration("{EXX: [{backlash: {lost_motion: 6 um}}]}"));
    let lines = Path {
        runs: 6,
        at: vec![vec![], vec![140.0], vec![-50.0]],
        ..path(line(0, 100.0, 400.0), 25.0, 5.0)
    };
    let mut scenario = noisy(lines, position("xy"), 0.001, 6);
    scenario.measurement.fixture = 0.008;
    let diagnosis = diagnosed(&bench, &known, &[&bench.record(&truth, &scenario)]);
    assert_eq!(diagnosis.verdict, Verdict::NotRepeatable);
    assert_eq!(diagnosis.findings.len(), 1);
    assert!(off(&numbers(called(&diagnosis, "EXX backlash"), "lost_motion")[0], 0.006) < FAR);
}

#[test]
fn a_dent_is_located() {
    let bench = Bench::of("FX");
    let known = bench.calibration(STAGE);
    let (from, to) = (212.0, 236.0);
    let dent = Arc::new(move |state: &simulation::State<'_>| {
        let q = state.position(0);
        if (from..to).contains(&q) {
            0.004 * ((q - from) / (to - from) * std::f64::consts::PI).sin()
        } else {
            0.0
        }
    });
    let plant = bench.plant(&known).with_effect(bench.motion("EXX"), dent);
    let lines = Path { runs: 5, ..path(line(0, 0.0, 300.0), 20.0, 10.0) };
    let recording = bench.recorded(&plant, &noisy(lines, position("x"), 0.001, 7));
    let diagnosis = diagnosed(&bench, &known, &[&recording]);
    // No term has this form but a table of that place.
    let interval = match (&diagnosis.unexplained, diagnosis.findings.as_slice()) {
        (Some(unexplained), []) => {
            assert_eq!(diagnosis.verdict, Verdict::Unexplained);
            assert_eq!(
                (unexplained.link.as_deref(), unexplained.direction.as_str()),
                (Some("X"), "measured.x")
            );
            unexplained.interval.clone().unwrap()
        }
        (None, [table]) if table.term == "table" => {
            assert_eq!(diagnosis.verdict, Verdict::LeftOutPhysics);
            table.location.interval.clone().unwrap()
        }
        (unexplained, _) => panic!("{:?} {unexplained:?}", found(&diagnosis)),
    };
    assert_eq!(interval.of, IntervalOf::Axis("X".to_owned()));
    let overlap = interval.to.min(to) - interval.from.max(from);
    assert!(overlap > 0.6 * (to - from), "{interval:?}");
    assert!(interval.to - interval.from < 2.0 * (to - from), "{interval:?}, {:?}", found(&diagnosis));
}

/// The backlash that is concealed in the tests of spoiled data.
fn with_backlash(change: impl FnOnce(&mut Scenario), spoil: impl FnOnce(&mut Recording)) -> Diagnosis {
    let bench = Bench::of("FX");
    let known = bench.calibration(STAGE);
    let truth = together(&known, &bench.calibration("{EXX: [{backlash: {lost_motion: 5 um}}]}"));
    let mut scenario = noisy(stage_path(), position("x"), 0.001, 8);
    change(&mut scenario);
    let mut recording = bench.record(&truth, &scenario);
    spoil(&mut recording);
    diagnosed(&bench, &known, &[&recording])
}

#[track_caller]
fn is_the_backlash(diagnosis: &Diagnosis) {
    assert_eq!(found(diagnosis), ["EXX backlash"]);
    let lost = &numbers(&diagnosis.findings[0], "lost_motion")[0];
    assert!(off(lost, 0.005) < FAR && (lost.value - 0.005).abs() < 0.001, "{lost:?}");
}

#[test]
fn missing_samples_change_nothing_and_are_counted() {
    let missing = Missing { rate: 0.05, blocks: 3, length: 4.0 };
    let diagnosis = with_backlash(|scenario| scenario.measurement.missing = missing, |_| {});
    is_the_backlash(&diagnosis);
    let summary = &diagnosis.recordings[0];
    assert!(summary.missing > summary.rows / 12, "{summary:?}");
    assert_eq!(summary.samples + summary.missing + summary.outliers, summary.rows);
}

#[test]
fn outliers_neither_hide_a_finding_nor_make_one() {
    let outliers = Some(Outliers { rate: 0.01, size: 0.05 });
    let diagnosis = with_backlash(|scenario| scenario.measurement.noise.outliers = outliers, |_| {});
    is_the_backlash(&diagnosis);
    let left_out = diagnosis.recordings[0].outliers;
    assert!((4..40).contains(&left_out), "{left_out}");
    for seed in 0..4 {
        let diagnosis = quiet(seed, Noise { outliers, ..Noise::white(0.001) }, true);
        assert_eq!((diagnosis.verdict, found(&diagnosis)), (Verdict::Adequate, vec![]), "{seed}");
    }
}

#[test]
fn missing_commands_cost_no_more_than_their_rows() {
    let diagnosis =
        with_backlash(|_| {}, |recording| recording.axes[0].command.as_mut().unwrap()[40..60].fill(f64::NAN));
    is_the_backlash(&diagnosis);
}

#[test]
fn without_named_runs_blocks_of_time_are_held_out() {
    let diagnosis = with_backlash(|scenario| scenario.holdout.clear(), |_| {});
    is_the_backlash(&diagnosis);
    assert!(diagnosis.after.holdout_rms.is_some());
    assert!(
        diagnosis.recordings[0].held_out.contains("blocks of time"),
        "{}",
        diagnosis.recordings[0].held_out
    );
}

#[test]
fn another_recording_can_be_held_out() {
    let bench = Bench::of("FX");
    let known = bench.calibration(STAGE);
    let truth = together(&known, &bench.calibration("{EXX: [{backlash: {lost_motion: 5 um}}]}"));
    let record = |truth, seed| bench.record(truth, &noisy(stage_path(), position("x"), 0.001, seed));
    let fitted = record(&truth, 1);
    // The instrument was set up anew: another zero.
    let mut same = record(&truth, 2);
    same.measured[0].as_mut().unwrap().iter_mut().for_each(|value| *value += 0.3);
    let diagnosis = with_holdout(&bench, &known, &[&fitted], Some(&same));
    is_the_backlash(&diagnosis);
    assert_eq!(diagnosis.recordings[1].held_out, "all of it");
    let evidence = &diagnosis.findings[0].evidence;
    assert!((evidence.with / 0.001 - 1.0).abs() < 0.1, "{evidence:?}");
    assert!((evidence.without / 0.001_f64.hypot(0.0025) - 1.0).abs() < 0.1, "{evidence:?}");
    // A machine that has none of it does not bear the finding out.
    let other = record(&known, 3);
    let diagnosis = with_holdout(&bench, &known, &[&fitted], Some(&other));
    assert!(diagnosis.findings.is_empty(), "{:?}", found(&diagnosis));
}

#[test]
fn shares_add_up_and_stand_in_order() {
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration(MILL);
    let truth =
        together(&known, &bench.calibration("{EXX: [{backlash: {lost_motion: 5 um}}], EC0Y: 80 urad}"));
    let diagnosis =
        diagnosed(&bench, &known, &[&bench.record(&truth, &noisy(mill_path(), position("xy"), 0.001, 9))]);
    assert_eq!(found(&diagnosis), ["EC0Y constant", "EXX backlash"]);
    let shares: Vec<f64> = diagnosis.findings.iter().map(|finding| finding.share).collect();
    // Variances: (80e-6 * 100 mm)^2 / 2 = 32 um^2 and 2.5^2 = 6.25 um^2, which are not correlated.
    assert!(
        (shares[0] - 32.0 / 38.25).abs() < 0.08 && (shares[0] + shares[1] - 1.0).abs() < 0.02,
        "{shares:?}"
    );
}

#[track_caller]
fn nothing_is_claimed(diagnosis: &Diagnosis, because: &str) {
    assert!(diagnosis.findings.is_empty() && diagnosis.unexplained.is_none());
    assert!(
        diagnosis.undecided.iter().any(|sentence| sentence.contains(because)),
        "{:?}",
        diagnosis.undecided
    );
    assert_eq!(diagnosis.recordings.len(), 1);
}

#[test]
fn recordings_that_tell_nothing_say_why() {
    let bench = Bench::of("FX");
    let known = bench.calibration(STAGE);
    let truth = together(&known, &bench.calibration("{EXX: [{backlash: {lost_motion: 60 um}}]}"));
    let record = |path: Path| bench.record(&truth, &noisy(path, position("x"), 0.001, 1));
    let short = record(path(line(0, 0.0, 45.0), 20.0, 2.0));
    assert_eq!(short.time.len(), 10);
    nothing_is_claimed(&diagnosed(&bench, &known, &[&short]), "can be fitted");
    let still = record(Path { runs: 3, ..path(Shape::Still { time: 30.0 }, 1.0, 5.0) });
    let diagnosis = diagnosed(&bench, &known, &[&still]);
    nothing_is_claimed(&diagnosis, "no axis moves");
    assert_eq!(diagnosis.verdict, Verdict::Adequate);
    let mut held = record(stage_path());
    held.holdout = Some(vec![1, 2, 3, 4]);
    nothing_is_claimed(&diagnosed(&bench, &known, &[&held]), "can be fitted");
    let mut fitted = record(stage_path());
    fitted.holdout = Some(Vec::new());
    nothing_is_claimed(&diagnosed(&bench, &known, &[&fitted]), "hold out");
    let mut empty = record(stage_path());
    empty.measured = [None, None, None];
    nothing_is_claimed(&diagnosed(&bench, &known, &[&empty]), "no observation");
    let mut blank = record(stage_path());
    blank.measured[0].as_mut().unwrap().fill(f64::NAN);
    nothing_is_claimed(&diagnosed(&bench, &known, &[&blank]), "no observation");
    let none = diagnosed(&bench, &known, &[]);
    assert!(none.findings.is_empty() && !none.undecided.is_empty());
    // Without any position of the axis there is still a diagnosis.
    let mut nowhere = record(stage_path());
    nowhere.axes[0].command = None;
    let undecided = diagnosed(&bench, &known, &[&nowhere]).undecided;
    assert!(undecided.iter().any(|sentence| sentence.contains("no axis moves")), "{undecided:?}");
}

#[test]
fn what_stands_still_and_what_runs_once_is_said_to_be_undecided() {
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration(MILL);
    let once = Path { runs: 1, ..mill_path() };
    let recording = bench.record(&known, &noisy(once, position("xy"), 0.001, 2));
    let undecided = diagnosed(&bench, &known, &[&recording]).undecided;
    assert!(undecided.iter().any(|sentence| sentence.contains("motion of Z")), "{undecided:?}");
    assert!(undecided.iter().any(|sentence| sentence.contains("one run")), "{undecided:?}");
    assert!(undecided.iter().all(|sentence| sentence.ends_with('.')));
}

#[test]
fn a_wave_is_found_under_what_has_no_name() {
    let bench = Bench::of("FX");
    let known = bench.calibration(STAGE);
    let truth = together(
        &known,
        &bench.calibration("{EXX: [{cyclic: {period: 9 mm, amplitude: 2 um, phase: 40 deg}}]}"),
    );
    let mut recording = bench.record(&truth, &noisy(stage_path(), position("x"), 0.000_3, 11));
    // Ten times as large, and faster each time: neither a wave in time nor one along the axis.
    let last = recording.time.last().copied().unwrap();
    let time = recording.time.clone();
    let spoilt = |value: &mut f64, time: f64| *value += 0.02 * (40.0 * (time / last).powi(2)).sin();
    for axis in &mut recording.axes {
        let measured = axis.measured.iter_mut().flatten();
        measured.zip(&time).for_each(|(value, time)| spoilt(value, *time));
    }
    let diagnosis = diagnosed(&bench, &known, &[&recording]);
    let waves: Vec<_> = diagnosis.findings.iter().filter(|finding| finding.term == "cyclic").collect();
    let [wave] = waves.as_slice() else { panic!("{:?}", found(&diagnosis)) };
    assert!((numbers(wave, "period")[0].value - 9.0).abs() < 0.05, "{wave:?}");
    assert!((numbers(wave, "amplitude")[0].value - 0.002).abs() < 0.000_6, "{wave:?}");
    assert_ne!(diagnosis.verdict, Verdict::Adequate);
}

#[test]
fn a_walk_of_the_sensor_is_nothing_of_the_machine() {
    let bench = Bench::of("FX");
    let known = bench.calibration(STAGE);
    let there_and_back = path(line(0, 0.0, 50.0), 0.05, 1.0);
    let scenario = noisy(there_and_back, position("x"), 0.000_000_5, 21);
    for seed in 1..=20 {
        let mut recording = bench.record(&known, &scenario);
        let steps = normals(seed, recording.time.len());
        let walk = steps.iter().scan(0.0, |place, step| {
            *place += 0.001 * step;
            Some(*place)
        });
        let walk: Vec<f64> = walk.collect();
        for axis in &mut recording.axes {
            let measured = axis.measured.iter_mut().flatten();
            measured.zip(&walk).for_each(|(value, walk)| *value += walk);
            // One pass alone: the way back is not read.
            let back = steps.len() / 2;
            axis.measured.iter_mut().for_each(|measured| measured[back..].fill(f64::NAN));
        }
        let diagnosis = diagnosed(&bench, &known, &[&recording]);
        assert!(diagnosis.findings.is_empty(), "{seed}: {:?}", found(&diagnosis));
        assert_eq!(diagnosis.recordings[0].outliers, 0, "{seed}");
    }
}
