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
            "error: one set-up makes one calibration\nhelp: name all files under its `measurements`"
                .to_owned(),
        )),
        (_, data) => Err(Failure::wrong(format!("{WHY}\n\n{}", indented(&setup_to_fill_in(data))))),
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
const WHY: &str = "error: the file of an instrument or a controller does not say which motion of which machine it shows, from where and in which sense\nhelp: write a set-up file and give that (`abbe new setup` writes it); for example";

fn indented(text: &str) -> String {
    text.lines().map(|line| format!("    {line}\n")).collect()
}

/// A set-up of these files, to be filled in.
pub(in crate::commands) fn setup_to_fill_in(data: &[&PathBuf]) -> String {
    let mut text = "setup: 1\nmachine: XYFZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\n".to_owned();
    let text_of = |path: &Path| load::read(path).map(|file| file.text().to_owned()).unwrap_or_default();
    let is_volumetric = |path: &&&PathBuf| volumetric_form(&text_of(path)).is_some();
    let (volumetric, others): (Vec<&&PathBuf>, Vec<&&PathBuf>) = data.iter().partition(is_volumetric);
    let form = |path: &&PathBuf| saved_form(&text_of(path));
    let (saved, measured): (Vec<&&PathBuf>, Vec<&&PathBuf>) =
        others.into_iter().partition(|path| form(path).is_some());
    let name = |path: &Path| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    for path in volumetric {
        text += &format!("volumetric: {}\n", name(path));
    }
    if !saved.is_empty() {
        text += "corrections:\n";
    }
    for path in saved {
        let more = match form(path) {
            Some(SavedForm::Screw) => ", axis: X, type: 1",
            Some(SavedForm::Codes) => ", x: [10 mm, 210 mm], y: [10 mm, 210 mm]",
            _ => "",
        };
        text += &format!("  - {{data: {}{more}}}\n", name(path));
    }
    if !measured.is_empty() {
        text += "measurements:\n";
    }
    for path in measured {
        text += &format!(
            "  - {{motion: EXX, data: {}, targets: {{origin: 0 mm, sign: +1}}, deviations: {{sign: +1}}}}\n",
            name(path)
        );
    }
    text
}
