//! Where the result of a command goes. In: `--output`, `--force`, and a text. Out: the text on standard output, or in a file of that
//! name, whole or not at all.

use std::path::PathBuf;

use clap::Args;
use diagnosis::report::{Terminal, WIDTH};
use workshop::failure::Failure;
use workshop::written;

use crate::output;

/// Where a result goes.
#[derive(Args, Clone, Default)]
pub(crate) struct Target {
    /// Write the result to this file; by default it is printed.
    #[arg(long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Replace an existing file.
    #[arg(long, requires = "output")]
    pub(crate) force: bool,
}

impl Target {
    /// Refuses a place that cannot be written to, is one of the files that the command reads or writes besides, or is there
    /// already, unless `--force` replaces it: before any work is done.
    pub(crate) fn check(&self, others: &[PathBuf]) -> Result<(), Failure> {
        let Some(target) = &self.output else { return Ok(()) };
        written::check_folder(target, "--output")?;
        written::check_new(target, ("--output", "result.txt"), others, self.force)
    }

    /// Prints the result, or writes it to the file.
    pub(crate) fn put(&self, text: &str) -> Result<(), Failure> {
        match &self.output {
            Some(target) => written::whole(target, text),
            None => output::print(text),
        }
    }

    /// What the result is shown on; a file is as wide as a page and has colours only where all things have.
    pub(crate) fn terminal(&self) -> Terminal {
        match &self.output {
            Some(_) => Terminal { columns: WIDTH, color: output::is_always_colored() },
            None => output::terminal(),
        }
    }
}
