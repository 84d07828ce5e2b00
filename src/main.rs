//! The command line `abbe`: thin doors to the compiler and the runtime.
//!
//! In: arguments, files and standard input. Out: machine output on standard output, everything
//! for people on standard error, and an exit status: 0 done, 1 the check or the data says no,
//! 2 the command or a file is wrong. No mathematics stands here.

mod arguments;
mod commands;
mod decimal;
mod map;
mod output;
mod positions;
mod progress;
mod target;

use std::process::ExitCode;

use arguments::{Arguments, Command};
use clap::Parser;
use workshop::failure::Failure;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    output::color(arguments.color);
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::report(&failure);
            status(&failure)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.command {
        Command::Derive(command) => commands::derive::run(command),
        Command::Check(command) => commands::check::run(command),
        Command::Expand(command) => commands::expand::run(command),
        Command::Compensate(command) => commands::compensate::run(command),
        Command::Diagnose(command) => commands::diagnose::run(command),
        Command::Limits(command) => commands::limits::run(command),
        Command::Plan(command) => commands::plan::run(command),
        Command::Simulate(command) => commands::simulate::run(command),
        Command::Calibrate(command) => commands::calibrate::run(command),
        Command::Update(command) => commands::update::run(command),
        Command::Evaluate(command) => commands::evaluate::run(command),
        Command::Fleet(command) => commands::fleet::run(command),
        Command::Export(command) => commands::export::run(command),
        Command::New(command) => commands::new::run(command),
        Command::Explain(command) => commands::explain::run(command),
        Command::Completions(command) => commands::completions::run(command),
        Command::Man(command) => commands::man::run(command),
    }
}

/// The exit status of a failure.
fn status(failure: &Failure) -> ExitCode {
    match failure {
        Failure::No(_) => ExitCode::from(1),
        Failure::Wrong(_) => ExitCode::from(2),
        Failure::ClosedPipe => ExitCode::SUCCESS,
    }
}
