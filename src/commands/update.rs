//! `abbe update`: the coefficients of a calibration, changed to what measured parts show. In: a calibration, recordings of
//! parts. Out: what was changed and what that rests on, as text or JSON, and the new calibration.

use std::path::{Path, PathBuf};

use model_dsl::calibration;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::yaml;
use update::{Inputs, Method, Options, Update, UpdateError, report};
use workshop::calibrated::{self, Calibrated};
use workshop::failure::Failure;
use workshop::named::Files;
use workshop::named::machine_name;
use workshop::recorded::{self, Recorded};
use workshop::written::{self, comment, folder};

use crate::arguments::{Update as Arguments, UpdateFormat, UpdateMethod};
use crate::output::{Person, print, warn};
use crate::progress::Progress;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let known = calibrated::read(&arguments.calibration, &Person::default())?;
    let mut parts = recorded::read_all(&arguments.measurements, &Person::new(arguments.quiet))?;
    if arguments.datum.turned {
        parts.iter_mut().for_each(|part| part.recording.free_datum = true);
    }
    check_machine(arguments, &known, &parts)?;
    if let Some(target) = &arguments.output {
        check_target(target, arguments, &known, &parts)?;
    }
    let inputs = Inputs {
        equations: &known.equations,
        calibration: &known.calibration,
        recordings: parts.iter().map(|part| &part.recording).collect(),
    };
    let progress = Progress::new(arguments.quiet, "solving for the coefficients");
    let updated = update::update(&inputs, &options(arguments));
    drop(progress);
    let updated = updated.map_err(|error| refused(&error, &parts))?;
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

/// The parts must be of the machine whose calibration it is; another one that a recording counts on is told.
fn check_machine(arguments: &Arguments, known: &Calibrated, parts: &[Recorded]) -> Result<(), Failure> {
    for part in parts {
        if part.equations.names() != known.equations.names() {
            return Err(Failure::wrong(format!(
                "error: {} is a recording of {}, {} a calibration of {}\nhelp: give both for the same machine",
                part.source.name(),
                part.equations.machine,
                arguments.calibration.display(),
                known.equations.machine
            )));
        }
        let other = part.calibration.as_ref().is_some_and(|own| own.calibration != known.calibration);
        if other {
            warn(&format!(
                "warning: {} counts on another calibration; it is {} that is updated",
                part.source.name(),
                arguments.calibration.display()
            ));
        }
    }
    Ok(())
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

/// Where a recording cannot serve, its place is marked; the rest is said as it is.
fn refused(error: &UpdateError, parts: &[Recorded]) -> Failure {
    let (number, code, key, help) = match error {
        UpdateError::NoTemperature { recording, sensor } => {
            let help = format!("add `temperature.{sensor}: {{column: ..., unit: degC}}`");
            (*recording, "E0626", "channels", help)
        }
        UpdateError::Instrument { recording } => {
            let help =
                "abbe diagnose reads all instruments; a part is measured along normals or in positions";
            (*recording, "E0627", "instrument", help.to_owned())
        }
        _ => return Failure::no(format!("error: {error}")),
    };
    let Some(part) = parts.get(number) else { return Failure::no(format!("error: {error}")) };
    let root = yaml::read(&part.source, &mut Diagnostics::new());
    let entries = root.as_ref().and_then(|root| root.entries()).unwrap_or(&[]);
    let place = entries.iter().find(|(name, _)| name.value == key).map(|(name, _)| name.span);
    let mut diagnostics = Diagnostics::new();
    diagnostics.push(Diagnostic::error(code, place.unwrap_or_default(), error.to_string()).help(help));
    Failure::marked(&part.source, &diagnostics)
}

/// Writes the new calibration, its machine file named from its own folder.
fn write(target: &Path, arguments: &Arguments, known: &Calibrated, updated: &Update) -> Result<(), Failure> {
    let mut new = updated.calibration.clone();
    new.machine.value = machine_name(&new.machine.value, &arguments.calibration, &folder(target))?;
    let text = comments(arguments, updated) + &calibration::write(&new, &known.equations.names());
    written::calibration(target, &text, &known.equations)
}

/// Where the numbers come from, as comments at the top.
fn comments(arguments: &Arguments, updated: &Update) -> String {
    let parts: Vec<&str> = updated.parts.iter().map(|part| part.file.as_str()).collect();
    let moved = updated.changes.len();
    let left = updated.residuals.iter().find(|residual| residual.direction == "all");
    let left = left.map_or(String::new(), |all| {
        format!("Rms at the points {:.6} mm before, {:.6} mm after.", all.before.rms, all.after.rms)
    });
    let lines = [
        format!("Written by abbe update from {} and {}.", arguments.calibration.display(), parts.join(", ")),
        format!(
            "Method {}, {} readings, rank {}; {moved} of {} coefficients changed.",
            updated.options.method.name(),
            updated.points,
            updated.rank,
            updated.unknowns
        ),
        left,
        "It holds where and at what temperatures the parts were made; elsewhere it is not tested.".to_owned(),
    ];
    lines.map(|line| comment(&line)).concat()
}
