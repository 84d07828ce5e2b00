//! Sizes: how large residuals and noise are, in the unit that a diagnosis speaks in.
//!
//! In: models and what they leave. Out: root mean squares over the channels that an instrument outside the drives reads,
//! or over the drives' own where there is no other.

use crate::appraisal::Appraisal;
use crate::channel::{ChannelAt, Kind};
use crate::diagnosis::{NoiseSummary, Residual};
use crate::model::Model;
use crate::noise::Noise;
use crate::parameters::axis_unit;
use crate::study::Study;
use crate::weights::Outliers;
use crate::zeros;

/// The unit in which residuals are told, and which channels count.
pub(super) struct Units {
    pub(super) unit: (f64, &'static str),
    pub(super) outside: bool,
    angular: bool,
}

impl Units {
    pub(super) fn new(study: &Study<'_>) -> Self {
        let kinds = || study.scenes.iter().flat_map(|scene| &scene.channels).map(|channel| channel.kind);
        let outside = kinds().any(Kind::outside);
        let first = kinds().find(|kind| kind.outside() == outside);
        let angular = first.is_some_and(|kind| kind.angular(study.equations));
        let unit = match first {
            Some(Kind::Stage(axis) | Kind::Drive(axis)) => axis_unit(study, axis),
            _ if angular => (1.0, "rad"),
            _ => (1.0, "mm"),
        };
        Self { unit, outside, angular }
    }

    pub(super) fn counts(&self, study: &Study<'_>, kind: Kind) -> bool {
        kind.outside() == self.outside && kind.angular(study.equations) == self.angular
    }

    /// The size of what a model leaves.
    pub(super) fn residual(&self, study: &Study<'_>, model: &Model, outliers: &Outliers) -> Residual {
        size(study, (model, outliers), self.unit, |kind| self.counts(study, kind))
    }

    /// The size of what a model leaves of the drive's own feedback of an axis.
    pub(super) fn at_drive(
        &self,
        study: &Study<'_>,
        model: &Model,
        outliers: &Outliers,
        axis: usize,
    ) -> Residual {
        size(study, (model, outliers), axis_unit(study, axis), |kind| kind == Kind::Drive(axis))
    }

    /// The residuals of all counted channels on the held-out rows (on all rows where none are), the mean of each channel
    /// taken out.
    pub(super) fn held_out(&self, study: &Study<'_>, model: &Model, outliers: &Outliers) -> Vec<f64> {
        let any = study.scenes.iter().any(|scene| scene.blocks.iter().any(|block| block.held_out));
        let mut values = Vec::new();
        for (scene, residuals) in zeros::residuals(study, model).into_iter().enumerate() {
            let fitted = study.scenes[scene].fitted_rows();
            for (channel, residual) in residuals.into_iter().enumerate() {
                let at = ChannelAt { scene, channel };
                if self.counts(study, study.channel(at).kind) {
                    let outliers = outliers.of(at);
                    let chosen = (0..residual.len()).filter(|row| {
                        residual[*row].is_finite() && !outliers[*row] && !(any && fitted[*row])
                    });
                    let mut of_channel: Vec<f64> = chosen.map(|row| residual[row]).collect();
                    zeros::center(&mut of_channel);
                    values.extend(of_channel);
                }
            }
        }
        values
    }

    pub(super) fn noise(&self, study: &Study<'_>, appraisal: &Appraisal) -> NoiseSummary {
        let channels = study.channels().filter(|at| self.counts(study, study.channel(*at).kind));
        let counted: Vec<Noise> = channels.map(|at| seen(study, appraisal, at)).collect();
        let count = crate::number(counted.len()).max(1.0);
        let mean = |part: &dyn Fn(&Noise) -> f64| {
            (counted.iter().map(|noise| part(noise) * part(noise)).sum::<f64>() / count).sqrt() * self.unit.0
        };
        let (white, wander) = (mean(&|noise| noise.white), mean(&|noise| noise.wander));
        let wandering = counted.iter().filter(|noise| noise.wander > 0.0);
        let time_constant = wandering.map(|noise| noise.time_constant).fold(0.0, f64::max);
        NoiseSummary { value: white.hypot(wander), unit: self.unit.1, white, wander, time_constant }
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

/// The size of what a model leaves of the channels that count, in a unit; outliers are left out.
fn size(
    study: &Study<'_>,
    (model, outliers): (&Model, &Outliers),
    (factor, unit): (f64, &'static str),
    counts: impl Fn(Kind) -> bool,
) -> Residual {
    let (mut all, mut held) = ((0.0, 0.0), (0.0, 0.0));
    for (scene, residuals) in zeros::residuals(study, model).into_iter().enumerate() {
        let fitted = study.scenes[scene].fitted_rows();
        for (channel, residual) in residuals.into_iter().enumerate() {
            let at = ChannelAt { scene, channel };
            if !counts(study.channel(at).kind) {
                continue;
            }
            for ((value, outlier), fits) in residual.iter().zip(outliers.of(at)).zip(&fitted) {
                if value.is_finite() && !outlier {
                    all = (all.0 + value * value, all.1 + 1.0);
                    if !fits {
                        held = (held.0 + value * value, held.1 + 1.0);
                    }
                }
            }
        }
    }
    let rms = |(squares, count): (f64, f64)| (squares / f64::max(count, 1.0)).sqrt() * factor;
    Residual { rms: rms(all), holdout_rms: (held.1 > 0.0).then(|| rms(held)), unit }
}
