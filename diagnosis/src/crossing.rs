//! Crossing: plays that an axis crosses after a reversal, in the place of what seems to hold it for a moment.
//!
//! In: a chosen model. Out: the same, or one in which some axes cross their plays; and how far each of them goes until it has.
//! Known plays, and those that are found, act at once, as a controller corrects them. A slide with free play stands still
//! instead until its drive has gone through it: where rows are dense against that time, what is missing meanwhile looks like
//! something that holds the slide and lets go. So wherever such a thing was chosen, the play of that axis is tried as one that
//! is crossed over its own length, which takes no parameter.

use crate::conditions::Conditions;
use crate::fit::Fit;
use crate::model::{Effect, Model, Place};
use crate::side::Side;
use crate::study::Study;
use crate::terms::Shape;

/// The most fits until a play that is fitted and the way over which it is crossed agree.
const AGREEING: usize = 6;
/// They agree within this share.
const AGREED: f64 = 0.01;

/// Tries crossed plays on every axis that something seems to hold after a reversal; `None` where none is better.
pub(crate) fn try_plays(study: &Study<'_>, model: &Model, conditions: &Conditions<'_>) -> Option<Model> {
    let held = |axis: &usize| model.chosen().iter().any(|fitted| holds(&fitted.effect, *axis));
    let held: Vec<usize> = (0..study.own.len()).filter(held).collect();
    if held.is_empty() {
        return None;
    }
    let now = conditions.refine(study, model.clone());
    let mut least = conditions.cost(study, &now);
    let mut chosen = None;
    for axis in held {
        let start = chosen.clone().unwrap_or_else(|| now.model.clone());
        for trial in without_holds(study, &start, axis) {
            let Some(fit) = crossed(study, trial, axis, conditions) else { continue };
            let cost = conditions.cost(study, &fit);
            if cost < least {
                least = cost;
                chosen = Some(fit.model);
            }
        }
    }
    chosen
}

/// Brings the ways over which a model crosses plays to those plays; none where there is no play any more. Whether that changed any.
pub(crate) fn follow(study: &Study<'_>, model: &mut Model) -> bool {
    let mut changed = false;
    for axis in model.crossing_axes() {
        let (way, play) = (model.crossing(axis), play(study, model, axis));
        if (play - way).abs() > AGREED * way {
            model.cross(axis, play);
            changed = true;
        }
    }
    changed
}

/// The axes that cross their plays and that nothing else of the model holds.
pub(crate) fn crossing_only(model: &Model) -> Vec<usize> {
    let held = |axis: usize| model.effects.iter().any(|fitted| holds(&fitted.effect, axis));
    model.crossing_axes().into_iter().filter(|axis| !held(*axis)).collect()
}

/// The model fitted with the play of an axis crossed over its own length; `None` where the axis has none.
fn crossed(study: &Study<'_>, mut model: Model, axis: usize, conditions: &Conditions<'_>) -> Option<Fit> {
    model.cross(axis, play(study, &model, axis));
    for _ in 0..AGREEING {
        if model.crossing(axis) <= 0.0 {
            return None;
        }
        let mut fit = conditions.refine(study, model);
        if !follow(study, &mut fit.model) {
            return Some(fit);
        }
        model = fit.model;
    }
    None
}

/// A model as it stands; without what seems to hold an axis; and without that and the plays of the axis which were found beside
/// it. Each of them once.
fn without_holds(study: &Study<'_>, model: &Model, axis: usize) -> Vec<Model> {
    let free = model.keeping(|fitted| !holds(&fitted.effect, axis));
    let known = free.keeping(|fitted| !is_play(study, &fitted.effect, axis));
    let mut models = vec![model.clone(), free];
    if known != models[1] {
        models.push(known);
    }
    models
}

/// Whether an effect seems to hold an axis after a reversal, for a time or over some way.
fn holds(effect: &Effect, axis: usize) -> bool {
    match effect.shape {
        Shape::ReversalSpike { axis: of, .. } => of == axis,
        Shape::Backlash { axis: of, wind_up } => of == axis && wind_up > 0.0,
        _ => false,
    }
}

/// Whether an effect is a play of the axis in its own direction, behind the drive, that acts at once.
fn is_play(study: &Study<'_>, effect: &Effect, axis: usize) -> bool {
    let own = study.own[axis].map(|motion| Place::Motion { motion, side: Side::After });
    Some(effect.place) == own && effect.shape == Shape::Backlash { axis, wind_up: 0.0 }
}

/// How wide the plays of an axis are together, known and found, mm or rad.
fn play(study: &Study<'_>, model: &Model, axis: usize) -> f64 {
    let all = study.known.iter().chain(&model.effects);
    let plays = all.filter(|fitted| is_play(study, &fitted.effect, axis));
    plays.flat_map(|fitted| &fitted.coefficients).sum::<f64>().max(0.0)
}

#[cfg(test)]
mod tests;
