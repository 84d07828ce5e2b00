//! What a calibration predicts. In: a calibrated machine, and a path file or a recording that is replayed. Out: what would be read, and
//! the two files of a recording.

mod output;
mod replay;

use std::path::{Path, PathBuf};

use model_dsl::calibration::MachineNames;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use simulation::file::{self, PathFile};
use simulation::{Plant, Simulated};

use crate::calibrated::{self, Calibrated};
use crate::failure::Failure;
use crate::named::Files;
use crate::recorded::Recorded;
use crate::told::{Listener, Words};

pub use output::Output;

/// What the calibration predicts along the path of a path file; `seed` is that of the noise, in place of the file's.
///
/// # Errors
///
/// What is wrong in the file, at its places; a path that the machine cannot drive.
pub fn driven(
    source: &SourceFile,
    calibrated: &Calibrated,
    seed: Option<u64>,
    listener: &dyn Listener,
) -> Result<Simulated, Failure> {
    let names = calibrated.equations.names();
    let mut plant = plant(calibrated)?;
    let PathFile { mut scenario, .. } = read_path(source, calibrated, &names, &mut plant, listener)?;
    if let Some(seed) = seed {
        scenario.measurement.seed = seed;
    }
    listener.begin("driving the path");
    let simulated = simulation::simulate(&plant, &scenario);
    listener.end();
    simulated.map_err(|error| wrong(&error))
}

/// The files that a simulation reads: a calibration by the name of its file, its machine, the calibration that is known, and a path file or
/// a recording with what it names. None of them may be written over.
#[must_use]
pub fn files_read(
    (calibrated, path): (&Calibrated, &Path),
    known: Option<&Path>,
    (driven, driven_path): (&SourceFile, &Path),
) -> Vec<PathBuf> {
    let machine = path.with_file_name(&calibrated.calibration.machine.value);
    let read = [path.to_owned(), machine].into_iter().chain(known.map(Path::to_owned));
    // A path names no other file; a recording names its data.
    read.chain(Files::named_in(driven, driven_path).all(None)).collect()
}

/// What a calibration, by the name of its file, predicts in place of a recording, without noise.
///
/// # Errors
///
/// A recording of another machine, or of what cannot be replayed.
pub fn replayed(
    recorded: &Recorded,
    (calibrated, path): (&Calibrated, &Path),
    listener: &dyn Listener,
) -> Result<Simulated, Failure> {
    let names = calibrated.equations.names();
    if is_reordered(recorded, &names) {
        let text = format!(
            "warning: {} is a recording of {}, but the simulated machine is {}, which has the same axes in another order",
            recorded.source.name(),
            recorded.equations.machine,
            names.machine
        );
        listener.hear(&text.into());
    } else if recorded.equations.names() != names {
        return Err(Failure::wrong(format!(
            "error: {} is a recording of {}, but {} is a calibration of {}\nhelp: give both for the same machine",
            recorded.source.name(),
            recorded.equations.machine,
            path.display(),
            names.machine
        )));
    }
    let calibration = recorded.recording.calibrated(&calibrated.calibration);
    let plant = Plant::new(&calibrated.machine, &names, &calibration).map_err(|error| wrong(&error))?;
    listener.begin("driving the recording's path");
    let simulated = replay::replayed(plant, &recorded.recording);
    listener.end();
    simulated.map_err(|reason| wrong(&reason))
}

/// Whether a calibration is for the machine of a recording with the letters of its topology word in another order, as `abbe diagnose`
/// writes one where the word was wrong.
fn is_reordered(recorded: &Recorded, names: &MachineNames) -> bool {
    let known = recorded.equations.names();
    let letters = |word: &str| {
        let mut letters: Vec<char> = word.chars().collect();
        letters.sort_unstable();
        letters
    };
    known.machine != names.machine
        && recorded.topology.as_ref().is_some_and(|topology| topology.word == known.machine)
        && letters(&known.machine) == letters(&names.machine)
        && (&known.axes, &known.constants) == (&names.axes, &names.constants)
}

/// The exact machine of a calibration.
///
/// # Errors
///
/// What cannot be simulated of it.
pub fn plant(calibrated: &Calibrated) -> Result<Plant, Failure> {
    let names = calibrated.equations.names();
    Plant::new(&calibrated.machine, &names, &calibrated.calibration).map_err(|error| wrong(&error))
}

/// A refusal in the words of whoever refuses.
pub fn wrong(error: &dyn std::fmt::Display) -> Failure {
    Failure::wrong(format!("error: {error}"))
}

/// Whether a file is a recording rather than a path; what else it may be is told by who reads paths.
pub fn is_recording(source: &SourceFile) -> bool {
    let root = yaml::read(source, &mut Diagnostics::new());
    root.is_some_and(|root| root.get("recording").is_some())
}

/// Reads a path file for a machine; the plant must hold what it drives.
///
/// # Errors
///
/// What is wrong in it, at its places.
pub fn read_path(
    source: &SourceFile,
    calibrated: &Calibrated,
    names: &MachineNames,
    plant: &mut Plant,
    listener: &dyn Listener,
) -> Result<PathFile, Failure> {
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(source, &mut diagnostics);
    let file = root.and_then(|root| file::read(&root, &calibrated.machine, names, &mut diagnostics));
    if let Some(file) = &file {
        file.fit(&calibrated.machine, plant, &mut diagnostics);
    }
    match file.filter(|_| !diagnostics.has_errors()) {
        Some(file) => {
            listener.hear(&Words::marked(source, &diagnostics));
            Ok(file)
        }
        None => Err(Failure::marked(source, &diagnostics)),
    }
}

/// The calibration that a simulated recording is to name: one of the same machine.
///
/// # Errors
///
/// One of another machine.
pub fn known_calibration(
    path: &Path,
    names: &MachineNames,
    listener: &dyn Listener,
) -> Result<PathBuf, Failure> {
    let known = calibrated::read(path, listener)?;
    if known.equations.names() != *names {
        return Err(Failure::wrong(format!(
            "error: {} is a calibration of {}, not of {}\nhelp: give --known another calibration of the same machine",
            path.display(),
            known.equations.machine,
            names.machine
        )));
    }
    Ok(path.to_owned())
}
