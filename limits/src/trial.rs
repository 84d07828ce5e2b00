//! One trial: an effect at a size in a recording, and what a diagnosis says of it.

use std::cmp::Ordering;

use diagnosis::diagnosis::{Diagnosis, Finding};
use diagnosis::{Inputs, diagnose};
use recording::Recording;

use crate::injection::base::Base;
use crate::injection::case::Case;
use crate::injection::effect::Effect;
use crate::injection::score::{self, How, Score, internal};

/// A recording with what its diagnosis says of it as it is.
pub struct Known {
    /// The recording and its machine.
    pub base: Base,
    /// What is found in it alone.
    pub alone: Diagnosis,
    /// The root mean square of what that leaves, mm or rad.
    pub left: f64,
}

impl Known {
    /// Diagnoses a recording as it is.
    ///
    /// # Errors
    ///
    /// Why nothing can be asked of it: nothing can be decided from it, or it has no noise that could hide an effect.
    pub fn new(base: Base) -> Result<Self, String> {
        let alone = diagnosed(&base, &[&base.recording]);
        if let Some(reason) = &alone.undecidable {
            return Err(format!("nothing can be decided from it. {reason}"));
        }
        let left = internal(alone.after.rms, alone.after.unit);
        match left.partial_cmp(&0.0) {
            Some(Ordering::Greater) if left.is_finite() => Ok(Self { base, alone, left }),
            Some(_) => Err("its readings have no noise, so an effect of any size would be found".to_owned()),
            None => Err("the size of its residuals is unknown".to_owned()),
        }
    }
}

/// What a diagnosis makes of an effect.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The effect as it was injected.
    pub effect: Effect,
    /// Its strength.
    pub strength: f64,
    /// Whether it was found, and its size is right. A claim of it together with what the recording has of the same has the wrong size.
    pub is_found: bool,
    /// The size that was found, with half of its interval of 95 %, where it was found by its own name.
    pub interval: Option<(f64, f64)>,
    /// Whether its own name stands first.
    pub is_first: bool,
    /// The other names of what was found: motion, term, and the measurement that would tell them apart.
    pub others: Vec<Other>,
    /// What was claimed instead, where it was not found.
    pub instead: Vec<String>,
    /// Whether something was told that no term explains.
    pub is_unexplained: bool,
}

/// Another name for what was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Other {
    /// `EXX backlash`, `clock of the instrument`.
    pub name: String,
    /// The measurement that would tell them apart; empty where none was told.
    pub separate_by: String,
}

/// Injects an effect and diagnoses; nothing where no such effect is one of its kind.
pub fn trial(known: &Known, motion: usize, effect: Effect) -> Option<Trial> {
    let case = Case::with(0, &known.base, (motion, effect), 0.0)?;
    let found = diagnosed(&known.base, &[&case.recording(&known.base)]);
    let score = Score::of(&case, &known.base, &found, &known.alone);
    let is_found = score.how != How::Missed && !score.beside_unclaimed;
    let own = &known.base.names.motions[motion].name;
    let hit = score.hit.and_then(|hit| found.findings.get(hit));
    let term = effect.term().name();
    let is_first = hit.is_some_and(|hit| hit.motion == *own && hit.term == term);
    Some(Trial {
        effect,
        strength: effect.strength(),
        is_found,
        interval: hit.filter(|_| is_first).and_then(|hit| score::interval(&effect, hit)),
        is_first,
        others: hit.map(|hit| others(hit, own, term)).unwrap_or_default(),
        instead: if is_found { Vec::new() } else { score.extra },
        is_unexplained: found.unexplained.is_some(),
    })
}

/// All names of a finding but the effect's own.
fn others(hit: &Finding, motion: &str, term: &str) -> Vec<Other> {
    let is_own = |of: &str, name: &str| of == motion && name == term;
    let advice = hit.alternatives.iter().find(|other| is_own(&other.motion, other.term));
    let first = Other {
        name: name(&hit.motion, hit.term),
        separate_by: advice.map(|advice| advice.separate_by.clone()).unwrap_or_default(),
    };
    let first = Some(first).filter(|_| !is_own(&hit.motion, hit.term));
    let rest = hit.alternatives.iter().filter(|other| !is_own(&other.motion, other.term));
    let rest = rest
        .map(|other| Other { name: name(&other.motion, other.term), separate_by: other.separate_by.clone() });
    first.into_iter().chain(rest).collect()
}

/// A name as it is told: `EXX backlash`, `clock of the instrument`.
pub(crate) fn name(motion: &str, term: &str) -> String {
    if motion == "instrument" { format!("{term} of the instrument") } else { format!("{motion} {term}") }
}

/// The diagnosis of recordings of a machine, beside what is known of it.
pub fn diagnosed(base: &Base, recordings: &[&Recording]) -> Diagnosis {
    let inputs = Inputs {
        equations: &base.compiled.equations,
        calibration: base.calibration.as_ref(),
        recordings: recordings.to_vec(),
        holdout: None,
        calibration_file: None,
        chains: None,
    };
    diagnose(&inputs, &mut |_| {})
}
