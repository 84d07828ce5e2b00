//! Waves: the search for periods along axes and frequencies in time.
//!
//! In: the residual of every channel under the present model, and its noise. Out: the most promising `cyclic` and
//! `vibration` effects, with how many independent waves were looked at. The residual is weighted by the inverse of its
//! noise, sorted into fine bins of position or time, and Fourier transformed at once: each bin of the spectrum is then
//! what generalised least squares would gain from that wave.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use crate::candidates::Travel;
use crate::design::STRETCH;
use crate::model::{Effect, Model, Place, Side};
use crate::noise::{Noise, Whitening, typical_step, unwhiten, whiten};
use crate::observations::{Course, Frame, Terms};
use crate::study::Study;
use crate::terms::Shape;

/// A wave that might be there.
#[derive(Clone, Debug)]
pub(crate) struct Peak {
    pub(crate) effect: Effect,
    /// What it would take from the weighted sum of squares, roughly.
    pub(crate) gain: f64,
}

/// The residual of one channel: raw, weighted by the inverse of the noise, and which samples count.
pub(crate) struct Weighted {
    pub(crate) white: Vec<f64>,
    weighted: Vec<f64>,
    pub(crate) valid: Vec<bool>,
}

/// What a channel sees of each motion, summed up for waves: gain times weighted residual.
struct Source {
    motion: usize,
    side: Side,
    /// For each scene a column.
    products: Vec<Vec<f64>>,
    /// The mean of the squared gain times the squared weight of the noise, over all samples.
    strength: f64,
}

/// The weighted residuals of all channels of a scene under a model.
pub(crate) fn weighted(study: &Study<'_>, scene: usize, model: &Model, noises: &[Noise], course: &Course) -> Vec<Weighted> {
    let channels = &study.scenes[scene].channels;
    let raws = residuals(study, scene, model, course);
    raws.into_iter()
        .zip(channels)
        .zip(noises)
        .map(|((raw, channel), noise)| {
            let valid: Vec<bool> =
                raw.iter().zip(&channel.outliers).map(|(value, outlier)| value.is_finite() && !outlier).collect();
            let steps = Whitening::new(*noise).steps(&study.scenes[scene].recording.time, &valid);
            let mut white = raw;
            whiten(&steps, &mut 0.0, &mut white);
            let mut weighted = white.clone();
            unwhiten(&steps, &mut weighted);
            Weighted { white, weighted, valid }
        })
        .collect()
}

/// Observed minus predicted of all channels of a scene, settings of the instrument included.
pub(crate) fn residuals(study: &Study<'_>, scene: usize, model: &Model, course: &Course) -> Vec<Vec<f64>> {
    let channels = &study.scenes[scene].channels;
    let mut residuals: Vec<Vec<f64>> = channels.iter().map(|_| Vec::new()).collect();
    each_frame(study, scene, model, course, |frame| {
        for (number, (channel, residual)) in channels.iter().zip(&mut residuals).enumerate() {
            let settings = frame.settings(study, scene, number, model);
            let values = frame.residual(study, scene, channel, model);
            residual.extend(values.iter().zip(settings).map(|(value, setting)| value - setting));
        }
    });
    residuals
}

/// Runs through the rows of a scene in stretches.
pub(crate) fn each_frame(
    study: &Study<'_>,
    scene: usize,
    model: &Model,
    course: &Course,
    mut each: impl FnMut(&Frame<'_>),
) {
    let (mut terms, mut drive_terms) = (Terms::new(model), Terms::new(model));
    let rows = study.scenes[scene].rows();
    let mut from = 0;
    while from < rows {
        let end = (from + STRETCH).min(rows);
        each(&Frame::new(study, course, from..end, &mut terms, &mut drive_terms));
        from = end;
    }
}

/// The most promising waves of every kind, and how many independent ones were looked at.
pub(crate) fn peaks(
    study: &Study<'_>,
    model: &Model,
    courses: &[Course],
    residuals: &[Vec<Weighted>],
    travels: &[Travel],
) -> (Vec<Peak>, f64) {
    let sources = sources(study, model, courses, residuals);
    let mut peaks = Vec::new();
    let mut tried = 0.0;
    for source in &sources {
        let own_axis = study.equations.motions[source.motion].axis;
        if let Some(axis) = own_axis.filter(|axis| travels[*axis].moves) {
            let positions: Vec<&[f64]> =
                courses.iter().map(|course| course.shown.axes[axis].position.as_slice()).collect();
            let travel = &travels[axis];
            let shortest = 2.2 * travel.step;
            if shortest < travel.range() / 2.0 {
                tried += travel.range() / shortest;
                let found = spectrum(&source.products, &positions, travel.low, travel.range(), shortest);
                peaks.extend(best(&found, 2.0 / travel.range(), 3).into_iter().map(|(frequency, power)| Peak {
                    effect: effect(source, Shape::Cyclic { axis, period: 1.0 / frequency }),
                    gain: power / source.strength,
                }));
            }
        }
        let times: Vec<&[f64]> = courses.iter().map(|course| course.shown.time.as_slice()).collect();
        let span = times.iter().filter_map(|time| time.last()).copied().fold(0.0, f64::max);
        let step = times.iter().map(|time| typical_step(time)).fold(f64::INFINITY, f64::min);
        if span > 10.0 * step {
            tried += span / (2.0 * step);
            let found = spectrum(&source.products, &times, 0.0, span, 2.0 * step);
            peaks.extend(best(&found, 5.0 / span, 3).into_iter().map(|(frequency, power)| Peak {
                effect: effect(source, Shape::Vibration { frequency }),
                gain: power / source.strength,
            }));
        }
    }
    (peaks, tried / crate::number(sources.len().max(1)))
}

fn effect(source: &Source, shape: Shape) -> Effect {
    Effect { place: Place::Motion { motion: source.motion, side: source.side }, shape }
}

/// Gain times weighted residual of every motion that is seen; motions that are seen alike stand for one another.
fn sources(study: &Study<'_>, model: &Model, courses: &[Course], residuals: &[Vec<Weighted>]) -> Vec<Source> {
    let motions = study.equations.motions.len();
    let mut sources: Vec<Source> = Vec::new();
    for side in [Side::After, Side::Drive] {
        let mut sums = vec![(0.0, Vec::new()); motions];
        for (scene, course) in courses.iter().enumerate() {
            for (_, products) in &mut sums {
                products.push(Vec::with_capacity(study.scenes[scene].rows()));
            }
            each_frame(study, scene, model, course, |frame| {
                add_sources(study, scene, model, frame, side, &residuals[scene], &mut sums);
            });
        }
        for (motion, (strength, products)) in sums.into_iter().enumerate() {
            let driven = study.equations.motions[motion]
                .axis
                .is_some_and(|axis| study.own[axis] == Some(motion) && study.has_drive(axis));
            if strength > 0.0 && (side == Side::After || driven) {
                sources.push(Source { motion, side, products, strength: 0.5 * strength });
            }
        }
    }
    sources
}

fn add_sources(
    study: &Study<'_>,
    scene: usize,
    model: &Model,
    frame: &Frame<'_>,
    side: Side,
    residuals: &[Weighted],
    sums: &mut [(f64, Vec<Vec<f64>>)],
) {
    let rows = frame.first_row()..frame.first_row() + frame.len();
    let mut added: Vec<Option<Vec<f64>>> = vec![None; sums.len()];
    for (channel, residual) in study.scenes[scene].channels.iter().zip(residuals) {
        let weight = residual.weight();
        let gains = frame.gains(study, scene, channel, model, side);
        for ((gain, added), (strength, _)) in gains.iter().zip(&mut added).zip(sums.iter_mut()) {
            let Some(gain) = gain else { continue };
            let target = added.get_or_insert_with(|| vec![0.0; rows.len()]);
            for (((target, gain), value), valid) in
                target.iter_mut().zip(gain).zip(&residual.weighted[rows.clone()]).zip(&residual.valid[rows.clone()])
            {
                if *valid && gain.is_finite() {
                    *target += gain * value;
                    *strength += gain * gain * weight;
                }
            }
        }
    }
    for (added, (_, products)) in added.into_iter().zip(sums) {
        if let Some(column) = products.last_mut() {
            column.extend(added.unwrap_or_else(|| vec![0.0; rows.len()]));
        }
    }
}

impl Weighted {
    /// The mean weight of a sample: that of the fast part of the noise.
    fn weight(&self) -> f64 {
        let counted = self.white.iter().zip(&self.weighted).zip(&self.valid).filter(|(_, valid)| **valid);
        let (white, weighted) = counted.fold((0.0, 0.0), |(white, weighted), ((a, b), _)| (white + a * a, weighted + b * b));
        if white > 0.0 { weighted / white } else { 0.0 }
    }
}

/// Squared magnitude of the Fourier sum of weights at places between `low` and `low + range`, from frequency 0 by equal
/// steps up to that of the shortest period: pairs of frequency and power.
fn spectrum(weights: &[Vec<f64>], places: &[&[f64]], low: f64, range: f64, shortest: f64) -> Vec<(f64, f64)> {
    // Six bins for the shortest period, and the range padded to twice its length.
    let wanted = (2.0 * range / shortest * 6.0).min(4e6);
    let size = (8..22).map(|power| 1 << power).find(|size| crate::number(*size) >= wanted).unwrap_or(1 << 22);
    let bin = 2.0 * range / crate::number(size);
    let mut bins = vec![Complex::new(0.0, 0.0); size];
    for (weights, places) in weights.iter().zip(places) {
        for (weight, place) in weights.iter().zip(*places) {
            if let Some(target) = crate::index((place - low) / bin).and_then(|index| bins.get_mut(index)) {
                target.re += weight;
            }
        }
    }
    FftPlanner::new().plan_fft_forward(size).process(&mut bins);
    let step = 1.0 / (2.0 * range);
    let frequencies = (0..size / 2).map(|number| crate::number(number) * step);
    frequencies
        .zip(bins)
        .take_while(|(frequency, _)| *frequency <= 1.0 / shortest)
        .map(|(frequency, value)| (frequency, value.norm_sqr()))
        .collect()
}

/// The highest peaks above a frequency, measured against the spectrum around them, so that a slope is no peak.
fn best(spectrum: &[(f64, f64)], above: f64, count: usize) -> Vec<(f64, f64)> {
    let mut peaks: Vec<(f64, f64)> = spectrum
        .windows(3)
        .filter(|three| three[1].0 >= above && three[1].1 >= three[0].1 && three[1].1 > three[2].1)
        .map(|three| (vertex(three), three[1].1))
        .collect();
    peaks.sort_by(|a, b| b.1.total_cmp(&a.1));
    peaks.truncate(count);
    peaks
}

/// The place of the top of the parabola through three points of the spectrum.
fn vertex(three: &[(f64, f64)]) -> f64 {
    let (left, middle, right) = (three[0].1.sqrt(), three[1].1.sqrt(), three[2].1.sqrt());
    let curvature = left - 2.0 * middle + right;
    let shift = if curvature < 0.0 { 0.5 * (left - right) / curvature } else { 0.0 };
    three[1].0 + shift * (three[1].0 - three[0].0)
}
