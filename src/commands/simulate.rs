//! `abbe simulate`: the recording that a calibration predicts, along a path or in place of another recording, as two files.

mod replay;

use std::io::Write;
use std::path::{Path, PathBuf};

use model_dsl::calibration::MachineNames;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use simulation::file::{self, PathFile};
use simulation::picture;
use simulation::write::{self, Head};
use simulation::{Plant, Simulated};
use workshop::calibrated::{self, Calibrated};
use workshop::failure::Failure;
use workshop::load;
use workshop::named::{Files, machine_name, relative};
use workshop::recorded::{self, Recorded};
use workshop::written;

use crate::arguments::Simulate;
use crate::output::{Person, show, warn};
use crate::progress::Progress;

/// Runs the command.
pub(crate) fn run(command: &Simulate) -> Result<(), Failure> {
    let calibrated = calibrated::read(&command.calibration, &Person::default())?;
    let names = calibrated.equations.names();
    let known = command.known.as_deref().map(|known| known_calibration(known, &names)).transpose()?;
    let output = Output::of(&command.output);
    output.check(command.force)?;
    let source = load::read(&command.path)?;
    if let Some(plot) = &command.plot {
        written::check_picture(
            plot,
            "--plot",
            &others(command, &calibrated, &source, &output),
            command.force,
        )?;
    }
    let simulated = match is_recording(&source) {
        true => replayed(command, &calibrated, &names)?,
        false => driven(command, &source, &calibrated, &names)?,
    };
    let folder = output.folder()?;
    if let Some(plot) = &command.plot {
        written::check_folder(plot, "--plot")?;
    }
    let machine = machine_name(&calibrated.calibration.machine.value, &command.calibration, &folder)?;
    let calibration = known.map(|known| relative(&folder, &known)).transpose()?;
    let head = Head { machine, calibration, data: output.data.clone(), axes: names.axes.clone() };
    let progress = Progress::new(command.quiet, "writing the recording");
    let written = output.write(&simulated, &head);
    drop(progress);
    written?;
    if let Some(plot) = &command.plot {
        let progress = Progress::new(command.quiet, "drawing");
        let drawing = picture::svg(&simulated, &plant(&calibrated, &names)?);
        drop(progress);
        written::whole(plot, &drawing)?;
    }
    let rows = simulated.time.len();
    warn(&format!("{rows} rows: {} and {}", output.recording.display(), output.data_path().display()));
    Ok(())
}

/// All other files that the command reads and writes: a picture is none of them.
fn others(command: &Simulate, calibrated: &Calibrated, source: &SourceFile, output: &Output) -> Vec<PathBuf> {
    let machine = command.calibration.with_file_name(&calibrated.calibration.machine.value);
    let read = [command.calibration.clone(), machine].into_iter().chain(command.known.clone());
    // A path names no other file; a recording names its data.
    let read = read.chain(Files::named_in(source, &command.path).all(None));
    read.chain([output.recording.clone(), output.data_path()]).collect()
}

/// What the calibration predicts along the path.
fn driven(
    command: &Simulate,
    source: &SourceFile,
    calibrated: &Calibrated,
    names: &MachineNames,
) -> Result<Simulated, Failure> {
    let mut plant = plant(calibrated, names)?;
    let PathFile { mut scenario, .. } = read_path(source, calibrated, names, &mut plant)?;
    if let Some(seed) = command.seed {
        scenario.measurement.seed = seed;
    }
    let progress = Progress::new(command.quiet, "driving the path");
    let simulated = simulation::simulate(&plant, &scenario);
    drop(progress);
    simulated.map_err(|error| wrong(&error))
}

/// What the calibration predicts in place of the recording.
fn replayed(command: &Simulate, calibrated: &Calibrated, names: &MachineNames) -> Result<Simulated, Failure> {
    if command.seed.is_some() {
        let help = "help: leave --seed out: what a calibration predicts for a recording has no noise";
        return Err(Failure::wrong(format!("error: {} is a recording\n{help}", command.path.display())));
    }
    let recorded = recorded::read(&command.path, &Person::new(command.quiet))?;
    if is_reordered(&recorded, names) {
        warn(&format!(
            "warning: {} is a recording of {}; what is simulated is {}, which has the same axes in another order",
            command.path.display(),
            recorded.equations.machine,
            names.machine
        ));
    } else if recorded.equations.names() != *names {
        return Err(Failure::wrong(format!(
            "error: {} is a recording of {}, {} a calibration of {}\nhelp: give both for the same machine",
            command.path.display(),
            recorded.equations.machine,
            command.calibration.display(),
            names.machine
        )));
    }
    let calibration = recorded.recording.calibrated(&calibrated.calibration);
    let plant = Plant::new(&calibrated.machine, names, &calibration).map_err(|error| wrong(&error))?;
    let progress = Progress::new(command.quiet, "driving the recording's path");
    let simulated = replay::replayed(plant, &recorded.recording);
    drop(progress);
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

fn plant(calibrated: &Calibrated, names: &MachineNames) -> Result<Plant, Failure> {
    Plant::new(&calibrated.machine, names, &calibrated.calibration).map_err(|error| wrong(&error))
}

pub(super) fn wrong(error: &dyn std::fmt::Display) -> Failure {
    Failure::wrong(format!("error: {error}"))
}

/// Whether a file is a recording rather than a path; what else it may be is told by who reads paths.
fn is_recording(source: &SourceFile) -> bool {
    let root = yaml::read(source, &mut Diagnostics::new());
    root.is_some_and(|root| root.get("recording").is_some())
}

pub(super) fn read_path(
    source: &SourceFile,
    calibrated: &Calibrated,
    names: &MachineNames,
    plant: &mut Plant,
) -> Result<PathFile, Failure> {
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(source, &mut diagnostics);
    let file = root.and_then(|root| file::read(&root, &calibrated.machine, names, &mut diagnostics));
    if let Some(file) = &file {
        file.fit(&calibrated.machine, plant, &mut diagnostics);
    }
    match file.filter(|_| !diagnostics.has_errors()) {
        Some(file) => {
            show(source, &diagnostics);
            Ok(file)
        }
        None => Err(Failure::marked(source, &diagnostics)),
    }
}

/// The calibration that the recording names: one of the same machine.
fn known_calibration(path: &Path, names: &MachineNames) -> Result<PathBuf, Failure> {
    let known = calibrated::read(path, &Person::default())?;
    if known.equations.names() != *names {
        return Err(Failure::wrong(format!(
            "error: {} is a calibration of {}, not of {}\nhelp: --known takes another calibration of the same machine",
            path.display(),
            known.equations.machine,
            names.machine
        )));
    }
    Ok(path.to_owned())
}

/// Where the two files go.
struct Output {
    recording: PathBuf,
    /// The name of the data file, beside the recording.
    data: String,
}

impl Output {
    fn of(path: &Path) -> Self {
        let is_file = path.extension().is_some_and(|extension| extension == "yaml" || extension == "yml");
        match path.file_stem().filter(|_| is_file) {
            Some(stem) => {
                Self { recording: path.to_owned(), data: format!("{}.csv", stem.to_string_lossy()) }
            }
            None => Self { recording: path.join("recording.yaml"), data: "data.csv".to_owned() },
        }
    }

    fn data_path(&self) -> PathBuf {
        self.recording.with_file_name(&self.data)
    }

    fn check(&self, force: bool) -> Result<(), Failure> {
        let there = [self.recording.clone(), self.data_path()].into_iter().find(|path| path.exists());
        match there.filter(|_| !force) {
            Some(path) => Err(Failure::wrong(format!(
                "error: {} is there already\nhelp: --output takes another place, --force replaces it",
                path.display()
            ))),
            None => Ok(()),
        }
    }

    /// Writes both files; they get their names only when both are complete.
    fn write(&self, simulated: &Simulated, head: &Head) -> Result<(), Failure> {
        let (data_path, recording) = (self.data_path(), write::recording(simulated, head));
        let data = written::staged(&data_path, |file| write::table(simulated, &head.axes, file))?;
        let head = written::staged(&self.recording, |file| file.write_all(recording.as_bytes()))?;
        data.keep().map_err(|error| written::cannot_write(&data_path, &error))?;
        head.keep().map_err(|error| written::cannot_write(&self.recording, &error))
    }

    /// The folder, made where it is missing.
    fn folder(&self) -> Result<PathBuf, Failure> {
        let folder = match self.recording.parent() {
            Some(parent) if parent != Path::new("") => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        std::fs::create_dir_all(&folder)
            .map_err(|error| Failure::io(&format!("cannot make {}", folder.display()), &error))?;
        Ok(folder)
    }
}
