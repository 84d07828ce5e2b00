//! Revision: what was upheld, asked again one effect at a time.
//!
//! In: an upheld model that leaves more than noise. Out: the same with effects exchanged for others that say it better, and with
//! effects added, as long as all of them stand up. A search takes many effects at once, and a long list of small ones may imitate
//! a large one; what the judge leaves of such a list is right and not complete. Here every step is fitted, period and all, before
//! it is compared, and nothing is added that the judge would drop.

use crate::appraisal::Appraisal;
use crate::candidates::simplicity;
use crate::channel::ChannelAt;
use crate::conditions::Conditions;
use crate::course::courses;
use crate::design::{Design, Regressor};
use crate::engine::rounds::{highest, open_candidates};
use crate::fit::Fit;
use crate::harmonics;
use crate::judge;
use crate::kinship::Kin;
use crate::model::{Effect, Fitted, Model};
use crate::ranges::holds;
use crate::search::rivals;
use crate::study::Study;
use crate::sweep::{Swept, misfit};
use crate::terms::Shape;
use crate::unsteady::Band;
use crate::waves::{self, WavePlace};

/// The most effects that are added.
const ADDED: usize = 6;
/// How many effects are fitted in the place of one, or beside all, of those that promise most.
const TRIED: usize = 4;

/// What a revision works with.
pub(crate) struct Revision<'r> {
    pub(crate) pool: &'r [Kin],
    pub(crate) places: &'r [WavePlace],
    /// Effects that are not added: their own numbers spoke against them.
    pub(crate) refuted: &'r [Effect],
    /// Oscillations that are not steady. No vibration is added in one of them.
    pub(crate) bands: &'r [Band],
    pub(crate) conditions: Conditions<'r>,
}

impl Revision<'_> {
    /// Exchanges and adds effects until nothing is better.
    pub(crate) fn revised(&self, study: &Study<'_>, fit: Fit, appraisal: Appraisal) -> (Fit, Appraisal) {
        self.revised_to(study, (fit, appraisal), usize::MAX)
    }

    /// Exchanges effects until nothing is better.
    pub(crate) fn exchanged(&self, study: &Study<'_>, fit: Fit, appraisal: Appraisal) -> (Fit, Appraisal) {
        let count = fit.model.effects.len();
        self.revised_to(study, (fit, appraisal), count)
    }

    /// Exchanges effects for others of fewer parameters until nothing costs less, also where nothing is lacking: what was taken beside effects
    /// that did not stand up may bend or wind up more than is left to explain.
    pub(crate) fn simplified(&self, study: &Study<'_>, fit: Fit, appraisal: Appraisal) -> (Fit, Appraisal) {
        let mut stands = (fit, appraisal);
        while let Some(simpler) = self.simpler(study, (&stands.0, &stands.1)) {
            stands = simpler;
        }
        stands
    }

    /// A model with an effect of fewer parameters in the place of one, which costs less and is at least as simple a name.
    fn simpler(&self, study: &Study<'_>, stands: (&Fit, &Appraisal)) -> Option<(Fit, Appraisal)> {
        let names = |model: &Model| -> f64 {
            model.chosen().iter().map(|fitted| simplicity(study, &fitted.effect)).sum()
        };
        let (parameters_now, names_now) = (parameters(&stands.0.model), names(&stands.0.model));
        let is_simpler = |trial: &Model| parameters(trial) < parameters_now && names(trial) <= names_now;
        self.cheaper(study, stands, &is_simpler).find_map(|cheaper| self.upheld(study, cheaper, stands))
    }

    /// Exchanges effects, and adds some as long as there are no more than `most`, until nothing is better.
    fn revised_to(
        &self,
        study: &Study<'_>,
        (mut fit, mut appraisal): (Fit, Appraisal),
        most: usize,
    ) -> (Fit, Appraisal) {
        for _ in 0..ADDED {
            if !appraisal.lacks() {
                break;
            }
            let Some(better) = self.better(study, (&fit, &appraisal), most) else { break };
            (fit, appraisal) = better;
        }
        (fit, appraisal)
    }

    /// A model that is better by one effect, or by two together.
    fn better(&self, study: &Study<'_>, stands: (&Fit, &Appraisal), most: usize) -> Option<(Fit, Appraisal)> {
        let mut first = None;
        for cheaper in self.cheaper(study, stands, &at_most(most)) {
            if let Some(upheld) = self.upheld(study, cheaper.clone(), stands) {
                return Some(upheld);
            }
            first.get_or_insert(cheaper);
        }
        self.better_by_two(study, first?, stands, most)
    }

    /// A model with one effect more than one that does not stand up yet, in which all do, and which is better than what stands. A wave
    /// beside which another is still missing draws the periods of others, and so foretells held-out samples no better than they do without
    /// it.
    fn better_by_two(
        &self,
        study: &Study<'_>,
        first: Fit,
        stands: (&Fit, &Appraisal),
        most: usize,
    ) -> Option<(Fit, Appraisal)> {
        let appraisal = Appraisal::new(study, &first.model);
        let fit = self.conditions.under(&appraisal.weights).refine(study, first.model);
        let second = self.cheaper(study, (&fit, &appraisal), &at_most(most)).next()?;
        let upheld = self.upheld(study, second, (&fit, &appraisal))?;
        self.is_better(study, &upheld, stands).then_some(upheld)
    }

    /// The trials, of those that are `allowed`, that cost less than what stands once they are fitted, the most promising first.
    fn cheaper<'a>(
        &'a self,
        study: &'a Study<'a>,
        (fit, appraisal): (&'a Fit, &'a Appraisal),
        allowed: &dyn Fn(&Model) -> bool,
    ) -> impl Iterator<Item = Fit> + 'a {
        let conditions = self.conditions.under(&appraisal.weights);
        let prices = conditions.prices(study, &fit.model, fit.samples);
        let cost = conditions.cost_at(study, fit, &prices);
        let trials = self.trials(study, fit, &prices, appraisal, allowed);
        trials.into_iter().filter_map(move |trial| {
            let fitted = conditions.refine(study, trial.model);
            (conditions.cost_at(study, &fitted, &trial.prices) < cost).then_some(fitted)
        })
    }

    /// A fitted trial, where all of it stands up, or what stands up of it beside its new effect still costs less than what stood.
    fn upheld(
        &self,
        study: &Study<'_>,
        fitted: Fit,
        (fit, appraisal): (&Fit, &Appraisal),
    ) -> Option<(Fit, Appraisal)> {
        let count = fitted.model.effects.len();
        let new = fitted.model.effects.last()?.effect.clone();
        let more = count > fit.model.effects.len();
        let (kept, left) = judge::uphold(study, fitted, &self.conditions);
        let has_new = kept.model.effects.last().is_some_and(|last| rivals(&last.effect, &new));
        let stands = (kept.model.effects.len() == count
            || has_new && self.costs_less(study, &kept.model, (fit, appraisal)))
            && (!more || self.stands_apart_together(study, &kept.model, (appraisal, &left)));
        stands.then_some((kept, left))
    }

    /// Whether a model costs less than what stands, and foretells held-out samples better.
    fn is_better(
        &self,
        study: &Study<'_>,
        (fit, with): &(Fit, Appraisal),
        stands: (&Fit, &Appraisal),
    ) -> bool {
        let without = Appraisal::beside(study, &stands.0.model, with);
        with.held_out(study, with) < without.held_out(study, with)
            && self.costs_less(study, &fit.model, stands)
    }

    /// Whether a model costs less than what stands.
    fn costs_less(&self, study: &Study<'_>, model: &Model, (fit, appraisal): (&Fit, &Appraisal)) -> bool {
        let conditions = self.conditions.under(&appraisal.weights);
        let cost =
            |fit: &Fit| conditions.cost_at(study, fit, &conditions.prices(study, &fit.model, fit.samples));
        cost(&conditions.refine(study, model.clone())) < cost(fit)
    }

    /// Whether the last effect of a model stands apart, or the harmonics of a wave do together of which it is one. `without` and `with` are
    /// the appraisals without it and with it.
    fn stands_apart_together(
        &self,
        study: &Study<'_>,
        model: &Model,
        (without, with): (&Appraisal, &Appraisal),
    ) -> bool {
        if stands_apart(study, without, with) {
            return true;
        }
        let together = harmonics::together(model, model.effects.len() - 1);
        together.len() > 1 && {
            let rest = self.conditions.under(&with.weights).refine(study, model.without_all(&together));
            stands_apart(study, &Appraisal::beside(study, &rest.model, with), with)
        }
    }

    /// Models with another effect in the place of one, and with one more, of those that are `allowed`, the most promising first.
    fn trials(
        &self,
        study: &Study<'_>,
        fit: &Fit,
        prices: &[f64],
        appraisal: &Appraisal,
        allowed: &dyn Fn(&Model) -> bool,
    ) -> Vec<Trial> {
        let model = &fit.model;
        let open = self.open(study, model, appraisal, fit.samples);
        let mut regressors = Regressor::all(&model.effects);
        regressors.extend(open.iter().map(|open| Regressor::of(open.effect.clone())));
        let mut design = Design::new(study, model, &appraisal.weights, regressors);
        design.rebase(&model.effects);
        let (products, samples) = design.fitted();
        let mut whole = Swept::new(&products);
        for column in (0..model.effects.len()).flat_map(|number| design.columns(number)) {
            whole.take(column);
        }
        let mut trials: Vec<Trial> = Vec::new();
        // A curve is made of what stood in for it: those are no better.
        let tabled = |number: &usize| matches!(model.effects[*number].effect.shape, Shape::Table { .. });
        let places =
            std::iter::once(None).chain(model.chosen_numbers().filter(|number| !tabled(number)).map(Some));
        for place in places {
            let mut swept = whole.clone();
            let (mut kept, mut prices) = (model.clone(), prices.to_vec());
            let mut spared = 0.0;
            if let Some(number) = place {
                design.columns(number).for_each(|column| swept.drop(column));
                kept = kept.without(number);
                spared = prices.remove(number);
            }
            let mut gains: Vec<(f64, usize)> = (0..open.len())
                .filter(|number| {
                    !kept.effects.iter().any(|known| against(&known.effect, &open[*number].effect))
                })
                .map(|number| {
                    let columns: Vec<usize> = design.columns(model.effects.len() + number).collect();
                    let left = swept.remaining() - swept.promise(&columns).0;
                    let gain = misfit(whole.remaining(), samples) - misfit(left, samples);
                    (gain - open[number].price + spared, number)
                })
                .collect();
            gains.sort_by(|a, b| b.0.total_cmp(&a.0));
            // One in the place of another may say less before it is fitted.
            let least = if place.is_some() { -LEEWAY } else { 0.0 };
            let promising = gains.into_iter().filter(|(gain, _)| *gain > least).map(|(gain, number)| {
                let model = kept.with(Fitted::unfitted(open[number].effect.clone()));
                let prices = prices.iter().copied().chain([open[number].price]).collect();
                Trial { model, prices, gain }
            });
            trials.extend(promising.filter(|trial| allowed(&trial.model)).take(TRIED));
        }
        trials.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        trials.truncate(2 * TRIED);
        trials
    }

    /// Effects that are not in the model: candidates, and waves of what it leaves.
    fn open(&self, study: &Study<'_>, model: &Model, appraisal: &Appraisal, samples: f64) -> Vec<Open> {
        let conditions = self.conditions.under(&appraisal.weights);
        let courses = courses(study, model);
        let residuals = waves::all_weighted(study, model, &appraisal.weights, &courses);
        let (peaks, _) = waves::peaks(study, model, &courses, &residuals, conditions.travels, self.places);
        let candidates = open_candidates(model.chosen(), self.pool);
        let candidates = candidates
            .into_iter()
            .chain(harmonics::open(study, model, conditions.travels))
            .map(|effect| Open { price: conditions.price(study, &effect, samples), effect });
        let waves = highest(study, peaks);
        let waves = waves
            .into_iter()
            .map(|peak| Open { price: conditions.price_of_peak(study, &peak, samples), effect: peak.effect });
        candidates.chain(waves).filter(|open| !self.is_denied(&open.effect)).collect()
    }

    /// Whether an effect may not be added.
    fn is_denied(&self, effect: &Effect) -> bool {
        self.refuted.iter().any(|known| rivals(known, effect))
            || self.bands.iter().any(|band| band.has(effect))
    }
}

/// An effect that is not in the model, and its price.
struct Open {
    effect: Effect,
    price: f64,
}

/// A model to try, the prices of its effects, and what it promises.
struct Trial {
    model: Model,
    prices: Vec<f64>,
    gain: f64,
}

/// The test whether a model has at most this many effects.
fn at_most(effects: usize) -> impl Fn(&Model) -> bool {
    move |trial| trial.effects.len() <= effects
}

/// How many numbers of a model are fitted or searched for.
fn parameters(model: &Model) -> usize {
    model.effects.iter().map(|fitted| fitted.effect.shape.parameters()).sum()
}

/// Whether an effect may not stand beside one of the model: it is the same in another form, or what a table leaves at its corners.
fn against(known: &Effect, effect: &Effect) -> bool {
    rivals(known, effect) || known.place == effect.place && holds(&known.shape, &effect.shape)
}

/// Whether an effect takes at least as much as what comes back without a name beside it: less may be a piece of that, as a wave is
/// of a dent. Only the channels that show the effect count.
pub(crate) fn stands_apart(study: &Study<'_>, without: &Appraisal, with: &Appraisal) -> bool {
    // Of each channel, in units of what is left: the energy of the effect, and by how much it takes more than what comes back.
    let of_channel = |at: ChannelAt| -> (f64, f64) {
        let ChannelAt { scene, channel } = at;
        let [one, other] = [with, without].map(|one| one.weights.outliers.of(at));
        let [before, after] = [without, with].map(|one| &one.residuals[scene][channel]);
        let valid: Vec<bool> =
            one.iter().zip(other).zip(after).map(|((a, b), value)| !a && !b && value.is_finite()).collect();
        let rows = || before.iter().zip(after).zip(&valid).filter(|(_, valid)| **valid);
        let energy: f64 = rows().map(|((before, after), _)| (before - after).powi(2)).sum();
        let taken: f64 = rows().map(|((before, after), _)| before * before - after * after).sum();
        let returning = study.scenes[scene].returns.most(after, &valid);
        let size = with.leftover[scene][channel].max(f64::MIN_POSITIVE);
        (energy / (size * size), (taken - returning) / (size * size))
    };
    let channels: Vec<(f64, f64)> = study.channels().map(of_channel).collect();
    let energy = channels.iter().map(|(energy, _)| energy).sum();
    let shown = channels.iter().filter(|(own, _)| judge::shows(*own, energy));
    shown.map(|(_, more)| more).sum::<f64>() > 0.0
}

/// By how much an effect in the place of another one may fall short before its own parameter is fitted: half of a grid's step.
const LEEWAY: f64 = 12.0;

#[cfg(test)]
mod tests;
