//! A search with the files as they are, or as they would be.
//!
//! In: what the user gives. Out: the study with what the engine found in it, and what is told of the recordings before anything is found;
//! or the whole diagnosis where nothing can be decided.

use super::decidable::{too_little, undecided};
use super::set_up::{Misread, astray, doubtful, misread, mistake, no_circle};
use super::units::{Left, Units};
use super::{Bare, bare_beside, bare_model, ceiling, fitted_runs, left, strongest, undecidable};
use crate::audit::Trial;
use crate::candidates;
use crate::clamping;
use crate::diagnosis::{Diagnosis, NothingReturns, Residual, Returning};
use crate::engine::{self, Found};
use crate::fit;
use crate::model::{Fitted, Model, Place};
use crate::pictures;
use crate::recording::Turned;
use crate::repeats::{self, Scatter};
use crate::returns;
use crate::study::Study;
use crate::weights::Outliers;
use crate::zeros;
use crate::{Inputs, Keep, Progress};

/// A study that was searched.
pub(super) struct Searched<'s> {
    pub(super) study: Study<'s>,
    pub(super) units: Units,
    pub(super) found: Found,
    /// The recordings whose runs do not repeat.
    pub(super) scattered: Vec<Scatter>,
    /// What the files leave of each measure.
    pub(super) before: Vec<Left>,
}

/// What is told of recordings before anything is found in them.
pub(super) struct Opening {
    pub(super) before: Residual,
    pub(super) drawn: Option<pictures::Before>,
    pub(super) keep: Keep,
    pub(super) returns: Vec<Returning>,
    pub(super) nothing_returns: Vec<NothingReturns>,
    pub(super) undecided: Vec<String>,
}

impl<'s> Searched<'s> {
    /// Searches recordings; the whole diagnosis where nothing can be decided from them. What turns out to be the rotation of a part is
    /// none of the machine's: then the search begins anew with a free datum.
    pub(super) fn new(
        inputs: &Inputs<'s>,
        keep: Keep,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<(Self, Opening), Box<Diagnosis>> {
        let (searched, opening) = Self::of(study(inputs, &[]), keep, progress)?;
        let turned = clamping::turned_as_found(&searched.study, &searched.found.fit.model);
        if turned.is_empty() {
            return Ok((searched, opening));
        }
        Self::of(study(inputs, &turned), keep, progress)
    }

    /// Searches a study.
    fn of(
        study: Study<'s>,
        keep: Keep,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<(Self, Opening), Box<Diagnosis>> {
        let mut opened = Diagnosis {
            machine: study.equations.machine.clone(),
            undecided: undecided(&study),
            ..Diagnosis::default()
        };
        if let Some(Misread { reason, change }) = misread(&study) {
            opened.undecided.clear();
            opened.model.push(change);
            return Err(Box::new(undecidable(opened, &study, &Outliers::none(&study), reason)));
        }
        if let Some(reason) = too_little(&study).or_else(|| mistake(&study)) {
            return Err(Box::new(undecidable(opened, &study, &Outliers::none(&study), reason)));
        }
        let mut bare = bare_model(&study, &Model::default());
        let mut study = returns::told(study, &bare.model, &bare.outliers);
        opened.returns = ceiling::ceiling(&study);
        opened.nothing_returns = ceiling::nothing(&study);
        if let Some(reason) = astray(&study, &bare.model).or_else(|| no_circle(&study, &bare.model)) {
            return Err(Box::new(undecidable(opened, &study, &bare.outliers, reason)));
        }
        opened.undecided.extend(doubtful(&study, &bare.model));
        let drawn = |study: &Study<'_>, Bare { model, outliers }: &Bare| {
            (keep != Keep::Nothing).then(|| pictures::Before::new(study, model, outliers))
        };
        let mut drawn_before = drawn(&study, &bare);
        let (found, scattered) = search(&study, &bare.outliers, progress);
        if found.fit.model.moves_otherwise() {
            bare = bare_beside(&study, &bare, &found.fit.model);
            drawn_before = drawn(&study, &bare);
            study = returns::told(study, &bare.model, &bare.outliers);
        }
        let units = Units::new(&study);
        let before = units.left(&study, &bare.model, &bare.outliers);
        let after = left(&study, &units, &found.fit.model, &found.appraisal.weights.outliers);
        let units = units.told_where_nearest(&before, &after);
        let before = units.left(&study, &bare.model, &bare.outliers);
        let Diagnosis { returns, nothing_returns, undecided, .. } = opened;
        let opening = Opening {
            before: units.told(&before),
            drawn: drawn_before,
            keep,
            returns,
            nothing_returns,
            undecided,
        };
        Ok((Self { study, units, found, scattered, before }, opening))
    }

    /// Whether nothing stands out at any place beside what was found: a number that has no name may only be changed if all is explained
    /// then.
    pub(super) fn is_explained(&self) -> bool {
        strongest(&self.study, &self.found).is_none()
    }

    /// What the effects that were found in a trial leave here, fitted again.
    pub(super) fn left_by(&self, trial: &Searched<'_>) -> Residual {
        let (from, to) = (trial.study.equations, self.study.equations);
        let place = |motion: usize| {
            let name = &from.motions[motion].name;
            to.motions.iter().position(|motion| motion.name == *name)
        };
        let here = |fitted: &Fitted| {
            let mut fitted = fitted.clone();
            if let Place::Motion { motion, .. } = &mut fitted.effect.place {
                *motion = place(*motion)?;
            }
            Some(fitted)
        };
        let Found { fit, appraisal, travels, .. } = &trial.found;
        let model = self.found.fit.model.with_effects(fit.model.effects.iter().filter_map(here));
        let own = &self.found.appraisal.weights;
        let weights = own.beside(appraisal.weights.noises.clone());
        let mut model = fit::refine(&self.study, model, &weights, travels).model;
        zeros::free_held_out(&self.study, &mut model);
        self.units.residual(&self.study, &model, &own.outliers)
    }

    /// The same as the audit takes it.
    pub(super) fn trial<'t>(&'t self, inputs: &'t Inputs<'t>) -> Trial<'t, 's> {
        Trial { study: &self.study, found: &self.found, inputs }
    }
}

/// The study of the files, some of whose parts are known to be turned.
fn study<'s>(inputs: &Inputs<'s>, turned: &[(usize, Turned)]) -> Study<'s> {
    let recordings: Vec<_> = inputs.recordings.iter().copied().chain(inputs.holdout).collect();
    let study = Study::with_turned(inputs.equations, inputs.calibration, &recordings, turned);
    if inputs.holdout.is_some() { study.with_last_held_out() } else { study }
}

/// What the engine finds, and the recordings whose runs do not repeat.
fn search(
    study: &Study<'_>,
    outliers: &Outliers,
    progress: &mut dyn FnMut(Progress),
) -> (Found, Vec<Scatter>) {
    let mut step = |done: f64| progress(Progress { step: "looking for left-out physics", done: 0.9 * done });
    let always = candidates::always(study);
    let mut found = engine::find(study, always, outliers.clone(), &mut step);
    let scattered = repeats::scatter(study, &found.fit.model);
    if !scattered.is_empty() {
        let mut always = candidates::always(study);
        for scatter in &scattered {
            let fitted: Vec<i64> = fitted_runs(&study.scenes[scatter.scene]);
            always.extend(repeats::run_zeros(scatter.scene, &study.scenes[scatter.scene], &fitted));
        }
        found = engine::find(study, always, found.appraisal.weights.outliers, &mut step);
    }
    (found, scattered)
}
