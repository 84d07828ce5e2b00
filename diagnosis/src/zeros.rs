//! Zeros beside effects that stay: an instrument that was set up anew has a zero of its own, and a noise that wanders draws zeros
//! away from the mean.
//!
//! In: a model that was fitted to some rows. Out: the same with the settings of recordings that are held out as a whole fitted
//! on themselves, or with all settings fitted to each row for itself; and residuals in which every run has its own zero where
//! runs do not repeat. Nothing of the machine is fitted here.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::appraisal::Appraisal;
use crate::channel::Kind;
use crate::course::Course;
use crate::design::{Design, Regressor};
use crate::fit;
use crate::model::{Fitted, Model, Place};
use crate::observations;
use crate::scene::Scene;
use crate::study::Study;
use crate::terms::{Setting, Shape};
use crate::weights::Weights;

/// Fits the settings that are always free of every recording of which no row is fitted.
pub(crate) fn free_held_out(study: &Study<'_>, model: &mut Model) {
    for (scene, known) in study.scenes.iter().enumerate() {
        if known.blocks.iter().any(|block| !block.held_out) {
            continue;
        }
        let own: Vec<usize> = (0..model.effects.len())
            .filter(|number| model.effects[*number].effect.place == Place::Instrument { recording: scene })
            .filter(|number| {
                !matches!(model.effects[*number].effect.shape, Shape::Instrument(Setting::Clock))
            })
            .collect();
        let regressors =
            own.iter().map(|number| Regressor::of(model.effects[*number].effect.clone())).collect();
        let weights = Appraisal::new(study, model).weights;
        let mut design = Design::new(study, model, &weights, regressors);
        let settings: Vec<Fitted> = own.iter().map(|number| model.effects[*number].clone()).collect();
        design.rebase(&settings);
        let (products, _) = design.sum(|block| block.scene == scene);
        for (number, fitted) in
            own.into_iter().zip(fit::linear(&design, &products, design.regressors.len(), &[]))
        {
            model.effects[number] = fitted;
        }
    }
}

/// Fits the settings that are always fitted to the rows that are fitted, each row for itself; what else the model
/// holds stays. Where noise wanders, zeros that allow for it may lie far from the mean of those rows, and farther from others.
pub(crate) fn weigh_plainly(study: &Study<'_>, model: &mut Model, weights: &Weights) {
    let settings: Vec<Fitted> = model.settings().to_vec();
    let regressors = Regressor::all(&settings);
    let mut design = Design::new(study, model, weights, regressors);
    design.rebase(&settings);
    let (products, _) = design.fitted();
    let fitted = fit::linear(&design, &products, settings.len(), &[]);
    model.effects.splice(..settings.len(), fitted);
}

/// Observed minus predicted of every channel of every recording; where runs have zeros of their own, those of held-out runs
/// are taken out too.
pub(crate) fn residuals(study: &Study<'_>, model: &Model) -> Vec<Vec<Vec<f64>>> {
    let each = study.scenes.iter().enumerate();
    each.map(|(scene, known)| {
        let course = Course::new(study, scene, model);
        let mut residuals = observations::residuals(study, scene, model, &course);
        let loose =
            model.effects.iter().any(|fitted| fitted.effect.setting_of(scene).is_some_and(Setting::of_a_run));
        if loose {
            for block in known.blocks.iter().filter(|block| block.held_out) {
                for (channel, residual) in known.channels.iter().zip(&mut residuals) {
                    let residual = &mut residual[block.rows.clone()];
                    match channel.kind {
                        Kind::Radius { center, .. } => recenter(known, &block.rows, center, residual),
                        _ => center(residual),
                    }
                }
            }
        }
        residuals
    })
    .collect()
}

/// Takes out what a ballbar's centre of its own explains.
fn recenter(known: &Scene<'_>, rows: &Range<usize>, center: [f64; 3], residual: &mut [f64]) {
    let programmed: Vec<&[f64]> =
        known.given.programmed.iter().map(|position| &position[rows.clone()]).collect();
    let nominal = known.built.interpreter.nominal_columns(&programmed);
    let leaning: Vec<usize> = (0..3).filter(|direction| known.leans[*direction]).collect();
    let spokes = DMatrix::from_fn(residual.len(), leaning.len(), |row, column| {
        let spoke = [0, 1, 2].map(|d| nominal[d][row] - center[d]);
        let length = spoke.iter().map(|part| part * part).sum::<f64>().sqrt();
        if residual[row].is_finite() { spoke[leaning[column]] / length } else { 0.0 }
    });
    let seen = DVector::from_fn(
        residual.len(),
        |row, _| if residual[row].is_finite() { residual[row] } else { 0.0 },
    );
    // Too short an arc to tell a centre from: nothing is taken out.
    if let Ok(shift) = spokes.clone().svd(true, true).solve(&seen, ARC) {
        let explained = spokes * shift;
        residual.iter_mut().zip(explained.iter()).for_each(|(left, explained)| *left -= explained);
    }
}

/// The share of the longest direction below which an arc says nothing of the other.
const ARC: f64 = 1e-6;

/// Takes the mean out.
pub(crate) fn center(values: &mut [f64]) {
    let known = values.iter().filter(|value| value.is_finite());
    let (sum, count) = known.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    values.iter_mut().for_each(|value| *value -= sum / f64::max(count, 1.0));
}

#[cfg(test)]
mod tests;
