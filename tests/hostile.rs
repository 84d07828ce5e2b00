//! Hostile files of every kind. In: the files of the repository and those of `fuzz/corpus`, as they are and with seeded
//! mutations. Out: nothing, or the file that breaks a promise of `abbe_fuzz`. It is the part of the search for such files
//! that needs no search: the same on every run, and done in seconds.

use std::fs;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use abbe_fuzz::mutate::{Chance, mutated};
use abbe_fuzz::{Run, TARGETS};

use crate::shipped::root;

/// What is bounded ends within a part of a second; what is not goes on for hours.
const ENDLESS: Duration = Duration::from_secs(60);

/// Where files of a kind lie besides the corpus: folders, and endings of names.
fn folders(target: &str) -> &'static [(&'static str, &'static str)] {
    match target {
        "machine" => &[("machines", "yaml"), ("tests/cases/machine", "yaml"), ("tests/fixtures", "yaml")],
        "calibration" => &[("calibrations", "yaml")],
        "equations" => &[("published", "eqs")],
        "positions" => &[("calibrations", "csv")],
        _ => &[],
    }
}

/// All files of a kind, in the order of their names.
fn files(target: &str) -> Vec<Vec<u8>> {
    let mut paths = Vec::new();
    find(&root().join("fuzz/corpus").join(target), None, &mut paths);
    for (folder, ending) in folders(target) {
        find(&root().join(folder), Some(ending), &mut paths);
    }
    paths.sort();
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

fn find(folder: &Path, ending: Option<&str>, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.unwrap().path();
        if path.is_dir() {
            find(&path, ending, found);
        } else if ending.is_none_or(|ending| path.extension().is_some_and(|own| own == ending)) {
            found.push(path);
        }
    }
}

/// Takes each file in turn; a panic and a file without an end both show the file.
fn all_hold(run: Run, files: impl Iterator<Item = Vec<u8>> + Send) {
    let (begun, begins) = mpsc::channel::<Option<Vec<u8>>>();
    thread::scope(|scope| {
        scope.spawn(move || {
            for file in files {
                begun.send(Some(file.clone())).unwrap();
                let done = panic::catch_unwind(AssertUnwindSafe(|| run(&file)));
                assert!(done.is_ok(), "breaks a promise, as told above:\n{}", shown(&file));
            }
            begun.send(None).unwrap();
        });
        let mut now = Vec::new();
        loop {
            match begins.recv_timeout(ENDLESS) {
                Ok(Some(file)) => now = file,
                // A thread that panicked is told of by the scope.
                Ok(None) | Err(mpsc::RecvTimeoutError::Disconnected) => break,
                Err(mpsc::RecvTimeoutError::Timeout) => {
                    // The scope would wait for the thread, which does not end.
                    abort_at(&now);
                }
            }
        }
    });
}

fn shown(file: &[u8]) -> String {
    format!("{}\n(escaped: {})", String::from_utf8_lossy(file), file.escape_ascii())
}

/// Ends the tests where a function does not.
#[expect(clippy::print_stderr, reason = "a program that is ended has no other way to say why")]
fn abort_at(file: &[u8]) -> ! {
    eprintln!("does not end:\n{}", shown(file));
    std::process::abort();
}

/// The files themselves, and then so many mutations.
fn target_holds(name: &str, mutations: usize) {
    let (_, run) = TARGETS.into_iter().find(|(target, _)| *target == name).unwrap();
    let files = files(name);
    assert!(files.len() > 1, "{name} has no files to start from");
    let mut chance = Chance::new(0xabbe);
    let changed = (0..mutations).map(|_| mutated(&files, &mut chance)).collect::<Vec<_>>();
    all_hold(run, files.iter().cloned().chain(changed));
}

#[test]
fn machine_files() {
    target_holds("machine", 1500);
}

#[test]
fn calibration_files() {
    target_holds("calibration", 1500);
}

#[test]
fn recordings() {
    target_holds("recording", 1500);
}

#[test]
fn equation_files() {
    target_holds("equations", 100);
}

#[test]
fn path_files() {
    target_holds("path", 1500);
}

#[test]
fn positions() {
    target_holds("positions", 3000);
}

#[test]
fn files_of_instruments() {
    target_holds("instrument", 3000);
}

#[test]
fn fleet_files() {
    target_holds("fleet", 3000);
}

/// A kind of file without a test here would be searched by hand alone.
#[test]
fn every_target_is_tested() {
    let own = include_str!("hostile.rs");
    for (name, _) in TARGETS {
        assert!(own.contains(&format!("target_holds({name:?}, ")), "{name} has no test");
    }
}
