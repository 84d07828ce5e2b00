//! How a recording was taken. In: the recording. Out: the instrument and the commands as the simulation has them, where the
//! readings stand, and what effects follow.

use model_dsl::calibration::MachineNames;
use recording::{AxisChannels, Instrument as Recorder, Named, Recording};
use simulation::{Column, Commands, Instrument};

use crate::injection::columns::{difference, filled, rms, straightened};
use crate::injection::effect::Path;
use crate::injection::state::{Axis, Clock};

/// A way back by less than this part of the travel is rounding of a command.
const ROUNDING: f64 = 1e-6;

/// The same of a drive's feedback, which jitters.
const JITTER: f64 = 1e-3;

/// A drive further behind its command than this part of the travel is where its own feedback has it, not its command.
const BEHIND: f64 = 1e-3;

/// What is further from its command than this part of the travel was not told where to be: the command is where it shall
/// come to in the end.
const END_POINT: f64 = 0.1;

/// Where a reading stands in the recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outlet {
    /// `measured.x|y|z`, by direction.
    Measured(usize),
    /// `measured` of a rotary axis.
    Angle(usize),
    /// `deviation`.
    Deviation,
    /// `actual` of an axis, where nothing outside the drive measures.
    Actual(usize),
}

/// What stands at an outlet.
pub fn reading(recording: &Recording, outlet: Outlet) -> Vec<f64> {
    match outlet {
        Outlet::Measured(direction) => recording.measured[direction].clone(),
        Outlet::Angle(axis) => recording.axes[axis].measured.clone(),
        Outlet::Deviation => recording.deviation.clone(),
        Outlet::Actual(axis) => recording.axes[axis].actual.clone(),
    }
    .unwrap_or_default()
}

/// The column at an outlet, to be changed.
pub fn column_of(recording: &mut Recording, outlet: Outlet) -> Option<&mut Vec<f64>> {
    match outlet {
        Outlet::Measured(direction) => recording.measured[direction].as_mut(),
        Outlet::Angle(axis) => recording.axes[axis].measured.as_mut(),
        Outlet::Deviation => recording.deviation.as_mut(),
        Outlet::Actual(axis) => recording.axes[axis].actual.as_mut(),
    }
}

/// The instrument of a recording without faults, and where its readings stand. Where there is none, the drives are read as
/// if an instrument stood in their place.
pub fn instrument(recording: &Recording, names: &MachineNames) -> Result<(Instrument, Vec<Outlet>), String> {
    let instrument = match &recording.instrument {
        Recorder::Position => return positions(recording, names),
        Recorder::Ballbar { center, radius } => Instrument::ballbar(*center, *radius),
        Recorder::Linear(line) => Instrument::linear(line.axis, line.direction),
        Recorder::Straightness(line) => Instrument::straightness(line.axis, line.direction),
        Recorder::Angular { axis, about } => Instrument::Angular { axis: *axis, about: *about },
        Recorder::Probe => return Err("readings of a probe cannot be reproduced".to_owned()),
    };
    Ok((instrument, vec![Outlet::Deviation]))
}

fn positions(recording: &Recording, names: &MachineNames) -> Result<(Instrument, Vec<Outlet>), String> {
    let angle = |axis: &usize| recording.axes[*axis].measured.is_some();
    let directions = recording.measured.each_ref().map(Option::is_some);
    let angles: Vec<usize> = (0..recording.axes.len()).filter(angle).collect();
    let outside = (0..3).filter(|direction| directions[*direction]).map(Outlet::Measured);
    let outlets: Vec<Outlet> = outside.chain(angles.iter().copied().map(Outlet::Angle)).collect();
    if outlets.is_empty() {
        return drives(recording, names);
    }
    Ok((Instrument::Position { directions, angles }, outlets))
}

fn drives(recording: &Recording, names: &MachineNames) -> Result<(Instrument, Vec<Outlet>), String> {
    let read: Vec<usize> =
        (0..recording.axes.len()).filter(|axis| recording.axes[*axis].actual.is_some()).collect();
    if read.is_empty() {
        return Err("nothing was measured".to_owned());
    }
    let (turning, sliding): (Vec<usize>, Vec<usize>) =
        read.into_iter().partition(|axis| names.axes[*axis].rotary);
    let direction = |axis: &usize| "XYZ".find(names.axes[*axis].letter.as_str());
    let mut slides: Vec<(usize, usize)> =
        sliding.iter().filter_map(|axis| Some((direction(axis)?, *axis))).collect();
    slides.sort_unstable();
    let mut directions = [false; 3];
    slides.iter().for_each(|(direction, _)| directions[*direction] = true);
    let outlets = slides.iter().map(|(_, axis)| *axis).chain(turning.iter().copied()).map(Outlet::Actual);
    Ok((Instrument::Position { directions, angles: turning.clone() }, outlets.collect()))
}

/// Where the axes were sent, and what surrounded them.
pub fn commands(recording: &Recording) -> Commands {
    let column = |named: &Named| Column {
        name: named.name.clone(),
        unit: named.unit.clone(),
        values: filled(&named.values),
    };
    let position =
        |axis: &AxisChannels| axis.position().map_or_else(|| vec![0.0; recording.time.len()], filled);
    Commands {
        time: recording.time.clone(),
        run: recording.run.clone(),
        positions: recording.axes.iter().map(position).collect(),
        temperatures: recording.temperatures.iter().map(column).collect(),
        loads: recording.loads.iter().map(column).collect(),
        ..Commands::default()
    }
}

/// What effects follow: the commands; the drive's feedback where it is far behind them.
pub fn path(recording: &Recording, names: &MachineNames) -> Path {
    let clock = Clock::new(recording.time.clone(), &recording.run);
    let axes = recording.axes.iter().enumerate().map(|(number, axis)| {
        let command = filled(axis.command.as_ref()?);
        let direction = "XYZ".find(names.axes[number].letter.as_str());
        let outside = direction.and_then(|direction| recording.measured[direction].as_ref());
        let came = axis.actual.as_ref().or(axis.measured.as_ref()).or(outside);
        let state = Axis::new(&clock, command.clone(), ROUNDING);
        let strayed = came.map_or(0.0, |came| rms(&straightened(&difference(came, &command), &command)));
        if strayed > END_POINT * state.travel() && state.travel() > 0.0 {
            return None;
        }
        match &axis.actual {
            Some(actual) if strayed > BEHIND * state.travel() => {
                Some(Axis::new(&clock, filled(actual), JITTER))
            }
            _ => Some(state),
        }
    });
    let values = |named: &Vec<Named>| named.iter().map(|named| filled(&named.values)).collect();
    Path {
        axes: axes.collect(),
        temperatures: values(&recording.temperatures),
        loads: values(&recording.loads),
        clock,
    }
}
