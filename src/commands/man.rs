//! `abbe man`: manual pages. In: nothing, or a folder. Out: the page of the program, or one page for each command in the
//! folder, from the same arguments that the program reads.

use std::fs;
use std::path::Path;

use clap::{Command, CommandFactory};
use clap_mangen::Man as Page;
use workshop::failure::Failure;
use workshop::written;

use crate::arguments::{Arguments, Man};
use crate::output;

/// Runs the command.
pub(crate) fn run(command: &Man) -> Result<(), Failure> {
    let mut program = Arguments::command();
    program.build();
    match &command.output {
        None => output::print(&page(program)?),
        Some(folder) => pages(program, folder),
    }
}

fn pages(program: Command, folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder)
        .map_err(|error| Failure::io(&format!("cannot create {}", folder.display()), &error))?;
    let commands: Vec<Command> =
        program.get_subcommands().filter(|one| one.get_name() != "help").cloned().collect();
    write(folder, "abbe", program)?;
    for command in commands {
        let name = format!("abbe-{}", command.get_name());
        write(folder, &name, command)?;
    }
    Ok(())
}

fn write(folder: &Path, name: &str, command: Command) -> Result<(), Failure> {
    written::whole(&folder.join(format!("{name}.1")), &page(command)?)
}

fn page(command: Command) -> Result<String, Failure> {
    let mut bytes = Vec::new();
    Page::new(command).render(&mut bytes).map_err(|error| Failure::io("cannot make the page", &error))?;
    // What stands behind the options in a help are its examples.
    Ok(String::from_utf8_lossy(&bytes).replace("\n.SH EXTRA\n", "\n.SH EXAMPLES\n"))
}
