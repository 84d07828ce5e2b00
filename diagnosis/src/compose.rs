//! Composition: forms for which no term has a name.
//!
//! In: a study that was searched, with what was found, where more comes back than the names explain. Out: what was found, with forms
//! built from terms and factors in the place of what only imitates them.
//!
//! Machines multiply states: a play grows where the screw is worn, a column leans with speed and height. What the vocabulary has no
//! name for, several of its terms imitate in part. So every form competes with all that was found, as the faults of the files do:
//!
//! ```text
//! forms: some thousand effects -> contest: the cost of a model with each, beside what it keeps of what was found
//!     -> refined: the number of its factor -> fitted and judged as any effect -> kept where all of it is better
//! ```
//!
//! The price of a form is that of all terms and all forms, and 2 for each of its factors.

mod delays;
mod events;
mod forms;
mod spins;
mod trials;

use crate::appraisal::Appraisal;
use crate::channel::ChannelAt;
use crate::contest::DECISIVE;
use crate::engine::{self, Found};
use crate::fit::Fit;
use crate::judge;
use crate::model::{Fitted, Model};
use crate::noise;
use crate::search::rivals;
use crate::study::Study;
use crate::terms::Shape;
use crate::unsteady;
use crate::weights::Weights;
use delays::Late;
use events::Event;
use forms::Form;
use trials::{FormPrice, Ring, Trial};

/// The most rounds. Each takes one effect in; with more of them the recordings show a machine of which too much is unknown for any form
/// to be right. With one round, a crash of three steps and two forms at once are found in part; five rounds find what three do.
const MOST: usize = 3;

/// Puts forms in the place of what imitates them, as long as one makes all of it better.
pub(crate) fn compose(study: &Study<'_>, found: &mut Found) {
    for _ in 0..MOST {
        let spins = spins::spins(study, found);
        let open = is_open(study, found);
        if !open && spins.forms.is_empty() {
            return;
        }
        let lacks = is_something_left(study, &found.appraisal);
        let mut forms = if open { forms::forms(study, found) } else { Vec::new() };
        let tried = crate::number(forms.len() + events::count(study)) + spins.tried;
        forms.extend(spins.forms);
        let price = FormPrice::new(found, tried);
        // A dead time first: where a loop stands in for it, forms of the velocity make up for the difference.
        let taken = take_delay(study, found, (&price, lacks))
            || take_form(study, found, &forms, (&price, lacks))
            || take_event(study, found, (&price, lacks));
        if !taken {
            return;
        }
    }
}

/// Takes over the first delay that makes all of it better, if one does.
fn take_delay(study: &Study<'_>, found: &mut Found, (price, lacks): (&FormPrice, bool)) -> bool {
    let late = delays::delays(study, found, lacks);
    late.into_iter().any(|late| take_late(study, found, late, price))
}

/// Takes over the first form that makes all of it better, the one that promises most first.
fn take_form(
    study: &Study<'_>,
    found: &mut Found,
    forms: &[Form],
    (price, lacks): (&FormPrice, bool),
) -> bool {
    // What a model lacks keeps its direction, and the search counts such stretches once: so few samples are left then that no form could
    // pay its price. A form that makes the rest noise again has to win under that noise.
    let weights = found.appraisal.weights.each_for_itself();
    let tried = trials::best(Ring { study, found, weights: &weights, price, lacks }, forms);
    tried.into_iter().any(|trial| take(study, found, &trial, price))
}

/// Takes over the first event that makes all of it better. Where nothing is left, only what was found as a course of time may be one.
fn take_event(study: &Study<'_>, found: &mut Found, (price, lacks): (&FormPrice, bool)) -> bool {
    let is_course = |fitted: &Fitted| {
        let shape = fitted.effect.shape.core();
        matches!(shape, Shape::Drift { .. } | Shape::Growth { .. } | Shape::SensorPolynomial { .. })
    };
    if !lacks && !found.fit.model.effects.iter().any(is_course) {
        return false;
    }
    let happened = events::events(study, found);
    let taken = happened.into_iter().any(|event| take_happened(study, found, event, price));
    if taken {
        search_beside_events(study, found, price);
        date_again(study, found);
    }
    taken
}

/// Looks for everything anew beside the events of a model. The search before knew nothing of them: it took them for noise, or for other
/// effects.
fn search_beside_events(study: &Study<'_>, found: &mut Found, price: &FormPrice) {
    let other = engine::beside_events(study, found);
    if is_better(study, found, (&other.fit, &other.appraisal), price) {
        *found = other;
    }
}

/// Looks for the moments of the events of a model anew, beside all else that is in it now. What stood in for an event when it was first
/// dated, such as a drift, may have drawn it away.
fn date_again(study: &Study<'_>, found: &mut Found) {
    let model = events::dated_again(study, found);
    let white = found.appraisal.weights.as_white();
    let conditions = found.conditions();
    let fit = conditions.under(&white).refine(study, model);
    let (fit, appraisal) = engine::upheld(study, fit, &conditions);
    let whole = fit.model.effects.len() == found.fit.model.effects.len();
    if whole && deviance(study, &appraisal, true) < deviance(study, &found.appraisal, true) {
        found.fit = fit;
        found.appraisal = appraisal;
    }
}

/// Whether there is anything for a form to explain: more than noise is left, or one form may be behind several names.
fn is_open(study: &Study<'_>, found: &Found) -> bool {
    found.fit.model.chosen().len() >= MANY || is_something_left(study, &found.appraisal)
}

/// Whether more is left of some channel than noise.
fn is_something_left(study: &Study<'_>, appraisal: &Appraisal) -> bool {
    appraisal.lacks() || unsteady::returning(study, appraisal).is_some() || is_rough(study, appraisal)
}

/// From this number of names on, one form may be behind them, and each name imitates a part of it. One name that leaves nothing is the
/// simplest model there is. Between one and three nothing that was simulated comes out otherwise, nor takes longer.
const MANY: usize = 2;

/// Whether what is left of a channel is larger than its differences from row to row say of noise: what changes slowly is left.
fn is_rough(study: &Study<'_>, appraisal: &Appraisal) -> bool {
    study.channels().any(|at| {
        let left = left(study, appraisal, at);
        let scatter = (3.0 / crate::number(left.len())).sqrt();
        square(&left) > white(study, &left, at).powi(2) * (1.0 + ROUGH * scatter)
    })
}

/// What is left of a channel in the rows that are fitted and count.
fn left(study: &Study<'_>, appraisal: &Appraisal, at: ChannelAt) -> Vec<f64> {
    let fitted = study.scenes[at.scene].fitted_rows();
    let (marks, residual) = (appraisal.weights.outliers.of(at), &appraisal.residuals[at.scene][at.channel]);
    let counts = |row: &usize| fitted[*row] && !marks[*row] && residual[*row].is_finite();
    (0..residual.len()).filter(counts).map(|row| residual[row]).collect()
}

/// The white noise of a channel by the differences from row to row.
fn white(study: &Study<'_>, left: &[f64], at: ChannelAt) -> f64 {
    noise::from_differences(left).max(study.channel(at).rounding).max(f64::MIN_POSITIVE)
}

/// The mean square.
fn square(left: &[f64]) -> f64 {
    left.iter().map(|value| value * value).sum::<f64>() / crate::number(left.len().max(1))
}

/// The variance of white noise, estimated from differences, has a relative standard deviation of the square root of 3 over their
/// number. By chance one channel of 4300 lies 3.5 of them above (a normal tail), and costs the time of a contest.
const ROUGH: f64 = 3.5;

/// Fits a form beside what is kept, and takes it over where all of it is better: it stands up before the judge, costs decisively less
/// under the noise that it leaves, and held-out samples lie nearer.
fn take(study: &Study<'_>, found: &mut Found, trial: &Trial, price: &FormPrice) -> bool {
    let Trial { form, beside, kept } = trial;
    let settings = found.fit.model.settings().iter();
    let beside = beside.iter().map(|effect| Fitted::unfitted(effect.clone()));
    let effects = settings.chain(kept).chain([form]).cloned().chain(beside);
    let model = found.fit.model.with_effects(effects);
    let is_form = |fitted: &Fitted| {
        fitted.effect.place == form.effect.place
            && fitted.effect.shape.factors() == form.effect.shape.factors()
    };
    take_model(study, found, model, (&is_form, form.effect.shape.is_composed()), price)
}

/// Fits a model in which something happened, and takes it over on the same terms.
fn take_happened(study: &Study<'_>, found: &mut Found, event: Event, price: &FormPrice) -> bool {
    let is_step = |fitted: &Fitted| fitted.effect.shape.is_event();
    take_model(study, found, event.model, (&is_step, true), price)
}

/// Fits a model in which an axis is late, and takes it over on the same terms.
fn take_late(study: &Study<'_>, found: &mut Found, late: Late, price: &FormPrice) -> bool {
    let is_delay =
        |fitted: &Fitted| matches!(fitted.effect.shape, Shape::Delay { axis, .. } if axis == late.axis);
    take_model(study, found, late.model, (&is_delay, false), price)
}

/// Fits a model and takes it over where what is wanted of it stands up and all of it is better. It must also take the place of several
/// names; or what is composed takes most of what was left. A name may replace another one, and is added only where more than noise was
/// left: otherwise the search has asked for it.
fn take_model(
    study: &Study<'_>,
    found: &mut Found,
    model: Model,
    (is_wanted, is_composed): (&dyn Fn(&Fitted) -> bool, bool),
    price: &FormPrice,
) -> bool {
    let conditions = found.conditions();
    // Under a noise that wanders, as it seemed to before, the size of an event would be that of one step of the noise.
    let white = found.appraisal.weights.as_white();
    let happened = model.effects.iter().any(|fitted| fitted.effect.shape.is_event());
    let first = if happened { conditions.under(&white) } else { conditions };
    let fit = first.refine(study, model);
    let (fit, appraisal) = engine::upheld(study, fit, &conditions);
    let simpler = fit.model.effects.len() + SIMPLER <= found.fit.model.effects.len()
        && stands_for_what_went(study, &found.fit.model, &fit.model, &appraisal.weights);
    let is_needed = if is_composed {
        takes_most(study, &found.appraisal, &appraisal)
    } else {
        fit.model.effects.len() <= found.fit.model.effects.len() || is_something_left(study, &found.appraisal)
    };
    if fit.model.effects.iter().any(is_wanted)
        && (simpler || is_needed)
        && is_better(study, found, (&fit, &appraisal), price)
    {
        found.fit = fit;
        found.appraisal = appraisal;
        return true;
    }
    false
}

/// How many effects fewer make a model simpler. Such a form need not take more of the residual than they did. With two, products of
/// positions come out a little farther from the noise, and nothing else changes.
const SIMPLER: usize = 1;

/// Whether names that went imitated what came in their place: beside it they take less than half of what they took. Names that take as
/// much are missing beside it; it only makes another noise, under which they do not stand up.
fn stands_for_what_went(study: &Study<'_>, old: &Model, new: &Model, weights: &Weights) -> bool {
    let stays = |fitted: &Fitted| {
        let is_same = |other: &Fitted| fitted.effect == other.effect || rivals(&fitted.effect, &other.effect);
        new.effects.iter().any(is_same)
    };
    let gone: Vec<usize> = old.chosen_numbers().filter(|number| !stays(&old.effects[*number])).collect();
    let with_them = gone.iter().fold(new.clone(), |model, number| model.with(old.effects[*number].clone()));
    let beside: Vec<usize> = (new.effects.len()..with_them.effects.len()).collect();
    let took = judge::worth_in(study, old, weights, &gone);
    let keeps = judge::worth_in(study, &with_them, weights, &beside);
    keeps <= IMITATED * took
}

/// The share of what names take that they keep at most beside what they imitate. On simulated and real recordings imitations keep less
/// than a hundredth, and names that only got lost two thirds and more; from 0.02 to 0.5 nothing that is found changes.
const IMITATED: f64 = 0.5;

/// The share of what is left above white noise that a form must take. What takes less leaves the better part without a name, and may be a
/// piece of that. At three quarters the first step of a crash and the first of two parts of a wave are refused, at a quarter nothing more is
/// found that is right.
const MOST_OF_IT: f64 = 0.5;

/// Whether a model takes most of what another one leaves above white noise, if that leaves anything above it.
fn takes_most(study: &Study<'_>, before: &Appraisal, after: &Appraisal) -> bool {
    let (mut taken, mut excess) = (0.0, 0.0);
    for at in study.channels() {
        let (old, new) = (left(study, before, at), left(study, after, at));
        let white = white(study, &new, at).powi(2);
        taken += (square(&old) - square(&new)) / white;
        // An axis that stands between two steps of its display leaves less than their rounding, and makes up for no other channel.
        excess += (square(&old) / white - 1.0).max(0.0);
    }
    excess > 0.0 && taken > MOST_OF_IT * excess
}

/// Whether a model costs decisively less than what was found, both under the noise that it leaves, and held-out samples lie nearer to
/// it. Beside white noise of the size that was left before it may not cost decisively more: a model that leaves more makes its noise
/// larger, under which every shorter model looks better. That noise counts each sample for itself. As one that wanders, or as stretches
/// that keep their direction, it would hold a step, or a play that fades, as well as a model does.
fn is_better(
    study: &Study<'_>,
    found: &Found,
    (fit, appraisal): (&Fit, &Appraisal),
    price: &FormPrice,
) -> bool {
    let gains = |weights: &Weights| gain(study, found, fit, (weights, price));
    let nearer = appraisal.held_out(study, appraisal) < found.appraisal.held_out(study, appraisal);
    let before = found.appraisal.weights.as_white().each_for_itself();
    nearer
        && gains(&appraisal.weights) > DECISIVE
        && gains(&before) > -DECISIVE
        && more_likely(study, found, (fit, appraisal), price) > DECISIVE
}

/// By how much a model costs less than what was found, each beside a noise that wanders as suits it best. A sensor that walks draws a
/// curve as well as a form does; under the noise that the form leaves, which holds less of the walk, it would not seem so.
fn more_likely(
    study: &Study<'_>,
    found: &Found,
    (fit, appraisal): (&Fit, &Appraisal),
    price: &FormPrice,
) -> f64 {
    let paid = |fit: &Fit, appraisal: &Appraisal| {
        let conditions = found.conditions();
        let conditions = conditions.under(&appraisal.weights);
        let names: f64 =
            conditions.prices(study, &fit.model, fit.samples)[fit.model.chosen_numbers()].iter().sum();
        names + fit.model.effects.iter().map(|fitted| price.beyond_a_name(&fitted.effect)).sum::<f64>()
    };
    // An event may have happened in a held-out part.
    let everywhere = fit.model.effects.iter().any(|fitted| fitted.effect.shape.is_event());
    let cost =
        |fit: &Fit, appraisal: &Appraisal| deviance(study, appraisal, everywhere) + paid(fit, appraisal);
    cost(&found.fit, &found.appraisal) - cost(fit, appraisal)
}

/// Minus twice the log-likelihood of what is left, of all rows or of those that are fitted, beside the noise that suits each channel best.
fn deviance(study: &Study<'_>, appraisal: &Appraisal, everywhere: bool) -> f64 {
    let of_channel = |ChannelAt { scene, channel }| {
        let (known, residual) = (&study.scenes[scene], &appraisal.residuals[scene][channel]);
        let outliers = appraisal.weights.outliers.of(ChannelAt { scene, channel });
        let fitted = known.fitted_rows();
        let counts = |row: usize| (everywhere || fitted[row]) && residual[row].is_finite() && !outliers[row];
        let valid: Vec<bool> = (0..residual.len()).map(counts).collect();
        noise::estimate(&known.recording.time, residual, &valid, known.channels[channel].rounding).1
    };
    study.channels().map(of_channel).sum()
}

/// By how much a model costs less than what was found, both fitted under a noise.
fn gain(study: &Study<'_>, found: &Found, fit: &Fit, (weights, price): (&Weights, &FormPrice)) -> f64 {
    let conditions = found.conditions();
    let conditions = conditions.under(weights);
    let cost = |model: &Model| {
        let fit = conditions.refine(study, model.clone());
        let names = conditions.cost_at(study, &fit, &conditions.prices(study, &fit.model, fit.samples));
        names + fit.model.effects.iter().map(|fitted| price.beyond_a_name(&fitted.effect)).sum::<f64>()
    };
    cost(&found.fit.model) - cost(&fit.model)
}

#[cfg(test)]
mod tests;
