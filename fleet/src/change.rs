//! Changes: what a series does over time. In: values with their standard errors. Out: the trend and the step that fit best, and how
//! probable either is by chance.
//!
//! Recordings scatter by more than their intervals say: a machine is warmer on one day than on another, and is set up anew. How much more
//! is estimated beside each change from the series itself (Paule and Mandel: the scatter at which the weighted squares are as many as the
//! degrees of freedom), and so Student's distribution is asked and not the normal one. Where intervals are unequal, a few recordings tell
//! the scatter: the degrees of freedom are those of the variance that is estimated (Satterthwaite). Where neighbours in time are alike
//! beside the change, the series says less than its points: the variance is stretched by (1 + r) / (1 - r), as for a first-order process,
//! and r is freed of what a fit takes from it in a short series (Marriott and Pope).

use serde::Serialize;

use crate::history::BOUND;
use crate::series::Series;
use crate::student::{quantile, two_sided};

/// The fewest recordings of which a change is told: three degrees of freedom beside a line. With fewer nobody knows how much a machine
/// scatters from recording to recording.
pub(crate) const FEWEST: usize = 5;

/// The fewest on each side of a step: one odd recording is measured again before it is called one.
const FEWEST_BESIDE: usize = 2;

/// What a series does.
#[derive(Clone, Debug, Serialize)]
pub struct Change {
    /// `trend` or `step`.
    pub kind: &'static str,
    /// The change from the first recording to the last along a trend, or over the step; of a noise of its logarithm.
    pub size: f64,
    /// Half of its 95 % interval.
    pub half: f64,
    /// The change in a week along a trend; 0 of a step.
    pub per_week: f64,
    /// The number of the first point behind the step; 0 of a trend.
    pub from: usize,
    /// How probable a trend or a step as plain as this is by chance, anywhere in the series.
    pub probability: f64,
    /// The level at the beginning, with half of its 95 % interval.
    pub before: (f64, f64),
    /// The level at the end, with half of its 95 % interval.
    pub after: (f64, f64),
}

/// A line through points: a level, and a number times a column.
struct Line {
    level: f64,
    slope: f64,
    /// The variances of both and their covariance, stretched as the series asks for.
    variances: [f64; 3],
    /// Weighted squares of what is left, without more scatter than the intervals have.
    left: f64,
    freedom: f64,
}

/// The change of a series that fits it best; nothing of a short one.
pub(crate) fn change(series: &Series) -> Option<Change> {
    let points: Vec<(f64, f64, f64)> = series
        .points
        .iter()
        .map(|point| {
            let (value, error) = series.compared(point);
            (point.days(), value, error)
        })
        .filter(|(_, value, error)| value.is_finite() && error.is_finite())
        .collect();
    let (first, last) = (points.first()?.0, points.last()?.0);
    if points.len() < FEWEST || points.len() != series.points.len() || last <= first {
        return None;
    }
    let trend = trend(&points, first, last);
    let step = step(&points);
    // Both were looked for, and either might have been plain by chance (Bonferroni): whichever is told, its probability is twice its own.
    let doubled = |change: Change| Change { probability: (2.0 * change.probability).min(1.0), ..change };
    match (
        trend.map(|(change, left)| (doubled(change), left)),
        step.map(|(change, left)| (doubled(change), left)),
    ) {
        (Some((trend, of_trend)), Some((step, of_step))) => {
            // The likelier form where neither is chance by the bound of all alarms, else the plainer one.
            let plain = trend.probability.max(step.probability) < BOUND;
            let steps = if plain { of_step < of_trend } else { step.probability < trend.probability };
            Some(if steps { step } else { trend })
        }
        (trend, step) => trend.or(step).map(|(change, _)| change),
    }
}

/// The line over time, and what it leaves.
fn trend(points: &[(f64, f64, f64)], first: f64, last: f64) -> Option<(Change, f64)> {
    let span = last - first;
    let column: Vec<f64> = points.iter().map(|(days, ..)| (days - first) / span).collect();
    let line = line(points, &column)?;
    let change = told(&line, "trend", 0);
    Some((Change { per_week: line.slope / span * 7.0, ..change }, line.left))
}

/// The step at its likeliest place, and what it leaves. As many places were looked at as there are, and each might have been it by
/// chance: the probability is that of one place times their number.
fn step(points: &[(f64, f64, f64)]) -> Option<(Change, f64)> {
    let scatter = scatter(points, &vec![0.0; points.len()]);
    let places = FEWEST_BESIDE..=points.len().checked_sub(FEWEST_BESIDE)?;
    let count = places.clone().count();
    let weight = |error: f64| 1.0 / (error * error + scatter).max(f64::MIN_POSITIVE);
    let whole = points
        .iter()
        .fold((0.0, 0.0), |sum, (_, value, error)| (sum.0 + weight(*error), sum.1 + weight(*error) * value));
    let (mut before, mut best) = ((0.0, 0.0), (0.0, 0));
    for (place, (_, value, error)) in points.iter().enumerate() {
        if places.contains(&place) {
            let after: (f64, f64) = (whole.0 - before.0, whole.1 - before.1);
            let apart: f64 = after.1 / after.0 - before.1 / before.0;
            let gain = apart * apart / (1.0 / before.0 + 1.0 / after.0);
            if gain > best.0 {
                best = (gain, place);
            }
        }
        before = (before.0 + weight(*error), before.1 + weight(*error) * value);
    }
    let (gain, place) = best;
    let column: Vec<f64> = (0..points.len()).map(|number| f64::from(u8::from(number >= place))).collect();
    let line = line(points, &column).filter(|_| gain > 0.0)?;
    let change = told(&line, "step", place);
    Some((Change { probability: (change.probability * number(count)).min(1.0), ..change }, line.left))
}

fn told(line: &Line, kind: &'static str, from: usize) -> Change {
    let width = quantile(0.05, line.freedom);
    let [of_level, of_slope, both] = line.variances;
    let half = |variance: f64| width * variance.max(0.0).sqrt();
    Change {
        kind,
        size: line.slope,
        half: half(of_slope),
        per_week: 0.0,
        from,
        probability: two_sided(line.slope / of_slope.sqrt(), line.freedom),
        before: (line.level, half(of_level)),
        after: (line.level + line.slope, half(of_level + of_slope + 2.0 * both)),
    }
}

/// The line of least squares with the scatter that the series itself shows beside it.
fn line(points: &[(f64, f64, f64)], column: &[f64]) -> Option<Line> {
    let scatter = scatter(points, column);
    let (level, slope, variances) = weighted(points, column, scatter)?;
    let count = number(points.len());
    let fitted = fitted(column);
    let residuals: Vec<f64> = points
        .iter()
        .zip(column)
        .map(|((_, value, error), x)| (value - level - slope * x) / (error * error + scatter).sqrt())
        .collect();
    let squares: f64 = residuals.iter().map(|left| left * left).sum();
    let neighbours: f64 = residuals.windows(2).map(|pair| pair.iter().product::<f64>()).sum();
    let alike = if squares > 0.0 { alike(neighbours / squares, count, fitted) } else { 0.0 };
    let stretch = (1.0 + alike) / (1.0 - alike);
    let freedom = freedom(points, column, scatter, variances).min(count / stretch - fitted).max(1.0);
    let variances = variances.map(|variance| variance * stretch);
    Some(Line { level, slope, variances, left: squares + log_sizes(points, scatter), freedom })
}

pub(crate) fn number(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}

/// How many numbers are fitted: the level, and the column where it is one.
fn fitted(column: &[f64]) -> f64 {
    if column.iter().all(|x| *x == 0.0) { 1.0 } else { 2.0 }
}

/// How alike neighbours are whose products over their squares are `r`: nothing where they are apart, and of fewer than five nobody knows.
fn alike(r: f64, count: f64, fitted: f64) -> f64 {
    if count <= 4.0 { 0.0 } else { freed(r, count, fitted).clamp(0.0, MOST_ALIKE) }
}

/// The correlation of neighbours, corrected for its bias: in a series of `count` points from which `fitted` numbers were fitted, the
/// estimate is too low by (fitted + 4 r) / count.
fn freed(r: f64, count: f64, fitted: f64) -> f64 {
    (count * r + fitted) / (count - 4.0)
}

/// The degrees of freedom of the variance of the slope (of the level, where there is no slope), as far as the scatter makes it: twice its
/// square over the variance that it has itself, since the scatter is estimated. Of equal intervals those of the points.
fn freedom(points: &[(f64, f64, f64)], column: &[f64], scatter: f64, variances: [f64; 3]) -> f64 {
    let [of_level, of_slope, both] = variances;
    let told = fitted(column);
    let row = if told > 1.0 { [both, of_slope] } else { [of_level, 0.0] };
    let (mut left, mut rate) = (0.0, 0.0);
    for ((_, _, error), x) in points.iter().zip(column) {
        let weight = 1.0 / (error * error + scatter).max(f64::MIN_POSITIVE.sqrt());
        let share = weight * (of_level + 2.0 * both * x + of_slope * x * x);
        left += weight * (1.0 - share);
        rate += (weight * (row[0] + row[1] * x)).powi(2);
    }
    let variance = if told > 1.0 { of_slope } else { of_level };
    let all = number(points.len()) - told;
    let freedom = (variance / rate * left).powi(2) / all;
    if freedom.is_finite() { freedom.min(all) } else { all }
}

/// A series in which neighbours are more alike than this is one drift, of which no number of points says more.
const MOST_ALIKE: f64 = 0.9;

/// What a larger scatter costs in minus twice the log-likelihood.
fn log_sizes(points: &[(f64, f64, f64)], scatter: f64) -> f64 {
    points.iter().map(|(_, _, error)| (error * error + scatter).max(f64::MIN_POSITIVE).ln()).sum()
}

/// The variance from recording to recording beside their own errors at which the weighted squares are as many as the degrees of freedom;
/// 0 where the errors alone give that many.
fn scatter(points: &[(f64, f64, f64)], column: &[f64]) -> f64 {
    let freedom = number(points.len()) - fitted(column);
    let squares = |scatter: f64| {
        let Some((level, slope, _)) = weighted(points, column, scatter) else { return 0.0 };
        let left = |((_, value, error), x): (&(f64, f64, f64), &f64)| {
            (value - level - slope * x).powi(2) / (error * error + scatter).max(f64::MIN_POSITIVE)
        };
        points.iter().zip(column).map(left).sum::<f64>()
    };
    let spread = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, value, _)| {
        (low.min(*value), high.max(*value))
    });
    let (mut low, mut high) = (0.0, (spread.1 - spread.0).powi(2));
    // Values without errors that are all the same still have the last digit of a number between them.
    let least = (spread.0.abs().max(spread.1.abs()) * f64::EPSILON).powi(2).max(f64::MIN_POSITIVE);
    let exact = points.iter().all(|(_, _, error)| *error == 0.0);
    if !exact && squares(0.0) <= freedom {
        return 0.0;
    }
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if squares(middle) > freedom { low = middle } else { high = middle }
    }
    high.max(if exact { least } else { 0.0 })
}

/// Halvings of an interval of variances until eight digits are known.
const HALVINGS: usize = 60;

/// Level and slope with weights, their variances and their covariance; nothing where the column is a level itself.
fn weighted(points: &[(f64, f64, f64)], column: &[f64], scatter: f64) -> Option<(f64, f64, [f64; 3])> {
    let mut sums = [0.0; 5];
    for ((_, value, error), x) in points.iter().zip(column) {
        let weight = 1.0 / (error * error + scatter).max(f64::MIN_POSITIVE.sqrt());
        for (sum, part) in sums.iter_mut().zip([1.0, *x, x * x, *value, x * value]) {
            *sum += weight * part;
        }
    }
    let [all, of_x, of_xx, of_value, of_both] = sums;
    if of_xx == 0.0 {
        return Some((of_value / all, 0.0, [1.0 / all, 0.0, 0.0]));
    }
    let determinant = all * of_xx - of_x * of_x;
    if determinant.is_nan() || determinant <= all * of_xx * f64::EPSILON {
        return None;
    }
    let slope = (all * of_both - of_x * of_value) / determinant;
    let level = (of_value - slope * of_x) / all;
    Some((level, slope, [of_xx / determinant, all / determinant, -of_x / determinant]))
}

/// The level of values that scatter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Level {
    /// The level.
    pub(crate) value: f64,
    /// Its variance.
    pub(crate) variance: f64,
    /// The variance from value to value beside their own errors.
    pub(crate) scatter: f64,
    /// The degrees of freedom of the variance.
    pub(crate) freedom: f64,
}

/// The mean of a series, the scatter from recording to recording and how alike neighbours are in its variance.
pub(crate) fn mean(series: &Series) -> Option<Level> {
    let points: Vec<(f64, f64, f64)> = series
        .points
        .iter()
        .map(|point| {
            let (value, error) = series.compared(point);
            (point.days(), value, error)
        })
        .collect();
    let flat = vec![0.0; points.len()];
    let Line { level: value, variances: [variance, ..], freedom, .. } = line(&points, &flat)?;
    let scatter = scatter(&points, &flat);
    (value.is_finite() && variance.is_finite()).then_some(Level { value, variance, scatter, freedom })
}

/// The level of values with their variances, in no order of time.
pub(crate) fn level(values: &[(f64, f64)]) -> Option<Level> {
    let points: Vec<(f64, f64, f64)> =
        values.iter().map(|(value, variance)| (0.0, *value, variance.sqrt())).collect();
    let flat = vec![0.0; points.len()];
    let scatter = scatter(&points, &flat);
    let (value, _, variances) = weighted(&points, &flat, scatter)?;
    let freedom = freedom(&points, &flat, scatter, variances).max(1.0);
    Some(Level { value, variance: variances[0], scatter, freedom })
}

#[cfg(test)]
mod tests;
