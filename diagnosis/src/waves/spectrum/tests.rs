//! The spectrum against sums written out, and its peaks.

use std::f64::consts::TAU;

use super::*;
use crate::testing::{normals, uneven};

#[test]
fn the_spectrum_is_the_squared_fourier_sum_at_uneven_places() {
    let (low, range, shortest) = (-40.0, 200.0, 4.0);
    let places: Vec<f64> = uneven(71, 160, 1.2).iter().map(|place| low + place).collect();
    assert!(places.iter().all(|place| (low..low + range).contains(place)));
    let weights = normals(72, 160);
    let weighted = std::slice::from_ref(&weights);
    let found: Vec<(f64, f64)> = spectrum(weighted, &[&places], low, range, shortest).collect();
    assert_eq!(found[0].0, 0.0);
    assert!((found.last().unwrap().0 - 1.0 / shortest).abs() < 1.0 / range);
    let total: f64 = weights.iter().map(|weight| weight * weight).sum();
    for (frequency, power) in found.iter().filter(|(frequency, _)| *frequency < 0.3 / shortest) {
        let sum = |part: fn(f64) -> f64| -> f64 {
            weights.iter().zip(&places).map(|(weight, place)| weight * part(TAU * frequency * place)).sum()
        };
        let expected = sum(f64::cos).powi(2) + sum(f64::sin).powi(2);
        // Sorting into bins moves a place by half a bin on average the same, and by half a bin at most beside that.
        assert!(
            (power - expected).abs() < 0.6 * (expected * total).sqrt() + 0.05 * total,
            "{frequency}: {power} {expected}"
        );
    }
}

#[test]
fn a_wave_stands_out_at_its_frequency_with_what_it_would_gain() {
    for period in [7.3, 12.0, 31.0] {
        let places: Vec<f64> = (0..900).map(|row| 0.37 * f64::from(row)).collect();
        let wave: Vec<f64> = places.iter().map(|place| (TAU * place / period + 0.7).sin()).collect();
        let found = best(spectrum(&[wave], &[&places], 0.0, 333.0, 2.0), 2.0 / 333.0, 3);
        let (frequency, power) = found[0];
        assert!((frequency * period - 1.0).abs() < 0.1 * period / 333.0, "{period}: {}", 1.0 / frequency);
        // (n / 2)^2, less what lies between two lines of the spectrum.
        assert!(power > 0.8 * 450.0_f64.powi(2) && power < 1.02 * 450.0_f64.powi(2), "{period}: {power}");
        assert!(found[1..].iter().all(|(_, other)| *other < 0.2 * power));
    }
}

#[test]
fn peaks_are_tops_above_a_frequency() {
    let spectrum: Vec<(f64, f64)> = [9.0, 4.0, 1.0, 4.0, 1.0, 0.0, 9.0, 16.0, 9.0, 0.0]
        .into_iter()
        .enumerate()
        .map(|(n, power)| (crate::number(n), power))
        .collect();
    let best = |above, count| best(spectrum.iter().copied(), above, count);
    let found = best(2.0, 5);
    assert_eq!(found, [(7.0, 16.0), (3.0, 4.0)]);
    assert_eq!(best(5.0, 5), [(7.0, 16.0)]);
    assert_eq!(best(2.0, 1).len(), 1);
    assert!(super::best(std::iter::empty(), 0.0, 3).is_empty());
    // Between two lines the top leans to the higher one.
    let leaning = [(0.0, 0.0), (1.0, 9.0), (2.0, 16.0), (3.0, 1.0)];
    let (place, _) = super::best(leaning.into_iter(), 0.5, 1)[0];
    assert!((1.5..2.0).contains(&place), "{place}");
}
