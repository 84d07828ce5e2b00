//! Trials: forms that are worth a fit of their own.
//!
//! In: all forms, and what was found. Out: a few forms, each with its amount and with what is kept beside it. All forms compete with what
//! was found; those that promise most compete again, beside the names that may be missing: a search that lacks something drops what
//! it would have found beside it, and without that a form that makes up for both looks better than the right one.

use crate::audit::spread;
use crate::channel::ChannelAt;
use crate::contest::{Contest, DECISIVE};
use crate::design::{Design, Regressor};
use crate::engine::Found;
use crate::model::{Effect, Fitted, Model};
use crate::study::Study;
use crate::terms::Shape;
use crate::weights::Weights;

use super::forms::{self, Form};

/// How many forms, of those that promise most beside what was found and of those that do alone, are compared in full. With eight,
/// motions that a lever arm cannot tell apart crowd out the right one; sixty find nothing more.
const COMPARED: usize = 24;

/// How many forms get a fit of their own: several have nearly the same column, and the fit tells which is right.
/// With one, a wave that grows along a travel is taken for another form beside a backlash that does; six find what three do.
const TRIALS: usize = 3;

/// How many forms with a number are compared at other values of it too. Beside a play that fades there are some ten others of the same
/// size, as the warmth of each axis behind each time constant.
const SHARPENED: usize = 16;

/// How many names that may be missing compete beside the forms, of those that promise most beside what was found and of those that do
/// alone, in turn. A search seldom misses more than two beside what it lacks, and one lever arm has three names or four.
/// With none, forms beside a squareness stay at up to 2.8 times the noise, with six at 1.2, and twenty-four find what twelve do.
const MISSING: usize = 12;

/// A form that is to be fitted.
pub(super) struct Trial {
    pub(super) form: Fitted,
    /// What is fitted beside it, and stays if it stands up.
    pub(super) beside: Option<Effect>,
    /// What is kept of what was found beyond the settings, and names that were missing.
    pub(super) kept: Vec<Fitted>,
}

/// What forms compete with, and how samples weigh.
#[derive(Clone, Copy)]
pub(super) struct Ring<'r> {
    pub(super) study: &'r Study<'r>,
    pub(super) found: &'r Found,
    pub(super) weights: &'r Weights,
    pub(super) price: &'r FormPrice,
    /// Whether more than noise is left, so that names may be missing too.
    pub(super) lacks: bool,
}

/// The price of a form: that of an effect of its kind, and more because it is the best of more candidates.
pub(super) struct FormPrice {
    more: f64,
}

impl FormPrice {
    /// The price of the best of this many forms.
    pub(super) fn new(found: &Found, forms: f64) -> Self {
        let known = found.tries.candidates.max(1.0);
        Self { more: 2.0 * ((known + forms) / known).ln() }
    }

    fn of(&self, study: &Study<'_>, found: &Found, effect: &Effect, samples: f64) -> f64 {
        found.conditions().price(study, effect, samples) + self.beyond_a_name(effect)
    }

    /// What an effect costs beyond a name of the vocabulary.
    pub(super) fn beyond_a_name(&self, effect: &Effect) -> f64 {
        if effect.shape.is_composed() { self.more } else { 0.0 }
    }
}

/// The forms that lower the cost most, the cheapest first.
pub(super) fn best(ring: Ring<'_>, forms: &[Form]) -> Vec<Trial> {
    let Ring { study, found, price, lacks, .. } = ring;
    let mut model = found.fit.model.clone();
    let contest = ring.contest(&model, forms);
    let price = |form: &Form| price.of(study, found, &form.effect, contest.samples);
    let promises = contest.promises();
    let known = contest.outcome(None).cost;
    let is_name = |form: &Form| !form.effect.shape.is_composed();
    let names_too = has_a_form(&found.fit.model);
    let compared = most_promising(forms, &promises, &price, (COMPARED, &|form| names_too || !is_name(form)));
    // Where nothing is left no name is missing, and the first contest has said all.
    let again = lacks.then(|| {
        let names = most_promising(forms, &promises, &price, (forms.len(), &is_name));
        let missing = different(forms, names);
        model.effects.extend(missing.into_iter().map(|number| forms[number].fitted(0.0)));
        let compared: Vec<Form> = compared.iter().map(|number| forms[*number].clone()).collect();
        ring.contest(&model, &compared)
    });
    let cost = |place: usize, number: usize| match &again {
        Some(again) => again.outcome(Some(place)).cost,
        None => contest.outcome(Some(number)).cost,
    };
    let mut gains: Vec<(Form, f64)> = compared
        .into_iter()
        .enumerate()
        .map(|(place, number)| (forms[number].clone(), known - cost(place, number) - price(&forms[number])))
        .filter(|(_, gain)| *gain > DECISIVE)
        .collect();
    gains.sort_by(|a, b| b.1.total_cmp(&a.1));
    let gains = ring.sharpened(&model, gains);
    gains.into_iter().take(TRIALS).map(|(form, _)| ring.refined(&model, &form)).collect()
}

/// Whether a model holds what the vocabulary of the search has no name for. A name is asked again only beside such a form, which may have
/// hidden it; of all other names the search has decided.
fn has_a_form(model: &Model) -> bool {
    let is_form = |shape: &Shape| shape.is_composed() || matches!(shape, Shape::Delay { .. });
    model.effects.iter().any(|fitted| is_form(&fitted.effect.shape))
}

/// The wanted forms whose promise exceeds their price most: `count` of them beside all that was found, and as many alone. They come in
/// turn, the best first.
fn most_promising(
    forms: &[Form],
    promises: &[[f64; 2]],
    price: &dyn Fn(&Form) -> f64,
    (count, is_wanted): (usize, &dyn Fn(&Form) -> bool),
) -> Vec<usize> {
    let of = |which: usize| {
        let gains = promises.iter().zip(forms).map(|(promise, form)| promise[which] - price(form));
        let gains = gains.enumerate().filter(|(number, gain)| *gain > 0.0 && is_wanted(&forms[*number]));
        let mut order: Vec<(usize, f64)> = gains.collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        order.into_iter().take(count).map(|(number, _)| number)
    };
    let (beside_all, alone): (Vec<usize>, Vec<usize>) = (of(0).collect(), of(1).collect());
    let longest = beside_all.len().max(alone.len());
    let in_turn = |place: usize| [beside_all.get(place), alone.get(place)].into_iter().flatten();
    let mut numbers: Vec<usize> = Vec::new();
    for number in (0..longest).flat_map(in_turn) {
        if !numbers.contains(number) {
            numbers.push(*number);
        }
    }
    numbers
}

/// The first of them that are different terms, or terms of different motions: a play is the same at each length over which it winds up.
fn different(forms: &[Form], numbers: Vec<usize>) -> Vec<usize> {
    let kind = |number: usize| (forms[number].effect.motion(), forms[number].effect.shape.name());
    let mut first: Vec<usize> = Vec::new();
    for number in numbers {
        if first.len() < MISSING && !first.iter().any(|known| kind(*known) == kind(number)) {
            first.push(number);
        }
    }
    first
}

impl Ring<'_> {
    /// The contest of forms with the effects of a model.
    fn contest(&self, model: &Model, forms: &[Form]) -> Contest {
        let rows: Vec<Vec<usize>> = self.study.scenes.iter().map(|scene| spread(scene.rows())).collect();
        let columns = |chunk: std::ops::Range<usize>, at: ChannelAt| {
            columns(self.study, model, &forms[chunk], at, &rows[at.scene])
        };
        Contest::new(self.study, (self.found, model, self.weights), &rows, forms.len(), &columns)
    }

    /// The forms and what they gain, with a better value of a factor's number where a neighbour on the grid gains more; the best first. A
    /// form that lies between two values of the grid would fall behind others that have no such number.
    fn sharpened(&self, model: &Model, mut forms: Vec<(Form, f64)>) -> Vec<(Form, f64)> {
        let has_neighbours = |(form, _): &&mut (Form, f64)| !forms::neighbours(&form.effect.shape).is_empty();
        let mut open: Vec<&mut (Form, f64)> =
            forms.iter_mut().filter(has_neighbours).take(SHARPENED).collect();
        let beside: Vec<(usize, Form)> = open
            .iter()
            .enumerate()
            .flat_map(|(place, (form, _))| neighbours(form).into_iter().map(move |other| (place, other)))
            .collect();
        let others: Vec<Form> = beside.iter().map(|(_, form)| form.clone()).collect();
        if others.is_empty() {
            return forms;
        }
        let contest = self.contest(model, &others);
        let known = contest.outcome(None).cost;
        for (number, (place, other)) in beside.into_iter().enumerate() {
            let price = self.price.of(self.study, self.found, &other.effect, contest.samples);
            let gain = known - contest.outcome(Some(number)).cost - price;
            if gain > open[place].1 {
                *open[place] = (other, gain);
            }
        }
        forms.sort_by(|a, b| b.1.total_cmp(&a.1));
        forms
    }

    /// A form with the best value of its factor's number, its amount, and the effects that are kept beside it.
    fn refined(&self, model: &Model, form: &Form) -> Trial {
        let mut variants = vec![form.clone()];
        variants.extend(neighbours(form));
        let contest = self.contest(model, &variants);
        let outcomes = (0..variants.len()).map(|number| (number, contest.outcome(Some(number))));
        let best = outcomes.min_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost));
        let (number, outcome) = best.unwrap_or_else(|| (0, contest.outcome(None)));
        let kept = outcome.kept.into_iter().filter(|number| model.chosen_numbers().contains(number));
        Trial {
            form: variants[number].fitted(outcome.amount),
            beside: form.beside.clone(),
            kept: kept.map(|number| model.effects[number].clone()).collect(),
        }
    }
}

/// A form with other values of the number of its factor.
fn neighbours(form: &Form) -> Vec<Form> {
    let shapes = forms::neighbours(&form.effect.shape).into_iter();
    shapes.map(|shape| Form { effect: Effect { shape, ..form.effect }, ..form.clone() }).collect()
}

/// The column of each form in some rows of a channel.
fn columns(study: &Study<'_>, model: &Model, forms: &[Form], at: ChannelAt, rows: &[usize]) -> Vec<Vec<f64>> {
    let regressors: Vec<Regressor> = forms.iter().map(|form| Regressor::of(form.effect.clone())).collect();
    let matrix = Design::columns_in(study, at, model, &regressors, rows);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Place;
    use crate::side::Side;

    fn form(motion: usize, shape: Shape) -> Form {
        let effect = Effect { place: Place::Motion { motion, side: Side::After }, shape };
        Form { effect, coefficients: vec![1.0], beside: None }
    }

    fn play(wind_up: f64) -> Shape {
        Shape::Backlash { axis: 0, wind_up }
    }

    /// Beside all, the first form promises most; alone, the last. What does not pay its price is not among them.
    #[test]
    fn the_most_promising_come_in_turn() {
        let forms =
            [form(0, play(0.0)), form(0, play(1.0)), form(1, Shape::Constant), form(2, Shape::Constant)];
        let promises = [[90.0, 20.0], [50.0, 5.0], [8.0, 9.0], [30.0, 70.0]];
        let price = |_: &Form| 10.0;
        assert_eq!(most_promising(&forms, &promises, &price, (4, &|_| true)), [0, 3, 1]);
        assert_eq!(most_promising(&forms, &promises, &price, (1, &|_| true)), [0, 3]);
    }

    /// A play that winds up is no other name than the play; the constant of another motion is.
    #[test]
    fn one_term_of_a_motion_is_one_name() {
        let forms =
            [form(0, play(0.0)), form(0, play(1.0)), form(1, Shape::Constant), form(2, Shape::Constant)];
        assert_eq!(different(&forms, vec![1, 0, 3, 2]), [1, 3, 2]);
    }
}
