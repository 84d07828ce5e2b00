//! A recording as the model predicts it.
//!
//! In: a plant, commands or a path that makes them, and an instrument with its faults. Out: the columns of a recording, with
//! noise and without. A recording of a real machine can be replayed the same way: [`replay`] takes its commands.

mod instants;
mod reader;

use std::fmt;

use nalgebra::{Rotation3, Vector3};

use crate::commands::{Column, Commands};
use crate::datum::Datum;
use crate::instrument::{Channel, Instrument};
use crate::legs::stretches;
use crate::noise::{Missing, Noise};
use crate::path::{Path, PathError, Timeline};
use crate::plant::{Plant, PlantError, Pose};
use crate::surroundings::{Load, Temperature};
use instants::{merge, purposes_of};
use reader::Reader;
pub(crate) use reader::channel_name;

/// A recording that is to be made.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// A line for people.
    pub title: Option<String>,
    /// Where the axes go.
    pub path: Path,
    /// The temperatures while they do.
    pub temperatures: Vec<Temperature>,
    /// The loads.
    pub loads: Vec<Load>,
    /// What reads it.
    pub measurement: Measurement,
    /// The runs that the recording holds out.
    pub holdout: Vec<i64>,
}

/// What reads the machine, and with which faults.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The instrument.
    pub instrument: Instrument,
    /// The instrument shows at t the state at t minus this, s. What a row commands is not late.
    pub clock: f64,
    /// How the part lies where it is measured, where it was clamped anew there.
    pub datum: Option<Datum>,
    /// Added to every reading: an arbitrary zero, mm or rad.
    pub offset: f64,
    /// The noise of each channel, mm or rad.
    pub noise: Noise,
    /// Readings that are not there, in all channels of the instrument at once.
    pub missing: Missing,
    /// Standard deviation of the displacement of the part in its fixture from run to run, in each direction, mm.
    pub fixture: f64,
    /// The axes whose drives are recorded.
    pub drives: Vec<usize>,
    /// The noise of the drives' feedback, mm or rad.
    pub drive_noise: Noise,
    /// The noise of temperature sensors and loads, by name.
    pub sensor_noise: Vec<(String, Noise)>,
    /// The seed of all noise.
    pub seed: u64,
}

impl Measurement {
    /// An instrument without faults.
    pub fn perfect(instrument: Instrument) -> Self {
        Self {
            instrument,
            clock: 0.0,
            datum: None,
            offset: 0.0,
            noise: Noise::default(),
            missing: Missing::default(),
            fixture: 0.0,
            drives: Vec::new(),
            drive_noise: Noise::default(),
            sensor_noise: Vec::new(),
            seed: 0,
        }
    }
}

/// One channel of readings over the recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Which channel.
    pub channel: Channel,
    /// As the instrument shows it, with noise, disturbances and gaps (NaN): mm or rad.
    pub values: Vec<f64>,
    /// As it would be without them; eccentricity, cosine, clock, datum and offset are in it.
    pub clean: Vec<f64>,
}

/// A simulated recording: columns of one length in mm, rad, s, degC and the units of the loads.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    /// A line for people.
    pub title: Option<String>,
    /// The instrument, with everything that the path told of it.
    pub instrument: Instrument,
    /// Whether the part was clamped anew where it was measured.
    pub free_datum: bool,
    /// Time since the recording began.
    pub time: Vec<f64>,
    /// The repeat that each row belongs to, from 1.
    pub run: Vec<i64>,
    /// The command of each axis.
    pub commands: Vec<Vec<f64>>,
    /// What the drive of each axis shows, where it is recorded.
    pub actual: Vec<Option<Vec<f64>>>,
    /// The readings of the instrument.
    pub readings: Vec<Reading>,
    /// The normals of a probe.
    pub normals: Option<[Vec<f64>; 3]>,
    /// Temperatures as their sensors show them.
    pub temperatures: Vec<Column>,
    /// Loads as they are read.
    pub loads: Vec<Column>,
    /// The runs that the recording holds out.
    pub holdout: Vec<i64>,
}

/// Why nothing could be simulated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SimulationError {
    /// The path cannot be driven.
    Path(PathError),
    /// The plant cannot run.
    Plant(PlantError),
    /// The ballbar or the probe needs a centre or a radius, and the path is no circle.
    NoCircle,
    /// The instrument reads the angle of an axis that does not turn.
    NotRotary(usize),
}

impl fmt::Display for SimulationError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Path(error) => error.fmt(formatter),
            Self::Plant(error) => error.fmt(formatter),
            Self::NoCircle => formatter.write_str("the path has no circle that gives centre and radius"),
            Self::NotRotary(axis) => write!(formatter, "axis number {axis} has no angle to measure"),
        }
    }
}

impl std::error::Error for SimulationError {}

impl From<PathError> for SimulationError {
    fn from(error: PathError) -> Self {
        Self::Path(error)
    }
}

impl From<PlantError> for SimulationError {
    fn from(error: PlantError) -> Self {
        Self::Plant(error)
    }
}

/// Drives the path and reads it.
///
/// # Errors
///
/// Every kind of [`SimulationError`].
pub fn simulate(plant: &Plant, scenario: &Scenario) -> Result<Simulated, SimulationError> {
    let rotary: Vec<bool> = plant.names().axes.iter().map(|axis| axis.rotary).collect();
    let timeline = scenario.path.timeline(&rotary)?;
    let commands = scenario.commands(&timeline);
    let measurement = &scenario.measurement;
    let mut wanted = measurement.clone();
    wanted.instrument = measurement.instrument.resolved(circle(plant, &scenario.path));
    let noises = scenario.temperatures.iter().map(|sensor| (&sensor.name, sensor.noise));
    let noises = noises.chain(scenario.loads.iter().map(|load| (&load.name, load.noise)));
    wanted.sensor_noise.extend(noises.map(|(name, noise)| (name.clone(), noise)));
    let looks = looks(&commands, measurement.clock).map(|Looks { time, legs }| {
        scenario.surrounded(Commands {
            run: time.iter().map(|time| timeline.run(*time)).collect(),
            positions: timeline.positions(&time),
            time,
            legs,
            ..Commands::default()
        })
    });
    let mut simulated = join(plant, &commands, looks.as_ref(), &wanted)?;
    simulated.title.clone_from(&scenario.title);
    simulated.holdout.clone_from(&scenario.holdout);
    Ok(simulated)
}

/// Lets a machine follow commands and reads it; between the samples the commands are taken as linear.
///
/// # Errors
///
/// [`SimulationError::Plant`], [`SimulationError::NoCircle`] and [`SimulationError::NotRotary`].
pub fn replay(
    plant: &Plant,
    commands: &Commands,
    measurement: &Measurement,
) -> Result<Simulated, SimulationError> {
    commands.check(plant.names().axes.len())?;
    let looks = looks(commands, measurement.clock);
    let looks = looks.map(|Looks { time, legs }| Commands { legs, ..commands.at(&time) });
    join(plant, commands, looks.as_ref(), measurement)
}

impl Scenario {
    /// The commands that a timeline of the scenario's path makes, with its surroundings.
    pub fn commands(&self, timeline: &Timeline) -> Commands {
        let instants = timeline.instants();
        let time: Vec<f64> = instants.iter().map(|instant| instant.time).collect();
        let whole = instants.iter().all(|instant| instant.recorded);
        let recorded = instants.iter().filter(|_| !whole).map(|instant| instant.recorded).collect();
        let run: Vec<i64> = instants.iter().map(|instant| instant.run).collect();
        self.surrounded(Commands {
            legs: run.clone(),
            run,
            positions: timeline.positions(&time),
            time,
            recorded,
            ..Commands::default()
        })
    }

    fn surrounded(&self, commands: Commands) -> Commands {
        Commands {
            temperatures: self.temperatures.iter().map(|sensor| sensor.column(&commands.time)).collect(),
            loads: self.loads.iter().map(|load| load.column(&commands.time)).collect(),
            ..commands
        }
    }
}

/// The nominal tip at the centre of the path's circle, its radius, and the directions in which it lies.
fn circle(plant: &Plant, path: &Path) -> Option<([f64; 3], f64, [bool; 3])> {
    let (plane, center, radius) = path.circle(plant.names().axes.len())?;
    let middle = plant.nominal(&center).tip;
    let mut inside = [false; 3];
    for axis in plane {
        let mut moved = center.clone();
        *moved.get_mut(axis)? += 1.0;
        let way = plant.nominal(&moved).tip - middle;
        inside.iter_mut().zip(way.iter()).for_each(|(inside, way)| *inside |= way.abs() > 1e-6);
    }
    Some((middle.into(), radius, inside))
}

/// The instants at which the instrument looks, one for each recorded row.
struct Looks {
    time: Vec<f64>,
    legs: Vec<i64>,
}

/// When the instrument looks, where that is not at the rows. Before the first sample of a leg and behind its last the axes rest.
fn looks(commands: &Commands, clock: f64) -> Option<Looks> {
    if clock == 0.0 {
        return None;
    }
    let legs = commands.numbered_legs();
    let mut looks = Looks { time: Vec::new(), legs: Vec::new() };
    for (first, end) in stretches(&legs) {
        let time = commands.time.get(first..end).unwrap_or_default();
        let (Some(start), Some(last)) = (time.first(), time.last()) else { continue };
        for row in (first..end).filter(|row| commands.is_recorded(*row)) {
            let at = commands.time.get(row).copied().unwrap_or(f64::NAN);
            looks.time.push((at - clock).clamp(*start, *last));
            looks.legs.extend(legs.get(row));
        }
    }
    Some(looks)
}

/// Runs the plant through rows and looks in order of time, and reads it.
fn join(
    plant: &Plant,
    commands: &Commands,
    looks: Option<&Commands>,
    measurement: &Measurement,
) -> Result<Simulated, SimulationError> {
    check(plant, &measurement.instrument)?;
    let recorded: Vec<usize> = (0..commands.time.len()).filter(|row| commands.is_recorded(*row)).collect();
    let (merged, purposes) = match looks {
        None => (None, purposes_of(commands)),
        Some(looks) => {
            let (merged, purposes) = merge(commands, looks);
            (Some(merged), purposes)
        }
    };
    let axes = plant.names().axes.len();
    let mut drives: Vec<Vec<f64>> = vec![Vec::new(); axes];
    let missing = Pose { tip: Vector3::from_element(f64::NAN), turn: Rotation3::identity() };
    let mut poses: Vec<Pose> = vec![missing; recorded.len()];
    plant.run(merged.as_ref().unwrap_or(commands), |moment| {
        let Some(purpose) = purposes.get(moment.state.row) else { return };
        if let Some(pose) = purpose.look.and_then(|row| poses.get_mut(row)) {
            *pose = moment.pose;
        }
        if purpose.row.is_some() {
            for axis in &measurement.drives {
                if let (Some(column), Some(position)) = (drives.get_mut(*axis), moment.drive.get(*axis)) {
                    column.push(*position);
                }
            }
        }
    })?;
    let pick = |column: &Vec<f64>| -> Vec<f64> {
        recorded.iter().filter_map(|row| column.get(*row)).copied().collect()
    };
    let time = pick(&commands.time);
    let run: Vec<i64> = recorded.iter().filter_map(|row| commands.run.get(*row)).copied().collect();
    let programmed = commands.positions.iter().map(pick).collect();
    let positions = plant.with_motors(programmed);
    let reader = Reader { plant, measurement, time: &time, run: &run, positions: &positions };
    let actual = drives.into_iter().enumerate().map(|(axis, column)| reader.drive(axis, column));
    let actual = actual.collect();
    let readings = reader.readings(&poses);
    let normals = reader.normals();
    let columns = |columns: &[Column], kind: &str| {
        let picked = columns.iter().map(|column| Column { values: pick(&column.values), ..column.clone() });
        picked.map(|column| reader.sensor(column, kind)).collect()
    };
    Ok(Simulated {
        title: None,
        instrument: measurement.instrument.clone(),
        free_datum: measurement.datum.is_some(),
        actual,
        readings,
        normals,
        temperatures: columns(&commands.temperatures, "temperature"),
        loads: columns(&commands.loads, "load"),
        holdout: Vec::new(),
        time,
        run,
        commands: positions,
    })
}

fn check(plant: &Plant, instrument: &Instrument) -> Result<(), SimulationError> {
    let rotary = |axis: &usize| plant.names().axes.get(*axis).is_some_and(|axis| axis.rotary);
    let unturned = match instrument {
        Instrument::Position { angles, .. } => angles.iter().find(|axis| !rotary(axis)),
        _ => None,
    };
    match unturned {
        Some(axis) => Err(SimulationError::NotRotary(*axis)),
        None if instrument.needs_circle() => Err(SimulationError::NoCircle),
        None => Ok(()),
    }
}
