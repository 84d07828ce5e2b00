//! What is there of results, and what of it counts. In: the folder of the results. Out: which jobs are done, what is to go, and the rows of
//! each recording once.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use workshop::failure::Failure;

use crate::results::{Filed, MACHINE, PAGES, Table, decoded, of_machine, sound};
use crate::table::{self, Row};

/// Where files of results are: those of a table, or the pages.
#[derive(Clone, Copy)]
pub(crate) struct Drawer {
    folder: &'static str,
    end: &'static str,
}

impl Drawer {
    /// The pages of diagnoses.
    pub(crate) const PAGES: Self = Self { folder: PAGES, end: "html" };

    /// The rows of a table.
    fn of(table: Table) -> Self {
        Self { folder: table.name(), end: "parquet" }
    }

    /// All there are.
    fn all() -> impl Iterator<Item = Self> {
        Table::ALL.map(Self::of).into_iter().chain([Self::PAGES])
    }

    /// Its files, of all machines or of one, in the order of their paths; none where there is no such folder.
    fn files(self, results: &Path, machine: Option<&str>) -> Result<Vec<PathBuf>, Failure> {
        let folder = results.join(self.folder);
        let machines = match machine {
            Some(machine) => vec![folder.join(of_machine(machine))],
            None => entries(&folder)?,
        };
        let mut found = Vec::new();
        for month in
            machines.iter().map(|machine| entries(machine)).collect::<Result<Vec<_>, _>>()?.iter().flatten()
        {
            let own = |path: &PathBuf| path.extension().is_some_and(|end| end == self.end);
            found.extend(entries(month)?.into_iter().filter(own));
        }
        found.sort();
        Ok(found)
    }
}

/// Which results are there in one place: for each recording the files of its results, by key.
#[derive(Clone, Debug, Default)]
pub(crate) struct There(BTreeMap<String, BTreeMap<String, Vec<PathBuf>>>);

impl There {
    /// Looks into a place, at all machines or at one.
    pub(crate) fn of(results: &Path, drawer: Drawer, machine: Option<&str>) -> Result<Self, Failure> {
        let mut there = Self::default();
        for path in drawer.files(results, machine)? {
            if let Some((id, key)) = id_and_key(&path) {
                there.0.entry(id).or_default().entry(key).or_default().push(path);
            }
        }
        Ok(there)
    }

    /// Whether a job has its result, filed where it belongs.
    pub(crate) fn holds(&self, filed: &Filed<'_>, own: &Path) -> bool {
        let known = self.0.get(filed.id).and_then(|keys| keys.get(filed.key));
        known.is_some_and(|paths| paths.iter().any(|path| path == own))
    }

    /// The results of other recordings of the machine that were made from the very same: the recording was moved. In: what was made from it
    /// now, and which recordings are still there. Out: what they are of.
    fn moved<'t>(
        &'t self,
        known: &'t BTreeMap<&str, &str>,
        listed: &'t BTreeSet<&str>,
    ) -> impl Iterator<Item = &'t str> {
        let gone = self.0.iter().filter(|(id, _)| !listed.contains(id.as_str()));
        let is_known = |path: &PathBuf, key: &str| {
            let folder = path.parent().and_then(Path::parent).and_then(Path::file_name);
            known
                .get(key)
                .is_some_and(|machine| folder.is_some_and(|folder| folder == of_machine(machine).as_str()))
        };
        let moved = move |keys: &BTreeMap<String, Vec<PathBuf>>| {
            keys.iter().all(|(key, paths)| paths.iter().all(|path| is_known(path, key)))
        };
        gone.filter(move |(_, keys)| moved(keys)).map(|(id, _)| id.as_str())
    }
}

/// The results of a fleet as they were when they were looked at.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shelf {
    tables: BTreeMap<Table, There>,
    pages: There,
}

impl Shelf {
    /// Looks at the results of all machines or of one.
    pub(crate) fn of(results: &Path, machine: Option<&str>) -> Result<Self, Failure> {
        let table = |table: Table| There::of(results, Drawer::of(table), machine).map(|there| (table, there));
        let tables = Table::ALL.into_iter().map(table).collect::<Result<_, _>>()?;
        Ok(Self { tables, pages: There::of(results, Drawer::PAGES, machine)? })
    }

    /// Whether a job has its rows in a table.
    pub(crate) fn holds(&self, results: &Path, filed: &Filed<'_>, table: Table) -> bool {
        self.tables.get(&table).is_some_and(|there| there.holds(filed, &filed.path(results, table)))
    }

    /// Whether a job has its page.
    pub(crate) fn holds_page(&self, results: &Path, filed: &Filed<'_>) -> bool {
        self.pages.holds(filed, &filed.page(results))
    }

    /// Takes away what the diagnosis of a recording replaces, its page too.
    pub(crate) fn replace(&self, results: &Path, filed: &Filed<'_>) -> Result<(), Failure> {
        for table in Table::OF_DIAGNOSIS {
            self.replace_in(results, filed, table)?;
        }
        remove_others(&self.pages, filed.id, Some(&filed.page(results)))
    }

    /// Takes away what the rows of a job replace in one table.
    pub(crate) fn replace_in(&self, results: &Path, filed: &Filed<'_>, table: Table) -> Result<(), Failure> {
        let Some(there) = self.tables.get(&table) else { return Ok(()) };
        remove_others(there, filed.id, Some(&filed.path(results, table)))
    }

    /// Takes away the results of recordings that were moved: the same is filed under their new paths. `known` has the keys of what is
    /// diagnosed, with the machines, `listed` what is still at its place.
    pub(crate) fn clear_moved(
        &self,
        known: &BTreeMap<&str, &str>,
        listed: &BTreeSet<&str>,
    ) -> Result<(), Failure> {
        let Some(recordings) = self.tables.get(&Table::Recordings) else { return Ok(()) };
        for id in recordings.moved(known, listed) {
            // That of recordings last, as it says that the others are there.
            let others = [Table::Followed, Table::Parameters, Table::Verdicts, Table::Recordings];
            let there = others.into_iter().filter_map(|table| self.tables.get(&table));
            there.chain([&self.pages]).try_for_each(|there| remove_others(there, id, None))?;
        }
        Ok(())
    }
}

/// Removes the files of a recording but for one.
fn remove_others(there: &There, id: &str, own: Option<&Path>) -> Result<(), Failure> {
    let of_recording = there.0.get(id).into_iter().flat_map(BTreeMap::values).flatten();
    for path in of_recording.filter(|path| Some(path.as_path()) != own) {
        match fs::remove_file(path) {
            // Another run may have been quicker.
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(Failure::io(&format!("cannot remove {}", path.display()), &error));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Which result of each recording counts. A run that is killed may leave two of them, the one that it has made and the one that this
/// replaces: the newer one counts, and the next run takes the other away. Of results of one machine that were made from the very same, as
/// those of a recording that was moved, one counts: that which is still listed.
pub(crate) struct Current(BTreeMap<String, (String, PathBuf)>);

impl Current {
    /// Looks at what is diagnosed, of all machines or of one; `listed` are the recordings that are at their places.
    pub(crate) fn of(
        results: &Path,
        machine: Option<&str>,
        listed: &BTreeSet<&str>,
    ) -> Result<Self, Failure> {
        let there = There::of(results, Drawer::of(Table::Recordings), machine)?;
        let mut of_key: BTreeMap<(PathBuf, &str), (bool, &str, &Path)> = BTreeMap::new();
        for (id, keys) in &there.0 {
            let Some((key, path)) =
                newest(keys.iter().flat_map(|(key, paths)| paths.iter().map(move |path| (key, path))))
            else {
                continue;
            };
            let folder = path.parent().map(Path::to_owned).unwrap_or_default();
            let own = (listed.contains(id.as_str()), id.as_str(), path);
            let known = of_key.entry((folder, key)).or_insert(own);
            if own.0 && !known.0 {
                *known = own;
            }
        }
        let of_id = |((_, key), (_, id, path)): ((PathBuf, &str), (bool, &str, &Path))| {
            (id.to_owned(), (key.to_owned(), path.to_owned()))
        };
        Ok(Self(of_key.into_iter().map(of_id).collect()))
    }
}

/// The file that was written last, and of one moment the last by its path.
fn newest<'f>(files: impl Iterator<Item = (&'f String, &'f PathBuf)>) -> Option<(&'f str, &'f Path)> {
    let written = |path: &Path| fs::metadata(path).and_then(|there| there.modified()).ok();
    let newest = files.max_by_key(|(_, path)| (written(path), *path));
    newest.map(|(key, path)| (key.as_str(), path.as_path()))
}

fn id_and_key(path: &Path) -> Option<(String, String)> {
    let (id, key) = path.file_stem()?.to_str()?.split_once('-')?;
    Some((id.to_owned(), key.to_owned()))
}

/// The files of a table of all machines, in the order of their paths.
pub(crate) fn files(results: &Path, table: Table) -> Result<Vec<PathBuf>, Failure> {
    Drawer::of(table).files(results, None)
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let cannot = |error: io::Error| Failure::io(&format!("cannot read {}", folder.display()), &error);
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {
            return Ok(Vec::new());
        }
        Err(error) => return Err(cannot(error)),
    };
    entries.map(|entry| entry.map(|entry| entry.path()).map_err(cannot)).collect()
}

/// A row of a table with what its path says.
#[derive(Clone, Debug)]
pub(crate) struct Known {
    /// The machine.
    pub(crate) machine: String,
    /// Which recording it is of.
    pub(crate) id: String,
    pub(crate) row: Row,
}

/// The rows of a table that count, of all machines or of one; what cannot be read is told to `broken`, a file of another form by its reason.
pub(crate) fn read(
    results: &Path,
    table: Table,
    (machine, current): (Option<&str>, &Current),
    broken: &mut dyn FnMut(String),
) -> Result<Vec<Known>, Failure> {
    let mut rows = Vec::new();
    each(results, table, (machine, current), broken, &mut |id, path, read| {
        let machine = machine_of(path).unwrap_or_default();
        rows.extend(read.into_iter().map(|row| Known { machine: machine.clone(), id: id.to_owned(), row }));
    })?;
    Ok(rows)
}

/// Tells `broken` what of a table is missing or cannot be read, and keeps no rows.
pub(crate) fn check(
    results: &Path,
    table: Table,
    (machine, current): (Option<&str>, &Current),
    broken: &mut dyn FnMut(String),
) -> Result<(), Failure> {
    each(results, table, (machine, current), broken, &mut |_, _, _| {})
}

/// Gives the rows of each recording that counts to `found`, and what is missing or cannot be read to `broken`.
fn each(
    results: &Path,
    table: Table,
    (machine, current): (Option<&str>, &Current),
    broken: &mut dyn FnMut(String),
    found: &mut dyn FnMut(&str, &Path, Vec<Row>),
) -> Result<(), Failure> {
    let there = There::of(results, Drawer::of(table), machine)?;
    for (id, (key, recording)) in &current.0 {
        let keys = there.0.get(id).into_iter().flatten();
        let all = keys.flat_map(|(key, paths)| paths.iter().map(move |path| (key, path)));
        // A table of followed effects has its own key.
        let own = |(of, _): &(&String, &PathBuf)| table == Table::Followed || of.as_str() == key;
        let Some((_, path)) = newest(all.filter(own)) else {
            // What is followed comes later than the rest, and has its turn with the next run.
            if table != Table::Followed && recording.exists() {
                let path = beside(results, recording, table);
                broken(format!("warning: {} is missing", path.display()));
            }
            continue;
        };
        let read = match table {
            // Rows of a recording as it was before are of no result that counts, and no fault.
            Table::Followed => table::read(path, table.columns())
                .map(|rows| rows.into_iter().filter(|row| row.text("key") == key).collect())
                .map_err(|why| format!("{} cannot be read: {why}", path.display())),
            _ => sound(path, table, key),
        };
        match read {
            Ok(read) => found(id, path, read),
            // Another run has replaced it since the folder was read.
            Err(_) if !path.exists() => {}
            Err(why) => broken(format!("warning: {why}")),
        }
    }
    Ok(())
}

/// The file of a table that belongs to a file of the table of recordings.
fn beside(results: &Path, recording: &Path, table: Table) -> PathBuf {
    let folder = results.join(Table::Recordings.name());
    results.join(table.name()).join(recording.strip_prefix(folder).unwrap_or(recording))
}

/// The machines of which there are results.
pub(crate) fn machines(results: &Path) -> Result<Vec<String>, Failure> {
    let name = |folder: PathBuf| folder.file_name()?.to_str()?.strip_prefix(MACHINE).map(decoded);
    let folders = entries(&results.join(Table::Recordings.name()))?;
    let mut machines: Vec<String> = folders.into_iter().filter_map(name).collect();
    machines.sort();
    Ok(machines)
}

/// The machine that the path of a result names.
fn machine_of(path: &Path) -> Option<String> {
    let folder = path.parent()?.parent()?.file_name()?.to_str()?;
    folder.strip_prefix(MACHINE).map(decoded)
}

/// What an attempt that was killed leaves beside a result is of no use after so long: a file is written in far less.
const ABANDONED: Duration = Duration::from_secs(3600);

/// Takes away what attempts that were killed have left.
pub(crate) fn tidy(results: &Path) -> Result<(), Failure> {
    for drawer in Drawer::all() {
        for path in (Drawer { end: "part", ..drawer }).files(results, None)? {
            let written = fs::metadata(&path).and_then(|there| there.modified()).ok();
            let age = written.and_then(|written| SystemTime::now().duration_since(written).ok());
            if age.is_some_and(|age| age > ABANDONED) {
                // Another run may have been quicker.
                let _ = fs::remove_file(&path);
            }
        }
    }
    Ok(())
}
