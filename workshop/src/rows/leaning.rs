//! The error of the tool's direction, row by row. In: samples, in their order. Out: that error at the position of each, without
//! compensation, and with it where rotary axes correct no more than their own angles. It exists beside the compensator, which then moves
//! the tip and knows no direction of the tool; what it leaves of a direction that it corrects, it tells itself.

use abbe_runtime::{ErrorMotion, Sample, TermState, Turning, states_needed};
use model_dsl::equations::Equations;
use model_dsl::program::Interpreter;

/// The error of the tool's direction at a position, in the frame of the part: rad.
#[derive(Clone, Copy, Debug)]
pub struct Lean {
    /// Without compensation.
    pub without: [f64; 3],
    /// Where rotary axes have corrected their own angles, and the direction where they do.
    pub with: [f64; 3],
}

/// Follows the error motions of a machine that derives the direction of its tool.
pub(super) struct Leaning<'c> {
    motions: &'c [ErrorMotion<'c>],
    /// What each term remembers, motion by motion: the same as the compensator's.
    states: Vec<TermState>,
    values: Vec<f64>,
    /// No travel turns the tool, whatever it is.
    travel: Vec<f64>,
    turning: Vec<Turning>,
}

impl<'c> Leaning<'c> {
    /// Before the first row; none for a machine that does not derive the direction of its tool.
    pub(super) fn new(equations: &Equations, motions: &'c [ErrorMotion<'c>]) -> Option<Self> {
        (!equations.orientation.is_empty()).then(|| Self {
            motions,
            states: vec![TermState::default(); states_needed(motions)],
            values: vec![0.0; motions.len()],
            travel: vec![0.0; equations.travels.len()],
            turning: equations.turning(),
        })
    }

    /// The same where the terms remember something already, as a compensator has left it.
    #[must_use]
    pub(super) fn remembering(self, states: &[TermState]) -> Self {
        Self { states: states.to_vec(), ..self }
    }

    /// Takes the memories over to the next row, and gives what the direction of the tool is wrong by at its position; `machine` is the
    /// machine with the tool of the row.
    pub(super) fn take(&mut self, machine: &Interpreter, sample: &Sample<'_>) -> Lean {
        // The compensator refuses such a row, and remembers nothing of it.
        if !sample.is_finite() {
            return Lean { without: [f64::NAN; 3], with: [f64::NAN; 3] };
        }
        let without = self.read(machine, sample);
        let with = if self.turning.is_empty() { without } else { self.read_turned(machine, sample) };
        Lean { without, with }
    }

    fn read(&mut self, machine: &Interpreter, sample: &Sample<'_>) -> [f64; 3] {
        let mut rest = self.states.as_mut_slice();
        for (motion, value) in self.motions.iter().zip(&mut self.values) {
            let (own, others) = rest.split_at_mut_checked(motion.terms.len()).unwrap_or_default();
            motion.advance(sample, own);
            *value = motion.value(sample, own);
            rest = others;
        }
        self.error(machine, sample)
    }

    /// The same without what rotary axes correct of their own angles in this row.
    fn read_turned(&mut self, machine: &Interpreter, sample: &Sample<'_>) -> [f64; 3] {
        let mut rest = self.states.as_slice();
        for (number, (motion, value)) in self.motions.iter().zip(&mut self.values).enumerate() {
            let (own, others) = rest.split_at_checked(motion.terms.len()).unwrap_or_default();
            if self.turning.iter().any(|turning| turning.motion == number) {
                *value -= motion.corrected(sample, own);
            }
            rest = others;
        }
        self.error(machine, sample)
    }

    fn error(&self, machine: &Interpreter, sample: &Sample<'_>) -> [f64; 3] {
        let error = machine.direction_error(sample.position, &self.travel, &self.values);
        error.unwrap_or([f64::NAN; 3])
    }
}
