//! Contributions. In: a fitted model. Out: how much each finding adds to the readings.

use super::Contribution;
use crate::channel::{ChannelAt, Kind};
use crate::engine::Found;
use crate::study::Study;
use crate::zeros;

/// For each of the effects with these numbers what the model leaves without it, minus what it leaves with it.
pub(super) fn draw(
    study: &Study<'_>,
    found: &Found,
    after: &[Vec<Vec<f64>>],
    (counts, factor): (&dyn Fn(Kind) -> bool, f64),
    findings: &[usize],
) -> Vec<Contribution> {
    let (model, outliers) = (&found.fit.model, &found.appraisal.weights.outliers);
    let of = |number: &usize| {
        let without = model.without(*number);
        let (mut squares, mut samples, mut max) = (0.0, 0.0, 0.0_f64);
        for (scene, residuals) in zeros::residuals(study, &without).iter().enumerate() {
            for (channel, (without, with)) in residuals.iter().zip(&after[scene]).enumerate() {
                let at = ChannelAt { scene, channel };
                if !counts(study.channel(at).kind) {
                    continue;
                }
                let outliers = outliers.of(at);
                let rows = (0..without.len()).filter(|row| !outliers[*row]);
                let mut added: Vec<f64> =
                    rows.map(|row| without[row] - with[row]).filter(|value| value.is_finite()).collect();
                zeros::center(&mut added);
                squares += added.iter().map(|value| value * value).sum::<f64>();
                samples += crate::number(added.len());
                max = added.iter().fold(max, |max, value| max.max(value.abs()));
            }
        }
        Contribution { rms: (squares / f64::max(samples, 1.0)).sqrt() * factor, max: max * factor }
    };
    findings.iter().filter(|number| **number < model.effects.len()).map(of).collect()
}
