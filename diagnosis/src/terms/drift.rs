//! `drift`: a warm-up without a sensor, a fixture that settles. In: time. Out: 1 - exp(-t / time constant).

use crate::states::Rows;

pub(super) fn fill(rows: &Rows<'_>, time_constant: f64, out: &mut Vec<f64>) {
    out.extend(rows.time.iter().map(|time| -(-time / time_constant).exp_m1()));
}
