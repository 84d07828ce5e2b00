//! `abbe plan`: what a path would show that was not driven yet. In: a path file with its instrument and noise, and a machine. Out: from
//! which size on each effect would be found, and what to drive besides, as text, JSON or a page.

use std::path::PathBuf;

use limits::plan::driven;
use model_dsl::Compiled;
use model_dsl::calibration::Calibration;
use simulation::Plant;
use workshop::calibrated::{self, Calibrated};
use workshop::failure::Failure;
use workshop::load;
use workshop::origin::word;
use workshop::simulated::{read_path, wrong};

use super::limits::{answered, cannot, check_names, options, tell};
use crate::arguments::Plan;
use crate::output::Person;
use crate::progress::Progress;

/// Runs the command. Status 1 where the path shows no effect.
pub(crate) fn run(arguments: &Plan) -> Result<(), Failure> {
    let read = [&arguments.path].into_iter().chain(&arguments.calibration).cloned();
    let read: Vec<PathBuf> = read.chain(arguments.machine.iter().map(PathBuf::from)).collect();
    arguments.asked.target.check(&read)?;
    let machine = machine(arguments)?;
    let names = machine.equations.names();
    let asked = &arguments.asked;
    check_names(&asked.only, &names)?;
    let source = load::read(&arguments.path)?;
    let mut plant =
        Plant::new(&machine.machine, &names, &machine.calibration).map_err(|error| wrong(&error))?;
    let scenario = read_path(&source, &machine, &names, &mut plant, &Person::default())?.scenario;
    let progress = Progress::new(asked.quiet, "driving the path");
    let name = arguments.path.display().to_string();
    let compiled = Compiled { machine: machine.machine, equations: machine.equations };
    let known = driven(&name, &compiled, &machine.calibration, (&plant, &scenario))
        .map_err(|reason| cannot(&name, &reason))?;
    let found = answered(&known, asked, true, &progress);
    drop(progress);
    tell(found, &name, asked, &command(arguments))
}

/// The machine as it is known: with its calibration, or without any error.
fn machine(arguments: &Plan) -> Result<Calibrated, Failure> {
    if let Some(calibration) = &arguments.calibration {
        return calibrated::read(calibration, &Person::default());
    }
    let name = arguments.machine.as_deref().unwrap_or_default();
    let loaded = load::machine(name, None, &Person::default())?;
    let Compiled { machine, equations } = loaded.compiled;
    let constants = equations.constants.iter().map(|constant| constant.default.unwrap_or_default()).collect();
    let calibration = Calibration::new(name, constants);
    Ok(Calibrated {
        machine,
        calibration,
        source: loaded.source.unwrap_or_else(|| word_itself(name)),
        equations,
    })
}

/// What is shown of a machine that is a topology word.
fn word_itself(name: &str) -> model_dsl::source::SourceFile {
    model_dsl::source::SourceFile::new(name, name)
}

/// The command that makes the page again.
fn command(arguments: &Plan) -> String {
    let machine = match (&arguments.calibration, &arguments.machine) {
        (Some(calibration), _) => format!("--calibration {}", word(calibration)),
        (None, machine) => format!("--machine {}", machine.as_deref().unwrap_or_default()),
    };
    format!("abbe plan {} {machine}{} > plan.html", word(&arguments.path), options(&arguments.asked))
}
