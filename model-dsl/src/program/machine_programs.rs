//! The programs of one machine. In: its equations. Out: the position, the error, the lever
//! arms, the turns, the directions of its axes and the direction of its tool as programs.

use super::{Builder, Input, Program};
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
    /// The turns: for each motion the rotation of the tool relative to the part about X, Y, Z.
    pub turns: Program,
    /// For each axis the displacement of the tip for each mm of programmed motion: X, Y, Z.
    pub directions: Program,
    /// The direction of the tool, where the machine derives it.
    pub orientation: Option<OrientationPrograms>,
}

/// The programs of the direction of the tool, in the part's frame.
#[derive(Clone, Debug)]
pub struct OrientationPrograms {
    /// The direction without errors: I, J, K, pure numbers.
    pub nominal: Program,
    /// Its error: I, J, K in rad.
    pub error: Program,
    /// For each axis that corrects it what that turns it by for each rad: I, J, K, pure numbers.
    pub aims: Program,
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
        let arms =
            motions.clone().flat_map(|motion| Axis::ALL.map(|direction| equations.arm(direction, motion)));
        let turns = motions.flat_map(|motion| Axis::ALL.map(|direction| equations.turn(direction, motion)));
        let mut effects = equations.axes.iter().flat_map(|axis| {
            axis.effect.clone().unwrap_or_else(|| std::array::from_fn(|_| Polynomial::zero()))
        });
        Self {
            nominal: program(&mut Axis::ALL.into_iter().map(|direction| nominal(equations, direction))),
            error: error(equations, &resolve, Equations::arm),
            levers: program(&mut arms.into_iter()),
            turns: program(&mut turns.into_iter()),
            directions: program(&mut effects),
            orientation: (!equations.orientation.is_empty()).then(|| OrientationPrograms {
                nominal: program(&mut equations.orientation.iter().map(|row| row.nominal.clone())),
                error: error(equations, &resolve, Equations::tilt),
                aims: program(&mut equations.axes.iter().filter_map(|axis| axis.aim.clone()).flatten()),
            }),
        }
    }
}

fn nominal(equations: &Equations, direction: Axis) -> Polynomial {
    equations.row(direction).map(|row| row.nominal.clone()).unwrap_or_default()
}

/// The lever arm of a motion in a direction.
type Arm = fn(&Equations, Axis, usize) -> Polynomial;

/// The error in the three directions. Motions that act with the same lever arms everywhere, up
/// to a common sign, are added first and multiplied once.
fn error(equations: &Equations, resolve: &dyn Fn(&Symbol) -> Option<Input>, arm: Arm) -> Program {
    let mut builder = Builder::new(resolve);
    let mut rows: [Polynomial; 3] = std::array::from_fn(|_| Polynomial::zero());
    for (number, (arms, motions)) in groups(equations, arm).into_iter().enumerate() {
        let group = Symbol::Motion(format!("#{number}").into());
        builder.define(group.clone(), &motions);
        for (row, arm) in rows.iter_mut().zip(&arms) {
            *row = &*row + &(arm * &Polynomial::symbol(group.clone()));
        }
    }
    rows.iter().for_each(|row| builder.result(row));
    builder.finish()
}

/// Motions with equal or opposite lever arms in all directions: the arms, and the signed sum of the motions. One without an arm is in none.
fn groups(equations: &Equations, arm: Arm) -> Vec<([Polynomial; 3], Polynomial)> {
    let mut groups: Vec<([Polynomial; 3], Polynomial)> = Vec::new();
    for (number, motion) in equations.motions.iter().enumerate() {
        let arms = Axis::ALL.map(|direction| arm(equations, direction, number));
        if arms.iter().all(Polynomial::is_zero) {
            continue;
        }
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
        // These are numbers, and nobody gives them.
        Symbol::FixedCos(_) | Symbol::FixedSin(_) => None,
    }
}
