//! Revision: what was upheld, asked again one effect at a time.
//!
//! In: an upheld model that leaves more than noise. Out: the same with effects exchanged for others that say it better, and with
//! effects added, as long as all of them stand up. A search takes many effects at once, and a long list of small ones may imitate
//! a large one; what the judge leaves of such a list is right and not complete. Here every step is fitted, period and all, before
//! it is compared, and nothing is added that the judge would drop.

use crate::appraisal::Appraisal;
use crate::curves::cost;
use crate::design::{Design, Regressor};
use crate::engine::{self, all_residuals, courses};
use crate::fit::{self, Fit};
use crate::judge::{self, Tries};
use crate::kinship::Kin;
use crate::model::{Effect, Fitted, Model};
use crate::ranges::holds;
use crate::search::{price, rivals};
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;
use crate::travel::Travel;
use crate::waves::{self, WavePlace};

/// The most effects that are added.
const ADDED: usize = 6;
/// How many effects are fitted in the place of one, or beside all, of those that promise most.
const TRIED: usize = 4;

/// What a revision works with.
pub(crate) struct Revision<'r> {
    pub(crate) always: usize,
    pub(crate) pool: &'r [Kin],
    pub(crate) places: &'r [WavePlace],
    pub(crate) travels: &'r [Travel],
    pub(crate) tries: Tries,
}

impl Revision<'_> {
    /// Exchanges and adds effects until nothing is better.
    pub(crate) fn revised(
        &self,
        study: &mut Study<'_>,
        mut fit: Fit,
        mut appraisal: Appraisal,
    ) -> (Fit, Appraisal) {
        for _ in 0..ADDED {
            if !appraisal.lacks() {
                break;
            }
            let trials = self.trials(study, &fit, &appraisal);
            let Some(better) =
                trials.into_iter().find_map(|trial| self.stands(study, trial, &fit, &appraisal))
            else {
                break;
            };
            (fit, appraisal) = better;
            appraisal.mark(study);
        }
        (fit, appraisal)
    }

    /// A trial, fitted, where it costs less and all of it stands up.
    fn stands(
        &self,
        study: &mut Study<'_>,
        trial: Model,
        fit: &Fit,
        appraisal: &Appraisal,
    ) -> Option<(Fit, Appraisal)> {
        let fitted = fit::refine(study, trial, &appraisal.noises, self.travels);
        let costs = |fit: &Fit| cost(study, fit, self.always, self.tries);
        if costs(&fitted) >= costs(fit) {
            return None;
        }
        let (count, more) = (fitted.model.len(), fitted.model.len() > fit.model.len());
        let (kept, left) = judge::uphold(study, fitted, self.always, self.travels, self.tries);
        appraisal.mark(study);
        let stands = kept.model.len() == count && (!more || stands_apart(study, appraisal, &left));
        stands.then_some((kept, left))
    }

    /// Models with another effect in the place of one, and with one more, the most promising first.
    fn trials(&self, study: &Study<'_>, fit: &Fit, appraisal: &Appraisal) -> Vec<Model> {
        let model = &fit.model;
        let open = self.open(study, model, appraisal);
        let mut regressors: Vec<Regressor> =
            model.iter().map(|fitted| Regressor::of(fitted.effect.clone())).collect();
        regressors.extend(open.iter().cloned().map(Regressor::of));
        let mut design = Design::new(study, model, &appraisal.noises, regressors);
        design.rebase(model);
        let (products, samples) = design.fitted();
        let mut whole = Swept::new(&products);
        for column in (0..model.len()).flat_map(|number| design.columns(number)) {
            whole.take(column);
        }
        let scale = (whole.remaining() / samples.max(1.0)).max(f64::MIN_POSITIVE);
        let mut trials: Vec<(f64, Model)> = Vec::new();
        // A curve is made of what stood in for it: those are no better.
        let tabled = |number: &usize| matches!(model[*number].effect.shape, Shape::Table { .. });
        let places = std::iter::once(None)
            .chain((self.always..model.len()).filter(|number| !tabled(number)).map(Some));
        for place in places {
            let mut swept = whole.clone();
            let mut kept = model.clone();
            if let Some(number) = place {
                design.columns(number).for_each(|column| swept.drop(column));
                kept.remove(number);
            }
            let lost = (swept.remaining() - whole.remaining()) / scale;
            let spared = place.map_or(0.0, |number| self.price(study, &model[number].effect, samples));
            let mut gains: Vec<(f64, usize)> = (0..open.len())
                .filter(|number| !kept.iter().any(|known| against(&known.effect, &open[*number])))
                .map(|number| {
                    let columns: Vec<usize> = design.columns(model.len() + number).collect();
                    let gain = swept.promise(&columns).0 / scale - self.price(study, &open[number], samples);
                    (gain - lost + spared, number)
                })
                .collect();
            gains.sort_by(|a, b| b.0.total_cmp(&a.0));
            // One in the place of another may say less before it is fitted.
            let least = if place.is_some() { -LEEWAY } else { 0.0 };
            for (gain, number) in gains.into_iter().filter(|(gain, _)| *gain > least).take(TRIED) {
                let mut trial = kept.clone();
                let coefficients = vec![0.0; open[number].shape.columns()];
                trial.push(Fitted { effect: open[number].clone(), coefficients });
                trials.push((gain, trial));
            }
        }
        trials.sort_by(|a, b| b.0.total_cmp(&a.0));
        trials.into_iter().map(|(_, model)| model).take(2 * TRIED).collect()
    }

    fn price(&self, study: &Study<'_>, effect: &Effect, samples: f64) -> f64 {
        price(study, effect, samples, self.tries.candidates, self.tries.waves)
    }

    /// Effects that are not in the model: candidates, and waves of what it leaves.
    fn open(&self, study: &Study<'_>, model: &Model, appraisal: &Appraisal) -> Vec<Effect> {
        let courses = courses(study, model);
        let residuals = all_residuals(study, model, &appraisal.noises, &courses);
        let (peaks, _) = waves::peaks(study, model, &courses, &residuals, self.travels, self.places);
        let candidates = engine::regressors(study, model, self.always, self.pool, peaks);
        candidates.into_iter().skip(model.len()).map(|regressor| regressor.effect).collect()
    }
}

/// Whether an effect may not stand beside one of the model: it is the same in another form, or what a table leaves at its corners.
fn against(known: &Effect, effect: &Effect) -> bool {
    rivals(known, effect) || known.place == effect.place && holds(&known.shape, &effect.shape)
}

/// Whether an effect takes at least as much as what comes back without a name beside it: less may be a piece of that, as a wave is
/// of a dent.
pub(crate) fn stands_apart(study: &Study<'_>, without: &Appraisal, with: &Appraisal) -> bool {
    let (mut taken, mut returning) = (0.0, 0.0);
    for (scene, known) in study.scenes.iter().enumerate() {
        for channel in 0..known.channels.len() {
            let outliers = with.outliers[scene][channel].iter().zip(&without.outliers[scene][channel]);
            let [before, after] = [without, with].map(|one| &one.residuals[scene][channel]);
            let valid: Vec<bool> =
                outliers.zip(after).map(|((a, b), value)| !a && !b && value.is_finite()).collect();
            let size = with.leftover[scene][channel].max(f64::MIN_POSITIVE);
            let rows = || before.iter().zip(after).zip(&valid).filter(|(_, valid)| **valid);
            taken += rows().map(|((before, after), _)| before * before - after * after).sum::<f64>()
                / (size * size);
            returning += known.returns.most(after, &valid) / (size * size);
        }
    }
    taken > returning
}

/// By how much an effect in the place of another one may fall short before its own parameter is fitted: half of a grid's step.
const LEEWAY: f64 = 12.0;
