//! `expansion`: a scale or a screw that grows with its temperature. In: a temperature and a position. Out: (T - T0) q.

use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "The scale or the screw expands with its temperature: an error proportional to travel and to \
    the difference from 20 degC. Plausible: some 1e-6 to 2e-5 per kelvin; steel has 11.5e-6.";

/// Coefficients, 1/K: aluminium, the softest of screws and scales, has 2.4e-5.
pub(super) const PLAUSIBLE: (f64, f64) = (0.0, 3e-5);

pub(super) fn fill(rows: &Rows<'_>, axis: usize, sensor: usize, reference: f64, out: &mut Vec<f64>) {
    let temperatures = rows.temperature(sensor).iter();
    out.extend(temperatures.zip(rows.axis(axis).position).map(|(t, q)| (t - reference) * q));
}
