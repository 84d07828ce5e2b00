//! House rules that no compiler checks. In: every source file of the workspace, and its lock files. Out: the files that break one.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::shipped::root;

/// Folders that hold no source of ours.
const SKIPPED: [&str; 3] = ["target", ".git", "corpus"];

/// All Rust files under a folder, in order.
pub(crate) fn rust_files(folder: &Path) -> Vec<PathBuf> {
    files(folder, ".rs")
}

/// All files under a folder whose names end so, in order.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() && !SKIPPED.contains(&name.as_str()) {
            found.extend(files(&path, ending));
        } else if name.ends_with(ending) {
            found.push(path);
        }
    }
    found
}

fn breaking(rule: impl Fn(&Path, &str) -> bool) -> Vec<PathBuf> {
    rust_files(&root()).into_iter().filter(|path| !rule(path, &fs::read_to_string(path).unwrap())).collect()
}

#[test]
fn every_file_says_what_it_is() {
    let broken = breaking(|_, text| text.starts_with("//! "));
    assert!(broken.is_empty(), "these do not open with `//!`: {broken:#?}");
}

/// What is iterated in the compiler reaches its output, so its order must be that of the input or of the names.
#[test]
fn the_compiler_has_no_hash_maps() {
    let compiler = root().join("model-dsl/src");
    let broken = breaking(|path, text| {
        !path.starts_with(&compiler) || !text.contains("HashMap") && !text.contains("HashSet")
    });
    assert!(broken.is_empty(), "unordered maps in {broken:#?}");
}

/// An exception to a lint gives its reason and goes stale loudly. The code that the compiler writes cannot: whether a number of a
/// machine is near a constant is not known when the exception is written.
#[test]
fn lints_are_expected_and_never_allowed() {
    let (attribute, writer) = (["#[al", "low("].concat(), root().join("model-dsl/src/codegen.rs"));
    let broken = breaking(|path, text| path == writer || !text.contains(&attribute));
    assert!(broken.is_empty(), "write #[expect(lint, reason = \"...\")] in {broken:#?}");
}

/// The crates outside the workspace are built where it is: another version of a crate that both lock would be compiled a second time.
#[test]
fn the_lock_files_lock_the_same_versions() {
    let workspace = root().join("Cargo.lock");
    let known = locked(&workspace);
    let outside: Vec<PathBuf> =
        files(&root(), "Cargo.lock").into_iter().filter(|file| *file != workspace).collect();
    assert!(!outside.is_empty());
    let differing: Vec<String> = outside.iter().flat_map(|file| differing(&known, file)).collect();
    assert!(differing.is_empty(), "`cargo update --precise` mends these: {differing:#?}");
}

/// What a lock file locks in another version than those that are known, where one of them may stand for it.
fn differing(known: &BTreeMap<String, Vec<String>>, file: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for (name, versions) in locked(file) {
        let Some(known) = known.get(&name) else { continue };
        for version in versions.iter().filter(|version| !known.contains(version)) {
            if known.iter().any(|known| compatible(known) == compatible(version)) {
                let known = known.join(", ");
                found.push(format!("{}: {name} {version}, where the workspace has {known}", file.display()));
            }
        }
    }
    found
}

/// The versions of each crate that a lock file takes from a registry.
fn locked(file: &Path) -> BTreeMap<String, Vec<String>> {
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let text = fs::read_to_string(file).unwrap();
    for package in text.split("[[package]]").filter(|package| package.contains("\nsource = ")) {
        let value = |key: &str| {
            let mut values = package.lines().filter_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
            values.next().unwrap().trim_matches('"').to_owned()
        };
        found.entry(value("name")).or_default().push(value("version"));
    }
    found
}

/// What versions have in common that may stand for each other: the first number that is not zero, and what is before it.
fn compatible(version: &str) -> &str {
    let zeros = version.len() - version.trim_start_matches("0.").len();
    let end = version[zeros..].find('.').map_or(version.len(), |end| zeros + end);
    &version[..end]
}

#[test]
fn versions_that_may_stand_for_each_other() {
    assert_eq!(compatible("1.12.1"), "1");
    assert_eq!(compatible("0.13.5"), "0.13");
    assert_eq!(compatible("0.0.3"), "0.0.3");
}
