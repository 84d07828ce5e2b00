//! Straight-line programs: the equations lowered until writing code is trivial.
//!
//! In: polynomials. Out: additions and multiplications of two values each, every value
//! computed once. The interpreter ([`Tape`]) and the Rust printer read the same program,
//! so neither decides anything.

mod builder;
mod column;
mod interpreter;
mod machine_programs;
mod tape;

pub use builder::Builder;
pub use column::Column;
pub use interpreter::Interpreter;
pub use machine_programs::{OrientationPrograms, Programs};
pub use tape::Tape;

use std::fmt;

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Input {
    /// The position of an axis, by number: mm or rad.
    Position(usize),
    /// A free travel, by number: mm.
    Travel(usize),
    /// A named offset, by number: mm.
    Constant(usize),
    /// The cosine of the position of an axis, by number.
    Cos(usize),
    /// The sine of the position of an axis, by number.
    Sin(usize),
    /// An error motion, by number: mm or rad.
    Motion(usize),
}

/// One value of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Value {
    /// Zero.
    Zero,
    /// A number, by its place in [`Program::numbers`].
    Number(usize),
    /// Something given.
    Input(Input),
    /// The result of a step, by number.
    Step(usize),
}

/// One operation on two earlier values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Step {
    /// The sum.
    Add(Value, Value),
    /// The first less the second.
    Sub(Value, Value),
    /// The product.
    Mul(Value, Value),
    /// The opposite.
    Neg(Value),
}

impl Step {
    /// The values that it reads.
    pub fn reads(self) -> impl Iterator<Item = Value> {
        let (first, second) = match self {
            Self::Add(a, b) | Self::Sub(a, b) | Self::Mul(a, b) => (a, Some(b)),
            Self::Neg(a) => (a, None),
        };
        std::iter::once(first).chain(second)
    }
}

/// A straight-line program with several results.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// The numbers that occur, none of them 0 or 1.
    pub numbers: Vec<f64>,
    /// The operations, each reading only earlier ones.
    pub steps: Vec<Step>,
    /// The results in order.
    pub results: Vec<Value>,
}

/// How many operations a program takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Additions, subtractions and changes of sign.
    pub additions: usize,
    /// Multiplications.
    pub multiplications: usize,
}

impl fmt::Display for Operations {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = |count: usize| if count == 1 { "" } else { "s" };
        let (sums, products) = (self.additions, self.multiplications);
        write!(f, "{sums} addition{}, {products} multiplication{}", plural(sums), plural(products))
    }
}

impl Program {
    /// The number of operations.
    pub fn operations(&self) -> Operations {
        let multiplications = self.steps.iter().filter(|step| matches!(step, Step::Mul(..))).count();
        Operations { additions: self.steps.len() - multiplications, multiplications }
    }

    /// How often each step is read, results included.
    pub fn uses(&self) -> Vec<usize> {
        let mut uses = vec![0; self.steps.len()];
        let reads = self.steps.iter().flat_map(|step| step.reads()).chain(self.results.iter().copied());
        for value in reads {
            if let Value::Step(number) = value {
                uses[number] += 1;
            }
        }
        uses
    }

    /// Runs the program on the inputs that `given` supplies; one number for each result.
    pub fn run(&self, given: impl Fn(Input) -> f64) -> Vec<f64> {
        Tape::new(self).run(given)
    }
}
