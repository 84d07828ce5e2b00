//! `abbe diagnose`: what the model leaves out. In: recordings. Out: the diagnosis as text, JSON or a page, and the
//! calibration with what was found.

mod display;
pub(super) mod files;
mod improved;

use std::path::PathBuf;

use diagnosis::diagnosis::Diagnosis;
use diagnosis::{Inputs, report};

use crate::arguments::{Diagnose, ReportFormat};
use crate::failure::Failure;
use crate::output::print;
use crate::recorded::{self, Recorded};
use display::Display;
use files::Files;

/// Runs the command. Status 0 whatever is found.
pub(crate) fn run(arguments: &Diagnose) -> Result<(), Failure> {
    let paths: Vec<PathBuf> = arguments.recordings.iter().chain(&arguments.holdout).cloned().collect();
    let recorded = recorded::read_all(&paths)?;
    let inputs: Vec<(Files, &Recorded)> =
        recorded.iter().zip(&paths).map(|(recorded, path)| (Files::of(recorded, path), recorded)).collect();
    let Some((first_files, first)) = inputs.first() else { return Ok(()) };
    if let Some(target) = &arguments.write_calibration {
        files::check_target(target, &inputs)?;
    }
    let diagnosis = diagnosed(arguments, &recorded)?;
    // The report is shown also where the calibration cannot be written, the calibration is written also where the reader
    // of the report is gone.
    let target = arguments.write_calibration.as_ref();
    let written = target.map_or(Ok(()), |target| improved::write(target, first, first_files, &diagnosis));
    print(&match arguments.format {
        ReportFormat::Text => report::text(&diagnosis),
        ReportFormat::Json => report::json(&diagnosis),
        ReportFormat::Html => report::html(&diagnosis),
    })?;
    written
}

/// The diagnosis of the recordings, the last of which is held out where the arguments say so.
fn diagnosed(arguments: &Diagnose, recorded: &[Recorded]) -> Result<Diagnosis, Failure> {
    let (fitted, held_out) = recorded.split_at(arguments.recordings.len().min(recorded.len()));
    let Some(first) = fitted.first() else { return Ok(Diagnosis::default()) };
    let inputs = Inputs {
        equations: &first.equations,
        calibration: first.calibration.as_ref().map(|known| &known.calibration),
        recordings: fitted.iter().map(|recorded| &recorded.recording).collect(),
        holdout: held_out.first().map(|recorded| &recorded.recording),
    };
    let mut display = Display::new(arguments.quiet);
    let diagnosis = diagnosis::diagnose(&inputs, &mut |progress| display.show(&progress));
    drop(display);
    if diagnosis.recordings.iter().all(|recording| recording.samples == 0) {
        return Err(Failure::No("error: the recordings hold no sample that could be used".to_owned()));
    }
    Ok(diagnosis)
}
