//! The figures of a laser's file. In: a set-up of one measurement, or the file of an instrument itself. Out: its evaluation, or why there
//! is none.

use std::path::{Path, PathBuf};

use evaluation::iso230_2::Target;
use evaluation::{Cycle, Evaluation, of_cycle};
use exchange::instrument::{file, stations};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use workshop::failure::Failure;
use workshop::load;
use workshop::set_up::SetUp;

use crate::output::{Person, show};

/// What a file of an instrument alone is taken for: it does not name its axis, and the figures do not depend on it.
const ALONE: &str = "setup: 1\nmachine: FX\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nmeasurements:\n";

/// The evaluation of a set-up or of a laser's file, and the files that it was read from; nothing of any other file.
pub(super) fn evaluated(path: &Path) -> Result<Option<(Evaluation, Vec<PathBuf>)>, Failure> {
    let Some(head) = load::head_of_file(path)? else { return Ok(None) };
    if file::is_sectioned(&head) {
        let setup = SetUp::read(alone(path), path, &Person::default())?;
        let mut evaluation = of_setup(&setup, path)?;
        let note =
            "The file names neither its axis, called X here, nor its sign. Use a set-up file to give both.";
        evaluation.positioning.iter_mut().for_each(|line| line.notes.push(note.to_owned()));
        return Ok(Some((evaluation, setup.files())));
    }
    let Ok(source) = load::read(path) else { return Ok(None) };
    let root = yaml::read(&source, &mut Diagnostics::new());
    // A recording has a `setup` too, which is no version.
    let is_setup = |root: &yaml::Node| root.get("setup").is_some_and(|version| version.text().is_some());
    if !root.is_some_and(|root| is_setup(&root)) {
        return Ok(None);
    }
    let setup = SetUp::read(source, path, &Person::default())?;
    Ok(Some((of_setup(&setup, path)?, setup.files())))
}

/// The set-up of a file that has none.
fn alone(path: &Path) -> SourceFile {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let name = name.replace('\'', "''");
    SourceFile::new(path.display().to_string(), format!("{ALONE}  - {{motion: EXX, data: '{name}'}}\n"))
}

fn of_setup(read: &SetUp, path: &Path) -> Result<Evaluation, Failure> {
    let (SetUp { source, equations, setup, .. }, [measured]) = (read, read.data.as_slice()) else {
        return Err(Failure::wrong(format!(
            "error: {} has {} measurements\nhelp: give a set-up with one file, of an axis's own motion such as EXX",
            path.display(),
            read.data.len()
        )));
    };
    let (mut in_setup, mut in_data) = (Diagnostics::new(), Diagnostics::new());
    let found = stations(setup, measured, equations, (&mut in_setup, &mut in_data));
    show(&measured.source, &in_data);
    let found = found.filter(|_| !in_setup.has_errors()).ok_or_else(|| Failure::marked(source, &in_setup))?;
    show(source, &in_setup);
    let axis = equations.axes.get(found.axis);
    let sides = found.up.into_iter().zip(found.down);
    let targets = found.positions.into_iter().zip(sides);
    let said = |key: &str| {
        let known = measured.about.iter().find(|(own, _)| own.eq_ignore_ascii_case(key));
        known.map(|(_, value)| value.clone())
    };
    Ok(of_cycle(Cycle {
        file: path.display().to_string(),
        machine: said("machine").unwrap_or_else(|| equations.machine.clone()),
        date: said("date"),
        axis: axis.map(|axis| axis.letter.clone()).unwrap_or_default(),
        rotary: axis.is_some_and(|axis| axis.rotary),
        targets: targets.map(|(position, (up, down))| Target { position, up, down }).collect(),
    }))
}
