//! `abbe evaluate`: the field's standard figures. In: a recording. Out: its figures, or why it cannot give them, as text, JSON
//! or a page.

use evaluation::{Inputs, report};
use workshop::failure::Failure;
use workshop::origin;
use workshop::recorded;

use crate::arguments::{Evaluate, EvaluationFormat};
use crate::output::{Person, print};
use crate::progress::Progress;

/// Runs the command. Status 1 where the recording gives no figure at all; the report says why.
pub(crate) fn run(arguments: &Evaluate) -> Result<(), Failure> {
    let recorded = recorded::read(&arguments.recording, &Person::new(arguments.quiet))?;
    let progress = Progress::new(arguments.quiet, "evaluating");
    let evaluation = evaluation::evaluate(&Inputs {
        equations: &recorded.equations,
        calibration: recorded.calibration.as_ref().map(|known| &known.calibration),
        recording: &recorded.recording,
    });
    drop(progress);
    print(&match arguments.format {
        EvaluationFormat::Text => report::text(&evaluation),
        EvaluationFormat::Json => report::json(&evaluation),
        EvaluationFormat::Html => report::html(&evaluation, &origin::evaluate(&arguments.recording)),
    })?;
    if evaluation.gives_any() { Ok(()) } else { Err(Failure::no("")) }
}
