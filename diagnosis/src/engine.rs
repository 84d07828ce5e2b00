//! The engine: from a study to the model that explains its recordings.
//!
//! In: a study. Out: effects with coefficients, the noise of every channel, and what was tried. A search goes round until nothing
//! changes. It begins anew beside what may have hidden the rest: a loop, or a dent. At its end the judge drops what does not stand up,
//! and a revision asks what is left one effect at a time.

pub(crate) mod rounds;

use crate::appraisal::Appraisal;
use crate::conditions::{Conditions, Tries};
use crate::crossing;
use crate::curves;
use crate::dents::{self, Dent};
use crate::dynamics;
use crate::fit::Fit;
use crate::heat;
use crate::judge;
use crate::kinship::Kin;
use crate::model::{Effect, Fitted, Model};
use crate::revise::Revision;
use crate::search::rivals;
use crate::side::Side;
use crate::study::Study;
use crate::terms::Shape;
use crate::travel::Travel;
use crate::unsteady::{self, Band};
use crate::waves::WavePlace;
use crate::weights::Outliers;
use rounds::{ROUNDS, Search};

/// What the engine found.
#[derive(Clone)]
pub(crate) struct Found {
    pub(crate) fit: Fit,
    pub(crate) appraisal: Appraisal,
    pub(crate) pool: Vec<Kin>,
    pub(crate) travels: Vec<Travel>,
    pub(crate) places: Vec<WavePlace>,
    /// Oscillations that are not steady, and not in the model.
    pub(crate) bands: Vec<Band>,
    pub(crate) tries: Tries,
    /// Whether the settings are fitted to each row for itself, and not as a noise that wanders lets them.
    pub(crate) plain_zeros: bool,
}

impl Found {
    /// Whether the model holds more than the settings that are fitted whatever else is.
    pub(crate) fn claims(&self) -> bool {
        !self.fit.model.chosen().is_empty()
    }

    /// The conditions under which its model stands.
    pub(crate) fn conditions(&self) -> Conditions<'_> {
        let weights = &self.appraisal.weights;
        Conditions { weights, travels: &self.travels, tries: self.tries }
    }

    /// Revises the model after an effect was dropped. None of the `refuted` effects is added again.
    pub(crate) fn replace(&mut self, study: &Study<'_>, refuted: &[Effect]) {
        let Self { pool, places, bands, .. } = &*self;
        let revision = Revision { pool, places, refuted, bands, conditions: self.conditions() };
        let (fit, appraisal) = revision.revised(study, self.fit.clone(), self.appraisal.clone());
        (self.fit, self.appraisal) = (fit, appraisal);
    }
}

/// Looks for the model. `settings` are fitted whatever else is; `outliers` are the samples that are left out until
/// there is a first model.
pub(crate) fn find(
    study: &Study<'_>,
    settings: Vec<Effect>,
    outliers: Outliers,
    progress: &mut dyn FnMut(f64),
) -> Found {
    let mut search = Search::new(study, settings, outliers);
    let places = search.places.clone();
    search.search(study, progress);
    let mut fit = search.fit(study);
    if let Some(loops) = dynamics::loops_alone(study, &fit.model, &search.conditions()) {
        (search, fit) = begun_anew(study, (search, fit), Start { model: loops, dent: None }, progress);
    }
    let growths = heat::growths_alone(study, &fit.model, &search.pool, &search.conditions());
    if let Some(growths) = growths.filter(|growths| !same_effects(growths, &fit.model)) {
        (search, fit) = begun_anew(study, (search, fit), Start { model: growths, dent: None }, progress);
    }
    let plain = (search, fit);
    let (other, dent) = beside_dents(study, plain.clone(), progress);
    let (mut search, mut fit, mut appraisal) = judged(study, other, progress);
    if dent.is_some_and(|dent| !dent.is_in(&fit.model, &search.travels)) {
        (search, fit, appraisal) = judged(study, plain, progress);
    }
    told(study, (search, fit, appraisal), places)
}

/// What a search finds beside the events of a model. They stay in the model while the search goes on; at its end they are priced like all
/// others.
pub(crate) fn beside_events(study: &Study<'_>, found: &Found) -> Found {
    let model = &found.fit.model;
    let settings = model.settings().len();
    let start = model.keeping(|fitted| fitted.effect.shape.is_event());
    let held = start.effects.len();
    let mut search = Search::beside(study, found, start.with_settings(held));
    let progress: &mut dyn FnMut(f64) = &mut |_| ();
    search.search(study, progress);
    search.price_all_but(settings);
    let fit = search.fit(study);
    told(study, judged(study, (search, fit), progress), found.places.clone())
}

/// What is told of the end of a search: revised, without what only imitates something that has no name.
fn told(
    study: &Study<'_>,
    (search, mut fit, mut appraisal): (Search, Fit, Appraisal),
    places: Vec<WavePlace>,
) -> Found {
    let Search { pool, travels, tries, richer, weights, .. } = search;
    let conditions = Conditions { weights: &weights, travels: &travels, tries };
    let revision = Revision { pool: &pool, places: &places, refuted: &[], bands: &[], conditions };
    for model in richer {
        if fit.model.chosen().is_empty() && appraisal.lacks() {
            (fit, appraisal) = better(study, (fit, appraisal), model, &revision);
        }
    }
    (fit, appraisal) = revision.revised(study, fit, appraisal);
    (fit, appraisal) = revision.simplified(study, fit, appraisal);
    while let Some(model) = curves::without_combs(&fit.model) {
        let rest = conditions.under(&appraisal.weights).refine(study, model);
        (fit, appraisal) = upheld(study, rest, &conditions);
    }
    let bands = unsteady::take_bands(&mut fit.model);
    if !bands.is_empty() {
        let steady = conditions.under(&appraisal.weights).refine(study, fit.model);
        (fit, appraisal) = upheld(study, steady, &conditions);
    }
    Found { fit, appraisal, pool, travels, places, bands, tries, plain_zeros: false }
}

/// What of the end of a search is upheld, tables in the place of what imitates them.
fn judged(
    study: &Study<'_>,
    (mut search, mut fit): (Search, Fit),
    progress: &mut dyn FnMut(f64),
) -> (Search, Fit, Appraisal) {
    let curved = curves::try_tables(study, fit.clone(), &search.conditions());
    if same_effects(&curved.model, &fit.model) {
        fit = curved;
    } else {
        // Beside a curve, what stood in for its bends may look different. What it leaves at its corners is no new wave.
        search.model = curved.model;
        search.places.clear();
        search.search(study, progress);
        fit = search.fit(study);
    }
    let (fit, appraisal) = upheld(study, fit, &search.conditions());
    (search, fit, appraisal)
}

/// What a search begins anew with: settings and loops; or a table over a dent behind the settings, and what stood beside it.
struct Start {
    model: Model,
    dent: Option<Dent>,
}

/// A search that begins with another model, where it comes to a better end than the one that did not. A dent stays in the model while
/// the search goes on; at its end it is priced like all others.
fn begun_anew(
    study: &Study<'_>,
    (search, fit): (Search, Fit),
    Start { model, dent }: Start,
    progress: &mut dyn FnMut(f64),
) -> (Search, Fit) {
    let settings = model.settings().len();
    let mut start = search.clone();
    start.begin(study, model.with_settings(settings + usize::from(dent.is_some())));
    let mut end = start.clone();
    end.search(study, progress);
    let ended = |mut search: Search| {
        search.price_all_but(settings);
        let fit = search.fit(study);
        let fit = match &dent {
            Some(dent) => dent.drawn(study, fit, &search.conditions()),
            None => fit,
        };
        (search, fit)
    };
    let mut other = ended(end);
    if dent.is_some() {
        let start = ended(start);
        if start.0.ends_better(study, &start.1, (&other.0, &other.1)) {
            other = start;
        }
    }
    if other.0.ends_better(study, &other.1, (&search, &fit)) {
        return other;
    }
    (search, fit)
}

/// A search that began with a dent and what it was seen beside, where it came to a better end and the dent is in it.
fn beside_dents(
    study: &Study<'_>,
    (mut search, mut fit): (Search, Fit),
    progress: &mut dyn FnMut(f64),
) -> ((Search, Fit), Option<Dent>) {
    let mut taken = None;
    for (dent, beside) in dents::hidden(study, &fit.model, &search.conditions()) {
        let Some(model) = dent.added(study, &beside, &search.conditions()) else { continue };
        let known = (search.clone(), fit.clone());
        let start = Start { model, dent: Some(dent.clone()) };
        (search, fit) = begun_anew(study, (search, fit), start, progress);
        if dent.takes_much(study, &fit.model, &search.conditions()) {
            taken = Some(dent);
        } else {
            (search, fit) = known;
        }
    }
    ((search, fit), taken)
}

/// What the judge upholds. A play that it drops is no longer crossed, and one that the rest is fitted to anew is crossed over
/// its new length; what stands up beside that is asked again.
pub(crate) fn upheld(study: &Study<'_>, mut fit: Fit, conditions: &Conditions<'_>) -> (Fit, Appraisal) {
    for _ in 0..ROUNDS {
        let (mut kept, appraisal) = judge::uphold(study, fit, conditions);
        if !crossing::follow(study, &mut kept.model) {
            return (kept, appraisal);
        }
        fit = conditions.under(&appraisal.weights).refine(study, kept.model);
    }
    judge::uphold(study, fit, conditions)
}

/// What the judge upholds of another model, its effects exchanged for better ones, where that is better than what stands: it costs
/// less under the noise that it leaves itself, held-out samples lie nearer to it, and a wandering noise does not explain as much. A
/// walk draws curves and waves together as well as each of them alone. Nothing is added: a few waves draw any place together.
fn better(
    study: &Study<'_>,
    stands: (Fit, Appraisal),
    model: Model,
    revision: &Revision<'_>,
) -> (Fit, Appraisal) {
    let conditions = &revision.conditions;
    let model = model.moving_as(&stands.0.model);
    let weights = Appraisal::new(study, &model).weights;
    let other = conditions.under(&weights).refine(study, model);
    let kept = upheld(study, other, conditions);
    let other = revision.exchanged(study, kept.0, kept.1);
    let conditions = conditions.under(&other.1.weights);
    let new = conditions.prices(study, &other.0.model, other.0.samples);
    let taken = taken_from_walk(study, &stands.1, &other);
    let gains = taken > new[other.0.model.chosen_numbers()].iter().sum()
        && other.1.held_out(study, &other.1) < stands.1.held_out(study, &other.1);
    let new = conditions.cost_at(study, &other.0, &new);
    let old = conditions.refine(study, stands.0.model.clone());
    let old = conditions.cost_at(study, &old, &conditions.prices(study, &old.model, old.samples));
    if gains && new < old {
        return other;
    }
    stands
}

/// What the effects of another model take from minus twice the log-likelihood of a noise that wanders. The fit of greatest likelihood
/// under that noise would take more: the one figure keeps the coefficients, the other the noise. Waves keep their coefficients.
fn taken_from_walk(study: &Study<'_>, stands: &Appraisal, other: &(Fit, Appraisal)) -> f64 {
    let (Fit { model, .. }, appraisal) = other;
    let as_fitted = stands.wandering - appraisal.wandering;
    if model.effects.iter().any(|fitted| fitted.effect.shape.is_wave()) {
        return as_fitted;
    }
    let effects: Vec<usize> = model.chosen_numbers().collect();
    let floors = appraisal.weights.beside(stands.floors.clone());
    as_fitted.max(judge::worth_in(study, model, &floors, &effects))
}

/// Whether two models have effects of the same kinds at the same places, and axes that are driven alike.
fn same_effects(a: &Model, b: &Model) -> bool {
    let inert = |fitted: &Fitted| matches!(fitted.effect.shape, Shape::Lag { inertia, .. } if inertia > 0.0);
    let answered = |fitted: &Fitted| fitted.effect.side().and_then(Side::answered_by);
    let alike = |a: &Fitted, b: &Fitted| inert(a) == inert(b) && answered(a) == answered(b);
    let kind = |a: &Fitted, b: &Fitted| a.effect == b.effect || (rivals(&a.effect, &b.effect) && alike(a, b));
    let driven = a.is_driven_as(b);
    let (a, b) = (&a.effects, &b.effects);
    driven && a.len() == b.len() && a.iter().all(|member| b.iter().any(|other| kind(member, other)))
}
