//! `abbe fleet`: many machines over years. In: a fleet file. Out: results of its recordings, and what changed in its machines.

mod show;

use std::path::Path;

use fleet::add::add;
use fleet::file::{self, Fleet as Known};
use fleet::run::{Done, Step, all, one, pending};
use workshop::failure::Failure;

use crate::arguments::{Fleet, FleetAdd, FleetCommand, FleetRun};
use crate::output::{Person, print, warn};
use crate::progress::Progress;

/// Runs the command.
pub(crate) fn run(arguments: &Fleet) -> Result<(), Failure> {
    match &arguments.command {
        FleetCommand::Run(command) => run_jobs(command),
        FleetCommand::Add(command) => take_over(command),
        FleetCommand::Show(command) => show::run(command),
    }
}

fn read(path: &Path) -> Result<Known, Failure> {
    file::read(path, &Person::default())
}

/// Does jobs, or lists them. Status 1 where a job is not what it was when it was listed, and where the list is not whole.
fn run_jobs(arguments: &FleetRun) -> Result<(), Failure> {
    let fleet = read(&arguments.fleet)?;
    if !arguments.job.is_empty() {
        return arguments.job.iter().try_for_each(|name| one(&fleet, name, arguments.pages));
    }
    if arguments.list {
        let listed = pending(&fleet, arguments.shard, &Person::default())?;
        listed.jobs.iter().try_for_each(|job| print(&job.line()))?;
        return match listed.put_off {
            0 => Ok(()),
            some => Err(Failure::no(format!(
                "error: {some} cannot be read now, and not in the list\nhelp: list the jobs again later"
            ))),
        };
    }
    let progress = Progress::new(arguments.quiet, "looking for recordings");
    let show = |step: Step<'_>| {
        let (done, of) = step.done;
        if progress.is_watched() {
            progress.part(&format!("{} {done} of {of}", step.step), done as f64 / of.max(1) as f64);
        }
    };
    let done = all(&fleet, (arguments.shard, arguments.pages), &Person::default(), &show)?;
    drop(progress);
    if !arguments.quiet {
        warn(&told(done));
    }
    Ok(())
}

fn told(done: Done) -> String {
    let Done { recordings, diagnosed, errors, followed, waiting, put_off } = done;
    let errors = if errors == 0 { String::new() } else { format!(", {errors} with errors") };
    let waiting = match waiting {
        0 => String::new(),
        1 => {
            "; one machine waits for the rest of its recordings: run again when they are diagnosed".to_owned()
        }
        more => format!(
            "; {more} machines wait for the rest of their recordings: run again when they are diagnosed"
        ),
    };
    let put_off = match put_off {
        0 => String::new(),
        some => format!("; {some} postponed to the next run"),
    };
    let plural = if recordings == 1 { "" } else { "s" };
    format!(
        "{recordings} recording{plural}: {diagnosed} diagnosed{errors}, {followed} followed again{waiting}{put_off}"
    )
}

fn take_over(arguments: &FleetAdd) -> Result<(), Failure> {
    let fleet = read(&arguments.fleet)?;
    let added = add(&fleet, &arguments.results, &Person::default())?;
    let plural = if added.taken == 1 { "" } else { "s" };
    warn(&format!(
        "{} result{plural} added, {} already known, {} refused",
        added.taken, added.known, added.refused
    ));
    Ok(())
}
