//! The unsteady: what is neither noise nor a term.
//!
//! In: a fitted model and what it leaves. Out: oscillations whose strength comes and goes, which a sum of steady vibrations
//! would imitate line by line; and residuals that move smoothly, as no sensor's noise does: something of the machine that
//! is still left out, with the term that comes nearest to it.

use crate::appraisal::Appraisal;
use crate::candidates::simplicity;
use crate::channel::{ChannelAt, Kind};
use crate::design::{Design, Regressor};
use crate::engine::Found;
use crate::model::{Effect, Fitted, Model, Place};
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;

/// An oscillation of an error motion that is spread over a band of frequencies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Band {
    pub(crate) motion: usize,
    /// Hz.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// mm or rad of the motion.
    pub(crate) rms: f64,
}

impl Band {
    /// Whether an effect is a vibration of its motion in the band, or as near to it as the lines of a band are to one another.
    pub(crate) fn has(&self, effect: &Effect) -> bool {
        let (from, to) = (self.from * (1.0 - NEAR), self.to * (1.0 + NEAR));
        effect.motion() == Some(self.motion)
            && frequency(effect).is_some_and(|frequency| from < frequency && frequency < to)
    }
}

/// How many vibrations of one motion so near to one another are one that is not steady.
const LINES: usize = 3;
/// How near, as a share of the frequency.
const NEAR: f64 = 0.02;

/// Takes oscillations that are not steady out of a model.
pub(crate) fn take_bands(model: &mut Model) -> Vec<Band> {
    let mut bands = Vec::new();
    while let Some(members) = crowded(model) {
        let motion = model.effects[members[0]].effect.motion().unwrap_or_default();
        let frequencies = members.iter().filter_map(|number| frequency(&model.effects[*number].effect));
        let (from, to) =
            frequencies.fold((f64::INFINITY, 0.0), |(from, to), f| (f64::min(from, f), f64::max(to, f)));
        let squares = members.iter().flat_map(|number| &model.effects[*number].coefficients);
        let rms = (squares.map(|value| value * value).sum::<f64>() / 2.0).sqrt();
        bands.push(Band { motion, from, to, rms });
        members.iter().rev().for_each(|number| drop(model.effects.remove(*number)));
    }
    bands
}

fn frequency(effect: &Effect) -> Option<f64> {
    match effect.shape {
        Shape::Vibration { frequency } => Some(frequency),
        _ => None,
    }
}

/// Vibrations of one motion that crowd around one of them, in the order of the model.
fn crowded(model: &Model) -> Option<Vec<usize>> {
    model.chosen_numbers().find_map(|center| {
        let (motion, around) =
            (model.effects[center].effect.motion(), frequency(&model.effects[center].effect)?);
        let near = |number: &usize| {
            let effect = &model.effects[*number].effect;
            effect.motion() == motion
                && frequency(effect).is_some_and(|frequency| (frequency / around - 1.0).abs() < NEAR)
        };
        let members: Vec<usize> = model.chosen_numbers().filter(near).collect();
        (members.len() >= LINES).then(|| with_neighbours(model, members))
    })
}

/// The members of a band, and what stands as near to one of them as they to one another.
fn with_neighbours(model: &Model, mut members: Vec<usize>) -> Vec<usize> {
    let near = |a: usize, b: usize| {
        let pair = (frequency(&model.effects[a].effect), frequency(&model.effects[b].effect));
        let close = matches!(pair, (Some(a), Some(b)) if (a / b - 1.0).abs() < NEAR);
        close && model.effects[a].effect.motion() == model.effects[b].effect.motion()
    };
    while let Some(next) = model
        .chosen_numbers()
        .find(|other| !members.contains(other) && members.iter().any(|known| near(*other, *known)))
    {
        members.push(next);
    }
    members.sort_unstable();
    members
}

/// A channel that moves smoothly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moving {
    pub(crate) at: ChannelAt,
    /// mm or rad.
    pub(crate) rms: f64,
    /// The time over which it keeps its direction, s.
    pub(crate) time: f64,
}

/// From lag to lag by this factor.
const LAGS: f64 = 1.4;
/// The fewest stretches of two lags in what was observed.
const STRETCHES: f64 = 8.0;
/// Over the lag it moves by this share of its variance, at least; a shorter way is nothing.
const FAR: f64 = 0.05;
/// The variance of second differences over that of first ones: 2 for a random walk, 3 for white noise, less for what keeps
/// its direction.
const KEEPS: f64 = 0.8;

/// The channel whose residual moves smoothly; of several, the one that is largest beside its noise. `outside` tells whether instruments
/// outside the drives count, or the drives' own feedback.
pub(crate) fn moving(study: &Study<'_>, appraisal: &Appraisal, outside: bool) -> Option<Moving> {
    let counted = study.channels().filter(|at| study.channel(*at).kind.outside() == outside);
    let moving = counted.filter_map(|at| {
        let known = &study.scenes[at.scene];
        let (time, rms) = keeps_on(&known.recording.time, &accepted(appraisal, at), known.given.step)?;
        Some(Moving { at, rms, time })
    });
    largest(appraisal, moving)
}

/// The largest beside the noise of its channel: lengths and angles cannot be compared.
fn largest(appraisal: &Appraisal, moving: impl Iterator<Item = Moving>) -> Option<Moving> {
    let beside_noise =
        |moving: &Moving| moving.rms / appraisal.floors[moving.at.scene][moving.at.channel].size();
    moving.max_by(|one, other| beside_noise(one).total_cmp(&beside_noise(other)))
}

/// The channel of which more comes back than does not, although nothing in it moves smoothly: stations far apart, say. The largest of
/// them.
pub(crate) fn returning(study: &Study<'_>, appraisal: &Appraisal) -> Option<Moving> {
    let rest = study.channels().filter_map(|at| {
        let (ChannelAt { scene, channel }, residual) = (at, accepted(appraisal, at));
        let fitted = study.scenes[scene].fitted_rows();
        let counts = |row: &usize| fitted[*row] && residual[*row].is_finite();
        let count = crate::number((0..residual.len()).filter(counts).count());
        let alone = count * appraisal.leftover[scene][channel].powi(2);
        let returning = appraisal.returning[scene][channel];
        let time = study.scenes[scene].given.step;
        (returning > alone).then(|| Moving { at, rms: (returning / count).sqrt(), time })
    });
    largest(appraisal, rest)
}

/// Whether what is left of a channel is the drive's own feedback behind a loop that was found, and moves smoothly: that is the
/// loop's answer to something. Strokes that are all alike bring it back at the same places, and no place has made it.
pub(crate) fn answers_motion(study: &Study<'_>, appraisal: &Appraisal, model: &Model, at: ChannelAt) -> bool {
    let Kind::Drive(axis) = study.channel(at).kind else { return false };
    let known = &study.scenes[at.scene];
    let residual = accepted(appraisal, at);
    looped(model, axis) && keeps_on(&known.recording.time, &residual, known.given.step).is_some()
}

fn looped(model: &Model, axis: usize) -> bool {
    model
        .effects
        .iter()
        .any(|fitted| matches!(fitted.effect.shape, Shape::Lag { axis: of, .. } if of == axis))
}

/// What is left of a channel, without its outliers.
fn accepted(appraisal: &Appraisal, at: ChannelAt) -> Vec<f64> {
    let residual = appraisal.residuals[at.scene][at.channel].iter().zip(appraisal.weights.outliers.of(at));
    residual.map(|(value, outlier)| if *outlier { f64::NAN } else { *value }).collect()
}

/// The shortest time over which a residual goes far and keeps its direction, and its standard deviation.
pub(crate) fn keeps_on(time: &[f64], residual: &[f64], step: f64) -> Option<(f64, f64)> {
    let known: Vec<f64> = residual.iter().copied().filter(|value| value.is_finite()).collect();
    let count = crate::number(known.len());
    let mean = known.iter().sum::<f64>() / f64::max(count, 1.0);
    let variance = known.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / f64::max(count, 1.0);
    let mut lag = 1;
    while crate::number(2 * lag) * STRETCHES < count {
        let far = differences(time, residual, step, lag).filter(|(first, _)| *first > FAR * variance);
        if let Some((first, second)) = far {
            return (second < KEEPS * first).then(|| (crate::number(lag) * step, variance.sqrt()));
        }
        lag = crate::index(crate::number(lag) * LAGS).unwrap_or(lag).max(lag + 1);
    }
    None
}

/// The mean squares of first and second differences over a lag, gaps left out.
fn differences(time: &[f64], residual: &[f64], step: f64, lag: usize) -> Option<(f64, f64)> {
    let longest = 1.5 * step * crate::number(lag);
    let (mut first, mut second, mut count) = (0.0, 0.0, 0.0);
    for row in 0..residual.len().saturating_sub(2 * lag) {
        let [a, b, c] = [0, 1, 2].map(|number| residual[row + number * lag]);
        let whole = time[row + lag] - time[row] < longest && time[row + 2 * lag] - time[row + lag] < longest;
        if whole && a.is_finite() && b.is_finite() && c.is_finite() {
            first += ((b - a).powi(2) + (c - b).powi(2)) / 2.0;
            second += (c - 2.0 * b + a).powi(2);
            count += 1.0;
        }
    }
    (count > 0.0).then(|| (first / count, second / count))
}

/// A term that takes this share of what remains, alone, comes near to it.
const COMES_NEAR: f64 = 0.4;

/// A term that comes near to what remains.
pub(crate) struct Suspect {
    /// As least squares fits it, every sample for itself.
    pub(crate) fitted: Fitted,
    /// The share of the remaining squares that it takes.
    pub(crate) share: f64,
}

/// The plain term that would take most of what remains, were the noise white.
pub(crate) fn suspect(study: &Study<'_>, found: &Found) -> Option<Suspect> {
    let model = &found.fit.model;
    let weights = found.appraisal.weights.as_white();
    let plain = |effect: &Effect| {
        matches!(effect.place, Place::Motion { .. }) && effect.shape.columns() <= 2 && !effect.shape.is_wave()
    };
    let others: Vec<Effect> =
        found.pool.iter().map(|kin| kin.effect.clone()).filter(|effect| plain(effect)).collect();
    let mut regressors = Regressor::all(&model.effects);
    regressors.extend(others.iter().cloned().map(Regressor::of));
    let design = Design::new(study, model, &weights, regressors);
    let (products, samples) = design.fitted();
    let mut swept = Swept::new(&products);
    for column in (0..model.effects.len()).flat_map(|number| design.columns(number)) {
        swept.take(column);
    }
    let remaining = swept.remaining().max(f64::MIN_POSITIVE);
    let share = |number: usize| {
        let columns: Vec<usize> = design.columns(model.effects.len() + number).collect();
        swept.promise(&columns).0 / remaining
    };
    let worth = |number: usize| share(number) - simplicity(study, &others[number]) / samples.max(1.0);
    let best = (0..others.len()).max_by(|a, b| worth(*a).total_cmp(&worth(*b)))?;
    let share = share(best);
    let columns: Vec<usize> = design.columns(model.effects.len() + best).collect();
    for column in &columns {
        swept.take(*column);
    }
    let coefficients = columns.iter().map(|column| swept.coefficient(*column)).collect();
    let fitted = Fitted { effect: others[best].clone(), coefficients };
    (share > COMES_NEAR).then_some(Suspect { fitted, share })
}

#[cfg(test)]
mod tests;
