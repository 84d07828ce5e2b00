//! `abbe update`: the coefficients of a calibration, changed to what measured parts show. In: a calibration, recordings of
//! parts. Out: what was changed and what that rests on, as text or JSON, and the new calibration.

use std::path::{Path, PathBuf};

use update::{Method, Options, Update, report};
use workshop::calibrated::{self, Calibrated};
use workshop::failure::Failure;
use workshop::named::Files;
use workshop::recorded::{self, Recorded};
use workshop::updated;
use workshop::written::{self, folder};

use crate::arguments::{Update as Arguments, UpdateFormat, UpdateMethod};
use crate::output::{Person, print};

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let known = calibrated::read(&arguments.calibration, &Person::default())?;
    let mut parts = recorded::read_all(&arguments.measurements, &Person::new(arguments.quiet))?;
    if arguments.datum.turned {
        parts.iter_mut().for_each(|part| part.recording.free_datum = true);
    }
    let person = Person::new(arguments.quiet);
    updated::check_machine((&known, &arguments.calibration), &parts, &person)?;
    if let Some(target) = &arguments.output {
        check_target(target, arguments, &known, &parts)?;
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

/// Refuses a place that cannot be written to, before any work is done.
fn check_target(
    target: &Path,
    arguments: &Arguments,
    known: &Calibrated,
    parts: &[Recorded],
) -> Result<(), Failure> {
    let wrong = |what: &str, help: &str| {
        Err(Failure::wrong(format!("error: {} {what}\nhelp: {help}", target.display())))
    };
    if !folder(target).is_dir() {
        return wrong("cannot be written: there is no such folder", "--output takes the name of a file");
    }
    if target.file_name().is_none() || target.is_dir() {
        return wrong("is a folder", "--output takes the name of a file");
    }
    let machine = known.calibration.machine.value.as_str();
    let parts = parts.iter().zip(&arguments.measurements);
    let mut read: Vec<PathBuf> = parts.flat_map(|(part, path)| Files::of(part, path).all(None)).collect();
    read.extend([arguments.calibration.clone(), arguments.calibration.with_file_name(machine)]);
    let same = |file: PathBuf| file.canonicalize().ok().zip(target.canonicalize().ok());
    if read.into_iter().filter_map(same).any(|(file, target)| file == target) {
        return wrong("is one of the files that the update is read from", "--output takes another name");
    }
    if target.exists() && !arguments.force {
        return wrong("is there already", "--output takes another place, --force replaces it");
    }
    Ok(())
}

/// Writes the new calibration, its machine file named from its own folder.
fn write(target: &Path, arguments: &Arguments, known: &Calibrated, updated: &Update) -> Result<(), Failure> {
    let text = updated::text(target, (known, &arguments.calibration), updated)?;
    written::calibration(target, &text, &known.equations)
}
