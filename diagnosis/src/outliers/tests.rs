//! What is an outlier, and what is an event.

use super::*;
use crate::testing::normals;

fn noise() -> Vec<f64> {
    normals(61, 400)
}

/// The outliers where no other pass came by.
fn marked(residual: &[f64]) -> Vec<usize> {
    marked_with(residual, 0.0, &|_, _| true)
}

fn marked_with(residual: &[f64], step: f64, apart: &dyn Fn(usize, f64) -> bool) -> Vec<usize> {
    let marks = mark(residual, step, apart);
    marks.iter().enumerate().filter(|(_, marked)| **marked).map(|(row, _)| row).collect()
}

#[test]
fn single_samples_and_pairs_far_off_are_marked_wherever_they_stand() {
    assert!(marked(&noise()).is_empty());
    let mut spoiled = noise();
    for (row, by) in [(0, 40.0), (57, -30.0), (120, 25.0), (121, 25.0), (399, -50.0)] {
        spoiled[row] += by;
    }
    assert_eq!(marked(&spoiled), [0, 57, 120, 121, 399]);
    // Beside a gap too, and whatever slope or step lies below.
    spoiled[58..70].fill(f64::NAN);
    assert_eq!(marked(&spoiled), [0, 57, 120, 121, 399]);
    let sloped: Vec<f64> =
        spoiled.iter().zip(0_u32..).map(|(value, row)| value + 0.05 * f64::from(row)).collect();
    assert_eq!(marked(&sloped), [0, 57, 120, 121, 399]);
}

#[test]
fn what_lasts_is_no_outlier() {
    let mut jumped = noise();
    jumped[200..].iter_mut().for_each(|value| *value += 60.0);
    assert!(marked(&jumped).is_empty(), "{:?}", marked(&jumped));
    let mut dented = noise();
    dented[200..212].iter_mut().for_each(|value| *value += 60.0);
    assert!(marked(&dented).is_empty(), "{:?}", marked(&dented));
}

#[test]
fn a_walk_has_no_outliers_however_far_it_goes() {
    for seed in 0..20 {
        let mut place = 0.0;
        let walk: Vec<f64> = normals(100 + seed, 1000)
            .into_iter()
            .map(|step| {
                place += step;
                place
            })
            .collect();
        assert!(marked(&walk).is_empty(), "{seed}: {:?}", marked(&walk));
    }
}

#[test]
fn what_other_passes_read_there_too_is_no_outlier() {
    let mut spoiled = noise();
    spoiled[57] += 40.0;
    spoiled[200] += 40.0;
    assert_eq!(marked_with(&spoiled, 0.0, &|row, _| row == 200), [200]);
}

#[test]
fn a_few_steps_of_a_coarse_display_are_none() {
    // At rest the display shows one number, and now and then the next one or two.
    let shown = |far: f64| {
        let mut shown = vec![0.0; 400];
        for row in (9..400).step_by(37) {
            shown[row] = if row % 2 == 0 { 2.0 } else { -1.0 };
        }
        shown[201] = far;
        shown
    };
    assert!(marked_with(&shown(4.0), 1.0, &|_, _| true).is_empty());
    assert_eq!(marked_with(&shown(40.0), 1.0, &|_, _| true), [201]);
}

#[test]
fn where_an_axis_moves_the_scatter_is_another() {
    // Quiet at rest, a hundred times as loud on the way: nothing on the way is an outlier at rest.
    let mut values = noise();
    values.iter_mut().enumerate().for_each(|(row, value)| {
        if row / 50 % 4 != 0 {
            *value *= 0.01;
        }
    });
    assert!(marked(&values).len() < 3, "{:?}", marked(&values));
    values[130] += 1.0;
    assert!(marked(&values).contains(&130));
}

#[test]
fn where_too_many_are_marked_none_is() {
    let mut spoiled = noise();
    (5..400).step_by(8).for_each(|row| spoiled[row] += 60.0);
    assert!(marked(&spoiled).is_empty(), "one in eight is no outlier");
}

#[test]
fn nothing_is_marked_where_nothing_is() {
    assert!(marked(&[]).is_empty());
    assert!(marked(&[3.0]).is_empty());
    assert!(marked(&[f64::NAN; 5]).is_empty());
    assert!(marked(&[2.0; 9]).is_empty());
}
