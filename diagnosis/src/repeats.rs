//! Repeatability: do runs under the same state agree, as far as the noise within them lets one expect?
//!
//! In: the model found. Out: how far the zeros of the runs scatter, where free zeros make the data far more likely than any
//! noise that runs on from one run to the next; a wandering sensor does not jump between runs.

use crate::appraisal::Appraisal;
use crate::channel::{ChannelAt, Kind};
use crate::design::{Design, Regressor};
use crate::diagnosis::Repeatability;
use crate::fit;
use crate::model::{Effect, Fitted, Model};
use crate::scene::Scene;
use crate::study::Study;
use crate::terms::Setting;

/// How many times the noise the zeros of runs must scatter to be called so.
const WIDE: f64 = 1.0;
/// How often noise and zeros are estimated in turn.
const TURNS: usize = 3;

/// How far the zeros of the runs of one recording scatter.
pub(crate) struct Scatter {
    pub(crate) scene: usize,
    /// For each zero, for each run: its value against the first run's.
    pub(crate) zeros: Vec<Vec<f64>>,
    pub(crate) runs: Vec<i64>,
    channel: usize,
    /// Whether runs went to the same places. Of others an error that depends on the place may be what they differ by: they have zeros
    /// of their own in the fit, and which of both it is cannot be decided.
    pub(crate) is_told: bool,
    pub(crate) between: f64,
    pub(crate) within: f64,
}

impl Scatter {
    /// The channel in which they scatter most beside its noise.
    pub(crate) fn at(&self) -> ChannelAt {
        ChannelAt { scene: self.scene, channel: self.channel }
    }
}

/// A zero of every channel for every run but the first that is fitted; of a ballbar the centre, which a part or a ball that was
/// displaced takes along.
pub(crate) fn run_zeros(scene: usize, known: &Scene<'_>, runs: &[i64]) -> Vec<Effect> {
    let later = || runs.iter().skip(1);
    let zeros =
        zeros_of(known).flat_map(|zero| later().map(move |run| Effect::setting(scene, zero.of(*run))));
    zeros.collect()
}

/// What a run may have of its own.
#[derive(Clone, Copy)]
enum Zero {
    Offset { channel: usize },
    Center { channel: usize, direction: usize },
}

impl Zero {
    fn of(self, run: i64) -> Setting {
        match self {
            Self::Offset { channel } => Setting::RunOffset { channel, run },
            Self::Center { direction, .. } => Setting::RunEccentricity { direction, run },
        }
    }

    fn channel(self) -> usize {
        match self {
            Self::Offset { channel } | Self::Center { channel, .. } => channel,
        }
    }
}

/// The zeros of a recording's outside channels.
fn zeros_of<'k>(known: &'k Scene<'_>) -> impl Iterator<Item = Zero> + 'k {
    let channels = known.channels.iter().enumerate().filter(|(_, channel)| channel.kind.outside());
    channels.flat_map(|(number, channel)| match channel.kind {
        Kind::Radius { .. } => {
            let leaning = (0..3).filter(|direction| known.leans[*direction]);
            leaning.map(|direction| Zero::Center { channel: number, direction }).collect()
        }
        _ => vec![Zero::Offset { channel: number }],
    })
}

/// Looks for recordings whose runs do not repeat under a model. Every run tells of that, also one that is held out for the fit.
pub(crate) fn scatter(study: &Study<'_>, model: &Model) -> Vec<Scatter> {
    (0..study.scenes.len()).filter_map(|scene| of_scene(study, scene, model)).collect()
}

fn of_scene(study: &Study<'_>, scene: usize, model: &Model) -> Option<Scatter> {
    let runs = study.scenes[scene].run_numbers();
    if runs.len() < 2 {
        return None;
    }
    let zeros = run_zeros(scene, &study.scenes[scene], &runs);
    let before = Appraisal::of_all_rows(study, model, None);
    let mut weights = before.weights.clone();
    let mut free = model.clone();
    let mut after = None;
    for _ in 0..TURNS {
        let mut effects: Vec<Effect> = model.effects.iter().map(|fitted| fitted.effect.clone()).collect();
        effects.extend(zeros.iter().cloned());
        let mut design =
            Design::new(study, &free, &weights, effects.into_iter().map(Regressor::of).collect());
        design.rebase(&free.effects);
        let (products, _) = design.sum(|_| true);
        free = keep_loops(model, fit::linear(&design, &products, design.regressors.len(), &[]));
        let appraisal = Appraisal::of_all_rows(study, &free, None);
        weights = appraisal.weights.clone();
        after = Some(appraisal);
    }
    let after = after?;
    let samples: usize = study.scenes[scene].channels.iter().map(|channel| channel.values.len()).sum();
    let price = crate::number(zeros.len()) * crate::number(samples).ln() + 20.0;
    let scatter = measure(study, scene, &free, &after, runs);
    // Under the weights of either: where a model lacks something, fewer samples count.
    let gains = [
        before.deviance - Appraisal::of_all_rows(study, &free, Some(&before)).deviance,
        Appraisal::of_all_rows(study, model, Some(&after)).deviance - after.deviance,
    ];
    let significant = gains.iter().all(|gain| *gain > price);
    (significant && scatter.between > WIDE * scatter.within).then_some(scatter)
}

/// Whether a run went where the first one did.
fn at_same_places(scene: &Scene<'_>) -> bool {
    let axes = 0..scene.given.programmed.len();
    later_runs(scene).any(|run| axes.clone().all(|axis| shares_with_first(scene, run, axis)))
}

/// The axes that were elsewhere in some run than in the first one.
pub(crate) fn elsewhere(scene: &Scene<'_>) -> Vec<usize> {
    let axes = 0..scene.given.programmed.len();
    axes.filter(|axis| later_runs(scene).any(|run| !shares_with_first(scene, run, *axis))).collect()
}

fn later_runs(scene: &Scene<'_>) -> impl Iterator<Item = i64> {
    scene.run_numbers().into_iter().skip(1)
}

fn shares_with_first(scene: &Scene<'_>, run: i64, axis: usize) -> bool {
    let Some(first) = scene.run_numbers().first().copied() else { return false };
    let range = |run: i64| Range::of(&scene.given.programmed[axis], &scene.recording.run, run);
    range(run).shares(&range(first))
}

/// Where an axis was in a run, mm or rad; from infinity to minus infinity where that is not known.
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    fn of(position: &[f64], runs: &[i64], run: i64) -> Self {
        let rows = position.iter().zip(runs).filter(|(value, of)| **of == run && value.is_finite());
        let nowhere = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };
        rows.fold(nowhere, |range, (value, _)| Self {
            low: range.low.min(*value),
            high: range.high.max(*value),
        })
    }

    /// Whether most of the shorter of two ranges lies in the other; an axis that stands in one run need only be within the other.
    fn shares(&self, other: &Self) -> bool {
        let shorter = (self.high - self.low).min(other.high - other.low);
        let longer = (self.high - self.low).max(other.high - other.low);
        let common = self.high.min(other.high) - self.low.max(other.low);
        let unknown = self.low > self.high || other.low > other.high;
        unknown || common >= SHARED * shorter - SAME_PLACE * longer
    }
}

/// Most of the shorter range: beside less, what differs may lie where only one of the runs went.
const SHARED: f64 = 0.5;
/// Ends of strokes of a servo differ by less than this share of the stroke.
const SAME_PLACE: f64 = 1e-3;

/// A linear fit of loops and clocks holds only nearby: they stay as they were.
fn keep_loops(model: &Model, mut free: Vec<Fitted>) -> Model {
    for (fitted, known) in free.iter_mut().zip(&model.effects) {
        if known.effect.shape.nonlinear_in_coefficient() {
            fitted.coefficients.clone_from(&known.coefficients);
        }
    }
    model.with_effects(free)
}

fn measure(study: &Study<'_>, scene: usize, free: &Model, after: &Appraisal, runs: Vec<i64>) -> Scatter {
    let value = |zero: Zero, run: i64| free.setting(scene, zero.of(run));
    let mut zeros = Vec::new();
    let (mut between, mut within, mut channel) = (0.0_f64, 0.0_f64, 0);
    for zero in zeros_of(&study.scenes[scene]) {
        let of_runs: Vec<f64> = runs.iter().map(|run| value(zero, *run)).collect();
        let noise = after.weights.noises[scene][zero.channel()];
        let spread = deviation(&of_runs);
        let size = noise.size();
        if spread * within.max(f64::MIN_POSITIVE) >= between * size {
            (between, within, channel) = (spread, size, zero.channel());
        }
        zeros.push(of_runs);
    }
    let is_told = at_same_places(&study.scenes[scene]);
    Scatter { scene, channel, zeros, runs, is_told, between, within }
}

/// The standard deviation of a few numbers.
fn deviation(values: &[f64]) -> f64 {
    let count = crate::number(values.len());
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / (count - 1.0).max(1.0)).sqrt()
}

/// What is said of runs that do not repeat: how far, and whether order, time or a temperature explains it.
pub(crate) fn describe(study: &Study<'_>, scatter: &Scatter, unit: (f64, &'static str)) -> Repeatability {
    let scene = &study.scenes[scatter.scene];
    let mean = |values: &[f64], run: i64| {
        let of_run = values
            .iter()
            .zip(&scene.recording.run)
            .filter(|(value, known)| **known == run && value.is_finite());
        let (sum, count) = of_run.fold((0.0, 0.0), |(sum, count), (value, _)| (sum + value, count + 1.0));
        sum / f64::max(count, 1.0)
    };
    let by_run = |values: &[f64]| scatter.runs.iter().map(|run| mean(values, *run)).collect::<Vec<f64>>();
    let mut states = vec![("time".to_owned(), by_run(&scene.recording.time))];
    for (name, values) in study.sensors.iter().zip(scene.given.temperatures.iter()) {
        states.push((format!("temperature {name}"), by_run(values)));
    }
    let strongest = states
        .into_iter()
        .flat_map(|(name, state)| {
            scatter.zeros.iter().map(move |zeros| (name.clone(), correlation(zeros, &state)))
        })
        .filter(|(_, correlation)| correlation.is_finite())
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let detail = match strongest {
        Some((name, r)) if r.abs() > FOLLOWS && scatter.runs.len() > 3 => {
            format!("the zeros of the runs follow {name} (correlation {r:.2})")
        }
        Some((name, r)) => format!(
            "neither the order of the runs nor a temperature explains it (closest: {name}, correlation {r:.2})"
        ),
        None => "no recorded quantity explains it".to_owned(),
    };
    Repeatability {
        between_runs: scatter.between * unit.0,
        expected: scatter.within * unit.0,
        unit: unit.1,
        detail,
    }
}

/// The correlation from which on zeros are said to follow a state.
const FOLLOWS: f64 = 0.95;

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let count = crate::number(a.len());
    let (mean_a, mean_b) = (a.iter().sum::<f64>() / count, b.iter().sum::<f64>() / count);
    let sums = a.iter().zip(b).fold((0.0, 0.0, 0.0), |(aa, ab, bb), (a, b)| {
        let (a, b) = (a - mean_a, b - mean_b);
        (aa + a * a, ab + a * b, bb + b * b)
    });
    sums.1 / (sums.0 * sums.2).sqrt()
}

#[cfg(test)]
mod tests;
