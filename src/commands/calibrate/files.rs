//! The files that the command was given. In: their names. Out: the set-up among them; or, where they are files of instruments, a
//! set-up of them to fill in.

use std::path::{Path, PathBuf};

use exchange::instrument::file;
use workshop::begin;
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
        (_, data) => Err(Failure::wrong(format!("{WHY}\n\n{}", indented(&beside(data)?)))),
    }
}

/// Whether a file is what an instrument or a controller wrote, by its name or its first words.
fn is_of_an_instrument(path: &Path) -> Result<bool, Failure> {
    const NAMES: [&str; 11] = ["csv", "rtl", "rta", "rtx", "rts", "txt", "cfg", "comp", "g", "gcode", "log"];
    if !path.exists() {
        // The error names a file in the folder whose name is similar.
        load::bytes(path)?;
    }
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
fn beside(data: &[&PathBuf]) -> Result<String, Failure> {
    let name = |path: &&PathBuf| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let files: Vec<(&Path, String)> = data.iter().map(|path| (path.as_path(), name(path))).collect();
    begin::setup(&files)
}
