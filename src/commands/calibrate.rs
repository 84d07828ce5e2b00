//! `abbe calibrate`: instruments' files into a calibration. In: a set-up file and the files that it names. Out: what they show,
//! with uncertainties, as text or JSON, and the calibration.

mod corrections;
pub(super) mod files;
mod volumetric;

use std::path::{Path, PathBuf};

use exchange::instrument::file::{self, Columns};
use exchange::instrument::setup::{self, Measurement, Setup};
use exchange::instrument::{Findings, Measured, Outcome, calibrate, report};
use model_dsl::calibration;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use workshop::failure::Failure;
use workshop::load;
use workshop::named::machine_name;
use workshop::recorded::unusable;
use workshop::written::{self, comment, folder};

use crate::arguments::{Calibrate, CalibrateFormat};
use crate::output::{Person, print, show};

/// Runs the command.
pub(crate) fn run(arguments: &Calibrate) -> Result<(), Failure> {
    let path = files::setup_among(&arguments.files)?;
    let read = Read::new(path)?;
    if let Some(target) = &arguments.output {
        written::check_folder(target, "--output")?;
        written::check_new(target, ("--output", "calibration.yaml"), &read.others(path), arguments.force)?;
    }
    let outcome = read.outcome()?;
    // The report is shown also where the file cannot be written, the file is written also where the reader is gone.
    let written = arguments.output.as_ref().map_or(Ok(()), |target| read.write(target, path, &outcome));
    print(&match arguments.format {
        CalibrateFormat::Text => report::text(&outcome, &read.equations),
        CalibrateFormat::Json => report::json(&outcome, &read.equations),
    })?;
    written
}

/// A set-up with all that it names.
pub(super) struct Read {
    pub(super) source: SourceFile,
    pub(super) equations: Equations,
    pub(super) setup: Setup,
    pub(super) data: Vec<Measured>,
    data_paths: Vec<PathBuf>,
}

impl Read {
    fn new(path: &Path) -> Result<Self, Failure> {
        Self::of(load::read(path)?, path)
    }

    /// Reads what a set-up names, whose paths count from the folder of `path`.
    pub(super) fn of(source: SourceFile, path: &Path) -> Result<Self, Failure> {
        let mut diagnostics = Diagnostics::new();
        let wrong = |diagnostics: &Diagnostics| Failure::marked(&source, diagnostics);
        let root = yaml::read(&source, &mut diagnostics).ok_or_else(|| wrong(&diagnostics))?;
        let name = setup::machine_of(&root, &mut diagnostics).ok_or_else(|| wrong(&diagnostics))?;
        let loaded = load::machine(&name.value, path.parent(), &Person::default())
            .map_err(|failure| unusable(&source, "E0913", "machine", &name, failure))?;
        let equations = loaded.compiled.equations;
        let setup = setup::read(&root, &equations, &mut diagnostics);
        let mut setup = setup.filter(|_| !diagnostics.has_errors()).ok_or_else(|| wrong(&diagnostics))?;
        volumetric::take(&mut setup, &source, path, &equations, &mut diagnostics)?;
        corrections::take(&mut setup, &source, path, &equations, &mut diagnostics)?;
        if diagnostics.has_errors() {
            return Err(wrong(&diagnostics));
        }
        show(&source, &diagnostics);
        let data_paths: Vec<PathBuf> =
            setup.measurements.iter().map(|one| path.with_file_name(&one.data.value)).collect();
        let data = setup.measurements.iter().zip(&data_paths);
        let data = data.map(|(one, path)| read_data(&source, one, path, &equations));
        let data = data.collect::<Result<_, _>>()?;
        Ok(Self { source, equations, setup, data, data_paths })
    }

    /// All files that were read.
    fn others(&self, path: &Path) -> Vec<PathBuf> {
        let machine = path.with_file_name(&self.setup.known.machine.value);
        let taken = self.setup.taken().map(|name| path.with_file_name(&name.value));
        self.data_paths.iter().cloned().chain(taken).chain([path.to_owned(), machine]).collect()
    }

    fn outcome(&self) -> Result<Outcome, Failure> {
        let mut findings = Findings::default();
        let outcome = calibrate(&self.setup, &self.data, &self.equations, &mut findings);
        for (file, found) in self.data.iter().zip(&findings.data) {
            show(&file.source, found);
        }
        let wrong = || Failure::marked(&self.source, &findings.setup);
        let outcome = outcome.ok_or_else(wrong)?;
        show(&self.source, &findings.setup);
        Ok(outcome)
    }

    /// Writes the calibration, its machine file named from its own folder.
    fn write(&self, target: &Path, path: &Path, outcome: &Outcome) -> Result<(), Failure> {
        let mut new = outcome.calibration.clone();
        new.machine.value = machine_name(&new.machine.value, path, &folder(target))?;
        let about = [format!("Written by abbe calibrate from {}.", path.display())];
        let names: Vec<&str> = self.setup.taken().map(|name| name.value.as_str()).collect();
        let taken = (!names.is_empty())
            .then(|| format!("Error motions that are not measured are those of {}.", names.join(", ")));
        let about = about.into_iter().chain(taken).chain(report::comments(outcome, &self.equations));
        let comments: String = about.map(|line| comment(&line)).collect();
        let text = comments + &calibration::write(&new, &self.equations.names());
        written::calibration(target, &text, &self.equations)
    }
}

/// Reads the file of a measurement; what is wrong stands at its place there, below the place of its name in the set-up (E0914).
fn read_data(
    setup: &SourceFile,
    one: &Measurement,
    path: &Path,
    equations: &Equations,
) -> Result<Measured, Failure> {
    let not = |failure: Failure| unusable(setup, "E0914", "file", &one.data, failure);
    // Of a file of samples the head is enough to say what it is, however long it is; a pipe can be read once.
    let head = load::head_of_file(path).map_err(not)?.filter(|head| file::is_dynamic(head));
    let bytes = head.map_or_else(|| load::bytes(path).map_err(not), Ok)?;
    let source = file::text(&path.display().to_string(), &bytes);
    let letter = equations.axes.get(one.axis).map(|axis| axis.letter.clone());
    let motion = equations.motions.get(one.motion.value).map(|motion| motion.name.clone());
    let columns = Columns {
        target: one.target_column.as_deref(),
        deviation: one.deviation_column.as_deref(),
        targets_like: letter.into_iter().collect(),
        deviations_like: motion.into_iter().collect(),
    };
    let mut diagnostics = Diagnostics::new();
    let measured = file::read(source.clone(), &columns, &mut diagnostics);
    match measured {
        Some(measured) => {
            show(&measured.source, &diagnostics);
            Ok(measured)
        }
        None => Err(not(Failure::marked(&source, &diagnostics))),
    }
}
