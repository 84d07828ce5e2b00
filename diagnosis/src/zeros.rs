//! Zeros of what is held out: an instrument that was set up anew has a zero of its own.
//!
//! In: a model that was fitted to some rows. Out: the same with the settings of recordings that are held out as a whole fitted
//! on themselves; and residuals in which every run has its own zero where runs do not repeat. Nothing of the machine is fitted
//! here.

use crate::appraisal::Appraisal;
use crate::course::Course;
use crate::design::{Design, Regressor};
use crate::fit;
use crate::model::{Model, Place};
use crate::observations;
use crate::study::Study;
use crate::terms::{Setting, Shape};

/// Fits the settings that are always free of every recording of which no row is fitted.
pub(crate) fn free_held_out(study: &Study<'_>, model: &mut Model) {
    for (scene, known) in study.scenes.iter().enumerate() {
        if known.blocks.iter().any(|block| !block.held_out) {
            continue;
        }
        let own: Vec<usize> = (0..model.len())
            .filter(|number| model[*number].effect.place == Place::Instrument { recording: scene })
            .filter(|number| !matches!(model[*number].effect.shape, Shape::Instrument(Setting::Clock)))
            .collect();
        let regressors = own.iter().map(|number| Regressor::of(model[*number].effect.clone())).collect();
        let noises = Appraisal::new(study, model).noises;
        let mut design = Design::new(study, model, &noises, regressors);
        let settings: Model = own.iter().map(|number| model[*number].clone()).collect();
        design.rebase(&settings);
        let (products, _) = design.sum(|block| block.scene == scene);
        for (number, fitted) in
            own.into_iter().zip(fit::linear(&design, &products, design.regressors.len(), &[]))
        {
            model[number] = fitted;
        }
    }
}

/// Observed minus predicted of every channel of every recording; where runs have zeros of their own, those of held-out runs
/// are taken out too.
pub(crate) fn residuals(study: &Study<'_>, model: &Model) -> Vec<Vec<Vec<f64>>> {
    let each = study.scenes.iter().enumerate();
    each.map(|(scene, known)| {
        let course = Course::new(study, scene, model);
        let mut residuals = observations::residuals(study, scene, model, &course);
        let loose = model
            .iter()
            .any(|fitted| matches!(fitted.effect.setting_of(scene), Some(Setting::RunOffset { .. })));
        if loose {
            for block in known.blocks.iter().filter(|block| block.held_out) {
                residuals.iter_mut().for_each(|residual| center(&mut residual[block.rows.clone()]));
            }
        }
        residuals
    })
    .collect()
}

/// Takes the mean out.
pub(crate) fn center(values: &mut [f64]) {
    let known = values.iter().filter(|value| value.is_finite());
    let (sum, count) = known.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    values.iter_mut().for_each(|value| *value -= sum / f64::max(count, 1.0));
}
