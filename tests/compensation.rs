//! The whole way: error motions of a calibration, the compensator over generated code, and the exact machine as judge.
//!
//! In: shipped machines with random small error motions made of the runtime's terms. Out: the distance that the tool really
//! keeps from where it was wanted, off and on. On, it must be of second order in the errors.

use abbe_runtime::{
    Compensator, Direction, ErrorMotion, Input, Kinematics, Outcome, Sample, Table, Term, TermState, Values,
    Work, states_needed,
};
use model_dsl::equations::Equations;

use crate::agreement::compiled;
use crate::oracle::{Machine, Sizes, State, draw, exact};
use crate::random::state;
use crate::shipped::{SHIPPED, Shipped};

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
struct Trial<'t> {
    machine: &'t Machine,
    equations: &'t Equations,
    motions: &'t [ErrorMotion<'t>],
    directions: &'t [Direction],
    target: State,
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

    fn wanted(&self) -> Vec<f64> {
        self.equations.axes.iter().map(|axis| self.target.positions[&*axis.variable]).collect()
    }

    /// The state of the real machine at a command: error motions as they are there, alignments over the real travel.
    fn real(&self, command: &[f64]) -> State {
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

    /// Where the tool really is at a command, less where it was wanted, in the sensitive directions.
    fn miss(&self, command: &[f64]) -> [f64; 3] {
        let (real, wanted) =
            (exact::tip(self.machine, &self.real(command)), exact::tip(self.machine, &self.target));
        std::array::from_fn(|axis| if self.machine.sensitive[axis] { real[axis] - wanted[axis] } else { 0.0 })
    }

    /// What the first order may leave: half the bound of the second derivative of the exact tip along the errors (see
    /// `Sizes`), and what the search leaves, which ends at steps of 1e-10 mm.
    fn second_order(&self, command: &[f64]) -> f64 {
        let sizes = Sizes::of(self.machine, &self.real(command));
        sizes.second() / 2.0 + sizes.rounding() + 1e-9
    }
}

fn cycle<K: Kinematics>(machine: &K, trial: &Trial<'_>, enabled: bool) -> (Outcome, Vec<f64>) {
    let mut states = vec![TermState::default(); states_needed(trial.motions)];
    let mut directions = vec![[0.0; 3]; machine.axes()];
    let mut values = vec![0.0; machine.motions()];
    let mut travel = vec![0.0; machine.travels().len()];
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let mut compensator = Compensator::new(machine, trial.motions, &mut states, work).unwrap();
    compensator.enabled = enabled;
    let wanted = trial.wanted();
    let mut command = vec![f64::NAN; wanted.len()];
    let outcome = compensator.compensate(&trial.sample(&wanted), &mut command).unwrap();
    (outcome, command)
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|part| part * part).sum::<f64>().sqrt()
}

fn less(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
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
}

/// The interpreter serves the compensator as generated code does.
#[test]
fn by_the_interpreter() {
    let equations =
        compiled(&SHIPPED.iter().find(|shipped| shipped.name == "trunnion-5axis").unwrap().text());
    judged("trunnion-5axis", |constants| model_dsl::program::Interpreter::new(&equations, constants));
}
