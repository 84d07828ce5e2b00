//! Outliers: samples that are no part of any motion.
//!
//! In: the residual of a channel. Out: a mark for each sample that stands far from its neighbours on both sides: single
//! samples or pairs. What lasts longer is something that happened, and stays.

/// How many robust standard deviations from its neighbours a sample must stand.
const FAR: f64 = 8.0;
/// How many neighbours on each side are looked at.
const NEIGHBOURS: usize = 4;

/// Marks the outliers of a residual.
pub(crate) fn mark(residual: &[f64]) -> Vec<bool> {
    let distances: Vec<f64> = (0..residual.len()).map(|row| from_neighbours(residual, row)).collect();
    let mut sizes: Vec<f64> =
        distances.iter().map(|distance| distance.abs()).filter(|size| size.is_finite()).collect();
    if sizes.is_empty() {
        return vec![false; residual.len()];
    }
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    let limit = FAR * *median / 0.6745;
    distances.iter().map(|distance| limit > 0.0 && distance.abs() > limit).collect()
}

/// A sample minus the nearer of the medians before and after it.
fn from_neighbours(residual: &[f64], row: usize) -> f64 {
    let before = median(residual[..row].iter().rev());
    let after = median(residual[row + 1..].iter());
    let value = residual[row];
    match (before, after) {
        (Some(before), Some(after)) if (value - before).signum() == (value - after).signum() => {
            if (value - before).abs() < (value - after).abs() { value - before } else { value - after }
        }
        (Some(_), Some(_)) => 0.0,
        (Some(one), None) | (None, Some(one)) => value - one,
        (None, None) => 0.0,
    }
}

fn median<'v>(values: impl Iterator<Item = &'v f64>) -> Option<f64> {
    let mut few: Vec<f64> = values.take(NEIGHBOURS).copied().filter(|value| value.is_finite()).collect();
    few.sort_by(f64::total_cmp);
    few.get(few.len() / 2).copied()
}

#[cfg(test)]
mod tests;
