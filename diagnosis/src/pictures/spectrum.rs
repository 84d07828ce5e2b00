//! Spectra. In: residuals over time or over the position of an axis. Out: the amplitude of each wave in them; of close ones
//! the highest, so that no line is lost.

use realfft::RealFftPlanner;

use super::channel::Sight;
use super::{PositionSpectrum, Spectrum};
use crate::noise::typical_step;
use crate::states::States;
use crate::terms::Shape;

/// The longest series that is transformed.
const LONGEST: usize = 1 << 22;
/// The fewest samples and bins.
const FEWEST: usize = 32;
/// How many amplitudes are drawn.
const SHOWN: usize = 400;
/// The fewest waves that a spectrum must have room for.
const WAVES: f64 = 8.0;

/// Amplitudes over frequency, for recordings whose rows are dense or in which a vibration was found.
pub(super) fn over_time(sight: &Sight<'_>, cleaned: &(Vec<f64>, Vec<f64>)) -> Option<Spectrum> {
    let scene = &sight.study.scenes[sight.scene];
    let found: Vec<(f64, String)> = sight.lines(|shape| match shape {
        Shape::Vibration { frequency } => Some(*frequency),
        _ => None,
    });
    if scene.sparse() && found.is_empty() {
        return None;
    }
    let time = &scene.recording.time;
    let step = typical_step(time);
    let places = Places::new(time, time.first().copied()?, time.last().copied()?, step)?;
    let of = |values: &[f64]| places.amplitudes(time, values, 4);
    Some(Spectrum { before: of(&cleaned.0), after: of(&cleaned.1), found })
}

/// Amplitudes over period along the axes with a cyclic finding; else along the one that travels farthest.
pub(super) fn over_position(
    sight: &Sight<'_>,
    states: &States,
    cleaned: &(Vec<f64>, Vec<f64>),
) -> Vec<PositionSpectrum> {
    let found = |axis: usize| {
        sight.lines(|shape| shape.wave_along().filter(|(of, _)| *of == axis).map(|(_, period)| period))
    };
    let moving = || (0..states.axes.len()).filter(|axis| states.axes[*axis].moves);
    let mut axes: Vec<usize> = moving().filter(|axis| !found(*axis).is_empty()).collect();
    if axes.is_empty() {
        let travel = |axis: &usize| ends(&states.axes[*axis].position).map_or(0.0, |(low, high)| high - low);
        axes.extend(moving().max_by(|a, b| travel(a).total_cmp(&travel(b))));
    }
    let of = |axis: usize| {
        let found = found(axis);
        let position = &states.axes[axis].position;
        let (low, high) = ends(position)?;
        let mut steps: Vec<f64> = position.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
        steps.retain(|step| *step > 1e-9 * (high - low));
        steps.sort_by(f64::total_cmp);
        let typical = steps.get(steps.len() / 2).copied()?;
        let shortest = found.iter().map(|(period, _)| period / 4.0).fold(typical, f64::min);
        if (high - low) / shortest < 2.0 * WAVES && found.is_empty() {
            return None;
        }
        let places = Places::new(position, low, high, shortest.max((high - low) / 20_000.0))?;
        let of = |values: &[f64]| {
            let amplitudes = places.amplitudes(position, values, 4);
            amplitudes.into_iter().rev().map(|(frequency, amplitude)| (1.0 / frequency, amplitude)).collect()
        };
        let known = &sight.study.equations.axes[axis];
        Some(PositionSpectrum {
            axis: known.letter.clone(),
            unit: if known.rotary { "rad" } else { "mm" },
            spectrum: Spectrum { before: of(&cleaned.0), after: of(&cleaned.1), found },
        })
    };
    axes.into_iter().filter_map(of).collect()
}

impl Sight<'_> {
    /// The waves of the model that `place` picks, with their names.
    fn lines(&self, place: impl Fn(&Shape) -> Option<f64>) -> Vec<(f64, String)> {
        let effects = self.model.effects.iter().map(|fitted| &fitted.effect);
        let of = |effect: &crate::model::Effect| {
            let motion = &self.study.equations.motions[effect.motion()?];
            Some((place(&effect.shape)?, format!("{} of {}", effect.shape.name(), motion.name)))
        };
        effects.filter_map(of).collect()
    }
}

fn ends(values: &[f64]) -> Option<(f64, f64)> {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    finite.fold(None, |ends, value| {
        let (low, high) = ends.unwrap_or((value, value));
        Some((low.min(value), high.max(value)))
    })
}

/// Equal bins along a state.
struct Places {
    low: f64,
    width: f64,
    bins: usize,
    /// The highest frequency that samples so far apart can tell.
    highest: f64,
}

/// Bins in the distance of two samples: what lies between their places is put off by an eighth of it at most.
const FINE: f64 = 4.0;

impl Places {
    /// Bins for samples that lie so far `apart`; nothing where there would be too few or too many.
    fn new(state: &[f64], low: f64, high: f64, apart: f64) -> Option<Self> {
        let bins = crate::index((FINE * (high - low) / apart).round())? + 1;
        let enough = state.len() >= FEWEST && (FEWEST..=LONGEST).contains(&bins);
        enough.then_some(Self {
            low,
            width: (high - low) / crate::number(bins - 1),
            bins,
            highest: 0.5 / apart,
        })
    }

    /// Frequency and amplitude, each wave taken alone, from one wave over the whole stretch to two samples a wave; at least `finer` times
    /// as many as there are independent ones.
    fn amplitudes(&self, state: &[f64], values: &[f64], finer: usize) -> Vec<(f64, f64)> {
        let length = (self.bins * finer).next_power_of_two().min(LONGEST);
        let (mut means, mut counts) = (vec![0.0; length], vec![0.0; length]);
        for (state, value) in state.iter().zip(values) {
            let bin = crate::index(((state - self.low) / self.width).round()).filter(|bin| *bin < length);
            if let Some(bin) = bin.filter(|_| value.is_finite()) {
                means[bin] += value;
                counts[bin] += 1.0;
            }
        }
        // Where an axis stood for long counts no more than where it passed.
        let seen = counts.iter().filter(|count| **count > 0.0).count();
        means.iter_mut().zip(&counts).for_each(|(mean, count)| *mean /= f64::max(*count, 1.0));
        let count = crate::number(seen).max(1.0);
        let middle = means.iter().sum::<f64>() / count;
        let known = means.iter_mut().zip(&counts).filter(|(_, count)| **count > 0.0);
        known.for_each(|(mean, _)| *mean -= middle);
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(length);
        let mut waves = transform.make_output_vec();
        // It fails for other lengths than its own only.
        if transform.process(&mut means, &mut waves).is_err() {
            return Vec::new();
        }
        let frequency = |wave: usize| crate::number(wave) / (crate::number(length) * self.width);
        let all = waves.iter().enumerate().skip(length.div_ceil(self.bins));
        let told = all.map(|(number, wave)| (frequency(number), 2.0 * wave.norm() / count));
        highest(told.take_while(|(frequency, _)| *frequency <= self.highest))
    }
}

/// Of each of equal stretches of the logarithm of the frequency the highest.
fn highest(amplitudes: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let amplitudes: Vec<(f64, f64)> = amplitudes.collect();
    let (Some(first), Some(last)) = (amplitudes.first(), amplitudes.last()) else { return Vec::new() };
    let width = (last.0 / first.0).ln() / crate::number(SHOWN);
    let mut highest: Vec<(f64, f64)> = Vec::with_capacity(SHOWN);
    let mut stretch = None;
    for (frequency, amplitude) in amplitudes.iter().copied() {
        let here = crate::index(((frequency / first.0).ln() / width).floor());
        match highest.last_mut() {
            Some(peak) if here == stretch => {
                if amplitude > peak.1 {
                    *peak = (frequency, amplitude);
                }
            }
            _ => highest.push((frequency, amplitude)),
        }
        stretch = here;
    }
    highest
}
