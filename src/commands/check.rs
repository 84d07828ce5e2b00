//! `abbe check`: a machine's equations against a published set, term by term.

use std::path::PathBuf;

use model_dsl::check;
use model_dsl::diagnostic::Diagnostics;
use workshop::failure::Failure;
use workshop::load;

use crate::arguments::Check;
use crate::output::{self, Person};

/// Runs the command; status 1 where the published equations disagree.
pub(crate) fn run(command: &Check) -> Result<(), Failure> {
    command.target.check(&[PathBuf::from(&command.machine), command.equations.clone()])?;
    let loaded = load::machine(&command.machine, None, &Person::default())?;
    let source = load::read(&command.equations)?;
    let mut diagnostics = Diagnostics::new();
    let compiled = &loaded.compiled;
    let report = check::check(&compiled.machine, &compiled.equations, &source, &mut diagnostics);
    let report = report.ok_or_else(|| Failure::marked(&source, &diagnostics))?;
    output::show(&source, &diagnostics);
    command.target.put(&report.text())?;
    if report.agrees() { Ok(()) } else { Err(Failure::no("")) }
}
