//! `lag`: the following error of the position loop q' = K (q_cmd - q), started at rest. In: the position behind the loop,
//! which the states hold. Out: how the position changes with the loop's time constant 1/K: -v in the steady state.

use crate::states::Rows;

pub(super) fn fill(rows: &Rows<'_>, axis: usize, out: &mut Vec<f64>) {
    out.extend_from_slice(rows.axis(axis).lag_slope);
}
