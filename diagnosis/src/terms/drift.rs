//! `drift`: a warm-up without a sensor, a fixture that settles. In: time. Out: 1 - exp(-t / time constant).

use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "Something settles with time, and no sensor shows it: a warm-up, a fixture, a clamp. Plausible: \
    micrometres, within minutes to hours.";

pub(super) fn fill(rows: &Rows<'_>, time_constant: f64, out: &mut Vec<f64>) {
    out.extend(rows.time.iter().map(|time| -(-time / time_constant).exp_m1()));
}
