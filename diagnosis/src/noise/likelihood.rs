//! The likelihood of a residual as noise.
//!
//! In: a residual with its times and gaps, and noises to choose from. Out: how likely each of them is, all in one run through
//! the rows. A filter waits for its own row before, and the others go on meanwhile; each does what [`Whitening`] would do.
//!
//! [`Whitening`]: super::Whitening

use super::{Noise, same_step};

/// Minus twice the logarithm of the likelihood of a residual under each noise, its scale concentrated out, and that scale (a
/// variance).
pub(super) fn deviances<const N: usize>(
    time: &[f64],
    residual: &[f64],
    valid: &[bool],
    noises: [Noise; N],
) -> [(f64, f64); N] {
    let mut filters = Filters::new(noises);
    let mut sums = Sums::new();
    for ((time, value), valid) in time.iter().zip(residual).zip(valid) {
        filters.come(*time);
        if *valid {
            filters.take();
            let new = filters.new_in(*value);
            sums.add(new, filters.weight);
        } else {
            filters.pass();
        }
    }
    sums.deviances()
}

/// Whitening filters side by side.
struct Filters<const N: usize> {
    noises: [Noise; N],
    /// The variance and the state of the wandering part.
    variance: [f64; N],
    state: [f64; N],
    last: Option<f64>,
    /// The step of time for which `decay` was worked out: most steps are equal.
    step: f64,
    decay: [f64; N],
    /// Those of the row before, where that had a sample.
    gain: [f64; N],
    weight: [f64; N],
    /// Whether variances came out of the row before as they went into it: another such row does the same.
    settled: bool,
}

impl<const N: usize> Filters<N> {
    fn new(noises: [Noise; N]) -> Self {
        let zeros = [0.0; N];
        Self {
            noises,
            variance: noises.map(|noise| noise.wander * noise.wander),
            state: zeros,
            last: None,
            step: 0.0,
            decay: decays(&noises, 0.0),
            gain: zeros,
            weight: zeros,
            settled: false,
        }
    }

    /// The time goes on to the next row: states decay.
    fn come(&mut self, time: f64) {
        if let Some(last) = self.last.replace(time) {
            self.wait(time - last);
        }
        for (state, decay) in self.state.iter_mut().zip(&self.decay) {
            *state *= decay;
        }
    }

    fn wait(&mut self, step: f64) {
        if !same_step(step, self.step) {
            self.step = step;
            self.settled = false;
            self.decay = decays(&self.noises, step);
        }
    }

    /// A row without a sample: variances grow.
    fn pass(&mut self) {
        self.settled = false;
        for lane in 0..N {
            self.variance[lane] = self.grown(lane);
        }
    }

    /// A row with a sample.
    fn take(&mut self) {
        if self.settled {
            return;
        }
        let before = self.variance;
        for lane in 0..N {
            let (grown, white) = (self.grown(lane), self.noises[lane].white);
            let total = grown + white * white;
            self.gain[lane] = grown / total;
            self.variance[lane] = grown * (1.0 - self.gain[lane]);
            self.weight[lane] = 1.0 / total.sqrt();
        }
        self.settled = before == self.variance;
    }

    /// What is new in a sample, which goes into the states.
    fn new_in(&mut self, value: f64) -> [f64; N] {
        let new = self.state.map(|state| value - state);
        for (state, (gain, new)) in self.state.iter_mut().zip(self.gain.iter().zip(&new)) {
            *state += gain * new;
        }
        new
    }

    fn grown(&self, lane: usize) -> f64 {
        let stationary = self.noises[lane].wander * self.noises[lane].wander;
        let decay = self.decay[lane];
        decay * decay * self.variance[lane] + stationary * (1.0 - decay * decay)
    }
}

/// What is left of each wandering part after a time.
fn decays<const N: usize>(noises: &[Noise; N], step: f64) -> [f64; N] {
    noises.map(|noise| if noise.wander == 0.0 { 0.0 } else { (-step / noise.time_constant).exp() })
}

/// What adds up to likelihoods.
pub(super) struct Sums<const N: usize> {
    squares: [f64; N],
    /// Of weights: one logarithm for many factors, as long as their product is far from both ends of the numbers.
    product: [f64; N],
    logs: [f64; N],
    count: f64,
}

impl<const N: usize> Sums<N> {
    pub(super) fn new() -> Self {
        Self { squares: [0.0; N], product: [1.0; N], logs: [0.0; N], count: 0.0 }
    }

    /// Adds what is new in a sample under each noise, and 1 / standard deviation of that.
    pub(super) fn add(&mut self, new: [f64; N], weight: [f64; N]) {
        self.count += 1.0;
        for lane in 0..N {
            self.squares[lane] += new[lane] * new[lane] * weight[lane] * weight[lane];
            self.product[lane] *= weight[lane];
        }
        for lane in 0..N {
            if !(1e-100..1e100).contains(&self.product[lane]) {
                self.take_logarithm(lane);
            }
        }
    }

    fn take_logarithm(&mut self, lane: usize) {
        self.logs[lane] -= 2.0 * self.product[lane].ln();
        self.product[lane] = 1.0;
    }

    /// Minus twice the log-likelihood under each noise, its scale concentrated out, and that scale (a variance).
    pub(super) fn deviances(mut self) -> [(f64, f64); N] {
        std::array::from_fn(|lane| {
            self.take_logarithm(lane);
            let scale = (self.squares[lane] / self.count).max(f64::MIN_POSITIVE);
            (self.count * scale.ln() + self.logs[lane] + self.count, scale)
        })
    }
}
