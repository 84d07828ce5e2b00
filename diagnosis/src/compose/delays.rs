//! Delays: axes that are told late.
//!
//! In: what was found. Out: models in which an axis that follows late does so by a dead time, in the place of its loop or beside it. At
//! constant speed a loop of gain K and a delay of 1/K are the same; where the speed changes, a loop takes 1/K to follow and a delay
//! follows at once. An acceleration may stand beside a delay, as feed-forward of the wrong size. The linear search has the loop alone:
//! a delay has no column that holds for every time.

use model_dsl::calibration::Factor;

use crate::engine::Found;
use crate::model::{Effect, Fitted, Model, Place};
use crate::study::Study;
use crate::terms::Shape;

/// The share of the following error that a delay beside a loop starts with. The fit moves it from there; a half is as near to every share
/// as one start can be.
const HALF: f64 = 0.5;

/// A model in which this axis is late.
pub(super) struct Late {
    pub(super) model: Model,
    pub(super) axis: usize,
}

/// For each loop that was found: a delay in its place, and one beside it. Where nothing is left, only for those beside which something
/// else follows the motion of the axis.
pub(super) fn delays(study: &Study<'_>, found: &Found, lacks: bool) -> Vec<Late> {
    let effects = found.fit.model.chosen();
    let is_open = |(axis, _): &(usize, f64)| {
        lacks || effects.iter().any(|fitted| follows_its_motion(&fitted.effect, *axis))
    };
    let loops = effects.iter().filter_map(|fitted| behind(study, fitted)).filter(is_open);
    loops.flat_map(|(axis, time)| [1.0, HALF].map(|share| late(found, axis, time, share))).collect()
}

/// The axis of a loop, and the time by which it stays behind. A drive that leads is no later than it is told.
fn behind(study: &Study<'_>, fitted: &Fitted) -> Option<(usize, f64)> {
    let Shape::Lag { axis, .. } = fitted.effect.shape else { return None };
    let time = fitted.coefficients.iter().sum();
    (study.own[axis] == fitted.effect.motion() && time > 0.0).then_some((axis, time))
}

/// What was found, with a delay that takes this share of what a loop stays behind by. What follows the motion of the axis otherwise may
/// stand in for it, and is left out.
fn late(found: &Found, axis: usize, time: f64, share: f64) -> Late {
    let mut effects = found.fit.model.settings().to_vec();
    for fitted in found.fit.model.chosen() {
        if matches!(fitted.effect.shape, Shape::Lag { axis: of, .. } if of == axis) {
            let effect =
                Effect { place: fitted.effect.place, shape: Shape::Delay { axis, time: share * time } };
            let place = effect.place;
            effects.push(Fitted { effect, coefficients: vec![1.0] });
            if share == 1.0 {
                // Where the feed-forward comes late it may be of the wrong size too; the judge drops it where it is not.
                let effect = Effect { place, shape: Shape::Acceleration { axis } };
                effects.push(Fitted { effect, coefficients: vec![0.0] });
            } else {
                // A mass in the loop may only have stood in for the delay.
                let effect = Effect { place: fitted.effect.place, shape: Shape::Lag { axis, inertia: 0.0 } };
                effects.push(Fitted { effect, coefficients: vec![(1.0 - share) * time] });
            }
        } else if !follows_its_motion(&fitted.effect, axis) {
            effects.push(fitted.clone());
        }
    }
    Late { model: found.fit.model.with_effects(effects), axis }
}

/// Whether an effect follows the velocity or the acceleration of an axis, or what happens when it turns back.
fn follows_its_motion(effect: &Effect, axis: usize) -> bool {
    let of_its_motion = |factor: &Factor<usize>| {
        matches!(*factor, Factor::Velocity { axis: of, .. } | Factor::Speed { axis: of, .. }
            | Factor::Acceleration { axis: of, .. } if of == axis)
    };
    let turns = matches!(effect.shape, Shape::Acceleration { axis: of } | Shape::ReversalSpike { axis: of, .. }
        if of == axis);
    matches!(effect.place, Place::Motion { .. })
        && (turns || effect.shape.factors().iter().any(of_its_motion))
}
