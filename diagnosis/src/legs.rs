//! Legs: stretches of rows through which the axes were driven without a break.
//!
//! In: times, runs and programmed positions. Out: for each row the number of its leg. Nothing is driven over a gap or from one run
//! to the next: a leg begins at rest where its first row stands, and nothing that happens on the way goes from leg to leg. A run
//! is no leg of its own where the axes plainly went on: a number that changes in the middle of a motion stops no machine.

use std::ops::Range;

use crate::noise::typical_step;
use crate::states::Shared;

/// A step of time that is this many times the typical one is a gap: no clock of a recorder wanders so far.
pub(crate) const GAP: f64 = 20.0;
/// Between two runs, a step of time that is this many times the typical one is a pause: where the number of the run changes in motion, no
/// row is missing.
const PAUSE: f64 = 1.5;

/// The last row of a run may be one step from its very end, and the first row of the next one from its beginning.
const REACH: f64 = 2.0;

/// The share of its speed by which an axis may be off what its speeds before and behind a gap allow: as much as a path may turn
/// without a sharp corner.
const SLACK: f64 = crate::way::CORNER;

/// The rounding of a programmed position, as a share of its travel.
const ROUNDING: f64 = 1e-9;

/// The number of the leg of each row, counted from 0.
pub(crate) fn legs(time: &[f64], run: &[i64], programmed: &[Shared]) -> Vec<usize> {
    let typical = typical_step(time);
    let mut leg = 0;
    let mut legs = Vec::with_capacity(time.len());
    for row in 0..time.len() {
        if row > 0 && !goes_on(time, run, programmed, row, typical) {
            leg += 1;
        }
        legs.push(leg);
    }
    legs
}

/// The rows of each leg.
pub(crate) fn stretches(legs: &[usize]) -> impl Iterator<Item = Range<usize>> {
    let mut start = 0;
    legs.chunk_by(|before, after| before == after).map(move |leg| {
        let rows = start..start + leg.len();
        start = rows.end;
        rows
    })
}

/// How far from the end of a leg the next one may begin as if it went on: [`REACH`] times as far as an axis comes from row to row
/// within legs. Among points that are read at rest a new run is a new number.
pub(crate) fn reach(legs: &[usize], position: &[f64]) -> f64 {
    let pairs = legs.windows(2).zip(position.windows(2)).filter(|(legs, _)| legs[0] == legs[1]);
    let steps = pairs.map(|(_, position)| (position[1] - position[0]).abs());
    REACH * steps.filter(|step| step.is_finite()).fold(0.0, f64::max)
}

/// Whether the axes were driven on from the row before.
fn goes_on(time: &[f64], run: &[i64], programmed: &[Shared], row: usize, typical: f64) -> bool {
    let (pause, same) = (time[row] - time[row - 1], run[row] == run[row - 1]);
    if same && pause <= GAP * typical {
        return true;
    }
    let step = |row: usize| {
        let near = run[row] == run[row - 1] && time[row] - time[row - 1] <= GAP * typical;
        near.then(|| time[row] - time[row - 1])
    };
    (same || pause <= PAUSE * typical)
        && programmed.iter().all(|position| {
            let speed = |row: usize| {
                let known = step(row).map(|step| (position[row] - position[row - 1]) / step);
                known.filter(|speed| speed.is_finite()).unwrap_or(0.0)
            };
            let before = if row > 1 { speed(row - 1) } else { 0.0 };
            let behind = if row + 1 < time.len() { speed(row + 1) } else { 0.0 };
            let way = position[row] - position[row - 1];
            // Nothing is known of an axis whose position is missing.
            way.is_nan() || allowed(way, pause, before, behind, !same, position[row])
        })
}

/// Whether an axis may have gone this way in this time, with these speeds before and behind it. From one run to the next it must have
/// moved on both sides or on none: a run that ends in motion and the next that begins at rest are two motions.
fn allowed(way: f64, time: f64, before: f64, behind: f64, runs: bool, place: f64) -> bool {
    let slack = SLACK * before.abs().max(behind.abs()) * time + ROUNDING * place.abs();
    let within = way >= before.min(behind) * time - slack && way <= before.max(behind) * time + slack;
    within && !(runs && (before == 0.0) != (behind == 0.0))
}

#[cfg(test)]
mod tests;
