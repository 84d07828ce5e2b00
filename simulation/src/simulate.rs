//! A recording as the model predicts it.
//!
//! In: a plant, commands or a path that makes them, and an instrument with its faults. Out: the columns of a recording, with
//! noise and without. A recording of a real machine can be replayed the same way: [`replay`] takes its commands.

use std::fmt;

use nalgebra::{Rotation3, Vector3};

use crate::commands::{Column, Commands};
use crate::instrument::{Channel, Instrument, Seen};
use crate::noise::{Missing, Noise, Source};
use crate::path::{Path, PathError, Timeline};
use crate::plant::{Plant, PlantError, Pose};
use crate::surroundings::{Load, Temperature};

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
    /// As it would be without them; eccentricity, cosine, clock and offset are in it.
    pub clean: Vec<f64>,
}

/// A simulated recording: columns of one length in mm, rad, s, degC and the units of the loads.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    /// A line for people.
    pub title: Option<String>,
    /// The instrument, with everything that the path told of it.
    pub instrument: Instrument,
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
            Self::NoCircle => formatter.write_str("the path has no circle to take centre and radius from"),
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
    let looks = looks(&commands, measurement.clock).map(|times| {
        scenario.surrounded(Commands {
            run: times.iter().map(|time| timeline.run(*time)).collect(),
            positions: timeline.positions(&times),
            time: times,
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
    let looks = looks(commands, measurement.clock).map(|times| commands.at(&times));
    join(plant, commands, looks.as_ref(), measurement)
}

impl Scenario {
    /// The commands that a timeline of the scenario's path makes, with its surroundings.
    pub fn commands(&self, timeline: &Timeline) -> Commands {
        let instants = timeline.instants();
        let time: Vec<f64> = instants.iter().map(|instant| instant.time).collect();
        let whole = instants.iter().all(|instant| instant.recorded);
        let recorded = instants.iter().filter(|_| !whole).map(|instant| instant.recorded).collect();
        self.surrounded(Commands {
            run: instants.iter().map(|instant| instant.run).collect(),
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

/// The times at which the instrument looks, where they are not those of the rows.
fn looks(commands: &Commands, clock: f64) -> Option<Vec<f64>> {
    let rows = commands.time.iter().enumerate().filter(|(row, _)| commands.is_recorded(*row));
    (clock != 0.0).then(|| rows.map(|(_, time)| time - clock).collect())
}

/// What each instant of a merged run is for.
#[derive(Clone, Copy)]
struct Purpose {
    /// The row that it is, where it is written down.
    row: Option<usize>,
    /// The row whose reading is taken at it.
    look: Option<usize>,
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
    let positions: Vec<Vec<f64>> = commands.positions.iter().map(pick).collect();
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

fn purposes_of(commands: &Commands) -> Vec<Purpose> {
    let mut next = 0;
    let purpose = |row: usize| {
        let row = commands.is_recorded(row).then(|| {
            next += 1;
            next - 1
        });
        Purpose { row, look: row }
    };
    (0..commands.time.len()).map(purpose).collect()
}

/// Merges the instants of the rows and those at which the instrument looks.
fn merge(commands: &Commands, looks: &Commands) -> (Commands, Vec<Purpose>) {
    let mut order: Vec<(f64, bool, usize)> = Vec::new();
    order.extend(commands.time.iter().enumerate().map(|(row, time)| (*time, false, row)));
    order.extend(looks.time.iter().enumerate().map(|(row, time)| (*time, true, row)));
    order.sort_by(|left, right| left.0.total_cmp(&right.0));
    let rows = purposes_of(commands);
    let purpose = |&(_, look, row): &(f64, bool, usize)| {
        if look {
            Purpose { row: None, look: Some(row) }
        } else {
            Purpose { row: rows.get(row).and_then(|purpose| purpose.row), look: None }
        }
    };
    let purposes = order.iter().map(purpose).collect();
    let take = |own: &[f64], other: &[f64]| -> Vec<f64> {
        let value = |&(_, look, row): &(f64, bool, usize)| if look { other.get(row) } else { own.get(row) };
        order.iter().map(|entry| value(entry).copied().unwrap_or(f64::NAN)).collect()
    };
    let named = |own: &[Column], other: &[Column]| -> Vec<Column> {
        let pairs = own.iter().zip(other);
        pairs.map(|(own, other)| Column { values: take(&own.values, &other.values), ..own.clone() }).collect()
    };
    let run = |&(_, look, row): &(f64, bool, usize)| {
        let runs = if look { &looks.run } else { &commands.run };
        runs.get(row).copied().unwrap_or(1)
    };
    let positions = commands.positions.iter().zip(&looks.positions);
    let merged = Commands {
        time: order.iter().map(|(time, ..)| *time).collect(),
        run: order.iter().map(run).collect(),
        positions: positions.map(|(own, other)| take(own, other)).collect(),
        temperatures: named(&commands.temperatures, &looks.temperatures),
        loads: named(&commands.loads, &looks.loads),
        recorded: Vec::new(),
    };
    (merged, purposes)
}

/// Reads the recorded rows.
struct Reader<'r> {
    plant: &'r Plant,
    measurement: &'r Measurement,
    time: &'r [f64],
    run: &'r [i64],
    positions: &'r [Vec<f64>],
}

impl Reader<'_> {
    fn readings(&self, poses: &[Pose]) -> Vec<Reading> {
        let instrument = &self.measurement.instrument;
        let clean = self.read(poses);
        let mut values = match self.displaced(poses) {
            Some(displaced) => self.read(&displaced),
            None => clean.clone(),
        };
        let channels = instrument.channels();
        let lost = self.measurement.missing.lost(self.time, &mut self.source("missing"));
        for (channel, values) in channels.iter().zip(&mut values) {
            let mut source = self.source(&self.name(*channel));
            self.measurement.noise.apply(self.time, values, &mut source);
            values.iter_mut().zip(&lost).filter(|(_, lost)| **lost).for_each(|(value, _)| *value = f64::NAN);
        }
        let columns = channels.into_iter().zip(values).zip(clean);
        columns.map(|((channel, values), clean)| Reading { channel, values, clean }).collect()
    }

    /// One column for each channel.
    fn read(&self, poses: &[Pose]) -> Vec<Vec<f64>> {
        let instrument = &self.measurement.instrument;
        let channels = instrument.channels();
        let mut columns = vec![Vec::with_capacity(poses.len()); channels.len()];
        let mut start = None;
        for (row, pose) in poses.iter().enumerate() {
            let positions = self.command(row);
            let nominal = self.plant.nominal(&positions);
            let start = *start.get_or_insert(nominal.tip);
            let seen = Seen { pose: *pose, nominal, positions: &positions, start };
            for (channel, column) in channels.iter().zip(&mut columns) {
                column.push(instrument.read(*channel, self.plant, &seen) + self.measurement.offset);
            }
        }
        columns
    }

    fn command(&self, row: usize) -> Vec<f64> {
        self.positions.iter().map(|column| column.get(row).copied().unwrap_or(f64::NAN)).collect()
    }

    /// The poses with the part displaced in its fixture, another way in every run.
    fn displaced(&self, poses: &[Pose]) -> Option<Vec<Pose>> {
        let sigma = self.measurement.fixture;
        if sigma <= 0.0 {
            return None;
        }
        let displacement = |run: &i64| {
            let mut source = self.source(&format!("fixture.{run}"));
            Vector3::from_fn(|_, _| sigma * source.normal())
        };
        let mut known: Vec<(i64, Vector3<f64>)> = Vec::new();
        let displaced = poses.iter().zip(self.run).map(|(pose, run)| {
            let by = match known.iter().find(|(other, _)| other == run) {
                Some((_, by)) => *by,
                None => {
                    let by = displacement(run);
                    known.push((*run, by));
                    by
                }
            };
            Pose { tip: pose.tip + by, ..*pose }
        });
        Some(displaced.collect())
    }

    fn normals(&self) -> Option<[Vec<f64>; 3]> {
        let Instrument::Probe { normal } = &self.measurement.instrument else { return None };
        let mut columns = [Vec::new(), Vec::new(), Vec::new()];
        for row in 0..self.time.len() {
            let direction = normal.at(self.plant.nominal(&self.command(row)).tip);
            columns.iter_mut().zip(direction.iter()).for_each(|(column, entry)| column.push(*entry));
        }
        Some(columns)
    }

    fn drive(&self, axis: usize, mut column: Vec<f64>) -> Option<Vec<f64>> {
        if !self.measurement.drives.contains(&axis) {
            return None;
        }
        let letter = self.plant.names().axes.get(axis).map(|axis| axis.letter.to_ascii_lowercase())?;
        let mut source = self.source(&format!("actual.{letter}"));
        self.measurement.drive_noise.apply(self.time, &mut column, &mut source);
        Some(column)
    }

    fn sensor(&self, mut column: Column, kind: &str) -> Column {
        let mut noises = self.measurement.sensor_noise.iter();
        if let Some((_, noise)) = noises.find(|(name, _)| *name == column.name) {
            let mut source = self.source(&format!("{kind}.{}", column.name));
            noise.apply(self.time, &mut column.values, &mut source);
        }
        column
    }

    fn source(&self, name: &str) -> Source {
        Source::new(self.measurement.seed, name)
    }

    fn name(&self, channel: Channel) -> String {
        channel_name(channel, &self.plant.names().axes)
    }
}

/// The name of a channel in recordings.
pub(crate) fn channel_name(channel: Channel, axes: &[model_dsl::calibration::AxisName]) -> String {
    match channel {
        Channel::Measured(direction) => {
            format!("measured.{}", ["x", "y", "z"].get(direction).unwrap_or(&"?"))
        }
        Channel::Angle(axis) => {
            let letter = axes.get(axis).map_or("?", |axis| axis.letter.as_str());
            format!("measured.{}", letter.to_ascii_lowercase())
        }
        Channel::Deviation => "deviation".to_owned(),
    }
}
