//! The whole way: error motions of a calibration, the compensator over generated code, and the exact machine as judge.
//!
//! In: shipped machines with random small error motions made of the runtime's terms. Out: the distance that the tool really
//! keeps from where it was wanted, off and on. On, it must be of second order in the errors.

use abbe_runtime::{
    Compensator, Direction, DirectionOutcome, ErrorMotion, Input, Kinematics, Limits, Outcome, Refusal,
    Sample, Table, Term, TermState, Values, Work, states_needed,
};
use model_dsl::equations::Equations;
use model_dsl::program::Interpreter;
use proptest::prelude::*;

use crate::agreement::compiled;
use crate::oracle::{Machine, Sizes, State, draw, exact};
use crate::random::{machines, state};
use crate::shipped::{SHIPPED, Shipped};
use crate::yaml;

/// Temperature of the one sensor, degC.
const WARM: [f64; 1] = [26.5];

/// The numbers of a calibration, kept where terms can borrow them.
struct Numbers {
    polynomials: Vec<[f64; 3]>,
    curves: Vec<[[f64; 5]; 2]>,
    nodes: [f64; 5],
}

impl Numbers {
    /// Displacements up to some 0.04 mm, angles up to some 40 urad, over axes of +-500 mm.
    fn new(equations: &Equations, seed: u64) -> Self {
        let size = |angular: bool| if angular { 10e-6 } else { 0.01 };
        let drawn = |name: &str, what: &str, number: usize| draw(seed, &format!("{name} {what} {number}"));
        let polynomial = |motion: &model_dsl::equations::Motion| {
            let number = |order: usize, range: f64| {
                size(motion.angular) * drawn(&motion.name, "polynomial", order) / range
            };
            [number(0, 1.0), number(1, 500.0), number(2, 500.0 * 500.0)]
        };
        let curves = |motion: &model_dsl::equations::Motion| {
            [0, 5].map(|start| {
                std::array::from_fn(|node| size(motion.angular) * drawn(&motion.name, "curve", start + node))
            })
        };
        Self {
            polynomials: equations.motions.iter().map(polynomial).collect(),
            curves: equations.motions.iter().map(curves).collect(),
            nodes: [-480.0, -200.0, 10.0, 150.0, 505.0],
        }
    }

    /// The terms of each error motion: a constant for alignments, the more for the others.
    fn terms(&self, equations: &Equations) -> Vec<Vec<Term<'_>>> {
        let of = |(number, motion): (usize, &model_dsl::equations::Motion)| {
            let [constant, slope, _] = &self.polynomials[number];
            let Some(axis) = motion.axis.filter(|_| !motion.alignment) else {
                return vec![Term::Constant { value: *constant }];
            };
            let [forward, reverse] = &self.curves[number];
            let values = Values::Directed { forward, reverse };
            vec![
                Term::Polynomial { input: Input::Axis(axis), coefficients: &self.polynomials[number] },
                Term::Table { axis, table: Table::at(&self.nodes, values).unwrap() },
                Term::Backlash { axis, lost_motion: *constant, wind_up: 0.0, ramp: 0.0 },
                Term::Cyclic { axis, period: 10.0, amplitude: constant / 10.0, phase: 0.3 },
                Term::Expansion { axis, sensor: 0, coefficient: slope / 10.0, reference: 20.0 },
                Term::Growth { sensor: 0, coefficient: constant / 10.0, reference: 20.0, time_constant: 0.0 },
            ]
        };
        equations.motions.iter().enumerate().map(of).collect()
    }
}

/// One machine with its errors, and a place to ask for.
pub(crate) struct Trial<'t> {
    pub(crate) machine: &'t Machine,
    pub(crate) equations: &'t Equations,
    motions: &'t [ErrorMotion<'t>],
    directions: &'t [Direction],
    pub(crate) target: State,
}

impl Trial<'_> {
    fn sample<'s>(&'s self, position: &'s [f64]) -> Sample<'s> {
        Sample {
            position,
            travel: &[],
            direction: self.directions,
            velocity: &[],
            temperature: &WARM,
            time_step: 0.002,
        }
    }

    pub(crate) fn wanted(&self) -> Vec<f64> {
        self.equations.axes.iter().map(|axis| self.target.positions[&*axis.variable]).collect()
    }

    /// The state of the real machine at a command: error motions as they are there, alignments over the real travel.
    pub(crate) fn real(&self, command: &[f64]) -> State {
        let mut state = self.target.clone();
        for (axis, position) in self.equations.axes.iter().zip(command) {
            state.positions.insert(axis.variable.to_string(), *position);
        }
        for travel in &self.equations.travels {
            state.travels.insert(travel.name.to_string(), command[travel.axis]);
        }
        let sample = self.sample(command);
        for (motion, error) in self.equations.motions.iter().zip(self.motions) {
            let memory = vec![TermState::default(); error.terms.len()];
            state.errors.insert(motion.name.clone(), error.value(&sample, &memory));
        }
        state
    }

    /// The turn of the tool at a command away from the one wanted, rad.
    fn turned(&self, command: &[f64]) -> f64 {
        length(exact::turn_between(self.machine, &self.target, &self.real(command)))
    }

    /// Where the tool really is at a command, less where it was wanted, in the sensitive directions.
    pub(crate) fn miss(&self, command: &[f64]) -> [f64; 3] {
        let (real, wanted) =
            (exact::tip(self.machine, &self.real(command)), exact::tip(self.machine, &self.target));
        std::array::from_fn(|axis| if self.machine.sensitive[axis] { real[axis] - wanted[axis] } else { 0.0 })
    }

    /// What the first order may leave: half the bound of the second derivative of the exact tip along the errors (see
    /// `Sizes`), and what the search leaves: ten of the steps at which it ends, 1e-10 mm or rad. A rotary axis moves the tip by its step
    /// times a lever, which is no longer than all lengths together.
    pub(crate) fn second_order(&self, command: &[f64]) -> f64 {
        let sizes = Sizes::of(self.machine, &self.real(command));
        let turns = self.equations.axes.iter().any(|axis| axis.rotary);
        let lever = if turns { sizes.lengths } else { 0.0 };
        sizes.second() / 2.0 + sizes.rounding() + 1e-9 * (1.0 + lever)
    }
}

fn cycle<K: Kinematics>(machine: &K, trial: &Trial<'_>, enabled: bool) -> (Outcome, Vec<f64>) {
    let Answer { outcome, command, .. } = asked(machine, trial, enabled);
    (outcome.unwrap(), command)
}

/// What a compensator answers.
pub(crate) struct Answer {
    pub(crate) outcome: Result<Outcome, Refusal>,
    pub(crate) direction: Option<DirectionOutcome>,
    pub(crate) command: Vec<f64>,
}

pub(crate) fn asked<K: Kinematics>(machine: &K, trial: &Trial<'_>, enabled: bool) -> Answer {
    answer(machine, trial, enabled, Limits::default())
}

/// The answer of a compensator that is switched on and has these limits.
pub(crate) fn asked_within<K: Kinematics>(machine: &K, trial: &Trial<'_>, limits: Limits) -> Answer {
    answer(machine, trial, true, limits)
}

fn answer<K: Kinematics>(machine: &K, trial: &Trial<'_>, enabled: bool, limits: Limits) -> Answer {
    let mut states = vec![TermState::default(); states_needed(trial.motions)];
    let mut directions = vec![[0.0; 3]; machine.axes()];
    let mut values = vec![0.0; machine.motions()];
    let mut travel = vec![0.0; machine.travels().len()];
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let mut compensator = Compensator::new(machine, trial.motions, &mut states, work).unwrap();
    (compensator.enabled, compensator.limits) = (enabled, limits);
    let wanted = trial.wanted();
    let mut command = vec![f64::NAN; wanted.len()];
    let outcome = compensator.compensate(&trial.sample(&wanted), &mut command);
    Answer { outcome, direction: compensator.direction(), command }
}

pub(crate) fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|part| part * part).sum::<f64>().sqrt()
}

pub(crate) fn less(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

/// Off and on at many points; `build` makes the compiled machine from the values of its constants.
fn judged<K: Kinematics>(name: &str, build: impl Fn(&[f64]) -> K) {
    let shipped: &Shipped = SHIPPED.iter().find(|shipped| shipped.name == name).unwrap();
    let (machine, equations) = ((shipped.described)(), compiled(&shipped.text()));
    let (mut off_total, mut on_total) = (0.0, 0.0);
    for seed in 0..40 {
        let numbers = Numbers::new(&equations, seed);
        let terms = numbers.terms(&equations);
        let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
        let backwards = |axis: &str| draw(seed, &format!("direction {axis}")) < 0.0;
        let directions: Vec<Direction> = equations
            .axes
            .iter()
            .map(|axis| if backwards(&axis.variable) { Direction::Negative } else { Direction::Positive })
            .collect();
        let target = state(&machine, seed);
        let constants: Vec<f64> =
            equations.constants.iter().map(|constant| target.constants[&*constant.name]).collect();
        let trial = Trial {
            machine: &machine,
            equations: &equations,
            motions: &motions,
            directions: &directions,
            target,
        };
        let compiled = build(&constants);

        let (off, unchanged) = cycle(&compiled, &trial, false);
        assert_eq!(unchanged, trial.wanted(), "{name}: switched off, positions pass unchanged");
        let left = length(less(trial.miss(&unchanged), off.error));
        assert!(left <= trial.second_order(&unchanged), "{name}: predicted {:?}, {left:e} away", off.error);

        let (on, command) = cycle(&compiled, &trial, true);
        let left = length(less(trial.miss(&command), on.remaining));
        assert!(left <= trial.second_order(&command), "{name}: left {left:e} at {command:?}");
        off_total += length(less(trial.miss(&unchanged), on.remaining));
        on_total += left;
    }
    // Errors of 1e-4 of all lengths leave some 1e-8 of them: a thousandth is asked for, so that the test says compensated.
    assert!(on_total < off_total / 1000.0, "{name}: off {off_total:e}, on {on_total:e}");
}

/// The machine of a module with its constants in it.
macro_rules! machine {
    ($module:ident) => {
        |constants: &[f64]| abbe_generated::$module::Machine {
            constants: abbe_generated::$module::Constants::from_array(constants.try_into().unwrap()),
        }
    };
}

#[test]
fn lathe() {
    judged("excello-921", machine!(excello_921));
}

/// Nothing drives Y of a turning centre: what is left there is told, not compensated.
#[test]
fn turning_center() {
    judged("nist-turning-center", machine!(nist_turning_center));
}

#[test]
fn mills() {
    judged("fxyz-mill", machine!(fxyz_mill));
    judged("xfyz-mill", machine!(xfyz_mill));
    judged("xyfz-mill", machine!(xyfz_mill));
    judged("xyzf-mill", machine!(xyzf_mill));
    judged("postech-mill", machine!(postech_mill));
}

#[test]
fn five_axes() {
    judged("trunnion-5axis", machine!(trunnion_5axis));
    judged("head-table-5axis", machine!(head_table_5axis));
    judged("nutating-head-5axis", machine!(nutating_head_5axis));
}

/// The interpreter serves the compensator as generated code does.
#[test]
fn by_the_interpreter() {
    let equations =
        compiled(&SHIPPED.iter().find(|shipped| shipped.name == "trunnion-5axis").unwrap().text());
    judged("trunnion-5axis", |constants| Interpreter::new(&equations, constants));
}

/// One place to ask for on any machine, with these terms.
fn on_any<R>(
    machine: &Machine,
    terms: impl Fn(&Equations) -> Vec<Vec<Term<'static>>>,
    seed: u64,
    judge: impl FnOnce(&Trial<'_>, &Interpreter) -> R,
) -> R {
    on_file(machine, &yaml::text(machine, true), terms, state(machine, seed), judge)
}

/// The same on a machine of which the file says more, at a place.
pub(crate) fn on_file<R>(
    machine: &Machine,
    file: &str,
    terms: impl Fn(&Equations) -> Vec<Vec<Term<'static>>>,
    target: State,
    judge: impl FnOnce(&Trial<'_>, &Interpreter) -> R,
) -> R {
    let equations = compiled(file);
    let terms = terms(&equations);
    let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
    let directions = vec![Direction::Positive; equations.axes.len()];
    let constants: Vec<f64> =
        equations.constants.iter().map(|constant| target.constants[&*constant.name]).collect();
    let trial = Trial { machine, equations: &equations, motions: &motions, directions: &directions, target };
    judge(&trial, &Interpreter::new(&equations, &constants))
}

/// Constants: displacements up to 0.05 mm, angles up to 40 urad.
pub(crate) fn constants(equations: &Equations, seed: u64) -> Vec<Vec<Term<'static>>> {
    let size = |angular: bool| if angular { 40e-6 } else { 0.05 };
    let motions = equations.motions.iter();
    motions
        .map(|motion| vec![Term::Constant { value: size(motion.angular) * draw(seed, &motion.name) }])
        .collect()
}

/// The own angles of rotary axes alone, up to 0.2 rad.
fn own_angles(equations: &Equations, seed: u64) -> Vec<Vec<Term<'static>>> {
    let mut terms = vec![Vec::new(); equations.motions.len()];
    for own in equations.turning() {
        let value = 0.2 * draw(seed, &equations.motions[own.motion].name);
        terms[own.motion].push(Term::Constant { value });
    }
    terms
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any chain with any errors: what is left is of second order, rotary axes included.
    #[test]
    fn random_machines(machine in machines(), seed in any::<u64>()) {
        on_any(&machine, |equations| constants(equations, seed), seed, |trial, interpreter| {
            let Answer { outcome, command, .. } = asked(interpreter, trial, true);
            // In front of a singular pose nothing is corrected, as the position says.
            let remaining = match outcome {
                Ok(outcome) => outcome.remaining,
                Err(Refusal::NearSingular { .. }) => return Ok(()),
                Err(refusal) => return Err(TestCaseError::fail(refusal.to_string())),
            };
            let left = length(less(trial.miss(&command), remaining));
            prop_assert!(left <= trial.second_order(&command), "left {left:e} at {command:?}");
            Ok(())
        })?;
    }

    /// Where only the angles of the rotary axes are wrong, they undo all of it, however much that is: tip and direction of the tool
    /// are right to rounding.
    #[test]
    fn own_angles_of_random_machines(machine in machines(), seed in any::<u64>()) {
        on_any(&machine, |equations| own_angles(equations, seed), seed, |trial, interpreter| {
            let Answer { outcome, command, .. } = asked(interpreter, trial, true);
            prop_assert_eq!(outcome.map(|outcome| outcome.remaining), Ok([0.0; 3]));
            let lengths = Sizes::of(trial.machine, &trial.real(&command)).lengths;
            let (tip, turn) = (length(trial.miss(&command)), trial.turned(&command));
            prop_assert!(tip <= 1e-12 * (1.0 + lengths), "tip {tip:e} at {command:?}");
            prop_assert!(turn <= 1e-12, "turned by {turn:e}");
            Ok(())
        })?;
    }
}
