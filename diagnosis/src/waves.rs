//! Waves: the search for periods along axes and frequencies in time.
//!
//! In: the residual of every channel under the present model, and its noise. Out: the most promising `cyclic` and
//! `vibration` effects, and waves over the turns of which a channel records the speed, with how many independent waves were
//! looked at. The residual is weighted by the inverse of its noise, sorted into fine bins of position, time or turns, and
//! Fourier transformed at once: `spectrum` tells what each wave would gain.

mod places;
mod spectrum;

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

use crate::channel::ChannelAt;
use crate::course::Course;
use crate::curves::LONG;
use crate::model::{Effect, Model, Place};
use crate::noise::{Whitening, unwhiten, whiten};
use crate::observations::{Frame, each_frame, residuals};
use crate::parallel;
use crate::ranges::{CYCLES, PERIODS, goes_round, shortest_step};
use crate::scene::Scene;
use crate::side::Side;
use crate::study::Study;
use crate::terms::Shape;
use crate::travel::Travel;
use crate::weights::Weights;
pub(crate) use places::{WavePlace, places};
use spectrum::{Rows, Top, spectrum, spectrum_by_place, tops, tops_by_place};

/// A wave that might be there.
#[derive(Clone, Debug)]
pub(crate) struct Peak {
    pub(crate) effect: Effect,
    /// What it would take from the weighted sum of squares, roughly.
    pub(crate) gain: f64,
    /// The noise around its frequency, squared, in units of that which the weights assume.
    pub(crate) noise: f64,
    /// What it would take were the noise of all frequencies that around its own.
    pub(crate) local: f64,
}

impl Peak {
    fn of(top: Top, effect: Effect) -> Self {
        Self { effect, gain: top.gain, noise: top.noise, local: top.local }
    }
}

/// The residual of one channel, weighted by the inverse of the noise, which samples count, and their mean weight.
pub(crate) struct Weighted {
    weighted: Vec<f64>,
    valid: Vec<bool>,
    weight: f64,
    /// Whether samples weigh alike because the model lacks something.
    lacks: bool,
}

/// What a channel sees of each motion, summed up for waves: gain times weighted residual.
struct Source {
    place: WavePlace,
    /// For each scene a column: gain times weighted residual, and squared gain times weight.
    products: Vec<Vec<f64>>,
    weights: Vec<Vec<f64>>,
}

impl Source {
    fn seen(&self) -> bool {
        self.weights.iter().flatten().any(|weight| *weight > 0.0)
    }

    /// The rows of each scene, at these places.
    fn rows<'s>(&'s self, places: &[&'s [f64]]) -> Vec<Rows<'s>> {
        let columns = self.products.iter().zip(&self.weights).zip(places);
        columns.map(|((weighted, weights), places)| Rows { places, weighted, weights }).collect()
    }
}

/// The weighted residuals of all channels of a scene under a model.
pub(crate) fn weighted(
    study: &Study<'_>,
    scene: usize,
    model: &Model,
    weights: &Weights,
    course: &Course,
) -> Vec<Weighted> {
    let raws = residuals(study, scene, model, course);
    raws.into_iter()
        .enumerate()
        .map(|(channel, raw)| {
            let at = ChannelAt { scene, channel };
            let valid: Vec<bool> = raw
                .iter()
                .zip(weights.outliers.of(at))
                .map(|(value, outlier)| value.is_finite() && !outlier)
                .collect();
            let steps = Whitening::new(weights.noise(at)).steps(&study.scenes[scene].recording.time, &valid);
            let mut white = raw;
            whiten(&steps, &mut [0.0], &mut white);
            let mut weighted = white.clone();
            unwhiten(&steps, &mut weighted);
            let weight = mean_weight(&white, &weighted, &valid);
            Weighted { weighted, valid, weight, lacks: weights.noise(at).alike > 1.0 }
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
    let (mut peaks, mut tried) = (Vec::new(), 0.0);
    let lacks = residuals.iter().flatten().any(|channel| channel.lacks);
    // A column for each row and place at a time is too much.
    for places in places.chunks(PLACES) {
        let sources = sources(study, model, courses, residuals, places);
        let spectra = parallel::counted(sources.len(), study.rows() * sources.len(), |number| {
            let source = &sources[number];
            [along(study, source, courses, travels, lacks), in_time(study, source, courses)]
        });
        for looked_at in spectra.into_iter().flatten().flatten() {
            tried += looked_at.tried;
            peaks.extend(looked_at.peaks);
        }
    }
    (peaks, tried)
}

/// The peaks around a wave of a model when it is taken out: within half a cycle over the range of its axis, or over the recording.
pub(crate) fn around(
    study: &Study<'_>,
    model: &Model,
    number: usize,
    weights: &Weights,
    travels: &[Travel],
) -> Vec<Peak> {
    let wave = &model.effects[number].effect;
    let without = model.without(number);
    let courses: Vec<Arc<Course>> =
        (0..study.scenes.len()).map(|scene| Course::new(study, scene, &without)).collect();
    let residuals = all_weighted(study, &without, weights, &courses);
    let place = WavePlace::of(wave);
    let (mut peaks, _) = peaks(study, &without, &courses, &residuals, travels, place.as_slice());
    let observed = observed(study);
    let near = |peak: &Peak| cycles_apart(&peak.effect.shape, &wave.shape, travels, observed);
    peaks.retain(|peak| near(peak).is_some_and(|cycles| cycles < AROUND));
    peaks
}

/// Whether two waves are one line of a spectrum: over all of it, pauses included, they differ by less than a quarter of a cycle.
pub(crate) fn same_line(study: &Study<'_>, a: &Effect, b: &Effect, travels: &[Travel]) -> bool {
    let span = longest(study, |scene| scene.given.time.last().copied().unwrap_or_default());
    cycles_apart(&a.shape, &b.shape, travels, span).is_some_and(|cycles| cycles < ONE_LINE)
}

/// How long the longest recording was observed, pauses left out, s.
pub(crate) fn observed(study: &Study<'_>) -> f64 {
    longest(study, |scene| scene.observed)
}

fn longest(study: &Study<'_>, of: impl Fn(&Scene<'_>) -> f64) -> f64 {
    study.scenes.iter().map(of).fold(0.0, f64::max)
}

/// By how many cycles two waves differ over the range of their axis, or over this time.
fn cycles_apart(a: &Shape, b: &Shape, travels: &[Travel], time: f64) -> Option<f64> {
    match (a, b) {
        (Shape::Vibration { frequency: a }, Shape::Vibration { frequency: b }) => Some((a - b).abs() * time),
        _ => match (a.wave_along()?, b.wave_along()?) {
            ((axis, a), (along, b)) if axis == along => {
                Some((1.0 / a - 1.0 / b).abs() * travels[axis].range())
            }
            _ => None,
        },
    }
}

/// Two waves are neighbours if they differ by less than this many cycles over the time observed, without pauses: half of the width of
/// a line.
const AROUND: f64 = 0.5;
/// Peaks of a spectrum lie about a cycle apart over its whole length. A wave within a quarter of a cycle is nearer to this peak than to
/// any other.
const ONE_LINE: f64 = 0.25;
/// The weighted residuals of all scenes under a model.
pub(crate) fn all_weighted(
    study: &Study<'_>,
    model: &Model,
    weights: &Weights,
    courses: &[Arc<Course>],
) -> Vec<Vec<Weighted>> {
    let each = courses.iter().enumerate();
    each.map(|(scene, course)| weighted(study, scene, model, weights, course)).collect()
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

/// Waves along the axis of a motion. Where the model lacks something, also those that stand out where all places weigh alike.
fn along(
    study: &Study<'_>,
    source: &Source,
    courses: &[Arc<Course>],
    travels: &[Travel],
    lacks: bool,
) -> Option<LookedAt> {
    let axis = study.equations.motions[source.place.motion].axis.filter(|_| source.place.cyclic)?;
    let positions: Vec<&[f64]> = courses.iter().map(|course| &*course.shown.axes[axis].position).collect();
    let (low, range) = (travels[axis].low, travels[axis].range());
    let shortest = 2.2 * travels[axis].step;
    (shortest < range / 2.0).then_some(())?;
    // Of an axis that goes round, a turn is the longest period, and it has been there.
    let longest = if goes_round(study, axis, &travels[axis]) { NEARLY / TAU } else { PERIODS / range };
    let rows = source.rows(&positions);
    let of_rows = spectrum(&rows, low, range, shortest);
    let mut found = tops(&of_rows, longest, OF_A_PLACE);
    if lacks {
        let by_place = spectrum_by_place(&rows, low, range, shortest);
        // A long wave may be part of a curve, and is not judged by the noise around it.
        let of_places = tops_by_place(&by_place, &of_rows, longest.max(1.0 / (LONG * range)), OF_A_PLACE);
        found = joined(found, of_places, AROUND / range);
    }
    let peak = |top: Top| {
        let period = turned(study, axis, &travels[axis], 1.0 / top.frequency);
        let shape = Shape::Cyclic { axis, period, order: 1, center: travels[axis].center() };
        Peak::of(top, effect(source, shape))
    };
    Some(LookedAt { peaks: found.into_iter().map(peak).collect(), tried: range / shortest })
}

/// The line of a whole turn may come out a little below it.
const NEARLY: f64 = 0.9;

/// Peaks of two spectra of the same residual. Those nearer than `near` are one; it stands out as it does where it does most.
fn joined(mut tops: Vec<Top>, others: Vec<Top>, near: f64) -> Vec<Top> {
    for other in others {
        let is_same = |top: &&mut Top| (top.frequency - other.frequency).abs() < near;
        let mut same = tops.iter_mut().filter(is_same).peekable();
        if same.peek().is_some() {
            same.for_each(|top| top.local = top.local.max(other.local));
        } else {
            tops.push(other);
        }
    }
    tops
}

/// Waves in time.
fn in_time(study: &Study<'_>, source: &Source, courses: &[Arc<Course>]) -> Option<LookedAt> {
    let times: Vec<&[f64]> = courses.iter().map(|course| &*course.shown.given.time).collect();
    let span = times.iter().filter_map(|time| time.last()).copied().fold(0.0, f64::max);
    let step = shortest_step(study);
    (source.place.vibration && span > 10.0 * step).then_some(())?;
    let observed = observed(study);
    let found = tops(&spectrum(&source.rows(&times), 0.0, span, 2.0 * step), CYCLES / observed, OF_A_PLACE);
    let peak = |top: Top| Peak::of(top, effect(source, Shape::Vibration { frequency: top.frequency }));
    // Pauses part the lines of a spectrum, and make no more of them independent: those are no more than the samples tell.
    Some(LookedAt { peaks: found.into_iter().map(peak).collect(), tried: observed / (2.0 * step) })
}

/// What something has turned since the beginning of each recording, of which a channel records the speed.
pub(crate) struct Turns {
    /// The number of the channel among the loads.
    pub(crate) load: usize,
    /// For each recording: the speed summed up over time, row by row.
    pub(crate) turned: Vec<Vec<f64>>,
    /// From one row to the next, typically.
    pub(crate) step: f64,
}

/// Waves whose frequency follows a recorded speed, and how many independent ones were looked at.
pub(crate) fn over_turns(
    study: &Study<'_>,
    (model, weights): (&Model, &Weights),
    travels: &[Travel],
    turns: &Turns,
) -> (Vec<Peak>, f64) {
    let courses: Vec<Arc<Course>> =
        (0..study.scenes.len()).map(|scene| Course::new(study, scene, model)).collect();
    let residuals = all_weighted(study, model, weights, &courses);
    let in_time = |place: &WavePlace| place.vibration;
    let places: Vec<WavePlace> =
        places(study, &courses, &weights.noises, travels).into_iter().filter(in_time).collect();
    let all = || turns.turned.iter().flatten();
    let low = all().copied().fold(f64::INFINITY, f64::min);
    let range = all().copied().fold(f64::NEG_INFINITY, f64::max) - low;
    let shortest = 2.0 * turns.step;
    // As in time: what changes in fewer cycles is a drift.
    if !(shortest > 0.0 && CYCLES * shortest < range) {
        return (Vec::new(), 0.0);
    }
    let turned: Vec<&[f64]> = turns.turned.iter().map(Vec::as_slice).collect();
    let (mut peaks, mut tried) = (Vec::new(), 0.0);
    for places in places.chunks(PLACES) {
        for source in sources(study, model, &courses, &residuals, places) {
            let found =
                tops(&spectrum(&source.rows(&turned), low, range, shortest), CYCLES / range, OF_A_PLACE);
            let peak = |top: Top| {
                let shape = Shape::spin(turns.load, top.frequency, 0.0);
                Peak::of(top, effect(&source, shape))
            };
            peaks.extend(found.into_iter().map(peak));
            tried += range / shortest;
        }
    }
    (peaks, tried)
}

/// A period along an axis; of one that goes round the nearest whole part of a turn.
fn turned(study: &Study<'_>, axis: usize, travel: &Travel, period: f64) -> f64 {
    if goes_round(study, axis, travel) { TAU / (TAU / period).round().max(1.0) } else { period }
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
    let mut sources: Vec<Source> = places
        .iter()
        .map(|place| Source { place: *place, products: Vec::new(), weights: Vec::new() })
        .collect();
    for (scene, course) in courses.iter().enumerate() {
        for source in &mut sources {
            source.products.push(Vec::with_capacity(study.scenes[scene].rows()));
            source.weights.push(Vec::with_capacity(study.scenes[scene].rows()));
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
    sources.retain(Source::seen);
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
        if source.place.side != side {
            return;
        }
        let (Some(products), Some(weights)) = (source.products.last_mut(), source.weights.last_mut()) else {
            return;
        };
        products.resize(rows.end, 0.0);
        weights.resize(rows.end, 0.0);
        for (gains, residual) in gains.iter().zip(residuals) {
            let Some(gain) = &gains[source.place.motion] else { continue };
            for (row, gain) in rows.clone().zip(gain) {
                if residual.valid[row] && gain.is_finite() {
                    products[row] += gain * residual.weighted[row];
                    weights[row] += gain * gain * residual.weight;
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
