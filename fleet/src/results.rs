//! Results on the disk. In: the rows of one job. Out: files under the name of the job, a folder for each table, machine and month; and
//! all of them again.
//!
//! `results/verdicts/machine=mill-07/month=2026-07/<id>-<key>.parquet`: readers of Parquet take the parts of the path as columns. The
//! table of recordings is written last: its file says that a job is done, and whoever finds it finds the others. A result that another one
//! replaces (the recording was measured anew, or Abbe has another version) goes when the new one is there.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use recording::Moment;
use workshop::failure::Failure;
use workshop::written;

use crate::table::{self, Cell, Columns, Kind, Row};

/// A table of the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Table {
    /// What was recorded, a row a recording.
    Recordings,
    /// What the diagnosis says of it, a row a recording.
    Verdicts,
    /// What was found in it, a row a parameter.
    Parameters,
    /// How large what was found in any recording of the machine is in this one, a row a parameter.
    Followed,
}

impl Table {
    /// All of them.
    pub(crate) const ALL: [Self; 4] = [Self::Parameters, Self::Verdicts, Self::Recordings, Self::Followed];

    /// Those of the first stage of a job, in the order in which they are written: that which says that it is done comes last.
    pub(crate) const OF_DIAGNOSIS: [Self; 3] = [Self::Parameters, Self::Verdicts, Self::Recordings];

    /// Its folder.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Recordings => "recordings",
            Self::Verdicts => "verdicts",
            Self::Parameters => "parameters",
            Self::Followed => "followed",
        }
    }

    pub(crate) fn columns(self) -> Columns {
        match self {
            Self::Recordings => &[
                ("key", Kind::Text),
                ("recording", Kind::Text),
                ("kind", Kind::Text),
                ("time", Kind::Time),
                ("title", Kind::Text),
                ("instrument", Kind::Text),
                ("rows", Kind::Count),
                ("samples", Kind::Count),
                ("missing", Kind::Count),
                ("outliers", Kind::Count),
                ("runs", Kind::Count),
                ("version", Kind::Text),
                ("error", Kind::Text),
            ],
            Self::Verdicts => &[
                ("key", Kind::Text),
                ("recording", Kind::Text),
                ("time", Kind::Time),
                ("verdict", Kind::Text),
                ("sentence", Kind::Text),
                ("findings", Kind::Count),
                ("changes", Kind::Count),
                ("noise", Kind::Number),
                ("before", Kind::Number),
                ("after", Kind::Number),
                ("before_held_out", Kind::Number),
                ("after_held_out", Kind::Number),
                ("unit", Kind::Text),
            ],
            Self::Parameters => &[
                ("key", Kind::Text),
                ("recording", Kind::Text),
                ("time", Kind::Time),
                ("finding", Kind::Count),
                ("motion", Kind::Text),
                ("term", Kind::Text),
                ("parameter", Kind::Text),
                ("value", Kind::Number),
                ("low", Kind::Number),
                ("high", Kind::Number),
                ("unit", Kind::Text),
                ("share", Kind::Number),
                ("side", Kind::Text),
                ("at_drive", Kind::Flag),
                ("inside_loop", Kind::Flag),
                ("family", Kind::Text),
                ("calibration", Kind::Text),
            ],
            Self::Followed => &[
                ("key", Kind::Text),
                ("recording", Kind::Text),
                ("time", Kind::Time),
                ("effect", Kind::Text),
                ("motion", Kind::Text),
                ("term", Kind::Text),
                ("parameter", Kind::Text),
                ("value", Kind::Number),
                ("low", Kind::Number),
                ("high", Kind::Number),
                ("unit", Kind::Text),
                ("claimed", Kind::Flag),
            ],
        }
    }
}

/// Which job a result is of, and where it is filed.
#[derive(Clone, Debug)]
pub(crate) struct Filed<'f> {
    pub(crate) machine: &'f str,
    pub(crate) time: Moment,
    pub(crate) id: &'f str,
    pub(crate) key: &'f str,
}

impl Filed<'_> {
    /// The file of its rows in a table.
    pub(crate) fn path(&self, results: &Path, table: Table) -> PathBuf {
        self.file(results, table.name(), "parquet")
    }

    /// The page of its diagnosis.
    pub(crate) fn page(&self, results: &Path) -> PathBuf {
        self.file(results, PAGES, "html")
    }

    fn file(&self, results: &Path, folder: &str, end: &str) -> PathBuf {
        let (machine, month) = (encoded(self.machine), self.time.month());
        let folder = results.join(folder).join(format!("machine={machine}")).join(format!("month={month}"));
        folder.join(format!("{}-{}.{end}", self.id, self.key))
    }
}

/// The folder of the pages.
const PAGES: &str = "pages";

/// Writes a file of a job whole, its folder too where there is none.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let cannot = |error: io::Error| written::cannot_write(path, &error);
    fs::create_dir_all(written::folder(path)).map_err(cannot)?;
    written::staged(path, |file| file.write_all(bytes))?.keep().map_err(cannot)
}

/// A moment as a cell.
pub(crate) fn moment(time: Moment) -> Cell {
    Cell::Count(time.seconds().saturating_mul(1000))
}

/// Writes the rows of a table of a job.
pub(crate) fn write(
    results: &Path,
    filed: &Filed<'_>,
    table: Table,
    rows: &[Vec<Cell>],
) -> Result<(), Failure> {
    let bytes =
        table::written(table.columns(), rows).map_err(|error| Failure::wrong(format!("error: {error}")))?;
    write_file(&filed.path(results, table), &bytes)
}

/// Which results of a table are there: for each recording the files of its results, by key.
#[derive(Clone, Debug, Default)]
pub(crate) struct There(BTreeMap<String, BTreeMap<String, Vec<PathBuf>>>);

impl There {
    /// Looks into the folder of a table.
    pub(crate) fn of(results: &Path, table: Table) -> Result<Self, Failure> {
        let mut there = Self::default();
        for path in files(results, table)? {
            let name = path.file_stem().map(|name| name.to_string_lossy().into_owned());
            if let Some((id, key)) = name.as_deref().and_then(|name| name.split_once('-')) {
                there
                    .0
                    .entry(id.to_owned())
                    .or_default()
                    .entry(key.to_owned())
                    .or_default()
                    .push(path.clone());
            }
        }
        Ok(there)
    }

    /// Whether a job has its result, filed where it belongs.
    pub(crate) fn holds(&self, results: &Path, filed: &Filed<'_>, table: Table) -> bool {
        let known = self.0.get(filed.id).and_then(|keys| keys.get(filed.key));
        known.is_some_and(|paths| paths.contains(&filed.path(results, table)))
    }

    /// The files that a result replaces.
    fn replaced<'t>(&'t self, own: &'t Path, id: &str) -> impl Iterator<Item = &'t PathBuf> {
        let of_recording = self.0.get(id).into_iter().flat_map(BTreeMap::values).flatten();
        of_recording.filter(move |path| path.as_path() != own)
    }
}

/// Takes away what a result replaces.
pub(crate) fn replace(results: &Path, filed: &Filed<'_>, table: Table, there: &There) -> Result<(), Failure> {
    let own = filed.path(results, table);
    for path in there.replaced(&own, filed.id) {
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

/// The files of a table, in the order of their paths; none where there is no such folder.
pub(crate) fn files(results: &Path, table: Table) -> Result<Vec<PathBuf>, Failure> {
    let mut found = Vec::new();
    for machine in entries(&results.join(table.name()))? {
        for month in entries(&machine)? {
            found.extend(
                entries(&month)?
                    .into_iter()
                    .filter(|path| path.extension().is_some_and(|end| end == "parquet")),
            );
        }
    }
    found.sort();
    Ok(found)
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

/// All rows of a table, or those of one machine; what cannot be read is told to `broken`, a file of another form by its reason.
pub(crate) fn read(
    results: &Path,
    table: Table,
    machine: Option<&str>,
    broken: &mut dyn FnMut(String),
) -> Result<Vec<Known>, Failure> {
    let mut rows = Vec::new();
    for path in files(results, table)? {
        let part = |name: &str| {
            let parts = path.components().map(|part| part.as_os_str().to_string_lossy().into_owned());
            parts.rev().find_map(|part| part.strip_prefix(name).map(decoded))
        };
        let Some(of) = part("machine=").filter(|of| machine.is_none_or(|machine| of == machine)) else {
            continue;
        };
        let name = path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let id = name.split('-').next().unwrap_or_default().to_owned();
        match table::read(&path) {
            Ok(read) => {
                let known = |row| Known { machine: of.clone(), id: id.clone(), row };
                rows.extend(read.into_iter().map(known));
            }
            // Another run has replaced it since the folder was read.
            Err(_) if !path.exists() => {}
            Err(why) => broken(format!("warning: {} cannot be read: {why}", path.display())),
        }
    }
    Ok(rows)
}

/// What an attempt that was killed leaves beside a result is of no use after so long: a file is written in far less.
const ABANDONED: Duration = Duration::from_secs(3600);

/// Takes away what attempts that were killed have left.
pub(crate) fn tidy(results: &Path) -> Result<(), Failure> {
    let mut folders = BTreeSet::new();
    for table in Table::ALL {
        for machine in entries(&results.join(table.name()))? {
            folders.extend(entries(&machine)?);
        }
    }
    for path in
        folders.iter().map(|folder| entries(folder)).collect::<Result<Vec<_>, _>>()?.into_iter().flatten()
    {
        let part = path.extension().is_some_and(|end| end == "part");
        let age =
            |path: &Path| SystemTime::now().duration_since(fs::metadata(path).ok()?.modified().ok()?).ok();
        if part && age(&path).is_some_and(|age| age > ABANDONED) {
            // Another run may have been quicker.
            let _ = fs::remove_file(&path);
        }
    }
    Ok(())
}

/// A name as part of a path: what is no letter, digit, `-`, `_` or `.` as `%` and two digits for each byte, as readers of such paths expect.
pub(crate) fn encoded(name: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte);
    name.bytes()
        .map(|byte| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") })
        .collect()
}

fn decoded(name: &str) -> String {
    let (mut bytes, mut rest) = (Vec::new(), name.as_bytes());
    while let Some((first, after)) = rest.split_first() {
        let escaped = (*first == b'%').then(|| after.get(..2)).flatten();
        let byte = escaped.and_then(|digits| u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok());
        bytes.push(byte.unwrap_or(*first));
        rest = if byte.is_some() { after.get(2..).unwrap_or_default() } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::{decoded, encoded};

    #[test]
    fn names_come_back_from_paths() {
        for name in ["mill-07", "Fräse 3/b", "100%", "a=b", "%41", ".."] {
            assert!(
                encoded(name).bytes().all(|byte| byte.is_ascii() && byte != b'/' && byte != b'='),
                "{name}"
            );
            assert_eq!(decoded(&encoded(name)), name);
        }
        assert_eq!(encoded("mill 07"), "mill%2007");
    }
}
