//! Harmonics: waves that one thing makes, whose lengths are whole fractions of one length.
//!
//! In: a model with waves along axes. Out: the same, with harmonics of a wave in the place of waves that cannot be told from them, and
//! with further ones, where that costs less. A motor, a worm or a line that is not alike all round makes a wave that is no sine. Over
//! a few of its cycles each harmonic alone would lean to whatever else is there; as parts of one wave they share its length, all of them
//! bear on it, and each pays for its two coefficients alone.

use crate::conditions::Conditions;
use crate::design::{Design, Regressor};
use crate::fit::{self, Fit};
use crate::model::{Effect, Fitted, Model};
use crate::parallel;
use crate::ranges::{Resolution, goes_round, periods};
use crate::study::Study;
use crate::sweep::{Swept, misfit};
use crate::terms::Shape;
use crate::travel::Travel;

/// The highest harmonic that is looked for. Those of a wave without jumps fall with the square of their order: beyond the twelfth they are
/// below 1 % of the fundamental.
pub(crate) const HIGHEST: u32 = 12;

/// A wave comes again where the travel holds this many of its cycles: two, but for what the rows leave out at the ends of the travel.
const TWICE: f64 = 1.9;

/// The effects that have a nonlinear parameter, by their numbers: those together that have the same one.
pub(crate) fn sharing(effects: &[Fitted]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (number, fitted) in effects.iter().enumerate() {
        if fitted.effect.shape.nonlinear().is_none() {
            continue;
        }
        let same = |group: &&mut Vec<usize>| {
            group.iter().any(|known| are_of_one_wave(&effects[*known].effect, &fitted.effect))
        };
        match groups.iter_mut().find(same) {
            Some(group) => group.push(number),
            None => groups.push(vec![number]),
        }
    }
    groups
}

/// Whether two effects are harmonics of one wave, or one of them is its fundamental.
fn are_of_one_wave(one: &Effect, other: &Effect) -> bool {
    let base = |effect: &Effect| match effect.shape {
        Shape::Cyclic { axis, period, .. } => Some((axis, period)),
        _ => None,
    };
    one.place == other.place && base(one).is_some() && base(one) == base(other)
}

/// Whether an effect is part of a wave with harmonics that comes at least twice along its axis.
pub(crate) fn comes_again(model: &Model, effect: &Effect, travels: &[Travel]) -> bool {
    let others = model.effects.iter().map(|fitted| &fitted.effect);
    comes_again_among(others, effect, |axis, far| far <= travels[axis].range())
}

/// The same beside these effects; `goes` tells whether an axis goes so far.
pub(crate) fn comes_again_among<'e>(
    mut others: impl Iterator<Item = &'e Effect>,
    effect: &Effect,
    goes: impl Fn(usize, f64) -> bool,
) -> bool {
    let Shape::Cyclic { axis, period, .. } = effect.shape else { return false };
    goes(axis, TWICE * period) && others.any(|other| other != effect && are_of_one_wave(other, effect))
}

/// An effect of a model and, where it is a harmonic from the second on, those of the same wave beside it, by their numbers.
pub(crate) fn together(model: &Model, number: usize) -> Vec<usize> {
    let own = &model.effects[number].effect;
    let with = |other: &usize| {
        let effect = &model.effects[*other].effect;
        !is_fundamental(effect) && are_of_one_wave(effect, own)
    };
    if is_fundamental(own) {
        return vec![number];
    }
    (0..model.effects.len()).filter(|other| *other == number || with(other)).collect()
}

/// Makes waves by themselves of harmonics whose fundamental is not among the effects. A harmonic has the length of its wave from the
/// fundamental; without it, nothing says that they belong together.
pub(crate) fn set_free(effects: &mut [Fitted]) {
    let fundamentals: Vec<Effect> = effects
        .iter()
        .map(|fitted| &fitted.effect)
        .filter(|effect| is_fundamental(effect))
        .cloned()
        .collect();
    for Fitted { effect, .. } in effects {
        let belongs = fundamentals.iter().any(|fundamental| are_of_one_wave(fundamental, effect));
        if !belongs {
            by_itself(&mut effect.shape);
        }
    }
}

/// A model in which these harmonics are waves by themselves.
fn set_apart(model: &Model, group: &[usize]) -> Model {
    let apart = |(number, fitted): (usize, &Fitted)| {
        let mut fitted = fitted.clone();
        if group.contains(&number) {
            by_itself(&mut fitted.effect.shape);
        }
        fitted
    };
    model.with_effects(model.effects.iter().enumerate().map(apart))
}

/// Makes a wave by itself of a harmonic.
fn by_itself(shape: &mut Shape) {
    if let Shape::Cyclic { period, order, .. } = shape {
        *period /= f64::from(*order);
        *order = 1;
    }
}

/// Whether a wave cannot be told from one of those of a model that have their length in common. It would lean to what that leaves, and as
/// part of the whole it costs less.
pub(crate) fn stands_for(model: &Model, resolution: &Resolution, wave: &Effect) -> bool {
    let groups = sharing(&model.effects).into_iter().filter(|group| group.len() > 1);
    groups.flatten().any(|number| {
        let member = &model.effects[number].effect;
        member.place == wave.place && resolution.blurs(&member.shape, &wave.shape)
    })
}

/// Further harmonics of the waves of a model that have some: those that are not in it yet, and that its recordings would show.
pub(crate) fn open(study: &Study<'_>, model: &Model, travels: &[Travel]) -> Vec<Effect> {
    let mut effects: Vec<Effect> = Vec::new();
    let have_some =
        model.chosen().iter().filter(|fitted| order(&fitted.effect).is_some_and(|order| order > 1));
    for fitted in have_some {
        for effect in harmonics(study, &fitted.effect, travels) {
            let stands =
                model.effects.iter().any(|known| known.effect == effect) || effects.contains(&effect);
            if !stands {
                effects.push(effect);
            }
        }
    }
    effects
}

/// The harmonics of a wave along an axis, from the second on, as far as its rows resolve them. Those of an axis that goes round are waves
/// of a known length already.
fn harmonics(study: &Study<'_>, wave: &Effect, travels: &[Travel]) -> Vec<Effect> {
    let Shape::Cyclic { axis, period, center, .. } = wave.shape else { return Vec::new() };
    if goes_round(study, axis, &travels[axis]) {
        return Vec::new();
    }
    let (shortest, _) = periods(study, axis, &travels[axis]);
    let orders = (2..=HIGHEST).take_while(|order| period / f64::from(*order) >= shortest);
    orders
        .map(|order| Effect { place: wave.place, shape: Shape::Cyclic { axis, period, order, center } })
        .collect()
}

/// Tries the harmonics of each wave of a fitted model, in the place of waves that cannot be told from them; and harmonics that stand already as
/// waves by themselves.
pub(crate) fn try_harmonics(study: &Study<'_>, now: Fit, conditions: &Conditions<'_>) -> Fit {
    let effects = now.model.chosen().iter().map(|fitted| &fitted.effect);
    let waves: Vec<&Effect> = effects.filter(|effect| is_fundamental(effect)).collect();
    let cheaper = parallel::counted(waves.len(), study.rows() * waves.len(), |number| {
        cheaper_with_harmonics(study, &now, waves[number], conditions)
    });
    let mut trials: Vec<Fit> = cheaper.into_iter().flatten().collect();
    let groups = sharing(&now.model.effects).into_iter().filter(|group| group.len() > 1);
    trials.extend(groups.map(|group| conditions.refine(study, set_apart(&now.model, &group))));
    conditions.cheapest(study, now, trials)
}

/// A fit with harmonics of a wave that costs less than the present one. At first they take the place of all waves that cannot be told from
/// them. Where that costs more, one of those waves is something else, and each may stay in the place of the harmonics that it hides.
fn cheaper_with_harmonics(
    study: &Study<'_>,
    now: &Fit,
    wave: &Effect,
    conditions: &Conditions<'_>,
) -> Option<Fit> {
    let cost = conditions.cost(study, now);
    let is_cheaper = |fit: &Fit| conditions.cost(study, fit) < cost;
    with_harmonics(study, now, wave, &[], conditions).filter(is_cheaper).or_else(|| {
        let imitators = imitators(study, &now.model, wave, conditions);
        if imitators.is_empty() {
            return None;
        }
        with_harmonics(study, now, wave, &imitators, conditions).filter(is_cheaper)
    })
}

/// The waves of a model that cannot be told from a harmonic of one of them.
fn imitators(study: &Study<'_>, model: &Model, wave: &Effect, conditions: &Conditions<'_>) -> Vec<Effect> {
    let harmonics = harmonics(study, wave, conditions.travels);
    let resolution = Resolution::new(study, conditions.travels);
    let effects = model.chosen().iter().map(|fitted| &fitted.effect);
    let others = effects.filter(|effect| *effect != wave && !is_other_harmonic(effect, wave));
    others.filter(|effect| imitates_one(&resolution, effect, &harmonics)).cloned().collect()
}

/// Whether an effect is a harmonic of a wave, from the second on.
fn is_other_harmonic(effect: &Effect, wave: &Effect) -> bool {
    !is_fundamental(effect) && are_of_one_wave(effect, wave)
}

/// Whether an effect is a wave that cannot be told from one of these.
fn imitates_one(resolution: &Resolution, effect: &Effect, waves: &[Effect]) -> bool {
    waves.iter().any(|wave| effect.place == wave.place && resolution.blurs(&wave.shape, &effect.shape))
}

fn is_fundamental(effect: &Effect) -> bool {
    order(effect) == Some(1)
}

/// A fit with those harmonics of a wave that pay and are no chance; `None` where there are none. Of the imitators each may stay in the place
/// of the harmonics that it cannot be told from.
fn with_harmonics(
    study: &Study<'_>,
    now: &Fit,
    wave: &Effect,
    imitators: &[Effect],
    conditions: &Conditions<'_>,
) -> Option<Fit> {
    let mut harmonics = harmonics(study, wave, conditions.travels);
    let (fit, fundamental) = with_those_that_pay(study, now, wave, (&harmonics, imitators), conditions)?;
    let effects = &fit.model.effects;
    let highest = highest(study, &fit.model, fundamental, conditions)?;
    let is_chance = |effect: &Effect| order(effect).is_some_and(|order| f64::from(order) > highest);
    let of_this_wave = |effect: &&Effect| are_of_one_wave(effect, &effects[fundamental].effect);
    if !effects.iter().map(|fitted| &fitted.effect).filter(of_this_wave).any(is_chance) {
        return Some(fit);
    }
    harmonics.retain(|harmonic| !is_chance(harmonic));
    let fit = with_those_that_pay(study, now, wave, (&harmonics, imitators), conditions);
    fit.map(|(fit, _)| fit)
}

/// A fit with those of some harmonics of a wave that pay, in the place of those that the model has and of waves that cannot be told from
/// any of them, and the number of the wave in it; `None` where none pays. An imitator that pays more than the harmonics that it cannot be
/// told from takes their place. `None` also where the present fit costs less than they do before they are fitted: the slopes of the periods
/// are in that already.
fn with_those_that_pay(
    study: &Study<'_>,
    now: &Fit,
    wave: &Effect,
    (harmonics, imitators): (&[Effect], &[Effect]),
    conditions: &Conditions<'_>,
) -> Option<(Fit, usize)> {
    let resolution = Resolution::new(study, conditions.travels);
    let stays = |effect: &Effect| {
        effect == wave || !is_other_harmonic(effect, wave) && !imitates_one(&resolution, effect, harmonics)
    };
    let kept = now.model.keeping(|fitted| stays(&fitted.effect));
    let mut open = harmonics.to_vec();
    open.extend(imitators.iter().filter(|imitator| !stays(imitator)).cloned());
    let (paying, cost) = paying(study, &kept, open, conditions);
    let has_harmonics = paying.iter().any(|effect| is_other_harmonic(effect, wave));
    if !has_harmonics || cost > conditions.cost(study, now) {
        return None;
    }
    let fundamental = kept.effects.iter().position(|fitted| fitted.effect == *wave)?;
    let model = paying.into_iter().fold(kept, |model, effect| model.with(Fitted::unfitted(effect)));
    Some((conditions.refine(study, model), fundamental))
}

/// The highest harmonic of a wave that is no chance: how well its length is known from its fundamental alone tells where its harmonics
/// are. Of a length that is hardly known, every other wave is some harmonic.
fn highest(study: &Study<'_>, model: &Model, fundamental: usize, conditions: &Conditions<'_>) -> Option<f64> {
    let period = model.effects[fundamental].effect.shape.nonlinear()?.value;
    let deviation = fit::deviation_alone(study, model, conditions.weights, fundamental)?;
    // Harmonics lie a whole frequency apart, each of them known to two deviations on both sides times its order.
    Some(CHANCE * period / (4.0 * deviation))
}

/// How often a wave of another cause may be taken for a harmonic.
const CHANCE: f64 = 0.05;

fn order(effect: &Effect) -> Option<u32> {
    match effect.shape {
        Shape::Cyclic { order, .. } => Some(order),
        _ => None,
    }
}

/// Those of some effects that pay for themselves beside a model, the one that gains most first. Of a harmonic and a wave that cannot be told
/// from it one alone does. Also what the model with them costs before it is fitted.
fn paying(
    study: &Study<'_>,
    model: &Model,
    open: Vec<Effect>,
    conditions: &Conditions<'_>,
) -> (Vec<Effect>, f64) {
    let first = model.effects.len();
    let mut regressors = Regressor::all(&model.effects);
    regressors.extend(open.iter().cloned().map(Regressor::of));
    regressors.extend(sharing(&model.effects).iter().map(|group| Regressor::slope(&model.effects, group)));
    let mut design = Design::new(study, model, conditions.weights, regressors);
    design.rebase(&model.effects);
    let (products, samples) = design.fitted();
    let mut swept = Swept::new(&products);
    let beside = (0..first).chain(first + open.len()..design.regressors.len());
    for column in beside.flat_map(|number| design.columns(number)) {
        swept.take(column);
    }
    let price = |effect: &Effect| conditions.price(study, effect, samples);
    let mut paid: f64 = model.chosen().iter().map(|fitted| price(&fitted.effect)).sum();
    let resolution = Resolution::new(study, conditions.travels);
    let mut paying = Vec::new();
    let mut left: Vec<usize> = (0..open.len()).collect();
    loop {
        let gain = |number: &usize| {
            let columns: Vec<usize> = design.columns(first + number).collect();
            let left = swept.remaining() - swept.promise(&columns).0;
            misfit(swept.remaining(), samples) - misfit(left, samples) - price(&open[*number])
        };
        let best = left.iter().copied().max_by(|a, b| gain(a).total_cmp(&gain(b)));
        let Some(best) = best.filter(|best| gain(best) > 0.0) else {
            return (paying, misfit(swept.remaining(), samples) + paid);
        };
        for column in design.columns(first + best) {
            swept.take(column);
        }
        let hides = |other: &Effect| {
            !are_of_one_wave(other, &open[best]) && resolution.blurs(&other.shape, &open[best].shape)
        };
        left.retain(|number| *number != best && !hides(&open[*number]));
        paid += price(&open[best]);
        paying.push(open[best].clone());
    }
}

#[cfg(test)]
mod tests;
