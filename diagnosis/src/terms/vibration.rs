//! `vibration`: amplifier noise, mains, imbalance. In: time. Out: sine and cosine of 2 pi f t.

use std::f64::consts::TAU;

use super::wave;
use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "An oscillation in time that does not depend on the positions of the axes: mains, an amplifier, \
    an imbalance, a pump. Its frequency is the best clue.";

pub(super) fn fill(rows: &Rows<'_>, frequency: f64, out: &mut [Vec<f64>]) {
    wave(rows.time.iter().map(|time| time * frequency), out);
}

/// How its phase, rad, changes with its frequency, Hz.
pub(super) fn phase_slope(rows: &Rows<'_>) -> Vec<f64> {
    rows.time.iter().map(|time| TAU * time).collect()
}
