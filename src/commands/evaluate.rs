//! `abbe evaluate`: the field's standard figures. In: a recording, a set-up of one measurement, or a laser's file. Out: its figures,
//! or why it cannot give them, as text, JSON or a page.

mod laser;

use evaluation::{Evaluation, Inputs, report};
use workshop::failure::Failure;
use workshop::named::Files;
use workshop::origin;
use workshop::recorded;
use workshop::tools;

use crate::arguments::{Evaluate, EvaluationFormat};
use crate::output::Person;
use crate::progress::Progress;

/// Runs the command. Status 1 where the recording gives no figure at all; the report says why.
pub(crate) fn run(arguments: &Evaluate) -> Result<(), Failure> {
    if let Some((evaluation, files)) = laser::evaluated(&arguments.recording)? {
        if arguments.tool.is_some() {
            return Err(no_calibration());
        }
        arguments.target.check(&files)?;
        return tell(arguments, &evaluation);
    }
    let mut recorded = recorded::read_in_order(&arguments.recording, &Person::new(arguments.quiet))?;
    if let Some(name) = &arguments.tool {
        let calibrated = recorded.calibration.as_mut().ok_or_else(no_calibration)?;
        tools::mount(&mut calibrated.calibration, name)?;
    }
    arguments.target.check(&Files::of(&recorded, &arguments.recording).all(None))?;
    let progress = Progress::new(arguments.quiet, "evaluating");
    let evaluation = evaluation::evaluate(&Inputs {
        equations: &recorded.equations,
        calibration: recorded.calibration.as_ref().map(|known| &known.calibration),
        recording: &recorded.recording,
    });
    let evaluation = if recorded.in_order { evaluation.in_order() } else { evaluation };
    drop(progress);
    tell(arguments, &evaluation)
}

/// Tools are a calibration's.
fn no_calibration() -> Failure {
    Failure::wrong(
        "error: --tool: the file names no calibration, and only a calibration has tools\n\
         help: write `calibration: FILE` in the recording file"
            .to_owned(),
    )
}

fn tell(arguments: &Evaluate, evaluation: &Evaluation) -> Result<(), Failure> {
    arguments.target.put(&match arguments.format {
        EvaluationFormat::Text => report::text(evaluation),
        EvaluationFormat::Json => report::json(evaluation),
        EvaluationFormat::Html => report::html(evaluation, &origin::evaluate(&arguments.recording)),
    })?;
    if evaluation.gives_any() { Ok(()) } else { Err(Failure::no("")) }
}
