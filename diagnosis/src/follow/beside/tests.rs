//! Restricted likelihoods against whole covariance matrices, and noises against those that were drawn.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::Seen;
use crate::number;
use crate::testing::{normals, uneven};

/// A channel whose residual is this noise, with a wave that comes round twice and a zero as columns.
fn seen(time: &[f64], noise: &[f64]) -> Seen {
    let span = time.last().unwrap() - time[0];
    let columns = DMatrix::from_fn(time.len(), 4, |row, column| {
        let angle = 2.0 * TAU * time[row] / span;
        [angle.sin(), angle.cos(), 1.0, noise[row]][column]
    });
    Seen {
        valid: vec![true; time.len()],
        columns,
        places: vec![0, 1, 2, 4],
        width: 5,
        samples: number(time.len()),
        step: crate::noise::typical_step(time),
        span,
        floor: 0.0,
        time: time.to_vec(),
    }
}

/// A wandering of this standard deviation and time constant beside white noise of 1.
fn wandering(time: &[f64], (deviation, time_constant): (f64, f64), seed: u64) -> Vec<f64> {
    let drawn = normals(seed, 2 * time.len());
    let mut state = deviation * drawn[0];
    let next = |row: usize| {
        if let Some(before) = row.checked_sub(1) {
            let kept = (-(time[row] - time[before]) / time_constant).exp();
            state = kept * state + deviation * (1.0 - kept * kept).sqrt() * drawn[row];
        }
        state + drawn[time.len() + row]
    };
    (0..time.len()).map(next).collect()
}

/// Minus twice the logarithm of the restricted likelihood under white noise of 1 and a wandering, its scale at its best, and that scale: by
/// the covariance of all rows.
fn by_covariance(seen: &Seen, (deviation, time_constant): (f64, f64)) -> (f64, f64) {
    let rows = seen.time.len();
    let covariance = DMatrix::from_fn(rows, rows, |a, b| {
        let apart = (seen.time[a] - seen.time[b]).abs();
        deviation * deviation * (-apart / time_constant).exp() + if a == b { 1.0 } else { 0.0 }
    });
    let columns = seen.columns.columns(0, 3).into_owned();
    let response: DVector<f64> = seen.columns.column(3).into_owned();
    let decomposed = covariance.clone().cholesky().unwrap();
    let products = columns.transpose() * decomposed.solve(&columns);
    let fit =
        products.clone().cholesky().unwrap().solve(&(columns.transpose() * decomposed.solve(&response)));
    let left = &response - &columns * fit;
    let freedom = number(rows - 3);
    let variance = left.dot(&decomposed.solve(&left)) / freedom;
    let sizes = 2.0 * decomposed.l().diagonal().iter().map(|value| value.ln()).sum::<f64>();
    (freedom * variance.ln() + sizes + products.determinant().ln(), variance.sqrt())
}

#[test]
fn the_likelihood_is_that_of_all_directions_that_the_columns_leave() {
    let time = uneven(3, 60, 9.0);
    let seen = seen(&time, &wandering(&time, (2.0, 50.0), 4));
    for (walk, time_constant) in [(0.3_f64, 40.0_f64), (1.0, 200.0), (0.01, 9.0), (2.0, 3000.0)] {
        let point = [walk.ln(), time_constant.ln()];
        let noise = seen.noise(point);
        let left = seen.left(point).unwrap();
        let (cost, scale) = by_covariance(&seen, (noise.wander, noise.time_constant));
        assert!((left.cost - cost).abs() < 1e-6 * cost.abs(), "{noise:?}: {} and {cost}", left.cost);
        assert!((left.scale / scale - 1.0).abs() < 1e-9, "{noise:?}: {} and {scale}", left.scale);
    }
}

#[test]
fn a_point_says_how_far_a_noise_wanders_from_row_to_row() {
    let time: Vec<f64> = (0..50_u32).map(|row| 9.0 * f64::from(row)).collect();
    let seen = seen(&time, &vec![0.0; 50]);
    let noise = seen.noise([0.5_f64.ln(), 100.0_f64.ln()]);
    // What is new after a step of an Ornstein-Uhlenbeck process.
    let new = noise.wander * (1.0 - (-2.0 * 9.0 / 100.0_f64).exp()).sqrt();
    assert!((new - 0.5).abs() < 1e-12 && (noise.time_constant - 100.0).abs() < 1e-9, "{noise:?}");
}

#[test]
fn the_noises_that_may_be_hold_the_one_that_was_drawn() {
    let time = uneven(5, 400, 9.0);
    for (deviation, time_constant) in [(0.0, 9.0), (3.0, 100.0), (3.0, 3e4)] {
        let seen = seen(&time, &wandering(&time, (deviation, time_constant), 6));
        let around = seen.around();
        let of_truth =
            by_covariance(&seen, (deviation, time_constant)).0 - 2.0 * super::LASTING * time_constant.ln();
        let least = around.iter().map(|known| known.cost).fold(f64::INFINITY, f64::min);
        // Chi-squared of two degrees of freedom passes 9.2 once in a hundred cases.
        assert!(least < of_truth + 0.5, "the truth is likelier by {} than all", least - of_truth);
        assert!(deviation == 0.0 || of_truth < least + 9.2, "{}", of_truth - least);
        assert!((4..100).contains(&around.len()), "{} points", around.len());
    }
}

#[test]
fn columns_that_are_not_there_have_no_products() {
    let time = uneven(7, 30, 9.0);
    let seen = seen(&time, &normals(8, 30));
    let left = seen.left([0.1_f64.ln(), 9.0_f64.ln()]).unwrap();
    let whole = seen.whole(&left.products);
    assert!(whole.column(3).iter().chain(whole.row(3).iter()).all(|value| *value == 0.0));
    assert_eq!(whole[(4, 1)], left.products[(3, 1)]);
}

#[test]
fn few_samples_beside_the_columns_tell_no_noise() {
    for (rows, is_told) in [(5, false), (6, true)] {
        let time = uneven(9, rows, 9.0);
        assert_eq!(!seen(&time, &normals(10, rows)).around().is_empty(), is_told, "{rows} rows");
    }
}
