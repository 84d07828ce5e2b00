//! Files that are written. In: a name and a text. Out: the file, whole or not at all; a calibration only where the compiler
//! reads it again.

mod staged;

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use model_dsl::calibration;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use model_dsl::yaml;

use crate::failure::Failure;
use crate::told::Words;
use staged::Staged;

/// The folder of a file.
pub fn folder(file: &Path) -> PathBuf {
    match file.parent() {
        Some(parent) if parent != Path::new("") => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// A line of comment: it ends with its line, and a file's name in it must not end it.
pub fn comment(text: &str) -> String {
    let control =
        |letter: char| letter.is_control() || matches!(letter, '\u{2028}' | '\u{2029}' | '\u{feff}');
    let text: String = text.chars().map(|letter| if control(letter) { ' ' } else { letter }).collect();
    format!("# {text}\n")
}

/// Writes a calibration; nothing is written that the compiler would not take.
pub fn calibration(target: &Path, text: &str, equations: &Equations) -> Result<(), Failure> {
    keep(staged_calibration(target, text, equations)?, target)
}

/// Writes a calibration beside its place, so that it can get its name together with other files.
pub fn staged_calibration(target: &Path, text: &str, equations: &Equations) -> Result<Staged, Failure> {
    let source = SourceFile::new(target.display().to_string(), text);
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(&source, &mut diagnostics);
    let read = root.and_then(|root| calibration::read(&root, &equations.names(), &mut diagnostics));
    match read {
        Some(_) => staged(target, |file| file.write_all(text.as_bytes())),
        None => Err(Failure::Wrong(Words::marked(&source, &diagnostics).then(
            "error: the calibration was not written, because it could not be read back; this is a bug in Abbe",
        ))),
    }
}

/// Checks, before any work is done, that a picture may be written to `target`. `option` is the option that named it.
///
/// # Errors
///
/// `target` is a folder or one of `others`, the files that the command reads or writes besides; or it exists and `force` is not set.
pub fn check_picture(target: &Path, option: &str, others: &[PathBuf], force: bool) -> Result<(), Failure> {
    check_new(target, (option, "picture.svg"), others, force)
}

/// The same for a file of any kind; the option comes with an example of a name.
///
/// # Errors
///
/// As for a picture.
pub fn check_new(
    target: &Path,
    (option, example): (&str, &str),
    others: &[PathBuf],
    force: bool,
) -> Result<(), Failure> {
    let wrong = |what: &str, help: &str| {
        Err(Failure::wrong(format!("error: {} {what}\nhelp: {help}", target.display())))
    };
    let name = format!("give {option} the name of a file, such as {example}");
    if target.file_name().is_none() || target.is_dir() {
        return wrong("is a folder", &name);
    }
    if is_one_of(target, others) {
        return wrong("is one of the files that this command reads or writes", &name);
    }
    if target.exists() && !force {
        return wrong(
            "already exists",
            &format!("give another path with {option}, or replace it with --force"),
        );
    }
    Ok(())
}

/// Whether a file is one of some others, by whatever names and links.
pub fn is_one_of(file: &Path, others: &[PathBuf]) -> bool {
    // A folder that is still to be made holds no file of that name.
    let new = |file: &Path| Some(folder(file).canonicalize().ok()?.join(file.file_name()?));
    // What a link leads to is what would be written over.
    let place = |file: &Path| file.canonicalize().ok().or_else(|| new(file));
    let own = place(file);
    others.iter().any(|other| other == file || own.is_some() && place(other) == own)
}

/// Refuses a place whose folder is not there.
pub fn check_folder(target: &Path, option: &str) -> Result<(), Failure> {
    if folder(target).is_dir() {
        return Ok(());
    }
    Err(Failure::wrong(format!(
        "error: {} cannot be written: its folder does not exist\nhelp: give {option} the name of a file in an existing folder",
        target.display()
    )))
}

/// Writes a file that gets its name only when it is complete and on the disk; what stood there before is replaced.
pub fn whole(target: &Path, text: &str) -> Result<(), Failure> {
    keep(staged(target, |file| file.write_all(text.as_bytes()))?, target)
}

/// Gives a staged file its name.
///
/// # Errors
///
/// Why it cannot have it.
pub fn keep(staged: Staged, target: &Path) -> Result<(), Failure> {
    staged.keep().map_err(|error| cannot_write(target, &error))
}

/// Writes a file beside its place, so that it can get its name together with others.
pub fn staged(target: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> Result<Staged, Failure> {
    Staged::write(target, fill).map_err(|error| cannot_write(target, &error))
}

/// Why a file could not be written.
pub fn cannot_write(target: &Path, error: &io::Error) -> Failure {
    Failure::io(&format!("cannot write {}", target.display()), error)
}
