//! Results from elsewhere. In: folders of results, or files of them. Out: those that are results of this fleet's recordings as they are,
//! filed with its own.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use workshop::failure::Failure;
use workshop::told::Listener;

use crate::file::Fleet;
use crate::jobs::{Job, job, places};
use crate::results::{Filed, Table, sound, write_file};
use crate::shelf::{Shelf, files};

/// What was added.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Added {
    /// Recordings whose result is here now.
    pub taken: usize,
    /// Results that were here already.
    pub known: usize,
    /// Results of no recording of this fleet as it is now, or whose files are missing, cannot be read or are of another result.
    pub refused: usize,
}

/// Takes the results in folders over, each a `results` folder of the same fleet elsewhere. Only what was made from the recordings as they
/// are here is taken; the listener hears of the others.
pub fn add(fleet: &Fleet, folders: &[PathBuf], listener: &dyn Listener) -> Result<Added, Failure> {
    let jobs = places(fleet, &()).found.into_iter().filter_map(|place| job(fleet, place).ok());
    let jobs: BTreeMap<String, Job> = jobs.map(|job| (job.result(), job)).collect();
    let shelf = Shelf::of(&fleet.results, None)?;
    let mut added = Added::default();
    for folder in folders {
        let there = files(folder, Table::Recordings)?;
        if there.is_empty() {
            return Err(Failure::wrong(format!(
                "error: {} contains no results\nhelp: name the folder that contains the folder `recordings`",
                folder.display()
            )));
        }
        for path in there {
            take(fleet, (&jobs, &shelf), (folder, &path), &mut added, listener)?;
        }
    }
    Ok(added)
}

fn take(
    fleet: &Fleet,
    (jobs, shelf): (&BTreeMap<String, Job>, &Shelf),
    (folder, path): (&Path, &Path),
    added: &mut Added,
    listener: &dyn Listener,
) -> Result<(), Failure> {
    let name = path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let Some(job) = jobs.get(&name) else {
        added.refused += 1;
        let text =
            format!("warning: {} is not a result of a current recording of this fleet", path.display());
        listener.hear(&text.into());
        return Ok(());
    };
    let Some(machine) = fleet.machines.get(job.place.machine) else { return Ok(()) };
    let filed = Filed { machine: &machine.name, time: job.time, id: &job.place.id, key: &job.key };
    let is_whole = |results: &Path| {
        let file = |table| sound(&filed.path(results, table), table, &job.key).map(drop);
        Table::OF_DIAGNOSIS.into_iter().try_for_each(file)
    };
    if is_whole(&fleet.results).is_ok() {
        added.known += 1;
        return Ok(());
    }
    if let Err(why) = is_whole(folder) {
        added.refused += 1;
        listener.hear(&format!("warning: the result of {} is not added: {why}", job.place.label).into());
        return Ok(());
    }
    // The table of recordings last, since it says that the others are there.
    for table in Table::OF_DIAGNOSIS {
        copy(&filed.path(folder, table), &filed.path(&fleet.results, table))?;
    }
    shelf.replace(&fleet.results, &filed)?;
    added.taken += 1;
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<(), Failure> {
    let cannot = |error: io::Error| Failure::io(&format!("cannot read {}", from.display()), &error);
    let bytes = fs::read(from).map_err(cannot)?;
    write_file(to, &bytes)
}
