//! All end-to-end tests, as one program: links once, and no file can be forgotten.
//!
//! In: the workspace as its users see it. Out: the laws that hold across crates.

#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

mod agreement;
mod aiming;
mod altered;
mod beside;
mod bounded;
mod browser;
mod calibrate;
mod cases_nist_update;
mod cli;
mod compensation;
mod compiled;
mod concealed;
mod counts;
mod dependencies;
mod diagnose;
mod evaluate;
mod examples;
mod experiments;
mod explain;
mod export;
mod files;
mod fleet;
mod found;
mod generated;
mod guide;
mod hostile;
mod killed;
mod laws;
mod limits;
mod machine_files;
mod macro_errors;
mod manuals;
mod odd_machines;
mod oracle;
mod page;
mod pictures;
mod plates;
mod pointing;
mod processors;
mod published_table;
mod python;
mod random;
mod real_recordings;
mod reproducible;
mod round_trips;
mod schemas;
mod shipped;
mod shipped_recordings;
mod simulate;
mod single;
mod snapshots;
mod terminal;
mod tidy;
mod tools;
mod vocabulary;
mod yaml;

/// Every file beside this one is a module of this program.
#[test]
fn no_test_file_is_forgotten() {
    let listed = include_str!("runner.rs");
    for entry in std::fs::read_dir(shipped::root().join("tests")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if let Some(module) = name.strip_suffix(".rs").filter(|module| *module != "runner") {
            let line = format!("\nmod {module};\n");
            assert!(listed.contains(&line), "tests/{name} is not in tests/runner.rs: add `mod {module};`");
        }
    }
}
