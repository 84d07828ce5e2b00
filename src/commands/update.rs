//! `abbe update`: the coefficients of a calibration, changed to what measured parts show. In: a calibration, recordings of
//! parts. Out: what was changed and what that rests on, as text or JSON, and the new calibration.

use std::path::{Path, PathBuf};

use recording::PartDatum;
use update::{Method, Options, Update, report};
use workshop::calibrated::{self, Calibrated};
use workshop::failure::Failure;
use workshop::recorded;
use workshop::updated;
use workshop::written;

use crate::arguments::{Update as Arguments, UpdateFormat, UpdateMethod};
use crate::output::{Person, print};

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let known = calibrated::read(&arguments.calibration, &Person::default())?;
    let mut parts = recorded::read_all(&arguments.measurements, &Person::new(arguments.quiet))?;
    if arguments.datum.turned {
        parts.iter_mut().for_each(|part| part.recording.datum = PartDatum::Free);
    }
    let person = Person::new(arguments.quiet);
    updated::check_machine((&known, &arguments.calibration), &parts, &person)?;
    if let Some(target) = &arguments.output {
        let measurements = parts.iter().zip(arguments.measurements.iter().map(PathBuf::as_path));
        let read = updated::files((&known, &arguments.calibration), measurements);
        written::check_folder(target, "--output")?;
        written::check_new(target, ("--output", "calibration.yaml"), &read, arguments.force)?;
    }
    let updated = updated::update(&known, &parts, &options(arguments), &person)?;
    // The report is shown also where the file cannot be written, the file is written also where the reader is gone.
    let written =
        arguments.output.as_ref().map_or(Ok(()), |target| write(target, arguments, &known, &updated));
    print(&match arguments.format {
        UpdateFormat::Text => report::text(&updated),
        UpdateFormat::Json => report::json(&updated),
    })?;
    written
}

fn options(arguments: &Arguments) -> Options {
    Options {
        method: match arguments.method {
            UpdateMethod::Svd => Method::Svd,
            UpdateMethod::Ridge => Method::Ridge,
            UpdateMethod::Select => Method::Select,
        },
        tolerance: arguments.tolerance,
        datum: arguments.datum.displaced,
        compensated: arguments.compensated,
    }
}

/// Writes the new calibration, its machine file named from its own folder.
fn write(target: &Path, arguments: &Arguments, known: &Calibrated, updated: &Update) -> Result<(), Failure> {
    let text = updated::text(target, (known, &arguments.calibration), updated)?;
    written::calibration(target, &text, &known.equations)
}
