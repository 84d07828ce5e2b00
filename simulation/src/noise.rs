//! Noise: what stands between the truth and a reading.
//!
//! In: a seed, a name, times and true values. Out: values with noise, jumps, gaps and steps. Every channel draws from a
//! stream of its own, told apart by its name, so that a channel more or less changes no other; the same seed gives the
//! same bits. Sizes are in the unit of the values, times in s.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Source(ChaCha8Rng);

impl Source {
    /// The stream of a name under a seed.
    pub fn new(seed: u64, name: &str) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream_of(name));
        Self(generator)
    }

    /// A number of the standard normal distribution.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// A number of the uniform distribution, at least 0 and below 1.
    pub fn uniform(&mut self) -> f64 {
        // 53 bits: every number is exact.
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The number of a name's stream: the hash FNV-1a.
fn stream_of(name: &str) -> u64 {
    name.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Everything that a channel may suffer; the default is nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Standard deviation of white, normal noise.
    pub white: f64,
    /// Noise that remembers: a slow, wandering sensor.
    pub correlated: Option<Correlated>,
    /// A random walk: a sensor that never comes back.
    pub walk: Option<Walk>,
    /// Single readings that are far off.
    pub outliers: Option<Outliers>,
    /// The step of the display; 0: none.
    pub resolution: f64,
}

/// An Ornstein-Uhlenbeck process: normal with a fixed spread, forgetting exponentially. At equal steps it is AR(1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correlated {
    /// Standard deviation.
    pub sigma: f64,
    /// The time after which the correlation has fallen to 1/e, s.
    pub time_constant: f64,
}

/// A random walk that starts at zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walk {
    /// Standard deviation reached after the time [`Walk::after`].
    pub sigma: f64,
    /// That time, s.
    pub after: f64,
}

/// Readings that are far off, each alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outliers {
    /// The share of readings, 0 to 1.
    pub rate: f64,
    /// Their size: between half of it and one and a half, of either sign.
    pub size: f64,
}

/// Readings that are not there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Missing {
    /// The share of single readings, 0 to 1.
    pub rate: f64,
    /// How many whole stretches are lost, anywhere in the recording.
    pub blocks: u32,
    /// How long each of these stretches is, s.
    pub length: f64,
}

impl Noise {
    /// White noise only.
    pub fn white(sigma: f64) -> Self {
        Self { white: sigma, ..Self::default() }
    }

    /// Adds the noise to a column, sample by sample; the resolution comes last. A NaN stays one.
    pub fn apply(&self, time: &[f64], values: &mut [f64], source: &mut Source) {
        let mut walked = 0.0;
        let mut wandering: Option<f64> = None;
        let mut before: Option<f64> = None;
        for (value, &time) in values.iter_mut().zip(time) {
            let step = before.map_or(0.0, |before| (time - before).max(0.0));
            before = Some(time);
            if self.white > 0.0 {
                *value += self.white * source.normal();
            }
            if let Some(correlated) = &self.correlated {
                let next = correlated.next(wandering, step, source);
                wandering = Some(next);
                *value += next;
            }
            if let Some(walk) = &self.walk {
                walked += walk.sigma * (step / walk.after).sqrt() * source.normal();
                *value += walked;
            }
            if let Some(outliers) = &self.outliers {
                *value += outliers.draw(source);
            }
            *value = quantised(*value, self.resolution);
        }
    }
}

impl Correlated {
    fn next(&self, before: Option<f64>, step: f64, source: &mut Source) -> f64 {
        let fresh = self.sigma * source.normal();
        match before {
            None => fresh,
            Some(before) => {
                let kept = (-step / self.time_constant).exp();
                before * kept + fresh * (1.0 - kept * kept).max(0.0).sqrt()
            }
        }
    }
}

impl Outliers {
    fn draw(&self, source: &mut Source) -> f64 {
        // Always three numbers, so that a hit does not shift the noise of what follows.
        let (hit, size, side) = (source.uniform(), source.uniform(), source.uniform());
        let sign = if side < 0.5 { -1.0 } else { 1.0 };
        if hit < self.rate { sign * self.size * (0.5 + size) } else { 0.0 }
    }
}

/// The nearest multiple of a step; the value itself where the step is zero.
pub fn quantised(value: f64, step: f64) -> f64 {
    if step > 0.0 { (value / step).round() * step } else { value }
}

impl Missing {
    /// Which samples are lost.
    pub fn lost(&self, time: &[f64], source: &mut Source) -> Vec<bool> {
        let mut lost: Vec<bool> =
            time.iter().map(|_| self.rate > 0.0 && source.uniform() < self.rate).collect();
        let (Some(first), Some(last)) = (time.first(), time.last()) else { return lost };
        for _ in 0..self.blocks {
            let start = first + source.uniform() * (last - first - self.length).max(0.0);
            let inside = |time: f64| time >= start && time < start + self.length;
            lost.iter_mut().zip(time).filter(|(_, time)| inside(**time)).for_each(|(lost, _)| *lost = true);
        }
        lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(rows: u32, step: f64) -> Vec<f64> {
        (0..rows).map(|row| f64::from(row) * step).collect()
    }

    fn drawn(noise: Noise, time: &[f64], seed: u64) -> Vec<f64> {
        let mut values = vec![0.0; time.len()];
        noise.apply(time, &mut values, &mut Source::new(seed, "measured.x"));
        values
    }

    fn mean_product(left: &[f64], right: &[f64]) -> f64 {
        left.iter().zip(right).map(|(left, right)| left * right).sum::<f64>() / left.len() as f64
    }

    #[test]
    fn white_noise_has_its_spread_and_no_memory() {
        let values = drawn(Noise::white(2.0), &times(200_000, 0.1), 1);
        assert!((mean_product(&values, &values) - 4.0).abs() < 0.06);
        assert!(mean_product(&values, &values[1..]).abs() < 0.06);
    }

    #[test]
    fn correlated_noise_forgets_in_its_time() {
        let noise =
            Noise { correlated: Some(Correlated { sigma: 3.0, time_constant: 2.0 }), ..Noise::default() };
        let values = drawn(noise, &times(400_000, 0.5), 2);
        assert!((mean_product(&values, &values) - 9.0).abs() < 0.3);
        let after_two_seconds = mean_product(&values[..values.len() - 4], &values[4..]);
        assert!((after_two_seconds - 9.0 * (-1.0_f64).exp()).abs() < 0.3);
    }

    #[test]
    fn a_walk_spreads_with_the_root_of_time() {
        let noise = Noise { walk: Some(Walk { sigma: 2.0, after: 10.0 }), ..Noise::default() };
        let time = times(41, 1.0);
        let ends: Vec<f64> = (0..4000).map(|seed| drawn(noise, &time, seed)[40]).collect();
        assert!((mean_product(&ends, &ends) - 16.0).abs() < 1.2);
    }

    #[test]
    fn outliers_are_rare_and_large() {
        let noise = Noise { outliers: Some(Outliers { rate: 0.01, size: 10.0 }), ..Noise::default() };
        let values = drawn(noise, &times(100_000, 1.0), 3);
        let far: Vec<f64> = values.into_iter().filter(|value| *value != 0.0).collect();
        assert!((900..1100).contains(&far.len()), "{}", far.len());
        assert!(far.iter().all(|value| (5.0..15.0).contains(&value.abs())));
    }

    #[test]
    fn readings_are_multiples_of_the_resolution() {
        let noise = Noise { white: 1.0, resolution: 0.25, ..Noise::default() };
        let values = drawn(noise, &times(1000, 1.0), 4);
        assert!(values.iter().all(|value| value % 0.25 == 0.0));
        assert!(quantised(f64::NAN, 0.1).is_nan());
    }

    #[test]
    fn seeds_and_names_make_the_stream() {
        let time = times(100, 1.0);
        assert_eq!(drawn(Noise::white(1.0), &time, 7), drawn(Noise::white(1.0), &time, 7));
        assert_ne!(drawn(Noise::white(1.0), &time, 7), drawn(Noise::white(1.0), &time, 8));
        assert_ne!(Source::new(7, "x").normal(), Source::new(7, "y").normal());
    }

    #[test]
    fn blocks_are_lost_whole() {
        let missing = Missing { rate: 0.0, blocks: 1, length: 5.0 };
        let lost = missing.lost(&times(100, 1.0), &mut Source::new(1, "missing"));
        let first = lost.iter().position(|lost| *lost).unwrap();
        assert_eq!(lost.iter().filter(|lost| **lost).count(), 5);
        assert!(lost[first..first + 5].iter().all(|lost| *lost));
        assert!(Missing::default().lost(&[], &mut Source::new(1, "missing")).is_empty());
    }
}
