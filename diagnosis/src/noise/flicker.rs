//! Flicker noise: each octave of frequency holds about as much of it as the octave above.
//!
//! In: a residual with its times and gaps. Out: how likely it is as white noise and a noise whose power falls with a power of the
//! frequency, at all times that the recording can show. Sensors, electronics and rooms are so. An Ornstein-Uhlenbeck process has one
//! correlation time, and no more power at longer times: beside it a slow curve of flicker noise seems to be physics.
//!
//! The noise is a sum of Ornstein-Uhlenbeck processes. Their correlation times are equal factors apart, and their variances grow with a
//! power of that time: 0 for 1/f, 1 for 1/f^2.

use super::likelihood::Sums;
use super::simplex::{TOGETHER, minimise};
use super::{same_step, span, typical_step};

/// How many processes there are. Over seven decades of time a factor of 25 lies between two of them, and their sum is 1/f within a fifth.
const PARTS: usize = 6;

/// The logarithm of the ratio of flicker and white noise, as standard deviations, lies within this of 0: one of them is not seen beyond.
const MOST: f64 = 12.0;

/// The powers of the correlation time with which variances grow: from half way to white noise up to 1/f^2.
const POWERS: (f64, f64) = (-0.5, 1.0);

/// One number for each of some noises, which go through the rows side by side.
type Lanes = [f64; TOGETHER];

/// Minus twice the logarithm of the likelihood of a residual under the noise of greatest likelihood, and the standard deviation of its white
/// part.
pub(super) fn deviance(time: &[f64], residual: &[f64], valid: &[bool]) -> (f64, f64) {
    let times = (typical_step(time), 10.0 * span(time));
    let outside = |[ratio, power]: [f64; 2]| {
        (ratio.abs() - MOST).max(0.0) + (POWERS.0 - power).max(0.0) + (power - POWERS.1).max(0.0)
    };
    let at = |points: [[f64; 2]; TOGETHER]| deviances(time, residual, valid, &Flickers::new(times, points));
    let costs = |points: [[f64; 2]; TOGETHER]| {
        let found = at(points);
        std::array::from_fn(|lane| found[lane].0 + 1e3 * outside(points[lane]))
    };
    let (value, point) = minimise(&costs, [0.0, 0.0]);
    let [(_, scale), ..] = at([point; TOGETHER]);
    (value, scale.sqrt())
}

/// Minus twice the log-likelihood under each noise, its scale concentrated out, and that scale (a variance).
fn deviances(time: &[f64], residual: &[f64], valid: &[bool], flickers: &Flickers) -> [(f64, f64); TOGETHER] {
    let mut filters = Filters::new(flickers);
    let mut sums = Sums::new();
    for ((time, value), valid) in time.iter().zip(residual).zip(valid) {
        filters.come(*time);
        if *valid {
            let (new, weight) = filters.take(*value);
            sums.add(new, weight);
        }
    }
    sums.deviances()
}

/// Noises beside white noise of variance 1.
struct Flickers {
    /// The correlation time of each process.
    times: [f64; PARTS],
    /// The variance of each process in each noise.
    variances: [Lanes; PARTS],
}

impl Flickers {
    /// Noises between two correlation times, each by the logarithm of its standard deviation and the power with which variances grow.
    fn new((shortest, longest): (f64, f64), points: [[f64; 2]; TOGETHER]) -> Self {
        let factor = (longest / shortest).powf(1.0 / crate::number(PARTS - 1));
        let growth: [f64; PARTS] = std::array::from_fn(|part| factor.powf(crate::number(part)));
        let mut variances = [[0.0; TOGETHER]; PARTS];
        for (lane, [size, power]) in points.into_iter().enumerate() {
            let shares = growth.map(|growth| growth.powf(power));
            let whole: f64 = shares.iter().sum();
            for (part, share) in shares.into_iter().enumerate() {
                variances[part][lane] = (2.0 * size.clamp(-MOST, MOST)).exp() * share / whole;
            }
        }
        Self { times: growth.map(|growth| shortest * growth), variances }
    }
}

/// A Kalman filter of the processes of each noise, as it runs through the rows.
struct Filters<'f> {
    flickers: &'f Flickers,
    state: [Lanes; PARTS],
    covariance: [[Lanes; PARTS]; PARTS],
    last: Option<f64>,
    /// The step of time for which `decays` were worked out: most steps are equal.
    step: f64,
    decays: [f64; PARTS],
}

impl<'f> Filters<'f> {
    fn new(flickers: &'f Flickers) -> Self {
        let mut covariance = [[[0.0; TOGETHER]; PARTS]; PARTS];
        for (part, variance) in flickers.variances.iter().enumerate() {
            covariance[part][part] = *variance;
        }
        let state = [[0.0; TOGETHER]; PARTS];
        Self { flickers, state, covariance, last: None, step: 0.0, decays: [1.0; PARTS] }
    }

    /// The time goes on to the next row.
    fn come(&mut self, time: f64) {
        let Some(last) = self.last.replace(time) else { return };
        let step = time - last;
        if !same_step(step, self.step) {
            self.step = step;
            self.decays = self.flickers.times.map(|time| (-step / time).exp());
        }
        for part in 0..PARTS {
            let decay = self.decays[part];
            for lane in 0..TOGETHER {
                self.state[part][lane] *= decay;
            }
            for other in 0..PARTS {
                let both = decay * self.decays[other];
                for lane in 0..TOGETHER {
                    self.covariance[part][other][lane] *= both;
                }
            }
            for lane in 0..TOGETHER {
                self.covariance[part][part][lane] +=
                    self.flickers.variances[part][lane] * (1.0 - decay * decay);
            }
        }
    }

    /// A row with a sample: what is new in it, and 1 / standard deviation of that.
    fn take(&mut self, value: f64) -> (Lanes, Lanes) {
        let sums = self.covariance.map(|row| sum(&row));
        let weight = sum(&sums).map(|variance| 1.0 / (variance + 1.0).sqrt());
        let new = sum(&self.state).map(|state| value - state);
        for part in 0..PARTS {
            let gain: Lanes = std::array::from_fn(|lane| sums[part][lane] * weight[lane] * weight[lane]);
            for lane in 0..TOGETHER {
                self.state[part][lane] += gain[lane] * new[lane];
            }
            for (covariance, sum) in self.covariance[part].iter_mut().zip(&sums) {
                for lane in 0..TOGETHER {
                    covariance[lane] -= gain[lane] * sum[lane];
                }
            }
        }
        (new, weight)
    }
}

/// The sum over the processes of each noise.
fn sum(parts: &[Lanes; PARTS]) -> Lanes {
    let mut sum = [0.0; TOGETHER];
    for part in parts {
        for lane in 0..TOGETHER {
            sum[lane] += part[lane];
        }
    }
    sum
}

#[cfg(test)]
mod tests;
