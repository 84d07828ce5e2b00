//! Of three sensors that warm up together, the two with which the machine grows are found in place of a third one and a drift.

use super::*;
use crate::conditions::Tries;
use crate::model::Fitted;
use crate::recording::Recording;
use crate::side::Side;
use crate::terms::Setting;
use crate::testing::{Bench, noisy, path, position, warming};
use simulation::path::Shape as PathShape;

/// A column at rest that grows down with its frame, after a time constant of 150 s, and up with its bed.
const TRUTH: &str = "{EZZ: [{growth: {sensor: frame, coefficient: -30 um/K, reference: 20 degC, time_constant: 150 s}}, \
    {growth: {sensor: bed, coefficient: 1.5 um/K, reference: 20 degC}}]}";
/// The numbers of the sensors.
const FRAME: usize = 0;
const CHAMBER: usize = 1;
const BED: usize = 2;

fn recorded(bench: &Bench) -> Recording {
    let mut scenario = noisy(path(PathShape::Still { time: 4000.0 }, 1.0, 0.2), position("z"), 0.001, 3);
    // The sensors in the order of their numbers.
    scenario.temperatures =
        vec![warming("frame", 12.0, 1800.0), warming("chamber", 16.0, 600.0), warming("bed", 70.0, 120.0)];
    // Exponentials alone could stand in for one another.
    for (sensor, step) in
        scenario.temperatures.iter_mut().zip([(2500.0, 28.0), (1800.0, 40.0), (1000.0, 70.0)])
    {
        sensor.steps.push(step);
    }
    bench.record(&bench.calibration(TRUTH), &scenario)
}

fn effect(bench: &Bench, shape: Shape) -> Effect {
    Effect { place: Place::Motion { motion: bench.motion("EZZ"), side: Side::After }, shape }
}

fn growth(sensor: usize, time_constant: f64) -> Shape {
    Shape::Growth { sensor, reference: 20.0, time_constant }
}

/// The growths of these sensors, each at once and after some time constants; none is that of the truth.
fn pool(bench: &Bench, sensors: &[usize]) -> Vec<Kin> {
    let mut pool = Vec::new();
    for sensor in sensors {
        for time_constant in [0.0, 50.0, 100.0, 200.0, 400.0] {
            let effect = effect(bench, growth(*sensor, time_constant));
            pool.push(Kin { effect, equals: Vec::new() });
        }
    }
    pool
}

/// What `growths_alone` makes of a model of these shapes, fitted, with these sensors.
fn alone(bench: &Bench, recording: &Recording, shapes: &[Shape], sensors: &[usize]) -> Option<Model> {
    let study = Study::new(bench.equations(), None, &[recording]);
    let zero = Model::of_settings([Effect::setting(0, Setting::Offset { channel: 0 })]);
    let model =
        shapes.iter().fold(zero, |model, shape| model.with(Fitted::unfitted(effect(bench, shape.clone()))));
    let weights = Appraisal::new(&study, &model).weights;
    let tries = Tries { candidates: 15.0, waves: 1.0 };
    let conditions = Conditions { weights: &weights, travels: &[], tries };
    let model = conditions.refine(&study, model).model;
    growths_alone(&study, &model, &pool(bench, sensors), &conditions)
}

#[test]
fn a_third_sensor_and_a_drift_give_way_to_the_two_that_grow() {
    let bench = Bench::of("FZ");
    let recording = recorded(&bench);
    let shapes = [growth(CHAMBER, 400.0), Shape::Drift { time_constant: 1500.0 }];
    let model = alone(&bench, &recording, &shapes, &[FRAME, CHAMBER, BED]).unwrap();
    let [frame, bed] = model.chosen() else { panic!("{model:?}") };
    assert_eq!([&frame.effect.shape, &bed.effect.shape].map(sensor_of), [Some(FRAME), Some(BED)]);
    // White noise of 1 um in 800 rows, on growths of 360 and 105 um.
    assert!((frame.coefficients[0] / -30e-3 - 1.0).abs() < 0.01, "{frame:?}");
    assert!((bed.coefficients[0] / 1.5e-3 - 1.0).abs() < 0.05, "{bed:?}");
    let Shape::Growth { time_constant, .. } = frame.effect.shape else { panic!("{frame:?}") };
    assert!((time_constant / 150.0 - 1.0).abs() < 0.1, "{frame:?}");
}

#[test]
fn where_nothing_grows_or_one_sensor_is_alone_there_is_no_pair() {
    let bench = Bench::of("FZ");
    let recording = recorded(&bench);
    let drift = Shape::Drift { time_constant: 1500.0 };
    assert_eq!(alone(&bench, &recording, &[drift], &[FRAME, CHAMBER, BED]), None);
    assert_eq!(alone(&bench, &recording, &[growth(BED, 0.0)], &[BED]), None);
}
