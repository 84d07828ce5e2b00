//! Rest: do the axes move or stand while a sparse recording is read?
//!
//! In: a study. Out: for each recording with rows far apart whether its axes are at rest in every row. A laser at stations
//! reads axes at rest, a slow log moving ones, and the programmed positions alone do not tell; a calibration that knows a
//! position loop does.

use crate::course::Course;
use crate::model::Model;
use crate::observations::residuals;
use crate::study::Study;
use crate::terms::Shape;

/// The study in which it is decided by what the calibration's loops explain better. It is the last step of making one.
pub(crate) fn told(mut study: Study<'_>) -> Study<'_> {
    if !study.known.iter().any(|fitted| matches!(fitted.effect.shape, Shape::Lag { .. })) {
        return study;
    }
    for scene in 0..study.scenes.len() {
        if study.scenes[scene].sparse() && study.scenes[scene].targets.axes.is_empty() {
            let moving = misfit(&study, scene);
            study.scenes[scene].at_rest = true;
            let resting = misfit(&study, scene);
            study.scenes[scene].at_rest = resting < moving;
        }
    }
    study
}

/// The sum of distances of each channel from its median under the calibration alone.
fn misfit(study: &Study<'_>, scene: usize) -> f64 {
    let model = Model::default();
    let course = Course::new(study, scene, &model);
    let residuals = residuals(study, scene, &model, &course);
    let spread = |residual: &Vec<f64>| {
        let mut known: Vec<f64> = residual.iter().copied().filter(|value| value.is_finite()).collect();
        known.sort_by(f64::total_cmp);
        let middle = known.get(known.len() / 2).copied().unwrap_or_default();
        known.iter().map(|value| (value - middle).abs()).sum::<f64>()
    };
    residuals.iter().map(spread).sum()
}
