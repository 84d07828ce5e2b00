//! Which waves have paid, and what costs less.

use super::*;
use crate::model::{Fitted, Place};
use crate::noise::Noise;
use crate::side::Side;
use crate::terms::Setting;
use crate::testing::{Bench, line, noisy, path, position};
use crate::travel::travels;

/// The prices of a wave of this period along X in a study whose machine has one of 9 mm and 2 um under a slope that has no name,
/// where `alike` samples count for one: what it has to pay, and what it would without that noise.
fn prices(period: f64, alike: f64) -> [f64; 2] {
    let bench = Bench::of("FX");
    let truth = bench.calibration("{EXX: [{cyclic: {period: 9 mm, amplitude: 2 um, phase: 40 deg}}, {polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 0.1]}}]}");
    let there_and_back = path(line(0, 0.0, 300.0), 20.0, 20.0);
    let recording = bench.record(&truth, &noisy(there_and_back, position("x"), 0.000_3, 5));
    let study = Study::new(bench.equations(), None, std::slice::from_ref(&&recording));
    let place = Place::Motion { motion: bench.motion("EXX"), side: Side::After };
    let shape = Shape::Cyclic { axis: 0, period, order: 1, center: 150.0 };
    let zero = Effect::setting(0, Setting::Offset { channel: 0 });
    let model = Model::of([
        Fitted { effect: zero, coefficients: vec![0.0] },
        Fitted { effect: Effect { place, shape }, coefficients: vec![0.0, 0.0] },
    ])
    .with_settings(1);
    let travels = travels(&study, &crate::course::courses(&study, &model));
    let weights = Weights::of_all(&study, vec![vec![Noise { alike, ..Noise::white(0.01) }]]);
    let tries = Tries { candidates: 40.0, waves: 300.0 };
    let conditions = Conditions { weights: &weights, travels: &travels, tries };
    [conditions.prices(&study, &model, 100.0)[1], conditions.price(&study, &model.effects[1].effect, 100.0)]
}

#[test]
fn a_wave_that_stands_out_at_its_own_noise_has_paid_where_samples_weigh_alike() {
    assert_eq!(prices(9.0, 100.0)[0], PAID);
    let [price, full] = prices(9.0, 1.0);
    assert_eq!(price, full, "the weights know the noise of its frequency");
}

#[test]
fn what_does_not_stand_out_pays_in_full() {
    let [price, full] = prices(13.7, 100.0);
    assert_eq!(price, full, "there is no such wave");
    let [price, full] = prices(150.0, 100.0);
    assert_eq!(price, full, "it is a part of the slope");
}
