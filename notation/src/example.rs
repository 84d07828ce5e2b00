//! One error motion worked through in numbers. In: equations. Out: a state of the machine, one angle of 10 urad, and the
//! error that the equations give, so that a reader can try every sign with a pencil.

use model_dsl::algebra::Axis;
use model_dsl::equations::{ConstantInfo, Equations, Motion};
use model_dsl::machine::LinkKind;
use model_dsl::program::Interpreter;

/// The size of the angle, rad.
const ANGLE: f64 = 10e-6;
/// How many parts a good example's lever arms have in all directions together: more than one, and few enough to add up.
const PARTS: usize = 4;
/// The least lever arm that makes an example, mm.
const LEAST_ARM: f64 = 1.0;

/// A worked example: numbers of a state, one error motion, and what follows.
#[derive(Clone, Debug, PartialEq)]
pub struct Example {
    /// The position of each axis of [`Equations::axes`]: mm, or rad.
    pub positions: Vec<f64>,
    /// The length of each free travel: mm. It is the position of its axis.
    pub travels: Vec<f64>,
    /// The value of each constant: mm. The machine file's own where it has one that is not zero, otherwise chosen.
    pub constants: Vec<f64>,
    /// The number of the error motion in [`Equations::motions`]; all others are zero.
    pub motion: usize,
    /// Its value, rad.
    pub value: f64,
    /// Its lever arm in X, Y, Z of the part's frame, mm; 0 where it has none.
    pub arms: [f64; 3],
}

impl Example {
    /// The error of the tool tip relative to the part, part frame, mm.
    pub fn error(&self) -> [f64; 3] {
        self.arms.map(|arm| arm * self.value)
    }
}

/// The worked example of a machine; none where no angle moves the tip.
pub fn example(equations: &Equations) -> Option<Example> {
    let positions = positions(equations);
    let travel = |axis: usize| positions.get(axis).copied().unwrap_or_default();
    let travels: Vec<f64> = equations.travels.iter().map(|own| travel(own.axis)).collect();
    let constants = constants(equations);
    let arms = Interpreter::new(equations, &constants).levers(&positions, &travels);
    let shown = |(number, arms): &(usize, &[f64; 3])| {
        equations.motions.get(*number).is_some_and(|motion| plain_angle(equations, motion))
            && arms.iter().any(|arm| arm.abs() >= LEAST_ARM)
    };
    let candidates = arms.iter().enumerate().filter(shown);
    let (motion, arms) = candidates.min_by_key(|(number, _)| parts(equations, *number).abs_diff(PARTS))?;
    let arms = *arms;
    Some(Example { positions, travels, constants, motion, value: ANGLE, arms })
}

/// Slides at 100, 200, 300 mm, rotary axes at 30, 60, 90 deg.
fn positions(equations: &Equations) -> Vec<f64> {
    let (mut slide, mut turn) = (0.0, 0.0);
    let next = |last: &mut f64, step: f64| {
        *last += step;
        *last
    };
    let position = |axis: &model_dsl::equations::AxisInfo| {
        if axis.rotary { next(&mut turn, 30.0).to_radians() } else { next(&mut slide, 100.0) }
    };
    equations.axes.iter().map(position).collect()
}

fn constants(equations: &Equations) -> Vec<f64> {
    let chosen = std::iter::successors(Some(40.0), |value| Some(value + 10.0));
    let value = |(constant, chosen): (&ConstantInfo, f64)| {
        let fits = |own: &f64| *own != 0.0 || constant.direction.is_some();
        constant.default.filter(fits).unwrap_or(chosen)
    };
    equations.constants.iter().zip(chosen).map(value).collect()
}

/// Whether a motion turns a body about a direction, in the sense of the hand that the page names: not an alignment, and
/// not the own angle of a rotary axis, which is counted along its programmed sense.
fn plain_angle(equations: &Equations, motion: &Motion) -> bool {
    let own = equations.links.iter().any(|link| {
        link.id == motion.link
            && matches!(link.kind, LinkKind::Rotary(_))
            && link.along.axis == motion.direction
    });
    motion.angular && !motion.alignment && !own
}

/// How many products a reader adds up.
fn parts(equations: &Equations, motion: usize) -> usize {
    Axis::ALL.iter().map(|direction| equations.arm(*direction, motion).size()).sum()
}
