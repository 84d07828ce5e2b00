//! A supervisor and what it borrows.
//!
//! In: a machine and its calibration. Out: one servo cycle after another. It exists because terms borrow the numbers of the
//! calibration, error motions the terms, and the supervisor both: each stage here owns the one before it.

use abbe_runtime::{
    AxisMemory, Compensator, DirectionOutcome, ErrorMotion, Memory, Sample, State, Supervisor, Term,
    TermState, Work, states_needed,
};
use model_dsl::calibration::{Calibration, SensorReadings};
use self_cell::{MutBorrow, self_cell};

use super::tracks::Tracks;
use super::{Inputs, SetupFailure};
use crate::machine::ChangingMachine;
use crate::status::{Cycle, Status};

/// The terms of each error motion.
type Terms<'a> = Vec<Vec<Term<'a>>>;

/// The error motions of the machine.
type Motions<'a> = Vec<ErrorMotion<'a>>;

self_cell! {
    struct CalibratedTerms {
        owner: Calibration,
        #[covariant]
        dependent: Terms,
    }
}

self_cell! {
    struct CalibratedMotions {
        owner: CalibratedTerms,
        #[covariant]
        dependent: Motions,
    }
}

/// All that a supervisor borrows.
struct Parts {
    machine: Box<dyn ChangingMachine>,
    motions: CalibratedMotions,
    storage: MutBorrow<Storage>,
}

/// Room for what is remembered and worked out.
struct Storage {
    states: Vec<TermState>,
    directions: Vec<[f64; 3]>,
    motions: Vec<f64>,
    travel: Vec<f64>,
    axes: Vec<AxisMemory>,
    temperature: Vec<f64>,
    silence: Vec<f64>,
}

/// The supervisor, and the sensors that the calibration derives from others.
struct Supervision<'a> {
    supervisor: Supervisor<'a, dyn ChangingMachine>,
    readings: SensorReadings<'a>,
}

self_cell! {
    struct Supervised {
        owner: Parts,
        #[not_covariant]
        dependent: Supervision,
    }
}

/// A supervisor with the room that each cycle needs.
pub(super) struct Running {
    supervised: Supervised,
    command: Vec<f64>,
    correction: Vec<f64>,
    /// For each sensor of the calibration where its temperature is.
    places: Vec<Place>,
    /// The temperature of each sensor of the calibration.
    temperature: Vec<f64>,
}

/// Where the temperature of a sensor comes from.
#[derive(Clone, Copy)]
enum Place {
    /// The entry of the controller's temperatures.
    Given(usize),
    /// Other sensors, or nowhere where no term reads it.
    Derived,
}

impl Running {
    /// Starts a machine with its calibration, switched off.
    pub(super) fn start(
        machine: Box<dyn ChangingMachine>,
        calibration: Calibration,
    ) -> Result<Self, SetupFailure> {
        let places = places(&calibration);
        let count = machine.motions();
        let terms = CalibratedTerms::try_new(calibration, |calibration| terms(calibration, count))?;
        let motions = CalibratedMotions::new(terms, |terms| {
            terms.borrow_dependent().iter().map(|terms| ErrorMotion { terms }).collect()
        });
        let storage = MutBorrow::new(Storage::new(machine.as_ref(), motions.borrow_dependent()));
        let axes = machine.axes();
        let supervised = Supervised::try_new(Parts { machine, motions, storage }, supervise)?;
        Ok(Self {
            supervised,
            command: vec![0.0; axes],
            correction: vec![0.0; axes],
            temperature: vec![f64::NAN; places.len()],
            places,
        })
    }

    /// The correction of each axis that the last cycle made.
    pub(super) fn correction(&self) -> &[f64] {
        &self.correction
    }

    /// What the last cycle found of the direction of the tool; NaN where it found nothing, none where rotary axes do not correct it.
    pub(super) fn direction(&mut self) -> Option<DirectionOutcome> {
        const NOTHING: DirectionOutcome = DirectionOutcome { error: [f64::NAN; 3], remaining: [f64::NAN; 3] };
        self.supervised.with_dependent_mut(|parts, running| {
            let corrects = !parts.machine.aiming().is_empty();
            corrects.then(|| running.supervisor.compensator.direction().unwrap_or(NOTHING))
        })
    }

    /// Forgets what terms and sensors remember.
    pub(super) fn restart(&mut self) {
        self.supervised.with_dependent_mut(|parts, running| {
            running.readings = SensorReadings::of_terms(parts.sensors());
            running.supervisor.restart();
        });
    }

    /// Takes a tool of the calibration, or the constants of the calibration itself; whether there is such a tool.
    pub(super) fn set_tool(&mut self, name: Option<&str>) -> bool {
        self.supervised.with_dependent_mut(|parts, running| {
            let calibration = parts.motions.borrow_owner().borrow_owner();
            let constants = match name {
                None => Some(&calibration.constants),
                Some(name) => calibration
                    .tool(name)
                    .and_then(|tool| calibration.tools.get(tool))
                    .map(|tool| &tool.constants),
            };
            constants.is_some_and(|constants| running.change(parts, constants))
        })
    }

    /// Takes these constants of the machine; whether they are as many as it has.
    pub(super) fn set_constants(&mut self, constants: &[f64]) -> bool {
        self.supervised.with_dependent_mut(|parts, running| running.change(parts, constants))
    }

    /// One cycle; every length has been checked.
    pub(super) fn cycle(&mut self, inputs: &Inputs<'_>, tracks: &Tracks, enabled: bool) -> (Status, Cycle) {
        let Self { supervised, command, correction, places, temperature } = self;
        supervised.with_dependent_mut(|_, running| {
            running.hear(places, inputs.temperature, temperature);
            let sample = Sample {
                position: inputs.position,
                travel: &[],
                direction: tracks.direction(),
                velocity: tracks.velocity(),
                temperature,
                time_step: inputs.time_step,
            };
            running.supervisor.compensator.enabled = enabled;
            let done = running.supervisor.cycle(&sample, command);
            for (correction, axis) in correction.iter_mut().zip(running.supervisor.axes()) {
                *correction = axis.made();
            }
            let silent = match done.state {
                State::Holding { sensor } | State::Lost { sensor } => given(places, sensor),
                _ => None,
            };
            (Status::from(done.state), Cycle::new(&done, silent))
        })
    }
}

impl Parts {
    /// The sensors of the calibration.
    fn sensors(&self) -> &model_dsl::calibration::Sensors {
        &self.motions.borrow_owner().borrow_owner().sensors
    }
}

impl Storage {
    fn new(machine: &dyn ChangingMachine, motions: &[ErrorMotion<'_>]) -> Self {
        Self {
            states: vec![TermState::default(); states_needed(motions)],
            directions: vec![[0.0; 3]; machine.axes()],
            motions: vec![0.0; machine.motions()],
            travel: vec![0.0; machine.travels().len()],
            axes: vec![AxisMemory::default(); machine.axes()],
            temperature: Vec::new(),
            silence: Vec::new(),
        }
    }
}

impl Supervision<'_> {
    /// Takes other constants of the machine; whether they are as many as it has.
    fn change(&mut self, parts: &Parts, constants: &[f64]) -> bool {
        let changed = parts.machine.change(constants);
        if changed {
            self.supervisor.switch();
        }
        changed
    }

    /// Takes the temperatures of a cycle over to all sensors of the calibration; one that no term reads is never silent.
    fn hear(&mut self, places: &[Place], given: &[f64], all: &mut [f64]) {
        let input = |sensor: usize| match places.get(sensor) {
            Some(Place::Given(index)) => given.get(*index).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        };
        let readings = self.readings.update(input);
        all.iter_mut().zip(readings).for_each(|(slot, reading)| *slot = *reading);
    }
}

/// The terms of every error motion.
fn terms(calibration: &Calibration, motions: usize) -> Result<Terms<'_>, SetupFailure> {
    let runtime = |motion| {
        let terms: Vec<Vec<Term<'_>>> =
            calibration.runtime(motion).collect::<Result<_, _>>().map_err(SetupFailure::Term)?;
        Ok(terms.concat())
    };
    (0..motions).map(runtime).collect()
}

/// The supervisor of what the parts hold.
fn supervise(parts: &Parts) -> Result<Supervision<'_>, SetupFailure> {
    let calibration = parts.motions.borrow_owner().borrow_owner();
    let Storage { states, directions, motions, travel, axes, temperature, silence } =
        parts.storage.borrow_mut();
    let work = Work { directions, motions, travel };
    let error_motions = parts.motions.borrow_dependent();
    let mut compensator =
        Compensator::new(parts.machine.as_ref(), error_motions, states, work).map_err(SetupFailure::Setup)?;
    compensator.enabled = false;
    compensator.limits = calibration.limits.of_compensator();
    temperature.resize(compensator.sensors(), f64::NAN);
    silence.resize(compensator.sensors(), 0.0);
    let mut supervisor =
        Supervisor::new(compensator, Memory { axes, temperature, silence }).map_err(SetupFailure::Setup)?;
    supervisor.transition = calibration.limits.transition();
    Ok(Supervision { supervisor, readings: SensorReadings::of_terms(&calibration.sensors) })
}

/// For each sensor of a calibration where its temperature comes from; inputs count in the order of their names for C.
fn places(calibration: &Calibration) -> Vec<Place> {
    let sensors = &calibration.sensors;
    let mut places = vec![Place::Derived; sensors.len()];
    for (number, (sensor, _)) in sensors.inputs().enumerate() {
        if let Some(place) = places.get_mut(sensor) {
            *place = Place::Given(number);
        }
    }
    places
}

/// The index for C of a sensor; none for one that is derived from others.
fn given(places: &[Place], sensor: usize) -> Option<usize> {
    match places.get(sensor) {
        Some(Place::Given(number)) => Some(*number),
        _ => None,
    }
}
