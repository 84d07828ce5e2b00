//! Effects under noises that may be. In: the noises that each channel may have, with the products of columns under them. Out: the
//! coefficients of all columns and their covariance, wide enough for all of these noises together.
//!
//! Under each noise an estimate has Student's distribution about its least squares. What is known of it is the sum of these
//! distributions, each as much as its noise is probable: its middle is their mean, and the covariance is such that 1.96 standard
//! deviations hold 95 % of the sum.

use nalgebra::DMatrix;

use super::beside::Possible;
use crate::certainty::WIDTH_95;
use crate::number;
use crate::sweep::Swept;

/// What is known of coefficients.
pub(super) struct Mixed {
    pub(super) coefficients: Vec<f64>,
    pub(super) covariance: DMatrix<f64>,
    /// The degrees of freedom with which the variance of each is known: its logarithm varies by 2 over them, as that of a sum of so many
    /// squares does.
    pub(super) freedoms: Vec<f64>,
}

/// What is known under one noise of each channel.
struct Part {
    probability: f64,
    coefficients: Vec<f64>,
    covariance: DMatrix<f64>,
    freedom: f64,
}

/// What is known under all noises that may be.
struct Parts(Vec<Part>);

impl Mixed {
    /// The coefficients of so many columns.
    pub(super) fn new(channels: &[Vec<Possible>], width: usize) -> Self {
        let settings = settings(channels);
        let parts = Parts(settings.iter().filter_map(|setting| Part::new(setting, width)).collect());
        let coefficients: Vec<f64> =
            (0..width).map(|column| parts.mean(|part| part.coefficients[column])).collect();
        let plain = parts.covariance(&coefficients);
        let wider: Vec<f64> = (0..width)
            .map(|column| parts.wider(column, coefficients[column], plain[(column, column)].sqrt()))
            .collect();
        Self {
            covariance: DMatrix::from_fn(width, width, |row, column| {
                plain[(row, column)] * wider[row] * wider[column]
            }),
            freedoms: (0..width).map(|column| parts.freedom(column)).collect(),
            coefficients,
        }
    }
}

impl Parts {
    fn mean(&self, of: impl Fn(&Part) -> f64) -> f64 {
        self.0.iter().map(|part| part.probability * of(part)).sum()
    }

    /// The covariance of coefficients about their means.
    fn covariance(&self, means: &[f64]) -> DMatrix<f64> {
        let apart = |part: &Part, column: usize| part.coefficients[column] - means[column];
        DMatrix::from_fn(means.len(), means.len(), |row, column| {
            self.mean(|part| part.covariance[(row, column)] + apart(part, row) * apart(part, column))
        })
    }

    /// How many times wider the interval of a coefficient is than its standard deviation has it.
    fn wider(&self, column: usize, mean: f64, deviation: f64) -> f64 {
        let parts: Vec<(f64, f64, f64)> = self.0.iter().map(|part| part.beside(column, mean)).collect();
        if deviation > 0.0 { half(&parts, deviation) / (WIDTH_95 * deviation) } else { 1.0 }
    }

    /// The degrees of freedom of the variance of a coefficient.
    fn freedom(&self, column: usize) -> f64 {
        let size = |part: &Part| part.covariance[(column, column)].max(f64::MIN_POSITIVE).ln();
        let middle = self.mean(size);
        let varies = self.mean(|part| (size(part) - middle).powi(2) + 2.0 / part.freedom);
        if varies > 0.0 { 2.0 / varies } else { 0.0 }
    }
}

impl Part {
    /// The least squares under a noise of each channel; none where no samples are left.
    fn new((probability, setting): &(f64, Vec<&Possible>), width: usize) -> Option<Self> {
        let mut products = DMatrix::zeros(width + 1, width + 1);
        let mut samples = 0.0;
        for possible in setting {
            products += &possible.products;
            samples += possible.samples;
        }
        let mut swept = Swept::new(&products);
        let taken = (0..width).filter(|column| swept.take(*column)).count();
        let freedom = samples - number(taken);
        if freedom <= 0.0 {
            return None;
        }
        let scale = swept.remaining() / freedom;
        Some(Self {
            probability: *probability,
            coefficients: (0..width).map(|column| swept.coefficient(column)).collect(),
            covariance: DMatrix::from_fn(width, width, |row, column| scale * swept.covariance(row, column)),
            freedom,
        })
    }

    /// The probability, how far the coefficient of a column lies from a mean, and its standard deviation, widened so that a normal
    /// distribution ends where Student's does.
    fn beside(&self, column: usize, mean: f64) -> (f64, f64, f64) {
        let deviation = self.covariance[(column, column)].max(0.0).sqrt();
        (self.probability, self.coefficients[column] - mean, deviation * student(self.freedom))
    }
}

/// A noise for each channel, with the probability of all together. Of one channel these are its own noises; of several, draws in which
/// the noise of each goes through all of its own, in another order.
fn settings(channels: &[Vec<Possible>]) -> Vec<(f64, Vec<&Possible>)> {
    let channels: Vec<&[Possible]> =
        channels.iter().filter(|possible| !possible.is_empty()).map(Vec::as_slice).collect();
    if let [alone] = channels.as_slice() {
        return alone.iter().map(|possible| (possible.probability, vec![possible])).collect();
    }
    (0..DRAWS).map(|draw| (1.0 / number(DRAWS), drawn(&channels, draw))).collect()
}

/// A noise of each channel, by the number of the draw.
fn drawn<'p>(channels: &[&'p [Possible]], draw: usize) -> Vec<&'p Possible> {
    let (mut drawn, mut factor) = (Vec::with_capacity(channels.len()), 1);
    for possible in channels {
        let share = (number(draw * factor % DRAWS) + 0.5) / number(DRAWS);
        drawn.extend(at(possible, share));
        factor = factor * FACTOR % DRAWS;
    }
    drawn
}

/// The noise at which the sum of probabilities reaches a share.
fn at(possible: &[Possible], share: f64) -> Option<&Possible> {
    let mut sum = 0.0;
    let reached = possible.iter().find(|possible| {
        sum += possible.probability;
        sum >= share
    });
    reached.or(possible.last())
}

/// Draws of noises of several channels, a prime number: their numbers times a factor are the same numbers in another order. A sixtieth of
/// a distribution is less than the 2.5 % of it beyond each end of an interval.
const DRAWS: usize = 61;
/// A number whose powers are all numbers below that prime, so that no two of sixty channels have the same order.
const FACTOR: usize = 6;

/// How far from a middle 95 % of a sum of normal distributions end: of each the probability, its own middle beside that one and its deviation.
fn half(parts: &[(f64, f64, f64)], deviation: f64) -> f64 {
    let beyond = |half: f64| -> f64 {
        let of = |(probability, middle, deviation): &(f64, f64, f64)| {
            probability * (tail((half - middle) / deviation) + tail((half + middle) / deviation))
        };
        parts.iter().map(of).sum()
    };
    let (mut low, mut high) = (0.0, deviation);
    while beyond(high) > OUTSIDE && high < FARTHEST * deviation {
        high *= 2.0;
    }
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if beyond(middle) > OUTSIDE { low = middle } else { high = middle }
    }
    (low + high) / 2.0
}

/// What a 95 % interval leaves out.
const OUTSIDE: f64 = 0.05;
/// By Chebyshev's inequality 95 % of any distribution lie within 4.5 of its standard deviations; those of Student's are widened.
const FARTHEST: f64 = 64.0;
/// Halvings until an interval is known to seven digits.
const HALVINGS: usize = 30;

/// The probability of a normal distribution beyond so many standard deviations, to 1e-7: Abramowitz and Stegun, 26.2.17.
fn tail(deviations: f64) -> f64 {
    if deviations < 0.0 {
        return 1.0 - tail(-deviations);
    }
    let t = 1.0 / (1.0 + 0.231_641_9 * deviations);
    let series = [0.319_381_53, -0.356_563_782, 1.781_477_937, -1.821_255_978, 1.330_274_429];
    let sum = series.iter().rev().fold(0.0, |sum, coefficient| (sum + coefficient) * t);
    sum * (-deviations * deviations / 2.0).exp() / std::f64::consts::TAU.sqrt()
}

/// How many times wider the 95 % interval of Student's distribution is than the normal one, to 1 % from three degrees of freedom on: the
/// series of Fisher and Cornish in 1 / freedom (Abramowitz and Stegun, 26.7.5).
fn student(freedom: f64) -> f64 {
    let z = WIDTH_95;
    let [first, second, third] = [
        (z.powi(2) + 1.0) / 4.0,
        (5.0 * z.powi(4) + 16.0 * z.powi(2) + 3.0) / 96.0,
        (3.0 * z.powi(6) + 19.0 * z.powi(4) + 17.0 * z.powi(2) - 15.0) / 384.0,
    ];
    1.0 + (first + (second + third / freedom) / freedom) / freedom
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;

    /// A channel that may have noises of these probabilities, each known by the number of its samples.
    fn channel(probabilities: &[f64]) -> Vec<Possible> {
        let noise = |(probability, samples): (&f64, f64)| Possible {
            noise: Noise::white(1.0),
            probability: *probability,
            products: DMatrix::zeros(1, 1),
            samples,
        };
        probabilities.iter().zip([1.0, 2.0, 3.0]).map(noise).collect()
    }

    #[test]
    fn a_channel_alone_has_each_of_its_noises_and_several_draw_them() {
        let alone = channel(&[0.7, 0.2, 0.1]);
        let empty = Vec::new();
        let told = [alone, empty];
        let probabilities: Vec<f64> = settings(&told).iter().map(|(probability, _)| *probability).collect();
        assert_eq!(probabilities, [0.7, 0.2, 0.1]);
        let several = [channel(&[0.7, 0.2, 0.1]), channel(&[0.5, 0.5]), channel(&[0.9, 0.1])];
        let drawn = settings(&several);
        let sum = |is: &dyn Fn(&[&Possible]) -> bool| -> f64 {
            drawn.iter().filter(|(_, noises)| is(noises)).map(|(probability, _)| probability).sum()
        };
        for (number, channel) in several.iter().enumerate() {
            for possible in channel {
                let share = sum(&|noises| noises[number].samples == possible.samples);
                assert!((share - possible.probability).abs() < 1.0 / 61.0, "{number}: {share}");
            }
        }
        // Those of two channels come in no common order: together as often as chance has it.
        let together = sum(&|noises| noises[0].samples == 1.0 && noises[1].samples == 1.0);
        assert!((together - 0.35).abs() < 0.06, "{together}");
    }

    /// A column of ones over four samples under white noise of a variance, and a residual.
    fn of_mean(variance: f64, probability: f64, residual: [f64; 4]) -> Possible {
        let squares: f64 = residual.iter().map(|value| value * value).sum();
        let sum: f64 = residual.iter().sum();
        let products = DMatrix::from_row_slice(2, 2, &[4.0, sum, sum, squares]) / variance;
        Possible { noise: Noise::white(variance.sqrt()), probability, products, samples: 4.0 }
    }

    #[test]
    fn a_mean_of_four_has_the_interval_of_students_distribution() {
        let residual = [1.0, 2.0, 4.0, 5.0];
        let mixed = Mixed::new(&[vec![of_mean(1.0, 1.0, residual)]], 1);
        assert!((mixed.coefficients[0] - 3.0).abs() < 1e-12);
        // The variance of the values is 10 / 3, that of their mean a fourth of it; t of three degrees of freedom is 3.182.
        let half = WIDTH_95 * mixed.covariance[(0, 0)].sqrt();
        assert!((half / (3.182 * (10.0_f64 / 12.0).sqrt()) - 1.0).abs() < 0.01, "{half}");
        assert!((mixed.freedoms[0] - 3.0).abs() < 1e-9, "{:?}", mixed.freedoms);
    }

    #[test]
    fn channels_that_tell_no_noise_tell_no_effect() {
        let mixed = Mixed::new(&[Vec::new(), Vec::new()], 2);
        assert_eq!((mixed.coefficients, mixed.freedoms), (vec![0.0, 0.0], vec![0.0, 0.0]));
    }

    #[test]
    fn noises_that_may_be_either_way_are_known_with_few_degrees_of_freedom() {
        // Whatever its variance is told as, that of the residual is found again: the two parts are one.
        let residual = [1.0, 2.0, 4.0, 5.0];
        let same = Mixed::new(&[vec![of_mean(1.0, 0.5, residual), of_mean(9.0, 0.5, residual)]], 1);
        assert!((same.freedoms[0] - 3.0).abs() < 1e-9, "{:?}", same.freedoms);
        let other = [-7.0, 1.0, 5.0, 13.0];
        let apart = Mixed::new(&[vec![of_mean(1.0, 0.5, residual), of_mean(1.0, 0.5, other)]], 1);
        assert!(apart.freedoms[0] < 2.0, "{:?}", apart.freedoms);
    }

    #[test]
    fn one_normal_distribution_ends_where_tables_say() {
        for (deviations, beyond) in [(0.0, 0.5), (1.0, 0.158_655_3), (1.959_964, 0.025), (3.0, 0.001_349_9)] {
            assert!((tail(deviations) - beyond).abs() < 1e-6, "{deviations}");
            assert!((tail(-deviations) - (1.0 - beyond)).abs() < 1e-6, "{deviations}");
        }
        assert!((half(&[(1.0, 0.0, 3.0)], 3.0) - 3.0 * WIDTH_95).abs() < 1e-4);
    }

    #[test]
    fn a_sum_of_two_ends_where_both_together_leave_out_five_in_a_hundred() {
        // The wide one alone reaches far out: half of it, 5 % in all, is what it leaves out beyond 1.645 deviations.
        let half = half(&[(0.5, 0.0, 1e-3), (0.5, 0.0, 1.0)], 0.7);
        assert!((half - 1.644_854).abs() < 1e-4, "{half}");
    }

    #[test]
    fn students_distribution_ends_where_tables_say() {
        for (freedom, end) in [(3.0, 3.182), (5.0, 2.571), (10.0, 2.228), (30.0, 2.042), (120.0, 1.980)] {
            assert!((student(freedom) * WIDTH_95 / end - 1.0).abs() < 0.01, "{freedom}");
        }
    }
}
