//! Outliers: single readings that are no part of any motion.
//!
//! In: the residual of a channel, the step of its display, and which rows other passes read at the same place. Out: a mark for each
//! reading, or two in a row, that stand far from their neighbours *and* from the other passes at their place. What lasts longer is
//! something that happened, and what comes back is something of the machine: both stay.

/// How many robust standard deviations of a step from row to row a reading must stand from its neighbours. For white noise, whose
/// steps scatter by the root of two more, that is more than eight of a reading, which a million rows do not give.
const FAR: f64 = 6.0;
/// How many neighbours on each side are looked at: with two, one or two readings may stand apart from the rest.
const NEIGHBOURS: usize = 2;
/// In how many rows around a reading the scatter is looked at: where an axis moves it is another than where it stands.
const AROUND: usize = 32;
/// At most one reading in 20 may be an outlier. Where the rule marks more, it is wrong for these readings, and none is marked.
const MOST: usize = 20;

/// Marks the outliers of a residual. `step` is that of the display; `apart` says of a row and a distance whether it lies as far
/// from what other passes read at its place, or nobody else came by.
pub(crate) fn mark(residual: &[f64], step: f64, apart: &dyn Fn(usize, f64) -> bool) -> Vec<bool> {
    let none = vec![false; residual.len()];
    let known: Vec<usize> = (0..residual.len()).filter(|row| residual[*row].is_finite()).collect();
    let values: Vec<f64> = known.iter().map(|row| residual[*row]).collect();
    let distances: Vec<f64> = (0..values.len()).map(|at| from_neighbours(&values, at)).collect();
    let steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let Some(everywhere) = scatter(&steps) else { return none };
    let least = FAR * everywhere.max(step);
    let far: Vec<usize> = (0..distances.len())
        .filter(|at| distances[*at].abs() > least && least > 0.0)
        .filter(|at| distances[*at].abs() > FAR * around(&steps, *at).max(step))
        .filter(|at| apart(known[*at], distances[*at]))
        .collect();
    if far.len() * MOST > known.len() {
        return none;
    }
    let mut marks = none;
    far.into_iter().for_each(|at| marks[known[at]] = true);
    marks
}

/// A reading minus the median of itself and its neighbours: one or two that stand apart are no median of five.
fn from_neighbours(values: &[f64], at: usize) -> f64 {
    let from = at.saturating_sub(NEIGHBOURS);
    let to = (at + NEIGHBOURS + 1).min(values.len());
    let mut few = values[from..to].to_vec();
    few.sort_by(f64::total_cmp);
    values[at] - few[few.len() / 2]
}

/// The scatter of the steps before a reading or behind it, whichever is the larger, those to it and from it left out: where an
/// axis sets out, it lies within the one and not within the other.
fn around(steps: &[f64], at: usize) -> f64 {
    let half = AROUND / 2;
    let before = at.saturating_sub(half)..at.saturating_sub(1).min(steps.len());
    let behind = (at + 1).min(steps.len())..(at + half).min(steps.len());
    let sides = [steps.get(before).unwrap_or_default(), &steps[behind]];
    sides.into_iter().filter_map(scatter).fold(0.0, f64::max)
}

/// The standard deviation of normal numbers that lie as far from their median: a slope is no scatter.
fn scatter(steps: &[f64]) -> Option<f64> {
    let middle = crate::noise::middle(&mut steps.to_vec())?;
    let mut sizes: Vec<f64> = steps.iter().map(|step| (step - middle).abs()).collect();
    crate::noise::middle(&mut sizes).map(|median| median / 0.6745)
}

#[cfg(test)]
mod tests;
