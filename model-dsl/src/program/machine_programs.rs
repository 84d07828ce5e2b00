//! The programs of one machine. In: its equations. Out: the position, the error, the lever
//! arms and the directions of its axes as programs, and an interpreter that runs them.

use abbe_runtime::Kinematics;
use abbe_runtime::math::sin_cos;

use super::{Builder, Input, Program, Tape};
use crate::algebra::{Axis, Polynomial, Symbol};
use crate::equations::Equations;

/// The programs of one machine.
#[derive(Clone, Debug)]
pub struct Programs {
    /// The nominal tool tip relative to the part: X, Y, Z in mm; 0 where not sensitive.
    pub nominal: Program,
    /// The error of the tool tip: X, Y, Z in mm; 0 where not sensitive.
    pub error: Program,
    /// The lever arms: for each motion X, Y, Z.
    pub levers: Program,
    /// For each axis the displacement of the tip for each mm of programmed motion: X, Y, Z.
    pub directions: Program,
}

impl Programs {
    /// Lowers the equations of a machine.
    pub fn new(equations: &Equations) -> Self {
        let resolve = |symbol: &Symbol| input(equations, symbol);
        let program = |polynomials: &mut dyn Iterator<Item = Polynomial>| {
            let mut builder = Builder::new(&resolve);
            polynomials.for_each(|polynomial| builder.result(&polynomial));
            builder.finish()
        };
        let motions = 0..equations.motions.len();
        let arms = motions.flat_map(|motion| Axis::ALL.map(|direction| equations.arm(direction, motion)));
        let mut effects = equations.axes.iter().flat_map(|axis| {
            axis.effect.clone().unwrap_or_else(|| std::array::from_fn(|_| Polynomial::zero()))
        });
        Self {
            nominal: program(&mut Axis::ALL.into_iter().map(|direction| nominal(equations, direction))),
            error: error(equations, &resolve),
            levers: program(&mut arms.into_iter()),
            directions: program(&mut effects),
        }
    }
}

fn nominal(equations: &Equations, direction: Axis) -> Polynomial {
    equations.row(direction).map(|row| row.nominal.clone()).unwrap_or_default()
}

/// The error in the three directions. Motions that act with the same lever arms everywhere, up
/// to a common sign, are added first and multiplied once.
fn error(equations: &Equations, resolve: &dyn Fn(&Symbol) -> Option<Input>) -> Program {
    let mut builder = Builder::new(resolve);
    let mut rows: [Polynomial; 3] = std::array::from_fn(|_| Polynomial::zero());
    for (number, (arms, motions)) in groups(equations).into_iter().enumerate() {
        let group = Symbol::Motion(format!("#{number}").into());
        builder.define(group.clone(), &motions);
        for (row, arm) in rows.iter_mut().zip(&arms) {
            *row = &*row + &(arm * &Polynomial::symbol(group.clone()));
        }
    }
    rows.iter().for_each(|row| builder.result(row));
    builder.finish()
}

/// Motions with equal or opposite lever arms in all directions: the arms, and the signed sum of the motions.
fn groups(equations: &Equations) -> Vec<([Polynomial; 3], Polynomial)> {
    let mut groups: Vec<([Polynomial; 3], Polynomial)> = Vec::new();
    for (number, motion) in equations.motions.iter().enumerate() {
        let arms = Axis::ALL.map(|direction| equations.arm(direction, number));
        let opposite = arms.each_ref().map(|arm| -arm);
        let symbol = Polynomial::symbol(Symbol::Motion(motion.name.as_str().into()));
        let known = groups.iter_mut().find(|(known, _)| *known == arms || *known == opposite);
        match known {
            Some((known, sum)) if *known == arms => *sum = &*sum + &symbol,
            Some((_, sum)) => *sum = &*sum - &symbol,
            None => groups.push((arms, symbol)),
        }
    }
    groups
}

fn input(equations: &Equations, symbol: &Symbol) -> Option<Input> {
    let axis = |name: &str| equations.axes.iter().position(|axis| *axis.variable == *name);
    match symbol {
        Symbol::Position(name) => axis(name).map(Input::Position),
        Symbol::Cos(name) => axis(name).map(Input::Cos),
        Symbol::Sin(name) => axis(name).map(Input::Sin),
        Symbol::Travel(name) => {
            equations.travels.iter().position(|travel| travel.name == *name).map(Input::Travel)
        }
        Symbol::Constant(name) => {
            equations.constants.iter().position(|constant| constant.name == *name).map(Input::Constant)
        }
        Symbol::Motion(name) => {
            equations.motions.iter().position(|motion| *motion.name == **name).map(Input::Motion)
        }
    }
}

/// A machine that is run from its programs, without generated code: slower, and the same numbers.
#[derive(Clone, Debug)]
pub struct Interpreter {
    nominal: Tape,
    error: Tape,
    levers: Tape,
    directions: Tape,
    constants: Vec<f64>,
    travels: Vec<usize>,
    rotary: Vec<bool>,
    motions: usize,
}

impl Interpreter {
    /// Prepares a machine with the values of its constants (mm), in the order of its equations.
    pub fn new(equations: &Equations, constants: &[f64]) -> Self {
        let programs = Programs::new(equations);
        Self {
            nominal: Tape::new(&programs.nominal),
            error: Tape::new(&programs.error),
            levers: Tape::new(&programs.levers),
            directions: Tape::new(&programs.directions),
            constants: constants.to_vec(),
            travels: equations.travels.iter().map(|travel| travel.axis).collect(),
            rotary: equations.axes.iter().map(|axis| axis.rotary).collect(),
            motions: equations.motions.len(),
        }
    }

    /// The nominal tool tip relative to the part: mm, part frame, 0 where not sensitive.
    pub fn nominal(&self, position: &[f64]) -> [f64; 3] {
        triple(&self.run(&self.nominal, position, &[], &[]))
    }

    /// The lever arm of every error motion: X, Y, Z for each.
    pub fn levers(&self, position: &[f64], travel: &[f64]) -> Vec<[f64; 3]> {
        self.run(&self.levers, position, travel, &[]).chunks(3).map(triple).collect()
    }

    fn run(&self, tape: &Tape, position: &[f64], travel: &[f64], motions: &[f64]) -> Vec<f64> {
        let turn = |(angle, rotary): (&f64, &bool)| if *rotary { sin_cos(*angle) } else { (0.0, 1.0) };
        let turns: Vec<(f64, f64)> = position.iter().zip(&self.rotary).map(turn).collect();
        let or_nan = |values: &[f64], number: usize| values.get(number).copied().unwrap_or(f64::NAN);
        tape.run(|input| match input {
            Input::Position(axis) => or_nan(position, axis),
            Input::Travel(number) => or_nan(travel, number),
            Input::Constant(number) => or_nan(&self.constants, number),
            Input::Cos(axis) => turns.get(axis).map_or(f64::NAN, |(_, cosine)| *cosine),
            Input::Sin(axis) => turns.get(axis).map_or(f64::NAN, |(sine, _)| *sine),
            Input::Motion(motion) => or_nan(motions, motion),
        })
    }
}

impl Kinematics for Interpreter {
    fn axes(&self) -> usize {
        self.rotary.len()
    }

    fn travels(&self) -> &[usize] {
        &self.travels
    }

    fn motions(&self) -> usize {
        self.motions
    }

    fn error(&self, position: &[f64], travel: &[f64], motions: &[f64]) -> [f64; 3] {
        let lengths = (position.len(), travel.len(), motions.len());
        if lengths != (self.rotary.len(), self.travels.len(), self.motions) {
            return [f64::NAN; 3];
        }
        triple(&self.run(&self.error, position, travel, motions))
    }

    fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
        let all = self.run(&self.directions, position, &[], &[]);
        for (slot, values) in directions.iter_mut().zip(all.chunks(3)) {
            *slot = triple(values);
        }
    }
}

fn triple(values: &[f64]) -> [f64; 3] {
    match values {
        [x, y, z] => [*x, *y, *z],
        _ => [f64::NAN; 3],
    }
}
