//! Flicker against the textbook: a dense covariance matrix and its Cholesky factor, the spectrum, and flicker made by fractional
//! differences.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use simulation::noise::{Correlated, Noise as Drawn, Source};

use super::*;
use crate::noise::WORTH;
use crate::testing::{flicker as drawn, normals, uneven};

#[test]
fn deviance_is_that_of_the_covariance_matrix() {
    let time = uneven(3, 60, 0.5);
    let values = normals(7, time.len());
    let valid: Vec<bool> = (0..time.len()).map(|row| row % 7 != 3 && !(20..30).contains(&row)).collect();
    let points = [[0.0, 0.0], [1.5, 0.5], [-1.0, 1.0], [2.0, -0.5]];
    let flickers = Flickers::new((0.5, 300.0), points);
    let found = deviances(&time, &values, &valid, &flickers);
    let known: Vec<usize> = (0..time.len()).filter(|row| valid[*row]).collect();
    let samples = DVector::from_iterator(known.len(), known.iter().map(|row| values[*row]));
    for (lane, (deviance, scale)) in found.into_iter().enumerate() {
        let covariance = DMatrix::from_fn(known.len(), known.len(), |row, column| {
            let apart = (time[known[row]] - time[known[column]]).abs();
            let parts = flickers.times.iter().zip(&flickers.variances);
            let wandering: f64 = parts.map(|(time, variance)| variance[lane] * (-apart / time).exp()).sum();
            wandering + if row == column { 1.0 } else { 0.0 }
        });
        let factor = covariance.cholesky().unwrap();
        let count = crate::number(known.len());
        let variance = samples.dot(&factor.solve(&samples)) / count;
        let logs: f64 = factor.l().diagonal().iter().map(|value| 2.0 * value.ln()).sum();
        assert!((scale / variance - 1.0).abs() < 1e-9);
        assert!((deviance - (count * variance.ln() + logs + count)).abs() < 1e-6, "{lane}");
    }
}

#[test]
fn spectrum_falls_as_its_power_says() {
    for (lane, [_, power]) in [[0.0, 0.0], [0.0, 0.5]].into_iter().enumerate() {
        let flickers = Flickers::new((1.0, 1e7), [[0.0, 0.0], [0.0, 0.5], [0.0, 0.0], [0.0, 0.0]]);
        let density = |frequency: f64| -> f64 {
            let of_part = |(time, variance): (&f64, &Lanes)| {
                variance[lane] * time / (1.0 + (2.0 * PI * frequency * time).powi(2))
            };
            flickers.times.iter().zip(&flickers.variances).map(of_part).sum()
        };
        let flat = (0..=40).map(|step| 10_f64.powf(-5.5 + 0.075 * f64::from(step)));
        let flat: Vec<f64> = flat.map(|frequency| density(frequency) * frequency.powf(1.0 + power)).collect();
        let (least, most) =
            flat.iter().fold((f64::MAX, 0.0_f64), |(low, high), now| (low.min(*now), high.max(*now)));
        assert!(most / least < 1.2 / 0.8, "power {power}: {least} to {most}");
    }
}

/// By how much flicker is likelier than the best noise with one correlation time.
fn likelier(time: &[f64], values: &[f64]) -> f64 {
    let valid = vec![true; time.len()];
    let (_, known) = crate::noise::estimate(time, values, &valid, 0.0);
    known - deviance(time, values, &valid).0
}

#[test]
fn flicker_is_known_from_noise_with_one_correlation_time_and_from_white_noise() {
    let time: Vec<f64> = (0..2000).map(|row| 0.1 * f64::from(row)).collect();
    for seed in 0..5 {
        assert!(likelier(&time, &drawn(seed, time.len())) > WORTH);
        assert!(likelier(&time, &normals(seed, time.len())) < WORTH);
        let correlated = Some(Correlated { sigma: 1.0, time_constant: 3.0 });
        let mut one = vec![0.0; time.len()];
        let noise = Drawn { correlated, ..Drawn::white(0.3) };
        noise.apply(&time, &mut one, &mut Source::new(seed, "one"));
        assert!(likelier(&time, &one) < -WORTH);
    }
}

/// A straight line takes more than chance from flicker in one of some recordings where noise has one correlation time, and in none
/// where it is flicker. A line that is there takes as much.
#[test]
fn a_slow_curve_of_flicker_is_no_line() {
    let time: Vec<f64> = (0..1000).map(|row| 0.1 * f64::from(row)).collect();
    let valid = vec![true; time.len()];
    let one = |values: &[f64]| crate::noise::estimate(&time, values, &valid, 0.0).1;
    let every = |values: &[f64]| deviance(&time, values, &valid).0.min(one(values));
    let rise = |values: &[f64], deviance: &dyn Fn(&[f64]) -> f64| {
        deviance(values) - deviance(&levelled(&time, values))
    };
    let more = |deviance: &dyn Fn(&[f64]) -> f64| {
        (0..200).filter(|seed| rise(&drawn(*seed, time.len()), deviance) > CHANCE).count()
    };
    let (one, every_time) = (more(&one), more(&every));
    assert!(one > 10 && every_time <= 2, "{one} {every_time}");
    let sloping: Vec<f64> =
        drawn(1, time.len()).iter().zip(&time).map(|(noise, time)| noise + 0.5 * time).collect();
    assert!(rise(&sloping, &every) > CHANCE);
}

/// Chance takes so much with one parameter in one of three thousand cases.
const CHANCE: f64 = 13.0;

/// Values without their straight line.
fn levelled(time: &[f64], values: &[f64]) -> Vec<f64> {
    let line = DMatrix::from_fn(time.len(), 2, |row, column| if column == 0 { 1.0 } else { time[row] });
    let samples = DVector::from_column_slice(values);
    let fitted = (line.transpose() * &line).cholesky().unwrap().solve(&(line.transpose() * &samples));
    (samples - line * fitted).as_slice().to_vec()
}
