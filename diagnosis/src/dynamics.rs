//! Dynamics: position loops that a linear choice cannot see.
//!
//! In: a chosen model. Out: the same, or one with loops on other axes too where that is truly better. Equal lags on the axes
//! of a circle only shrink it, to second order, and act at starts; no linear regressor shows that. So loops are tried
//! outright, through the true dynamics, from several time constants, wherever the model holds something that a loop
//! could be mistaken for. So are loops that ring, and friction inside a loop, which only the right loop brings out.

use crate::candidates::geometric;
use crate::conditions::Conditions;
use crate::course;
use crate::fit::Fit;
use crate::model::{Effect, Fitted, Model, Place};
use crate::ranges::shortest_step;
use crate::side::Side;
use crate::study::Study;
use crate::terms::{Setting, Shape, oddity, plausible};
use crate::travel::Travel;

/// Tries loops on all moving axes in the place of what they could be mistaken for.
pub(crate) fn try_loops(study: &Study<'_>, model: Model, conditions: &Conditions<'_>) -> Model {
    if !may_lag(study, &model, conditions) {
        return model;
    }
    let now = conditions.refine(study, model);
    let kept = now.model.keeping(|fitted| !mistakable(&fitted.effect));
    let trials = looped(study, &kept, &now.model, conditions);
    conditions.cheapest(study, now, trials).model
}

/// Loops on all moving axes beside nothing but the settings, where something of the model could be mistaken for them. Beside what
/// was chosen in their place they may not pay: only a search that begins with them shows what they leave.
pub(crate) fn loops_alone(study: &Study<'_>, model: &Model, conditions: &Conditions<'_>) -> Option<Model> {
    if !may_lag(study, model, conditions) {
        return None;
    }
    let kept = model.settings_alone();
    let trials = looped(study, &kept, model, conditions).into_iter();
    let cheapest =
        trials.min_by(|one, other| conditions.cost(study, one).total_cmp(&conditions.cost(study, other)));
    cheapest.map(|fit| fit.model)
}

/// Whether loops are missing on moving axes, and something stands in the model that could be mistaken for them, or is larger than
/// its physics allows.
fn may_lag(study: &Study<'_>, model: &Model, conditions: &Conditions<'_>) -> bool {
    let travels = conditions.travels;
    let lacks = |axis: usize| {
        // The drive's own feedback shows its loop to the linear choice.
        let hidden = travels[axis].moves && study.own[axis].is_some() && !study.has_drive(axis);
        hidden && !model.effects.iter().any(|fitted| lag_of(&fitted.effect.shape) == Some(axis))
    };
    let suspicious = |fitted: &Fitted| {
        mistakable(&fitted.effect)
            || oddity(plausible(study, &fitted.effect), &fitted.effect.shape, &fitted.coefficients) > 0.0
    };
    (0..travels.len()).any(lacks) && model.chosen().iter().any(suspicious)
}

/// Models with loops on all moving axes beside what is kept, fitted from several time constants.
fn looped(study: &Study<'_>, kept: &Model, known: &Model, conditions: &Conditions<'_>) -> Vec<Fit> {
    let step = shortest_step(study);
    let trial = |time_constant: f64| {
        let trial = with_loops(study, kept, known, time_constant, conditions.travels);
        without_idle(study, conditions.refine(study, trial), conditions)
    };
    geometric(0.5 * step, (40.0 * step).min(0.3), 2.0).into_iter().map(trial).collect()
}

/// Tries runs that begin underway, where a loop remembers how its axis moved before. What imitates such a beginning is taken out only where
/// the beginning itself costs less: a loop may stand for nothing but a slow change in the first rows.
pub(crate) fn try_underway(study: &Study<'_>, model: Model, conditions: &Conditions<'_>) -> Model {
    if !may_begin_underway(study, &model) {
        return model;
    }
    let now = conditions.refine(study, model);
    let underway = conditions.refine(study, now.model.clone().begun_underway());
    let best = conditions.cheapest(study, now, [underway]);
    if !best.model.underway() {
        return best.model;
    }
    let bare = best.model.keeping(|fitted| !imitates_beginning(&fitted.effect));
    let bare = conditions.refine(study, bare);
    conditions.cheapest(study, best, [bare]).model
}

/// Whether an axis without feedback follows a loop and may move where a run begins, and no model says so yet.
fn may_begin_underway(study: &Study<'_>, model: &Model) -> bool {
    let loops = course::loops(study, model);
    let is_hidden = |axis: &usize| loops[*axis].acts() && !study.has_drive(*axis);
    !model.underway() && (0..loops.len()).filter(is_hidden).any(|axis| study.may_begin_underway(axis))
}

/// Whether an effect may be what a run that begins underway leaves beside a loop that begins at rest: a change in its first rows.
fn imitates_beginning(effect: &Effect) -> bool {
    imitates_ringing(effect) || matches!(effect.shape, Shape::Backlash { .. } | Shape::Step { .. })
}

/// Tries what a first-order loop, and what acts at once, cannot say: commands that bend between rows, loops that ring, and friction on the
/// drive, which the loop answers.
pub(crate) fn try_drives(study: &Study<'_>, model: Model, conditions: &Conditions<'_>) -> Model {
    let bent = bent(study, &model);
    if bent.is_none() && !model.chosen().iter().any(|fitted| lag_of(&fitted.effect.shape).is_some()) {
        return model;
    }
    let now = conditions.refine(study, model);
    let mut best = conditions.cheapest(study, now, bent.map(|trial| conditions.refine(study, trial)));
    for axis in 0..study.own.len() {
        let Some(held) = best.model.chosen().iter().find(|fitted| lag_of(&fitted.effect.shape) == Some(axis))
        else {
            continue;
        };
        let loops = loops(held, shortest_step(study));
        let trials = drives(study, &best.model, axis, &loops).into_iter();
        best = conditions.cheapest(study, best, trials.map(|trial| conditions.refine(study, trial)));
    }
    best.model
}

/// A model with commands that bend between rows in the place of the accelerations of axes behind their loops; `None` where there are none.
/// A recording may have fewer rows than the controller has cycles. If its command is taken as straight between them, an axis that
/// follows seems to be off by its acceleration times a twelfth of the step squared.
fn bent(study: &Study<'_>, model: &Model) -> Option<Model> {
    let loops = course::loops(study, model);
    let is_of_rows = |fitted: &Fitted| match fitted.effect.shape {
        Shape::Acceleration { axis } => {
            let is_own = fitted.effect.motion() == study.own[axis];
            is_own && loops[axis].acts() && is_between_rows(study, fitted.coefficients.iter().sum())
        }
        _ => false,
    };
    let found = !model.bends() && model.chosen().iter().any(is_of_rows);
    found.then(|| model.keeping(|fitted| !is_of_rows(fitted)).bending())
}

/// Whether an axis is off by its acceleration as much as straight lines between rows would make it seem.
fn is_between_rows(study: &Study<'_>, off: f64) -> bool {
    study.scenes.iter().any(|scene| (12.0 * off / scene.given.step.powi(2) - 1.0).abs() < LIKE_ROWS)
}

/// The share by which it may differ. In simulated recordings it was up to 4 % off beside what the first rounds chose. Without a limit, a
/// dead time before a loop was lost: it makes an acceleration of another size.
const LIKE_ROWS: f64 = 0.2;

/// Other models of how an axis is driven: with each of these loops, with and without what imitates its ringing, with friction
/// where it is and inside the loop; each of them once.
fn drives(study: &Study<'_>, model: &Model, axis: usize, loops: &[Shape]) -> Vec<Model> {
    let mut known = vec![model.clone()];
    for start in [model, &without_imitations(model)] {
        for inside in [start.clone(), with_friction(study, start, axis)] {
            for shape in loops {
                let trial = with_loop(inside.clone(), axis, shape);
                if !known.contains(&trial) {
                    known.push(trial);
                }
            }
        }
    }
    known.split_off(1)
}

/// Whether [`try_drives`] may find something: a first-order loop beside what would imitate its ringing, or friction beside
/// any loop.
pub(crate) fn may_answer(model: &Model) -> bool {
    let effects = || model.chosen().iter().map(|fitted| &fitted.effect);
    let friction = |effect: &Effect| {
        effect.side() == Some(Side::Drive) && matches!(effect.shape, Shape::Backlash { .. })
    };
    effects().any(|effect| lag_of(&effect.shape).is_some())
        && effects().any(|effect| imitates_ringing(effect) || friction(effect))
}

/// Dampings from which a loop of second order is tried: one that rings for long, and some that hardly do.
const DAMPINGS: [f64; 4] = [0.15, 0.3, 0.6, 1.2];

/// A loop as it stands; one of first order also with each of the dampings whose ringing the rows resolve.
fn loops(lag: &Fitted, step: f64) -> Vec<Shape> {
    let mut shapes = vec![lag.effect.shape.clone()];
    if let Shape::Lag { axis, inertia: 0.0 } = lag.effect.shape {
        let time_constant: f64 = lag.coefficients.iter().sum();
        let roots = DAMPINGS.map(|damping| 0.5 * time_constant / damping);
        // Rows resolve no ringing that is quicker than twice their step.
        let roots = roots.into_iter().filter(|root| *root > step / std::f64::consts::PI);
        shapes.extend(roots.map(|root| Shape::Lag { axis, inertia: root * root }));
    }
    shapes
}

fn with_loop(mut model: Model, axis: usize, shape: &Shape) -> Model {
    for fitted in model.effects.iter_mut().filter(|fitted| lag_of(&fitted.effect.shape) == Some(axis)) {
        fitted.effect.shape = shape.clone();
    }
    model
}

/// A model in which friction of an axis that seemed to act at once, or to build up as the loop lets it, lies inside the loop.
fn with_friction(study: &Study<'_>, model: &Model, axis: usize) -> Model {
    let mut model = model.clone();
    for fitted in model.chosen_mut() {
        if let (Place::Motion { motion, side: Side::Drive }, Shape::Backlash { axis: of, .. }) =
            (fitted.effect.place, &fitted.effect.shape)
            && *of == axis
            && study.own[axis] == Some(motion)
        {
            fitted.effect.place = Place::Motion { motion, side: Side::Loop { axis } };
            fitted.effect.shape = Shape::Backlash { axis, wind_up: 0.0 };
        }
    }
    model
}

fn without_imitations(model: &Model) -> Model {
    model.keeping(|fitted| !imitates_ringing(&fitted.effect))
}

/// Whether an effect, beside a lag of first order, may be what a loop makes that rings at every change of speed.
fn imitates_ringing(effect: &Effect) -> bool {
    let waves = matches!(effect.shape, Shape::Vibration { .. } | Shape::Drift { .. });
    waves || matches!(effect.shape, Shape::Acceleration { .. } | Shape::ReversalSpike { .. })
}

/// The axis of whose loop a shape is the lag.
fn lag_of(shape: &Shape) -> Option<usize> {
    match *shape {
        Shape::Lag { axis, .. } => Some(axis),
        _ => None,
    }
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
        let shape = Shape::Lag { axis, inertia: 0.0 };
        let lags = known.effects.iter().filter(|fitted| lag_of(&fitted.effect.shape) == Some(axis));
        let lag: f64 = lags.flat_map(|fitted| &fitted.coefficients).sum();
        let effect = Effect { place: Place::Motion { motion, side: Side::Drive }, shape };
        model.effects.push(Fitted { effect, coefficients: vec![lag + time_constant] });
    }
    model
}

/// Drops loops that came out as good as immediate.
fn without_idle(study: &Study<'_>, fit: Fit, conditions: &Conditions<'_>) -> Fit {
    let idle = |fitted: &Fitted| {
        matches!(fitted.effect.shape, Shape::Lag { .. }) && fitted.coefficients.iter().all(|lag| *lag < 1e-6)
    };
    let before = fit.model.effects.len();
    let model = fit.model.keeping(|fitted| !idle(fitted));
    if model.effects.len() < before { conditions.refine(study, model) } else { fit }
}

#[cfg(test)]
mod tests;
