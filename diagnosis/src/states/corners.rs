//! Corners: rows before which it is not recorded what an axis did.
//!
//! In: times, legs and programmed positions. Out: the rows behind a corner of the path that lies between two rows, and those in which
//! it is not known from which side an axis came.

use crate::legs::reach;
use crate::way::CORNER;

/// Rows in which it is not known from which side an axis came to its place: it stands where it stood in the row before, and leaves
/// the other way than it came. The cycle of ISO 230-2 goes beyond its last target and comes back in between; a path without an
/// overrun does not.
pub(crate) fn unseen_turns(legs: &[usize], position: &[f64]) -> Vec<bool> {
    let known = || position.iter().copied().filter(|position| position.is_finite());
    let range = known().fold(f64::NEG_INFINITY, f64::max) - known().fold(f64::INFINITY, f64::min);
    let near = reach(legs, position);
    let mut unseen = vec![false; position.len()];
    let mut came = 0.0;
    let mut first = 0;
    for row in 1..position.len() {
        let step = position[row] - position[row - 1];
        // How an axis came to a leg that begins elsewhere than the last one ended is not asked.
        if legs[row] != legs[row - 1] && step.abs() > near {
            (came, first) = (0.0, row);
            continue;
        }
        // A missing position is no step: nothing is known of it. A millionth of the travel is rounding.
        if step.is_nan() || step.abs() <= 1e-6 * range {
            continue;
        }
        if came * step < 0.0 {
            unseen[first + 1..row].fill(true);
        }
        (came, first) = (step, row);
    }
    unseen
}

/// Rows behind a corner of the path that lies between two rows: where the axis was on the way is not recorded, so that no
/// loop and no clock can be judged by them.
pub(crate) fn behind_corners(time: &[f64], legs: &[usize], position: &[f64]) -> Vec<bool> {
    let slope = |row: usize| (position[row] - position[row - 1]) / (time[row] - time[row - 1]);
    let fastest = (1..time.len())
        .filter(|row| legs[*row] == legs[row - 1])
        .map(|row| slope(row).abs())
        .filter(|slope| slope.is_finite())
        .fold(0.0, f64::max);
    (0..time.len())
        .map(|row| {
            let inside = row >= 2 && row + 1 < time.len() && legs[row - 2] == legs[row + 1];
            let (before, here, after) =
                if inside { (slope(row - 1), slope(row), slope(row + 1)) } else { return false };
            let mixed = (here - before).abs().min((after - here).abs()) > MIXED * fastest;
            mixed && (after - before).abs() > CORNER * fastest
        })
        .collect()
}

/// The least share of the highest speed by which the speed changes before and behind such a row.
const MIXED: f64 = 0.02;
