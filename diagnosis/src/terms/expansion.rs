//! `expansion`: a scale or a screw that grows with its temperature. In: a temperature and a position. Out: (T - T0) q.

use crate::states::Rows;

pub(super) fn fill(rows: &Rows<'_>, axis: usize, sensor: usize, reference: f64, out: &mut Vec<f64>) {
    let temperatures = rows.temperature(sensor).iter();
    out.extend(temperatures.zip(rows.axis(axis).position).map(|(t, q)| (t - reference) * q));
}
