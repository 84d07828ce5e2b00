//! Files that name each other. In: a recording with its path. Out: every file that it was read from, none of which is written over;
//! and how a new file names them from its own folder.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml;

use crate::failure::Failure;
use crate::recorded::Recorded;
use crate::written::folder;

/// A recording with what its file names, as paths.
pub struct Files {
    /// The recording file.
    pub recording: PathBuf,
    /// The machine as the recording names it.
    pub machine: String,
    /// The calibration that it counts on.
    pub calibration: Option<PathBuf>,
    data: Option<PathBuf>,
}

impl Files {
    /// Those that the file of a recording names.
    pub fn of(recorded: &Recorded, path: &Path) -> Self {
        Self::named_in(&recorded.source, path)
    }

    /// Those that a file names in the way of a recording.
    pub fn named_in(source: &SourceFile, path: &Path) -> Self {
        let root = yaml::read(source, &mut Diagnostics::new());
        let named = |key: &str| root.as_ref().and_then(|root| root.get(key)).and_then(|node| node.text());
        let file = |name: &str| beside(path, name);
        let data = root.as_ref().and_then(|root| root.get("data"));
        // A mapping says besides how the table is written.
        let data = data.and_then(|node| node.text().or_else(|| node.get("file")?.text()));
        Self {
            recording: path.to_owned(),
            machine: named("machine").unwrap_or_default().to_owned(),
            calibration: named("calibration").map(file),
            data: data.map(file),
        }
    }

    /// All of them, the machine's file too where it is one; `known` is the machine as the calibration names it.
    pub fn all(&self, known: Option<&str>) -> Vec<PathBuf> {
        let machine = beside(&self.recording, &self.machine);
        let known = self.calibration.as_deref().zip(known).map(|(path, name)| beside(path, name));
        let optional = [self.calibration.clone(), self.data.clone(), known];
        [self.recording.clone(), machine].into_iter().chain(optional.into_iter().flatten()).collect()
    }
}

/// A name in a file, counted from the file's folder.
fn beside(file: &Path, name: &str) -> PathBuf {
    file.parent().map_or_else(|| PathBuf::from(name), |folder| folder.join(name))
}

/// Refuses to write over what the diagnosis is read from, and into a folder that is not there: before any work is done.
pub fn check_target(target: &Path, inputs: &[(Files, &Recorded)]) -> Result<(), Failure> {
    let help = "help: give --write-calibration the name of a new file, or of one that may be replaced";
    let wrong = |what: &str| Failure::wrong(format!("error: {} {what}\n{help}", target.display()));
    if !folder(target).is_dir() {
        return Err(wrong("cannot be written: its folder does not exist"));
    }
    if target.file_name().is_none() || target.is_dir() {
        return Err(wrong("is a folder"));
    }
    let Ok(there) = target.canonicalize() else { return Ok(()) };
    let read = inputs.iter().flat_map(|(files, recorded)| {
        let known = recorded.calibration.as_ref().map(|known| known.calibration.machine.value.as_str());
        files.all(known)
    });
    let same = read.filter_map(|file| file.canonicalize().ok()).any(|file| file == there);
    if same { Err(wrong("is one of the files that the diagnosis reads")) } else { Ok(()) }
}

/// The machine as the recording names it: a file's path from the recording's folder, or the name as it is.
pub fn machine_name(name: &str, calibration: &Path, folder: &Path) -> Result<String, Failure> {
    let file = calibration.parent().map_or_else(|| PathBuf::from(name), |parent| parent.join(name));
    if file.is_file() { relative(folder, &file) } else { Ok(name.to_owned()) }
}

/// The path of a file as seen from a folder; the whole path where they have nothing in common. Refused where it is no text,
/// since no file could name it.
pub fn relative(folder: &Path, file: &Path) -> Result<String, Failure> {
    let text = |part: &OsStr| part.to_str().map(str::to_owned).ok_or_else(|| nameless(file));
    let (Ok(from), Ok(to)) = (folder.canonicalize(), file.canonicalize()) else {
        return text(file.as_os_str());
    };
    let common = from.components().zip(to.components()).take_while(|(left, right)| left == right).count();
    let up = from.components().skip(common).map(|_| Ok("..".to_owned()));
    let down = to.components().skip(common).map(|part| text(part.as_os_str()));
    match common {
        // Not even the drive is the same.
        0 => text(to.as_os_str()),
        _ => Ok(up.chain(down).collect::<Result<Vec<_>, _>>()?.join("/")),
    }
}

fn nameless(file: &Path) -> Failure {
    Failure::wrong(format!(
        "error: the new file cannot name {}: its path is not UTF-8 text\nhelp: write the new file beside it, or rename its folders",
        file.display()
    ))
}
