//! Waves: the search for periods along axes and frequencies in time.
//!
//! In: the residual of every channel under the present model, and its noise. Out: the most promising `cyclic` and
//! `vibration` effects, with how many independent waves were looked at. The residual is weighted by the inverse of its
//! noise, sorted into fine bins of position or time, and Fourier transformed at once: each bin of the spectrum is then
//! what generalised least squares would gain from that wave.

use std::ops::Range;
use std::sync::Arc;

use realfft::RealFftPlanner;

use crate::course::Course;
use crate::kinship;
use crate::model::{Effect, Model, Place};
use crate::noise::{Noise, Whitening, unwhiten, whiten};
use crate::observations::{Frame, each_frame, residuals};
use crate::parallel;
use crate::ranges::{CYCLES, shortest_step};
use crate::side::Side;
use crate::study::Study;
use crate::terms::Shape;
use crate::travel::Travel;

/// A wave that might be there.
#[derive(Clone, Debug)]
pub(crate) struct Peak {
    pub(crate) effect: Effect,
    /// What it would take from the weighted sum of squares, roughly.
    pub(crate) gain: f64,
}

/// The residual of one channel, weighted by the inverse of the noise, which samples count, and their mean weight.
pub(crate) struct Weighted {
    weighted: Vec<f64>,
    valid: Vec<bool>,
    weight: f64,
}

/// A place where waves are looked for; places at which the recordings show waves alike are looked at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WavePlace {
    motion: usize,
    side: Side,
    /// Whether along the motion's axis, in time, or both.
    cyclic: bool,
    vibration: bool,
}

impl WavePlace {
    /// The place of a wave of the machine.
    pub(crate) fn of(effect: &Effect) -> Option<Self> {
        let (motion, side) = (effect.motion()?, effect.side()?);
        let cyclic = matches!(effect.shape, Shape::Cyclic { .. });
        Some(Self { motion, side, cyclic, vibration: !cyclic })
    }
}

/// The places where waves can be looked for.
pub(crate) fn places(
    study: &Study<'_>,
    courses: &[Arc<Course>],
    noises: &[Vec<Noise>],
    travels: &[Travel],
) -> Vec<WavePlace> {
    let span =
        courses.iter().filter_map(|course| course.shown.given.time.last()).copied().fold(0.0, f64::max);
    let mut samples = Vec::new();
    for (motion, known) in study.equations.motions.iter().enumerate().filter(|(_, known)| !known.alignment) {
        let driven = known.axis.is_some_and(|axis| study.own[axis] == Some(motion) && study.has_drive(axis));
        let sides = [(Side::After, true), (Side::Drive, driven)];
        for side in sides.into_iter().filter(|(_, possible)| *possible).map(|(side, _)| side) {
            let place = Place::Motion { motion, side };
            if let Some(axis) = known.axis.filter(|axis| travels[*axis].moves) {
                // Any period and any frequency tell which places are alike.
                let period = travels[axis].range() / 3.7;
                samples.push(Effect { place, shape: Shape::Cyclic { axis, period } });
            }
            samples.push(Effect { place, shape: Shape::Vibration { frequency: 7.3 / span } });
        }
    }
    let mut places: Vec<WavePlace> = Vec::new();
    for kin in kinship::groups(study, courses, noises, samples) {
        let (Some(motion), Some(side)) = (kin.effect.motion(), kin.effect.side()) else { continue };
        let cyclic = matches!(kin.effect.shape, Shape::Cyclic { .. });
        match places.iter_mut().find(|known| (known.motion, known.side) == (motion, side)) {
            Some(known) => {
                known.cyclic |= cyclic;
                known.vibration |= !cyclic;
            }
            None => places.push(WavePlace { motion, side, cyclic, vibration: !cyclic }),
        }
    }
    places
}

/// What a channel sees of each motion, summed up for waves: gain times weighted residual.
struct Source {
    place: WavePlace,
    /// For each scene a column.
    products: Vec<Vec<f64>>,
    /// The mean of the squared gain times the squared weight of the noise, over all samples.
    strength: f64,
}

/// The weighted residuals of all channels of a scene under a model.
pub(crate) fn weighted(
    study: &Study<'_>,
    scene: usize,
    model: &Model,
    noises: &[Noise],
    course: &Course,
) -> Vec<Weighted> {
    let channels = &study.scenes[scene].channels;
    let raws = residuals(study, scene, model, course);
    raws.into_iter()
        .zip(channels)
        .zip(noises)
        .map(|((raw, channel), noise)| {
            let valid: Vec<bool> = raw
                .iter()
                .zip(&channel.outliers)
                .map(|(value, outlier)| value.is_finite() && !outlier)
                .collect();
            let steps = Whitening::new(*noise).steps(&study.scenes[scene].recording.time, &valid);
            let mut white = raw;
            whiten(&steps, &mut [0.0], &mut white);
            let mut weighted = white.clone();
            unwhiten(&steps, &mut weighted);
            let weight = mean_weight(&white, &weighted, &valid);
            Weighted { weighted, valid, weight }
        })
        .collect()
}

/// The most promising waves of every kind, and how many independent ones were looked at.
pub(crate) fn peaks(
    study: &Study<'_>,
    model: &Model,
    courses: &[Arc<Course>],
    residuals: &[Vec<Weighted>],
    travels: &[Travel],
    places: &[WavePlace],
) -> (Vec<Peak>, f64) {
    let (mut peaks, mut tried, mut count) = (Vec::new(), 0.0, 0_usize);
    // A column for each row and place at a time is too much.
    for places in places.chunks(PLACES) {
        let sources = sources(study, model, courses, residuals, places);
        count += sources.len();
        let spectra = parallel::counted(sources.len(), study.rows() * sources.len(), |number| {
            let source = &sources[number];
            [along(study, source, courses, travels), in_time(study, source, courses)]
        });
        for looked_at in spectra.into_iter().flatten().flatten() {
            tried += looked_at.tried;
            peaks.extend(looked_at.peaks);
        }
    }
    (peaks, tried / crate::number(count.max(1)))
}

/// At how many places waves are looked for at a time.
const PLACES: usize = 8;
/// How many waves of each kind are taken from one place.
const OF_A_PLACE: usize = 3;

/// The waves of one spectrum.
struct LookedAt {
    peaks: Vec<Peak>,
    /// How many independent ones there were.
    tried: f64,
}

/// Waves along the axis of a motion.
fn along(
    study: &Study<'_>,
    source: &Source,
    courses: &[Arc<Course>],
    travels: &[Travel],
) -> Option<LookedAt> {
    let axis = study.equations.motions[source.place.motion].axis.filter(|_| source.place.cyclic)?;
    let positions: Vec<&[f64]> = courses.iter().map(|course| &*course.shown.axes[axis].position).collect();
    let (low, range) = (travels[axis].low, travels[axis].range());
    let shortest = 2.2 * travels[axis].step;
    (shortest < range / 2.0).then_some(())?;
    let found = best(spectrum(&source.products, &positions, low, range, shortest), 2.0 / range, OF_A_PLACE);
    let peak = |(frequency, power): (f64, f64)| Peak {
        effect: effect(source, Shape::Cyclic { axis, period: 1.0 / frequency }),
        gain: power / source.strength,
    };
    Some(LookedAt { peaks: found.into_iter().map(peak).collect(), tried: range / shortest })
}

/// Waves in time.
fn in_time(study: &Study<'_>, source: &Source, courses: &[Arc<Course>]) -> Option<LookedAt> {
    let times: Vec<&[f64]> = courses.iter().map(|course| &*course.shown.given.time).collect();
    let span = times.iter().filter_map(|time| time.last()).copied().fold(0.0, f64::max);
    let step = shortest_step(study);
    (source.place.vibration && span > 10.0 * step).then_some(())?;
    let observed = study.scenes.iter().map(|scene| scene.observed).fold(0.0, f64::max);
    let found =
        best(spectrum(&source.products, &times, 0.0, span, 2.0 * step), CYCLES / observed, OF_A_PLACE);
    let peak = |(frequency, power): (f64, f64)| Peak {
        effect: effect(source, Shape::Vibration { frequency }),
        gain: power / source.strength,
    };
    Some(LookedAt { peaks: found.into_iter().map(peak).collect(), tried: span / (2.0 * step) })
}

fn effect(source: &Source, shape: Shape) -> Effect {
    Effect { place: Place::Motion { motion: source.place.motion, side: source.place.side }, shape }
}

/// Gain times weighted residual at every place.
fn sources(
    study: &Study<'_>,
    model: &Model,
    courses: &[Arc<Course>],
    residuals: &[Vec<Weighted>],
    places: &[WavePlace],
) -> Vec<Source> {
    let mut sources: Vec<Source> =
        places.iter().map(|place| Source { place: *place, products: Vec::new(), strength: 0.0 }).collect();
    for (scene, course) in courses.iter().enumerate() {
        for source in &mut sources {
            source.products.push(Vec::with_capacity(study.scenes[scene].rows()));
        }
        let sides: Vec<Side> = [Side::After, Side::Drive]
            .into_iter()
            .filter(|side| sources.iter().any(|source| source.place.side == *side))
            .collect();
        let gains = |frame: &Frame<'_>| -> Vec<(Side, Vec<Gains>)> {
            let channels = &study.scenes[scene].channels;
            let of = |side: Side| -> Vec<Gains> {
                channels.iter().map(|channel| frame.gains(study, scene, channel, model, side)).collect()
            };
            sides.iter().map(|side| (*side, of(*side))).collect()
        };
        each_frame(study, scene, model, course, gains, |rows, gains| {
            for (side, gains) in gains {
                add_sources(&rows, side, &gains, &residuals[scene], &mut sources);
            }
        });
    }
    sources.retain(|source| source.strength > 0.0);
    sources.iter_mut().for_each(|source| source.strength *= 0.5);
    sources
}

/// How a channel sees each error motion in a stretch of rows.
type Gains = Vec<Option<Vec<f64>>>;

/// Adds a stretch of rows to the sources of a side; `gains` and `residuals` are those of the channels.
fn add_sources(
    rows: &Range<usize>,
    side: Side,
    gains: &[Gains],
    residuals: &[Weighted],
    sources: &mut [Source],
) {
    let work = rows.len() * sources.len() * gains.len();
    parallel::each(sources, work, |source| {
        let Some(target) = source.products.last_mut().filter(|_| source.place.side == side) else { return };
        target.resize(rows.end, 0.0);
        for (gains, residual) in gains.iter().zip(residuals) {
            let Some(gain) = &gains[source.place.motion] else { continue };
            for (row, gain) in rows.clone().zip(gain) {
                if residual.valid[row] && gain.is_finite() {
                    target[row] += gain * residual.weighted[row];
                    source.strength += gain * gain * residual.weight;
                }
            }
        }
    });
}

/// The mean weight of a sample: that of the fast part of the noise.
fn mean_weight(white: &[f64], weighted: &[f64], valid: &[bool]) -> f64 {
    let counted = white.iter().zip(weighted).zip(valid).filter(|(_, valid)| **valid);
    let (white, weighted) =
        counted.fold((0.0, 0.0), |(white, weighted), ((a, b), _)| (white + a * a, weighted + b * b));
    if white > 0.0 { weighted / white } else { 0.0 }
}

/// Squared magnitude of the Fourier sum of weights at places between `low` and `low + range`, from frequency 0 by equal
/// steps up to that of the shortest period: pairs of frequency and power.
fn spectrum(
    weights: &[Vec<f64>],
    places: &[&[f64]],
    low: f64,
    range: f64,
    shortest: f64,
) -> impl Iterator<Item = (f64, f64)> {
    // Three bins for the shortest period, and the range padded to twice its length.
    let size = transform_size(2.0 * range / shortest * 3.0);
    let bin = 2.0 * range / crate::number(size);
    let mut bins = vec![0.0; size];
    for (weights, places) in weights.iter().zip(places) {
        for (weight, place) in weights.iter().zip(*places) {
            if let Some(target) = crate::index((place - low) / bin).and_then(|index| bins.get_mut(index)) {
                *target += weight;
            }
        }
    }
    let transform = RealFftPlanner::new().plan_fft_forward(size);
    let mut lines = transform.make_output_vec();
    if transform.process(&mut bins, &mut lines).is_err() {
        // It fails for lengths alone that are not its own.
        lines.clear();
    }
    let step = 1.0 / (2.0 * range);
    let frequencies = (0..lines.len()).map(move |number| crate::number(number) * step);
    frequencies
        .zip(lines)
        .take_while(move |(frequency, _)| *frequency <= 1.0 / shortest)
        .map(|(frequency, line)| (frequency, line.norm_sqr()))
}

/// The most bins of a transform.
const MOST_BINS: usize = 1 << 23;

/// A length that transforms fast, at least `wanted` where that is not too long: a power of two, or three quarters or
/// five eighths of one.
fn transform_size(wanted: f64) -> usize {
    let sizes = (8..=23).map(|power| 1_usize << power).flat_map(|size| [size / 8 * 5, size / 4 * 3, size]);
    sizes.into_iter().find(|size| crate::number(*size) >= wanted).unwrap_or(MOST_BINS)
}

/// The highest peaks above a frequency, measured against the spectrum around them, so that a slope is no peak.
fn best(spectrum: impl Iterator<Item = (f64, f64)>, above: f64, count: usize) -> Vec<(f64, f64)> {
    let mut peaks: Vec<(f64, f64)> = Vec::new();
    let mut before: [Option<(f64, f64)>; 2] = [None, None];
    for last in spectrum {
        if let [Some(first), Some(middle)] = before
            && middle.0 >= above
            && middle.1 >= first.1
            && middle.1 > last.1
        {
            // Of equal ones the first.
            let place = peaks.partition_point(|peak| peak.1.total_cmp(&middle.1).is_ge());
            peaks.insert(place, (vertex(&[first, middle, last]), middle.1));
            peaks.truncate(count);
        }
        before = [before[1], Some(last)];
    }
    peaks
}

/// The place of the top of the parabola through three points of the spectrum.
fn vertex(three: &[(f64, f64)]) -> f64 {
    let (left, middle, right) = (three[0].1.sqrt(), three[1].1.sqrt(), three[2].1.sqrt());
    let curvature = left - 2.0 * middle + right;
    let shift = if curvature < 0.0 { 0.5 * (left - right) / curvature } else { 0.0 };
    three[1].0 + shift * (three[1].0 - three[0].0)
}

#[cfg(test)]
mod tests;
