//! What is an outlier, and what is an event.

use super::*;
use crate::testing::normals;

fn noise() -> Vec<f64> {
    normals(61, 400)
}

fn marked(residual: &[f64]) -> Vec<usize> {
    mark(residual).iter().enumerate().filter(|(_, marked)| **marked).map(|(row, _)| row).collect()
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
fn nothing_is_marked_where_nothing_is() {
    assert!(mark(&[]).is_empty());
    assert_eq!(mark(&[3.0]), [false]);
    assert_eq!(mark(&[f64::NAN; 5]), [false; 5]);
    assert_eq!(mark(&[2.0; 9]), [false; 9]);
}
