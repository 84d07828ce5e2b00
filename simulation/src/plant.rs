//! The plant: a machine with all its errors, in numbers.
//!
//! In: a validated machine, the numbers of a calibration, and what the machine is told: positions, temperatures, loads
//! over time. Out, at every sample: where the tool tip really stands in the part's frame and how it is turned there.
//! Rotations are finite, nothing is linearised, and nothing of the compiler's equations is used, so that what is derived
//! from those can be held against this.

mod body;
mod curve;
pub(crate) mod error;
mod factor;
mod history;
mod names;
mod piece;
mod servo;
mod state;

pub use error::PlantError;
pub use history::History;
pub use names::names_of;
pub use servo::Servo;
pub use state::State;

use std::fmt;
use std::sync::Arc;

use model_dsl::calibration::{
    AxisName, Calibration, Factor, MachineNames, SensorKind, SensorReadings, Sensors,
};
use model_dsl::machine::{Branch, Machine};
use nalgebra::{Rotation3, Vector3};

use crate::commands::Commands;
use crate::legs::stretches;
use body::Body;
use factor::FactorMemory;
use names::own_axis;
use piece::{Memory, Piece, number_of};
use servo::Before;

/// How far an axis must move back before that is a real motion, mm or rad: far below what any drive resolves.
pub const DEADBAND: f64 = 1e-9;

/// Where the tool stands relative to the part, and how it is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The tool tip in the part's frame, mm.
    pub tip: Vector3<f64>,
    /// The rotation of the tool relative to the part, in the part's frame.
    pub turn: Rotation3<f64>,
}

/// A physical effect that no term describes: the value that it adds to an error motion, mm or rad.
pub type Effect = Arc<dyn Fn(&State<'_>) -> f64 + Send + Sync>;

/// A machine with numbers, ready to run.
#[derive(Clone)]
pub struct Plant {
    names: MachineNames,
    rotary: Vec<bool>,
    workpiece: Vec<Body>,
    tool: Vec<Body>,
    terms: Vec<PlantTerm>,
    effects: Vec<(usize, Effect)>,
    sensors: Sensors,
    loads: Vec<String>,
    servos: Vec<Option<Servo>>,
    deadband: f64,
}

/// One term of one error motion.
#[derive(Clone, Debug)]
struct PlantTerm {
    motion: usize,
    /// Its place among the terms of the motion in the calibration.
    place: usize,
    name: &'static str,
    piece: Piece,
    factors: Vec<Factor<usize>>,
    /// The axis whose drive sees it.
    drive: Option<usize>,
    /// The axis whose position loop answers it.
    inside: Option<usize>,
}

/// What a term remembers from sample to sample.
struct TermMemory {
    own: Memory,
    factors: Vec<FactorMemory>,
    /// What its axis's position loop makes of it.
    before: Before,
}

impl TermMemory {
    /// That of a term before the first sample.
    fn of(term: &PlantTerm) -> Self {
        let factors = vec![FactorMemory::default(); term.factors.len()];
        Self { own: Memory::default(), factors, before: Before::default() }
    }
}

/// What the plant does at one sample.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'m> {
    /// The state that the terms read.
    pub state: State<'m>,
    /// The error motions, numbered as the names of the machine: mm or rad.
    pub motions: &'m [f64],
    /// The position of each axis as its drive sees it: behind the position loop, with the terms on the drive's side.
    pub drive: &'m [f64],
    /// Where the tool really stands.
    pub pose: Pose,
}

impl Plant {
    /// Puts a machine and its numbers together. `names` are those that the calibration was read against: from the
    /// machine's equations, or from [`names_of`].
    ///
    /// # Errors
    ///
    /// [`PlantError::OtherMachine`] where names or calibration do not belong to the machine, [`PlantError::Table`].
    pub fn new(
        machine: &Machine,
        names: &MachineNames,
        calibration: &Calibration,
    ) -> Result<Self, PlantError> {
        let constants = &calibration.constants;
        let branch = |branch| body::branch(machine, branch, names, constants);
        let mut plant = Self {
            names: names.clone(),
            rotary: names.axes.iter().map(|axis| axis.rotary).collect(),
            workpiece: branch(Branch::Workpiece)?,
            tool: branch(Branch::Tool)?,
            terms: Vec::new(),
            effects: Vec::new(),
            sensors: calibration.sensors.clone(),
            loads: Vec::new(),
            servos: vec![None; names.axes.len()],
            deadband: DEADBAND,
        };
        plant.take_terms(machine, calibration)?;
        Ok(plant)
    }

    /// A machine without errors; only its constants have values, in the order of the names, mm.
    ///
    /// # Errors
    ///
    /// [`PlantError::OtherMachine`] where names or constants do not belong to the machine.
    pub fn perfect(machine: &Machine, names: &MachineNames, constants: &[f64]) -> Result<Self, PlantError> {
        let calibration = Calibration::new(machine.name.clone(), constants.to_vec());
        Self::new(machine, names, &calibration)
    }

    fn take_terms(&mut self, machine: &Machine, calibration: &Calibration) -> Result<(), PlantError> {
        let mut slowness = vec![0.0; self.names.axes.len()];
        let mut inertia = slowness.clone();
        // The loop of a motor moves its axes no further than its error does.
        let is_motor: Vec<bool> = self.names.axes.iter().map(AxisName::is_motor).collect();
        let programmed = |axis: usize| is_motor.get(axis) == Some(&false);
        for listed in &calibration.motions {
            let motion = listed.motion;
            let Some(name) = self.names.motions.get(motion) else {
                return Err(PlantError::OtherMachine(format!("error motion number {motion}")));
            };
            let own = own_axis(machine, &self.names, &name.name);
            for (place, term) in listed.terms.iter().enumerate() {
                let term = term.value.in_steady_state();
                let mut piece = Piece::of(&term, &mut self.loads)?;
                let factors = term.factors().iter().cloned();
                let factors = factors
                    .filter_map(|factor| factor.with_load(|load| Some(number_of(&load, &mut self.loads))))
                    .collect();
                if let Piece::Lag { axis, loop_of } = piece
                    && own == Some(axis)
                    && programmed(axis)
                    && let (Some(slowness), Some(inertia)) = (slowness.get_mut(axis), inertia.get_mut(axis))
                {
                    let (slow, inert) = loop_of.slowness_and_inertia();
                    *slowness += slow;
                    *inertia += inert;
                    piece = Piece::Loop;
                }
                let inside = own.filter(|_| listed.is_inside_loop(place));
                let name = listed.terms.get(place).map_or("", |term| term.value.name());
                self.terms.push(PlantTerm { motion, place, name, piece, factors, drive: inside, inside });
            }
        }
        for ((servo, slowness), inertia) in self.servos.iter_mut().zip(slowness).zip(inertia) {
            *servo = (slowness != 0.0).then(|| Servo::of(slowness, inertia));
        }
        Ok(())
    }

    /// The names that error motions, axes and constants go by.
    pub fn names(&self) -> &MachineNames {
        &self.names
    }

    /// The loads that the terms read, by number.
    pub fn loads(&self) -> &[String] {
        &self.loads
    }

    /// The sensors that the terms need a temperature of.
    pub fn temperatures(&self) -> impl Iterator<Item = &str> {
        self.sensors.inputs().map(|(_, sensor)| sensor.name.value.as_str())
    }

    /// The position loop of an axis, where it has one.
    pub fn servo(&self, axis: usize) -> Option<Servo> {
        self.servos.get(axis).copied().flatten()
    }

    /// Gives an axis another position loop than the one that its `lag` terms make.
    #[must_use]
    pub fn with_servo(mut self, axis: usize, servo: Option<Servo>) -> Self {
        if let Some(slot) = self.servos.get_mut(axis) {
            *slot = servo;
        }
        self
    }

    /// Sets how far an axis must move back before its direction turns, mm or rad; [`DEADBAND`] by default.
    #[must_use]
    pub fn with_deadband(mut self, deadband: f64) -> Self {
        self.deadband = deadband;
        self
    }

    /// Adds an effect that no term describes to an error motion, by the number of its name.
    #[must_use]
    pub fn with_effect(mut self, motion: usize, effect: Effect) -> Self {
        self.effects.push((motion, effect));
        self
    }

    /// Puts a term on the drive's side, so that the drive's own feedback shows it: by the name of the motion, which must
    /// be the axis's own (EXX of X), and the name of the term, which may stand there several times.
    ///
    /// # Errors
    ///
    /// [`PlantError::NoDriveTerm`] where the calibration has no such term, or the motion is not an axis's own.
    pub fn see_at_drive(&mut self, machine: &Machine, motion: &str, term: &str) -> Result<(), PlantError> {
        let missing = || PlantError::NoDriveTerm(format!("`{term}` of {motion}"));
        let number = self.names.motion(motion).ok_or_else(missing)?;
        let name = self.names.motions.get(number).map_or("", |motion| motion.name.as_str());
        let axis = own_axis(machine, &self.names, name).ok_or_else(missing)?;
        let mut found = false;
        for own in self.terms.iter_mut().filter(|own| own.motion == number && own.name == term) {
            own.drive = Some(axis);
            found = true;
        }
        if found { Ok(()) } else { Err(missing()) }
    }

    /// Puts one term on the drive's side, by the number of its motion and its place among the motion's terms.
    ///
    /// # Errors
    ///
    /// [`PlantError::NoDriveTerm`] where there is no such term, or the motion is not an axis's own.
    pub fn see_term_at_drive(
        &mut self,
        machine: &Machine,
        motion: usize,
        place: usize,
    ) -> Result<(), PlantError> {
        let missing = || PlantError::NoDriveTerm(format!("term {place} of error motion {motion}"));
        let name = self.names.motions.get(motion).map_or("", |motion| motion.name.as_str());
        let axis = own_axis(machine, &self.names, name).ok_or_else(missing)?;
        let mut own = self.terms.iter_mut();
        let term = own.find(|own| own.motion == motion && own.place == place).ok_or_else(missing)?;
        term.drive = Some(axis);
        Ok(())
    }

    /// Where the tool stands at positions of the axes (mm, rad) with error motions numbered as the names (mm, rad); what
    /// is missing at the end of either list is zero.
    pub fn pose(&self, positions: &[f64], motions: &[f64]) -> Pose {
        let part = body::end(&self.workpiece, positions, motions);
        let tool = body::end(&self.tool, positions, motions);
        let back = part.rotation.inverse();
        Pose { tip: back * (tool.origin - part.origin), turn: back * tool.rotation }
    }

    /// Where the tool stands without errors.
    pub fn nominal(&self, positions: &[f64]) -> Pose {
        self.pose(positions, &[])
    }

    /// The direction, in the part's frame, about which the tool turns relative to the part when a rotary axis is
    /// programmed to move forward; nothing for a slide. The errors are left out.
    pub fn turning_direction(&self, axis: usize, positions: &[f64]) -> Option<Vector3<f64>> {
        if !*self.rotary.get(axis)? {
            return None;
        }
        let back = body::end(&self.workpiece, positions, &[]).rotation.inverse();
        let carried = body::direction_of(&self.tool, axis, positions).map(|direction| back * direction);
        // Where the axis turns the part, the tool turns the other way.
        carried.or_else(|| {
            body::direction_of(&self.workpiece, axis, positions).map(|direction| -(back * direction))
        })
    }

    /// Runs through the commands and tells what the machine does at every sample.
    ///
    /// # Errors
    ///
    /// [`PlantError::NoTemperature`] and [`PlantError::NoLoad`] where a term reads what the commands lack,
    /// [`PlantError::Length`] where columns differ in length.
    pub fn run(&self, commands: &Commands, mut each: impl FnMut(&Moment<'_>)) -> Result<(), PlantError> {
        commands.check(self.names.axes.len())?;
        let legs = commands.numbered_legs();
        let histories = self.histories(commands, &legs);
        let inputs = self.inputs(commands)?;
        let loads = self.load_columns(commands)?;
        let mut readings = SensorReadings::new(&self.sensors);
        let mut memories: Vec<TermMemory> = self.terms.iter().map(TermMemory::of).collect();
        let stretches = stretches(&legs);
        let mut leg = stretches.iter().copied().peekable();
        let mut positions = vec![0.0; self.names.axes.len()];
        let mut motions = vec![0.0; self.names.motions.len()];
        let mut drive = positions.clone();
        let mut row_loads = vec![0.0; loads.len()];
        for (row, &time) in commands.time.iter().enumerate() {
            let at = |column: &[f64]| column.get(row).copied().unwrap_or(f64::NAN);
            let temperatures =
                readings.update(|sensor| inputs.get(sensor).copied().flatten().map_or(f64::NAN, at));
            row_loads.iter_mut().zip(&loads).for_each(|(slot, column)| *slot = at(column));
            positions.iter_mut().zip(&histories).for_each(|(slot, history)| *slot = at(&history.position));
            while leg.next_if(|(_, end)| *end <= row).is_some() {}
            let leg = leg.peek().copied().unwrap_or_default();
            let begins = row > 0 && leg.0 == row;
            let state = State {
                row,
                time,
                begins,
                leg,
                times: &commands.time,
                histories: &histories,
                temperatures,
                loads: &row_loads,
            };
            drive.copy_from_slice(&positions);
            self.evaluate(&state, &mut memories, &mut motions, &mut drive);
            let pose = self.pose(&positions, &motions);
            each(&Moment { state, motions: &motions, drive: &drive, pose });
        }
        Ok(())
    }

    fn evaluate(
        &self,
        state: &State<'_>,
        memories: &mut [TermMemory],
        motions: &mut [f64],
        drive: &mut [f64],
    ) {
        motions.fill(0.0);
        for (term, TermMemory { own, factors, before }) in self.terms.iter().zip(memories) {
            let multiplied = term.factors.iter().zip(factors);
            let product: f64 =
                multiplied.map(|(factor, memory)| factor::value(factor, state, memory)).product();
            let value = product * term.piece.value(state, own);
            let value = match term.inside.and_then(|axis| self.servo(axis)) {
                Some(servo) => {
                    if state.begins {
                        *before = Before::default();
                    }
                    servo.answer(before, state.time, value)
                }
                None => value,
            };
            if let Some(motion) = motions.get_mut(term.motion) {
                *motion += value;
            }
            if let Some(position) = term.drive.and_then(|axis| drive.get_mut(axis)) {
                *position += value;
            }
        }
        for (motion, effect) in &self.effects {
            if let Some(motion) = motions.get_mut(*motion) {
                *motion += effect(state);
            }
        }
    }

    fn histories(&self, commands: &Commands, legs: &[i64]) -> Vec<History> {
        let stretches = stretches(legs);
        let followed = |servo: &Servo, command: &[f64]| -> Vec<f64> {
            let part = |from: &(usize, usize)| {
                let rows = from.0..from.1;
                commands.time.get(rows.clone()).zip(command.get(rows)).unwrap_or_default()
            };
            let parts = stretches.iter().map(part);
            parts.flat_map(|(time, command)| servo.follow(time, command)).collect()
        };
        let axes = commands.positions.iter().zip(&self.servos);
        let positions: Vec<Vec<f64>> = axes
            .map(|(command, servo)| match servo {
                Some(servo) => followed(servo, command),
                None => command.clone(),
            })
            .collect();
        let commanded = self.with_motors(commands.positions.clone());
        let columns = commanded.iter().zip(self.with_motors(positions));
        let history = |(command, position): (&Vec<f64>, Vec<f64>)| {
            History::of(&commands.time, legs, command, position, self.deadband)
        };
        columns.map(history).collect()
    }

    /// The positions of all axes in all rows, motors where their axes put them.
    pub(crate) fn with_motors(&self, mut columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        for (number, name) in self.names.axes.iter().enumerate().filter(|(_, name)| name.is_motor()) {
            let at = |axis: usize, row: usize| columns.get(axis).and_then(|column| column.get(row)).copied();
            let stands = |row| name.followed(|axis| at(axis, row).unwrap_or(f64::NAN)).unwrap_or(f64::NAN);
            let rows = columns.first().map_or(0, Vec::len);
            let column = (0..rows).map(stands).collect();
            if let Some(slot) = columns.get_mut(number) {
                *slot = column;
            }
        }
        columns
    }

    /// The column of each sensor that is an input and used, by its number.
    fn inputs<'c>(&self, commands: &'c Commands) -> Result<Vec<Option<&'c [f64]>>, PlantError> {
        let sensors = self.sensors.iter().map(|sensor| {
            if sensor.kind != SensorKind::Input {
                return Ok(None);
            }
            let name = &sensor.name.value;
            match commands.temperatures.iter().find(|column| column.name == *name) {
                Some(column) => Ok(Some(column.values.as_slice())),
                None if sensor.used => Err(PlantError::NoTemperature(name.clone())),
                None => Ok(None),
            }
        });
        sensors.collect()
    }

    fn load_columns<'c>(&self, commands: &'c Commands) -> Result<Vec<&'c [f64]>, PlantError> {
        let loads = self.loads.iter().map(|name| {
            let found = commands.loads.iter().find(|column| column.name == *name);
            found.map(|column| column.values.as_slice()).ok_or_else(|| PlantError::NoLoad(name.clone()))
        });
        loads.collect()
    }
}

impl fmt::Debug for Plant {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let effects: Vec<usize> = self.effects.iter().map(|(motion, _)| *motion).collect();
        formatter
            .debug_struct("Plant")
            .field("machine", &self.names.machine)
            .field("terms", &self.terms)
            .field("effects", &effects)
            .field("servos", &self.servos)
            .finish_non_exhaustive()
    }
}
