//! Pictures of a diagnosis: what is drawn says the same as the figures, and lies where the concealed effect puts it.

use std::f64::consts::{FRAC_PI_2, TAU};

use abbe_diagnosis::diagnose_with_pictures;
use abbe_diagnosis::diagnosis::Diagnosis;
use abbe_diagnosis::pictures::{ChannelPicture, Pictures};
use model_dsl::calibration::Calibration;
use simulation::Path;

use crate::common::*;
use crate::recording::Recording;
use crate::testing::*;

fn drawn(bench: &Bench, known: &Calibration, recording: &Recording) -> (Diagnosis, Pictures) {
    let mut diagnosis = diagnose_with_pictures(&bench.inputs(known, &[recording]), &mut |_| {});
    let pictures = diagnosis.pictures.take().unwrap();
    (diagnosis, pictures)
}

/// A stage there and back, with something concealed.
fn stage(concealed: &str) -> (Diagnosis, Pictures) {
    let bench = Bench::of("FX");
    let known = bench.calibration(STAGE);
    let lines = Path { runs: 3, ..path(line(0, 0.0, 300.0), 20.0, 20.0) };
    let truth = together(&known, &bench.calibration(concealed));
    drawn(&bench, &known, &bench.record(&truth, &noisy(lines, position("x"), 0.001, 5)))
}

fn channel(pictures: &Pictures) -> &ChannelPicture {
    &pictures.recordings[0].channels[0]
}

/// The root mean square of all channels together.
fn joined(pictures: &Pictures, of: impl Fn(&ChannelPicture) -> f64) -> f64 {
    let channels =
        || pictures.recordings.iter().flat_map(|picture| &picture.channels).filter(|channel| channel.counts);
    let samples = |channel: &ChannelPicture| channel.samples as f64;
    let squares: f64 = channels().map(|channel| samples(channel) * of(channel).powi(2)).sum();
    (squares / channels().map(samples).sum::<f64>()).sqrt()
}

#[track_caller]
fn near(one: f64, other: f64, share: f64) {
    assert!((one - other).abs() <= share * other.abs(), "{one} is not {other}");
}

#[test]
fn what_is_drawn_has_the_rms_that_is_told() {
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration(MILL);
    let truth = together(&known, &bench.calibration("{EYY: [{backlash: {lost_motion: 8 um}}]}"));
    let round =
        Path { at: vec![vec![250.0], vec![140.0], vec![-50.0]], runs: 3, ..path(circle(100.0), 25.0, 6.0) };
    let recording = bench.record(&truth, &noisy(round, position("xy"), 0.001, 9));
    let (diagnosis, pictures) = drawn(&bench, &known, &recording);
    near(joined(&pictures, |channel| channel.rms.0), diagnosis.before.rms, 1e-9);
    near(joined(&pictures, |channel| channel.rms.1), diagnosis.after.rms, 1e-9);
    let counted = |after, held_out| {
        let mut of =
            pictures.distributions.iter().filter(|one| (one.after, one.held_out) == (after, held_out));
        let one = of.next().unwrap();
        assert_eq!(one.edges.len(), one.counts.len() + 1);
        one.counts.iter().sum::<usize>() + one.beyond
    };
    let samples: usize = pictures.recordings[0].channels.iter().map(|channel| channel.samples).sum();
    assert_eq!((counted(false, false), counted(true, false)), (samples, samples));
    // Rows behind corners of the path count nowhere.
    assert!(
        samples <= diagnosis.recordings[0].samples && samples > diagnosis.recordings[0].samples * 98 / 100
    );
    let held_out = recording.run.iter().filter(|run| **run == 3).count();
    assert!((2 * held_out * 98 / 100..=2 * held_out).contains(&counted(true, true)));
}

#[test]
fn backlash_stands_half_on_each_side() {
    let (diagnosis, pictures) = stage("{EXX: [{backlash: {lost_motion: 6 um}}]}");
    assert_eq!(found(&diagnosis), ["EXX backlash"]);
    // -B/2 d with both directions alike.
    near(pictures.contributions[0].rms, 0.003, 0.05);
    near(pictures.contributions[0].max, 0.003, 0.06);
    let shown = &channel(&pictures).shown;
    let mean = |values: &[f64], direction: f64| {
        let rows: Vec<usize> =
            (0..values.len()).filter(|row| shown.axes[0].direction[*row] == direction).collect();
        rows.iter().map(|row| values[*row]).sum::<f64>() / rows.len() as f64
    };
    near(mean(&shown.before, -1.0) - mean(&shown.before, 1.0), 0.006, 0.1);
    assert!((mean(&shown.after, -1.0) - mean(&shown.after, 1.0)).abs() < 0.0005);
    assert!(shown.held_out.iter().zip(&shown.run).all(|(held_out, run)| *held_out == (*run == 3)));
}

#[test]
fn waves_are_lines_at_their_period_and_frequency() {
    let (_, pictures) = stage("{EXX: [{cyclic: {period: 12 mm, amplitude: 4 um, phase: 0.4 rad}}]}");
    let highest = |line: &[(f64, f64)]| *line.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    let spectrum = &channel(&pictures).over_position[0];
    let (period, amplitude) = highest(&spectrum.spectrum.before);
    near(period, 12.0, 0.02);
    near(amplitude, 0.004, 0.1);
    assert!(highest(&spectrum.spectrum.after).1 < 0.001);
    let (at, name) = &spectrum.spectrum.found[0];
    near(*at, 12.0, 0.01);
    assert_eq!((name.as_str(), spectrum.axis.as_str(), spectrum.unit), ("cyclic of EXX", "X", "mm"));
    let (_, pictures) = stage("{EXX: [{vibration: {frequency: 3 Hz, amplitude: 3 um, phase: 1 rad}}]}");
    let over_time = channel(&pictures).over_time.as_ref().unwrap();
    near(over_time.found[0].0, 3.0, 0.01);
    let (frequency, amplitude) = highest(&over_time.before);
    near(frequency, 3.0, 0.01);
    near(amplitude, 0.003, 0.1);
    assert!(highest(&over_time.after).1 < 0.0005);
}

#[test]
fn a_squareness_is_an_oval_at_45_degrees_in_both_senses() {
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration("{}");
    let truth = bench.calibration("{EC0Y: 40 urad}");
    let round =
        Path { at: vec![vec![250.0], vec![140.0], vec![-50.0]], runs: 2, ..path(circle(100.0), 25.0, 6.0) };
    for instrument in [ballbar([0.03, -0.02, 0.0]), position("xy")] {
        let recording = bench.record(&truth, &noisy(round.clone(), instrument, 0.0003, 4));
        let (_, pictures) = drawn(&bench, &known, &recording);
        let circle = pictures.recordings[0].circle.as_ref().unwrap();
        near(circle.radius, 100.0, 1e-4);
        assert_eq!(circle.directions, ["+X", "+Y"]);
        assert_eq!((circle.passes.len(), circle.of), (4, 4));
        assert_eq!(circle.passes.iter().filter(|pass| pass.against_the_clock).count(), 2);
        for pass in &circle.passes {
            // An angle between the axes displaces by alpha y along x: alpha r sin cos along the radius.
            let part = |which: usize| {
                let seen = pass.points.iter().filter(|point| point[which].is_finite());
                let products: (f64, f64) = seen.fold((0.0, 0.0), |(with, own), point| {
                    let form = (2.0 * point[0]).sin();
                    (with + form * point[which], own + form * form)
                });
                products.0 / products.1
            };
            near(part(1).abs(), 0.002, 0.05);
            near(part(3), part(1), 0.05);
            assert!(
                pass.points.iter().all(|point| point[2].is_nan() || point[2].abs() < 1e-9),
                "nothing was known"
            );
            for quadrant in [0.5, 1.5, 2.5, 3.5] {
                let near = |point: &[f64; 4]| (point[0].rem_euclid(TAU) / FRAC_PI_2 - quadrant).abs() < 0.5;
                assert!(pass.points.iter().any(near), "a whole turn");
            }
        }
    }
}

#[test]
fn nothing_found_is_nothing_changed() {
    let (diagnosis, pictures) = stage("{}");
    assert!(diagnosis.findings.is_empty() && pictures.contributions.is_empty() && pictures.unchanged());
    assert!(pictures.recordings[0].circle.is_none(), "a line is no circle");
    let (_, changed) = stage("{EXX: [{backlash: {lost_motion: 6 um}}]}");
    assert!(!changed.unchanged());
}

#[test]
fn what_is_not_asked_for_is_not_made() {
    let bench = Bench::of("FX");
    let known = bench.calibration(STAGE);
    let recording =
        bench.record(&known, &noisy(path(line(0, 0.0, 300.0), 20.0, 8.0), position("x"), 0.001, 5));
    assert!(diagnosed(&bench, &known, &[&recording]).pictures.is_none());
}
