//! What readings say of an effect where nobody knows their noise. In: the readings of a channel beside all that is known, and
//! what an effect shows in it. Out: how much likelier the readings are with the effect than without it.
//!
//! An effect may be many times as large as the noise and leave no trace: a slow one in a single run looks like noise that
//! wanders. The noise that suits the readings best is looked for with the effect and without it, so that such an effect gains
//! nothing. What gains nothing here, nobody can find.

use crate::case::{dot, remove};

/// White noise of variance 1 and an Ornstein-Uhlenbeck process beside it.
#[derive(Clone, Copy)]
struct Family {
    /// The variance of the process.
    wander: f64,
    /// Its correlation time.
    time_constant: f64,
}

/// What a channel shows.
pub(crate) struct Channel<'c> {
    pub(crate) time: &'c [f64],
    /// What is left of the readings beside all that is known and beside the effect; NaN where there is no reading.
    pub(crate) noise: &'c [f64],
    /// What the effect shows.
    pub(crate) effect: &'c [f64],
    /// What is free besides an offset.
    pub(crate) free: &'c [Vec<f64>],
    /// Whether noise of this channel may wander.
    pub(crate) wanders: bool,
}

impl Channel<'_> {
    /// Twice the gain in log likelihood of a model that knows the effect over one that does not. Each has the noise that suits it best.
    pub(crate) fn gain(&self) -> f64 {
        let without: Vec<f64> =
            self.noise.iter().zip(self.effect).map(|(noise, effect)| noise + effect).collect();
        self.least_deviance(&without) - self.least_deviance(self.noise)
    }

    /// The deviance, -2 log L, of readings under the noise that suits them best.
    fn least_deviance(&self, readings: &[f64]) -> f64 {
        let mut best = self.deviance(readings, None);
        let (Some(first), Some(last)) = (self.time.first(), self.time.last()) else { return best };
        let steps = self.time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
        let step = steps.fold(f64::INFINITY, f64::min);
        if !self.wanders || !step.is_finite() {
            return best;
        }
        // From noise of one row to a random walk; from a trace of wander to hardly any white noise.
        let (shortest, longest) = (step, 100.0 * (last - first));
        let decades = (longest / shortest).log10();
        let (mut place, mut reach) = ([0.5 * decades, 2.0], [0.5 * decades, 4.0]);
        // Four rounds come within a tenth of a decade of the best noise, around which a deviance is flat.
        for _ in 0..4 {
            let center = place;
            for along in -4..=4 {
                for up in -4..=4 {
                    let here = [
                        center[0] + 0.25 * f64::from(along) * reach[0],
                        center[1] + 0.25 * f64::from(up) * reach[1],
                    ];
                    let noise = Family {
                        wander: 10_f64.powf(here[1]),
                        time_constant: shortest * 10_f64.powf(here[0]),
                    };
                    let deviance = self.deviance(readings, Some(noise));
                    if deviance < best {
                        (best, place) = (deviance, here);
                    }
                }
            }
            reach = reach.map(|reach| 0.3 * reach);
        }
        best
    }

    /// The deviance of readings under one noise of the family, or white noise alone. Its size, the offset and what else is free are
    /// those that suit best.
    fn deviance(&self, readings: &[f64], noise: Option<Family>) -> f64 {
        let ones = vec![1.0; readings.len()];
        let mut columns: Vec<&[f64]> = vec![&ones];
        columns.extend(self.free.iter().map(Vec::as_slice));
        columns.push(readings);
        let (mut white, logarithms) = whitened(self.time, &columns, noise);
        let mut left = white.pop().unwrap_or_default();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for mut column in white {
            basis.iter().for_each(|known| remove(&mut column, known));
            let length = dot(&column, &column).sqrt();
            if length > 1e-6 {
                column.iter_mut().for_each(|entry| *entry /= length);
                basis.push(column);
            }
        }
        basis.iter().for_each(|known| remove(&mut left, known));
        let rows = left.len() as f64;
        rows * (dot(&left, &left) / rows).ln() + logarithms
    }
}

/// Columns behind the Kalman filter of a noise, and the sum of the logarithms of the variances that it expects. Rows with a missing
/// value in any column are left out.
fn whitened(time: &[f64], columns: &[&[f64]], noise: Option<Family>) -> (Vec<Vec<f64>>, f64) {
    let mut white = vec![Vec::with_capacity(time.len()); columns.len()];
    let mut states = vec![0.0; columns.len()];
    let (mut variance, mut logarithms) = (0.0, 0.0);
    let mut before: Option<f64> = None;
    for (row, time) in time.iter().enumerate() {
        if let Some(noise) = noise {
            let step = before.map_or(f64::INFINITY, |before| (time - before).abs());
            let kept = (-step / noise.time_constant).exp();
            states.iter_mut().for_each(|state| *state *= kept);
            variance = kept * kept * variance + (1.0 - kept * kept) * noise.wander;
        }
        before = Some(*time);
        if columns.iter().any(|column| column[row].is_nan()) {
            continue;
        }
        let expected = variance + 1.0;
        for ((column, state), white) in columns.iter().zip(&mut states).zip(&mut white) {
            let new = column[row] - *state;
            white.push(new / expected.sqrt());
            *state += variance / expected * new;
        }
        variance /= expected;
        logarithms += expected.ln();
    }
    (white, logarithms)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use simulation::noise::Source;

    use super::*;

    const ROWS: usize = 2000;

    /// The gain of an effect of one channel, a row a second.
    fn gain(noise: &[f64], effect: impl Fn(f64) -> f64) -> f64 {
        let time: Vec<f64> = (0..ROWS).map(|row| row as f64).collect();
        let effect: Vec<f64> = time.iter().map(|time| effect(*time)).collect();
        Channel { time: &time, noise, effect: &effect, free: &[], wanders: true }.gain()
    }

    fn normals(seed: u64) -> Vec<f64> {
        let mut source = Source::new(seed, "evidence");
        (0..ROWS).map(|_| source.normal()).collect()
    }

    /// What no noise of the family looks like gains its whole energy, where that is little beside all of the noise.
    #[test]
    fn a_wave_of_ten_rows_gains_its_energy() {
        let energy = 0.5 * 0.2 * 0.2 * ROWS as f64;
        let seeds = 16;
        let gains = (0..seeds).map(|seed| gain(&normals(seed), |time| 0.2 * (TAU * time / 10.0).sin()));
        let mean = gains.sum::<f64>() / seeds as f64;
        // The standard deviation of a gain is twice the root of the energy.
        let deviation = 2.0 * energy.sqrt() / (seeds as f64).sqrt();
        assert!((mean - energy).abs() < 3.0 * deviation, "{mean} for {energy}");
    }

    /// Half a wave over the whole recording gains next to nothing beside a noise that wanders as slowly, however large it is over white noise.
    #[test]
    fn what_looks_like_wander_gains_next_to_nothing() {
        let energy = 0.5 * ROWS as f64;
        for seed in 0..5 {
            let mut walked = 0.0;
            let walk = normals(100 + seed).into_iter().map(|step| {
                walked += 0.1 * step;
                walked
            });
            let noise: Vec<f64> = normals(seed).iter().zip(walk).map(|(white, walk)| white + walk).collect();
            let gained = gain(&noise, |time| (0.5 * TAU * time / ROWS as f64).sin());
            assert!(gained < 0.02 * energy, "{gained} of {energy}");
        }
    }
}
