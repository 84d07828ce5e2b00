//! The verdict on a suspect: what was found with the files as they are, against what is found with them changed.
//!
//! In: both searches. Out: whether the change holds, and how much of the fault is left with it.

use super::Suspect;
use super::columns::Versions;
use super::contest::{Contest, DECISIVE, NEAR, TURNED, price_of_a_run};
use crate::Inputs;
use crate::certainty::WIDTH_95;
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
        self.found.fit.model.len() - self.found.always
    }
}

/// How much of a fault is left with the files changed, in the fault's own unit, and its standard deviation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rest {
    pub(crate) amount: f64,
    pub(crate) deviation: f64,
}

/// What becomes of a suspect.
pub(crate) enum Verdict {
    /// The change holds.
    Holds(Rest),
    /// It is a little more, or less: the same with this amount is to be tried.
    Again(Suspect),
    /// The files are no better with it.
    Dropped,
}

/// Held-out samples may lie so much farther: the small effects that stood in for the fault fitted a little noise too, and held-out rms
/// of one model scatter by as much between halves of a recording.
const FARTHER: f64 = 1.05;

/// So much of a fault with a name may be left, as a share of it, where its interval is narrower: an error of the first order.
const LEFT: f64 = 0.02;

/// The interval of a sign may be so much of it: it must be far from a number that is missing, and from one that is right.
const NEAR_TURNED: f64 = 0.25;

/// How many standard deviations what is left of a fault may be from nothing.
const DEVIATIONS: f64 = 3.0;

/// Judges a suspect. Its change holds if it costs decisively less, held-out samples lie no farther, and nothing of the fault is left.
pub(crate) fn judged(suspect: &Suspect, before: Trial<'_, '_>, after: Trial<'_, '_>) -> Verdict {
    let one = &before.found.appraisal;
    let held_out = |trial: &Trial<'_, '_>| trial.found.appraisal.held_out(trial.study, one);
    let noises = &after.found.appraisal.noises;
    let saved = cost(&before, noises) - cost(&after, noises) + suspect.chance;
    let holds = saved > DECISIVE
        && (one.lacks() || !after.found.appraisal.lacks())
        && held_out(&after) <= FARTHER * FARTHER * held_out(&before);
    let Some(rest) = holds.then(|| rest(suspect, &before, &after)).flatten() else { return Verdict::Dropped };
    // What is left of a factor is relative to the numbers as they were changed.
    let whole = match suspect.fault.is_whole() || suspect.fault.is_factor() {
        true => 1.0,
        false => suspect.amount,
    };
    // A number without a name stands in for whatever is missing. It may not ask for more physics beside it.
    if !suspect.named && after.effects() > before.effects() {
        return Verdict::Dropped;
    }
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

/// What was found costs where samples weigh by these noises, zeros of single runs included.
fn cost(trial: &Trial<'_, '_>, noises: &[Vec<Noise>]) -> f64 {
    let conditions = trial.found.conditions();
    let conditions = conditions.under(noises);
    let fit = conditions.refine(trial.study, trial.found.fit.model.clone());
    let always = fit.model[..trial.found.always].iter();
    let zeros: f64 = always.filter_map(|fitted| price_of_a_run(&fitted.effect, fit.samples)).sum();
    zeros + conditions.cost(trial.study, &fit)
}

fn rest(suspect: &Suspect, before: &Trial<'_, '_>, after: &Trial<'_, '_>) -> Option<Rest> {
    let fault = suspect.fault.turned_back(before.inputs.chains.map(|chains| chains.word));
    let versions = Versions::new(after.study, &after.found.fit.model, after.inputs, vec![fault]);
    Contest::new(after.study, after.found, &versions).rest()
}
