//! Which crates come with Abbe, and how much unsafe code is in each of them.
//!
//! In: the lock file of the workspace, and the sources of the crates that it names. Out: tables in Markdown on standard
//! output; with `--check` the lines in which `docs/dependencies.md` differs from them, and status 1; with `--write` that
//! document, brought up to date. It exists so that nobody compiles in what nobody has looked at.
//!
//! ```text
//! cargo run --example dependencies -- [--check | --write]
//! ```

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program for the terminal")]

mod crates;
mod document;
mod table;
mod unsafe_code;

use std::fs;
use std::process::ExitCode;

use crates::{Workspace, builds};

const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/dependencies.md");

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

/// Whether all is as it should be.
fn run() -> Result<bool, String> {
    let wish: Vec<String> = std::env::args().skip(1).collect();
    let workspace = Workspace::read()?;
    let tables = table::markdown(&builds(&workspace)?)?;
    match wish.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => print!("{tables}"),
        ["--write"] => {
            let text = document::renewed(&read()?, &tables)?;
            fs::write(DOCUMENT, text).map_err(|error| format!("{DOCUMENT}: {error}"))?;
        }
        ["--check"] => return Ok(told(&document::differences(&read()?, &tables, &workspace.direct)?)),
        _ => return Err("Usage: cargo run --example dependencies -- [--check | --write]".to_owned()),
    }
    Ok(true)
}

fn read() -> Result<String, String> {
    fs::read_to_string(DOCUMENT).map_err(|error| format!("{DOCUMENT}: {error}"))
}

/// Whether there is nothing to tell.
fn told(wrong: &[String]) -> bool {
    for line in wrong {
        println!("docs/dependencies.md: {line}");
    }
    if !wrong.is_empty() {
        println!("its tables are renewed by: cargo run --example dependencies -- --write");
    }
    wrong.is_empty()
}
