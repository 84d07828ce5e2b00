//! Corners: rows around which it is not recorded what an axis did.
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
    let slope = slopes(time, position);
    let fastest = fastest(time, legs, &slope);
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

/// Rows on both sides of a sharp reversal of a path that was rounded: within the step it is not known where it lies, nor how far the
/// axis went.
pub(crate) fn beside_reversals(time: &[f64], legs: &[usize], position: &[f64]) -> Vec<bool> {
    let slope = slopes(time, position);
    let fastest = fastest(time, legs, &slope);
    let mut beside = vec![false; time.len()];
    for row in 2..time.len() {
        let (before, behind) = (slope(row - 1), slope(row));
        let turns = before * behind < 0.0 && (behind - before).abs() > CORNER * fastest;
        if turns && legs[row - 2] == legs[row] {
            beside[row - 1..=row].fill(true);
        }
    }
    beside
}

/// The speed with which an axis comes to a row.
fn slopes<'a>(time: &'a [f64], position: &'a [f64]) -> impl Fn(usize) -> f64 + 'a {
    |row| (position[row] - position[row - 1]) / (time[row] - time[row - 1])
}

fn fastest(time: &[f64], legs: &[usize], slope: &impl Fn(usize) -> f64) -> f64 {
    (1..time.len())
        .filter(|row| legs[*row] == legs[row - 1])
        .map(|row| slope(row).abs())
        .filter(|slope| slope.is_finite())
        .fold(0.0, f64::max)
}

/// The least share of the highest speed by which the speed changes before and behind such a row.
const MIXED: f64 = 0.02;
