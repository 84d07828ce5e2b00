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

mod events;
mod forms;

use crate::appraisal::Appraisal;
use crate::audit::spread;
use crate::contest::{Contest, DECISIVE};
use crate::design::{Design, Regressor};
use crate::engine::{self, Found};
use crate::fit::Fit;
use crate::model::{Effect, Fitted, Model};
use crate::noise::{self, Noise};
use crate::study::Study;
use crate::terms::Shape;
use crate::unsteady;
use events::Event;
use forms::Form;

/// The most rounds. Each takes one effect in; with more of them the recordings show a machine of which too much is unknown for any form
/// to be right.
const MOST: usize = 3;

/// How many forms, of those that promise most beside what was found and of those that do alone, are compared in full.
const COMPARED: usize = 24;

/// How many forms get a fit of their own: several have nearly the same column, and the fit tells which is right.
const TRIALS: usize = 3;

/// A form that is to be fitted.
struct Trial {
    form: Fitted,
    /// What is fitted beside it, and stays if it stands up.
    beside: Option<Effect>,
    /// The effects found that are kept, by their numbers.
    kept: Vec<usize>,
}

/// Puts forms in the place of what imitates them, as long as one makes all of it better.
pub(crate) fn compose(study: &mut Study<'_>, found: &mut Found) {
    for _ in 0..MOST {
        if !is_open(study, found) {
            return;
        }
        let forms = forms::forms(study, found);
        let price = FormPrice::new(found, forms.len() + events::count(study));
        let contest = contest(study, found, &forms);
        let happened = events::events(study, found);
        let tried = best(study, found, &forms, (&contest, &price));
        let taken = tried.into_iter().any(|trial| take(study, found, &trial, &price))
            || happened.into_iter().any(|event| take_event(study, found, event, &price));
        if !taken {
            return;
        }
    }
}

/// Whether there is anything for a form to explain: more than noise is left, or one form may be behind several names.
fn is_open(study: &Study<'_>, found: &Found) -> bool {
    found.fit.model.len() >= found.always + MANY || is_something_left(study, &found.appraisal)
}

/// Whether more is left of some channel than noise.
fn is_something_left(study: &Study<'_>, appraisal: &Appraisal) -> bool {
    appraisal.lacks() || unsteady::returning(study, appraisal).is_some() || is_rough(study, appraisal)
}

/// From this number of names on, one form may be behind them, and each name imitates a part of it. One name that leaves nothing is the
/// simplest model there is.
const MANY: usize = 2;

/// Whether what is left of a channel is larger than its differences from row to row say of noise: what changes slowly is left.
fn is_rough(study: &Study<'_>, appraisal: &Appraisal) -> bool {
    study.scenes.iter().enumerate().any(|(scene, known)| {
        (0..known.channels.len()).any(|channel| {
            let left = left(study, appraisal, scene, channel);
            let scatter = (3.0 / crate::number(left.len())).sqrt();
            square(&left) > white(study, &left, scene, channel).powi(2) * (1.0 + ROUGH * scatter)
        })
    })
}

/// What is left of a channel in the rows that are fitted and count.
fn left(study: &Study<'_>, appraisal: &Appraisal, scene: usize, channel: usize) -> Vec<f64> {
    let fitted = study.scenes[scene].fitted_rows();
    let (marks, residual) = (&appraisal.outliers[scene][channel], &appraisal.residuals[scene][channel]);
    let counts = |row: &usize| fitted[*row] && !marks[*row] && residual[*row].is_finite();
    (0..residual.len()).filter(counts).map(|row| residual[row]).collect()
}

/// The white noise of a channel by the differences from row to row.
fn white(study: &Study<'_>, left: &[f64], scene: usize, channel: usize) -> f64 {
    let rounding = study.scenes[scene].channels[channel].rounding;
    noise::from_differences(left).max(rounding).max(f64::MIN_POSITIVE)
}

/// The mean square.
fn square(left: &[f64]) -> f64 {
    left.iter().map(|value| value * value).sum::<f64>() / crate::number(left.len().max(1))
}

/// The variance of white noise, estimated from differences, has a relative standard deviation of the square root of 3 over their
/// number. By chance one channel of 4300 lies 3.5 of them above (a normal tail), and costs the time of a contest.
const ROUGH: f64 = 3.5;

/// The price of a form: that of an effect of its kind, and more because it is the best of more candidates.
struct FormPrice {
    more: f64,
}

impl FormPrice {
    fn new(found: &Found, forms: usize) -> Self {
        let known = found.tries.candidates.max(1.0);
        Self { more: 2.0 * ((known + crate::number(forms)) / known).ln() }
    }

    fn of(&self, study: &Study<'_>, found: &Found, effect: &Effect, samples: f64) -> f64 {
        found.conditions().price(study, effect, samples) + self.beyond_a_name(effect)
    }

    /// What an effect costs beyond a name of the vocabulary.
    fn beyond_a_name(&self, effect: &Effect) -> f64 {
        if effect.shape.is_composed() { self.more } else { 0.0 }
    }
}

/// The forms that lower the cost most, the cheapest first, each with its amount and with the numbers of the effects that are kept beside
/// it.
fn best(
    study: &Study<'_>,
    found: &Found,
    forms: &[Form],
    (contest, price): (&Contest, &FormPrice),
) -> Vec<Trial> {
    let price = |form: &Form| price.of(study, found, &form.effect, contest.samples);
    let promises = contest.promises();
    let known = contest.outcome(None).cost;
    let mut compared = most_promising(forms, &promises, |[beside_all, _]| beside_all, &price);
    compared.extend(most_promising(forms, &promises, |[_, alone]| alone, &price));
    compared.sort_unstable();
    compared.dedup();
    let mut gains: Vec<(usize, f64)> = compared
        .into_iter()
        .map(|number| (number, known - contest.outcome(Some(number)).cost - price(&forms[number])))
        .filter(|(_, gain)| *gain > DECISIVE)
        .collect();
    gains.sort_by(|a, b| b.1.total_cmp(&a.1));
    gains.into_iter().take(TRIALS).map(|(number, _)| refined(study, found, &forms[number])).collect()
}

/// The forms of the highest promises above their price, beside all that was found or alone.
fn most_promising(
    forms: &[Form],
    promises: &[[f64; 2]],
    which: fn([f64; 2]) -> f64,
    price: &dyn Fn(&Form) -> f64,
) -> Vec<usize> {
    let gains = promises.iter().zip(forms).map(|(promise, form)| which(*promise) - price(form));
    let mut order: Vec<(usize, f64)> = gains.enumerate().filter(|(_, gain)| *gain > 0.0).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    order.into_iter().take(COMPARED).map(|(number, _)| number).collect()
}

/// The contest of forms with what was found.
fn contest(study: &Study<'_>, found: &Found, forms: &[Form]) -> Contest {
    let rows: Vec<Vec<usize>> = study.scenes.iter().map(|scene| spread(scene.rows())).collect();
    let columns = |chunk: std::ops::Range<usize>, (scene, channel): (usize, usize)| {
        columns(study, found, &forms[chunk], (scene, channel), &rows[scene])
    };
    Contest::new(study, found, &rows, forms.len(), &columns)
}

/// The column of each form in some rows of a channel.
fn columns(
    study: &Study<'_>,
    found: &Found,
    forms: &[Form],
    channel: (usize, usize),
    rows: &[usize],
) -> Vec<Vec<f64>> {
    let regressors: Vec<Regressor> = forms.iter().map(|form| Regressor::of(form.effect.clone())).collect();
    let matrix = Design::columns_in(study, channel, &found.fit.model, &regressors, rows);
    let mut first = 0;
    forms
        .iter()
        .map(|form| {
            let mut sum = vec![0.0; rows.len()];
            for coefficient in &form.coefficients {
                let column = matrix.column(first);
                sum.iter_mut().zip(column.iter()).for_each(|(sum, value)| *sum += coefficient * value);
                first += 1;
            }
            sum
        })
        .collect()
}

/// A form with the best value of its factor's number, its amount, and the effects that are kept beside it.
fn refined(study: &Study<'_>, found: &Found, form: &Form) -> Trial {
    let mut variants = vec![form.clone()];
    variants.extend(
        forms::neighbours(&form.effect.shape)
            .into_iter()
            .map(|shape| Form { effect: Effect { shape, ..form.effect }, ..form.clone() }),
    );
    let contest = contest(study, found, &variants);
    let outcomes = (0..variants.len()).map(|number| (number, contest.outcome(Some(number))));
    let best = outcomes.min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost));
    let (number, outcome) = best.unwrap_or_else(|| (0, contest.outcome(None)));
    let (form, beside) = (variants[number].fitted(outcome.amount), form.beside.clone());
    Trial { form, beside, kept: outcome.kept }
}

/// Fits a form beside what is kept, and takes it over where all of it is better: it stands up before the judge, costs decisively less
/// under the noise that it leaves, and held-out samples lie nearer.
fn take(study: &mut Study<'_>, found: &mut Found, trial: &Trial, price: &FormPrice) -> bool {
    let Trial { form, beside, kept } = trial;
    let kept = kept.iter().copied().filter(|number| *number >= found.always);
    let numbers = (0..found.always).chain(kept);
    let mut model: Model = numbers.map(|number| found.fit.model[number].clone()).collect();
    model.push(form.clone());
    model.extend(
        beside
            .iter()
            .map(|effect| Fitted { effect: effect.clone(), coefficients: vec![0.0; effect.shape.columns()] }),
    );
    let is_form = |fitted: &Fitted| {
        fitted.effect.place == form.effect.place
            && fitted.effect.shape.factors() == form.effect.shape.factors()
    };
    take_model(study, found, model, (&is_form, form.effect.shape.is_composed()), price)
}

/// Fits a model in which something happened, and takes it over on the same terms.
fn take_event(study: &mut Study<'_>, found: &mut Found, event: Event, price: &FormPrice) -> bool {
    let is_step = |fitted: &Fitted| matches!(fitted.effect.shape, Shape::Step { .. });
    take_model(study, found, event.model, (&is_step, true), price)
}

/// Fits a model and takes it over where what is wanted of it stands up and all of it is better. It must also take the place of several
/// names; or what is composed takes most of what was left. A name may replace another one, and is added only where more than noise was
/// left: otherwise the search has asked for it.
fn take_model(
    study: &mut Study<'_>,
    found: &mut Found,
    model: Model,
    (is_wanted, is_composed): (&dyn Fn(&Fitted) -> bool, bool),
    price: &FormPrice,
) -> bool {
    let crossings = study.crossings.clone();
    let conditions = found.conditions();
    let fit = conditions.refine(study, model);
    let (fit, appraisal) = engine::upheld(study, fit, &conditions);
    let simpler = fit.model.len() + SIMPLER <= found.fit.model.len();
    let is_needed = if is_composed {
        takes_most(study, &found.appraisal, &appraisal)
    } else {
        fit.model.len() <= found.fit.model.len() || is_something_left(study, &found.appraisal)
    };
    if fit.model.iter().any(is_wanted)
        && (simpler || is_needed)
        && is_better(study, found, (&fit, &appraisal), price)
    {
        found.fit = fit;
        found.appraisal = appraisal;
        return true;
    }
    study.crossings = crossings;
    found.appraisal.mark(study);
    false
}

/// How many effects fewer make a model simpler. Such a form need not take more of the residual than they did.
const SIMPLER: usize = 1;

/// The share of what is left above white noise that a form must take. What takes less leaves the better part without a name, and may be a
/// piece of that.
const MOST_OF_IT: f64 = 0.5;

/// Whether a model takes most of what another one leaves above white noise.
fn takes_most(study: &Study<'_>, before: &Appraisal, after: &Appraisal) -> bool {
    let (mut taken, mut excess) = (0.0, 0.0);
    for (scene, known) in study.scenes.iter().enumerate() {
        for channel in 0..known.channels.len() {
            let (old, new) = (left(study, before, scene, channel), left(study, after, scene, channel));
            let white = white(study, &new, scene, channel).powi(2);
            taken += (square(&old) - square(&new)) / white;
            excess += square(&old) / white - 1.0;
        }
    }
    taken > MOST_OF_IT * excess
}

/// Whether a model costs decisively less than what was found, both under the noise that it leaves, and held-out samples lie nearer to
/// it. Under the noise that was left before it may not cost decisively more: what a poor model leaves looks like noise, under which
/// the better model is only the longer one.
fn is_better(
    study: &Study<'_>,
    found: &Found,
    (fit, appraisal): (&Fit, &Appraisal),
    price: &FormPrice,
) -> bool {
    let gains = |noises: &[Vec<Noise>]| gain(study, found, fit, (noises, price));
    let nearer = appraisal.held_out(study, appraisal) < found.appraisal.held_out(study, appraisal);
    nearer && gains(&appraisal.noises) > DECISIVE && gains(&found.appraisal.noises) > -DECISIVE
}

/// By how much a model costs less than what was found, both fitted under a noise.
fn gain(study: &Study<'_>, found: &Found, fit: &Fit, (noises, price): (&[Vec<Noise>], &FormPrice)) -> f64 {
    let conditions = found.conditions();
    let conditions = conditions.under(noises);
    let cost = |model: &Model| {
        let fit = conditions.refine(study, model.clone());
        let names = conditions.cost_at(study, &fit, &conditions.prices(study, &fit.model, fit.samples));
        names + fit.model.iter().map(|fitted| price.beyond_a_name(&fitted.effect)).sum::<f64>()
    };
    cost(&found.fit.model) - cost(&fit.model)
}
