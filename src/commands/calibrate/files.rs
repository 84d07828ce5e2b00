//! The files that the command was given. In: their names. Out: the set-up among them; or, where they are files of instruments, a
//! set-up of them to fill in.

use std::path::{Path, PathBuf};

use exchange::controller::{SavedForm, saved_form, volumetric_form};
use exchange::instrument::file;
use workshop::failure::Failure;
use workshop::load;

/// The set-up, which is given alone.
pub(super) fn setup_among(files: &[PathBuf]) -> Result<&Path, Failure> {
    let mut data = Vec::new();
    for path in files {
        if is_of_an_instrument(path)? {
            data.push(path);
        }
    }
    match (files, data.as_slice()) {
        ([setup], []) => Ok(setup),
        (_, []) => Err(Failure::wrong(
            "error: give one set-up for one calibration\nhelp: list all files under its `measurements`"
                .to_owned(),
        )),
        (_, data) => Err(Failure::wrong(format!("{WHY}\n\n{}", indented(&beside(data))))),
    }
}

/// Whether a file is what an instrument or a controller wrote, by its name or its first words.
fn is_of_an_instrument(path: &Path) -> Result<bool, Failure> {
    const NAMES: [&str; 11] = ["csv", "rtl", "rta", "rtx", "rts", "txt", "cfg", "comp", "g", "gcode", "log"];
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    if NAMES.iter().any(|name| ending.eq_ignore_ascii_case(name)) {
        return Ok(true);
    }
    Ok(load::head_of_file(path)?.is_some_and(|head| file::is_sectioned(&head)))
}

/// Why the file of an instrument alone makes no calibration.
const WHY: &str = "error: the file of an instrument or a controller does not name its machine, its error motion, its origin or its sign\nhelp: write a set-up file and give that instead (`abbe new setup` writes one), for example";

fn indented(text: &str) -> String {
    text.lines().map(|line| format!("    {line}\n")).collect()
}

/// A set-up beside these files.
fn beside(data: &[&PathBuf]) -> String {
    let name = |path: &&PathBuf| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let names: Vec<String> = data.iter().map(name).collect();
    setup_to_fill_in(&data.iter().copied().zip(&names).collect::<Vec<_>>())
}

/// Error motions for the measurements of a set-up that is to be filled in, in the order in which instruments mostly measure them: each file
/// shows another one.
const MOTIONS: [&str; 9] = ["EXX", "EYY", "EZZ", "EYX", "EZX", "EXY", "EZY", "EXZ", "EYZ"];

/// A set-up of these files, to be filled in; each with the name by which the set-up finds it.
pub(in crate::commands) fn setup_to_fill_in(data: &[(&PathBuf, &String)]) -> String {
    let mut text = "setup: 1\nmachine: XYFZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\n".to_owned();
    let text_of = |path: &Path| load::read(path).map(|file| file.text().to_owned()).unwrap_or_default();
    let is_volumetric = |(path, _): &&(&PathBuf, &String)| volumetric_form(&text_of(path)).is_some();
    let (volumetric, others): (Vec<_>, Vec<_>) = data.iter().partition(is_volumetric);
    let form = |path: &Path| saved_form(&text_of(path));
    let (saved, measured): (Vec<_>, Vec<_>) = others.into_iter().partition(|(path, _)| form(path).is_some());
    for (_, name) in volumetric {
        text += &format!("volumetric: {name}\n");
    }
    if !saved.is_empty() {
        text += "corrections:\n";
    }
    for (path, name) in saved {
        let more = match form(path) {
            Some(SavedForm::Screw) => ", axis: X, type: 1",
            Some(SavedForm::Codes) => ", x: [10 mm, 210 mm], y: [10 mm, 210 mm]",
            _ => "",
        };
        text += &format!("  - {{data: {name}{more}}}\n");
    }
    if !measured.is_empty() {
        text += "measurements:\n";
    }
    for ((_, name), motion) in measured.into_iter().zip(MOTIONS.into_iter().cycle()) {
        text += &format!(
            "  - {{motion: {motion}, data: {name}, targets: {{origin: 0 mm, sign: +1}}, deviations: {{sign: +1}}}}\n"
        );
    }
    text
}
