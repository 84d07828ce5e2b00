//! House rules that no compiler checks. In: every source file of the workspace. Out: the files that break one.

use std::fs;
use std::path::{Path, PathBuf};

use crate::shipped::root;

/// Folders that hold no source of ours.
const SKIPPED: [&str; 3] = ["target", ".git", "corpus"];

/// All Rust files under a folder, in order.
pub(crate) fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() && !SKIPPED.contains(&name.as_str()) {
            found.extend(rust_files(&path));
        } else if name.ends_with(".rs") {
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
