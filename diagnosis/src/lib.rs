//! Diagnosis: what a calibration left out, found from recordings of the real machine.
//!
//! In: the equations of a machine, what its calibration knows, and recordings. Out: a [`report`](crate) of what the model
//! lacks: located, named, fitted, tested on held-out data, and written as terms that the compiler takes.

mod appraisal;
mod candidates;
mod design;
pub mod diagnosis;
mod dynamics;
mod engine;
mod fit;
mod judge;
mod kinship;
mod model;
mod noise;
mod observations;
mod outliers;
pub mod recording;
mod search;
mod states;
mod study;
mod sweep;
mod terms;
mod waves;

use model_dsl::calibration::Calibration;
use model_dsl::equations::Equations;

use recording::Recording;

/// For now: prints what the engine finds.
pub fn probe(equations: &Equations, calibration: Option<&Calibration>, recordings: &[&Recording]) -> String {
    let mut study = study::Study::new(equations, calibration, recordings);
    let found = { let always = candidates::always(&study); engine::find(&mut study, always, &mut |_| {}) };
    let mut text = String::new();
    for (fitted, covariance) in found.fit.model.iter().zip(&found.fit.covariances) {
        let motion = fitted.effect.motion().map(|motion| equations.motions[motion].name.as_str()).unwrap_or("-");
        text += &format!("{motion} {:?} {:?} {:?} ±{:?}\n", fitted.effect.side(), fitted.effect.shape, fitted.coefficients,
            (0..covariance.nrows()).map(|k| 2.0 * covariance[(k, k)].sqrt()).collect::<Vec<_>>());
    }
    for noise in found.appraisal.noises.iter().flatten() {
        text += &format!("{noise:?}\n");
    }
    text += &format!("rss/n {} pool {} always {} waves {}\n", found.fit.remaining / found.fit.samples, found.pool.len(), found.always, found.tries.waves);
    text
}

/// A count as a number.
#[expect(clippy::cast_precision_loss, reason = "counts of rows and candidates are far below 2^52")]
fn number(count: usize) -> f64 {
    count as f64
}

/// The whole part of a number that is not negative, as an index.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked to be small and not negative")]
fn index(value: f64) -> Option<usize> {
    (value >= 0.0 && value < 1e12).then_some(value as usize)
}
