//! A table of positions that is in memory, answered at once. In: columns of positions and of what else is known in each row. Out: for
//! each row the error and the compensated position, on all processors, to the last bit what one row after the other gives.
//!
//! What rows remember of the rows before them is taken along first, row by row; then pieces of the table are answered side by side,
//! each from what is remembered where it begins.

use abbe_runtime::{
    Batch, BatchWork, Compensator, Direction, ErrorMotion, Lanes, Outcome, Refusal, Sample, TermState, Work,
    states_needed,
};
use model_dsl::equations::Equations;
use model_dsl::program::Interpreter;
use rayon::prelude::*;

use super::{Leaning, Row, State, timed};
use crate::calibrated::Calibrated;
use crate::failure::Failure;

/// Rows of a piece: so many that a processor is worth waking for them, and a whole number of lanes.
const PIECE: usize = 512 * Lanes::WIDTH;

/// Columns of rows, one entry a row: mm, rad, s, degC.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// The position of each axis.
    pub position: Vec<Vec<f64>>,
    /// Each free travel; none where the positions stand for them.
    pub travel: Vec<Vec<f64>>,
    /// The direction in which each axis came; none where it follows from the positions.
    pub direction: Vec<Vec<Direction>>,
    /// The time.
    pub time: Option<Vec<f64>>,
    /// The temperature of each sensor that the calibration reads, in the order of
    /// [`Sensors::inputs`](model_dsl::calibration::Sensors::inputs).
    pub temperature: Vec<Vec<f64>>,
}

/// How a table is answered.
#[derive(Clone, Debug, Default)]
pub struct Wanted {
    /// The number of the tool; none: the constants of the calibration itself.
    pub tool: Option<usize>,
    /// How far an axis must move back until it has turned: mm or rad, one for each axis.
    pub hysteresis: Vec<f64>,
    /// Whether positions are compensated; else errors alone are predicted, and no correction is refused.
    pub compensated: bool,
    /// Whether terms that cannot be compensated in real time are left out; else they are refused.
    pub left_out: bool,
}

impl Wanted {
    /// The machine with the tool.
    pub(super) fn machine(&self, calibrated: &Calibrated) -> Interpreter {
        let tool = self.tool.and_then(|tool| calibrated.calibration.tools.get(tool));
        let constants = tool.map_or(&calibrated.calibration.constants, |tool| &tool.constants);
        Interpreter::new(&calibrated.equations, constants)
    }
}

/// The answers, row by row.
#[derive(Clone, Debug, Default)]
pub struct Answers {
    /// For each axis the compensated positions: mm or rad.
    pub commands: Vec<Vec<f64>>,
    /// The errors, with them and without.
    pub outcomes: Vec<Outcome>,
    /// The error of the tool's direction without compensation, rad; empty where it is not derived.
    pub leans: Vec<[f64; 3]>,
    /// What was left out, a sentence each.
    pub warnings: Vec<String>,
}

/// Answers all rows of a table.
///
/// # Errors
///
/// Terms that cannot be compensated; the first row that cannot be, by its number counted from 0.
pub fn answer(calibrated: &Calibrated, table: &Table, wanted: &Wanted) -> Result<Answers, Failure> {
    if !wanted.left_out {
        calibrated.refuse_uncompensable()?;
    }
    let mut warnings = Vec::new();
    let terms = calibrated.terms(|left_out| warnings.push(left_out));
    let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
    let machine = wanted.machine(calibrated);
    let answering = Answering { calibrated, machine, motions: &motions, compensated: wanted.compensated };
    let followed = answering.follow(table, &wanted.hysteresis)?;
    let pieces: Vec<Result<Answers, Failure>> = followed
        .starts
        .par_iter()
        .enumerate()
        .map(|(piece, start)| answering.piece(&followed, piece, start))
        .collect();
    let axes = calibrated.equations.axes.len();
    let mut all = Answers { commands: vec![Vec::new(); axes], warnings, ..Answers::default() };
    for piece in pieces {
        let piece = piece?;
        all.commands.iter_mut().zip(piece.commands).for_each(|(all, own)| all.extend(own));
        all.outcomes.extend(piece.outcomes);
        all.leans.extend(piece.leans);
    }
    Ok(all)
}

/// What all pieces have in common.
struct Answering<'a> {
    calibrated: &'a Calibrated,
    machine: Interpreter,
    motions: &'a [ErrorMotion<'a>],
    compensated: bool,
}

/// The state of the machine in every row, a vector for each quantity, and what terms remember where each piece begins.
#[derive(Default)]
struct Followed {
    position: Vec<Vec<f64>>,
    travel: Vec<Vec<f64>>,
    direction: Vec<Vec<Direction>>,
    velocity: Vec<Vec<f64>>,
    temperature: Vec<Vec<f64>>,
    time_step: Vec<f64>,
    starts: Vec<Vec<TermState>>,
}

impl Followed {
    fn push(&mut self, sample: &Sample<'_>) {
        push(&mut self.position, sample.position);
        push(&mut self.travel, sample.travel);
        push(&mut self.direction, sample.direction);
        push(&mut self.velocity, sample.velocity);
        push(&mut self.temperature, sample.temperature);
        self.time_step.push(sample.time_step);
    }
}

impl Answering<'_> {
    fn equations(&self) -> &Equations {
        &self.calibrated.equations
    }

    /// Takes the state along, from the first row to the last.
    fn follow(&self, table: &Table, hysteresis: &[f64]) -> Result<Followed, Failure> {
        let calibration = &self.calibrated.calibration;
        let mut state =
            State::new(calibration, self.equations().following(), timed(calibration).is_some(), hysteresis);
        let mut states = vec![TermState::default(); states_needed(self.motions)];
        let mut followed = Followed::default();
        let mut row = Buffers::default();
        for number in 0..table.position.first().map_or(0, Vec::len) {
            row.fill(table, number);
            let taken = state.take(&row.row(table.time.as_ref().and_then(|time| time.get(number)).copied()));
            taken.map_err(|mistake| refused(number, &mistake))?;
            let sample = state.sample();
            if !sample.is_finite() {
                return Err(refused(number, &Refusal::NotFinite));
            }
            if number.is_multiple_of(PIECE) {
                followed.starts.push(states.clone());
            }
            remember(self.motions, &sample, &mut states);
            followed.push(&sample);
        }
        Ok(followed)
    }

    /// Answers one piece of a table.
    fn piece(&self, all: &Followed, piece: usize, start: &[TermState]) -> Result<Answers, Failure> {
        let first = piece.saturating_mul(PIECE);
        let rows = all.time_step.len().saturating_sub(first).min(PIECE);
        let equations = self.equations();
        let (mut states, mut directions) = (start.to_vec(), vec![[0.0; 3]; equations.axes.len()]);
        let (mut values, mut travel) =
            (vec![0.0; equations.motions.len()], vec![0.0; equations.travels.len()]);
        let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
        let mut compensator = Compensator::new(&self.machine, self.motions, &mut states, work)
            .map_err(|error| Failure::wrong(format!("error: the calibration cannot be run: {error}")))?;
        compensator.limits = self.calibrated.calibration.limits.of_compensator();
        compensator.enabled = self.compensated;
        let sizes = compensator.batch_sizes();
        let (mut lanes, mut numbers) = (vec![Lanes::default(); sizes.lanes], vec![0.0; sizes.numbers]);
        let mut ways = vec![Direction::default(); sizes.directions];
        let work = BatchWork { lanes: &mut lanes, numbers: &mut numbers, directions: &mut ways };
        let of = |columns| slices(columns, first, rows);
        let (position, direction) = (of(&all.position), slices(&all.direction, first, rows));
        let batch = Batch {
            position: &position,
            travel: &of(&all.travel),
            direction: &direction,
            velocity: &of(&all.velocity),
            temperature: &of(&all.temperature),
            time_step: all.time_step.get(first..first.saturating_add(rows)).unwrap_or_default(),
        };
        let mut answers = vec![Err(Refusal::NotFinite); rows];
        let mut commands = vec![vec![0.0; rows]; equations.axes.len()];
        let mut out: Vec<&mut [f64]> = commands.iter_mut().map(Vec::as_mut_slice).collect();
        compensator
            .compensate_batch(&batch, work, &mut out, &mut answers)
            .map_err(|refusal| Failure::wrong(format!("error: the rows cannot be compensated: {refusal}")))?;
        let outcomes = answers.into_iter().enumerate();
        let outcomes = outcomes
            .map(|(row, answer)| answer.map_err(|refusal| refused(first.saturating_add(row), &refusal)));
        Ok(Answers {
            outcomes: outcomes.collect::<Result<_, _>>()?,
            leans: self.leans(&batch, rows, start),
            commands,
            warnings: Vec::new(),
        })
    }

    /// The error of the tool's direction in each row of a piece.
    fn leans(&self, batch: &Batch<'_>, rows: usize, start: &[TermState]) -> Vec<[f64; 3]> {
        let Some(leaning) = Leaning::new(self.equations(), &self.machine, self.motions) else {
            return Vec::new();
        };
        let mut leaning = leaning.remembering(start);
        let at = |columns: &[&[f64]], row: usize| -> Vec<f64> {
            columns.iter().filter_map(|column| column.get(row)).copied().collect()
        };
        let each = (0..rows).map(|row| {
            let directions = batch.direction.iter().filter_map(|column| column.get(row)).copied();
            let sample = Sample {
                position: &at(batch.position, row),
                travel: &at(batch.travel, row),
                direction: &directions.collect::<Vec<_>>(),
                velocity: &at(batch.velocity, row),
                temperature: &at(batch.temperature, row),
                time_step: batch.time_step.get(row).copied().unwrap_or_default(),
            };
            leaning.take(&sample).without
        });
        each.collect()
    }
}

/// Takes the memory of every term over to a row.
fn remember(motions: &[ErrorMotion<'_>], sample: &Sample<'_>, states: &mut [TermState]) {
    let mut rest = states;
    for motion in motions {
        let (own, others) = rest.split_at_mut_checked(motion.terms.len()).unwrap_or_default();
        motion.advance(sample, own);
        rest = others;
    }
}

/// The numbers of one row.
#[derive(Default)]
struct Buffers {
    position: Vec<f64>,
    travel: Vec<f64>,
    direction: Vec<Option<Direction>>,
    temperature: Vec<f64>,
}

impl Buffers {
    fn fill(&mut self, table: &Table, row: usize) {
        take(&mut self.position, &table.position, row);
        take(&mut self.travel, &table.travel, row);
        take(&mut self.temperature, &table.temperature, row);
        self.direction.clear();
        let axes = 0..table.position.len();
        self.direction.extend(axes.map(|axis| table.direction.get(axis)?.get(row).copied()));
    }

    fn row(&self, time: Option<f64>) -> Row<'_> {
        Row {
            position: &self.position,
            travel: &self.travel,
            direction: &self.direction,
            time,
            temperature: &self.temperature,
        }
    }
}

fn take(numbers: &mut Vec<f64>, columns: &[Vec<f64>], row: usize) {
    numbers.clear();
    numbers.extend(columns.iter().filter_map(|column| column.get(row)));
}

fn refused(row: usize, why: &dyn std::fmt::Display) -> Failure {
    Failure::no(format!("error: row {row}, counted from 0: {why}"))
}

/// Adds a row to columns; the first row makes them.
fn push<T: Copy>(columns: &mut Vec<Vec<T>>, row: &[T]) {
    columns.resize_with(row.len(), Vec::new);
    columns.iter_mut().zip(row).for_each(|(column, value)| column.push(*value));
}

fn slices<T>(columns: &[Vec<T>], first: usize, rows: usize) -> Vec<&[T]> {
    let rows = first..first.saturating_add(rows);
    columns.iter().map(|column| column.get(rows.clone()).unwrap_or_default()).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use model_dsl::source::SourceFile;

    use super::*;
    use crate::calibrated;

    /// A machine with all that is remembered: a play that winds up, a filter and a curve; and, with rotary axes, the tool's direction.
    fn machine() -> Calibrated {
        let text = "calibration: 1
machine: trunnion-5axis
constants: {Ya: 1 mm, Za: 2 mm, Xc: 3 mm, Yc: 4 mm, Zc: 50 mm, Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}
errors:
  EXX: [{backlash: {lost_motion: 10 um, wind_up: 0.5 mm}}]
  EZZ: [{growth: {sensor: spindle, coefficient: 2 um/K, reference: 20 degC, time_constant: 600 s}}]
  EBX: [{polynomial: {axis: X, per: mm, unit: arcsec, coefficients: [0, 0.1, 1e-3]}}]
";
        calibrated::of(SourceFile::new("c.yaml", text), Some(Path::new(".")), &()).ok().unwrap()
    }

    /// Positions that go to and fro, more than two pieces of them.
    fn table(axes: usize, rows: usize) -> Table {
        let place = |axis: usize, row: usize| 20.0 * (0.013 * row as f64 * (1.0 + axis as f64)).sin();
        let of = |axis| (0..rows).map(|row| place(axis, row)).collect();
        Table {
            position: (0..axes).map(of).collect(),
            time: Some((0..rows).map(|row| 0.1 * row as f64).collect()),
            temperature: vec![(0..rows).map(|row| 20.0 + (0.001 * row as f64).sin()).collect()],
            ..Table::default()
        }
    }

    #[test]
    fn pieces_give_what_one_row_after_the_other_gives() {
        let calibrated = machine();
        let axes = calibrated.equations.axes.len();
        let (rows, hysteresis) = (2 * PIECE + 7, vec![0.001; axes]);
        let table = table(axes, rows);
        let wanted = Wanted { hysteresis: hysteresis.clone(), compensated: true, ..Wanted::default() };
        let answers = answer(&calibrated, &table, &wanted).ok().unwrap();
        assert_eq!((answers.outcomes.len(), answers.commands.len()), (rows, axes));

        let terms = calibrated.terms(|_| panic!("nothing is left out"));
        let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
        let machine = wanted.machine(&calibrated);
        let mut states = vec![TermState::default(); states_needed(&motions)];
        let (mut directions, mut values) = (vec![[0.0; 3]; axes], vec![0.0; motions.len()]);
        let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
        let mut compensator = Compensator::new(&machine, &motions, &mut states, work).unwrap();
        let mut leaning = Leaning::new(&calibrated.equations, &machine, &motions);
        let mut state =
            State::new(&calibrated.calibration, calibrated.equations.following(), true, &hysteresis);
        let (mut out, mut row) = (vec![0.0; axes], Buffers::default());
        for number in 0..rows {
            row.fill(&table, number);
            state.take(&row.row(Some(table.time.as_ref().unwrap()[number]))).unwrap();
            let outcome = compensator.compensate(&state.sample(), &mut out).unwrap();
            assert_eq!(outcome, answers.outcomes[number], "row {number}");
            let commands: Vec<f64> = answers.commands.iter().map(|column| column[number]).collect();
            assert_eq!(out, commands, "row {number}");
            if let Some(leaning) = &mut leaning {
                assert_eq!(leaning.take(&state.sample()).without, answers.leans[number], "row {number}");
            }
        }
    }

    #[test]
    fn the_first_row_that_cannot_be_is_told() {
        let calibrated = machine();
        let axes = calibrated.equations.axes.len();
        let wanted = Wanted { hysteresis: vec![0.001; axes], compensated: true, ..Wanted::default() };
        let told = |table: &Table| match answer(&calibrated, table, &wanted) {
            Err(failure) => failure.words().unwrap().text(false),
            Ok(_) => panic!("it was answered"),
        };
        let mut back = table(axes, 10);
        back.time = Some((0..10).map(|row| if row == 4 { 0.0 } else { f64::from(row) }).collect());
        assert_eq!(told(&back), "error: row 4, counted from 0: the time goes back by 3 s");
        let mut lost = table(axes, 10);
        lost.position[1][6] = f64::NAN;
        assert!(told(&lost).starts_with("error: row 6, counted from 0: "), "{}", told(&lost));
    }
}
