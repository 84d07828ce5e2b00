//! Set-ups that do not fit the recording: said before anything is diagnosed, or beside it.
//!
//! In: recordings made here. Out: the verdict, and the sentence that says what is wrong or open.

use abbe_diagnosis::diagnosis::{Diagnosis, Verdict};
use simulation::Path;

use crate::common::*;
use crate::recording::{Instrument, Line, Recording};
use crate::testing::*;

/// Several runs over stations, forward and backward, and the error at each station: 20 ppm, a backlash of 8 um, and noise of 1 um.
fn stations(targets: &[f64], runs: i64) -> (Recording, Vec<f64>) {
    let both_ways = || targets.iter().map(|at| (*at, -1.0)).chain(targets.iter().rev().map(|at| (*at, 1.0)));
    let of_runs: Vec<(f64, f64)> = (0..runs).flat_map(|_| both_ways()).collect();
    let command: Vec<f64> = of_runs.iter().map(|(at, _)| *at).collect();
    let noise = normals(31, command.len());
    let error = of_runs.iter().zip(noise).map(|((at, back), noise)| 2e-5 * at + 0.004 * back + 0.001 * noise);
    // Displayed to 0.1 um.
    let error: Vec<f64> = error.map(|error| (error * 1e4).round() / 1e4).collect();
    let time: Vec<f64> = (0..command.len()).map(|row| 5.0 * row as f64).collect();
    let mut recording = programmed(&time, &[command]);
    recording.run = (1..=runs).flat_map(|run| vec![run; 2 * targets.len()]).collect();
    (recording, error)
}

fn of_stage(recording: &Recording) -> Diagnosis {
    let bench = Bench::of("FX");
    diagnosed(&bench, &bench.calibration("{}"), &[recording])
}

#[test]
fn a_reading_that_is_exchanged_with_its_command_decides_nothing() {
    let steps = |step: f64, from: f64| -> Vec<f64> { (0..17).map(|n| from + step * f64::from(n)).collect() };
    for targets in [steps(25.0, 0.0), steps(12.5, 0.0), steps(25.0, 0.25), steps(10.0, 3.0)] {
        let (mut recording, error) = stations(&targets, 4);
        let command = recording.axes[0].command.clone().unwrap();
        let reading: Vec<f64> = command.iter().zip(&error).map(|(command, error)| command + error).collect();
        recording.instrument = Instrument::Position;
        recording.measured[0] = Some(reading.clone());
        let right = of_stage(&recording);
        assert_eq!(right.undecidable, None);
        let mut names = found(&right);
        names.sort();
        assert_eq!(names, ["EXX backlash", "EXX polynomial"]);
        recording.axes[0].command = Some(reading);
        recording.measured[0] = Some(command);
        let exchanged = of_stage(&recording);
        assert_eq!((exchanged.verdict, exchanged.findings.len()), (Verdict::Undecided, 0));
        let because = exchanged.undecidable.unwrap();
        assert!(because.contains("`measured.x`") && because.contains("seem to be exchanged"), "{because}");
    }
}

#[test]
fn a_display_is_no_exchange() {
    let bench = Bench::of("FX");
    let nothing = bench.calibration("{}");
    // A display of 0.01 mm beside a command with all its digits.
    let strokes = Path { runs: 3, ..path(line(0, 1.0, 97.3), 7.3, 9.0) };
    let mut recording = bench.record(&nothing, &noisy(strokes, position("x"), 0.0005, 3));
    for reading in recording.measured[0].iter_mut().flatten() {
        *reading = (*reading * 100.0).round() / 100.0;
    }
    assert_eq!(of_stage(&recording).undecidable, None);
    // Targets at a regular pitch lie alike in the steps of a display, and one that stands has one reading.
    let (mut pitched, _) = stations(&[3.137, 28.137, 53.137, 78.137, 103.137, 128.137], 4);
    pitched.instrument = Instrument::Position;
    let shown = |at: &f64| (at * 10.0).round() / 10.0;
    pitched.measured[0] = pitched.axes[0].command.as_ref().map(|command| command.iter().map(shown).collect());
    assert_eq!(of_stage(&pitched).undecidable, None);
    // Nor is it one where the first command is missing.
    pitched.axes[0].command.as_mut().unwrap()[0] = f64::NAN;
    assert_eq!(of_stage(&pitched).undecidable, None);
    let mill = Bench::of("xyfz-mill");
    let beside =
        Path { at: vec![vec![], vec![172.0004], vec![]], runs: 3, ..path(line(0, 1.0, 97.3), 7.3, 9.0) };
    let mut beside = mill.record(&mill.calibration("{}"), &noisy(beside, position("xy"), 0.0005, 4));
    beside.measured[1].iter_mut().flatten().for_each(|reading| *reading = shown(reading));
    assert_eq!(diagnosed(&mill, &mill.calibration("{}"), &[&beside]).undecidable, None);
    // Targets that a coarse display shows as they were commanded.
    let (mut recording, _) = stations(&[0.0, 25.0, 50.0, 75.0, 100.0, 125.0], 4);
    recording.instrument = Instrument::Position;
    recording.measured[0] = recording.axes[0].command.clone();
    assert_eq!(of_stage(&recording).undecidable, None);
}

/// A laser whose set-up names an axis and a direction.
fn laser(axis: usize, direction: [f64; 3]) -> Instrument {
    Instrument::Linear(Line { axis: Some(axis), direction })
}

#[test]
fn an_instrument_on_an_axis_that_stands_while_another_moves_decides_nothing() {
    let bench = Bench::of("xyfz-mill");
    let (mut recording, error) = stations(&[0.0, 50.0, 100.0, 150.0, 200.0], 4);
    let still = vec![0.0; error.len()];
    recording.axes =
        programmed(&recording.time, &[recording.axes[0].command.clone().unwrap(), still.clone(), still]).axes;
    recording.deviation = Some(error);
    let diagnosed = |recording: &Recording| diagnosed(&bench, &bench.calibration("{}"), &[recording]);
    recording.instrument = laser(1, [0.0, 1.0, 0.0]);
    let wrong = diagnosed(&recording);
    assert_eq!((wrong.verdict, wrong.findings.len()), (Verdict::Undecided, 0));
    let because = wrong.undecidable.unwrap();
    assert!(because.contains("names Y") && because.contains("only X moves"), "{because}");
    recording.instrument = laser(0, [1.0, 0.0, 0.0]);
    assert_eq!(diagnosed(&recording).undecidable, None);
    // What is read along Y while X moves is its straightness.
    recording.instrument = Instrument::Straightness(Line { axis: Some(0), direction: [0.0, 1.0, 0.0] });
    assert_eq!(diagnosed(&recording).undecidable, None);
}

#[test]
fn a_recording_that_could_not_show_anything_is_not_adequate() {
    let (mut recording, error) = stations(&[0.0, 50.0, 100.0, 150.0, 200.0], 4);
    recording.instrument = laser(0, [1.0, 0.0, 0.0]);
    recording.deviation = Some(vec![0.0; error.len()]);
    let dead = of_stage(&recording);
    assert_eq!(dead.verdict, Verdict::Undecided);
    assert!(dead.undecidable.unwrap().contains("`deviation` is 0 in all rows"));
    recording.deviation = Some(normals(7, error.len()).iter().map(|noise| 0.001 * noise).collect());
    assert_eq!(of_stage(&recording).verdict, Verdict::Adequate);
    recording.axes[0].command = None;
    let blind = of_stage(&recording);
    assert_eq!(blind.verdict, Verdict::Undecided);
    assert!(blind.undecidable.unwrap().contains("no recording has the position of an axis"));
}

#[test]
fn errors_larger_than_those_of_machine_tools_make_a_unit_doubtful() {
    let targets: Vec<f64> = (0..17).map(|n| 25.0 * f64::from(n)).collect();
    let (mut recording, error) = stations(&targets, 4);
    recording.instrument = laser(0, [1.0, 0.0, 0.0]);
    recording.deviation = Some(error.clone());
    let is_doubtful = |diagnosis: &Diagnosis| {
        diagnosis.undecided.iter().any(|sentence| sentence.contains("unit of the column"))
    };
    assert!(!is_doubtful(&of_stage(&recording)));
    // Micrometres taken for millimetres.
    recording.deviation = Some(error.iter().map(|error| 1e3 * error).collect());
    assert!(is_doubtful(&of_stage(&recording)));
}

/// Four heights, a run each and one of them held out: what a wave of Z makes of them may be four zeros of the instrument.
#[test]
fn runs_that_differ_at_different_places_are_not_adequate() {
    let bench = Bench::of("xyfz-mill");
    let nothing = bench.calibration("{}");
    let at_height = |z: f64, seed: u64| {
        let lines = Path { at: vec![vec![], vec![150.0], vec![z]], ..path(line(0, 20.0, 400.0), 25.0, 8.0) };
        bench.record(&nothing, &noisy(lines, position("xyz"), 0.0005, seed))
    };
    let mut all = at_height(-20.0, 1);
    for (run, z, more) in [(2, -41.3, 0.009), (3, -63.9, -0.007), (4, -88.0, 0.008)] {
        let next = at_height(z, run);
        let begin = all.time.last().unwrap() + 60.0;
        all.time.extend(next.time.iter().map(|time| begin + time));
        all.run.extend(next.time.iter().map(|_| i64::try_from(run).unwrap()));
        for (own, next) in all.axes.iter_mut().zip(next.axes) {
            own.command.as_mut().unwrap().extend(next.command.unwrap());
        }
        for (direction, (own, next)) in all.measured.iter_mut().zip(next.measured).enumerate() {
            let more = if direction == 2 { more } else { 0.0 };
            own.as_mut().unwrap().extend(next.unwrap().iter().map(|value| value + more));
        }
    }
    all.holdout = Some(vec![2]);
    let diagnosis = diagnosed(&bench, &nothing, &[&all]);
    assert_eq!((diagnosis.verdict, found(&diagnosis)), (Verdict::Undecided, Vec::new()));
    let because = diagnosis.undecidable.unwrap();
    assert!(because.contains("different places of Z") && because.contains("measured.z"), "{because}");
    assert!(diagnosis.after.rms < 0.001 && diagnosis.before.rms > 0.002, "{:?}", diagnosis.before);
}
