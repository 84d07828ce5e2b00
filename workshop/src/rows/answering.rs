//! Rows answered on all processors. In: a calibrated machine, and the state of the machine in many rows. Out: for each row the error and
//! the compensated position, to the last bit what one row after the other gives.
//!
//! What rows remember of the rows before them is taken along first, row by row ([`Samples`]); then pieces are answered side by side, each
//! from what is remembered where it begins.

use abbe_runtime::math::length;
use abbe_runtime::{
    Compensator, ErrorMotion, Exchanged, Kinematics, Outcome, Refusal, Sample, TermState, Work,
};
use model_dsl::calibration::{LARGEST_ANGLE, LARGEST_DISPLACEMENT};
use model_dsl::equations::Equations;
use model_dsl::program::Interpreter;
use rayon::prelude::*;

use super::samples::{PIECE, Samples};
use super::{Lean, Leaning};
use crate::calibrated::Calibrated;
use crate::failure::Failure;

/// A machine that answers rows.
pub struct Answering<'c> {
    calibrated: &'c Calibrated,
    motions: &'c [ErrorMotion<'c>],
    without_tool: Interpreter,
    with_tool: Vec<Interpreter>,
    /// Whether positions are compensated; else errors alone are predicted, and no correction is refused.
    pub compensated: bool,
}

/// What one row is answered.
#[derive(Debug)]
pub struct Answer<'a> {
    /// The errors, without compensation and with it; or why there is none.
    pub outcome: Result<Outcome, Refusal>,
    /// For each axis the compensated position, mm or rad; where the row is refused, its position.
    pub command: &'a [f64],
    /// The error of the tool's direction, where it is derived.
    pub lean: Option<Lean>,
    /// Whether rotary axes correct that error.
    pub aimed: bool,
    /// The error motion that is the farthest from small, by its number, and its value: mm or rad. None where all are.
    pub large: Option<(usize, f64)>,
}

impl<'c> Answering<'c> {
    /// A machine without a tool, and with each tool of its calibration.
    #[must_use]
    pub fn new(calibrated: &'c Calibrated, motions: &'c [ErrorMotion<'c>]) -> Self {
        let (equations, calibration) = (&calibrated.equations, &calibrated.calibration);
        let of = |constants: &[f64]| Interpreter::new(equations, constants);
        Self {
            calibrated,
            motions,
            without_tool: of(&calibration.constants),
            with_tool: calibration.tools.iter().map(|tool| of(&tool.constants)).collect(),
            compensated: true,
        }
    }

    /// The machine's equations.
    #[must_use]
    pub fn equations(&self) -> &'c Equations {
        &self.calibrated.equations
    }

    /// The machine with the tool of a number; the constants of the calibration itself where there is none.
    #[must_use]
    pub fn machine(&self, tool: Option<usize>) -> &Interpreter {
        tool.and_then(|tool| self.with_tool.get(tool)).unwrap_or(&self.without_tool)
    }

    /// Has each piece of the rows answered, side by side. `begin` makes what a piece is gathered in; `take` puts into it a row by its
    /// number and what that is answered, and ends the piece where it gives `false`.
    ///
    /// # Errors
    ///
    /// A calibration that cannot be run.
    pub fn answer<T: Send>(
        &self,
        samples: &Samples<'_>,
        begin: impl Fn() -> T + Sync,
        take: impl Fn(&mut T, usize, &Answer<'_>) -> bool + Sync,
    ) -> Result<Vec<T>, Failure> {
        let piece = |(number, start): (usize, &Vec<TermState>)| {
            let mut gathered = begin();
            self.piece(samples, number, start, |row, answer| take(&mut gathered, row, answer))?;
            Ok(gathered)
        };
        match samples.pieces() {
            // To wake another processor would take longer than the answer.
            [start] => Ok(vec![piece((0, start))?]),
            starts => starts.par_iter().enumerate().map(piece).collect(),
        }
    }

    /// Answers the rows of one piece, one after the other.
    fn piece(
        &self,
        samples: &Samples<'_>,
        number: usize,
        start: &[TermState],
        mut take: impl FnMut(usize, &Answer<'_>) -> bool,
    ) -> Result<(), Failure> {
        let first = number.saturating_mul(PIECE);
        let rows = first..first.saturating_add(PIECE).min(samples.len());
        let machine = Exchanged::new(self.machine(None));
        let mut room = Room::new(self.equations());
        let mut states = start.to_vec();
        let mut compensator = room.compensator(&machine, self.motions, &mut states)?;
        compensator.limits = self.calibrated.calibration.limits.of_compensator();
        compensator.enabled = self.compensated;
        let leaning = Leaning::new(self.equations(), self.motions);
        let mut leaning = leaning.map(|leaning| leaning.remembering(start));
        let mut command = vec![0.0; self.equations().axes.len()];
        for row in rows {
            let with_tool = self.machine(samples.tool(row));
            machine.exchange(with_tool);
            let sample = samples.sample(row);
            let outcome = compensator.compensate(&sample, &mut command);
            let mut lean = leaning.as_mut().map(|leaning| leaning.take(with_tool, &sample));
            if let (Some(lean), Some(direction)) = (&mut lean, compensator.direction()) {
                lean.with = direction.remaining;
            }
            let aimed = self.compensated && compensator.direction().is_some();
            let shows = outcome.as_ref().is_ok_and(|outcome| length(outcome.error) > SHOWS);
            let large = if shows { self.large(&mut compensator, &sample) } else { None };
            if !take(row, &Answer { outcome, command: &command, lean, aimed, large }) {
                break;
            }
        }
        Ok(())
    }
}

/// The error of the tip, mm, from which on it is asked whether all error motions are small: that of the largest angle at a lever arm of
/// 10 mm, the length of a short tool.
const SHOWS: f64 = 10.0 * LARGEST_ANGLE;

impl Answering<'_> {
    /// The error motion that is the farthest above the largest that equations of first order are for. The angle of a rotary axis itself may
    /// be any.
    fn large<K: Kinematics + ?Sized>(
        &self,
        compensator: &mut Compensator<'_, K>,
        sample: &Sample<'_>,
    ) -> Option<(usize, f64)> {
        let values = compensator.motions(sample)?;
        let times = |number: usize, value: f64| {
            let motion = self.equations().motions.get(number)?;
            let largest = if motion.angular { LARGEST_ANGLE } else { LARGEST_DISPLACEMENT };
            let own = motion.angular && self.equations().own_axis(motion).is_some();
            (!own && value.abs() > largest).then_some((number, value, value.abs() / largest))
        };
        let large = values.iter().enumerate().filter_map(|(number, value)| times(number, *value));
        large.max_by(|a, b| a.2.total_cmp(&b.2)).map(|(number, value, _)| (number, value))
    }
}

/// The storage that a compensator works in.
#[derive(Debug)]
pub struct Room {
    directions: Vec<[f64; 3]>,
    values: Vec<f64>,
    travel: Vec<f64>,
}

impl Room {
    /// As much as a machine needs.
    #[must_use]
    pub fn new(equations: &Equations) -> Self {
        Self {
            directions: vec![[0.0; 3]; equations.axes.len()],
            values: vec![0.0; equations.motions.len()],
            travel: vec![0.0; equations.travels.len()],
        }
    }

    /// A compensator that works in it.
    ///
    /// # Errors
    ///
    /// A calibration that cannot be run.
    pub fn compensator<'r, K: Kinematics + ?Sized>(
        &'r mut self,
        machine: &'r K,
        motions: &'r [ErrorMotion<'r>],
        states: &'r mut [TermState],
    ) -> Result<Compensator<'r, K>, Failure> {
        let Self { directions, values, travel } = self;
        let work = Work { directions, motions: values, travel };
        Compensator::new(machine, motions, states, work)
            .map_err(|error| Failure::wrong(format!("error: the calibration cannot be used: {error}")))
    }
}
