//! Programs laid out for running. In: a program. Out: its operations over one array of values,
//! each value at a place of its own, so that running it looks nothing up.

use super::{Input, Program, Step, Value};

/// A program that is ready to run.
#[derive(Clone, Debug, Default)]
pub struct Tape {
    /// Zero and the numbers of the program: the beginning of the array.
    numbers: Vec<f64>,
    /// The inputs, which follow them.
    inputs: Vec<Input>,
    /// The operations, whose results follow the inputs.
    operations: Vec<(Operation, usize, usize)>,
    /// The places of the results.
    results: Vec<usize>,
}

#[derive(Clone, Copy, Debug)]
enum Operation {
    Add,
    Sub,
    Mul,
    Neg,
}

impl Tape {
    /// Lays a program out.
    pub fn new(program: &Program) -> Self {
        let mut tape = Self::default();
        tape.numbers.push(0.0);
        tape.numbers.extend(&program.numbers);
        let read = program.steps.iter().flat_map(|step| step.reads());
        for value in read.chain(program.results.iter().copied()) {
            if let Value::Input(input) = value
                && !tape.inputs.contains(&input)
            {
                tape.inputs.push(input);
            }
        }
        for step in &program.steps {
            let (operation, first, second) = match *step {
                Step::Add(a, b) => (Operation::Add, a, b),
                Step::Sub(a, b) => (Operation::Sub, a, b),
                Step::Mul(a, b) => (Operation::Mul, a, b),
                Step::Neg(a) => (Operation::Neg, a, Value::Zero),
            };
            tape.operations.push((operation, tape.place(first), tape.place(second)));
        }
        tape.results = program.results.iter().map(|result| tape.place(*result)).collect();
        tape
    }

    /// Runs the tape on the inputs that `given` supplies; one number for each result.
    pub fn run(&self, given: impl Fn(Input) -> f64) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.numbers.len() + self.inputs.len() + self.operations.len());
        values.extend_from_slice(&self.numbers);
        values.extend(self.inputs.iter().map(|input| given(*input)));
        let at = |values: &[f64], place: usize| values.get(place).copied().unwrap_or(f64::NAN);
        for (operation, first, second) in &self.operations {
            let (a, b) = (at(&values, *first), at(&values, *second));
            values.push(match operation {
                Operation::Add => a + b,
                Operation::Sub => a - b,
                Operation::Mul => a * b,
                Operation::Neg => -a,
            });
        }
        self.results.iter().map(|place| at(&values, *place)).collect()
    }

    fn place(&self, value: Value) -> usize {
        match value {
            Value::Zero => 0,
            Value::Number(number) => number + 1,
            Value::Input(input) => {
                let number = self.inputs.iter().position(|known| *known == input);
                self.numbers.len() + number.unwrap_or_default()
            }
            Value::Step(step) => self.numbers.len() + self.inputs.len() + step,
        }
    }
}
