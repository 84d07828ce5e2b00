//! A diagnosis of recordings that were read. In: recordings of one machine, those that are fitted and one that is held out. Out: what
//! the model leaves out.

use diagnosis::diagnosis::Diagnosis;
use diagnosis::{Chains, Inputs, Progress};

use crate::failure::Failure;
use crate::recorded::Recorded;

/// What a diagnosis keeps besides what it says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// Nothing.
    Nothing,
    /// What a page draws.
    Pictures,
    /// What a page draws, and every sample.
    Traces,
}

/// Diagnoses recordings of one machine with one calibration, as [`crate::recorded::read_all`] has read them. `show` hears how far the
/// work is.
///
/// # Errors
///
/// Recordings of which one lacks the positions that its readings need, or none holds a sample that could be used.
pub fn diagnose(
    fitted: &[Recorded],
    held_out: Option<&Recorded>,
    keep: Keep,
    show: &mut dyn FnMut(Progress),
) -> Result<Diagnosis, Failure> {
    let Some(first) = fitted.first() else { return Ok(Diagnosis::default()) };
    fitted.iter().chain(held_out).try_for_each(Recorded::needs_positions)?;
    let derive = first.topology.as_ref().map(|topology| |word: &str| topology.derive(word));
    let inputs = Inputs {
        equations: &first.equations,
        calibration: first.calibration.as_ref().map(|known| &known.calibration),
        recordings: fitted.iter().map(|recorded| &recorded.recording).collect(),
        holdout: held_out.map(|recorded| &recorded.recording),
        calibration_file: first.calibration.as_ref().map(|known| &known.source),
        chains: first.topology.as_ref().zip(derive.as_ref()).map(|(topology, derive)| Chains {
            file: &topology.file,
            word: &topology.word,
            derive,
        }),
    };
    let mut show = |now: Progress| show(now);
    let diagnosis = match keep {
        Keep::Nothing => diagnosis::diagnose(&inputs, &mut show),
        Keep::Pictures => diagnosis::diagnose_with_pictures(&inputs, &mut show),
        Keep::Traces => diagnosis::diagnose_with_traces(&inputs, &mut show),
    };
    if diagnosis.recordings.iter().all(|recording| recording.samples == 0) {
        return Err(first.unusable());
    }
    Ok(diagnosis)
}
