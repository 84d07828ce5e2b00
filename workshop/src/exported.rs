//! The files of a controller. In: a calibrated machine, and what the user says of the controller. Out: the files, what is told of them,
//! and both written.

use std::io::Write;
use std::path::{Path, PathBuf};

use exchange::controller::{self, Export, Format, Geometry, Options, Refused, Space};

use crate::failure::Failure;
use crate::written;

/// The cross tables that a Sinumerik has where nothing else is said.
pub const TABLES: usize = 8;

/// What each format is called.
pub const FORMATS: [(&str, Format); 9] = [
    ("linuxcnc", Format::LinuxCnc),
    ("isg", Format::Isg),
    ("etalon", Format::Etalon),
    ("sinumerik", Format::Sinumerik),
    ("heidenhain", Format::Heidenhain),
    ("pmac", Format::Pmac),
    ("marlin", Format::Marlin),
    ("klipper", Format::Klipper),
    ("reprap", Format::RepRap),
];

/// The options that only some formats have.
const OPTIONS: [(&str, &[Format]); 6] = [
    ("type", &[Format::LinuxCnc]),
    ("unit", &[Format::LinuxCnc]),
    ("value", &[Format::Sinumerik, Format::Heidenhain]),
    ("tables", &[Format::Sinumerik]),
    ("name", &[Format::Sinumerik, Format::Heidenhain, Format::Pmac]),
    ("counts", &[Format::Pmac]),
];

/// Refuses options of other formats: whoever gives one means that it does something. `given` are the names of those that are given;
/// `dashes` stand before them where they are those of a command line.
///
/// # Errors
///
/// The first option that says nothing to the format.
pub fn check_options(format: Format, given: &[&str], dashes: &str) -> Result<(), Failure> {
    let stray = OPTIONS.iter().find(|(option, formats)| given.contains(option) && !formats.contains(&format));
    let Some((option, formats)) = stray else { return Ok(()) };
    let names: Vec<&str> = formats.iter().map(|format| name(*format)).collect();
    Err(Failure::wrong(format!(
        "error: {dashes}{option} has no effect on {}\nhelp: leave it out; it is an option for {}",
        name(format),
        names.join(", ")
    )))
}

/// What a format is called.
#[must_use]
pub fn name(format: Format) -> &'static str {
    FORMATS.iter().find(|(_, known)| *known == format).map_or("", |(name, _)| name)
}

/// The files of a controller.
///
/// # Errors
///
/// What the format cannot hold.
pub fn export(
    geometry: &Geometry<'_>,
    space: &Space,
    format: Format,
    options: &Options,
) -> Result<Export, Failure> {
    controller::export(geometry, space, format, options).map_err(refused)
}

/// Writes the files into a folder, all of them or none, and gives their places; `force` replaces those that are there.
///
/// # Errors
///
/// A file that is there already, a folder that is not there, a file that cannot be written.
pub fn write(export: &Export, folder: &Path, force: bool) -> Result<Vec<PathBuf>, Failure> {
    let targets: Vec<PathBuf> = export.files.iter().map(|file| folder.join(&file.name)).collect();
    check_targets(folder, &targets, force)?;
    let staged = targets
        .iter()
        .zip(&export.files)
        .map(|(target, file)| written::staged(target, |out| out.write_all(file.text.as_bytes())));
    let staged = staged.collect::<Result<Vec<_>, Failure>>()?;
    for (staged, target) in staged.into_iter().zip(&targets) {
        written::keep(staged, target)?;
    }
    Ok(targets)
}

/// What is told of the files, which stand at `targets`: what each is, how they are loaded, what they lose.
#[must_use]
pub fn text(export: &Export, targets: &[PathBuf], geometry: &Geometry<'_>, space: &Space) -> String {
    let files = targets
        .iter()
        .zip(&export.files)
        .map(|(target, file)| format!("{}: {}", target.display(), file.about));
    let mut text = listed("written", files);
    text += &listed("to load them", export.loading.iter().cloned());
    text += &listed("left out", export.left_out.iter().cloned());
    text += &controller::text(geometry, space, &export.lost);
    text
}

/// A heading and its lines; nothing where there are none.
pub fn listed(heading: &str, lines: impl Iterator<Item = String>) -> String {
    let lines: String = lines.map(|line| format!("  {line}\n")).collect();
    if lines.is_empty() { lines } else { format!("{heading}:\n{lines}") }
}

/// A refusal in the words of whoever refuses.
#[must_use]
#[expect(clippy::needless_pass_by_value, reason = "the form that `map_err` takes")]
pub fn refused(reason: Refused) -> Failure {
    Failure::wrong(reason.to_string())
}

/// Refuses files that are there already, unless they are to be replaced, and a folder that is not there.
fn check_targets(folder: &Path, targets: &[PathBuf], force: bool) -> Result<(), Failure> {
    for target in targets {
        if target.exists() && !force {
            return Err(Failure::wrong(format!(
                "error: {} already exists\nhelp: give another folder with --output, or replace the file with --force",
                target.display()
            )));
        }
    }
    if folder.is_dir() {
        return Ok(());
    }
    let folder = folder.display();
    Err(Failure::wrong(format!(
        "error: folder {folder} does not exist\nhelp: give an existing folder with --output"
    )))
}
