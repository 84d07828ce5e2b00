//! The conclusion: from recordings to a diagnosis.
//!
//! In: what the user gives. Out: the verdict, findings in words and numbers, and how far they carry on held-out data.

mod ceiling;
mod decidable;
mod denied;
mod findings;
mod refuted;
mod searched;
mod set_up;
mod summary;
mod unexplained;
mod units;

use crate::appraisal::Appraisal;
use crate::audit;
use crate::candidates;
use crate::compose;
use crate::course::courses;
use crate::crossing;
use crate::diagnosis::{
    Change, Diagnosis, Evidence, Finding, Mended, NoiseSummary, Residual, SettingFinding, Verdict,
};
use crate::engine::Found;
use crate::fit;
use crate::harmonics;
use crate::local::{self, Feature};
use crate::model::Model;
use crate::places;
use crate::repeats;
use crate::revise;
use crate::scene::Scene;
use crate::study::Study;
use crate::terms::SettingKind;
use crate::traces;
use crate::unsteady;
use crate::weights::Outliers;
use crate::zeros;
use crate::{Inputs, Keep, Progress};
use decidable::{bent, crossed, underway};
use findings::report;
use searched::{Opening, Searched};
use summary::summaries;
use units::{Left, Units, lies_farther, unit_at};

/// Finds what the model leaves out; with the numbers behind plots of it, or all numbers, where `keep` says so.
pub(crate) fn diagnose(inputs: &Inputs<'_>, keep: Keep, progress: &mut dyn FnMut(Progress)) -> Diagnosis {
    match Searched::new(inputs, keep, progress) {
        Ok((searched, opening)) => audited(searched, inputs, opening, Vec::new(), progress),
        Err(undecidable) => *undecidable,
    }
}

/// Audits the files of a search. If a change of one of them holds, the search with the change is audited in its turn; if none does, the
/// search is concluded. `opening` is of the files as they were read.
fn audited(
    searched: Searched<'_>,
    inputs: &Inputs<'_>,
    opening: Opening,
    mut changes: Vec<Change>,
    progress: &mut dyn FnMut(Progress),
) -> Diagnosis {
    let suspects = match changes.len() < audit::MOST {
        true => audit::suspects(&searched.study, &searched.found, inputs),
        false => Vec::new(),
    };
    for suspect in suspects {
        let mut next = Some(suspect);
        for _ in 0..audit::CORRECTIONS {
            let Some(suspect) = next.take() else { break };
            let Some(changed) = suspect.changed(inputs) else { break };
            let with = changed.inputs(inputs);
            let Ok((trial, _)) = Searched::new(&with, Keep::Nothing, progress) else { break };
            let rest = match audit::judged(&suspect, searched.trial(inputs), trial.trial(&with)) {
                audit::Verdict::Holds(rest) if suspect.named || trial.is_explained() => rest,
                audit::Verdict::Again(corrected) => {
                    next = Some(corrected);
                    continue;
                }
                _ => break,
            };
            let noise = searched.units.noise(&trial.study, &trial.found.appraisal).value;
            let sizes = [searched.left_by(&trial), trial.left_by(&trial)];
            changes.push(audit::change(&suspect, rest, inputs, (sizes, noise)));
            // One search at a time is enough for the memory.
            drop(searched);
            return audited(trial, &with, opening, changes, progress);
        }
    }
    let mended = (!changes.is_empty()).then(|| mended(inputs)).flatten();
    let diagnosis = Diagnosis { model: changes, mended, ..Diagnosis::default() };
    concluded(searched, opening, diagnosis, progress)
}

fn mended(inputs: &Inputs<'_>) -> Option<Mended> {
    let calibration = inputs.calibration?.clone();
    let word = inputs.chains.map(|chains| chains.word.to_owned());
    Some(Mended { calibration, equations: inputs.equations.clone(), word })
}

/// What is told of a search. `diagnosis` holds the faults of the files already.
fn concluded(
    searched: Searched<'_>,
    opening: Opening,
    mut diagnosis: Diagnosis,
    progress: &mut dyn FnMut(Progress),
) -> Diagnosis {
    let Searched { study, units, mut found, scattered, before } = searched;
    diagnosis.machine = study.equations.machine.clone();
    (diagnosis.before, diagnosis.undecided) = (opening.before, opening.undecided);
    (diagnosis.returns, diagnosis.nothing_returns) = (opening.returns, opening.nothing_returns);
    stand_or_fall(&study, &units, &mut found, &before);
    compose::compose(&study, &mut found);
    let mut feature = explain_locally(&study, &mut found);
    progress(Progress { step: "comparing with other names", done: 0.95 });
    let mut numbers = claims(&study, &mut found, &units, &mut diagnosis);
    let mut refuted = Vec::new();
    while let Some(weakest) = refuted::weakest(&diagnosis.findings)
        .map(|weakest| numbers[weakest])
        .or_else(|| piece_of_the_rest(&study, &found, &numbers))
    {
        refuted.push(found.fit.model.effects[weakest].effect.clone());
        let finding = numbers.iter().position(|number| *number == weakest).map(|at| &diagnosis.findings[at]);
        let carries = finding.is_some_and(takes_most);
        drop_effect(&study, &mut found, weakest);
        if carries {
            found.replace(&study, &refuted);
        }
        // A table that was refuted is not made again.
        feature = strongest(&study, &found);
        numbers = claims(&study, &mut found, &units, &mut diagnosis);
    }
    diagnosis.undecided.extend(crossed(&study, &found.fit.model));
    diagnosis.undecided.extend(bent(&study, &found.fit.model));
    diagnosis.undecided.extend(underway(&study, &found.fit.model));
    diagnosis.undecided.extend(diagnosis.model.iter().map(decidable::since_when));
    let moving =
        if feature.is_none() { unsteady::moving(&study, &found.appraisal, units.outside) } else { None };
    let quiet = feature.as_ref().and_then(|feature| places::beside(&study, &found, feature));
    diagnosis.noise = units.noise(&study, quiet.as_ref().unwrap_or(&found.appraisal));
    let counts = |kind| units.counts(&study, kind);
    diagnosis.traces = match &opening.drawn {
        Some(before) if opening.keep == Keep::Traces => traces::traces(&study, before, &found),
        _ => Vec::new(),
    };
    diagnosis.pictures =
        opening.drawn.map(|before| before.draw(&study, &found, (&counts, units.unit().0), &numbers));
    diagnosis.unexplained = match feature {
        Some(feature) => Some(unexplained::feature(&study, &found, &feature)),
        None => {
            unexplained::unsteady(&study, &found, moving).or_else(|| unexplained::returning(&study, &found))
        }
    };
    diagnosis.unexplained = diagnosis.unexplained.or_else(|| unexplained::on_the_way(&study));
    let told = scattered.iter().find(|scatter| scatter.is_told);
    diagnosis.repeatability =
        told.map(|scatter| repeats::describe(&study, scatter, unit_at(&study, scatter.at())));
    let zeros_or_places = decidable::zeros_or_places(&study, &scattered);
    diagnosis.undecided.extend(zeros_or_places.clone());
    diagnosis.verdict = verdict(&diagnosis);
    if diagnosis.verdict == Verdict::Adequate {
        diagnosis.undecidable = zeros_or_places.or_else(|| decidable::shows_nothing(&study));
    }
    if diagnosis.undecidable.is_some() {
        diagnosis.verdict = Verdict::Undecided;
    } else if diagnosis.verdict == Verdict::Adequate {
        diagnosis.denied = denied::denied(&study, &found);
    }
    diagnosis.candidates = found.pool.len();
    diagnosis.recordings = summaries(&study, &found.appraisal.weights.outliers);
    diagnosis
}

fn verdict(diagnosis: &Diagnosis) -> Verdict {
    let demanding =
        |setting: &SettingFinding| SettingKind::of_name(setting.term).is_some_and(SettingKind::is_physics);
    if diagnosis.repeatability.is_some() {
        Verdict::NotRepeatable
    } else if diagnosis.unexplained.is_some() {
        Verdict::Unexplained
    } else if !(diagnosis.model.is_empty() && diagnosis.findings.is_empty())
        || diagnosis.settings.iter().any(demanding)
    {
        Verdict::LeftOutPhysics
    } else {
        Verdict::Adequate
    }
}

/// What a model leaves of each measure, the zeros of recordings that are held out as a whole left free.
fn left(study: &Study<'_>, units: &Units, model: &Model, outliers: &Outliers) -> Vec<Left> {
    let mut model = model.clone();
    zeros::free_held_out(study, &mut model);
    units.left(study, &model, outliers)
}

/// Keeps what was found only where held-out rows lie no farther with it than the calibration leaves them, `before`: what makes
/// them lie farther is no explanation, however well it fitted. Where it is only that zeros allow for a noise that wanders, they are
/// weighed as those of the calibration are.
fn stand_or_fall(study: &Study<'_>, units: &Units, found: &mut Found, before: &[Left]) {
    let outliers = &found.appraisal.weights.outliers;
    let farther = |model: &Model| lies_farther(&left(study, units, model, outliers), before);
    if !found.claims() || !farther(&found.fit.model) {
        return;
    }
    let mut plain = found.fit.model.clone();
    zeros::weigh_plainly(study, &mut plain, &found.appraisal.weights.as_white());
    if farther(&plain) {
        withdraw(study, found);
    } else {
        found.plain_zeros = true;
        found.appraisal = Appraisal::new(study, &plain);
        found.fit.model = plain;
    }
}

/// Findings and settings as they would be told, and what the whole model leaves; the numbers of the model's effects that are the
/// findings, in their order.
fn claims(study: &Study<'_>, found: &mut Found, units: &Units, diagnosis: &mut Diagnosis) -> Vec<usize> {
    if !found.claims() {
        // Zeros that allow for a noise that wanders are no better than the plain ones where there is nothing beside them.
        zeros::weigh_plainly(study, &mut found.fit.model, &found.appraisal.weights.as_white());
    }
    zeros::free_held_out(study, &mut found.fit.model);
    diagnosis.after = units.residual(study, &found.fit.model, &found.appraisal.weights.outliers);
    diagnosis.findings.clear();
    diagnosis.settings.clear();
    report(study, found, units, diagnosis)
}

/// The number of a wave that takes less than what comes back without a name beside it, the one of the least share of them: it may be
/// a piece of that.
fn piece_of_the_rest(study: &Study<'_>, found: &Found, numbers: &[usize]) -> Option<usize> {
    let model = &found.fit.model;
    let waves = numbers.iter().rev().copied().filter(|number| model.effects[*number].effect.shape.is_wave());
    waves.into_iter().find(|number| {
        let rest = model.without_all(&harmonics::together(model, *number));
        let rest = fit::refine(study, rest, &found.appraisal.weights, &found.travels);
        let without = Appraisal::beside(study, &rest.model, &found.appraisal);
        !revise::stands_apart(study, &without, &found.appraisal)
    })
}

/// Whether a finding takes more than all findings leave together. Without it, others would be told apart no longer.
fn takes_most(finding: &Finding) -> bool {
    let Evidence { with, without, .. } = finding.evidence;
    without.powi(2) - with.powi(2) > with.powi(2)
}

/// Takes one effect back and fits the rest again.
fn drop_effect(study: &Study<'_>, found: &mut Found, number: usize) {
    let mut model = found.fit.model.without(number);
    crossing::follow(study, &mut model);
    found.fit = fit::refine(study, model, &found.appraisal.weights, &found.travels);
    found.appraisal = Appraisal::new(study, &found.fit.model);
}

/// Takes all effects of the machine back.
fn withdraw(study: &Study<'_>, found: &mut Found) {
    let mut settings = found.fit.model.settings_alone();
    crossing::follow(study, &mut settings);
    found.fit = fit::refine(study, settings, &found.appraisal.weights.as_white(), &found.travels);
    found.appraisal = Appraisal::new(study, &found.fit.model);
}

/// The settings of the instruments alone, and the samples that are left out beside them.
struct Bare {
    model: Model,
    outliers: Outliers,
}

/// The settings of the instruments alone, fitted, where known plays are crossed as far as they go on the axes on which a model crosses
/// plays, and commands bend where it bends them: beside that, what changes is what was found, and not how an axis moves.
fn bare_beside(study: &Study<'_>, bare: &Bare, found: &Model) -> Bare {
    let mut known = bare.model.clone().moving_as(found);
    crossing::follow(study, &mut known);
    bare_model(study, &known)
}

/// The settings of the instruments alone, fitted, with axes that move as in another model.
fn bare_model(study: &Study<'_>, moving: &Model) -> Bare {
    let model = Model::of_settings(candidates::always(study)).moving_as(moving);
    let weights = Appraisal::new(study, &model).weights;
    let mut model = fit::refine(study, model, &weights.as_white(), &[]).model;
    zeros::free_held_out(study, &mut model);
    Bare { model, outliers: weights.outliers }
}

/// Looks for what remains at one place of an axis. It becomes a `table` where that stands up, and the search goes on.
fn explain_locally(study: &Study<'_>, found: &mut Found) -> Option<Feature> {
    for _ in 0..TABLES {
        let feature = strongest(study, found)?;
        match places::with_table(study, found, &feature) {
            Some(better) => *found = better,
            None => return Some(feature),
        }
    }
    strongest(study, found)
}

fn strongest(study: &Study<'_>, found: &Found) -> Option<Feature> {
    let courses = courses(study, &found.fit.model);
    local::strongest(study, &found.appraisal, &found.fit.model, &courses, &found.travels)
}

/// The most tables that are added.
const TABLES: usize = 3;

fn fitted_runs(scene: &Scene<'_>) -> Vec<i64> {
    let fits = |run: &i64| scene.blocks.iter().any(|block| block.run == *run && !block.held_out);
    scene.run_numbers().into_iter().filter(fits).collect()
}

fn undecidable(
    mut diagnosis: Diagnosis,
    study: &Study<'_>,
    outliers: &Outliers,
    because: String,
) -> Diagnosis {
    let sentence = format!("Nothing can be decided from this recording, because {because}.");
    diagnosis.undecided.push(sentence.clone());
    // An axis that is read wrongly is not on its way anywhere.
    diagnosis.unexplained = if diagnosis.model.is_empty() { unexplained::on_the_way(study) } else { None };
    if diagnosis.unexplained.is_some() {
        diagnosis.verdict = Verdict::Unexplained;
    } else {
        diagnosis.undecidable = Some(sentence);
        diagnosis.verdict = Verdict::Undecided;
    }
    let nothing = Residual { rms: f64::NAN, holdout_rms: None, unit: "mm" };
    (diagnosis.before, diagnosis.after) = (nothing, nothing);
    diagnosis.noise = NoiseSummary { value: f64::NAN, unit: "mm", ..NoiseSummary::default() };
    diagnosis.recordings = summaries(study, outliers);
    diagnosis
}
