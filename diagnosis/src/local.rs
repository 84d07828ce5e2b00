//! Local features: what remains at one place of an axis, pass after pass.
//!
//! In: the residual that a model leaves. Out: where on which axis it comes back in every pass, and how large it is. The
//! scatter from pass to pass is the yardstick, so that a wandering sensor, which does not know where the axis is, gives
//! nothing.

use std::ops::Range;
use std::sync::Arc;

use crate::appraisal::Appraisal;
use crate::channel::ChannelAt;
use crate::course::Course;
use crate::model::Model;
use crate::rounded;
use crate::study::Study;
use crate::travel::Travel;
use crate::unsteady;

/// Something that comes back at one place of an axis.
#[derive(Clone, Debug)]
pub(crate) struct Feature {
    pub(crate) scene: usize,
    pub(crate) channel: usize,
    pub(crate) axis: usize,
    /// Which passes show it: +1 or -1 for one direction of motion, 0 for both.
    pub(crate) direction: f64,
    /// Where, mm or rad.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// The root mean square of the mean residual there.
    pub(crate) rms: f64,
    /// The mean residual at its highest, in standard deviations.
    pub(crate) strength: f64,
    /// The places and the mean residual of all passes there.
    pub(crate) profile: Vec<(f64, f64)>,
}

impl Feature {
    /// The share of the travel that it covers.
    pub(crate) fn extent(&self, travel: &Travel) -> f64 {
        (self.to - self.from) / travel.range()
    }
}

/// How many standard deviations the mean residual at its highest place must be above zero. There are many places to choose from.
const SURE: f64 = 6.0;
/// It must be this share of the noise of a single sample, at least.
const MATERIAL: f64 = 0.7;
/// And this share of that of the noisiest channel beside it: a fine feedback shows what does not matter to the whole.
const BESIDE: f64 = 0.3;
/// Places of at least this share of the height belong to the feature.
const FLANK: f64 = 0.25;
/// The fewest passes and places.
const PASSES: usize = 3;
const PLACES: usize = 8;
/// The most places along an axis.
const MOST_PLACES: usize = 64;

/// The strongest local feature, if there is any.
pub(crate) fn strongest(
    study: &Study<'_>,
    appraisal: &Appraisal,
    model: &Model,
    courses: &[Arc<Course>],
    travels: &[Travel],
) -> Option<Feature> {
    let mut best: Option<Feature> = None;
    for (scene, known) in study.scenes.iter().enumerate() {
        let angular = |channel: usize| known.channels[channel].kind.angular(study.equations);
        for (channel, observed) in known.channels.iter().enumerate() {
            // What a loop answers to strokes has the sign of their direction: only what is alike in both may be a place.
            let answers = unsteady::answers_motion(study, appraisal, model, ChannelAt { scene, channel });
            let directions: &[f64] = if answers { &[0.0] } else { &[0.0, 1.0, -1.0] };
            let alike = (0..known.channels.len()).filter(|other| angular(*other) == angular(channel));
            let loudest =
                alike.map(|other| appraisal.weights.noises[scene][other].size()).fold(0.0, f64::max);
            for (axis, travel) in travels.iter().enumerate().filter(|(_, travel)| travel.moves) {
                let position = &courses[scene].states(observed.kind).axes[axis].position;
                let moves = &courses[scene].states(observed.kind).axes[axis].direction;
                let residual = &appraisal.residuals[scene][channel];
                let outliers = appraisal.weights.outliers.of(ChannelAt { scene, channel });
                let valid = |row: usize| residual[row].is_finite() && !outliers[row];
                let passes = passes(position, moves, &known.recording.run);
                for direction in directions.iter().copied() {
                    let chosen: Vec<&Range<usize>> = passes
                        .iter()
                        .filter(|(_, d)| direction == 0.0 || *d == direction)
                        .map(|(rows, _)| rows)
                        .collect();
                    let noise = appraisal.weights.noises[scene][channel].size();
                    let profile = Profile::new(residual, position, &chosen, &valid, travel);
                    // In every pass over the same place a display is off by as much.
                    let least =
                        noise.max(BESIDE * loudest).max(rounded::beat(observed.rounding, noise) / MATERIAL);
                    let feature = profile.and_then(|profile| profile.feature(least));
                    if let Some(found) = feature
                        && best.as_ref().is_none_or(|best| found.strength > 1.2 * best.strength)
                    {
                        best = Some(Feature { scene, channel, axis, direction, ..found });
                    }
                }
            }
        }
    }
    best
}

/// Stretches of rows in one run in which the axis moves in one direction.
fn passes(position: &[f64], direction: &[f64], run: &[i64]) -> Vec<(Range<usize>, f64)> {
    let mut passes: Vec<(Range<usize>, f64)> = Vec::new();
    for row in 0..position.len() {
        match passes.last_mut() {
            Some((rows, known)) if *known == direction[row] && run[rows.start] == run[row] => {
                rows.end = row + 1
            }
            _ => passes.push((row..row + 1, direction[row])),
        }
    }
    passes
}

/// The mean residual at places along an axis, over passes.
struct Profile {
    low: f64,
    width: f64,
    means: Vec<f64>,
    /// The standard error of each mean; infinite where too few passes came by.
    errors: Vec<f64>,
}

impl Profile {
    fn new(
        residual: &[f64],
        position: &[f64],
        passes: &[&Range<usize>],
        valid: &impl Fn(usize) -> bool,
        travel: &Travel,
    ) -> Option<Self> {
        let full: Vec<&&Range<usize>> = passes
            .iter()
            .filter(|rows| covered(&position[(**rows).clone()]) > 0.5 * travel.range())
            .collect();
        let samples: usize = full.iter().map(|rows| rows.len()).sum();
        let places = places(samples / full.len().max(1));
        if full.len() < PASSES || places < PLACES {
            return None;
        }
        let width = travel.range() / crate::number(places);
        let curves: Vec<Vec<Option<f64>>> = full
            .iter()
            .map(|rows| curve(residual, position, rows, valid, travel.low, width, places))
            .collect();
        let (mut means, mut squares, mut counts) = (vec![0.0; places], 0.0, vec![0.0; places]);
        let mut freedom = 0.0;
        for place in 0..places {
            let values: Vec<f64> = curves.iter().filter_map(|curve| curve[place]).collect();
            counts[place] = crate::number(values.len());
            if values.len() >= PASSES {
                means[place] = values.iter().sum::<f64>() / counts[place];
                squares += values.iter().map(|value| (value - means[place]).powi(2)).sum::<f64>();
                freedom += counts[place] - 1.0;
            }
        }
        let scatter = (squares / f64::max(freedom, 1.0)).sqrt();
        let error = |count: &f64| {
            if *count >= crate::number(PASSES) { scatter / count.sqrt() } else { f64::INFINITY }
        };
        Some(Self { low: travel.low, width, means, errors: counts.iter().map(error).collect() })
    }

    fn center(&self, place: usize) -> f64 {
        self.low + (crate::number(place) + 0.5) * self.width
    }

    /// The highest place and what belongs to it.
    fn feature(&self, noise: f64) -> Option<Feature> {
        let strength = |place: usize| self.means[place].abs() / self.errors[place].max(f64::MIN_POSITIVE);
        let top = (0..self.means.len()).max_by(|a, b| strength(*a).total_cmp(&strength(*b)))?;
        let height = self.means[top];
        if strength(top) < SURE || height.abs() < MATERIAL * noise {
            return None;
        }
        let belongs = |place: usize| self.means[place] * height.signum() > FLANK * height.abs();
        let first = (0..=top).rev().take_while(|place| belongs(*place)).last().unwrap_or(top);
        let last = (top..self.means.len()).take_while(|place| belongs(*place)).last().unwrap_or(top);
        let squares: f64 = self.means[first..=last].iter().map(|mean| mean * mean).sum();
        Some(Feature {
            scene: 0,
            channel: 0,
            axis: 0,
            direction: 0.0,
            from: self.center(first) - 0.5 * self.width,
            to: self.center(last) + 0.5 * self.width,
            rms: (squares / crate::number(last + 1 - first)).sqrt(),
            strength: strength(top),
            profile: (0..self.means.len()).map(|place| (self.center(place), self.means[place])).collect(),
        })
    }
}

/// The number of places at which a pass is looked at: half the number of its samples, so that no place is empty. A pass with few
/// samples stops at stations, the same ones in every pass: then each sample is a place.
fn places(samples: usize) -> usize {
    if samples / 2 < PLACES { samples } else { (samples / 2).min(MOST_PLACES) }
}

fn covered(position: &[f64]) -> f64 {
    let known = position.iter().filter(|position| position.is_finite());
    let (low, high) =
        known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(*q), high.max(*q)));
    (high - low).max(0.0)
}

/// The mean residual of one pass at each place, its median taken out: a wandering sensor has no zero.
fn curve(
    residual: &[f64],
    position: &[f64],
    rows: &Range<usize>,
    valid: &impl Fn(usize) -> bool,
    low: f64,
    width: f64,
    places: usize,
) -> Vec<Option<f64>> {
    let mut sums = vec![(0.0, 0.0); places];
    for row in rows.clone().filter(|row| valid(*row)) {
        let place = crate::index((position[row] - low) / width).map(|place| place.min(places - 1));
        if let Some(sum) = place.and_then(|place| sums.get_mut(place)) {
            sum.0 += residual[row];
            sum.1 += 1.0;
        }
    }
    let means: Vec<Option<f64>> =
        sums.iter().map(|(sum, count)| (*count > 0.0).then(|| sum / count)).collect();
    let mut known: Vec<f64> = means.iter().flatten().copied().collect();
    known.sort_by(f64::total_cmp);
    let zero = known.get(known.len() / 2).copied().unwrap_or_default();
    means.into_iter().map(|mean| mean.map(|mean| mean - zero)).collect()
}
