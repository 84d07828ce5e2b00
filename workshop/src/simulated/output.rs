//! The two files of a simulated recording. In: what was simulated, and where it goes. Out: both files, each whole or absent. The data file
//! gets its name first.

use std::io::Write;
use std::path::{Path, PathBuf};

use simulation::Simulated;
use simulation::write::{self, Head};

use crate::calibrated::Calibrated;
use crate::failure::Failure;
use crate::named::{machine_name, relative};
use crate::written;

/// Where the two files go.
pub struct Output {
    /// The recording file.
    pub recording: PathBuf,
    /// The name of the data file, beside the recording.
    pub data: String,
}

impl Output {
    /// The places of both in a folder; or of a recording file with its own name.
    #[must_use]
    pub fn of(path: &Path) -> Self {
        let is_file = path.extension().is_some_and(|extension| extension == "yaml" || extension == "yml");
        match path.file_stem().filter(|_| is_file) {
            Some(stem) => {
                Self { recording: path.to_owned(), data: format!("{}.csv", stem.to_string_lossy()) }
            }
            None => Self { recording: path.join("recording.yaml"), data: "data.csv".to_owned() },
        }
    }

    /// The data file.
    #[must_use]
    pub fn data_path(&self) -> PathBuf {
        self.recording.with_file_name(&self.data)
    }

    /// Refuses to replace a file, unless `force` does, and in any case one of those that are read.
    ///
    /// # Errors
    ///
    /// The file that is there already.
    pub fn check(&self, read: &[PathBuf], force: bool) -> Result<(), Failure> {
        let own = [self.recording.clone(), self.data_path()];
        if let Some(path) = own.into_iter().find(|path| written::is_one_of(path, read)) {
            return Err(Failure::wrong(format!(
                "error: {} is one of the files that this command reads\nhelp: give --output another folder or name",
                path.display()
            )));
        }
        let there = [self.recording.clone(), self.data_path()].into_iter().find(|path| path.exists());
        match there.filter(|_| !force) {
            Some(path) => Err(Failure::wrong(format!(
                "error: {} already exists\nhelp: give another path with --output, or replace it with --force",
                path.display()
            ))),
            None => Ok(()),
        }
    }

    /// Writes both files; they get their names only when both are complete.
    ///
    /// # Errors
    ///
    /// Why one of them could not be written.
    pub fn write(&self, simulated: &Simulated, head: &Head) -> Result<(), Failure> {
        let (data_path, recording) = (self.data_path(), write::recording(simulated, head));
        let data = written::staged(&data_path, |file| write::table(simulated, &head.axes, file))?;
        let file = written::staged(&self.recording, |file| file.write_all(recording.as_bytes()))?;
        written::keep(data, &data_path)?;
        written::keep(file, &self.recording)
    }

    /// The folder, made where it is missing.
    ///
    /// # Errors
    ///
    /// Why it cannot be made.
    pub fn folder(&self) -> Result<PathBuf, Failure> {
        let folder = written::folder(&self.recording);
        std::fs::create_dir_all(&folder)
            .map_err(|error| Failure::io(&format!("cannot create {}", folder.display()), &error))?;
        Ok(folder)
    }

    /// The head of the recording file, with names relative to `folder`, to which that file goes: the machine that the calibration at `path`
    /// names, and the calibration `known`, if there is one.
    ///
    /// # Errors
    ///
    /// A path that no file could name.
    pub fn head(
        &self,
        (calibrated, path): (&Calibrated, &Path),
        known: Option<&Path>,
        folder: &Path,
    ) -> Result<Head, Failure> {
        Ok(Head {
            machine: machine_name(&calibrated.calibration.machine.value, path, folder)?,
            calibration: known.map(|known| relative(folder, known)).transpose()?,
            data: self.data.clone(),
            axes: calibrated.equations.names().axes,
        })
    }
}
