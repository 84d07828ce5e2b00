//! Changes: what a series does over time. In: values with their standard errors. Out: the trend and the step that fit best, and how
//! probable either is by chance.
//!
//! Recordings scatter by more than their intervals say: a machine is warmer on one day than on another, and is set up anew. How much more
//! is estimated beside each change from the series itself (Paule and Mandel: the scatter at which the weighted squares are as many as the
//! degrees of freedom), and so Student's distribution is asked and not the normal one. Where intervals are unequal, a few recordings tell
//! the scatter: the degrees of freedom are those of the variance that is estimated (Satterthwaite).
//!
//! Neighbours in time may be alike beside the change. A short series does not tell how much: what it estimates is mostly chance. So no
//! estimate is trusted. Everything is fitted for each of several correlations (a first-order process, generalised least squares), with
//! Student's distribution under each. Sizes and intervals are averaged over them, each as much as it is probable (restricted likelihood,
//! with a weak prior). A change is told only if it is no chance on that average, nor under any correlation up to [`GUARDED`] alone: so the
//! bound holds up to there whatever the series seems to say, and one recording more moves the probability little.
//!
//! Measured with 100 000 quiet series a case of 5 to 30 recordings: how many pass a bound of 1 % (of 0.01 %), trend or step, as a share of
//! the bound. Intervals that alone explain the scatter: 0.00. A scatter beside them whose neighbours are alike by 0: 0.00 to 0.31 (0.1); by
//! 0.3: 0.02 to 0.59 (0.4); by 0.6: 0.62 to 0.99 (1.4, of 14 series). Beyond what is guarded: by 0.8, 1.4 to 5.4 (12); by 0.9, 1.7 to 13
//! (68). Of wear by one standard deviation of the scatter a week, held against 0.01 %, half of 1500 series are told after 11 to 14 weeks, and 6
//! of a hundred lose that in any week up to the 26th; of three, after 7 to 8 weeks, and 2 of a hundred. `change/tests.rs` has a
//! smaller sweep.

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
    /// What `size`, `half`, `per_week`, `before` and `after` are of: `value`, in the unit of the series; `logarithm`, the natural one of the
    /// values in that unit, of a noise. There `size` is the logarithm of the factor, and `exp(before)` is a level in the unit.
    pub scale: &'static str,
    /// The change from the first recording to the last along a trend, or over the step.
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

/// The correlations of neighbours that are tried. From 0.9 on a series is one drift, of which no number of points says more.
const ALIKE: [f64; 7] = [0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9];

/// The correlation up to which the bound holds whatever a series seems to say. Where it is 0.6 from week to week, recordings a month apart
/// still have an eighth in common (0.6^4): more than a machine that is set up anew once a month.
const GUARDED: f64 = 0.6;

/// How probable a correlation is beforehand, up to a factor: a weak prior, with a mean of 1/4. Machines are mostly set up anew between two
/// recordings; a season or a warm week is the exception.
fn prior(alike: f64) -> f64 {
    (1.0 - alike).powi(2)
}

/// A line through points: a level, and a number times a column, where neighbours are alike by some correlation.
struct Line {
    alike: f64,
    level: f64,
    slope: f64,
    /// The variances of both and their covariance.
    variances: [f64; 3],
    freedom: f64,
    /// The logarithm of the restricted likelihood, up to what all correlations share.
    likelihood: f64,
    /// Minus twice the logarithm of the likelihood, up to what all columns share.
    left: f64,
}

/// The same line for each correlation, with how probable each is.
struct Lines(Vec<(f64, Line)>);

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
    let scale = if series.is_noise() { "logarithm" } else { "value" };
    let doubled =
        |change: Change| Change { probability: (2.0 * change.probability).min(1.0), scale, ..change };
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
    let lines = lines(points, &column)?;
    let change = told(&lines, "trend", 0);
    Some((Change { per_week: change.size / span * 7.0, ..change }, lines.left()))
}

/// The step at its likeliest place, and what it leaves. As many places were looked at as there are, and each might have been it by
/// chance: the probability is that of one place times their number.
fn step(points: &[(f64, f64, f64)]) -> Option<(Change, f64)> {
    let scatter = scatter(points, &vec![0.0; points.len()], 0.0);
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
    let lines = lines(points, &column).filter(|_| gain > 0.0)?;
    let change = told(&lines, "step", place);
    Some((Change { probability: (change.probability * number(count)).min(1.0), ..change }, lines.left()))
}

fn told(lines: &Lines, kind: &'static str, from: usize) -> Change {
    let level = lines.averaged(|line| line.level, |line| line.variances[0]);
    let slope = lines.averaged(|line| line.slope, |line| line.variances[1]);
    let end = lines.averaged(
        |line| line.level + line.slope,
        |line| line.variances.iter().sum::<f64>() + line.variances[2],
    );
    Change {
        kind,
        scale: "value",
        size: slope.0,
        half: slope.1,
        per_week: 0.0,
        from,
        probability: lines.probability(),
        before: level,
        after: end,
    }
}

impl Lines {
    /// A number averaged over all correlations, with half of its 95 % interval: its variance is that under each, and what they differ by.
    fn averaged(&self, value: impl Fn(&Line) -> f64, variance: impl Fn(&Line) -> f64) -> (f64, f64) {
        let (mean, variance, freedom) = self.moments(value, variance);
        (mean, quantile(0.05, freedom) * variance.max(0.0).sqrt())
    }

    /// The mean of a number over all correlations, its variance, and the degrees of freedom of that.
    fn moments(&self, value: impl Fn(&Line) -> f64, variance: impl Fn(&Line) -> f64) -> (f64, f64, f64) {
        let mean = self.mean(&value);
        let spread = |line: &Line| variance(line) + (value(line) - mean).powi(2);
        (mean, self.mean(spread), self.mean(|line| line.freedom))
    }

    fn mean(&self, value: impl Fn(&Line) -> f64) -> f64 {
        self.0.iter().map(|(share, line)| share * value(line)).sum()
    }

    /// How probable a slope as plain as this is by chance: on the average, and no less than under any correlation that is guarded against.
    fn probability(&self) -> f64 {
        let own = |line: &Line| two_sided(line.slope / line.variances[1].sqrt(), line.freedom);
        let guarded = self.0.iter().filter(|(_, line)| line.alike <= GUARDED);
        guarded.map(|(_, line)| own(line)).fold(self.mean(own), f64::max)
    }

    /// What the line leaves: minus twice the logarithm of the likelihood, if recordings know nothing of each other.
    fn left(&self) -> f64 {
        self.0.first().map_or(f64::INFINITY, |(_, line)| line.left)
    }
}

/// The lines of least squares for each correlation, with the scatter that the series itself shows beside each. Of fewer points than tell a
/// change, recordings are taken as if they knew nothing of each other.
fn lines(points: &[(f64, f64, f64)], column: &[f64]) -> Option<Lines> {
    let tried = if points.len() < FEWEST { ALIKE.get(..1) } else { ALIKE.get(..) };
    let all = tried?.iter().map(|alike| line(points, column, *alike)).collect::<Option<Vec<Line>>>()?;
    let most = all.iter().map(|line| line.likelihood).fold(f64::NEG_INFINITY, f64::max);
    let share = |line: &Line| prior(line.alike) * (line.likelihood - most).exp();
    let sum: f64 = all.iter().map(share).sum();
    Some(Lines(all.into_iter().map(|line| (share(&line) / sum, line)).collect()))
}

/// The line where neighbours are alike by this correlation.
fn line(points: &[(f64, f64, f64)], column: &[f64], alike: f64) -> Option<Line> {
    let scatter = scatter(points, column, alike);
    let fit = weighted(points, column, scatter, alike)?;
    // What the estimate of the scatter rests on depends on the intervals, and not on the order in time.
    let plain = weighted(points, column, scatter, 0.0)?;
    let freedom = freedom(points, column, scatter, plain.variances).max(1.0);
    let sizes = log_sizes(points, scatter) + (number(points.len()) - 1.0) * (1.0 - alike * alike).ln();
    let left = fit.squares + sizes;
    Some(Line {
        alike,
        level: fit.level,
        slope: fit.slope,
        variances: fit.variances,
        freedom,
        likelihood: -0.5 * (left + fit.determinant.ln()),
        left,
    })
}

pub(crate) fn number(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}

/// How many numbers are fitted: the level, and the column where it is one.
fn fitted(column: &[f64]) -> f64 {
    if column.iter().all(|x| *x == 0.0) { 1.0 } else { 2.0 }
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

/// What a larger scatter costs in minus twice the log-likelihood.
fn log_sizes(points: &[(f64, f64, f64)], scatter: f64) -> f64 {
    points.iter().map(|(_, _, error)| (error * error + scatter).max(f64::MIN_POSITIVE).ln()).sum()
}

/// The variance from recording to recording beside their own errors at which the weighted squares are as many as the degrees of freedom;
/// 0 where the errors alone give that many.
fn scatter(points: &[(f64, f64, f64)], column: &[f64], alike: f64) -> f64 {
    let freedom = number(points.len()) - fitted(column);
    let squares = |scatter: f64| weighted(points, column, scatter, alike).map_or(0.0, |fit| fit.squares);
    let spread = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, value, _)| {
        (low.min(*value), high.max(*value))
    });
    // No direction of a series counts for more than this in a first-order process.
    let widest = (spread.1 - spread.0).powi(2) * (1.0 + alike) / (1.0 - alike);
    // Values without errors that are all the same still have the last digit of a number between them.
    let least = (spread.0.abs().max(spread.1.abs()) * f64::EPSILON).powi(2).max(f64::MIN_POSITIVE);
    let found = root(|scatter| freedom / squares(scatter) - 1.0, (least, widest.max(least)));
    let exact = points.iter().all(|(_, _, error)| *error == 0.0);
    if found > least || exact { found } else { 0.0 }
}

/// Where a growing function passes zero between two ends; the end nearer to it where it does not. Of equal intervals the function
/// of a scatter is a straight line, and a chord meets it at once; else chords close in (the Illinois method).
fn root(function: impl Fn(f64) -> f64, (start, end): (f64, f64)) -> f64 {
    let (mut low, mut high) = ((start, function(start)), (end, function(end)));
    if low.1 >= 0.0 || low.1.is_nan() {
        return start;
    }
    for _ in 0..MOST_CHORDS {
        let place = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
        if high.1 <= 0.0 || !place.is_finite() || high.0 - low.0 <= high.0 * KNOWN {
            break;
        }
        let value = function(place);
        if value.abs() <= KNOWN {
            return place;
        }
        // The end that stays counts half, so that it does not stay for ever.
        if value < 0.0 {
            (low, high.1) = ((place, value), high.1 / 2.0);
        } else {
            (high, low.1) = ((place, value), low.1 / 2.0);
        }
    }
    high.0
}

/// More chords than eight digits take.
const MOST_CHORDS: usize = 100;

/// The share to which a variance is found: eight digits, more than any series tells.
const KNOWN: f64 = 1e-8;

/// What least squares give.
struct Fit {
    level: f64,
    slope: f64,
    /// The variances of level and slope and their covariance.
    variances: [f64; 3],
    /// The weighted squares of what is left.
    squares: f64,
    /// The determinant of the normal equations.
    determinant: f64,
}

/// The rows of a fit (one, the column, the value) with weights, where neighbours are alike by a correlation: each row less what the one
/// before it says of it, so that they know nothing of each other (Prais and Winsten).
fn rows(
    points: &[(f64, f64, f64)],
    column: &[f64],
    scatter: f64,
    alike: f64,
) -> impl Iterator<Item = [f64; 3]> {
    let rest = (1.0 - alike * alike).sqrt();
    let weighed = points.iter().zip(column).map(move |((_, value, error), x)| {
        let weight = (1.0 / (error * error + scatter).max(f64::MIN_POSITIVE.sqrt())).sqrt();
        [weight, weight * x, weight * value]
    });
    weighed.scan(None, move |last: &mut Option<[f64; 3]>, own| {
        let [one, x, value] = own;
        Some(match last.replace(own) {
            None => own,
            Some(last) => {
                [one - alike * last[0], x - alike * last[1], value - alike * last[2]].map(|part| part / rest)
            }
        })
    })
}

/// Level and slope of least squares; nothing where the column is a level itself.
fn weighted(points: &[(f64, f64, f64)], column: &[f64], scatter: f64, alike: f64) -> Option<Fit> {
    let mut sums = [0.0; 5];
    for [one, x, value] in rows(points, column, scatter, alike) {
        for (sum, part) in sums.iter_mut().zip([one * one, one * x, x * x, one * value, x * value]) {
            *sum += part;
        }
    }
    let [all, of_x, of_xx, of_value, of_both] = sums;
    let (level, slope, variances, determinant) = if of_xx == 0.0 {
        (of_value / all, 0.0, [1.0 / all, 0.0, 0.0], all)
    } else {
        let determinant = all * of_xx - of_x * of_x;
        if determinant.is_nan() || determinant <= all * of_xx * f64::EPSILON {
            return None;
        }
        let slope = (all * of_both - of_x * of_value) / determinant;
        let variances = [of_xx / determinant, all / determinant, -of_x / determinant];
        ((of_value - slope * of_x) / all, slope, variances, determinant)
    };
    let left = |[one, x, value]: [f64; 3]| (value - level * one - slope * x).powi(2);
    let squares = rows(points, column, scatter, alike).map(left).sum();
    Some(Fit { level, slope, variances, squares, determinant })
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

/// The mean of a series; the scatter from recording to recording, and how alike neighbours may be, are in its variance.
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
    let (value, variance, freedom) =
        lines(&points, &flat)?.moments(|line| line.level, |line| line.variances[0]);
    let scatter = scatter(&points, &flat, 0.0);
    (value.is_finite() && variance.is_finite()).then_some(Level { value, variance, scatter, freedom })
}

/// The level of values with their variances, in no order of time.
pub(crate) fn level(values: &[(f64, f64)]) -> Option<Level> {
    let points: Vec<(f64, f64, f64)> =
        values.iter().map(|(value, variance)| (0.0, *value, variance.sqrt())).collect();
    let flat = vec![0.0; points.len()];
    let scatter = scatter(&points, &flat, 0.0);
    let Fit { level: value, variances, .. } = weighted(&points, &flat, scatter, 0.0)?;
    let freedom = freedom(&points, &flat, scatter, variances).max(1.0);
    Some(Level { value, variance: variances[0], scatter, freedom })
}

#[cfg(test)]
mod tests;
