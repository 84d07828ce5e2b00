//! `abbe simulate`: the recording that a calibration predicts, along a path or in place of another recording, as two files.

use simulation::picture;
use workshop::calibrated;
use workshop::failure::Failure;
use workshop::load;
use workshop::recorded::{self, Recorded};
use workshop::simulated::{Output, driven, files_read, is_recording, known_calibration, plant, replayed};
use workshop::written;

use crate::arguments::Simulate;
use crate::output::{Person, warn};
use crate::progress::Progress;

/// Runs the command.
pub(crate) fn run(command: &Simulate) -> Result<(), Failure> {
    let calibrated = calibrated::read(&command.calibration, &Person::default())?;
    let names = calibrated.equations.names();
    let person = Person::new(command.quiet);
    let known = command.known.as_deref();
    let known = known.map(|known| known_calibration(known, &names, &Person::default())).transpose()?;
    let output = Output::of(&command.output);
    let source = load::read(&command.path)?;
    let read = files_read((&calibrated, &command.calibration), known.as_deref(), (&source, &command.path));
    output.check(&read, command.force)?;
    if let Some(plot) = &command.plot {
        let others = [read, vec![output.recording.clone(), output.data_path()]].concat();
        written::check_picture(plot, "--plot", &others, command.force)?;
    }
    let simulated = match is_recording(&source) {
        true => replayed(&recording(command)?, (&calibrated, &command.calibration), &person)?,
        false => driven(&source, &calibrated, command.seed, &person)?,
    };
    let folder = output.folder()?;
    if let Some(plot) = &command.plot {
        written::check_folder(plot, "--plot")?;
    }
    let head = output.head((&calibrated, &command.calibration), known.as_deref(), &folder)?;
    let progress = Progress::new(command.quiet, "writing the recording");
    let written = output.write(&simulated, &head);
    drop(progress);
    written?;
    if let Some(plot) = &command.plot {
        let progress = Progress::new(command.quiet, "drawing");
        let drawing = picture::svg(&simulated, &plant(&calibrated)?);
        drop(progress);
        written::whole(plot, &drawing)?;
    }
    let rows = simulated.time.len();
    warn(&format!("{rows} rows: {} and {}", output.recording.display(), output.data_path().display()));
    Ok(())
}

/// The recording that is to be replayed.
fn recording(command: &Simulate) -> Result<Recorded, Failure> {
    if command.seed.is_some() {
        let help = "help: leave out --seed; the prediction for a recording has no noise";
        return Err(Failure::wrong(format!("error: {} is a recording\n{help}", command.path.display())));
    }
    recorded::read(&command.path, &Person::new(command.quiet))
}
