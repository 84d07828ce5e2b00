//! Crossing: plays that do not act at once after a reversal, in the place of what seems to hold an axis for a moment.
//!
//! In: a chosen model. Out: the same, or one in which the plays of some axes act otherwise.
//! Known plays, and those that are found, act at once, as a controller corrects them. A slide with free play stands still
//! instead until its drive has gone through it; and one that sticks and lets go, or whose controller waits until it takes a reversal
//! for one, jumps when it has gone some way back. Where rows are dense against that time, what is missing meanwhile looks like
//! something that holds the slide and lets go. So wherever such a thing was chosen, the play of that axis is tried as one that is
//! crossed over its own length, which takes no parameter, and as one that comes all at once after a way back, which takes one.

use crate::channel::ChannelAt;
use crate::conditions::Conditions;
use crate::fit::Fit;
use crate::model::{Effect, Fitted, Model, Place};
use crate::search::parameter_price;
use crate::side::Side;
use crate::states::Crossing;
use crate::study::Study;
use crate::terms::Shape;
use crate::zeros;

/// The most fits until a play that is fitted and the way over which it is crossed agree.
const AGREEING: usize = 6;
/// They agree within this share.
const AGREED: f64 = 0.01;

/// The ways back after which a jump is looked for, as shares of the travel: from the step of a fine scale to a fiftieth of the travel,
/// which is more than any contact yields before it slides or rolls.
const WAYS: (f64, f64) = (1e-5, 0.02);
/// How many of them are tried at first: each is 1.8 times the one before, so that the best of them lies next to the right one.
const TRIED: i32 = 14;
/// How often the stretch between its neighbours is then divided by the golden section: 2 ln 1.8 times 0.618^10 is a hundredth of the way.
const DIVISIONS: usize = 10;

/// What a way after which something jumps must say beyond a build-up, which the calibration can hold: twice the logarithm of the odds
/// from which on Kass and Raftery call evidence very strong (Journal of the American Statistical Association 90, 1995). Samples that
/// weigh alike because the model lacks something are few, and tell the two apart by less.
const VERY_STRONG: f64 = 10.0;

/// Tries plays that do not act at once on every axis that something seems to hold after a reversal; `None` where none is better.
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
        let free = without_holds(study, &start, axis);
        let over = free.into_iter().filter_map(|trial| crossed(study, trial, axis, conditions));
        let jumping = in_jumps(study, &start, axis);
        let after = jumping.into_iter().filter_map(|trial| late(study, trial, axis, conditions));
        for fit in over.chain(after) {
            let cost = conditions.cost(study, &fit);
            if cost < least {
                least = cost;
                chosen = Some(fit.model);
            }
        }
    }
    chosen
}

/// Brings the ways over which a model crosses plays to those plays; at once where there is no play any more. Whether that changed any.
pub(crate) fn follow(study: &Study<'_>, model: &mut Model) -> bool {
    let mut changed = false;
    for axis in model.crossing_axes() {
        let followed = match model.crossing(axis) {
            Crossing::Over(way) => {
                let play = play(study, model, axis);
                if (play - way).abs() > AGREED * way { Crossing::over(play) } else { Crossing::Over(way) }
            }
            Crossing::After(way) if jumps(study, model, axis) => Crossing::After(way),
            Crossing::After(_) | Crossing::AtOnce => Crossing::AtOnce,
        };
        changed |= followed != model.crossing(axis);
        model.cross(axis, followed);
    }
    changed
}

/// The price of those ways of a model that are parameters: what each must take from the cost.
pub(crate) fn price(model: &Model, samples: f64) -> f64 {
    let is_late = |axis: &usize| matches!(model.crossing(*axis), Crossing::After(_));
    let late = model.crossing_axes().into_iter().filter(is_late).count();
    crate::number(late) * (parameter_price(samples) + VERY_STRONG)
}

/// The axes whose plays do not act at once and that nothing else of the model holds.
pub(crate) fn crossing_only(model: &Model) -> Vec<usize> {
    let held = |axis: usize| model.effects.iter().any(|fitted| holds(&fitted.effect, axis));
    model.crossing_axes().into_iter().filter(|axis| !held(*axis)).collect()
}

/// The model fitted with the play of an axis crossed over its own length; `None` where the axis has none.
fn crossed(study: &Study<'_>, mut model: Model, axis: usize, conditions: &Conditions<'_>) -> Option<Fit> {
    model.cross(axis, Crossing::over(play(study, &model, axis)));
    for _ in 0..AGREEING {
        if model.crossing(axis) == Crossing::AtOnce {
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

/// The model fitted with the jumps of an axis that come after the way back that leaves least; `None` where nothing jumps, or where it
/// does at once.
fn late(study: &Study<'_>, model: Model, axis: usize, conditions: &Conditions<'_>) -> Option<Fit> {
    if !jumps(study, &model, axis) {
        return None;
    }
    let mut model = conditions.refine(study, model).model;
    let travel = conditions.travels[axis].range();
    let (least, most) = (travel * WAYS.0, travel * WAYS.1);
    let factor = (most / least).powf(1.0 / f64::from(TRIED - 1));
    let rest = |model: &Model, way: f64| left(study, &after(model, axis, way), conditions);
    let ways = (0..TRIED).map(|number| least * factor.powi(number));
    let tried = ways.map(|way| (rest(&model, way), way));
    let (_, best) = tried.min_by(|one, other| one.0.total_cmp(&other.0)).filter(|(_, way)| *way > least)?;
    model = conditions.refine(study, after(&model, axis, best)).model;
    let way = golden_section((best / factor).ln(), (best * factor).ln(), |way| rest(&model, way.exp())).exp();
    Some(conditions.refine(study, after(&model, axis, way)))
}

/// A model in which the jumps of an axis come after this way back.
fn after(model: &Model, axis: usize, way: f64) -> Model {
    let mut late = model.clone();
    late.cross(axis, Crossing::After(way));
    late
}

/// Where a function of one valley is least, by the golden section.
fn golden_section(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
    let share = (5.0_f64.sqrt() - 1.0) / 2.0;
    let inner = |low: f64, high: f64| [high - share * (high - low), low + share * (high - low)];
    let mut tried = inner(low, high).map(|place| (place, value(place)));
    for _ in 0..DIVISIONS {
        if tried[0].1 <= tried[1].1 {
            high = tried[1].0;
            let place = inner(low, high)[0];
            tried = [(place, value(place)), tried[0]];
        } else {
            low = tried[0].0;
            let place = inner(low, high)[1];
            tried = [tried[1], (place, value(place))];
        }
    }
    0.5 * (low + high)
}

/// The sum of squares that a model leaves of the rows that are fitted, in units of the noise.
fn left(study: &Study<'_>, model: &Model, conditions: &Conditions<'_>) -> f64 {
    let residuals = zeros::residuals(study, model);
    let of_channel = |at: ChannelAt| {
        let (residual, outliers) = (&residuals[at.scene][at.channel], conditions.weights.outliers.of(at));
        let fitted = study.scenes[at.scene].fitted_rows();
        let counts = |row: &usize| fitted[*row] && !outliers[*row] && residual[*row].is_finite();
        let squares: f64 = (0..residual.len()).filter(counts).map(|row| residual[row].powi(2)).sum();
        squares / conditions.weights.noise(at).size().powi(2)
    };
    study.channels().map(of_channel).sum()
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

/// A model without the spikes after reversals of an axis: one in which what builds up after them jumps instead, and one in which
/// something jumps besides.
fn in_jumps(study: &Study<'_>, model: &Model, axis: usize) -> Vec<Model> {
    let free = model.keeping(|fitted| !is_spike(&fitted.effect, axis));
    let built_up = |fitted: &&Fitted| holds(&fitted.effect, axis);
    let Some(built_up) = free.chosen().iter().find(built_up).cloned() else { return vec![free] };
    let jump = Effect { shape: Shape::Backlash { axis, wind_up: 0.0 }, ..built_up.effect };
    let jump = Fitted { effect: jump, coefficients: built_up.coefficients };
    let without = free.keeping(|fitted| !holds(&fitted.effect, axis));
    if jumps(study, &free, axis) {
        return vec![without, free];
    }
    let besides = free.with(Fitted::unfitted(jump.effect.clone()));
    vec![without.with(jump), besides]
}

/// Whether an effect seems to hold an axis after a reversal, for a time or over some way.
fn holds(effect: &Effect, axis: usize) -> bool {
    is_spike(effect, axis)
        || matches!(effect.shape, Shape::Backlash { axis: of, wind_up } if of == axis && wind_up > 0.0)
}

/// Whether an effect is a spike after each reversal of an axis.
fn is_spike(effect: &Effect, axis: usize) -> bool {
    matches!(effect.shape, Shape::ReversalSpike { axis: of, .. } if of == axis)
}

/// Whether an effect is a play of the axis in its own direction, behind the drive, that acts at once.
fn is_play(study: &Study<'_>, effect: &Effect, axis: usize) -> bool {
    let own = study.own[axis].map(|motion| Place::Motion { motion, side: Side::After });
    Some(effect.place) == own && effect.shape == Shape::Backlash { axis, wind_up: 0.0 }
}

/// Whether anything of an axis jumps in its own direction, known or found, before its drive or behind it.
fn jumps(study: &Study<'_>, model: &Model, axis: usize) -> bool {
    let own = study.own[axis];
    let is_jump = |fitted: &Fitted| {
        own.is_some()
            && fitted.effect.motion() == own
            && fitted.effect.shape == Shape::Backlash { axis, wind_up: 0.0 }
    };
    study.known.iter().chain(&model.effects).any(is_jump)
}

/// How wide the plays of an axis are together, known and found, mm or rad.
fn play(study: &Study<'_>, model: &Model, axis: usize) -> f64 {
    let all = study.known.iter().chain(&model.effects);
    let plays = all.filter(|fitted| is_play(study, &fitted.effect, axis));
    plays.flat_map(|fitted| &fitted.coefficients).sum::<f64>().max(0.0)
}

#[cfg(test)]
mod tests;
