//! `reversal-spike`: stick-slip and static friction where an axis turns round. In: the time since each reversal. Out:
//! -d exp(-(t - t_reversal) / decay).

use crate::states::Rows;

pub(super) fn fill(rows: &Rows<'_>, axis: usize, decay: f64, out: &mut Vec<f64>) {
    let axis = rows.axis(axis);
    let spike = |(since, direction): (&f64, &f64)| -direction * (-since / decay).exp();
    out.extend(axis.since_reversal.iter().zip(axis.direction).map(spike));
}
