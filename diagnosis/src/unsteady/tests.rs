//! The unsteady against signals of known kind: what no sensor does is told from what sensors do, and named.

use std::f64::consts::{PI, TAU};

use simulation::noise::{Correlated, Noise as Drawn, Source, Walk};

use super::*;
use crate::candidates;
use crate::conditions::Tries;
use crate::course::courses;
use crate::fit;
use crate::kinship;
use crate::model::Model;
use crate::noise::Noise;
use crate::recording::Recording;
use crate::side::Side;
use crate::terms::Setting;
use crate::testing::{Bench, line, noisy, normals, path, position};
use crate::travel;
use crate::weights::{Outliers, Weights};

/// The seeds every kind of noise is tried with.
const SEEDS: std::ops::Range<u64> = 0..20;
/// The step of the signals, s, and their rows.
const STEP: f64 = 0.05;
const ROWS: usize = 1200;

fn machine(motion: usize, shape: Shape, coefficients: &[f64]) -> Fitted {
    let place = Place::Motion { motion, side: Side::After };
    Fitted { effect: Effect { place, shape }, coefficients: coefficients.to_vec() }
}

fn vibration(motion: usize, frequency: f64, coefficients: [f64; 2]) -> Fitted {
    machine(motion, Shape::Vibration { frequency }, &coefficients)
}

fn zero(channel: usize) -> Fitted {
    Fitted { effect: Effect::setting(0, Setting::Offset { channel }), coefficients: vec![0.0] }
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / crate::number(values.len())).sqrt()
}

#[test]
fn lines_that_crowd_become_a_band_with_their_strength_together() {
    let crowd =
        [vibration(2, 30.3, [1e-3, 0.0]), vibration(2, 30.0, [0.0, -2e-3]), vibration(2, 30.5, [2e-3, 1e-3])];
    let others = [
        zero(0),
        machine(2, Shape::Backlash { axis: 0, wind_up: 0.0 }, &[5e-3]),
        // Two are two, and what another motion does is its own.
        vibration(2, 80.0, [1e-3, 0.0]),
        vibration(2, 80.5, [1e-3, 0.0]),
        vibration(1, 30.2, [3e-3, 0.0]),
        // More than 2 % away.
        vibration(2, 32.0, [4e-3, 0.0]),
    ];
    let mut model = Model::default();
    model.effects.extend(others[..3].iter().cloned());
    model.effects.push(crowd[0].clone());
    model.effects.push(others[3].clone());
    model.effects.push(crowd[1].clone());
    model.effects.extend(others[4..].iter().cloned());
    model.effects.push(crowd[2].clone());
    let mut model = model.with_settings(1);
    let bands = take_bands(&mut model);
    assert_eq!(model.effects, others);
    let [band] = bands.as_slice() else { panic!("{bands:?}") };
    assert_eq!((band.motion, band.from, band.to), (2, 30.0, 30.5));
    assert!(crowd.iter().all(|line| band.has(&line.effect)));
    assert!(others.iter().all(|other| !band.has(&other.effect)));
    // Over 10 s all three lines have whole periods.
    let value = |row: u32| -> f64 {
        let time = 1e-3 * f64::from(row);
        let of = |line: &Fitted| {
            let (sine, cosine) = (TAU * frequency(&line.effect).unwrap() * time).sin_cos();
            line.coefficients[0] * sine + line.coefficients[1] * cosine
        };
        crowd.iter().map(of).sum()
    };
    let signal: Vec<f64> = (0..10_000).map(value).collect();
    assert!((band.rms / rms(&signal) - 1.0).abs() < 1e-6, "{} {}", band.rms, rms(&signal));
}

#[test]
fn lines_need_not_be_near_to_each_other_but_to_one_of_them() {
    let of = |frequency: f64| vibration(0, frequency, [1e-3, 0.0]);
    // From the lowest to the highest it is 3 %.
    let mut model = Model::of([of(50.0), of(51.5), of(50.7)]);
    let bands = take_bands(&mut model);
    assert_eq!((bands[0].from, bands[0].to), (50.0, 51.5));
    assert!(model.effects.is_empty());
    // Neighbours, none of which has both of the others near.
    let mut model = Model::of([of(50.0), of(52.0), of(54.0)]);
    assert!(take_bands(&mut model).is_empty());
    assert_eq!(model.effects.len(), 3);
}

#[test]
fn every_motion_and_every_crowd_has_a_band_of_its_own() {
    let mut model = Model::default();
    for (motion, center) in [(0, 20.0), (0, 90.0), (3, 20.0)] {
        model.effects.extend([0.0, 0.05, 0.1].map(|off| vibration(motion, center + off, [1e-3, 0.0])));
    }
    let mut bands: Vec<(usize, f64, f64)> =
        take_bands(&mut model).iter().map(|band| (band.motion, band.from, band.to)).collect();
    bands.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    assert_eq!(bands, [(0, 20.0, 20.1), (0, 90.0, 90.1), (3, 20.0, 20.1)]);
    assert!(model.effects.is_empty());
    assert!(take_bands(&mut model).is_empty());
}

fn times(rows: usize) -> Vec<f64> {
    (0..rows).map(|row| STEP * crate::number(row)).collect()
}

/// Noise of a sensor, in um.
fn drawn(noise: Drawn, time: &[f64], seed: u64) -> Vec<f64> {
    let mut values = vec![0.0; time.len()];
    noise.apply(time, &mut values, &mut Source::new(seed, "unsteady"));
    values
}

fn wandering(time_constant: f64) -> Drawn {
    Drawn { correlated: Some(Correlated { sigma: 1.0, time_constant }), ..Drawn::default() }
}

#[test]
fn no_noise_of_a_sensor_keeps_on() {
    let walk = Drawn { walk: Some(Walk { sigma: 1.0, after: 1.0 }), ..Drawn::default() };
    let span = STEP * crate::number(ROWS);
    let slow = [STEP, 0.2, 1.0, 5.0, 20.0, span].map(wandering);
    let mixed = Drawn { white: 0.3, ..wandering(2.0) };
    for noise in [Drawn::white(1.0), walk, mixed].into_iter().chain(slow) {
        for rows in [ROWS / 4, ROWS] {
            let time = times(rows);
            for seed in SEEDS {
                let found = keeps_on(&time, &drawn(noise, &time, seed), STEP);
                assert_eq!(found, None, "{noise:?}, {rows} rows, seed {seed}");
            }
        }
    }
}

/// A sum of slow sines of random phases: 3, 5 and 11 s, in um.
struct Sines {
    waves: [(f64, f64, f64); 3],
}

impl Sines {
    fn new(seed: u64) -> Self {
        let mut source = Source::new(seed, "phases");
        Self { waves: [(1.0, 3.0), (2.0, 5.0), (1.5, 11.0)].map(|(a, period)| (a, period, source.uniform())) }
    }

    /// With white noise of a thousandth of it.
    fn values(&self, time: &[f64], seed: u64) -> Vec<f64> {
        let sum = |time: &f64| -> f64 {
            self.waves.iter().map(|(a, period, phase)| a * (TAU * (time / period + phase)).sin()).sum()
        };
        let clean: Vec<f64> = time.iter().map(sum).collect();
        let white = 1e-3 * rms(&clean);
        clean.iter().zip(normals(seed, time.len())).map(|(value, normal)| value + white * normal).collect()
    }

    /// The mean square of its values and of its velocity, over a long time.
    fn squares(&self) -> (f64, f64) {
        let square = |(a, _, _): &(f64, f64, f64)| a * a / 2.0;
        let velocity = |(a, period, _): &(f64, f64, f64)| (a * TAU / period).powi(2) / 2.0;
        (self.waves.iter().map(square).sum(), self.waves.iter().map(velocity).sum())
    }
}

/// The time is that in which it goes as far as asked for; lags go by steps of [`LAGS`], and a recording is not endless.
#[track_caller]
fn keeps_on_for(found: Option<(f64, f64)>, sines: &Sines, what: &str) {
    let (time, deviation) = found.unwrap_or_else(|| panic!("{what}: stays unseen"));
    let (square, velocity) = sines.squares();
    let expected = (FAR * square / velocity).sqrt();
    assert!(time > 0.7 * expected && time < 1.5 * LAGS * expected, "{what}: {time} s, not {expected} s");
    // It keeps its direction meanwhile: less than a quarter of the quickest wave.
    assert!(time < 3.0 / 4.0, "{what}: {time}");
    assert!((deviation / square.sqrt() - 1.0).abs() < 0.15, "{what}: {deviation} {}", square.sqrt());
}

#[test]
fn slow_sines_always_keep_on_for_about_as_long_as_they_do() {
    let time = times(ROWS);
    for seed in SEEDS {
        let sines = Sines::new(seed);
        let found = keeps_on(&time, &sines.values(&time, seed), STEP);
        keeps_on_for(found, &sines, &format!("seed {seed}"));
    }
}

#[test]
fn slow_sines_keep_on_across_gaps_of_every_kind() {
    let whole = times(ROWS);
    for seed in SEEDS {
        let sines = Sines::new(seed);
        // Rows that are missing, stretches without rows, and values that were not read.
        let pause = |row: usize| [0.0, 300.0, 304.7, 1000.0][4 * row / ROWS];
        let paused: Vec<f64> = whole.iter().enumerate().map(|(row, time)| time + pause(row)).collect();
        keeps_on_for(keeps_on(&paused, &sines.values(&paused, seed), STEP), &sines, "paused");
        let mut source = Source::new(seed, "gaps");
        let sparse: Vec<f64> = whole.iter().copied().filter(|_| source.uniform() > 0.1).collect();
        keeps_on_for(keeps_on(&sparse, &sines.values(&sparse, seed), STEP), &sines, "rows missing");
        let mut values = sines.values(&whole, seed);
        values.iter_mut().filter(|_| source.uniform() < 0.2).for_each(|value| *value = f64::NAN);
        keeps_on_for(keeps_on(&whole, &values, STEP), &sines, "values missing");
        let mut values = sines.values(&whole, seed);
        values.iter_mut().skip(1).step_by(2).for_each(|value| *value = f64::NAN);
        keeps_on_for(keeps_on(&whole, &values, STEP), &sines, "every other value missing");
    }
}

#[test]
fn differences_are_taken_where_rows_follow_one_another() {
    // Pieces of 300 rows with a pause between them, each a parabola t^2 from its own beginning, and at another height.
    let pause = |row: usize| 60.0 * crate::number(row / 300);
    let time: Vec<f64> = (0..ROWS).map(|row| STEP * crate::number(row) + pause(row)).collect();
    let own = |row: usize| STEP * crate::number(row % 300);
    let mut values: Vec<f64> = (0..ROWS).map(|row| own(row).powi(2) + 100.0 * pause(row)).collect();
    for lag in [1, 7, 40] {
        let way = STEP * crate::number(lag);
        let (_, second) = differences(&time, &values, STEP, lag).unwrap();
        assert!((second / (2.0 * way * way).powi(2) - 1.0).abs() < 1e-6, "{lag}: {second}");
    }
    values[450] = f64::NAN;
    let (_, second) = differences(&time, &values, STEP, 7).unwrap();
    assert!((second / (2.0 * (7.0 * STEP).powi(2)).powi(2) - 1.0).abs() < 1e-6, "{second}");
    let line: Vec<f64> = (0..ROWS).map(|row| 3.0 * own(row)).collect();
    let (first, second) = differences(&time, &line, STEP, 20).unwrap();
    assert!((first - 9.0).abs() < 1e-9 && second < 1e-18, "{first} {second}");
    assert_eq!(differences(&time, &line, STEP, 150), None, "no piece is that long");
}

#[test]
fn nothing_keeps_on_where_there_is_next_to_nothing() {
    assert_eq!(keeps_on(&[], &[], STEP), None);
    assert_eq!(keeps_on(&times(1), &[1.0], STEP), None);
    assert_eq!(keeps_on(&times(ROWS), &vec![0.0; ROWS], STEP), None);
    assert_eq!(keeps_on(&times(ROWS), &vec![3.7; ROWS], STEP), None);
    assert_eq!(keeps_on(&times(ROWS), &vec![f64::NAN; ROWS], STEP), None);
    // A slope of a few rows may be anything.
    let few: Vec<f64> = (0..10).map(f64::from).collect();
    assert_eq!(keeps_on(&times(10), &few, STEP), None);
}

/// A stage X that goes to and fro, with 0.05 um of noise; all rows are fitted.
fn stage(errors: &str, leftover: impl Fn(f64) -> f64) -> (Bench, Recording) {
    let bench = Bench::of("FX");
    let mut way = path(line(0, 0.0, 200.0), 50.0, 20.0);
    (way.runs, way.pause) = (3, 1.0);
    let mut recording = bench.record(&bench.calibration(errors), &noisy(way, position("x"), 5e-5, 11));
    recording.holdout = Some(Vec::new());
    let time = recording.time.clone();
    let values = recording.measured[0].as_mut().unwrap();
    values.iter_mut().zip(time).for_each(|(value, time)| *value += leftover(time));
    (bench, recording)
}

/// What is found where nothing but the zero of the instrument is fitted.
fn found(study: &Study<'_>) -> Found {
    let model = Model::of([zero(0)]).with_settings(1);
    let courses = courses(study, &model);
    let travels = travel::travels(study, &courses);
    let noises = vec![vec![Noise::white(1e-3); study.scenes[0].channels.len()]];
    let pool = kinship::groups(study, &courses, &noises, candidates::candidates(study, &travels));
    let fit = fit::refine(study, model, &Weights::of_all(study, noises), &travels);
    let appraisal = Appraisal::new(study, &fit.model);
    let tries = Tries { candidates: crate::number(pool.len()), waves: 1.0 };
    let (places, bands) = (Vec::new(), Vec::new());
    Found { fit, appraisal, pool, travels, places, bands, tries, plain_zeros: false }
}

/// The standard deviation of what is left over, mm, and the periods of its sines, s.
const SMOOTH: f64 = 8.5e-4;
const PERIODS: [f64; 2] = [2.3, 3.1];

/// Slow sines that know nothing of the way of the axis.
fn leftover(time: f64) -> f64 {
    SMOOTH * PERIODS.map(|period| (TAU * time / period + period).sin()).iter().sum::<f64>()
}

/// The commanded and the observed positions.
fn seen(recording: &Recording) -> (&[f64], &[f64]) {
    (recording.axes[0].command.as_ref().unwrap(), recording.measured[0].as_ref().unwrap())
}

#[test]
fn play_below_something_smooth_is_suspected_with_its_lost_motion() {
    let (bench, recording) = stage("{EXX: [{backlash: {lost_motion: 6 um}}]}", leftover);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let found = found(&study);
    let suspect = suspect(&study, &found).unwrap();
    assert_eq!(suspect.fitted.effect.motion(), Some(bench.motion("EXX")));
    assert_eq!(suspect.fitted.effect.shape, Shape::Backlash { axis: 0, wind_up: 0.0 });
    let [lost] = suspect.fitted.coefficients[..] else { panic!("{:?}", suspect.fitted) };
    // In the mean of a stroke of 4 s a sine leaves at most its period / (pi 4 s); the lost motion is between two means.
    let most: f64 = PERIODS.iter().map(|period| 2.0 * SMOOTH * period / (PI * 4.0)).sum();
    assert!((lost - 6e-3).abs() < most, "{lost} {most}");
    // Least squares by hand, without outliers: the means of both directions, and what they leave.
    let left_out = found.appraisal.weights.outliers.of(ChannelAt { scene: 0, channel: 0 });
    let (command, measured) = seen(&recording);
    let errors: Vec<f64> = command.iter().zip(measured).map(|(command, seen)| seen - command).collect();
    let mut forward = true;
    let mut split = [Vec::new(), Vec::new()];
    for (row, error) in errors.iter().enumerate() {
        if row > 0 && command[row] != command[row - 1] {
            forward = command[row] > command[row - 1];
        }
        if !left_out[row] {
            split[usize::from(!forward)].push(*error);
        }
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / crate::number(values.len());
    let squares = |values: &[f64]| -> f64 {
        let mean = mean(values);
        values.iter().map(|value| (value - mean).powi(2)).sum()
    };
    let [ahead, back] = &split;
    assert!((lost - (mean(back) - mean(ahead))).abs() < 1e-6, "{lost}");
    let share = 1.0 - (squares(ahead) + squares(back)) / squares(&split.concat());
    assert!((suspect.share - share).abs() < 1e-3 && share > COMES_NEAR, "{} {share}", suspect.share);
}

#[test]
fn nothing_is_suspected_where_no_term_comes_near() {
    let (bench, recording) = stage("{}", leftover);
    let study = Study::new(bench.equations(), None, &[&recording]);
    assert!(suspect(&study, &found(&study)).is_none());
}

#[test]
fn a_bend_is_not_suspected_of_being_what_bends_at_will() {
    let bent = "{EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 0.24, -1.2e-3]}}]}";
    let (bench, recording) = stage(bent, |_| 0.0);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let plain = suspect(&study, &found(&study)).is_none_or(|suspect| suspect.fitted.coefficients.len() <= 2);
    assert!(plain);
}

#[test]
fn what_is_in_the_model_is_not_suspected_again() {
    let (bench, recording) = stage("{EXX: [{backlash: {lost_motion: 6 um}}]}", leftover);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let mut found = found(&study);
    let play = machine(bench.motion("EXX"), Shape::Backlash { axis: 0, wind_up: 0.0 }, &[0.0]);
    found.fit.model.effects.push(play);
    let weights = found.appraisal.weights.as_white();
    found.fit = fit::refine(&study, found.fit.model.clone(), &weights, &found.travels);
    found.appraisal = Appraisal::new(&study, &found.fit.model);
    assert!(suspect(&study, &found).is_none());
}

#[test]
fn the_largest_channel_that_moves_is_named_and_outliers_do_not_hide_it() {
    let bench = Bench::of("FX");
    let way = path(line(0, 0.0, 200.0), 10.0, 1.0 / STEP);
    let recording = bench.record(&bench.calibration("{}"), &noisy(way, position("xyz"), 1e-6, 5));
    let study = Study::new(bench.equations(), None, &[&recording]);
    let (rows, channels) = (study.scenes[0].rows(), study.scenes[0].channels.len());
    assert!(channels >= 2, "{channels}");
    let sines = Sines::new(3);
    let smooth = sines.values(&recording.time, 3);
    let mut residuals: Vec<Vec<f64>> =
        vec![normals(9, rows).iter().map(|value| 10.0 * value).collect(); channels];
    residuals[0] = smooth.iter().map(|value| 0.5 * value).collect();
    let noises = vec![vec![Noise::white(1.0); channels]];
    let mut appraisal = Appraisal::new(&study, &Model::default());
    appraisal.residuals = vec![residuals];
    appraisal.floors.clone_from(&noises);
    appraisal.weights = Weights::of_all(&study, noises);
    // The larger channel is white.
    assert_eq!(moving(&study, &appraisal, true).unwrap().at.channel, 0);
    appraisal.residuals[0][1] = smooth.clone();
    for row in (7..rows).step_by(31) {
        appraisal.residuals[0][1][row] += 40.0;
    }
    assert_eq!(moving(&study, &appraisal, true).unwrap().at.channel, 0, "what jumps does not move smoothly");
    let mut marks = vec![vec![false; rows]; channels];
    for row in (7..rows).step_by(31) {
        marks[1][row] = true;
    }
    appraisal.weights.outliers = Outliers::new(vec![marks]);
    let found = moving(&study, &appraisal, true).unwrap();
    assert_eq!(found.at, ChannelAt { scene: 0, channel: 1 });
    keeps_on_for(Some((found.time, found.rms)), &sines, "channel 1");
}
