//! Fits that begin far from the least squares, where a whole step overshoots.

use super::*;
use crate::course::courses;
use crate::model::Place;
use crate::noise::Noise;
use crate::side::Side;
use crate::terms::Setting;
use crate::testing::{Bench, line, noisy, path, position};
use crate::travel::travels;

/// White noise, mm.
const NOISE: f64 = 1e-4;

/// What a stage X does, mm and Hz, that vibrates while it goes 200 mm there and back, in 8 s.
const VIBRATES: &str = "{EXX: [{vibration: {frequency: 3.1 Hz, amplitude: 2 um, phase: 10 deg}}]}";
const FREQUENCY: f64 = 3.1;
const OBSERVED: f64 = 8.0;

/// For fits that begin at these frequencies, Hz: the sum of squares of the linear fit at the beginning, and the end.
fn from(frequencies: impl Iterator<Item = f64>) -> Vec<(f64, f64, Fit)> {
    let bench = Bench::of("FX");
    let scenario = noisy(path(line(0, 0.0, 200.0), 50.0, 40.0), position("x"), NOISE, 7);
    let recording = bench.record(&bench.calibration(VIBRATES), &scenario);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let travels = travels(&study, &courses(&study, &Model::default()));
    let weights = Weights::of_all(&study, vec![vec![Noise::white(NOISE)]]);
    let place = Place::Motion { motion: bench.motion("EXX"), side: Side::After };
    let fit = |frequency: f64| {
        let zero = Effect::setting(0, Setting::Offset { channel: 0 });
        let vibration = Effect { place, shape: Shape::Vibration { frequency } };
        let model = Model::of([
            Fitted { effect: zero, coefficients: vec![0.0] },
            Fitted { effect: vibration, coefficients: vec![0.0; 2] },
        ]);
        let groups = harmonics::sharing(&model.effects);
        // Without an amplitude the frequency has no slope: the first step is the linear fit at this frequency.
        let begin = Linearised::new(&study, model, &weights, &groups).stepped(&study, 1.0, &travels);
        let squares = Linearised::new(&study, begin.clone(), &weights, &groups).remaining;
        (frequency, squares, refine(&study, begin, &weights, &travels))
    };
    frequencies.map(fit).collect()
}

fn frequency(fit: &Fit) -> f64 {
    fit.model.effects[1].effect.shape.nonlinear().unwrap().value
}

#[test]
fn no_fit_is_worse_than_where_it_began() {
    // Up to five turns ahead of the vibration and behind it, where most fits end on a side lobe of its spectrum.
    let fits = from((0..60).map(|step| 2.5 + 0.02 * f64::from(step)));
    for (start, squares, fit) in &fits {
        assert!(
            fit.remaining <= *squares,
            "{start} Hz: {squares}, {} at {} Hz",
            fit.remaining,
            frequency(fit)
        );
    }
}

#[test]
fn a_fit_that_begins_within_half_a_turn_comes_to_the_vibration() {
    // A frequency is known to a standard deviation of 3e-4 Hz there: sqrt(6) / pi / 8 s times noise / amplitude / sqrt(320).
    for (start, _, fit) in
        from([-0.5, -0.3, -0.1, 0.1, 0.3, 0.5].map(|turns| FREQUENCY + turns / OBSERVED).into_iter())
    {
        assert!((frequency(&fit) - FREQUENCY).abs() < 1e-3, "{start} Hz: {}", frequency(&fit));
        assert!(
            (fit.remaining / fit.samples - 1.0).abs() < 0.25,
            "{start} Hz: {}",
            fit.remaining / fit.samples
        );
    }
}

#[test]
fn a_wave_slips_by_less_than_half_a_cycle_in_one_step() {
    for (low, high, period) in [(0.0, 300.0, 8.0), (-400.0, 400.0, 2.0), (0.0, 50.0, 40.0)] {
        let travel = Travel { low, high, step: 0.1, moves: true, between: high - low, ..Travel::default() };
        let most = furthest(&Shape::Cyclic { axis: 0, period, order: 1, center: 0.0 }, &[travel]);
        let cycles = |period: f64| (high - low) / period;
        for slipped in [cycles(period - most) - cycles(period), cycles(period) - cycles(period + most)] {
            assert!((0.2..0.5).contains(&slipped), "{period} mm: {slipped} cycles");
        }
    }
}

/// A delay of 5 ms that is fitted 1.2 times is one of 6 ms, once; what is no delay stays.
#[test]
fn a_delay_keeps_its_amount_in_its_time() {
    let (shape, coefficients) = timed(Shape::Delay { axis: 0, time: 0.005 }, vec![1.2]);
    assert_eq!(coefficients, [1.0]);
    assert!(matches!(shape, Shape::Delay { axis: 0, time } if (time - 0.006).abs() < 1e-12), "{shape:?}");
    let play = Shape::Backlash { axis: 0, wind_up: 0.0 };
    assert_eq!(timed(play.clone(), vec![1.2]), (play, vec![1.2]));
}
