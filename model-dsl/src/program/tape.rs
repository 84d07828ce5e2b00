//! Programs laid out for running. In: a program. Out: its operations over one array of values,
//! each value at a place of its own, so that running it looks nothing up.

use super::column::Room;
use super::{Column, Input, Program, Step, Value};

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
    /// For each place the last operation or result that reads it, counted through both; 0 where nothing does.
    last_reads: Vec<usize>,
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
        tape.last_reads = tape.last_reads();
        tape
    }

    /// Whether any of the inputs is the position of an axis, or its sine or cosine.
    pub fn reads_axes(&self) -> bool {
        self.inputs.iter().any(|input| matches!(input, Input::Position(_) | Input::Sin(_) | Input::Cos(_)))
    }

    /// Runs the tape on the inputs that `given` supplies; one number for each result.
    pub fn run(&self, given: impl Fn(Input) -> f64) -> Vec<f64> {
        let known = self.numbers.len() + self.inputs.len();
        let places = known + self.operations.len();
        // With room for the results, which then need no array of their own.
        let mut values = Vec::with_capacity(places + self.results.len());
        values.extend_from_slice(&self.numbers);
        values.extend(self.inputs.iter().map(|input| given(*input)));
        values.resize(places + self.results.len(), f64::NAN);
        let at = |values: &[f64], place: usize| values.get(place).copied().unwrap_or(f64::NAN);
        // As a slice: a vector would have its length written again at every step.
        let slots = values.as_mut_slice();
        for (place, (operation, first, second)) in (known..).zip(&self.operations) {
            let (a, b) = (at(slots, *first), at(slots, *second));
            let result = match operation {
                Operation::Add => a + b,
                Operation::Sub => a - b,
                Operation::Mul => a * b,
                Operation::Neg => -a,
            };
            if let Some(slot) = slots.get_mut(place) {
                *slot = result;
            }
        }
        for (place, result) in (places..).zip(&self.results) {
            let value = at(slots, *result);
            if let Some(slot) = slots.get_mut(place) {
                *slot = value;
            }
        }
        values.drain(..places);
        values
    }

    /// Runs the tape on columns of equal length; one column for each result.
    ///
    /// Each operation runs over all rows before the next begins; one on numbers that are the same in every row runs once.
    pub fn run_columns<'c>(&self, given: impl Fn(Input) -> Column<'c>) -> Vec<Column<'c>> {
        let mut values: Vec<Column<'c>> = Vec::with_capacity(self.last_reads.len());
        values.extend(self.numbers.iter().map(|number| Column::Same(*number)));
        values.extend(self.inputs.iter().map(|input| given(*input)));
        let mut room = Room::default();
        let unknown = Column::Same(f64::NAN);
        for (number, (operation, first, second)) in self.operations.iter().enumerate() {
            let (a, b) = (values.get(*first).unwrap_or(&unknown), values.get(*second).unwrap_or(&unknown));
            let result = match operation {
                Operation::Add => a.combine(b, &mut room, |a, b| a + b),
                Operation::Sub => a.combine(b, &mut room, |a, b| a - b),
                Operation::Mul => a.combine(b, &mut room, |a, b| a * b),
                Operation::Neg => a.map(&mut room, |a| -a),
            };
            values.push(result);
            for place in [*first, *second].into_iter().filter(|place| self.is_last(number, *place)) {
                room.reuse(taken(&mut values, place));
            }
        }
        let results = self.results.iter().enumerate().map(|(number, place)| {
            match self.is_last(self.operations.len() + number, *place) {
                true => taken(&mut values, *place),
                false => values.get(*place).unwrap_or(&unknown).clone(),
            }
        });
        results.collect()
    }

    fn is_last(&self, reader: usize, place: usize) -> bool {
        self.last_reads.get(place) == Some(&reader)
    }

    fn last_reads(&self) -> Vec<usize> {
        let mut last = vec![0; self.numbers.len() + self.inputs.len() + self.operations.len()];
        let operations = self.operations.iter().map(|(_, first, second)| [*first, *second]);
        let readers = operations.chain(self.results.iter().map(|place| [*place; 2]));
        for (reader, places) in readers.enumerate() {
            for place in places {
                last[place] = reader;
            }
        }
        last
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

/// A value that nobody reads any more.
fn taken<'c>(values: &mut [Column<'c>], place: usize) -> Column<'c> {
    let unknown = Column::Same(f64::NAN);
    values.get_mut(place).map_or(Column::Same(f64::NAN), |value| std::mem::replace(value, unknown))
}
