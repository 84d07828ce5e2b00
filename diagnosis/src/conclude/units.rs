//! Sizes: how large residuals and noise are, in the unit that a diagnosis speaks in.
//!
//! In: models and what they leave. Out: root mean squares over the channels that an instrument outside the drives reads,
//! or over the drives' own where there is no other. Lengths and angles are never summed: where both are read, each has sizes of its own.

use crate::appraisal::Appraisal;
use crate::channel::{ChannelAt, Kind};
use crate::diagnosis::{NoiseSummary, Residual};
use crate::model::Model;
use crate::noise::Noise;
use crate::parameters::axis_unit;
use crate::study::Study;
use crate::weights::Outliers;
use crate::zeros;

/// Which channels count, and in which units they are told.
pub(super) struct Units {
    /// Lengths, angles or both. The diagnosis as a whole is told in the first.
    measures: Vec<Measure>,
    pub(super) outside: bool,
}

/// Lengths or angles, and the unit in which they are told.
#[derive(Clone, Copy)]
struct Measure {
    angular: bool,
    unit: (f64, &'static str),
}

/// What a model leaves of one measure: the sum of the squares and the number of the readings, mm² or rad².
#[derive(Clone, Copy, Default)]
pub(super) struct Left {
    all: Squares,
    held_out: Squares,
}

#[derive(Clone, Copy, Default)]
struct Squares {
    sum: f64,
    count: f64,
}

impl Squares {
    fn add(&mut self, value: f64) {
        self.sum += value * value;
        self.count += 1.0;
    }

    fn rms(self) -> f64 {
        (self.sum / f64::max(self.count, 1.0)).sqrt()
    }
}

impl Left {
    fn told(self, (factor, unit): (f64, &'static str)) -> Residual {
        let holdout_rms = (self.held_out.count > 0.0).then(|| self.held_out.rms() * factor);
        Residual { rms: self.all.rms() * factor, holdout_rms, unit }
    }

    /// The size on held-out readings, or on all readings where none are held out.
    fn size(self) -> f64 {
        if self.held_out.count > 0.0 { self.held_out.rms() } else { self.all.rms() }
    }
}

/// Whether held-out readings lie farther from one model than from another, in all measures together: each counts by the logarithm
/// of the ratio of its sizes, once for every reading.
pub(super) fn lies_farther(from: &[Left], than_from: &[Left]) -> bool {
    let farther = |(from, than_from): (&Left, &Left)| {
        let (from, than_from) = (from.held_out, than_from.held_out);
        if from.sum == than_from.sum { 0.0 } else { from.count * (from.rms() / than_from.rms()).ln() }
    };
    from.iter().zip(than_from).map(farther).sum::<f64>() > 0.0
}

impl Units {
    pub(super) fn new(study: &Study<'_>) -> Self {
        let kinds = || study.scenes.iter().flat_map(|scene| &scene.channels).map(|channel| channel.kind);
        let outside = kinds().any(Kind::outside);
        let mut measures: Vec<Measure> = Vec::new();
        for kind in kinds().filter(|kind| kind.outside() == outside) {
            let angular = kind.angular(study.equations);
            if measures.iter().all(|measure| measure.angular != angular) {
                measures.push(Measure { angular, unit: unit_of(study, kind) });
            }
        }
        if measures.is_empty() {
            measures.push(Measure { angular: false, unit: (1.0, "mm") });
        }
        Self { measures, outside }
    }

    /// The same, told in the measure whose held-out readings one model brings nearest in proportion to another, `before`.
    pub(super) fn told_where_nearest(mut self, before: &[Left], after: &[Left]) -> Self {
        let ratio = |number: &usize| after[*number].size() / before[*number].size();
        let nearest = (0..self.measures.len()).min_by(|one, other| ratio(one).total_cmp(&ratio(other)));
        self.measures.swap(0, nearest.unwrap_or_default());
        self
    }

    /// The factor from mm or rad to the unit of the diagnosis, and its name.
    pub(super) fn unit(&self) -> (f64, &'static str) {
        self.measures[0].unit
    }

    /// What a model leaves of the measure in which the diagnosis is told, in its unit.
    pub(super) fn told(&self, left: &[Left]) -> Residual {
        left[0].told(self.unit())
    }

    /// Whether a channel is of the measure in which the diagnosis is told.
    pub(super) fn counts(&self, study: &Study<'_>, kind: Kind) -> bool {
        self.is_of(study, &self.measures[0], kind)
    }

    fn is_of(&self, study: &Study<'_>, measure: &Measure, kind: Kind) -> bool {
        kind.outside() == self.outside && kind.angular(study.equations) == measure.angular
    }

    /// What a model leaves of each measure.
    pub(super) fn left(&self, study: &Study<'_>, model: &Model, outliers: &Outliers) -> Vec<Left> {
        let of = |measure: &Measure| left(study, (model, outliers), |kind| self.is_of(study, measure, kind));
        self.measures.iter().map(of).collect()
    }

    /// The size of what a model leaves.
    pub(super) fn residual(&self, study: &Study<'_>, model: &Model, outliers: &Outliers) -> Residual {
        self.told(&self.left(study, model, outliers))
    }

    /// The sizes of what two models leave, in the measure in which they differ most in proportion.
    pub(super) fn most_apart(&self, one: &[Left], other: &[Left]) -> [Residual; 2] {
        let apart = |number: &usize| (one[*number].size() / other[*number].size()).ln().abs();
        // Of equals the first: `max_by` takes the last.
        let most = (0..one.len()).rev().max_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or_default();
        [one, other].map(|left| left[most].told(self.measures[most].unit))
    }

    /// The size of what a model leaves of the drive's own feedback of an axis.
    pub(super) fn at_drive(
        &self,
        study: &Study<'_>,
        model: &Model,
        outliers: &Outliers,
        axis: usize,
    ) -> Residual {
        left(study, (model, outliers), |kind| kind == Kind::Drive(axis)).told(axis_unit(study, axis))
    }

    /// The residuals of all channels of all measures on the held-out rows (on all rows where none are), the mean of each channel
    /// taken out, each as a multiple of the size that `left` gives its measure.
    pub(super) fn held_out(
        &self,
        study: &Study<'_>,
        model: &Model,
        outliers: &Outliers,
        left: &[Left],
    ) -> Vec<f64> {
        let any = study.scenes.iter().any(|scene| scene.blocks.iter().any(|block| block.held_out));
        let mut values = Vec::new();
        for (scene, residuals) in zeros::residuals(study, model).into_iter().enumerate() {
            let fitted = study.scenes[scene].fitted_rows();
            for (channel, residual) in residuals.into_iter().enumerate() {
                let at = ChannelAt { scene, channel };
                let kind = study.channel(at).kind;
                let measure = self.measures.iter().position(|measure| self.is_of(study, measure, kind));
                let Some(measure) = measure else { continue };
                let size = left[measure].size().max(f64::MIN_POSITIVE);
                let outliers = outliers.of(at);
                let chosen = (0..residual.len())
                    .filter(|row| residual[*row].is_finite() && !outliers[*row] && !(any && fitted[*row]));
                let mut of_channel: Vec<f64> = chosen.map(|row| residual[row] / size).collect();
                zeros::center(&mut of_channel);
                values.extend(of_channel);
            }
        }
        values
    }

    pub(super) fn noise(&self, study: &Study<'_>, appraisal: &Appraisal) -> NoiseSummary {
        let channels = study.channels().filter(|at| self.counts(study, study.channel(*at).kind));
        let counted: Vec<Noise> = channels.map(|at| seen(study, appraisal, at)).collect();
        let count = crate::number(counted.len()).max(1.0);
        let mean = |part: &dyn Fn(&Noise) -> f64| {
            (counted.iter().map(|noise| part(noise) * part(noise)).sum::<f64>() / count).sqrt()
                * self.unit().0
        };
        let (white, wander) = (mean(&|noise| noise.white), mean(&|noise| noise.wander));
        let wandering = counted.iter().filter(|noise| noise.wander > 0.0);
        let time_constant = wandering.map(|noise| noise.time_constant).fold(0.0, f64::max);
        NoiseSummary { value: white.hypot(wander), unit: self.unit().1, white, wander, time_constant }
    }
}

/// The noise of a channel, no larger than the residual that was observed. A noise that wanders for longer than the recording lasts shows
/// only part of its size, and the rows that are held out may be quieter than the others.
fn seen(study: &Study<'_>, appraisal: &Appraisal, at: ChannelAt) -> Noise {
    let (floor, left) = (appraisal.floors[at.scene][at.channel], appraisal.leftover[at.scene][at.channel]);
    let residual = appraisal.residuals[at.scene][at.channel].iter().zip(appraisal.weights.outliers.of(at));
    let counted = residual.filter(|(value, outlier)| value.is_finite() && !**outlier);
    let mut everywhere: Vec<f64> = counted.map(|(value, _)| *value).collect();
    zeros::center(&mut everywhere);
    let squares: f64 = everywhere.iter().map(|value| value * value).sum();
    let in_all_rows = (squares / crate::number(everywhere.len()).max(1.0)).sqrt();
    let size = left.min(in_all_rows).max(study.channel(at).rounding);
    let white = floor.white.min(size);
    let wander = floor.wander.min((size * size - white * white).max(0.0).sqrt());
    Noise { white, wander, ..floor }
}

/// What a model leaves of the channels that count; outliers are left out.
fn left(study: &Study<'_>, (model, outliers): (&Model, &Outliers), counts: impl Fn(Kind) -> bool) -> Left {
    let mut left = Left::default();
    for (scene, residuals) in zeros::residuals(study, model).into_iter().enumerate() {
        let fitted = study.scenes[scene].fitted_rows();
        for (channel, residual) in residuals.into_iter().enumerate() {
            let at = ChannelAt { scene, channel };
            if !counts(study.channel(at).kind) {
                continue;
            }
            for ((value, outlier), fits) in residual.iter().zip(outliers.of(at)).zip(&fitted) {
                if value.is_finite() && !outlier {
                    left.all.add(*value);
                    if !fits {
                        left.held_out.add(*value);
                    }
                }
            }
        }
    }
    left
}

/// The factor from mm or rad to the unit in which a channel is told, and its name.
pub(super) fn unit_at(study: &Study<'_>, at: ChannelAt) -> (f64, &'static str) {
    unit_of(study, study.channel(at).kind)
}

fn unit_of(study: &Study<'_>, kind: Kind) -> (f64, &'static str) {
    match kind {
        Kind::Stage(axis) | Kind::Drive(axis) => axis_unit(study, axis),
        _ if kind.angular(study.equations) => (1.0, "rad"),
        _ => (1.0, "mm"),
    }
}
