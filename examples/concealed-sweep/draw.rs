//! Random choices. In: a seed and the number of a case. Out: numbers, the same ones every time.

use std::f64::consts::TAU;

use simulation::noise::Source;

/// A stream of choices.
pub(crate) struct Draw(Source);

impl Draw {
    /// The stream of one case under a seed.
    pub(crate) fn new(seed: u64, number: usize) -> Self {
        Self(Source::new(seed, &format!("case {number}")))
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    /// Between two positive numbers, evenly over their ratio.
    pub(crate) fn ratio(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// A number of either sign.
    pub(crate) fn either(&mut self, size: f64) -> f64 {
        if self.chance(0.5) { size } else { -size }
    }

    pub(crate) fn chance(&mut self, share: f64) -> bool {
        self.0.uniform() < share
    }

    /// Below a number.
    pub(crate) fn index(&mut self, below: usize) -> usize {
        let at = self.0.uniform() * below as f64;
        (1..below).take_while(|entry| *entry as f64 <= at).count()
    }

    pub(crate) fn count(&mut self, low: u32, high: u32) -> u32 {
        let at = self.0.uniform() * f64::from(high + 1 - low);
        (low..=high).find(|entry| f64::from(entry + 1 - low) > at).unwrap_or(high)
    }

    pub(crate) fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.index(from.len())]
    }

    /// One of them, by weight.
    pub(crate) fn weighted<T: Copy>(&mut self, from: &[(T, f64)]) -> T {
        let total: f64 = from.iter().map(|(_, weight)| weight).sum();
        let mut at = self.0.uniform() * total;
        for (entry, weight) in from {
            at -= weight;
            if at < 0.0 {
                return *entry;
            }
        }
        from[from.len() - 1].0
    }

    pub(crate) fn seed(&mut self) -> u64 {
        self.index(1 << 20) as u64
    }

    /// A smooth curve at evenly spaced nodes, its largest value `size`: a few waves and a bow.
    pub(crate) fn curve(&mut self, nodes: usize, size: f64) -> Vec<f64> {
        let waves: Vec<[f64; 3]> = (0..4)
            .map(|wave| {
                let turns = 0.4 + 0.8 * f64::from(wave) + self.between(-0.2, 0.2);
                [turns, self.between(-1.0, 1.0) / (1.0 + f64::from(wave)), self.between(0.0, TAU)]
            })
            .collect();
        let at = |node: usize| {
            let along = node as f64 / (nodes - 1).max(1) as f64;
            waves.iter().map(|[turns, size, phase]| size * (TAU * turns * along + phase).sin()).sum::<f64>()
        };
        let raw: Vec<f64> = (0..nodes).map(at).collect();
        let largest = raw.iter().fold(1e-9_f64, |largest, value| largest.max(value.abs()));
        raw.into_iter().map(|value| value * size / largest).collect()
    }
}
