//! Replaying a recording: what a machine with a given calibration would have shown in its place.
//!
//! In: a recording and a plant. Out: the same channels at the same times, as the model predicts them: no noise, no gap, and an
//! instrument that stands where the set-up says.

use recording::{Instrument as Recorder, Named, Recording};
use simulation::{Column, Commands, DEADBAND, Instrument, Measurement, Normal, Plant, Simulated};

/// A motion back by less is none where an axis's own feedback, with its noise, has to stand for its command: mm or rad.
const FEEDBACK_DEADBAND: f64 = 1e-3;

/// What the plant shows where the recording was taken; or, as a sentence, why that cannot be told.
pub(super) fn replayed(plant: Plant, recording: &Recording) -> Result<Simulated, String> {
    let commanded = recording.axes.iter().all(|axis| axis.command.is_some() || axis.position().is_none());
    let plant = plant.with_deadband(if commanded { DEADBAND } else { FEEDBACK_DEADBAND });
    let measurement =
        Measurement { drives: drives(recording), ..Measurement::perfect(instrument(recording)?) };
    let mut simulated =
        simulation::replay(&plant, &commands(recording), &measurement).map_err(|error| error.to_string())?;
    simulated.title.clone_from(&recording.title);
    simulated.holdout = recording.holdout.clone().unwrap_or_default();
    Ok(simulated)
}

/// The numbers of the axes whose drives were recorded.
fn drives(recording: &Recording) -> Vec<usize> {
    let axes = recording.axes.iter().enumerate();
    axes.filter(|(_, axis)| axis.actual.is_some()).map(|(number, _)| number).collect()
}

fn commands(recording: &Recording) -> Commands {
    let rows = recording.time.len();
    Commands {
        time: recording.time.clone(),
        run: recording.run.clone(),
        positions: recording.axes.iter().map(|axis| axis.position_or_zero(rows).into_owned()).collect(),
        temperatures: recording.temperatures.iter().map(column).collect(),
        loads: recording.loads.iter().map(column).collect(),
        ..Commands::default()
    }
}

fn column(named: &Named) -> Column {
    Column { name: named.name.clone(), unit: named.unit.clone(), values: named.values.clone() }
}

/// The instrument of the recording, without faults.
fn instrument(recording: &Recording) -> Result<Instrument, String> {
    Ok(match &recording.instrument {
        Recorder::Position => position_channels(recording),
        Recorder::Ballbar { center, radius } => Instrument::ballbar(*center, *radius),
        Recorder::Linear(line) => Instrument::linear(line.axis, line.direction),
        Recorder::Straightness(line) => Instrument::straightness(line.axis, line.direction),
        Recorder::Angular { axis, about } => Instrument::Angular { axis: *axis, about: *about },
        Recorder::Probe => Instrument::Probe { normal: Normal::Fixed(one_normal(recording)?) },
    })
}

fn position_channels(recording: &Recording) -> Instrument {
    let angles = recording.axes.iter().enumerate().filter(|(_, axis)| axis.measured.is_some());
    Instrument::Position {
        directions: recording.measured.each_ref().map(Option::is_some),
        angles: angles.map(|(number, _)| number).collect(),
    }
}

/// The normal of a probe whose surface looks the same way everywhere.
fn one_normal(recording: &Recording) -> Result<[f64; 3], String> {
    let [x, y, z] = recording.normal.as_ref().ok_or("the recording has no normals")?;
    let mut rows = x.iter().zip(y).zip(z).map(|((x, y), z)| [*x, *y, *z]);
    let first = rows.next().ok_or("the recording has no rows")?;
    let same = |normal: [f64; 3]| normal.iter().zip(first).all(|(own, first)| (own - first).abs() < 1e-9);
    if rows.all(same) {
        return Ok(first);
    }
    Err("a probe with a different normal in each row cannot be replayed".to_owned())
}
