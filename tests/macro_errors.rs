//! Mistakes behind `machine!`: one folder for each case in `cases/macro/`.
//!
//! In: `lib.rs` and the machine file that it names, as a crate of their own. Out: what the Rust compiler says, compared with
//! `stderr.txt`; `UPDATE=1` writes that file again. Every error stands at the literal.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shipped::root;

/// Compiles one case and gives what the compiler said of it, and whether it was content.
fn said(case: &Path, folder: &Path) -> (bool, String) {
    let source = folder.join("src");
    let _ = fs::remove_dir_all(&source);
    fs::create_dir_all(&source).unwrap();
    for entry in fs::read_dir(case).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap_or_default();
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("rs") => drop(fs::copy(&path, source.join(name)).unwrap()),
            Some("yaml") => drop(fs::copy(&path, folder.join(name)).unwrap()),
            _ => {}
        }
    }
    let output = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["check", "--offline", "--quiet", "--color", "never"])
        .current_dir(folder)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .env_remove("RUSTFLAGS")
        .output()
        .unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    let text = text.replace(&folder.display().to_string(), "$CRATE");
    // The last lines count the errors and name the crate.
    let kept = text.lines().take_while(|line| !line.starts_with("error: could not compile"));
    (output.status.success(), kept.map(|line| format!("{}\n", line.trim_end())).collect())
}

/// One crate for all cases, so that the compiler is compiled once.
fn prepared() -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("macro-errors");
    fs::create_dir_all(&folder).unwrap();
    let [macros, runtime] = ["macros", "runtime"].map(|name| root().join(name).canonicalize().unwrap());
    let manifest = format!(
        "[package]\nname = \"mistaken\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\nabbe-macros = {{ path = {macros:?} }}\nabbe-runtime = {{ path = {runtime:?}, features = [\"single\"] }}\n\n[workspace]\n"
    );
    fs::write(folder.join("Cargo.toml"), manifest).unwrap();
    fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    folder
}

#[test]
fn every_mistake_stands_at_the_literal() {
    let folder = prepared();
    let mut cases: Vec<PathBuf> =
        fs::read_dir(root().join("tests/cases/macro")).unwrap().map(|entry| entry.unwrap().path()).collect();
    cases.sort();
    let mut different = Vec::new();
    for case in cases {
        let (content, told) = said(&case, &folder);
        let name = case.file_name().unwrap_or_default().to_string_lossy().into_owned();
        assert_eq!(content, name == "warning", "{name}: {told}");
        let place = match (content, &*name) {
            (true, _) => "machine.yaml:",
            (false, "calibration" | "numbers-of-16-bits") => "--> src/lib.rs:5:43",
            (false, "beyond-32-bits") => "--> src/lib.rs:5:59",
            (false, _) => "--> src/lib.rs:5:27",
        };
        assert!(told.contains(place), "{name}: {told}");
        let expected = case.join("stderr.txt");
        if std::env::var_os("UPDATE").is_some_and(|value| value == "1") {
            fs::write(&expected, &told).unwrap();
        } else if fs::read_to_string(&expected).unwrap_or_default() != told {
            different.push(format!("{name}\n{told}"));
        }
    }
    assert!(
        different.is_empty(),
        "these differ; UPDATE=1 accepts them once read:\n\n{}",
        different.join("\n\n")
    );
}
