//! `abbe completions`: what a shell needs to complete this command line. In: the shell. Out: its script, from the same
//! arguments that the program reads.

use clap::CommandFactory;
use workshop::failure::Failure;

use crate::arguments::{Arguments, Completions};
use crate::output;

/// Runs the command.
pub(crate) fn run(command: &Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(command.shell, &mut Arguments::command(), "abbe", &mut script);
    output::print(&String::from_utf8_lossy(&script))
}
