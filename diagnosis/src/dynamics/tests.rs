//! Which drives are tried.

use super::*;
use crate::recording::Recording;
use crate::testing::{Bench, circle, noisy, path, position};

/// A circle at 100 rows/s on the stages X and Y.
fn circled(bench: &Bench) -> Recording {
    let scenario = noisy(path(circle(40.0), 20.0, 100.0), position("xy"), 2e-4, 5);
    bench.record(&bench.calibration("{}"), &scenario)
}

fn bench() -> Bench {
    Bench::of("XFY")
}

fn own(bench: &Bench, name: &str, shape: Shape, coefficients: &[f64]) -> Fitted {
    let place = Place::Motion { motion: bench.motion(name), side: Side::Drive };
    Fitted { effect: Effect { place, shape }, coefficients: coefficients.to_vec() }
}

fn lag(bench: &Bench, time_constant: f64) -> Fitted {
    own(bench, "EXX", Shape::Lag { axis: 0, inertia: 0.0 }, &[time_constant])
}

#[test]
fn a_loop_is_tried_with_the_dampings_whose_ringing_rows_resolve() {
    let bench = bench();
    let count = |time_constant: f64| loops(&lag(&bench, time_constant), 0.01).len() - 1;
    assert_eq!(count(1e-2), 4);
    // Two rows of 10 ms in a period of 2 pi T / (2 d), d the damping.
    for (number, damping) in [0.15, 0.3, 0.6, 1.2].into_iter().enumerate() {
        let resolved = 2.0 * damping * 0.02 / std::f64::consts::TAU;
        assert_eq!(count(1.02 * resolved), number + 1);
        assert_eq!(count(0.98 * resolved), number);
    }
}

#[test]
fn every_other_way_to_drive_an_axis_is_tried_once() {
    let bench = bench();
    let recording = circled(&bench);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let lag = lag(&bench, 0.02);
    let shapes = loops(&lag, 0.01);
    let of = |model: &Model| drives(&study, model, 0, &shapes);
    let alone = Model::of([lag.clone()]);
    assert_eq!(of(&alone).len(), DAMPINGS.len());
    // With something that imitates ringing: with it and without it.
    let spike = own(&bench, "EXX", Shape::ReversalSpike { axis: 0, decay: 0.1 }, &[1e-3]);
    assert_eq!(of(&Model::of([lag.clone(), spike.clone()])).len(), 2 * DAMPINGS.len() + 1);
    // With friction: where it is and inside the loop.
    let friction = own(&bench, "EXX", Shape::Backlash { axis: 0, wind_up: 0.0 }, &[1e-3]);
    assert_eq!(of(&Model::of([lag.clone(), friction.clone()])).len(), 2 * DAMPINGS.len() + 1);
    let all = Model::of([lag, spike, friction]);
    let trials = of(&all);
    assert_eq!(trials.len(), 4 * DAMPINGS.len() + 3);
    for (number, trial) in trials.iter().enumerate() {
        assert!(*trial != all && !trials[..number].contains(trial), "{trial:?}");
    }
}
