//! The engine: from a study to the model that explains its recordings.
//!
//! In: a study. Out: effects with coefficients, the noise of every channel, and what was tried. It goes round: residual,
//! noise, waves, design, choice, fit; every round starts the choice afresh with a better idea of the noise, so that nothing
//! chosen early has to stay. At the end the judge drops what does not stand up.

use std::sync::Arc;

use crate::appraisal::Appraisal;
use crate::candidates;
use crate::conditions::{Conditions, Tries};
use crate::course::Course;
use crate::crossing;
use crate::curves;
use crate::dents::{self, Dent};
use crate::design::{Design, Regressor};
use crate::dynamics;
use crate::fit::{self, Fit};
use crate::harmonics;
use crate::judge;
use crate::kinship::{self, Kin};
use crate::model::{Effect, Fitted, Model};
use crate::noise::{self, Noise};
use crate::observations;
use crate::ranges::{Resolution, limit};
use crate::revise::Revision;
use crate::search::{Choice, rivals};
use crate::side::Side;
use crate::study::Study;
use crate::terms::Shape;
use crate::travel::{self, Travel};
use crate::unsteady::{self, Band};
use crate::waves::{self, WavePlace};
use crate::weights::{Outliers, Weights};

/// The most rounds.
const ROUNDS: usize = 6;
/// How many waves are added to the candidates in a round by what they gain, and as many by what they gain at their own noise: the
/// one is right where the noise is known, the other where it is not yet.
const WAVES: usize = 4;

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
    search.go_round(study, progress);
    search.cross_plays(study, progress);
    let mut fit = search.fit(study);
    if let Some(loops) = dynamics::loops_alone(study, &fit.model, &search.conditions()) {
        (search, fit) = begun_anew(study, (search, fit), Start { model: loops, dent: None }, progress);
    }
    let plain = (search, fit);
    let (other, dent) = beside_dents(study, plain.clone(), progress);
    let (mut search, mut fit, mut appraisal) = judged(study, other, progress);
    if dent.is_some_and(|dent| !dent.is_in(&fit.model, &search.travels)) {
        (search, fit, appraisal) = judged(study, plain, progress);
    }
    let Search { pool, travels, tries, richer, weights, .. } = search;
    let conditions = Conditions { weights: &weights, travels: &travels, tries };
    let revision = Revision { pool: &pool, places: &places, refuted: &[], bands: &[], conditions };
    for model in richer {
        if fit.model.chosen().is_empty() && appraisal.lacks() {
            (fit, appraisal) = better(study, (fit, appraisal), model, &revision);
        }
    }
    (fit, appraisal) = revision.revised(study, fit, appraisal);
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
        search.go_round(study, progress);
        search.cross_plays(study, progress);
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
    end.go_round(study, progress);
    end.cross_plays(study, progress);
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
    let model = model.crossed_as(&stands.0.model);
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

/// A search on its way.
#[derive(Clone)]
struct Search {
    model: Model,
    /// Models of earlier rounds with more effects than a later one. Where much is left, a round that takes an effect less leaves more
    /// to the noise, and the next takes less still: so a search can run down to nothing past what would have stood up.
    richer: Vec<Model>,
    weights: Weights,
    courses: Vec<Arc<Course>>,
    travels: Vec<Travel>,
    pool: Vec<Kin>,
    places: Vec<WavePlace>,
    tries: Tries,
}

impl Search {
    fn new(study: &Study<'_>, settings: Vec<Effect>, outliers: Outliers) -> Self {
        let model = Model::of_settings(settings);
        let courses = courses(study, &model);
        let travels = travel::travels(study, &courses);
        let noises = first_noises(study, &model, &courses);
        let pool = candidates::candidates(study, &travels);
        let pool = kinship::groups(study, &courses, &noises, pool);
        let places = waves::places(study, &courses, &noises, &travels);
        let tries = Tries { candidates: crate::number(pool.len() + 2 * WAVES), waves: 1.0 };
        Self {
            model,
            richer: Vec::new(),
            weights: Weights { noises, outliers },
            courses,
            travels,
            pool,
            places,
            tries,
        }
    }

    /// Begins anew with a model. Its plays act at once, as at the beginning of every search.
    fn begin(&mut self, study: &Study<'_>, model: Model) {
        let model = model.uncrossed();
        self.weights = Appraisal::new(study, &model).weights;
        self.courses = courses(study, &model);
        self.model = model;
    }

    /// Keeps the first `settings` effects as settings, which are always fitted. All others pay the BIC penalty from here on.
    fn price_all_but(&mut self, settings: usize) {
        self.model = std::mem::take(&mut self.model).with_settings(settings);
        for model in &mut self.richer {
            *model = std::mem::take(model).with_settings(settings);
        }
    }

    /// Whether its end costs less than that of another search: minus twice the likelihood, and the prices. It must under the weights that
    /// either end gives to the samples: under those of an end that lacks something fewer samples count.
    fn ends_better(&self, study: &Study<'_>, end: &Fit, (other, of_other): (&Self, &Fit)) -> bool {
        let [ours, theirs] = [end, of_other].map(|fit| Appraisal::new(study, &fit.model));
        let price = self.paid(study, end, &ours) - other.paid(study, of_other, &theirs);
        let under_theirs = Appraisal::beside(study, &end.model, &theirs).deviance - theirs.deviance;
        let under_ours = ours.deviance - Appraisal::beside(study, &of_other.model, &ours).deviance;
        under_theirs + price < 0.0 && under_ours + price < 0.0
    }

    /// The prices of all effects of its end.
    fn paid(&self, study: &Study<'_>, end: &Fit, appraisal: &Appraisal) -> f64 {
        let conditions = self.conditions();
        let conditions = conditions.under(&appraisal.weights);
        conditions.cost(study, end) - conditions.cost_at(study, end, &vec![0.0; end.model.effects.len()])
    }

    /// The conditions of the present round.
    fn conditions(&self) -> Conditions<'_> {
        Conditions { weights: &self.weights, travels: &self.travels, tries: self.tries }
    }

    /// Chooses anew, with a better idea of the noise each time, until nothing changes.
    fn go_round(&mut self, study: &Study<'_>, progress: &mut dyn FnMut(f64)) {
        for round in 0..ROUNDS {
            progress(crate::number(round + 1) / crate::number(ROUNDS + 2));
            let next = self.choose(study);
            let fit = self.conditions().refine(study, next);
            let mut next = harmonics::try_harmonics(study, fit, &self.conditions()).model;
            let mut settled = same_effects(&self.model, &next);
            if settled || round + 1 == ROUNDS {
                next = dynamics::try_loops(study, next, &self.conditions());
                next = dynamics::try_drives(study, next, &self.conditions());
                settled = same_effects(&self.model, &next);
            } else if round > 0 && dynamics::may_answer(&next) {
                // Not in a first round, whose choice serves to know the noise: at the very first, all of it is taken as white.
                next = dynamics::try_drives(study, next, &self.conditions());
            }
            if next.effects.len() < self.model.effects.len() {
                self.richer.push(self.model.clone());
            }
            self.model = next;
            self.courses = courses(study, &self.model);
            let known = std::mem::replace(&mut self.weights, Appraisal::new(study, &self.model).weights);
            let quiet = same_noises(&known.noises, &self.weights.noises);
            if settled && quiet && round > 0 {
                break;
            }
        }
    }

    /// Lets axes cross their plays where that says as much as what seems to hold them after reversals, and goes on from there.
    fn cross_plays(&mut self, study: &Study<'_>, progress: &mut dyn FnMut(f64)) {
        let Some(crossed) = crossing::try_plays(study, &self.model, &self.conditions()) else { return };
        self.model = crossed;
        for _ in 0..ROUNDS {
            self.courses = courses(study, &self.model);
            self.go_round(study, progress);
            if !crossing::follow(study, &mut self.model) {
                break;
            }
        }
    }

    /// The best set of effects under the present noise, by linear least squares.
    fn choose(&mut self, study: &Study<'_>) -> Model {
        let residuals = waves::all_weighted(study, &self.model, &self.weights, &self.courses);
        let (mut peaks, waves) =
            waves::peaks(study, &self.model, &self.courses, &residuals, &self.travels, &self.places);
        self.tries.waves = self.tries.waves.max(waves);
        let mut others = other_peaks(study, &self.model, &self.conditions());
        let resolution = Resolution::new(study, &self.travels);
        peaks.retain(|peak| !harmonics::stands_for(&self.model, &resolution, &peak.effect));
        others.retain(|other| !harmonics::stands_for(&self.model, &resolution, &other.effect));
        // One course of states at a time is enough for the memory.
        drop((std::mem::take(&mut self.courses), residuals));
        let mut regressors = regressors(study, &self.model, &self.pool, &self.travels, peaks);
        regressors.extend(others);
        let mut design = Design::new(study, &self.model, &self.weights, regressors);
        design.rebase(&self.model.effects);
        let (products, samples) = design.fitted();
        let settings = self.model.settings().len();
        let waves = self.tries.waves;
        let choice =
            Choice::new(study, &design, products.clone(), samples, settings, waves, resolution).best();
        self.model.with_effects(fit::linear(&design, &products, settings, &choice))
    }

    /// Fits the model; what has run to the end of its range becomes what it is there.
    fn fit(&self, study: &Study<'_>) -> Fit {
        let mut fit = self.conditions().refine(study, self.model.clone());
        let mut effects: Vec<Fitted> = Vec::new();
        for fitted in &fit.model.effects {
            let mut fitted = fitted.clone();
            if let Some(limit) = limit(study, &self.travels, &fitted.effect.shape) {
                fitted.effect.shape = limit;
            }
            // At its end it may have become one that stands there already.
            if !effects.iter().any(|known| known.effect == fitted.effect) {
                effects.push(fitted);
            }
        }
        let model = fit.model.with_effects(effects);
        if !same_effects(&model, &fit.model) {
            fit = self.conditions().refine(study, model);
        }
        fit
    }
}

/// For each wave of the model, when it is taken out: the peak of its own line, and the highest peak beside it. Runs with long pauses
/// between them give every wave neighbours of nearly its height, and a first fit may stand on one of them.
fn other_peaks(study: &Study<'_>, model: &Model, conditions: &Conditions<'_>) -> Vec<Regressor> {
    let mut regressors = Vec::new();
    for (number, fitted) in
        model.effects.iter().enumerate().filter(|(_, fitted)| fitted.effect.shape.is_wave())
    {
        let mut peaks = waves::around(study, model, number, conditions.weights, conditions.travels);
        peaks.retain(|peak| rivals(&peak.effect, &fitted.effect) && peak.effect != fitted.effect);
        peaks.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        // Its own line as the spectrum has it now, and the highest of the others.
        let own =
            |peak: &&waves::Peak| waves::same_line(study, &peak.effect, &fitted.effect, conditions.travels);
        let highest = peaks.iter().find(own).into_iter().chain(peaks.iter().find(|peak| !own(peak)));
        regressors.extend(highest.map(|peak| Regressor::of(peak.effect.clone())));
    }
    regressors
}

pub(crate) fn courses(study: &Study<'_>, model: &Model) -> Vec<Arc<Course>> {
    (0..study.scenes.len()).map(|scene| Course::new(study, scene, model)).collect()
}

/// White noise of the size of the differences from row to row.
fn first_noises(study: &Study<'_>, model: &Model, courses: &[Arc<Course>]) -> Vec<Vec<Noise>> {
    let each = courses.iter().enumerate();
    each.map(|(scene, course)| {
        let residuals = observations::residuals(study, scene, model, course);
        let channels = residuals.iter().zip(&study.scenes[scene].channels);
        channels
            .map(|(residual, channel)| {
                let white = noise::from_differences(residual).max(channel.rounding);
                Noise::white(white)
            })
            .collect()
    })
    .collect()
}

/// The effects of the present model as they stand, the candidates, and waves.
fn regressors(
    study: &Study<'_>,
    model: &Model,
    pool: &[Kin],
    travels: &[Travel],
    peaks: Vec<waves::Peak>,
) -> Vec<Regressor> {
    let mut effects: Vec<Effect> = model.effects.iter().map(|fitted| fitted.effect.clone()).collect();
    effects.extend(open_candidates(model.chosen(), pool));
    effects.extend(harmonics::open(study, model, travels));
    effects.extend(highest(study, peaks).into_iter().map(|peak| peak.effect));
    effects.into_iter().map(Regressor::of).collect()
}

/// The candidates that are not chosen already.
pub(crate) fn open_candidates(chosen: &[Fitted], pool: &[Kin]) -> Vec<Effect> {
    let lags = |shape: &Shape| matches!(shape, Shape::Lag { .. });
    let stands = |effect: &Effect, known: &Effect| {
        known == effect || (known.place == effect.place && lags(&known.shape) && lags(&effect.shape))
    };
    let candidates = pool.iter().map(|kin| &kin.effect);
    candidates.filter(|effect| !chosen.iter().any(|known| stands(effect, &known.effect))).cloned().collect()
}

/// The waves to try: the highest by what they gain, and by what they gain at their own noise.
pub(crate) fn highest(study: &Study<'_>, mut peaks: Vec<waves::Peak>) -> Vec<waves::Peak> {
    let simplicity = |peak: &waves::Peak| candidates::simplicity(study, &peak.effect);
    let mut highest: Vec<waves::Peak> = Vec::new();
    for measure in [|peak: &waves::Peak| peak.gain, |peak: &waves::Peak| peak.local] {
        peaks.sort_by(|a, b| measure(b).total_cmp(&measure(a)).then(simplicity(a).total_cmp(&simplicity(b))));
        let most = highest.len() + WAVES;
        for peak in &peaks {
            if highest.len() < most && !highest.iter().any(|known| rivals(&known.effect, &peak.effect)) {
                highest.push(peak.clone());
            }
        }
    }
    highest
}

fn same_effects(a: &Model, b: &Model) -> bool {
    let inert = |fitted: &Fitted| matches!(fitted.effect.shape, Shape::Lag { inertia, .. } if inertia > 0.0);
    let answered = |fitted: &Fitted| fitted.effect.side().and_then(Side::answered_by);
    let alike = |a: &Fitted, b: &Fitted| inert(a) == inert(b) && answered(a) == answered(b);
    let kind = |a: &Fitted, b: &Fitted| a.effect == b.effect || (rivals(&a.effect, &b.effect) && alike(a, b));
    let (a, b) = (&a.effects, &b.effects);
    a.len() == b.len() && a.iter().all(|member| b.iter().any(|other| kind(member, other)))
}

fn same_noises(a: &[Vec<Noise>], b: &[Vec<Noise>]) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 0.03 * (a.abs() + b.abs());
    let alike = |(a, b): (&Noise, &Noise)| {
        let slow = near(a.time_constant.ln(), b.time_constant.ln());
        near(a.white, b.white) && near(a.wander, b.wander) && (a.wander < 0.1 * a.white || slow)
    };
    a.iter().flatten().zip(b.iter().flatten()).all(alike)
}
