//! The servo cycle of one machine, with everything that it borrows in one place.
//!
//! In: a machine, its calibration and, every cycle, what the controller knows of axes and sensors ([`Inputs`]). Out: the
//! correction of each axis and a [`Status`]. It exists because the runtime owns nothing: here its terms, their memories and
//! what lies between two cycles (directions, velocities, derived sensors) live as long as the handle that C holds.

mod running;
mod tracks;

use std::fmt;

use abbe_runtime::{DirectionOutcome, SetupError};
use model_dsl::calibration::{Calibration, NotCompensable};

use self::running::Running;
use self::tracks::Tracks;
use crate::machine::ChangingMachine;
use crate::status::{Cycle, Status};

/// What a controller knows in one servo cycle, borrowed from it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Inputs<'a> {
    /// Position commanded for each axis, mm or rad, machine coordinates.
    pub position: &'a [f64],
    /// For each axis the direction of its last real motion: +1, -1, or 0: found from its corrected commands. Empty: all are found.
    pub direction: &'a [f64],
    /// Temperature of each sensor in degC; NaN: silent.
    pub temperature: &'a [f64],
    /// Time since the cycle before this one, s.
    pub time_step: f64,
}

/// No reversal asks for more, in mm, where the calibration has no limit.
const LARGEST: f64 = 0.1;

/// The same of a rotary axis, in rad: 200 arcsec, several times the play of a worm. It only bounds for how long directions
/// are not looked for, where a calibration has a rate and no limit.
const LARGEST_ROTATION: f64 = 1e-3;

/// Why there is no controller for a calibration.
#[derive(Debug)]
pub enum SetupFailure {
    /// A term that no controller can compensate.
    Term(NotCompensable),
    /// The runtime refuses the calibration.
    Setup(SetupError),
}

impl fmt::Display for SetupFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Term(term) => write!(f, "{term}"),
            Self::Setup(error) => write!(f, "the calibration cannot be run: {error}"),
        }
    }
}

impl std::error::Error for SetupFailure {}

/// The compensation of one machine, from cycle to cycle.
pub struct Controller {
    axes: usize,
    sensors: usize,
    tracks: Tracks,
    running: Running,
}

impl Controller {
    /// A controller, switched off. `rotary` tells of each axis whether its positions are angles.
    ///
    /// # Errors
    /// Refuses a calibration that the runtime cannot run.
    pub fn new(
        machine: Box<dyn ChangingMachine>,
        rotary: impl Iterator<Item = bool>,
        calibration: Calibration,
    ) -> Result<Self, SetupFailure> {
        let (axes, sensors) = (machine.axes(), calibration.sensors.inputs().count());
        let tracks = Tracks::new(rotary, transition(&calibration));
        Ok(Self { axes, sensors, tracks, running: Running::start(machine, calibration)? })
    }

    /// How far an axis must move back before its direction counts as turned, in mm or rad; until this is called 0.001 mm or
    /// 0.001 deg. Its direction begins anew.
    pub fn set_hysteresis(&mut self, axis: usize, threshold: f64) -> Status {
        self.tracks.set_hysteresis(axis, threshold)
    }

    /// Forgets what terms, sensors and axes remember, as if the machine had just started. The correction made stays, and goes
    /// from there to what is wanted next.
    pub fn restart(&mut self) {
        self.tracks.restart();
        self.running.restart();
    }

    /// Takes a tool of the calibration, by its name; without one, the constants of the calibration itself. The correction fades to
    /// that of the new lever arms.
    pub fn set_tool(&mut self, name: Option<&str>) -> Status {
        if self.running.set_tool(name) { Status::Done } else { Status::OutOfRange }
    }

    /// Takes these constants of the machine, in mm, in place of those of the calibration and its tools. The correction fades to that of
    /// the new lever arms.
    pub fn set_constants(&mut self, constants: &[f64]) -> Status {
        if !constants.iter().all(|constant| constant.is_finite()) {
            return Status::OutOfRange;
        }
        if self.running.set_constants(constants) { Status::Done } else { Status::WrongLength }
    }

    /// What is to be added to the position of each axis, mm or rad, as the last cycle found it; 0 before the first.
    #[must_use]
    pub fn correction(&self) -> &[f64] {
        self.running.correction()
    }

    /// What the last cycle found of the direction of the tool, NaN where there was none or its sample was refused; none on a machine whose
    /// rotary axes do not correct that direction.
    #[must_use]
    pub fn direction(&mut self) -> Option<DirectionOutcome> {
        self.running.direction()
    }

    /// One servo cycle, which finds the correction. `enabled` switches the compensation.
    ///
    /// # Errors
    /// A negative status where lengths or directions are wrong: then nothing goes on.
    pub fn update(&mut self, inputs: &Inputs<'_>, enabled: bool) -> Result<(Status, Cycle), Status> {
        let axes = self.axes;
        let directed = inputs.direction.is_empty() || inputs.direction.len() == axes;
        let fits = inputs.position.len() == axes && directed;
        if !fits || inputs.temperature.len() != self.sensors {
            return Err(Status::WrongLength);
        }
        if !inputs.direction.iter().all(|direction| [1.0, -1.0, 0.0].contains(direction)) {
            return Err(Status::OutOfRange);
        }
        self.tracks.follow(inputs, self.running.correction());
        Ok(self.running.cycle(inputs, &self.tracks, enabled))
    }
}

/// How long a correction may be on its way after a reversal, s: its ramp, and at the greatest rate the largest correction.
fn transition(calibration: &Calibration) -> f64 {
    let limits = &calibration.limits;
    let largest = limits.compensation.map_or(LARGEST, |limit| limit.value);
    let at_rate = limits.rate.map_or(0.0, |rate| largest / rate.value);
    let largest = limits.rotation.map_or(LARGEST_ROTATION, |limit| limit.value);
    let at_rate = limits.rotation_rate.map_or(at_rate, |rate| at_rate.max(largest / rate.value));
    let ramps = calibration.motions.iter().flat_map(|motion| &motion.ramps);
    at_rate + ramps.fold(0.0, |longest, ramp| ramp.time.max(longest))
}
