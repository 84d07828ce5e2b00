//! Dynamics: position loops that a linear choice cannot see.
//!
//! In: a chosen model. Out: the same, or one with loops on other axes too where that is truly better. Equal lags on the axes
//! of a circle only shrink it, to second order, and act at starts; no linear regressor shows that. So loops are tried
//! outright, through the true dynamics, from several time constants, wherever the model holds something that a loop
//! could be mistaken for.

use crate::candidates::geometric;
use crate::curves::cost;
use crate::fit::{self, Fit};
use crate::judge::Tries;
use crate::model::{Effect, Fitted, Model, Place, Side};
use crate::noise::Noise;
use crate::ranges::shortest_step;
use crate::study::Study;
use crate::terms::{Setting, Shape};
use crate::travel::Travel;

/// Tries loops on all moving axes in the place of what they could be mistaken for.
pub(crate) fn try_loops(
    study: &Study<'_>,
    model: Model,
    always: usize,
    noises: &[Vec<Noise>],
    travels: &[Travel],
    tries: Tries,
) -> Model {
    let lacking: Vec<usize> = (0..travels.len())
        .filter(|axis| travels[*axis].moves && study.own[*axis].is_some())
        // The drive's own feedback shows its loop to the linear choice.
        .filter(|axis| !study.has_drive(*axis))
        .filter(|axis| !model.iter().any(|fitted| fitted.effect.shape == Shape::Lag { axis: *axis }))
        .collect();
    let suspicious = model[always..].iter().any(|fitted| mistakable(&fitted.effect));
    if lacking.is_empty() || !suspicious {
        return model;
    }
    let now = fit::refine(study, model, noises, travels);
    let mut best = cost(study, &now, always, tries);
    let mut chosen = now.model.clone();
    let kept: Model = now
        .model
        .iter()
        .enumerate()
        .filter(|(number, fitted)| *number < always || !mistakable(&fitted.effect))
        .map(|(_, fitted)| fitted.clone())
        .collect();
    let step = shortest_step(study);
    for time_constant in geometric(0.5 * step, (40.0 * step).min(0.3), 2.0) {
        let trial = with_loops(study, &kept, &now.model, time_constant, travels);
        let fit = fit::refine(study, trial, noises, travels);
        let fit = without_idle(study, fit, always, noises, travels);
        let cost = cost(study, &fit, always, tries);
        if cost < best {
            best = cost;
            chosen = fit.model;
        }
    }
    chosen
}

/// Whether a loop could be mistaken for this effect.
fn mistakable(effect: &Effect) -> bool {
    matches!(
        effect.shape,
        Shape::Lag { .. }
            | Shape::ReversalSpike { .. }
            | Shape::Acceleration { .. }
            | Shape::Instrument(Setting::Clock)
    )
}

/// A model with loops on all moving axes; the differences of lags that are known already stay.
fn with_loops(
    study: &Study<'_>,
    kept: &Model,
    known: &Model,
    time_constant: f64,
    travels: &[Travel],
) -> Model {
    let mut model = kept.clone();
    for (axis, own) in study.own.iter().enumerate() {
        let Some(motion) = own.filter(|_| travels[axis].moves) else { continue };
        let shape = Shape::Lag { axis };
        let lag: f64 = known
            .iter()
            .filter(|fitted| fitted.effect.shape == shape)
            .flat_map(|fitted| &fitted.coefficients)
            .sum();
        let effect = Effect { place: Place::Motion { motion, side: Side::Drive }, shape };
        model.push(Fitted { effect, coefficients: vec![lag + time_constant] });
    }
    model
}

/// Drops loops that came out as good as immediate.
fn without_idle(
    study: &Study<'_>,
    fit: Fit,
    always: usize,
    noises: &[Vec<Noise>],
    travels: &[Travel],
) -> Fit {
    let idle = |number: usize, fitted: &Fitted| {
        number >= always
            && matches!(fitted.effect.shape, Shape::Lag { .. })
            && fitted.coefficients.iter().all(|lag| *lag < 1e-6)
    };
    let before = fit.model.len();
    let model: Model = fit
        .model
        .iter()
        .enumerate()
        .filter(|(number, fitted)| !idle(*number, fitted))
        .map(|(_, f)| f.clone())
        .collect();
    if model.len() < before { fit::refine(study, model, noises, travels) } else { fit }
}
