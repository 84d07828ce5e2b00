//! `abbe calibrate`: instruments' files into a calibration. In: a set-up file and the files that it names. Out: what they show,
//! with uncertainties, as text or JSON, and the calibration.

mod files;

use exchange::instrument::report;
use workshop::failure::Failure;
use workshop::load;
use workshop::set_up::SetUp;
use workshop::written;

use crate::arguments::{Calibrate, CalibrateFormat};
use crate::output::{Person, print};

/// Runs the command.
pub(crate) fn run(arguments: &Calibrate) -> Result<(), Failure> {
    let path = files::setup_among(&arguments.files)?;
    let person = Person::default();
    let read = SetUp::read(load::read(path)?, path, &person)?;
    if let Some(target) = &arguments.output {
        written::check_folder(target, "--output")?;
        written::check_new(target, ("--output", "calibration.yaml"), &read.files(), arguments.force)?;
    }
    let outcome = read.outcome(&person)?;
    // The report is shown also where the file cannot be written, the file is written also where the reader is gone.
    let written = arguments.output.as_ref().map_or(Ok(()), |target| {
        written::calibration(target, &read.calibration(target, &outcome)?, &read.equations)
    });
    print(&match arguments.format {
        CalibrateFormat::Text => report::text(&outcome, &read.equations),
        CalibrateFormat::Json => report::json(&outcome, &read.equations),
    })?;
    written
}
