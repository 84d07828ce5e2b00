//! How samples weigh, where recordings of one channel lack something.

use super::*;
use crate::model::{Effect, Fitted};
use crate::recording::Recording;
use crate::terms::Setting;
use crate::testing::{Bench, flicker, line, noisy, path, position};

fn stage(bench: &Bench, errors: &str, noise: f64, seed: u64) -> Recording {
    let strokes = simulation::Path { runs: 3, ..path(line(0, 0.0, 300.0), 20.0, 8.0) };
    bench.record(&bench.calibration(errors), &noisy(strokes, position("x"), noise, seed))
}

/// The weights of two recordings under a model of nothing but their zeros.
fn weights(bench: &Bench, recordings: [&Recording; 2]) -> [Noise; 2] {
    let study = Study::new(bench.equations(), None, &recordings);
    let zero = |recording: usize| Fitted {
        effect: Effect::setting(recording, Setting::Offset { channel: 0 }),
        coefficients: vec![0.0],
    };
    let noises = Appraisal::new(&study, &Model::of([zero(0), zero(1)])).weights.noises;
    [noises[0][0], noises[1][0]]
}

#[test]
fn recordings_of_one_channel_share_a_weight_where_one_of_them_lacks_something() {
    let bench = Bench::of("FX");
    let quiet = stage(&bench, "{}", 2e-4, 1);
    let loud = stage(&bench, "{}", 8e-4, 2);
    // Of nothing but noise each keeps its own.
    let [one, other] = weights(&bench, [&quiet, &loud]);
    assert!((one.size() - 2e-4).abs() < 2e-5 && (other.size() - 8e-4).abs() < 8e-5, "{one:?} {other:?}");
    // A slope of 20 um in one of them is all that both leave: an rms of 20 um over the root of twelve, over the root of two.
    let lacking = stage(
        &bench,
        "{EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 0.0666667]}}]}",
        2e-4,
        3,
    );
    let [one, other] = weights(&bench, [&quiet, &lacking]);
    assert_eq!(one.white, other.white);
    assert!((one.white - 0.02 / 24f64.sqrt()).abs() < 4e-4, "{one:?}");
    assert!(one.alike > 1.0 && other.alike > 1.0);
}

#[test]
fn flicker_is_asked_where_the_noise_may_be_flicker() {
    let bench = Bench::of("FX");
    let mut recording = stage(&bench, "{}", 2e-4, 1);
    let above = |recording: &Recording| {
        let study = Study::new(bench.equations(), None, &[recording]);
        let appraisal = Appraisal::new(&study, &Model::default());
        appraisal.above_in_flicker(&study, &appraisal)
    };
    assert_eq!(above(&recording), None);
    let measured = recording.measured.iter_mut().flatten().next().unwrap();
    let noise = flicker(5, measured.len());
    measured.iter_mut().zip(noise).for_each(|(value, noise)| *value += 1e-3 * noise);
    assert_eq!(above(&recording), Some(0.0), "a model lies nowhere above itself");
}
