//! Jobs: what there is to do. In: a fleet. Out: its recordings, each with its time and with the key of what it would be made from.

use std::io;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use glob::{MatchOptions, Pattern as Glob, glob_with};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use recording::{Moment, date_of};
use workshop::load;
use workshop::named::Files;
use workshop::told::Listener;

use crate::file::{Fleet, Machine};
use crate::key::{Sum, of_texts};
use crate::results::{decoded, encoded};

/// A recording of the fleet.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Place {
    /// The number of its machine.
    pub(crate) machine: usize,
    /// Its path from the fleet's folder, with `/` between folders.
    pub(crate) label: String,
    /// Its path.
    pub(crate) path: PathBuf,
    /// What stays of it when it is measured anew: a sum of machine and path.
    pub(crate) id: String,
}

/// A recording with what it holds now.
#[derive(Clone, Debug)]
pub(crate) struct Job {
    pub(crate) place: Place,
    /// When it was made.
    pub(crate) time: Moment,
    /// The sum of all that its result is made from.
    pub(crate) key: String,
}

/// A recording, or a folder of them, that cannot be read now, and may be the next time: nothing is filed about it.
#[derive(Clone, Debug)]
pub(crate) struct PutOff {
    /// Its path from the fleet's folder.
    pub(crate) label: String,
    /// Why, in words.
    pub(crate) why: String,
}

impl PutOff {
    /// The line that says so.
    pub(crate) fn line(&self) -> String {
        format!("warning: {} is postponed to the next run: {}", self.label, self.why)
    }
}

/// What is found where a fleet looks for recordings.
#[derive(Clone, Debug, Default)]
pub(crate) struct Places {
    /// The recordings, in the order of machines and paths.
    pub(crate) found: Vec<Place>,
    /// The folders that cannot be read now.
    pub(crate) unread: Vec<PutOff>,
}

impl Job {
    /// The name of its result.
    pub(crate) fn result(&self) -> String {
        format!("{}-{}", self.place.id, self.key)
    }

    /// The name by which it is asked for: what it is made from, its machine and its path, so that nothing else need be looked at.
    pub(crate) fn name(&self, fleet: &Fleet) -> String {
        let machine = fleet.machines.get(self.place.machine).map_or("", |machine| &machine.name);
        format!("{}/{}/{}", self.key, encoded(machine), self.place.label)
    }
}

/// The recording and the key that the name of a job tells; nothing where the fleet has no such recording.
pub(crate) fn named(fleet: &Fleet, name: &str) -> Option<(Place, String)> {
    let (key, rest) = name.split_once('/')?;
    let (machine, label) = rest.split_once('/')?;
    let known = machine_named(fleet, machine)?;
    let own = place(fleet, known, fleet.folder.join(label));
    let fits = known.1.recordings.iter().any(|pattern| fits(pattern, label));
    let is_own = fits && own.label == label && is_recording(fleet, &own.path);
    // A pattern that names a folder in a roundabout way is looked up.
    let found = || places_of(fleet, known, &()).found.into_iter().find(|place| place.label == label);
    let place = if is_own { Some(own) } else { found() };
    Some((place?, key.to_owned()))
}

/// The machine of which a job tells the name, with its number.
pub(crate) fn machine_named<'f>(fleet: &'f Fleet, name: &str) -> Option<(usize, &'f Machine)> {
    let name = decoded(name);
    fleet.machines.iter().enumerate().find(|(_, machine)| machine.name == name)
}

/// The recordings that are there; the listener hears of paths that match none.
pub(crate) fn places(fleet: &Fleet, listener: &dyn Listener) -> Places {
    let mut places = Places::default();
    for machine in fleet.machines.iter().enumerate() {
        let own = places_of(fleet, machine, listener);
        places.found.extend(own.found);
        places.unread.extend(own.unread);
    }
    places
}

/// Those of one machine.
pub(crate) fn places_of(
    fleet: &Fleet,
    (number, machine): (usize, &Machine),
    listener: &dyn Listener,
) -> Places {
    let mut places = Places::default();
    for pattern in &machine.recordings {
        let (found, unread) = matching(fleet, pattern);
        if found.is_empty() && unread.is_empty() {
            let text = format!("warning: no file matches `{pattern}` of the machine `{}`", machine.name);
            listener.hear(&text.into());
        }
        places.found.extend(found.into_iter().map(|path| place(fleet, (number, machine), path)));
        places.unread.extend(unread);
    }
    places.found.sort();
    places.found.dedup();
    places
}

/// A star never stands for a slash, nor for the point of a hidden file.
const OPTIONS: MatchOptions =
    MatchOptions { case_sensitive: true, require_literal_separator: true, require_literal_leading_dot: true };

/// Whether a pattern, as it stands in the fleet file, is one of a path from the fleet's folder.
fn fits(pattern: &str, label: &str) -> bool {
    Glob::new(pattern).is_ok_and(|pattern| pattern.matches_with(label, OPTIONS))
}

/// The recordings that fit a pattern, and the folders that cannot be read.
fn matching(fleet: &Fleet, pattern: &str) -> (Vec<PathBuf>, Vec<PutOff>) {
    let own = Path::new(pattern).is_absolute();
    let folder = fleet.folder.to_string_lossy();
    let whole = match folder.as_ref() {
        _ if own => pattern.to_owned(),
        "" => pattern.to_owned(),
        folder => format!("{}/{pattern}", Glob::escape(folder)),
    };
    let (mut found, mut unread) = (Vec::new(), Vec::new());
    for path in glob_with(&whole, OPTIONS).into_iter().flatten() {
        match path {
            Ok(path) if is_recording(fleet, &path) => found.push(path),
            Ok(_) => {}
            Err(error) if error.path().starts_with(&fleet.results) => {}
            Err(error) => {
                let why = format!("the folder cannot be read now: {}", error.error());
                unread.push(PutOff { label: label(fleet, error.path()), why });
            }
        }
    }
    (found, unread)
}

/// Whether a path that fits is a recording: anything but a folder, and none of the results. What is no file, such as a link to nothing or a
/// named pipe, is a recording that is wrong, and is not passed over.
fn is_recording(fleet: &Fleet, path: &Path) -> bool {
    let is_there = path.symlink_metadata().is_ok() && !path.is_dir();
    is_there && !path.starts_with(&fleet.results)
}

/// A path from the fleet's folder, with `/` between folders.
fn label(fleet: &Fleet, path: &Path) -> String {
    path.strip_prefix(&fleet.folder).unwrap_or(path).to_string_lossy().replace('\\', "/")
}

fn place(fleet: &Fleet, (number, machine): (usize, &Machine), path: PathBuf) -> Place {
    let label = label(fleet, &path);
    let id = of_texts(&[&machine.name, &label]);
    Place { machine: number, label, path, id }
}

/// What a recording holds now.
pub(crate) fn job(fleet: &Fleet, place: Place) -> Result<Job, PutOff> {
    // A pipe would wait for somebody who writes.
    let source = place.path.is_file().then(|| load::read(&place.path).ok()).flatten();
    let time = time(fleet, &place, source.as_ref());
    match key(&place.path, source.as_ref(), time) {
        Ok(key) => Ok(Job { place, time, key }),
        Err((path, error)) => {
            let why = format!("{} cannot be read now: {error}", path.display());
            Err(PutOff { label: place.label, why })
        }
    }
}

/// When it was made: as its file says, else as its name does, else when the file was written.
fn time(fleet: &Fleet, place: &Place, source: Option<&SourceFile>) -> Moment {
    let root = source.and_then(|source| yaml::read(source, &mut Diagnostics::new()));
    let pattern = fleet.machines.get(place.machine).and_then(|machine| machine.time.as_ref());
    let named = || pattern.and_then(|pattern| pattern.find(&place.label));
    let dated = root.as_ref().and_then(date_of).or_else(named).or_else(|| written(&place.path));
    dated.unwrap_or_else(Moment::first)
}

fn written(path: &Path) -> Option<Moment> {
    let since = std::fs::metadata(path).ok()?.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
    Moment::new(i64::try_from(since.as_secs()).ok()?)
}

/// The sum of the recording, of all files that it names, and of its time, by which it is filed; or the file that cannot be read now.
fn key(path: &Path, source: Option<&SourceFile>, time: Moment) -> Result<String, (PathBuf, io::Error)> {
    let add = |sum: Sum, file: &Path| sum.file(file).map_err(|error| (file.to_owned(), error));
    let sum = add(Sum::versioned().text(&time.to_string()), path)?;
    let Some(source) = source else { return Ok(sum.digits()) };
    // What is no file is a name that the version of Abbe knows, and stands in the file that names it.
    let mut named = named_files(source, path).into_iter().skip(1);
    Ok(named.try_fold(sum, |sum, file| add(sum, &file))?.digits())
}

/// A recording and all files that it names.
fn named_files(source: &SourceFile, path: &Path) -> Vec<PathBuf> {
    let files = Files::named_in(source, path);
    let known = files.calibration.as_deref().and_then(machine_of_calibration);
    files.all(known.as_deref())
}

/// The first of a recording and the files that it names which is neither a file nor a folder: a named pipe, a socket, or a device. To
/// read one may take for ever, and what it gives is no recording of a fleet.
pub(crate) fn endless(path: &Path) -> Option<PathBuf> {
    let is_endless = |path: &Path| path.metadata().is_ok_and(|there| !there.is_file() && !there.is_dir());
    if is_endless(path) {
        return Some(path.to_owned());
    }
    let source = load::read(path).ok()?;
    named_files(&source, path).into_iter().find(|file| is_endless(file))
}

/// The machine as a calibration names it.
fn machine_of_calibration(path: &Path) -> Option<String> {
    let path = Some(path).filter(|path| path.is_file())?;
    let source = load::read(path).ok()?;
    let root = yaml::read(&source, &mut Diagnostics::new())?;
    root.get("machine")?.text().map(str::to_owned)
}
