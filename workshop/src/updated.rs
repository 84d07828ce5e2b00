//! The coefficients of a calibration, changed to what measured parts show. In: a calibration, recordings of parts. Out: what was changed,
//! and the new calibration file.

use std::path::{Path, PathBuf};

use model_dsl::calibration;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::yaml;
use update::{Inputs, Options, Update, UpdateError};

use crate::calibrated::Calibrated;
use crate::failure::Failure;
use crate::named::{Files, machine_name};
use crate::recorded::Recorded;
use crate::told::Listener;
use crate::written::{comment, folder};

/// Where the zero of a part is free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Datum {
    /// The directions X, Y, Z in which it is.
    pub displaced: [bool; 3],
    /// Whether the part lies turned as well, as one does that was measured on another machine than it was made on.
    pub turned: bool,
}

/// Reads `free`, `turned`, `none` or directions.
///
/// # Errors
///
/// What to write instead.
pub fn datum(text: &str) -> Result<Datum, String> {
    let all = |displaced, turned| Datum { displaced: [displaced; 3], turned };
    match text {
        "free" => return Ok(all(true, false)),
        "turned" => return Ok(all(true, true)),
        "none" => return Ok(all(false, false)),
        _ => {}
    }
    let mut free = [false; 3];
    for word in text.split(',') {
        let place = ["x", "y", "z"].iter().position(|letter| word.trim().eq_ignore_ascii_case(letter));
        match place.and_then(|place| free.get_mut(place)) {
            Some(slot) => *slot = true,
            None => {
                return Err("write `free`, `turned`, `none`, or directions such as `z` or `x,z`".to_owned());
            }
        }
    }
    Ok(Datum { displaced: free, turned: false })
}

/// All files that an update is read from: the calibration with its machine, and the recordings with what they name.
pub fn files<'p>(
    (known, calibration): (&Calibrated, &Path),
    parts: impl IntoIterator<Item = (&'p Recorded, &'p Path)>,
) -> Vec<PathBuf> {
    let parts = parts.into_iter().flat_map(|(part, path)| Files::of(part, path).all(None));
    let machine = calibration.with_file_name(&known.calibration.machine.value);
    parts.chain([calibration.to_owned(), machine]).collect()
}

/// Updates a calibration from recordings of parts of its machine, which are [checked](check_machine) already.
///
/// # Errors
///
/// Parts that cannot serve.
pub fn update(
    known: &Calibrated,
    parts: &[Recorded],
    options: &Options,
    listener: &dyn Listener,
) -> Result<Update, Failure> {
    let inputs = Inputs {
        equations: &known.equations,
        calibration: &known.calibration,
        recordings: parts.iter().map(|part| &part.recording).collect(),
    };
    listener.begin("solving for the coefficients");
    let updated = update::update(&inputs, options);
    listener.end();
    updated.map_err(|error| refused(&error, parts))
}

/// The text of the new calibration file as it stands at `target`, its machine file named from there.
///
/// # Errors
///
/// A path that no file could name.
pub fn text(target: &Path, (known, path): (&Calibrated, &Path), updated: &Update) -> Result<String, Failure> {
    let mut new = updated.calibration.clone();
    new.machine.value = machine_name(&new.machine.value, path, &folder(target))?;
    Ok(comments(path, updated) + &calibration::write(&new, &known.equations.names()))
}

/// The parts must be of the machine whose calibration it is; another one that a recording counts on is told. `path` is the
/// calibration's file.
///
/// # Errors
///
/// The first part of another machine.
pub fn check_machine(
    (known, path): (&Calibrated, &Path),
    parts: &[Recorded],
    listener: &dyn Listener,
) -> Result<(), Failure> {
    for part in parts {
        if part.equations.names() != known.equations.names() {
            return Err(Failure::wrong(format!(
                "error: {} is a recording of {}, but {} is a calibration of {}\nhelp: give both for the same machine",
                part.source.name(),
                part.equations.machine,
                path.display(),
                known.equations.machine
            )));
        }
        let other = part.calibration.as_ref().is_some_and(|own| own.calibration != known.calibration);
        if other {
            let text = format!(
                "warning: {} names another calibration; the updated one is {}",
                part.source.name(),
                path.display()
            );
            listener.hear(&text.into());
        }
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
            let help = "use abbe diagnose for other instruments; a part is measured as positions, along normals, or as lengths (ballbar)";
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

/// Where the numbers come from, as comments at the top.
fn comments(path: &Path, updated: &Update) -> String {
    let parts: Vec<&str> = updated.parts.iter().map(|part| part.file.as_str()).collect();
    let moved = updated.changes.len();
    let left = updated.residuals.iter().find(|residual| residual.direction == "all");
    let left = left.map_or(String::new(), |all| {
        format!("Rms at the points {:.6} mm before, {:.6} mm after.", all.before.rms, all.after.rms)
    });
    let lines = [
        format!("Written by abbe update from {} and {}.", path.display(), parts.join(", ")),
        format!(
            "Method {}, {} readings, rank {}; {moved} of {} coefficients changed.",
            updated.options.method.name(),
            updated.points,
            updated.rank,
            updated.unknowns
        ),
        left,
        "It holds for the places and temperatures of the parts. It is not tested elsewhere.".to_owned(),
    ];
    lines.map(|line| comment(&line)).concat()
}
