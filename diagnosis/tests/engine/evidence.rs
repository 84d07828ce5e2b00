//! Evidence: small recordings that are easily misread. Displays, few stations, lengths alone, equal loops, units that cannot be.
//!
//! In: recordings made here, by the exact machine or by hand. Out: what is claimed of them, and what is not.

use abbe_diagnosis::diagnosis::{Diagnosis, Evidence, Verdict};
use simulation::{Instrument as Reads, Path};

use crate::common::*;
use crate::recording::{Instrument, Line, Recording};
use crate::testing::*;

fn alone(bench: &Bench, recordings: &[&Recording]) -> Diagnosis {
    diagnosed(bench, &bench.calibration("{}"), recordings)
}

/// A length that calipers measure five times, from one corner of a square of 100 mm to another: zero, then how much too long it is.
fn length(from: [f64; 2], to: [f64; 2], excess: f64, seed: u64) -> Recording {
    let noise = normals(seed, 5);
    let columns = |which: usize| -> Vec<f64> { (0..5).flat_map(|_| [from[which], to[which]]).collect() };
    let [x, y] = [columns(0), columns(1)];
    let mut recording =
        programmed(&(0..10_i32).map(|row| 10.0 * f64::from(row)).collect::<Vec<f64>>(), &[x, y]);
    recording.run = (1..=5).flat_map(|run| [run, run]).collect();
    let step = [to[0] - from[0], to[1] - from[1]];
    let distance = step[0].hypot(step[1]);
    recording.instrument =
        Instrument::Linear(Line { axis: None, direction: [step[0] / distance, step[1] / distance, 0.0] });
    recording.deviation = Some(noise.iter().flat_map(|noise| [0.0, excess + 0.005 * noise]).collect());
    recording
}

#[test]
fn lengths_of_a_square_show_its_squareness_and_its_scale_and_no_impossible_play() {
    // A plate carried by X on Y, both before the bed: what is too short in Y, and not square.
    let bench = Bench::of("XYF");
    for (scale, square) in [(-3.8e-3, 3.5e-3), (2.5e-3, -1.5e-3), (-2e-3, -0.8e-3)] {
        // The line of Y turns about Z: the tool goes by -angle times y along X.
        let excess = |dx: f64, dy: f64| {
            let moved = [-square * dy, scale * dy];
            (dx * moved[0] + dy * moved[1]) / dx.hypot(dy)
        };
        let lengths = [
            length([0.0, 0.0], [100.0, 100.0], excess(100.0, 100.0), 1),
            length([100.0, 0.0], [0.0, 100.0], excess(-100.0, 100.0), 2),
            length([0.0, 0.0], [100.0, 0.0], excess(100.0, 0.0), 3),
        ];
        let lengths: Vec<&Recording> = lengths.iter().collect();
        let diagnosis = alone(&bench, &lengths);
        let mut names = found(&diagnosis);
        names.sort();
        assert_eq!(names, ["EC0Y constant", "EYY polynomial"], "{scale} {square}");
        let angle = &numbers(called(&diagnosis, "EC0Y constant"), "value")[0];
        let slope = &numbers(called(&diagnosis, "EYY polynomial"), "coefficients")[1];
        assert!((angle.value.abs() - square.abs()).abs() < 1.5e-4, "{angle:?}");
        assert!((slope.value - scale).abs() < 1.5e-4, "{slope:?}");
    }
}

/// A recording whose readings and commands were kept to a step.
fn rounded(recording: Recording, step: f64) -> Recording {
    rounded_to(recording, |_| step)
}

/// The same, each position to a step of its own.
fn rounded_to(mut recording: Recording, step: impl Fn(f64) -> f64) -> Recording {
    let shown = |value: f64| (value / step(value)).round() * step(value);
    let keep = |values: &mut Vec<f64>| values.iter_mut().for_each(|value| *value = shown(*value));
    for axis in &mut recording.axes {
        axis.command.iter_mut().chain(&mut axis.actual).for_each(keep);
    }
    recording.measured.iter_mut().flatten().for_each(keep);
    recording
}

#[test]
fn the_beat_of_a_display_is_no_wave_of_the_machine() {
    let bench = Bench::of("FX");
    let truth = bench.calibration("{EXX: [{lag: {gain: 100 1/s}}]}");
    for (from, feed, step) in [(60.0, 6.1, 0.1), (10.3, 7.3, 0.1), (0.0, 3.07, 0.05)] {
        let strokes = Path { runs: 4, pause: 0.1, ..path(line(0, from, from + 80.0), feed, 10.0) };
        let recording = rounded(bench.record(&truth, &scenario(strokes, position("x"))), step);
        let diagnosis = alone(&bench, &[&recording]);
        let names = found(&diagnosis);
        assert_eq!(names.len(), 1, "{names:?}");
        // At one speed a loop, a clock and play are one.
        assert!(["EXX lag", "EXX backlash"].contains(&&*names[0]), "{names:?}");
    }
}

/// Three significant digits show 99.9 mm, and then 100 mm.
#[test]
fn what_three_digits_show_coarser_neither_hides_a_loop_nor_bends_it() {
    let bench = Bench::of("FX");
    let truth = bench.calibration("{EXX: [{lag: {gain: 100 1/s}}]}");
    let three_digits = |value: f64| if value.abs() < 99.95 { 0.1 } else { 1.0 };
    let shown = |feed: f64| {
        let strokes = Path { runs: 3, pause: 0.5, ..path(line(0, 52.3, 123.7), feed, 10.0) };
        rounded_to(bench.record(&truth, &scenario(strokes, position("x"))), three_digits)
    };
    let recordings = [31.3, 17.9, 43.7].map(shown);
    let diagnosis = alone(&bench, &recordings.each_ref());
    assert_eq!(found(&diagnosis), ["EXX lag"], "{diagnosis:#?}");
    let gain = &numbers(&diagnosis.findings[0], "gain")[0];
    assert!(gain.ci95.0 < 100.0 && 100.0 < gain.ci95.1 && gain.ci95.1 - gain.ci95.0 < 20.0, "{gain:?}");
    let coarse = "From 100 mm on it is displayed to 1 mm only, and below to 0.1 mm.";
    assert_eq!(diagnosis.undecided.iter().filter(|sentence| sentence.ends_with(coarse)).count(), 3);
}

/// Two significant digits show errors of 0.098 mm, and then 0.10 mm: what is written coarser is the large error itself.
#[test]
fn large_errors_that_are_written_with_few_digits_are_not_left_out() {
    let bench = Bench::of("FX");
    let there: Vec<f64> = (0..=20_i32).map(|station| 25.0 * f64::from(station)).collect();
    let x: Vec<f64> = (0..3).flat_map(|_| there.iter().chain(there.iter().rev()).copied()).collect();
    // A scale of 3e-4, beside noise of 5 um: less, and the rounding would come back at each station.
    let error = |x: f64| 3e-4 * x;
    let noise = normals(5, x.len());
    let two_digits = |value: f64| {
        let step = 10f64.powf(value.abs().max(1e-9).log10().floor() - 1.0);
        (value / step).round() * step
    };
    let read = x.iter().zip(noise).map(|(x, noise)| two_digits(error(*x) + 5e-3 * noise));
    let read: Vec<f64> = read.collect();
    let time: Vec<f64> = (0..126_i32).map(|row| 5.0 * f64::from(row)).collect();
    let mut recording = programmed(&time, &[x]);
    recording.instrument = Instrument::Linear(Line { axis: Some(0), direction: [1.0, 0.0, 0.0] });
    recording.deviation = Some(read);
    recording.run = (0..126).map(|row| 1 + row / 42).collect();
    let diagnosis = alone(&bench, &[&recording]);
    assert_eq!(found(&diagnosis), ["EXX polynomial"], "{diagnosis:#?}");
    assert!(diagnosis.undecided.iter().all(|sentence| !sentence.contains("is displayed to")));
}

#[test]
fn a_station_that_is_off_in_every_approach_is_a_place() {
    let bench = Bench::of("FX");
    for (bad, seed) in [(3, 1), (6, 2), (8, 3)] {
        let there: Vec<f64> = (0..11_i32).map(|station| 50.0 * f64::from(station)).collect();
        let mut x: Vec<f64> = Vec::new();
        for _ in 0..3 {
            x.extend(there.iter().chain([525.0].iter()).chain(there.iter().rev()).chain([-25.0].iter()));
        }
        let noise = normals(seed, x.len());
        let read = x.iter().zip(noise).map(|(x, noise)| {
            let overrun = !(0.0..=500.0).contains(x);
            let off = if (x - there[bad]).abs() < 1.0 { 0.01 } else { 0.0 };
            if overrun { f64::NAN } else { x + off + 1.5e-4 * noise }
        });
        let read: Vec<f64> = read.collect();
        let time: Vec<f64> = (0..72_i32).map(|row| 5.0 * f64::from(row)).collect();
        let mut recording = programmed(&time, &[x]);
        recording.measured[0] = Some(read);
        recording.run = (0..72).map(|row| 1 + row / 24).collect();
        let diagnosis = alone(&bench, &[&recording]);
        assert_eq!(found(&diagnosis), ["EXX table"], "{bad}");
        let values = numbers(&diagnosis.findings[0], "values");
        let highest = values.iter().map(|one| one.value).fold(f64::NEG_INFINITY, f64::max);
        assert!((highest - 0.01).abs() < 5e-4, "{values:?}");
        assert!(values.iter().all(|one| one.value.abs() < 0.011), "{values:?}");
    }
}

/// X goes five times to nine stations and back, and is read at each of them for 2 s, and 2 s on the way, on which its command is not
/// known; what is off follows a wave of 3.3 mm.
fn stations_with_an_unknown_way(seed: u64) -> Recording {
    let stations: Vec<f64> = (0..9_i32).map(|station| 5.0 * f64::from(station)).collect();
    let once: Vec<f64> = stations.iter().chain(stations.iter().rev()).copied().collect();
    let off = |x: f64| 0.01 * (std::f64::consts::TAU * x / 3.3 + 0.4).sin();
    let (mut x, mut read, mut run) = (Vec::new(), Vec::new(), Vec::new());
    for cycle in 1..=5 {
        for (number, station) in once.iter().enumerate() {
            let next = once.get(number + 1).unwrap_or(station);
            for row in 0..40_i32 {
                let way = f64::from((row - 19).max(0)) / 20.0;
                let at = station + way * (next - station);
                x.push(if row < 20 { at } else { f64::NAN });
                read.push(at + off(at));
                run.push(cycle);
            }
        }
    }
    let noise = normals(seed, x.len());
    read.iter_mut().zip(noise).for_each(|(read, noise)| *read += 2e-4 * noise);
    let time: Vec<f64> = (0..x.len()).map(|row| 0.1 * f64::from(u32::try_from(row).unwrap())).collect();
    let mut recording = programmed(&time, &[x]);
    recording.measured[0] = Some(read);
    recording.run = run;
    recording
}

#[test]
fn an_axis_that_is_known_at_stations_alone_has_a_table_and_no_waves() {
    let bench = Bench::of("FX");
    for seed in 1..=3 {
        let diagnosis = alone(&bench, &[&stations_with_an_unknown_way(seed)]);
        assert_eq!(found(&diagnosis), ["EXX table"], "{seed}");
        assert!(diagnosis.after.rms < 2.2e-4, "{:?}", diagnosis.after);
    }
}

#[test]
fn equal_loops_are_told_from_the_length_of_the_bar_by_how_a_circle_starts() {
    let bench = Bench::of("XFY");
    let truth = bench.calibration("{EXX: [{lag: {gain: 30 1/s}}], EYY: [{lag: {gain: 30 1/s}}]}");
    for seed in 0..3 {
        let circles = Path { runs: 3, acceleration: Some(300.0), ..path(circle(80.0), 40.0, 100.0) };
        let recording = bench.record(&truth, &noisy(circles, ballbar([0.0; 3]), 3e-4, seed));
        let diagnosis = alone(&bench, &[&recording]);
        let mut names = found(&diagnosis);
        names.sort();
        assert_eq!(names, ["EXX lag", "EYY lag"], "{seed}");
        for finding in &diagnosis.findings {
            let gain = &numbers(finding, "gain")[0];
            assert!(off(gain, 30.0) < FAR, "{seed}: {gain:?}");
        }
    }
}

#[test]
fn units_that_make_an_axis_faster_or_longer_than_any_are_told_before_anything_is_found() {
    let bench = Bench::of("FX");
    let truth = bench.calibration("{EXX: [{backlash: {lost_motion: 5 um}}]}");
    let strokes = Path { runs: 3, ..path(line(0, 0.0, 300.0), 40.0, 50.0) };
    let recording = bench.record(&truth, &noisy(strokes, position("x"), 5e-4, 4));
    assert_eq!(found(&alone(&bench, &[&recording])), ["EXX backlash"]);
    // Milliseconds that were read as seconds would be slow; seconds read as milliseconds are too fast.
    let mut hurried = recording.clone();
    hurried.time.iter_mut().for_each(|time| *time *= 1e-3);
    let mut stretched = recording;
    stretched.axes[0].command.iter_mut().flatten().for_each(|place| *place *= 1e3);
    stretched.measured[0].iter_mut().flatten().for_each(|place| *place *= 1e3);
    for (recording, words) in [(hurried, "moves at"), (stretched, "goes 300 m")] {
        let diagnosis = alone(&bench, &[&recording]);
        assert_eq!(diagnosis.verdict, Verdict::Undecided);
        assert!(diagnosis.findings.is_empty());
        assert!(
            diagnosis.undecided.iter().any(|sentence| sentence.contains(words)),
            "{:?}",
            diagnosis.undecided
        );
    }
}

#[test]
fn waves_of_like_size_along_one_axis_are_all_told() {
    // A screw, half its pitch, a motor and a gear: none of them is half of what all of them are.
    let bench = Bench::of("FX");
    let periods = [20.0, 10.0, 6.4, 3.3];
    let terms: Vec<String> = periods
        .iter()
        .enumerate()
        .map(|(number, period)| {
            format!("{{cyclic: {{period: {period} mm, amplitude: 3 um, phase: {number} rad}}}}")
        })
        .collect();
    let truth = bench.calibration(&format!("{{EXX: [{}]}}", terms.join(", ")));
    for seed in 0..3 {
        let strokes = Path { runs: 3, ..path(line(0, 0.0, 120.0), 20.0, 50.0) };
        let recording = bench.record(&truth, &noisy(strokes, position("x"), 1e-3, seed));
        let diagnosis = alone(&bench, &[&recording]);
        assert_eq!(found(&diagnosis), ["EXX cyclic"; 4], "{seed}");
        let mut told: Vec<f64> =
            diagnosis.findings.iter().map(|finding| numbers(finding, "period")[0].value).collect();
        told.sort_by(|a, b| b.total_cmp(a));
        for (told, period) in told.iter().zip(periods) {
            assert!((told / period - 1.0).abs() < 5e-3, "{seed}: {told} {period}");
        }
    }
}

/// What an angle meter does not see is found beside it, and what it alone sees is found too, whichever recording comes first.
#[test]
fn lengths_and_angles_have_sizes_of_their_own() {
    let bench = Bench::of("fxyz-mill");
    let truth = bench.calibration(
        "{EXX: [{cyclic: {axis: X, period: 12 mm, amplitude: 4 um, phase: 40 deg}}], \
          ECX: [{cyclic: {axis: X, period: 70 mm, amplitude: 20 urad, phase: 0 deg}}]}",
    );
    let strokes = |at: f64| Path {
        at: vec![vec![], vec![at], vec![-40.0]],
        runs: 4,
        ..path(line(0, 40.0, 300.0), 20.0, 8.0)
    };
    let laser = bench.record(&truth, &noisy(strokes(150.0), position("x"), 0.001, 3));
    let about_z = Reads::Angular { axis: Some(0), about: [0.0, 0.0, 1.0] };
    let level = bench.record(&truth, &noisy(strokes(40.0), about_z, 1e-6, 4));
    for recordings in [[&laser, &level], [&level, &laser]] {
        let diagnosis = alone(&bench, &recordings);
        let mut told = found(&diagnosis);
        told.sort();
        assert_eq!(told, ["ECX cyclic", "EXX cyclic"], "{:?}", diagnosis.verdict);
        let [wave, yaw] = ["EXX cyclic", "ECX cyclic"].map(|name| called(&diagnosis, name));
        assert_eq!((wave.evidence.unit, yaw.evidence.unit), ("mm", "rad"));
        // What each takes is the rms of a sine of 4 um, or of 20 urad.
        for (finding, amplitude) in [(wave, 0.004), (yaw, 2e-5)] {
            let Evidence { with, without, .. } = finding.evidence;
            let taken = (without * without - with * with).sqrt() * 2.0_f64.sqrt();
            assert!((taken / amplitude - 1.0).abs() < 0.05, "{:?}", finding.evidence);
        }
    }
}

/// The unit of what no term explains is that of the instrument that sees it.
#[test]
fn what_no_term_explains_is_told_in_the_unit_of_its_instrument() {
    let bench = Bench::of("fxyz-mill");
    let nothing = bench.calibration("{}");
    let strokes = || Path { runs: 4, ..path(line(0, 40.0, 300.0), 20.0, 8.0) };
    let laser = bench.record(&nothing, &noisy(strokes(), position("x"), 0.001, 5));
    let about_z = Reads::Angular { axis: Some(0), about: [0.0, 0.0, 1.0] };
    let mut level = bench.record(&nothing, &noisy(strokes(), about_z, 1e-6, 6));
    // A pitch that rises all the time: no vibration, no drift.
    let of_time = |time: &f64| 2e-5 * (time / 4.0).powf(1.5).sin();
    let rising: Vec<f64> = level.time.iter().map(of_time).collect();
    let readings = level.deviation.iter_mut().flatten().zip(&rising);
    readings.for_each(|(reading, more)| *reading += more);
    let diagnosis = alone(&bench, &[&laser, &level]);
    assert_eq!(diagnosis.verdict, Verdict::Unexplained, "{:?}", found(&diagnosis));
    let unexplained = diagnosis.unexplained.unwrap();
    assert_eq!((unexplained.unit, unexplained.direction.as_str()), ("rad", "deviation"));
    assert!((unexplained.rms - 2e-5 / 2.0_f64.sqrt()).abs() < 2e-6, "{unexplained:?}");
}
