//! `cyclic`: an error that repeats with a screw's pitch, a gear's teeth or an encoder's lines. In: positions. Out: sine
//! and cosine of 2 pi q / period.

use super::wave;
use crate::states::Rows;

pub(super) fn fill(rows: &Rows<'_>, axis: usize, period: f64, out: &mut [Vec<f64>]) {
    wave(rows.axis(axis).position.iter().map(|position| position / period), out);
}
