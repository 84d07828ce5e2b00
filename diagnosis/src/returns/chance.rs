//! Chance: what noise gives that wanders as the residual does.
//!
//! In: the times of some rows and a noise. Out: residuals of nothing but that noise, the same in every run of the program. What a
//! function of a state predicts of them in other units is what chance predicts.

use crate::noise::Noise;
use crate::random::Random;

/// A generator of normal numbers.
pub(super) struct Normals(Random);

impl Normals {
    pub(super) fn new(seed: u64) -> Self {
        Self(Random::new(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x2545_F491_4F6C_DD1D))
    }

    /// A number between 0 and 1.
    fn uniform(&mut self) -> f64 {
        (f64::from(self.0.next()) + 0.5) / (f64::from(u32::MAX) + 1.0)
    }

    /// A normal number, by the transform of Box and Muller.
    fn normal(&mut self) -> f64 {
        let (radius, turn) = (self.uniform(), self.uniform());
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * turn).cos()
    }

    /// Noise at these times.
    pub(super) fn noise(&mut self, time: &[f64], noise: &Noise) -> Vec<f64> {
        let mut wander = noise.wander * self.normal();
        let mut last: Option<f64> = None;
        let mut draw = |time: &f64| {
            let step = last.replace(*time).map_or(0.0, |last| (time - last).abs());
            let decay = (-step / noise.time_constant).exp();
            wander = decay * wander + noise.wander * (1.0 - decay * decay).max(0.0).sqrt() * self.normal();
            wander + noise.white * self.normal()
        };
        time.iter().map(&mut draw).collect()
    }
}
