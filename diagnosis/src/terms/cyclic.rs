//! `cyclic`: an error that repeats with a screw's pitch, a gear's teeth or an encoder's lines. In: positions. Out: sine
//! and cosine of 2 pi (q - center) / period.

use std::f64::consts::TAU;

use super::wave;
use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "An error that repeats with travel: a ball screw with the period of its lead, a gear with the \
    period of its teeth, or the interpolation of an encoder with its line spacing. Plausible: a few micrometres at the pitch of \
    the screw, or a fraction of a micrometre at the encoder's period.";

pub(super) fn fill(rows: &Rows<'_>, axis: usize, period: f64, center: f64, out: &mut [Vec<f64>]) {
    wave(rows.axis(axis).position.iter().map(|position| (position - center) / period), out);
}

/// How its phase, rad, changes with the length of the wave whose harmonic of this order it is.
pub(super) fn phase_slope(rows: &Rows<'_>, axis: usize, period: f64, order: u32, center: f64) -> Vec<f64> {
    let each = -TAU * f64::from(order) / period.powi(2);
    rows.axis(axis).position.iter().map(|position| each * (position - center)).collect()
}
