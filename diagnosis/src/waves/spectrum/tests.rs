//! The spectrum against least squares written out, and its peaks.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::*;
use crate::testing::{normals, uneven};

/// The spectrum of a residual of rows that weigh alike.
fn of(places: &[f64], residual: &[f64], low: f64, range: f64, shortest: f64) -> Vec<Line> {
    let weights = vec![1.0; places.len()];
    spectrum(&[Rows { places, weighted: residual, weights: &weights }], low, range, shortest)
}

/// By how much weighted least squares of a mean, a sine and a cosine leaves less than that of the mean alone.
fn gained(places: &[f64], values: &[f64], weights: &[f64], frequency: f64) -> f64 {
    let left = |columns: usize| {
        let design = DMatrix::from_fn(places.len(), columns, |row, column| {
            let (sine, cosine) = (TAU * frequency * places[row]).sin_cos();
            [1.0, sine, cosine][column] * weights[row].sqrt()
        });
        let seen = DVector::from_fn(values.len(), |row, _| values[row] * weights[row].sqrt());
        let fitted = design.clone().svd(true, true).solve(&seen, 1e-12).unwrap();
        (seen - design * fitted).norm_squared()
    };
    left(1) - left(3)
}

#[test]
fn each_line_is_what_least_squares_gains_beside_a_free_mean() {
    let (low, range, shortest) = (-40.0, 200.0, 4.0);
    // Half of the rows lie at one place, where the axis rests.
    let moving = uneven(71, 80, 2.4).into_iter().map(|place| low + place);
    let places: Vec<f64> = moving.chain(std::iter::repeat_n(low + 1.0, 80)).collect();
    assert!(places.iter().all(|place| (low..low + range).contains(place)));
    let values: Vec<f64> = normals(72, 160).into_iter().map(|value| 3.0 + value).collect();
    let weights: Vec<f64> = (0..160).map(|row| if row % 3 == 0 { 4.0 } else { 1.0 }).collect();
    let weighted: Vec<f64> = values.iter().zip(&weights).map(|(value, weight)| value * weight).collect();
    let rows = [Rows { places: &places, weighted: &weighted, weights: &weights }];
    let found = spectrum(&rows, low, range, shortest);
    assert!((found.last().unwrap().0 - 1.0 / shortest).abs() < 1.0 / range);
    let slow = found.iter().filter(|(frequency, _)| (2.0 / range..0.2 / shortest).contains(frequency));
    let total: f64 = weights.iter().sum();
    for (frequency, gain) in slow {
        let expected = gained(&places, &values, &weights, *frequency);
        // Sorting into bins moves a place by a sixtieth of a period at most.
        assert!(
            (gain - expected).abs() < 0.05 * (expected * total).sqrt() + 0.02 * total,
            "{frequency}: {gain} {expected}"
        );
    }
}

#[test]
fn a_wave_stands_out_at_its_frequency_with_what_it_would_gain() {
    for period in [7.3, 12.0, 31.0] {
        let places: Vec<f64> = (0..900).map(|row| 0.37 * f64::from(row)).collect();
        let wave: Vec<f64> = places.iter().map(|place| (TAU * place / period + 0.7).sin()).collect();
        let found = tops(&of(&places, &wave, 0.0, 333.0, 2.0), 2.0 / 333.0, 3);
        let top = found.iter().max_by(|a, b| a.gain.total_cmp(&b.gain)).unwrap();
        assert!(
            (top.frequency * period - 1.0).abs() < 0.1 * period / 333.0,
            "{period}: {}",
            1.0 / top.frequency
        );
        // n / 2, less what lies between two lines of the spectrum.
        assert!(top.gain > 0.8 * 450.0 && top.gain < 1.02 * 450.0, "{period}: {}", top.gain);
    }
}

#[test]
fn a_wave_is_found_beside_a_noise_that_is_louder_at_other_frequencies() {
    // A walk: its slow lines are a thousand times as high as that of the wave.
    let places: Vec<f64> = (0..2000).map(f64::from).collect();
    let mut walked = 0.0;
    let values: Vec<f64> = normals(73, 2000)
        .into_iter()
        .zip(&places)
        .map(|(step, place)| {
            walked += step;
            walked + 1.5 * (TAU * place / 12.5).sin()
        })
        .collect();
    let lines = of(&places, &values, 0.0, 2000.0, 2.2);
    let found = tops(&lines, 1.6 / 2000.0, 3);
    let near = |top: &&Top| (top.frequency * 12.5 - 1.0).abs() < 0.01;
    let wave = found.iter().find(near);
    let wave = wave.unwrap_or_else(|| panic!("the wave is none of the peaks: {found:?}"));
    assert!(found.iter().all(|other| other.local <= wave.local), "{found:?}");
    let loudest = lines.iter().fold(0.0, |most: f64, line| most.max(line.1));
    assert!(loudest > 10.0 * wave.gain, "by its power alone it would not be looked at");
}

#[test]
fn where_all_rows_see_one_phase_nothing_is_gained() {
    let places = vec![5.0; 100];
    assert!(of(&places, &normals(74, 100), 0.0, 10.0, 1.0).iter().all(|(_, gain)| *gain == 0.0));
    assert!(of(&[], &[], 0.0, 10.0, 1.0).iter().all(|(_, gain)| *gain == 0.0));
}

#[test]
fn peaks_are_tops_above_a_frequency() {
    let spectrum: Vec<Line> = [9.0, 4.0, 1.0, 4.0, 1.0, 0.0, 9.0, 16.0, 9.0, 0.0]
        .into_iter()
        .enumerate()
        .map(|(n, gain)| (crate::number(n), gain))
        .collect();
    let places = |above: f64, count: usize| -> Vec<f64> {
        tops(&spectrum, above, count).iter().map(|top| top.frequency).collect()
    };
    assert_eq!(places(2.0, 5), [7.0, 3.0]);
    assert_eq!(places(5.0, 5), [7.0]);
    assert_eq!(places(2.0, 1), [7.0]);
    assert!(tops(&[], 0.0, 3).is_empty());
    // Between two lines the top leans to the higher one.
    let leaning = [(0.0, 0.0), (1.0, 9.0), (2.0, 16.0), (3.0, 1.0)];
    let top = tops(&leaning, 0.5, 1)[0];
    assert!((1.5..2.0).contains(&top.frequency), "{top:?}");
}

/// Where an axis turns there are the most rows, and there alone a model is off. A wave that is plain along the rest of the travel stands out
/// where all stretches weigh alike, and noise does not.
#[test]
fn a_wave_is_found_beside_what_a_model_lacks_where_an_axis_turns() {
    let strokes = (0..4000).map(|row| 100.0 - 100.0 * (TAU * f64::from(row) / 2000.0).cos());
    let places: Vec<f64> = strokes.collect();
    // Behind each turn the axis is off by ten times the wave, over a fiftieth of the travel.
    let turned = |place: f64| if place < 4.0 { 10.0 * (1.0 - place / 4.0) } else { 0.0 };
    let noise = normals(74, 4000);
    let seen = |wave: f64| -> Vec<f64> {
        let one = |(place, noise): (&f64, &f64)| turned(*place) + wave * (TAU * place / 13.0).sin() + noise;
        places.iter().zip(&noise).map(one).collect()
    };
    let weights = vec![1.0; places.len()];
    let local = |values: &[f64], spectrum: fn(&[Rows<'_>], f64, f64, f64) -> Vec<Line>| {
        let rows = [Rows { places: &places, weighted: values, weights: &weights }];
        let lines = spectrum(&rows, 0.0, 200.0, 2.0);
        tops_by_place(&lines, &lines, 3.0 / 200.0, 1)[0]
    };
    let (of_rows, of_places) = (local(&seen(1.0), super::spectrum), local(&seen(1.0), spectrum_by_place));
    assert!((of_places.frequency * 13.0 - 1.0).abs() < 0.02, "{of_places:?}");
    // A wave pays some 20, and stands out with twice as much.
    assert!(of_places.local > 40.0 && of_rows.local < 20.0, "{of_places:?} {of_rows:?}");
    assert!(local(&seen(0.0), spectrum_by_place).local < 20.0);
}
