//! The audit: may a file be wrong, and not the physics missing?
//!
//! In: a study that was searched, what was found in it, and the files as they were read. Out: suspects, the likeliest first: single
//! faults of the machine file, of the calibration or of the recording's set-up, each with the files as they would be without it.
//! A wrong file makes errors that many small effects together imitate: a table with the wrong sign, a tool that is 20 mm longer, an
//! axis on the other branch. So every fault is one candidate, in competition with all that was found:
//!
//! ```text
//! catalogue: every fault that these files may have -> columns: how the prediction changes with it
//!     -> contest: what it costs to explain the recordings with it and without what it makes needless
//!     -> suspects -> the files changed, and searched anew -> verdict: told, or not
//! ```

mod catalogue;
mod changed;
mod columns;
mod contest;
mod fault;
pub(crate) mod gross;
mod verdict;
mod words;

use crate::Inputs;
use crate::engine::Found;
use crate::study::Study;

pub(crate) use changed::Changed;
use columns::Versions;
use contest::Contest;
use fault::Fault;
pub(crate) use verdict::{Rest, Trial, Verdict, judged};
pub(crate) use words::change;

/// The most faults that are told of one set of files: who has more of them has to look through the files.
pub(crate) const MOST: usize = 3;

/// How many faults with a name, and how many without one, are tried by a search of their own. Where one without a name is not right,
/// others that explain less hardly are.
const TRIALS: (usize, usize) = (2, 1);

/// How often the amount of a fault is corrected, at most.
pub(crate) const CORRECTIONS: usize = 3;

/// A fault that explains the recordings better than what was found.
#[derive(Clone, Debug)]
pub(crate) struct Suspect {
    pub(crate) fault: Fault,
    /// How much of it there is, in the fault's own unit; 1 of one that there is or is not.
    pub(crate) amount: f64,
    /// Whether the amount is one that a fault with a name has.
    pub(crate) named: bool,
    /// What it saves of the cost, its own price paid.
    pub(crate) gain: f64,
    /// What of that is due to an amount that would be unlikely without the fault.
    pub(crate) chance: f64,
    /// Faults that explain as much, each with its amount.
    pub(crate) others: Vec<(Fault, f64)>,
}

/// The faults that are worth a search of their own, the likeliest first.
pub(crate) fn suspects(study: &Study<'_>, found: &Found, inputs: &Inputs<'_>) -> Vec<Suspect> {
    let faults = catalogue::faults(inputs);
    if faults.is_empty() {
        return Vec::new();
    }
    let versions = Versions::new(study, &found.fit.model, inputs, faults);
    let mut suspects = Contest::new(study, found, &versions).suspects();
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

    /// The same with more of it, of what is left where so much was taken out: factors multiply, all else adds up.
    fn with(&self, more: f64) -> Self {
        let each = if self.fault.is_factor() { 1.0 + self.amount } else { 1.0 };
        Self { amount: self.amount + each * more, ..self.clone() }
    }
}

#[cfg(test)]
mod tests;
