//! A table of positions that is in memory, answered at once. In: columns of positions and of what else is known in each row. Out: for
//! each row the error and the compensated position.

use abbe_runtime::{Direction, ErrorMotion, Outcome, Refusal};

use super::{Answer, Answering, FARTHEST, Row, Samples, State, timed};
use crate::calibrated::Calibrated;
use crate::failure::Failure;

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
/// Terms that cannot be compensated; the first row that cannot be, by its number counted from 0, or whose position is beyond
/// [`FARTHEST`].
pub fn answer(calibrated: &Calibrated, table: &Table, wanted: &Wanted) -> Result<Answers, Failure> {
    if !wanted.left_out {
        calibrated.refuse_uncompensable()?;
    }
    let needed = if table.time.is_none() { timed(&calibrated.calibration) } else { None };
    let mut warnings: Vec<String> = needed.and_then(|needed| needed.standing()).into_iter().collect();
    let terms = calibrated.terms(|left_out| warnings.push(left_out));
    let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
    let mut answering = Answering::new(calibrated, &motions);
    answering.compensated = wanted.compensated;
    let samples = follow(calibrated, &motions, table, wanted)?;
    let begin = || (Answers::new(calibrated.equations.axes.len()), None);
    let pieces =
        answering.answer(&samples, begin, |(answers, refusal), row, answer| match answer.outcome {
            Ok(outcome) => {
                answers.push(outcome, answer);
                true
            }
            Err(why) => {
                *refusal = Some(refused(row, &why));
                false
            }
        })?;
    let mut all = Answers::new(calibrated.equations.axes.len());
    all.warnings = warnings;
    for (piece, refusal) in pieces {
        if let Some(refusal) = refusal {
            return Err(refusal);
        }
        all.append(piece);
    }
    Ok(all)
}

impl Answers {
    fn new(axes: usize) -> Self {
        Self { commands: vec![Vec::new(); axes], ..Self::default() }
    }

    fn push(&mut self, outcome: Outcome, answer: &Answer<'_>) {
        self.commands.iter_mut().zip(answer.command).for_each(|(column, place)| column.push(*place));
        self.outcomes.push(outcome);
        self.leans.extend(answer.lean.map(|lean| lean.without));
    }

    fn append(&mut self, piece: Self) {
        self.commands.iter_mut().zip(piece.commands).for_each(|(all, own)| all.extend(own));
        self.outcomes.extend(piece.outcomes);
        self.leans.extend(piece.leans);
    }
}

/// Takes the state of the machine along, from the first row to the last.
fn follow<'m>(
    calibrated: &Calibrated,
    motions: &'m [ErrorMotion<'m>],
    table: &Table,
    wanted: &Wanted,
) -> Result<Samples<'m>, Failure> {
    let calibration = &calibrated.calibration;
    let motors = calibrated.equations.following();
    let mut state = State::new(calibration, motors, timed(calibration).is_some(), &wanted.hysteresis);
    let mut samples = Samples::new(motions);
    let mut row = Buffers::default();
    for number in 0..table.position.first().map_or(0, Vec::len) {
        row.fill(table, number);
        if let Some(axis) = row.position.iter().position(|place| place.abs() > FARTHEST) {
            let letter = calibrated.equations.axes.get(axis).map_or("", |axis| &axis.letter);
            let why = format!("the position of {letter} is farther than any machine reaches; check the unit");
            return Err(refused(number, &why));
        }
        let taken = state.take(&row.row(table.time.as_ref().and_then(|time| time.get(number)).copied()));
        taken.map_err(|mistake| refused(number, &mistake))?;
        let sample = state.sample();
        if !sample.is_finite() {
            return Err(refused(number, &Refusal::NotFinite));
        }
        samples.push(&sample, wanted.tool);
    }
    Ok(samples)
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use abbe_runtime::{Compensator, TermState, Work, states_needed};
    use model_dsl::program::Interpreter;
    use model_dsl::source::SourceFile;

    use super::*;
    use crate::calibrated;
    use crate::rows::leaning::Leaning;
    use crate::rows::samples::PIECE;

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
        let machine = Interpreter::new(&calibrated.equations, &calibrated.calibration.constants);
        let mut states = vec![TermState::default(); states_needed(&motions)];
        let (mut directions, mut values) = (vec![[0.0; 3]; axes], vec![0.0; motions.len()]);
        let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
        let mut compensator = Compensator::new(&machine, &motions, &mut states, work).unwrap();
        let mut leaning = Leaning::new(&calibrated.equations, &motions);
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
                assert_eq!(
                    leaning.take(&machine, &state.sample()).without,
                    answers.leans[number],
                    "row {number}"
                );
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
        assert_eq!(told(&back), "error: row 4, counted from 0: the time decreases by 3 s");
        let mut lost = table(axes, 10);
        lost.position[1][6] = f64::NAN;
        assert!(told(&lost).starts_with("error: row 6, counted from 0: "), "{}", told(&lost));
    }

    #[test]
    fn a_position_beyond_any_machine_is_refused_with_its_row_and_axis() {
        let calibrated = machine();
        let mut table = table(calibrated.equations.axes.len(), 5);
        table.position[1][3] = -2e12;
        let failure = answer(&calibrated, &table, &Wanted::default()).err().unwrap();
        let told = failure.words().unwrap().text(false);
        assert!(
            told.contains("row 3, counted from 0: the position of Y is farther than any machine"),
            "{told}"
        );
    }
}
