//! A set-up to begin with. In: files of instruments and controllers. Out: a commented set-up file of them, in which what the files do not
//! say themselves is left to be filled in.

use std::path::Path;

use exchange::controller::{SavedForm, motion_of, saved_form, volumetric_form};
use exchange::instrument::file::{self, Columns};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::quantity::unit_in_name;
use recording::foreign;

use super::recording::quoted;
use super::table;
use crate::failure::Failure;
use crate::load;

/// What stands for an error motion that nobody has told.
const UNKNOWN: &str = "E??";

/// What the file says above its measurements.
const MEASUREMENTS: &str = "\
# motion: the error motion that the file shows; `abbe explain EXX` describes one
# targets: {origin: 0 mm} is the position of the axis at the file's target 0; {sign: -1} if the targets count against the axis
# deviations: {sign: -1} if the sensor counts against the ISO sense: the motion of the tool relative to the part
measurements:
";

/// What one file is.
enum Content {
    /// Error motions that somebody has determined.
    Volumetric,
    /// What a controller adds to its commands.
    Saved(SavedForm),
    /// Readings, of the error motions that the file names.
    Measured(Vec<String>),
}

/// A commented set-up file of these files, each with the name by which the set-up finds it.
///
/// # Errors
///
/// A file that cannot be read, or is none that `abbe calibrate` reads.
pub fn setup(files: &[(&Path, String)]) -> Result<String, Failure> {
    let mut text = "# A set-up file for Abbe: what the files of instruments and controllers show. Check each line.\n\
        setup: 1\n\
        machine: XYFZ   # a machine file, a shipped machine or a topology word\n\
        # source: who measured what, with which instrument, when\n\
        constants: {Xt: 0 mm, Yt: 0 mm, Zt: -120 mm}   # the machine's own: here the tip of the tool is 120 mm below the head\n"
        .to_owned();
    let (mut corrections, mut measurements) = (String::new(), String::new());
    for (path, name) in files {
        let name = quoted(name);
        match content(path)? {
            Content::Volumetric => text += &format!("volumetric: {name}\n"),
            Content::Saved(form) => corrections += &correction(form, &name),
            Content::Measured(motions) => measurements += &measured(&motions, &name),
        }
    }
    if !corrections.is_empty() {
        text += &format!("corrections:\n{corrections}");
    }
    if !measurements.is_empty() {
        text += &format!("{MEASUREMENTS}{measurements}");
    }
    Ok(text)
}

/// Reads a file and tells what it is.
fn content(path: &Path) -> Result<Content, Failure> {
    let refused =
        |what: &str, help: &str| Failure::wrong(format!("error: {} {what}\nhelp: {help}", path.display()));
    if path.is_dir() {
        return Err(refused("is a folder", "give the files in it"));
    }
    let bytes = load::bytes(path)?;
    if bytes.trim_ascii().is_empty() {
        return Err(refused("is empty", "give the file that the instrument wrote"));
    }
    if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PAR1") {
        return Err(refused(
            "is a workbook or a packed file, which Abbe does not calibrate from",
            "save the table as CSV",
        ));
    }
    if let Some((what, help)) = foreign(&bytes) {
        return Err(refused(&format!("is {what}, which Abbe does not read"), help));
    }
    let source = file::text(&path.display().to_string(), &bytes);
    if file::is_sectioned(&bytes) || file::is_dynamic(&bytes) {
        let mut found = Diagnostics::new();
        if file::read(source.clone(), &Columns::default(), &mut found).is_none() {
            return Err(Failure::marked(&source, &found));
        }
        return Ok(Content::Measured(in_name(path)));
    }
    if volumetric_form(source.text()).is_some() {
        return Ok(Content::Volumetric);
    }
    if let Some(form) = saved_form(source.text()) {
        return Ok(Content::Saved(form));
    }
    let columns = table::columns_of(path, source.text())?;
    let motions: Vec<String> = columns.names.iter().filter_map(|name| motion(bare(name))).collect();
    Ok(Content::Measured(if motions.is_empty() { in_name(path) } else { motions }))
}

/// The name of a column without its unit.
fn bare(name: &str) -> &str {
    unit_in_name(name).map_or(name, |(bare, _)| bare)
}

/// An error motion of an axis, by its ISO name in any letter case.
fn motion(word: &str) -> Option<String> {
    let word = word.to_ascii_uppercase();
    motion_of(&word).filter(|motion| *motion == word)
}

/// The error motion in the name of a file: `x-EYX.rtl`.
fn in_name(path: &Path) -> Vec<String> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    name.split(|letter: char| !letter.is_alphanumeric()).filter_map(motion).take(1).collect()
}

fn correction(form: SavedForm, name: &str) -> String {
    let (keys, check) = match form {
        SavedForm::Screw => (
            ", axis: X, type: 1",
            "   # the axis; type 0: actual positions of the joint, 1: what is added to the command",
        ),
        SavedForm::Codes => (", x: [10 mm, 210 mm], y: [10 mm, 210 mm]", "   # the range of the mesh"),
        _ => ("", ""),
    };
    format!("  - {{data: {name}{keys}}}{check}\n")
}

/// The lines of a file with readings: one for each error motion in it, or one whose motion is to be filled in.
fn measured(motions: &[String], name: &str) -> String {
    let line = |motion: &str, told: &str| {
        format!(
            "  - {{motion: {motion}, data: {name}, targets: {{origin: 0 mm, sign: +1}}, deviations: {{sign: +1}}}}{told}\n"
        )
    };
    if motions.is_empty() {
        return line(UNKNOWN, "   # put in the error motion that the file shows");
    }
    motions.iter().map(|motion| line(motion, "")).collect()
}
