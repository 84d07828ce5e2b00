//! The verdict on a suspect: what was found with the files as they are, against what is found with them changed.
//!
//! In: the search with the files as they are, and the search with them changed. Out: whether the change holds.

use super::Suspect;
use super::columns::Versions;
use super::suspected::{FaultContest, NEAR, TURNED};
use crate::Inputs;
use crate::certainty::WIDTH_95;
use crate::contest::{DECISIVE, price_of_a_run};
use crate::engine::Found;
use crate::noise::Noise;
use crate::study::Study;

/// Files that were searched.
#[derive(Clone, Copy)]
pub(crate) struct Trial<'t, 's> {
    pub(crate) study: &'t Study<'s>,
    pub(crate) found: &'t Found,
    pub(crate) inputs: &'t Inputs<'t>,
}

impl Trial<'_, '_> {
    /// How many effects were found.
    fn effects(&self) -> usize {
        self.found.fit.model.chosen().len()
    }
}

/// The amount of a fault that is left with the files changed, and its standard deviation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rest {
    pub(crate) amount: f64,
    pub(crate) deviation: f64,
}

/// What becomes of a suspect.
pub(crate) enum Verdict {
    /// The change holds.
    Holds(Rest),
    /// The amount was not right: this one is to be tried.
    Again(Suspect),
    /// The files are no better with it.
    Dropped,
}

/// The rms of held-out samples may be so much larger where the change makes effects needless: held-out rms of one model differ by as
/// much between halves of a recording. A change that makes none needless must bring them nearer, as any finding must.
const FARTHER: f64 = 1.05;

/// The share of a fault that may be left even if its interval is narrower. The columns are of first order, and agree with the exact
/// machine within 1 % (`a_column_is_what_the_exact_machine_does_differently`): this is twice that.
const LEFT: f64 = 0.02;

/// Half of the interval of a wrong sign, as a share of the number. Its neighbours are a number that is missing (0) and one that is right
/// (+1). An interval of a quarter keeps it four intervals away from the nearer one.
const NEAR_TURNED: f64 = 0.25;

/// The amount that is left may be this many standard deviations from 0: 3 are exceeded by chance in 3 of 1000.
const DEVIATIONS: f64 = 3.0;

/// Judges a suspect. Its change holds if it costs decisively less, held-out samples lie no farther, and nothing of the fault is left.
pub(crate) fn judged(suspect: &Suspect, before: Trial<'_, '_>, after: Trial<'_, '_>) -> Verdict {
    // A number without a name can stand in for whatever is missing. It must not need more effects than were found without it.
    if !suspect.named && after.effects() > before.effects() || !is_better(suspect, &before, &after) {
        return Verdict::Dropped;
    }
    let Some(rest) = rest(suspect, &before, &after) else { return Verdict::Dropped };
    // The amount left of a factor is relative to the changed numbers.
    let whole = match suspect.fault.is_whole() || suspect.fault.is_factor() {
        true => 1.0,
        false => suspect.amount,
    };
    let widest = if suspect.amount == TURNED { NEAR_TURNED } else { NEAR };
    if suspect.named && WIDTH_95 * rest.deviation > widest * whole.abs() {
        return Verdict::Dropped;
    }
    if rest.amount.abs() <= f64::max(DEVIATIONS * rest.deviation, LEFT * whole.abs()) {
        Verdict::Holds(rest)
    } else if suspect.named {
        Verdict::Dropped
    } else {
        Verdict::Again(suspect.with(rest.amount))
    }
}

/// Whether what is found with the files changed costs decisively less, and lies no farther from held-out samples.
fn is_better(suspect: &Suspect, before: &Trial<'_, '_>, after: &Trial<'_, '_>) -> bool {
    let [one, other] = [before, after].map(|trial| &trial.found.appraisal);
    let held_out = |trial: &Trial<'_, '_>| trial.found.appraisal.held_out(trial.study, one);
    let farther = if after.effects() < before.effects() { FARTHER * FARTHER } else { 1.0 };
    let saved = cost(before, &other.weights.noises) - cost(after, &other.weights.noises) + suspect.chance;
    saved > DECISIVE && (one.lacks() || !other.lacks()) && held_out(after) <= farther * held_out(before)
}

/// The cost of what was found under these noises. Zeros of single runs are part of it.
fn cost(trial: &Trial<'_, '_>, noises: &[Vec<Noise>]) -> f64 {
    let conditions = trial.found.conditions();
    let weights = trial.found.appraisal.weights.beside(noises.to_vec());
    let conditions = conditions.under(&weights);
    let fit = conditions.refine(trial.study, trial.found.fit.model.clone());
    let settings = fit.model.settings().iter();
    let zeros: f64 = settings.filter_map(|fitted| price_of_a_run(&fitted.effect, fit.samples)).sum();
    zeros + conditions.cost(trial.study, &fit)
}

fn rest(suspect: &Suspect, before: &Trial<'_, '_>, after: &Trial<'_, '_>) -> Option<Rest> {
    let fault = suspect.fault.turned_back(before.inputs.chains.map(|chains| chains.word));
    let versions = Versions::new(after.study, &after.found.fit.model, after.inputs, vec![fault]);
    FaultContest::new(after.study, after.found, &versions).rest()
}
