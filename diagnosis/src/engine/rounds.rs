//! The rounds of a search: from a model to the effects that explain what it leaves.
//!
//! In: a study, and a model to begin with. Out: the model at which the rounds end. Each round estimates the noise and the waves of what
//! the model before leaves, and chooses all effects anew, so that nothing chosen early has to stay.

use std::sync::Arc;

use super::{Found, same_effects};
use crate::appraisal::Appraisal;
use crate::candidates;
use crate::conditions::{Conditions, Tries};
use crate::course::{Course, courses};
use crate::crossing;
use crate::design::{Design, Regressor};
use crate::dynamics;
use crate::fit::{self, Fit};
use crate::harmonics;
use crate::kinship::{self, Kin};
use crate::model::{Effect, Fitted, Model};
use crate::noise::{self, Noise};
use crate::observations;
use crate::ranges::{Resolution, limit};
use crate::search::{Choice, rivals};
use crate::study::Study;
use crate::terms::Shape;
use crate::travel::{self, Travel};
use crate::waves::{self, WavePlace};
use crate::weights::{Outliers, Weights};

/// The most rounds.
pub(super) const ROUNDS: usize = 6;
/// How many waves are added to the candidates in a round by what they gain, and as many by what they gain at their own noise: the
/// one is right where the noise is known, the other where it is not yet.
const WAVES: usize = 4;

/// A search on its way.
#[derive(Clone)]
pub(super) struct Search {
    pub(super) model: Model,
    /// Models of earlier rounds with more effects than a later one. Where much is left, a round that takes an effect less leaves more
    /// to the noise, and the next takes less still: so a search can run down to nothing past what would have stood up.
    pub(super) richer: Vec<Model>,
    pub(super) weights: Weights,
    courses: Vec<Arc<Course>>,
    pub(super) travels: Vec<Travel>,
    pub(super) pool: Vec<Kin>,
    pub(super) places: Vec<WavePlace>,
    pub(super) tries: Tries,
}

impl Search {
    pub(super) fn new(study: &Study<'_>, settings: Vec<Effect>, outliers: Outliers) -> Self {
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

    /// A search that begins with a model, and looks for what another search looked for.
    pub(super) fn beside(study: &Study<'_>, found: &Found, model: Model) -> Self {
        let mut search = Self {
            model: Model::default(),
            richer: Vec::new(),
            weights: found.appraisal.weights.clone(),
            courses: Vec::new(),
            travels: found.travels.clone(),
            pool: found.pool.clone(),
            places: found.places.clone(),
            tries: found.tries,
        };
        search.begin(study, model);
        search
    }

    /// Begins anew with a model. Its plays act at once, as at the beginning of every search.
    pub(super) fn begin(&mut self, study: &Study<'_>, model: Model) {
        let model = model.uncrossed();
        self.weights = Appraisal::new(study, &model).weights;
        self.courses = courses(study, &model);
        self.model = model;
    }

    /// Keeps the first `settings` effects as settings, which are always fitted. All others pay the BIC penalty from here on.
    pub(super) fn price_all_but(&mut self, settings: usize) {
        self.model = std::mem::take(&mut self.model).with_settings(settings);
        for model in &mut self.richer {
            *model = std::mem::take(model).with_settings(settings);
        }
    }

    /// Whether its end costs less than that of another search: minus twice the likelihood, and the prices. It must under the weights that
    /// either end gives to the samples: under those of an end that lacks something fewer samples count.
    pub(super) fn ends_better(&self, study: &Study<'_>, end: &Fit, (other, of_other): (&Self, &Fit)) -> bool {
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
    pub(super) fn conditions(&self) -> Conditions<'_> {
        Conditions { weights: &self.weights, travels: &self.travels, tries: self.tries }
    }

    /// Goes to its end: chooses until nothing changes, and lets axes cross their plays.
    pub(super) fn search(&mut self, study: &Study<'_>, progress: &mut dyn FnMut(f64)) {
        self.go_round(study, progress);
        self.cross_plays(study, progress);
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
                next = dynamics::try_underway(study, next, &self.conditions());
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
    pub(super) fn fit(&self, study: &Study<'_>) -> Fit {
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

fn same_noises(a: &[Vec<Noise>], b: &[Vec<Noise>]) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 0.03 * (a.abs() + b.abs());
    let alike = |(a, b): (&Noise, &Noise)| {
        let slow = near(a.time_constant.ln(), b.time_constant.ln());
        near(a.white, b.white) && near(a.wander, b.wander) && (a.wander < 0.1 * a.white || slow)
    };
    a.iter().flatten().zip(b.iter().flatten()).all(alike)
}
