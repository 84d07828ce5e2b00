//! What a form takes the place of: names that imitate it, and none that it only hides.

use super::*;
use crate::model::{Effect, Place};
use crate::noise::Noise;
use crate::side::Side;
use crate::terms::Setting;
use crate::testing::{Bench, line, noisy, path, position};

/// White noise, mm.
const NOISE: f64 = 1e-4;

/// A stage X that is long by 1e-4 and has a wave of 5 mm. A slope takes the place of a wave of 100 mm, which imitates it over 44 mm; a
/// backlash, which is not there, does not take the place of the wave of 5 mm.
#[test]
fn what_goes_must_have_imitated_what_comes() {
    let bench = Bench::of("FX");
    let truth = "{EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 0.1]}}, {cyclic: {period: 5 mm, amplitude: 1 um, phase: 0 deg}}]}";
    let way = noisy(path(line(0, 0.0, 44.0), 10.0, 40.0), position("x"), NOISE, 1);
    let recording = bench.record(&bench.calibration(truth), &way);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let weights = Weights::of_all(&study, vec![vec![Noise::white(NOISE)]]);
    let place = Place::Motion { motion: bench.motion("EXX"), side: Side::After };
    let zero = Effect::setting(0, Setting::Offset { channel: 0 });
    let model = |shapes: &[Shape]| {
        let effects = shapes.iter().map(|shape| Fitted::unfitted(Effect { place, shape: shape.clone() }));
        effects.fold(Model::of_settings([zero.clone()]), |model, effect| model.with(effect))
    };
    let wave = |period: f64| Shape::Cyclic { axis: 0, period, order: 1, center: 22.0 };
    let slope = Shape::Polynomial { axis: 0, degree: 1, center: 22.0, scale: 22.0 };
    let backlash = Shape::Backlash { axis: 0, wind_up: 0.0 };
    let stands =
        |old: &[Shape], new: &[Shape]| stands_for_what_went(&study, &model(old), &model(new), &weights);
    assert!(stands(&[wave(100.0), wave(5.0)], &[slope.clone(), wave(5.0)]));
    assert!(!stands(&[slope.clone(), wave(5.0)], &[slope, backlash]));
}
