//! What comes back, on residuals whose truth is known: functions of a state, mere noise, and both.

use super::*;
use crate::testing::{Bench, line, normals, path, position, scenario};

/// A stage X that goes to and fro over 200 mm, five times.
fn with_returns<T>(look: impl FnOnce(&Returns, &States) -> T) -> T {
    let bench = Bench::of("FX");
    let mut way = path(line(0, 0.0, 200.0), 50.0, 20.0);
    (way.runs, way.pause) = (5, 1.0);
    let recording = bench.record(&bench.calibration("{}"), &scenario(way, position("x")));
    let study = Study::new(bench.equations(), None, &[&recording]);
    let course = Course::new(&study, 0, &Model::default());
    look(&study.scenes[0].returns, &course.shown)
}

fn told(returns: &Returns, residual: &[f64]) -> Vec<(Quantity, f64, f64)> {
    let valid = vec![true; residual.len()];
    let noise = noise::estimate(&returns.time, residual, &valid, 0.0).0;
    let found = returns.of(residual, &valid, noise);
    found.into_iter().map(|one| (returns.quantity(one), one.share, one.left)).collect()
}

#[test]
fn a_function_of_the_position_comes_back_with_it_and_leaves_the_noise() {
    with_returns(|returns, states| {
        let random = normals(5, states.given.time.len());
        let places = states.axes[0].position.iter().zip(&random);
        let residual: Vec<f64> = places.map(|(q, noise)| (q / 23.0).sin() + 0.1 * noise).collect();
        let found = told(returns, &residual);
        assert!(matches!(found[0].0, Quantity::Position(0) | Quantity::Branch(0)), "{found:?}");
        let last = found.last().unwrap();
        // The variance of the sine is about a half; that of the noise a hundredth, and a mean of four passes has a part of it.
        assert!(last.1 > 0.95 && last.2 < 0.125, "{found:?}");
    });
}

#[test]
fn what_turns_with_the_direction_comes_back_with_it() {
    with_returns(|returns, states| {
        let random = normals(6, states.given.time.len());
        let rows = states.axes[0].direction.iter().zip(&random);
        let residual: Vec<f64> = rows.map(|(direction, noise)| direction + 0.2 * noise).collect();
        let (quantity, share, _) = told(returns, &residual)[0];
        assert!(
            matches!(
                quantity,
                Quantity::Direction(0) | Quantity::Branch(0) | Quantity::Velocity(0) | Quantity::Way(0)
            ),
            "{quantity:?}"
        );
        assert!(share > 0.9, "{share}");
    });
}

#[test]
fn noise_does_not_come_back_whether_it_is_white_or_walks() {
    with_returns(|returns, states| {
        let rows = states.given.time.len();
        for seed in 10..25 {
            let white = normals(seed, rows);
            assert!(told(returns, &white).is_empty(), "white {seed}: {:?}", told(returns, &white));
            let mut at = 0.0;
            let walk: Vec<f64> = white
                .iter()
                .map(|step| {
                    at += step;
                    at
                })
                .collect();
            assert!(told(returns, &walk).is_empty(), "walk {seed}: {:?}", told(returns, &walk));
        }
    });
}

#[test]
fn the_floor_is_the_noise_beside_whatever_comes_back() {
    with_returns(|returns, states| {
        let random = normals(7, states.given.time.len());
        let places = states.axes[0].position.iter().zip(&random);
        let residual: Vec<f64> = places.map(|(q, noise)| 40.0 * (q / 17.0).cos() + noise).collect();
        let valid = vec![true; residual.len()];
        let noise = noise::estimate(&returns.time, &residual, &valid, 0.0).0;
        let found = returns.of(&residual, &valid, noise);
        let (left, factor) = returns.beside(&found, &residual, &valid);
        let floor = factor * variance(&left, &valid).sqrt();
        // What straight lines between nodes leave of the cosine is small beside it.
        assert!((floor - 1.0).abs() < 0.15, "{floor}");
        assert!(noise.size() > 10.0, "without it the cosine would be the noise: {noise:?}");
    });
}

#[test]
fn a_wave_in_time_that_strokes_do_not_know_of_stays() {
    with_returns(|returns, states| {
        let rows = states.given.time.len();
        let random = normals(8, rows);
        let valid = vec![true; rows];
        let signal: Vec<f64> = states.given.time.iter().map(|t| (7.77 * t).sin()).collect();
        let beside: Vec<f64> = signal.iter().zip(&random).map(|(s, noise)| s + 0.3 * noise).collect();
        assert!(returns.stays(&signal, &beside, &valid) > 0.8);
        // One that is a function of the position is taken by it.
        let of_place: Vec<f64> = states.axes[0].position.iter().map(|q| (q / 23.0).sin()).collect();
        let beside: Vec<f64> = of_place.iter().zip(&random).map(|(s, noise)| s + 0.3 * noise).collect();
        assert!(returns.stays(&of_place, &beside, &valid) < 0.2);
    });
}

#[test]
fn a_reading_is_apart_only_where_other_passes_read_something_else() {
    with_returns(|returns, states| {
        let position = &states.axes[0].position;
        let mut residual = vec![0.0; position.len()];
        let moving = position.iter().position(|q| (90.0..110.0).contains(q)).unwrap();
        residual[moving] = 5.0;
        assert!(returns.apart(&residual, moving, 5.0));
        let there = residual.iter_mut().zip(position.iter());
        there.filter(|(_, q)| (*q - position[moving]).abs() < 2.0).for_each(|(value, _)| *value = 5.0);
        assert!(!returns.apart(&residual, moving, 5.0), "it comes back in every pass");
    });
}

#[test]
fn where_nothing_is_driven_twice_nothing_comes_back() {
    let bench = Bench::of("FX");
    let once = simulation::Path { runs: 1, ..path(line(0, 0.0, 200.0), 50.0, 20.0) };
    let mut recording = bench.record(&bench.calibration("{}"), &scenario(once, position("x")));
    // The way there alone.
    let far = recording.axes[0].command.as_ref().unwrap();
    let end = far.iter().position(|q| *q >= 199.0).unwrap();
    recording.time.truncate(end);
    recording.run.truncate(end);
    for axis in &mut recording.axes {
        axis.command.iter_mut().for_each(|command| command.truncate(end));
    }
    recording.measured.iter_mut().flatten().for_each(|measured| measured.truncate(end));
    let study = Study::new(bench.equations(), None, &[&recording]);
    let returns = &study.scenes[0].returns;
    let residual: Vec<f64> = (0..end).map(crate::number).collect();
    assert!(told(returns, &residual).is_empty());
}
