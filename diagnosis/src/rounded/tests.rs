//! Ways that were rounded, against the ways themselves.

use super::*;
use crate::testing::{distance, normals};

fn clock(rows: usize) -> Vec<f64> {
    (0..rows).map(|row| 0.1 * crate::number(row)).collect()
}

fn found(way: &[f64], step: f64) -> Option<Rounded> {
    let command: Vec<f64> = way.iter().map(|place| (place / step).round() * step).collect();
    unrounded(&clock(way.len()), &command, std::iter::once(0..way.len()))
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / crate::number(a.len())).sqrt()
}

#[test]
fn a_way_to_and_fro_is_found_behind_its_rounding() {
    for (speed, step) in [(0.617, 0.1), (0.617, 0.2), (3.33, 0.5), (1.234, 0.05)] {
        let triangle = |row: usize| {
            let at = speed * crate::number(row);
            let turn = 4.0 * 60.0;
            ((at + 60.0) % turn - 0.5 * turn).abs()
        };
        let way: Vec<f64> = (0..1500).map(triangle).collect();
        let rounded = found(&way, step).unwrap();
        assert!((rounded.step - step).abs() < 1e-9);
        let left = rms(&rounded.way, &way);
        assert!(left < 0.4 * deviation(step), "{step}: {left}");
        assert!(distance(&rounded.way, &way) < step);
    }
}

#[test]
fn a_circle_keeps_its_form() {
    let way: Vec<f64> = (0..3000).map(|row| 75.0 * (0.01 * f64::from(row)).sin()).collect();
    let rounded = found(&way, 0.1).unwrap();
    assert!(rms(&rounded.way, &way) < deviation(0.1));
    assert!(distance(&rounded.way, &way) < 0.1);
}

#[test]
fn programs_are_not_rounded() {
    // Stations at whole mm, each read thrice; a motion by the same step in every row; a command in full.
    let stations: Vec<f64> = (0..90).map(|row: i32| f64::from(25 * (row / 3))).collect();
    assert!(unrounded(&clock(90), &stations, std::iter::once(0..90)).is_none());
    let even: Vec<f64> = (0..90).map(f64::from).collect();
    assert!(unrounded(&clock(90), &even, std::iter::once(0..90)).is_none());
    let full: Vec<f64> = (0..90).map(|row| 40.0 * (0.07 * f64::from(row)).sin()).collect();
    assert!(unrounded(&clock(90), &full, std::iter::once(0..90)).is_none());
    // To a micrometre on 100 mm: nothing hides in that.
    let fine: Vec<f64> = full.iter().map(|place| (place * 1e3).round() * 1e-3).collect();
    assert!(unrounded(&clock(90), &fine, std::iter::once(0..90)).is_none());
    let noise = normals(1, 90);
    assert!(unrounded(&clock(90), &noise, std::iter::once(0..90)).is_none());
}

#[test]
fn the_beat_of_a_display_is_half_a_step_and_noise_blurs_it() {
    let step_of = deviation(0.1);
    assert!((super::beat(step_of, step_of) - 0.05).abs() < 1e-12);
    assert_eq!(super::beat(0.0, 1.0), 0.0);
    // The mean of many readings of one place: rounded after noise was added, it is off by less than is said, at the worst place.
    for sigma in [0.01, 0.03, 0.06] {
        let noise = normals(7, 20_000);
        let off = |place: f64| {
            let sum: f64 =
                noise.iter().map(|noise| ((place + sigma * noise) / 0.1).round() * 0.1 - place).sum();
            (sum / crate::number(noise.len())).abs()
        };
        let worst = (0..40).map(|part| off(0.0025 * f64::from(part))).fold(0.0, f64::max);
        let said = super::beat(step_of, sigma.hypot(step_of));
        assert!(worst < said + 3.0 * sigma / 20_000f64.sqrt(), "{sigma}: {worst} of {said}");
        assert!(said < 0.05);
    }
}
