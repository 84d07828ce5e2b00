//! The part of a calibrated machine that a table can hold. In: equations and a calibration. Out: error and correction at a
//! pose, without what changes with time, temperature, velocity or load; and what those are, by name.

use abbe_runtime::{
    Compensator, Direction, ErrorMotion, Kinematics, Refusal, Sample, Term, TermState, Work, place_motors,
    states_needed,
};
use model_dsl::calibration::vocabulary::State;
use model_dsl::calibration::{CalibratedTerm, Calibration, CurveValues};
use model_dsl::equations::Equations;
use model_dsl::program::Interpreter;

use super::beyond::Beyond;
use super::refused::Refused;

/// Where the axes stand and how they came there.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// The position of each axis, mm or rad.
    pub position: Vec<f64>,
    /// The direction of each axis's last motion.
    pub direction: Vec<Direction>,
}

impl Pose {
    /// The pose with one axis elsewhere.
    #[must_use]
    pub fn moved(&self, axis: usize, place: f64) -> Self {
        let mut moved = self.clone();
        if let Some(position) = moved.position.get_mut(axis) {
            *position = place;
        }
        moved
    }

    /// The pose of the first axes alone.
    pub(super) fn of_first(&self, axes: usize) -> Self {
        let Self { position, direction } = self;
        Self {
            position: position.iter().take(axes).copied().collect(),
            direction: direction.iter().take(axes).copied().collect(),
        }
    }

    /// The pose with motors where their axes put them.
    fn with_motors(&self, machine: &Interpreter) -> Self {
        let mut placed = self.clone();
        place_motors(machine.following(), &mut placed.position);
        placed
    }

    /// The pose with one axis having come from the other side or this one.
    #[must_use]
    pub fn coming(&self, axis: usize, from: Direction) -> Self {
        let mut coming = self.clone();
        if let Some(direction) = coming.direction.get_mut(axis) {
            *direction = from;
        }
        coming
    }
}

/// A calibrated machine without what no table holds.
#[derive(Debug)]
pub struct Geometry<'c> {
    /// Its equations.
    pub equations: &'c Equations,
    /// Its numbers.
    pub calibration: &'c Calibration,
    machine: Interpreter,
    terms: Vec<Vec<Term<'c>>>,
    beyond: Vec<Beyond>,
}

impl<'c> Geometry<'c> {
    /// The geometry of a machine.
    pub fn new(equations: &'c Equations, calibration: &'c Calibration) -> Self {
        let mut beyond = Vec::new();
        let motions = 0..equations.motions.len();
        let terms = motions.map(|motion| lasting(calibration, motion, &mut beyond)).collect();
        // Tables hold what is wrong at the tip: which way a rotary axis has to turn for the direction depends on all others.
        let machine = Interpreter::new(equations, &calibration.constants).leaving_direction();
        Self { equations, calibration, machine, terms, beyond }
    }

    /// What stands in the calibration and in no table.
    pub fn beyond(&self) -> &[Beyond] {
        &self.beyond
    }

    /// The terms of an error motion that a table holds.
    pub fn terms(&self, motion: usize) -> &[Term<'c>] {
        self.terms.get(motion).map_or(&[], Vec::as_slice)
    }

    /// The axes whose direction some term reads.
    pub fn directed(&self) -> Vec<usize> {
        let terms = self.calibration.motions.iter().flat_map(|motion| &motion.terms);
        let mut axes: Vec<usize> = terms.flat_map(|term| directed_axes(&term.value)).collect();
        axes.sort_unstable();
        axes.dedup();
        axes
    }

    /// The lever arms of all motions: X, Y, Z for each, mm per mm or rad.
    pub fn levers(&self, position: &[f64]) -> Vec<[f64; 3]> {
        self.machine.levers(position, &travels(&self.machine, position))
    }

    /// What every motion does to the tool relative to the part.
    pub(super) fn senses(&self, position: &[f64]) -> Vec<[f64; 3]> {
        senses(&self.machine, position)
    }

    /// The tip of the tool relative to the part without errors, mm.
    pub fn nominal(&self, position: &[f64]) -> [f64; 3] {
        self.machine.nominal(position)
    }

    /// What an error motion is at a pose, mm or rad.
    pub fn motion(&self, motion: usize, pose: &Pose) -> f64 {
        let motion = ErrorMotion { terms: self.terms(motion) };
        let states = vec![TermState::default(); states_needed(std::slice::from_ref(&motion))];
        motion.value(&sample(&pose.with_motors(&self.machine)), &states)
    }

    /// The error at a pose: tip relative to the part, actual minus commanded, mm, part frame.
    ///
    /// # Errors
    /// Where the calibration gives no finite number there.
    pub fn error(&self, pose: &Pose) -> Result<[f64; 3], Refused> {
        asked(&self.machine, &self.terms, pose, |compensator, sample| compensator.error(sample))
    }

    /// What is to be added to the command of each axis so that the error at the pose vanishes: mm, or rad for a rotary axis.
    ///
    /// # Errors
    /// Where the inverse refuses.
    pub fn correction(&self, pose: &Pose) -> Result<Vec<f64>, Refused> {
        correction(&self.machine, &self.terms, pose)
    }

    /// The error that remains at a pose with a correction added to the commands: mm, part frame.
    ///
    /// # Errors
    /// Where the calibration gives no finite number there.
    pub fn remaining(&self, pose: &Pose, correction: &[f64]) -> Result<[f64; 3], Refused> {
        let position = pose.position.iter().zip(correction).map(|(place, more)| place + more).collect();
        let commanded = Pose { position, direction: pose.direction.clone() };
        // An axis that is corrected in its angle stands where its own error takes it: a whole turn of it is exact.
        let mut stands = commanded.clone();
        let mut others = self.terms.clone();
        for own in self.equations.turning() {
            let angle = self.motion(own.motion, &commanded);
            if let (Some(place), Some(terms)) =
                (stands.position.get_mut(own.axis), others.get_mut(own.motion))
            {
                *place += angle;
                terms.clear();
            }
        }
        let error =
            asked(&self.machine, &others, &commanded, |compensator, sample| compensator.error(sample))?;
        let [to, from] = [&stands, pose].map(|pose| self.machine.nominal(&pose.position));
        Ok(std::array::from_fn(|axis| error[axis] + to[axis] - from[axis]))
    }
}

/// One question to the compensator of a machine, which knows of no sample before.
fn asked<T>(
    machine: &Interpreter,
    terms: &[Vec<Term<'_>>],
    pose: &Pose,
    ask: impl FnOnce(&mut Compensator<'_, Interpreter>, &Sample<'_>) -> Result<T, Refusal>,
) -> Result<T, Refused> {
    let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
    let mut states = vec![TermState::default(); states_needed(&motions)];
    let mut directions = vec![[0.0; 3]; machine.axes()];
    let (mut values, mut travel) = (vec![0.0; motions.len()], vec![0.0; machine.travels().len()]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let mut compensator = Compensator::new(machine, &motions, &mut states, work)?;
    Ok(ask(&mut compensator, &sample(&pose.with_motors(machine)))?)
}

/// What every motion of a machine does to the tool relative to the part: what it turns it by, in which no offset counts; or
/// where it turns nothing, what it displaces it by.
pub(super) fn senses(machine: &Interpreter, position: &[f64]) -> Vec<[f64; 3]> {
    let travels = travels(machine, position);
    let turns = machine.turns(position, &travels);
    let levers = machine.levers(position, &travels);
    turns.into_iter().zip(levers).map(|(turn, lever)| if turn == [0.0; 3] { lever } else { turn }).collect()
}

/// The free travels of a machine: the positions of their axes.
fn travels(machine: &Interpreter, position: &[f64]) -> Vec<f64> {
    machine.travels().iter().map(|axis| position.get(*axis).copied().unwrap_or(f64::NAN)).collect()
}

/// What is to be added to the commands of a machine with these error motions: mm, or rad for a rotary axis.
pub(super) fn correction(
    machine: &Interpreter,
    terms: &[Vec<Term<'_>>],
    pose: &Pose,
) -> Result<Vec<f64>, Refused> {
    let mut command = pose.position.clone();
    let pose = &pose.with_motors(machine);
    asked(machine, terms, pose, |compensator, sample| compensator.compensate(sample, &mut command))?;
    Ok(command.iter().zip(&pose.position).map(|(command, target)| command - target).collect())
}

fn sample(pose: &Pose) -> Sample<'_> {
    Sample {
        position: &pose.position,
        travel: &[],
        direction: &pose.direction,
        velocity: &[],
        temperature: &[],
        time_step: 0.0,
    }
}

/// The terms of a motion that depend on positions and directions alone; `beyond` takes the others.
///
/// Play that is taken up over a wind-up counts as taken up.
fn lasting<'c>(calibration: &'c Calibration, motion: usize, beyond: &mut Vec<Beyond>) -> Vec<Term<'c>> {
    let mut lasting = Vec::new();
    for term in calibration.terms(motion).iter().map(|term| &term.value) {
        beyond.extend(Beyond::of(motion, term));
        match term.runtime() {
            Ok(_) if is_changing(term) => {}
            Ok(with_factors) => lasting.extend(with_factors.into_iter().map(taken_up)),
            Err(_) => {}
        }
    }
    lasting
}

/// A play whose take-up is over.
fn taken_up(term: Term<'_>) -> Term<'_> {
    match term {
        Term::Backlash { axis, lost_motion, .. } => {
            Term::Backlash { axis, lost_motion, wind_up: 0.0, ramp: 0.0 }
        }
        other => other,
    }
}

fn is_changing(term: &CalibratedTerm) -> bool {
    term.states().any(|(state, _)| matches!(state, State::Temperature | State::Velocity))
}

/// The axes whose directions a term reads.
fn directed_axes(term: &CalibratedTerm) -> impl Iterator<Item = usize> {
    let of_table = match term.core() {
        CalibratedTerm::Table { axis, curve } => {
            Some(*axis).filter(|_| matches!(curve.values, CurveValues::Directed { .. }))
        }
        _ => None,
    };
    let of_states =
        term.states().filter(|(state, _)| *state == State::Direction).filter_map(|(_, axis)| axis);
    of_table.into_iter().chain(of_states)
}
