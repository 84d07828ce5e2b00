//! The size from which on an effect is found in nine of ten trials.
//!
//! In: trials at several sizes, each found or not. Out: that size with its uncertainty, and the size at which the next trial tells most.
//!
//! Whether an effect is found depends on its sign, its phase and its place beside the noise that stands in the recording. So the share
//! of the trials that find it rises with its size from nothing to nearly all, as in psychophysics, and is measured the same way: a
//! normal distribution over the logarithm of the size, its middle and its width from all trials by Bayes' theorem, each trial where it
//! tells most. (Watson and Pelli 1983; Kontsevich and Tyler 1999.)

/// The share of trials in which an effect is found: nine of ten.
pub const SHARE: f64 = 0.9;

/// The share that is missed at any size: an effect that meets what the recording has of the same kind. Below a tenth, so that nine of ten
/// can be reached.
const MISSED: f64 = 0.04;

/// The share that is taken as found where nothing is: a claim of the same shape by chance.
const GUESSED: f64 = 0.01;

/// Widths of the rise in the logarithm of the size, each with its weight before any trial. An effect is claimed at some five standard
/// errors, and its estimate scatters by one: a fifth. Places and periods that differ widen it; where only the sign is drawn it is narrow.
const WIDTHS: [(f64, f64); 6] = [(0.06, 1.0), (0.1, 2.0), (0.16, 3.0), (0.25, 2.5), (0.4, 1.0), (0.63, 0.5)];

/// The width where nothing is drawn: less than the uncertainty that ends a search.
const SHARP: f64 = 0.02;

/// The steps of the middle: finer than the uncertainty that ends a search.
const STEP: f64 = 0.02;

/// A distribution of the middle and the width of the rise.
#[derive(Clone, Debug)]
pub struct Posterior {
    points: Vec<Point>,
}

#[derive(Clone, Copy, Debug)]
struct Point {
    /// The logarithm of the size that is found in half of the trials, lapses aside.
    middle: f64,
    width: f64,
    weight: f64,
}

impl Posterior {
    /// Before any trial: the size is known but for a factor of `exp(spread)`.
    pub fn new(size: f64, spread: f64) -> Self {
        Self::with(size, spread, &WIDTHS)
    }

    /// The same where all trials of a size are one and the same: found from one size on, and never below it.
    pub fn sharp(size: f64, spread: f64) -> Self {
        Self::with(size, spread, &[(SHARP, 1.0)])
    }

    fn with(size: f64, spread: f64, widths: &[(f64, f64)]) -> Self {
        let steps = (4.0 * spread / STEP).ceil();
        let count = 2 * crate::index(steps);
        let points = (0..=count).flat_map(|step| {
            let away = crate::number(step) * STEP - steps * STEP;
            let near = (-0.5 * (away / spread).powi(2)).exp();
            let point = move |(width, weight): &(f64, f64)| Point {
                middle: size.ln() + away,
                width: *width,
                weight: near * weight,
            };
            widths.iter().map(point)
        });
        let mut posterior = Self { points: points.collect() };
        posterior.normalise();
        posterior
    }

    /// Takes a trial in.
    pub fn observe(&mut self, size: f64, found: bool) {
        for point in &mut self.points {
            let share = point.share(size.ln());
            point.weight *= if found { share } else { 1.0 - share };
        }
        self.normalise();
    }

    /// The size that nine of ten trials find: the median of what it may be. Its mean lies higher, since a rise that may be wide has much
    /// room above and little below.
    pub fn limit(&self) -> f64 {
        let widths = widths_to(SHARE);
        let mut sizes: Vec<(f64, f64)> =
            self.points.iter().map(|point| (point.at(widths), point.weight)).collect();
        sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut below = 0.0;
        let middle = sizes.into_iter().find(|(_, weight)| {
            below += weight;
            below >= 0.5
        });
        middle.map_or_else(|| self.reaches(SHARE), |(size, _)| size.exp())
    }

    /// Its relative standard uncertainty.
    pub fn uncertainty(&self) -> f64 {
        let widths = widths_to(SHARE);
        let mean = self.mean(|point| point.at(widths));
        self.mean(|point| (point.at(widths) - mean).powi(2)).sqrt()
    }

    /// The size that this share of the trials finds.
    pub fn reaches(&self, share: f64) -> f64 {
        let widths = widths_to(share);
        self.mean(|point| point.at(widths)).exp()
    }

    /// The share of the trials at a size that find it.
    pub fn share(&self, size: f64) -> f64 {
        self.mean(|point| point.share(size.ln()))
    }

    fn mean(&self, of: impl Fn(&Point) -> f64) -> f64 {
        self.points.iter().map(|point| point.weight * of(point)).sum()
    }

    fn normalise(&mut self) {
        let sum: f64 = self.points.iter().map(|point| point.weight).sum();
        self.points.iter_mut().for_each(|point| point.weight /= sum.max(f64::MIN_POSITIVE));
    }
}

impl Point {
    fn share(&self, size: f64) -> f64 {
        GUESSED + (1.0 - GUESSED - MISSED) * normal((size - self.middle) / self.width)
    }

    /// The logarithm of the size so many widths above the middle.
    fn at(&self, widths: f64) -> f64 {
        self.middle + self.width * widths
    }
}

/// How many widths above the middle this share of the trials finds an effect.
fn widths_to(share: f64) -> f64 {
    quantile((share - GUESSED) / (1.0 - GUESSED - MISSED))
}

/// The normal distribution function, to 2e-7: Abramowitz and Stegun, Handbook of Mathematical Functions, 26.2.17.
fn normal(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * x.abs());
    let powers = [0.319_381_530, -0.356_563_782, 1.781_477_937, -1.821_255_978, 1.330_274_429];
    let sum = powers.iter().rev().fold(0.0, |sum, power| t * (power + sum));
    let beyond = (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt() * sum;
    if x < 0.0 { beyond } else { 1.0 - beyond }
}

/// Its inverse, by halving.
fn quantile(share: f64) -> f64 {
    let (mut low, mut high) = (-6.0, 6.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if normal(middle) < share { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use simulation::noise::Source;

    use super::*;

    #[test]
    fn the_normal_distribution_is_that_of_the_tables() {
        for (x, share) in [(0.0, 0.5), (1.0, 0.841_344_75), (-1.96, 0.024_997_9), (3.0, 0.998_650_1)] {
            assert!((normal(x) - share).abs() < 3e-7, "{x}");
            assert!((quantile(share) - x).abs() < 1e-4, "{share}");
        }
    }

    /// What is found in a share of trials that rises like a logistic function, which the posterior does not know: its nine of ten are met.
    #[test]
    fn the_size_of_nine_of_ten_is_met_within_its_uncertainty() {
        let (slope, middle) = (8.0, 2.0_f64.ln());
        let truth = (middle + (0.9_f64 / 0.1).ln() / slope).exp();
        let mut away = Vec::new();
        for seed in 0..40 {
            let mut source = Source::new(seed, "trials");
            let mut posterior = Posterior::new(1.0, 1.0);
            for trial in 0..40 {
                let size = posterior.reaches(if trial % 2 == 0 { 0.8 } else { 0.5 });
                let share = 1.0 / (1.0 + (-slope * (size.ln() - middle)).exp());
                posterior.observe(size, source.uniform() < share);
            }
            away.push((posterior.limit() / truth).ln());
        }
        let mean = away.iter().sum::<f64>() / 40.0;
        let spread = (away.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / 40.0).sqrt();
        assert!(mean.abs() < 0.08 && spread < 0.15, "{mean} +- {spread}");
    }

    #[test]
    fn what_is_always_found_lies_below_and_what_is_never_found_above() {
        let mut below = Posterior::new(1.0, 1.0);
        let mut above = below.clone();
        (0..10).for_each(|_| below.observe(0.5, true));
        (0..10).for_each(|_| above.observe(2.0, false));
        assert!(below.limit() < 0.5 && above.limit() > 2.0, "{} {}", below.limit(), above.limit());
    }
}
