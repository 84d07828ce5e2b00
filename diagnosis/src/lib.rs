//! Diagnosis: what a calibration left out, found from recordings of the real machine.
//!
//! In: the equations of a machine, what its calibration knows, and recordings. Out: a [`Diagnosis`] of what the model lacks:
//! located, named, fitted, tested on held-out data, and written as terms that the compiler takes.
//!
//! ```text
//! recordings -> study: scenes with channels (coarse), sensors, blocks of rows (legs, targets, rounded, rest), parts that were clamped anew
//!   (clamping) -> states: what every axis did (way, position_loop) -> observations: residual and gain of every channel (course, travel) -> noise: the filter that whitens it
//! terms -> candidates, waves -> design: products of their columns -> search: the cheapest set (model, sweep) -> fit -> judge -> revise
//!   -> engine: the rounds through all of this; harmonics: waves of one period; dynamics, heat, curves, dents, crossing, answers: what
//!   imitates or hides something else
//! returns: what comes back of a residual, before any name -> appraisal: the floor, and how samples weigh (weights)
//! a fitted model -> audit: wrong files; compose: forms without a name; places, unsteady, repeats, zeros: what remains
//!   -> certainty, alternatives, parameters, elements, words -> conclude: a Diagnosis, plain data -> report: text, JSON, a page (pictures)
//! ```
//!
//! Three values are apart, and none of them is kept in another. A study is what was recorded, and never changes after it is made. A model is
//! what is held to act: effects, and the plays that axes cross. Weights are how samples count, outliers among them. So a fit is one
//! model under one set of weights, and a search that comes to nothing leaves nothing to restore.

mod alternatives;
mod answers;
mod appraisal;
mod audit;
mod candidates;
mod certainty;
mod channel;
mod clamping;
mod coarse;
mod compose;
mod conclude;
mod conditions;
mod contest;
mod course;
mod crossing;
mod curves;
mod dents;
mod design;
pub mod diagnosis;
mod dynamics;
mod elements;
mod engine;
mod fit;
mod follow;
mod form;
mod harmonics;
mod heat;
mod judge;
mod kinship;
mod legs;
mod local;
mod model;
mod noise;
mod observations;
mod outliers;
mod parallel;
mod parameters;
pub mod pictures;
mod places;
mod position_loop;
mod random;
mod ranges;
mod repeats;
pub mod report;
mod rest;
mod returns;
mod revise;
mod rounded;
mod scene;
mod search;
mod side;
mod states;
mod study;
mod sweep;
mod targets;
mod terms;
#[cfg(test)]
mod testing;
pub mod traces;
mod travel;
mod unsteady;
mod waves;
mod way;
mod weights;
mod words;
mod zeros;

use std::fmt;

use model_dsl::calibration::Calibration;
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;

use diagnosis::Diagnosis;
// Recordings are a crate of their own; the modules know it by this name.
pub(crate) use ::recording;
use recording::Recording;

pub use follow::{Followed, Size, Untold, follow, is_event, told_by};
pub use terms::{look_at, meaning};

/// What a diagnosis starts from.
#[derive(Clone, Debug)]
pub struct Inputs<'a> {
    /// The error equations of the machine.
    pub equations: &'a Equations,
    /// What is known of it already; without it, every error motion is zero.
    pub calibration: Option<&'a Calibration>,
    /// Recordings of this machine. They are fitted together: terms of the machine are shared, settings of instruments are not.
    pub recordings: Vec<&'a Recording>,
    /// A recording that is held out as a whole, beside what the others hold out.
    pub holdout: Option<&'a Recording>,
    /// The calibration's file, to tell where in it something is wrong.
    pub calibration_file: Option<&'a SourceFile>,
    /// Where the machine is that of a topology word: the same in another order. Without it no other order is looked for.
    pub chains: Option<Chains<'a>>,
}

/// A machine in other orders of its topology word.
#[derive(Clone, Copy)]
pub struct Chains<'a> {
    /// The file that has the word, or the word itself.
    pub file: &'a str,
    /// The word as the machine has it.
    pub word: &'a str,
    /// The equations of the machine with another word; `None` where that is no machine.
    pub derive: &'a dyn Fn(&str) -> Option<Equations>,
}

impl fmt::Debug for Chains<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Chains").field("word", &self.word).finish_non_exhaustive()
    }
}

/// How far a diagnosis has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// What is being done.
    pub step: &'static str,
    /// The share that is done, 0 to 1.
    pub done: f64,
}

/// Finds what the model leaves out.
///
/// It never fails: what cannot be decided from the recordings is said in [`Diagnosis::undecided`].
pub fn diagnose(inputs: &Inputs<'_>, progress: &mut dyn FnMut(Progress)) -> Diagnosis {
    conclude::diagnose(inputs, Keep::Nothing, progress)
}

/// The same, with [`Diagnosis::pictures`]: what a page draws. It takes more time and memory.
pub fn diagnose_with_pictures(inputs: &Inputs<'_>, progress: &mut dyn FnMut(Progress)) -> Diagnosis {
    conclude::diagnose(inputs, Keep::Pictures, progress)
}

/// The same, with [`Diagnosis::traces`] besides: every sample beside what the model says of it.
pub fn diagnose_with_traces(inputs: &Inputs<'_>, progress: &mut dyn FnMut(Progress)) -> Diagnosis {
    conclude::diagnose(inputs, Keep::Traces, progress)
}

/// What is kept of a diagnosis besides what is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Keep {
    Nothing,
    Pictures,
    /// Pictures, and every sample.
    Traces,
}

/// A count as a number.
#[expect(clippy::cast_precision_loss, reason = "counts of rows and candidates are far below 2^52")]
fn number(count: usize) -> f64 {
    count as f64
}

/// The whole part of a number that is not negative, as an index.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "checked to be small and not negative"
)]
fn index(value: f64) -> Option<usize> {
    (0.0..1e12).contains(&value).then_some(value as usize)
}
