//! `abbe diagnose`: what the model leaves out. In: recordings. Out: the diagnosis.

use crate::arguments::Diagnose;
use crate::failure::Failure;
use crate::output::print;
use crate::recorded;

/// Runs the command.
pub(crate) fn run(arguments: &Diagnose) -> Result<(), Failure> {
    let recorded = recorded::read_all(&arguments.recordings)?;
    let Some(first) = recorded.first() else { return Ok(()) };
    let recordings: Vec<&diagnosis::recording::Recording> =
        recorded.iter().map(|recorded| &recorded.recording).collect();
    let calibration = first.calibration.as_ref().map(|calibrated| &calibrated.calibration);
    print(&diagnosis::probe(&first.equations, calibration, &recordings))
}
