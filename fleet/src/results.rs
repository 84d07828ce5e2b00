//! Results on the disk. In: the rows of one job. Out: files under the name of the job, a folder for each table, machine and month.
//!
//! `results/verdicts/machine=mill-07/month=2026-07/<id>-<key>.parquet`: readers of Parquet take the parts of the path as columns. The
//! table of recordings is written last: who finds its file finds the others, unless something else has removed or spoilt them. So a result
//! counts only if all its files can be read and bear its key. A result that another one
//! replaces (the recording was measured anew, or Abbe has another version) goes when the new one is there; until then readers take the
//! newer of both.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

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

    /// Whether every recording has a row in it.
    fn is_of_one_row(self) -> bool {
        matches!(self, Self::Recordings | Self::Verdicts)
    }

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
                ("untold", Kind::Text),
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
        let month = format!("month={}", self.time.month());
        let folder = results.join(folder).join(of_machine(self.machine)).join(month);
        folder.join(format!("{}-{}.{end}", self.id, self.key))
    }
}

/// The rows of a result in a file of a table; why they are none: the file is missing, cannot be read, or holds rows of another result.
/// `key` is that of the recording, which the rows of each table bear.
pub(crate) fn sound(path: &Path, table: Table, key: &str) -> Result<Vec<Row>, String> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(format!("{} is missing", path.display()));
        }
        _ => {}
    }
    let rows = table::read(path, table.columns())
        .map_err(|why| format!("{} cannot be read: {why}", path.display()))?;
    let own = rows.iter().filter(|row| row.text("key") == key).count();
    if own != rows.len() || (rows.is_empty() && table.is_of_one_row()) {
        return Err(format!("{} holds rows of another result", path.display()));
    }
    Ok(rows)
}

/// The folder of the pages.
pub(crate) const PAGES: &str = "pages";

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

/// Before the name of a machine in a path.
pub(crate) const MACHINE: &str = "machine=";

/// The folder of a machine.
pub(crate) fn of_machine(name: &str) -> String {
    format!("{MACHINE}{}", encoded(name))
}

/// A name as part of a path: what is no letter, digit, `-`, `_` or `.` as `%` and two digits for each byte, as readers of such paths expect.
pub(crate) fn encoded(name: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte);
    name.bytes()
        .map(|byte| if plain(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") })
        .collect()
}

pub(crate) fn decoded(name: &str) -> String {
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
