//! `abbe new`: a commented file to start from. In: its kind, and what it is of: a topology word, a machine, a table, files of
//! instruments. Out: the file, on standard output or under a name of its own.

use std::path::{Path, PathBuf};

use model_dsl::diagnostic::Diagnostics;
use model_dsl::machine::template;
use model_dsl::source::SourceFile;
use workshop::begin;
use workshop::failure::Failure;
use workshop::load::{self, Loaded};
use workshop::named::{machine_name, relative};
use workshop::written::folder;

use crate::arguments::{New, NewFile};
use crate::output::Person;
use crate::target::Target;

/// Runs the command.
pub(crate) fn run(command: &New) -> Result<(), Failure> {
    let file = command.file.as_ref();
    let target = Target { output: command.output.clone(), force: command.force };
    target.check(&file.map(files_read).unwrap_or_default())?;
    let here = command.output.as_deref().map_or_else(|| PathBuf::from("."), folder);
    let text = match file {
        Some(file) => text(file, &here)?,
        None => machine(command.topology.as_deref().unwrap_or_default())?,
    };
    target.put(&text)
}

/// The text of the file, which names others from the folder where it will be.
fn text(file: &NewFile, here: &Path) -> Result<String, Failure> {
    // What is no file is a name that means the same everywhere.
    let named = |machine: &str| machine_name(machine, Path::new(""), here);
    match file {
        NewFile::Machine { topology } => machine(topology),
        NewFile::Calibration { machine } => {
            Ok(begin::calibration(&named(machine)?, &loaded(machine)?.compiled.equations))
        }
        NewFile::Path { machine } => Ok(begin::path(&loaded(machine)?.compiled.equations)),
        NewFile::Recording { data, machine } => {
            let columns = begin::columns(data)?;
            let machine = machine.as_deref().map(named).transpose()?;
            Ok(begin::recording(&relative(here, data)?, &columns, machine.as_deref()))
        }
        NewFile::Setup { files } => {
            let named = |file: &PathBuf| Ok((file.clone(), relative(here, file)?));
            let files = files.iter().map(named).collect::<Result<Vec<_>, Failure>>()?;
            let files: Vec<(&Path, String)> =
                files.iter().map(|(path, name)| (path.as_path(), name.clone())).collect();
            begin::setup(&files)
        }
    }
}

/// The files that are read, none of which is written over.
fn files_read(file: &NewFile) -> Vec<PathBuf> {
    match file {
        NewFile::Machine { .. } => Vec::new(),
        NewFile::Calibration { machine } | NewFile::Path { machine } => vec![machine.into()],
        NewFile::Recording { data, machine } => {
            machine.iter().map(PathBuf::from).chain([data.clone()]).collect()
        }
        NewFile::Setup { files } => files.clone(),
    }
}

fn loaded(machine: &str) -> Result<Loaded, Failure> {
    load::machine(machine, None, &Person::default())
}

fn machine(topology: &str) -> Result<String, Failure> {
    let mut diagnostics = Diagnostics::new();
    let source = SourceFile::new("topology", topology);
    template(topology, &mut diagnostics).ok_or_else(|| Failure::marked(&source, &diagnostics))
}
