//! `abbe diagnose`: what the model leaves out. In: recordings. Out: the diagnosis as text, JSON or a page, and the
//! calibration with what was found.

use std::path::PathBuf;

use diagnosis::diagnosis::Diagnosis;
use diagnosis::report::{self, Origin};

use workshop::diagnosed::{Keep, diagnose};
use workshop::failure::Failure;
use workshop::improved;
use workshop::named::{self, Files};
use workshop::origin;
use workshop::recorded::{self, Recorded};

use crate::arguments::{Diagnose, ReportFormat};
use crate::output::Person;
use crate::progress::Progress;

/// Runs the command. Status 0 whatever is found, but for the verdicts of `--fail-on`.
pub(crate) fn run(arguments: &Diagnose) -> Result<(), Failure> {
    let paths: Vec<PathBuf> = arguments.recordings.iter().chain(&arguments.holdout).cloned().collect();
    let recorded = recorded::read_all(&paths, &Person::new(arguments.quiet))?;
    let inputs: Vec<(Files, &Recorded)> =
        recorded.iter().zip(&paths).map(|(recorded, path)| (Files::of(recorded, path), recorded)).collect();
    let Some((first_files, first)) = inputs.first() else { return Ok(()) };
    if let Some(target) = &arguments.write_calibration {
        named::check_target(target, &inputs)?;
    }
    arguments.target.check(&files_beside(arguments, &inputs))?;
    let diagnosis = diagnosed(arguments, &recorded)?;
    // The report is shown also where the calibration cannot be written, the calibration is written also where the reader
    // of the report is gone.
    let target = arguments.write_calibration.as_ref();
    let written = target.map_or(Ok(()), |target| {
        improved::write(target, first, first_files, &diagnosis, &Person::new(arguments.quiet))
    });
    arguments.target.put(&match arguments.format {
        ReportFormat::Text => report::text_on(&diagnosis, arguments.target.terminal()),
        ReportFormat::Json => report::json(&diagnosis),
        ReportFormat::Html => page(arguments, first, first_files, &diagnosis)?,
    })?;
    written?;
    let fails = arguments.fail_on.iter().any(|name| name.verdict() == diagnosis.verdict);
    if fails { Err(Failure::no("")) } else { Ok(()) }
}

/// The files that the command reads, and the calibration that it writes: the result goes over none of them.
fn files_beside(arguments: &Diagnose, inputs: &[(Files, &Recorded)]) -> Vec<PathBuf> {
    let read = inputs.iter().flat_map(|(files, recorded)| {
        let known = recorded.calibration.as_ref().map(|known| known.calibration.machine.value.as_str());
        files.all(known)
    });
    read.chain(arguments.write_calibration.clone()).collect()
}

/// The page, with the command that makes it and what the findings change in the calibration.
fn page(
    arguments: &Diagnose,
    first: &Recorded,
    files: &Files,
    diagnosis: &Diagnosis,
) -> Result<String, Failure> {
    let origin = Origin {
        command: &origin::diagnose(
            arguments.recordings.iter().map(PathBuf::as_path),
            arguments.holdout.as_deref(),
        ),
        program: concat!("abbe ", env!("CARGO_PKG_VERSION")),
        change: &improved::change(first, files, diagnosis)?,
    };
    Ok(report::html(diagnosis, &origin))
}

/// The diagnosis of the recordings, the last of which is held out where the arguments say so.
fn diagnosed(arguments: &Diagnose, recorded: &[Recorded]) -> Result<Diagnosis, Failure> {
    let (fitted, held_out) = recorded.split_at(arguments.recordings.len().min(recorded.len()));
    let progress = Progress::new(arguments.quiet, "reading the machine");
    let keep = match arguments.format {
        ReportFormat::Html => Keep::Pictures,
        ReportFormat::Text | ReportFormat::Json => Keep::Nothing,
    };
    diagnose(fitted, held_out.first(), keep, &mut |now| progress.part(now.step, now.done))
}
