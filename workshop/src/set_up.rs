//! Instruments' files into a calibration. In: a set-up file and the files that it names. Out: what they show, with uncertainties, and
//! the calibration file.

mod corrections;
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

use crate::failure::Failure;
use crate::load;
use crate::named::machine_name;
use crate::recorded::unusable;
use crate::told::{Listener, Words};
use crate::written::{comment, folder};

/// A set-up with all that it names.
pub struct SetUp {
    /// The equations of its machine.
    pub equations: Equations,
    /// Its file.
    pub source: SourceFile,
    /// What it says.
    pub setup: Setup,
    /// The data of its measurements, in their order.
    pub data: Vec<Measured>,
    path: PathBuf,
    data_paths: Vec<PathBuf>,
}

impl SetUp {
    /// Reads a set-up by its text and its path, from which the files that it names are found.
    ///
    /// # Errors
    ///
    /// What is wrong in it or in one of the files, at its place.
    pub fn read(source: SourceFile, path: &Path, listener: &dyn Listener) -> Result<Self, Failure> {
        let mut diagnostics = Diagnostics::new();
        let wrong = |diagnostics: &Diagnostics| Failure::marked(&source, diagnostics);
        let root = yaml::read(&source, &mut diagnostics).ok_or_else(|| wrong(&diagnostics))?;
        let name = setup::machine_of(&root, &mut diagnostics).ok_or_else(|| wrong(&diagnostics))?;
        let loaded = load::machine(&name.value, path.parent(), listener)
            .map_err(|failure| unusable(&source, "E0913", "machine", &name, failure))?;
        let equations = loaded.compiled.equations;
        let setup = setup::read(&root, &equations, &mut diagnostics);
        let mut setup = setup.filter(|_| !diagnostics.has_errors()).ok_or_else(|| wrong(&diagnostics))?;
        volumetric::take(&mut setup, &source, path, &equations, &mut diagnostics, listener)?;
        corrections::take(&mut setup, &source, path, &equations, &mut diagnostics, listener)?;
        if diagnostics.has_errors() {
            return Err(wrong(&diagnostics));
        }
        listener.hear(&Words::marked(&source, &diagnostics));
        let data_paths: Vec<PathBuf> =
            setup.measurements.iter().map(|one| path.with_file_name(&one.data.value)).collect();
        let data = setup.measurements.iter().zip(&data_paths);
        let data = data.map(|(one, path)| read_data(&source, one, path, &equations, listener));
        let data = data.collect::<Result<_, _>>()?;
        Ok(Self { equations, source, path: path.to_owned(), setup, data, data_paths })
    }

    /// All files that were read.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        let path = &self.path;
        let machine = path.with_file_name(&self.setup.known.machine.value);
        let taken = self.setup.taken().map(|name| path.with_file_name(&name.value));
        self.data_paths.iter().cloned().chain(taken).chain([path.clone(), machine]).collect()
    }

    /// What the measurements show.
    ///
    /// # Errors
    ///
    /// Measurements that show nothing, at their places.
    pub fn outcome(&self, listener: &dyn Listener) -> Result<Outcome, Failure> {
        let mut findings = Findings::default();
        let outcome = calibrate(&self.setup, &self.data, &self.equations, &mut findings);
        for (file, found) in self.data.iter().zip(&findings.data) {
            listener.hear(&Words::marked(&file.source, found));
        }
        let wrong = || Failure::marked(&self.source, &findings.setup);
        let outcome = outcome.ok_or_else(wrong)?;
        listener.hear(&Words::marked(&self.source, &findings.setup));
        Ok(outcome)
    }

    /// The text of the calibration file as it stands at `target`, its machine file named from there.
    ///
    /// # Errors
    ///
    /// A path that no file could name.
    pub fn calibration(&self, target: &Path, outcome: &Outcome) -> Result<String, Failure> {
        let path = &self.path;
        let mut new = outcome.calibration.clone();
        new.machine.value = machine_name(&new.machine.value, path, &folder(target))?;
        let about = [format!("Written by abbe calibrate from {}.", path.display())];
        let names: Vec<&str> = self.setup.taken().map(|name| name.value.as_str()).collect();
        let taken = (!names.is_empty())
            .then(|| format!("Error motions that were not measured are those of {}.", names.join(", ")));
        let about = about.into_iter().chain(taken).chain(report::comments(outcome, &self.equations));
        let comments: String = about.map(|line| comment(&line)).collect();
        Ok(comments + &calibration::write(&new, &self.equations.names()))
    }
}

/// A number of terms in words.
fn counted(terms: usize) -> String {
    let plural = if terms == 1 { "" } else { "s" };
    format!("{terms} term{plural} of error motions")
}

/// Reads the file of a measurement; what is wrong stands at its place there, below the place of its name in the set-up (E0914).
fn read_data(
    setup: &SourceFile,
    one: &Measurement,
    path: &Path,
    equations: &Equations,
    listener: &dyn Listener,
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
            listener.hear(&Words::marked(&measured.source, &diagnostics));
            Ok(measured)
        }
        None => Err(not(Failure::marked(&source, &diagnostics))),
    }
}
