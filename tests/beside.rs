//! What tests need that is not in the repository. In: a name in `../shared`, beside the repository; or a reason. Out: where it is; or
//! a line that begins with `skipped: `, by which `.ci/run` counts the tests that had nothing to test. Tests of other crates have this
//! file as a module of theirs.

use std::path::{Path, PathBuf};
use std::{env, fs};

/// Set where a test that finds nothing to test in `../shared` must fail.
const REQUIRED: &str = "ABBE_REQUIRE_SHARED";

/// Says that a test, or a part of it, is not run here.
#[expect(clippy::print_stdout, reason = "whoever runs the tests is told what was not checked")]
pub(crate) fn skipped(why: &str) {
    println!("skipped: {why}");
}

/// A file or folder of `../shared`; nothing, with a line, where it is not there.
#[track_caller]
pub(crate) fn shared(name: &str) -> Option<PathBuf> {
    let mut folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let workspace = folders.find(|folder| folder.join("Cargo.lock").is_file()).unwrap();
    let path = workspace.join("../shared").join(name);
    if path.exists() {
        return Some(path);
    }
    let why = format!("there is no {}", path.display());
    assert!(env::var_os(REQUIRED).is_none(), "{why}, and {REQUIRED} is set");
    skipped(&why);
    None
}

/// What lies in a folder of `../shared`, in order; nothing, with a line, where the folder is not there. A folder that is there and
/// empty is a mistake.
#[track_caller]
pub(crate) fn listed(folder: &str) -> Option<Vec<PathBuf>> {
    let path = shared(folder)?;
    let mut entries: Vec<PathBuf> = fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    assert!(!entries.is_empty(), "{} is empty", path.display());
    Some(entries)
}
