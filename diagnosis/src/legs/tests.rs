//! Legs of runs and gaps as people make them.

use super::*;

const STEP: f64 = 0.01;

/// A motion with this speed, mm/s, begun and ended by some rows at rest.
fn sweep(from: f64, speed: f64) -> Vec<f64> {
    (0..60).map(|row: i32| from + STEP * speed * f64::from((row - 5).clamp(0, 50))).collect()
}

fn clock(rows: usize) -> Vec<f64> {
    (0..rows).map(|row| STEP * crate::number(row)).collect()
}

/// The first rows of the legs but the first.
fn breaks(time: &[f64], run: &[i64], position: Vec<f64>) -> Vec<usize> {
    stretches(&legs(time, run, &[position.into()])).map(|rows| rows.start).skip(1).collect()
}

fn runs(lengths: &[usize]) -> Vec<i64> {
    (1_i64..).zip(lengths).flat_map(|(run, length)| vec![run; *length]).collect()
}

#[test]
fn runs_that_begin_elsewhere_or_after_a_pause_are_legs() {
    let one_way = [sweep(0.0, 20.0), sweep(0.0, 50.0)].concat();
    assert_eq!(breaks(&clock(120), &runs(&[60, 60]), one_way), [60]);
    let there_and_back = [sweep(0.0, 20.0), sweep(10.0, -20.0)].concat();
    assert_eq!(breaks(&clock(120), &runs(&[60, 60]), there_and_back.clone()), [0; 0]);
    let mut paused = clock(120);
    paused[60..].iter_mut().for_each(|time| *time += 1.0);
    assert_eq!(breaks(&paused, &runs(&[60, 60]), there_and_back), [60]);
}

#[test]
fn a_number_that_changes_in_motion_is_no_leg() {
    let ramp: Vec<f64> = (0..120).map(|row| 0.3 * f64::from(row)).collect();
    assert_eq!(breaks(&clock(120), &runs(&[60, 60]), ramp.clone()), [0; 0]);
    let turned: Vec<f64> = (0..120).map(|row: i32| 0.3 * f64::from(60 - (row - 60).abs())).collect();
    assert_eq!(breaks(&clock(120), &runs(&[60, 60]), turned), [0; 0]);
    // The one ends in motion, the other begins at rest where that ended.
    let stopped: Vec<f64> = (0..120).map(|row: i32| 0.3 * f64::from(row.min(59))).collect();
    assert_eq!(breaks(&clock(120), &runs(&[60, 60]), stopped), [60]);
}

#[test]
fn a_gap_is_a_break_where_the_speed_does_not_bridge_it() {
    let mut time = clock(120);
    time[60..].iter_mut().for_each(|time| *time += 1.0);
    let one = runs(&[120]);
    assert_eq!(breaks(&time, &one, [vec![0.0; 60], vec![300.0; 60]].concat()), [60]);
    assert_eq!(breaks(&time, &one, vec![7.0; 120]), [0; 0]);
    assert_eq!(breaks(&time, &one, time.iter().map(|time| 9.0 * time).collect()), [0; 0]);
    // Rows that are missing alone are no break.
    assert_eq!(breaks(&clock(120), &one, [vec![0.0; 60], vec![300.0; 60]].concat()), [0; 0]);
}

#[test]
fn rows_of_legs_follow_one_another() {
    assert_eq!(stretches(&[0, 0, 1, 2, 2]).collect::<Vec<_>>(), [0..2, 2..3, 3..5]);
    assert_eq!(stretches(&[]).count(), 0);
    assert_eq!(legs(&[0.0], &[1], &[vec![3.0].into()]), [0]);
}
