//! The audit: may a file be wrong, and not the physics missing?
//!
//! In: a study that was searched, what was found in it, and the files as they were read. Out: suspects, the likeliest first. A suspect
//! is one fault of the machine file, of the calibration or of a recording's set-up.
//!
//! A wrong file makes errors that many small effects together imitate: a table with the wrong sign, a tool that is 20 mm longer, an
//! axis on the other branch. So every fault is a candidate and competes with all that was found:
//!
//! ```text
//! catalogue: every fault that these files may have -> columns: how the prediction changes with each
//!     -> contest: the cost of a model with the fault, beside the cost of what was found -> suspects
//!     -> changed: the files without the fault, which are searched again -> verdict -> words
//! ```

mod catalogue;
mod changed;
mod columns;
mod fault;
pub(crate) mod gross;
mod suspected;
mod verdict;
mod words;

use crate::Inputs;
use crate::engine::Found;
use crate::study::Study;

pub(crate) use changed::Changed;
use columns::Versions;
pub(crate) use columns::spread;
use fault::Fault;
use suspected::FaultContest;
pub(crate) use verdict::{Rest, Trial, Verdict, judged};
pub(crate) use words::change;

/// The most faults that are told of one set of files. Each takes a search of its own, and files with more faults need to be read
/// through by a person.
pub(crate) const MOST: usize = 3;

/// How many suspects with a named amount, and how many without one, get a search of their own. Several names can fit the same data.
/// Of amounts without a name only the one that explains most is worth the time.
const TRIALS: (usize, usize) = (2, 1);

/// The most searches for one suspect. Each corrects the amount by what the search before left of it. Only the shift of a table is not
/// linear, and each correction brings it nearer by the share of a node step that was missing.
pub(crate) const CORRECTIONS: usize = 3;

/// A fault that explains the recordings better than what was found.
#[derive(Clone, Debug)]
pub(crate) struct Suspect {
    pub(crate) fault: Fault,
    /// The amount of the fault, in its own unit. It is 1 for a fault that is either there or not.
    pub(crate) amount: f64,
    /// Whether the amount has a name: the fault is either there or not, or it is a known factor.
    pub(crate) named: bool,
    /// By how much it lowers the cost, after its own price.
    pub(crate) gain: f64,
    /// The part of the gain for an exact reversal, which is unlikely without a wrong sign.
    pub(crate) chance: f64,
    /// Faults that explain as much, each with its amount.
    pub(crate) others: Vec<(Fault, f64)>,
}

/// The suspects that get a search of their own, the likeliest first.
pub(crate) fn suspects(study: &Study<'_>, found: &Found, inputs: &Inputs<'_>) -> Vec<Suspect> {
    let faults = catalogue::faults(inputs);
    if faults.is_empty() {
        return Vec::new();
    }
    let versions = Versions::new(study, &found.fit.model, inputs, faults);
    let mut suspects = FaultContest::new(study, found, &versions).suspects();
    suspects.retain(|suspect| suspect.named || !catalogue::is_a_finding(inputs, &suspect.fault));
    let mut left = TRIALS;
    let tried = |suspect: &Suspect| {
        let left = if suspect.named { &mut left.0 } else { &mut left.1 };
        let is_tried = *left > 0;
        *left = left.saturating_sub(1);
        is_tried
    };
    suspects.into_iter().filter(tried).collect()
}

impl Suspect {
    /// The files without the fault.
    pub(crate) fn changed(&self, inputs: &Inputs<'_>) -> Option<Changed> {
        Changed::new(inputs, &self.fault, self.amount)
    }

    /// The same with the amount that is left once this amount is taken out. Factors multiply, all other amounts add up.
    fn with(&self, more: f64) -> Self {
        let each = if self.fault.is_factor() { 1.0 + self.amount } else { 1.0 };
        Self { amount: self.amount + each * more, ..self.clone() }
    }
}

#[cfg(test)]
mod tests;
