//! `vibration`: amplifier noise, mains, imbalance. In: time. Out: sine and cosine of 2 pi f t.

use super::wave;
use crate::states::Rows;

pub(super) fn fill(rows: &Rows<'_>, frequency: f64, out: &mut [Vec<f64>]) {
    wave(rows.time.iter().map(|time| time * frequency), out);
}
