//! Running a machine from its equations. In: its programs, and positions one by one or in columns. Out: nominal
//! positions, errors, lever arms, turns and the direction of the tool as numbers, the same bits either way.

use std::borrow::Cow;

use abbe_runtime::math::sin_cos;
use abbe_runtime::{Kinematics, Share, Turning};

use super::{Column, Input, OrientationPrograms, Programs, Tape};
use crate::equations::Equations;

/// A machine that is run from its programs, without generated code: slower, and the same numbers.
#[derive(Clone, Debug)]
pub struct Interpreter {
    nominal: Tape,
    error: Tape,
    levers: Tape,
    turns: Tape,
    directions: Tape,
    orientation: Option<Orientation>,
    constants: Vec<f64>,
    travels: Vec<usize>,
    rotary: Vec<bool>,
    resting: Vec<bool>,
    turning: Vec<Turning>,
    following: Vec<Share>,
    squaring: Vec<Share>,
    aiming: Vec<usize>,
    squares: Option<[f64; 3]>,
    motions: usize,
}

/// The direction of the tool, its error, and what axes turn it by.
#[derive(Clone, Debug)]
struct Orientation {
    nominal: Tape,
    error: Tape,
    aims: Tape,
}

impl Orientation {
    fn new(programs: &OrientationPrograms) -> Self {
        let OrientationPrograms { nominal, error, aims } = programs;
        Self { nominal: Tape::new(nominal), error: Tape::new(error), aims: Tape::new(aims) }
    }
}

impl Interpreter {
    /// Prepares a machine with the values of its constants (mm), in the order of its equations.
    pub fn new(equations: &Equations, constants: &[f64]) -> Self {
        let programs = Programs::new(equations);
        Self {
            nominal: Tape::new(&programs.nominal),
            error: Tape::new(&programs.error),
            levers: Tape::new(&programs.levers),
            turns: Tape::new(&programs.turns),
            directions: Tape::new(&programs.directions),
            orientation: programs.orientation.as_ref().map(Orientation::new),
            constants: constants.to_vec(),
            travels: equations.travels.iter().map(|travel| travel.axis).collect(),
            rotary: equations.axes.iter().map(|axis| axis.rotary).collect(),
            resting: equations.resting(),
            turning: equations.turning(),
            following: equations.following(),
            squaring: equations.squaring(),
            aiming: equations.aiming(),
            squares: equations.squares(),
            motions: equations.motions.len(),
        }
    }

    /// The same machine, whose rotary axes leave the direction of the tool as it is.
    #[must_use]
    pub fn leaving_direction(self) -> Self {
        Self { aiming: Vec::new(), ..self }
    }

    /// The nominal tool tip relative to the part: mm, part frame, 0 where not sensitive.
    pub fn nominal(&self, position: &[f64]) -> [f64; 3] {
        triple(&self.run(&self.nominal, position, &[], &[]))
    }

    /// The lever arm of every error motion: X, Y, Z for each.
    pub fn levers(&self, position: &[f64], travel: &[f64]) -> Vec<[f64; 3]> {
        self.run(&self.levers, position, travel, &[]).chunks(3).map(triple).collect()
    }

    /// What every error motion turns the tool relative to the part by, rad for each rad of it, right-handed about X, Y,
    /// Z of the part's frame; 0 for displacements.
    pub fn turns(&self, position: &[f64], travel: &[f64]) -> Vec<[f64; 3]> {
        self.run(&self.turns, position, travel, &[]).chunks(3).map(triple).collect()
    }

    /// The direction of the tool without errors, from its tip towards the spindle: I, J, K in the part's frame, pure numbers, a vector of
    /// length 1. None where the machine file does not request it (`orientation: true`).
    pub fn direction(&self, position: &[f64]) -> Option<[f64; 3]> {
        Some(triple(&self.run(&self.orientation.as_ref()?.nominal, position, &[], &[])))
    }

    /// The error of that direction to first order, actual minus nominal: I, J, K in rad, square to the direction. NaN for a slice of the
    /// wrong length; none where the machine file does not ask for the direction.
    pub fn direction_error(&self, position: &[f64], travel: &[f64], motions: &[f64]) -> Option<[f64; 3]> {
        Some(self.sum_in(&self.orientation.as_ref()?.error, position, travel, motions))
    }

    /// [`Interpreter::nominal`] of many positions: a column for each of X, Y, Z.
    ///
    /// `positions` holds a column for each axis, in their order. There are as many rows as the longest column has; what a
    /// shorter one lacks is NaN. The same holds of the travels of the functions below.
    pub fn nominal_columns(&self, positions: &[&[f64]]) -> [Vec<f64>; 3] {
        let columns = self.run_columns(&self.nominal, positions, &[]);
        let mut triples = written_out(triples(columns), rows(positions, &[]));
        triples.pop().unwrap_or_default()
    }

    /// [`Interpreter::levers`] of many positions: for every error motion a column for each of X, Y, Z.
    ///
    /// A thousand rows or a few in a call are best: every step runs over all of them, and its column should stay in a
    /// cache. Most of the time goes into writing out numbers that are the same in every row, and mostly 0:
    /// [`Interpreter::lever_values`] does not.
    pub fn lever_columns(&self, positions: &[&[f64]], travels: &[&[f64]]) -> Vec<[Vec<f64>; 3]> {
        written_out(self.lever_values(positions, travels), rows(positions, travels))
    }

    /// [`Interpreter::turns`] of many positions: for every error motion a column for each of X, Y, Z.
    pub fn turn_columns(&self, positions: &[&[f64]], travels: &[&[f64]]) -> Vec<[Vec<f64>; 3]> {
        written_out(self.turn_values(positions, travels), rows(positions, travels))
    }

    /// The same as [`Interpreter::lever_columns`], a number where a lever arm is the same in every row.
    pub fn lever_values<'p>(&self, positions: &[&'p [f64]], travels: &[&'p [f64]]) -> Vec<[Column<'p>; 3]> {
        triples(self.run_columns(&self.levers, positions, travels))
    }

    /// The same as [`Interpreter::turn_columns`], a number where a turn is the same in every row.
    pub fn turn_values<'p>(&self, positions: &[&'p [f64]], travels: &[&'p [f64]]) -> Vec<[Column<'p>; 3]> {
        triples(self.run_columns(&self.turns, positions, travels))
    }

    /// A sum over the error motions; NaN for a slice of the wrong length.
    fn sum_in(&self, tape: &Tape, position: &[f64], travel: &[f64], motions: &[f64]) -> [f64; 3] {
        let lengths = (position.len(), travel.len(), motions.len());
        if lengths != (self.rotary.len(), self.travels.len(), self.motions) {
            return [f64::NAN; 3];
        }
        triple(&self.run(tape, position, travel, motions))
    }

    fn run(&self, tape: &Tape, position: &[f64], travel: &[f64], motions: &[f64]) -> Vec<f64> {
        let turn = |(angle, rotary): (&f64, &bool)| if *rotary { sin_cos(*angle) } else { (0.0, 1.0) };
        let turns: Vec<(f64, f64)> = match self.rotary.contains(&true) {
            true => position.iter().zip(&self.rotary).map(turn).collect(),
            false => Vec::new(),
        };
        let or_nan = |values: &[f64], number: usize| values.get(number).copied().unwrap_or(f64::NAN);
        tape.run(|input| match input {
            Input::Position(axis) => or_nan(position, axis),
            Input::Travel(number) => or_nan(travel, number),
            Input::Constant(number) => self.constants.get(number).copied().unwrap_or(f64::NAN),
            Input::Cos(axis) => turns.get(axis).map_or(f64::NAN, |(_, cosine)| *cosine),
            Input::Sin(axis) => turns.get(axis).map_or(f64::NAN, |(sine, _)| *sine),
            Input::Motion(motion) => or_nan(motions, motion),
        })
    }

    fn run_columns<'p>(
        &self,
        tape: &Tape,
        positions: &[&'p [f64]],
        travels: &[&'p [f64]],
    ) -> Vec<Column<'p>> {
        let rows = rows(positions, travels);
        let turn =
            |(angles, rotary): (&&[f64], &bool)| if *rotary { turned(angles) } else { Default::default() };
        let turns: Vec<(Vec<f64>, Vec<f64>)> = positions.iter().zip(&self.rotary).map(turn).collect();
        let whole =
            |column: Option<&'p [f64]>| column.map_or(Column::Same(f64::NAN), |known| filled(known, rows));
        let owned = |column: Option<&Vec<f64>>| {
            column.map_or(Column::Same(f64::NAN), |known| {
                Column::Rows(filled(known, rows).written_out(rows).into())
            })
        };
        tape.run_columns(|input| match input {
            Input::Position(axis) => whole(positions.get(axis).copied()),
            Input::Travel(number) => whole(travels.get(number).copied()),
            Input::Constant(number) => Column::Same(self.constants.get(number).copied().unwrap_or(f64::NAN)),
            Input::Cos(axis) => owned(turns.get(axis).map(|(_, cosines)| cosines)),
            Input::Sin(axis) => owned(turns.get(axis).map(|(sines, _)| sines)),
            Input::Motion(_) => Column::Same(f64::NAN),
        })
    }
}

/// How many rows columns have: those of the longest.
fn rows(positions: &[&[f64]], travels: &[&[f64]]) -> usize {
    positions.iter().chain(travels).map(|column| column.len()).max().unwrap_or_default()
}

/// A column of so many rows: NaN in those that it lacks.
fn filled(column: &[f64], rows: usize) -> Column<'_> {
    if column.len() == rows {
        return Column::Rows(Cow::Borrowed(column));
    }
    let missing = std::iter::repeat_n(f64::NAN, rows.saturating_sub(column.len()));
    Column::Rows(Cow::Owned(column.iter().copied().chain(missing).collect()))
}

/// The sines and cosines of a column of angles.
fn turned(angles: &[f64]) -> (Vec<f64>, Vec<f64>) {
    angles.iter().map(|angle| sin_cos(*angle)).unzip()
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
        self.sum_in(&self.error, position, travel, motions)
    }

    fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
        let all = self.run(&self.directions, position, &[], &[]);
        for (slot, values) in directions.iter_mut().zip(all.chunks(3)) {
            *slot = triple(values);
        }
    }

    fn directions_vary(&self) -> bool {
        self.directions.reads_axes()
    }

    fn resting(&self) -> &[bool] {
        &self.resting
    }

    fn turning(&self) -> &[Turning] {
        &self.turning
    }

    fn following(&self) -> &[Share] {
        &self.following
    }

    fn squaring(&self) -> &[Share] {
        &self.squaring
    }

    fn squares(&self) -> Option<[f64; 3]> {
        self.squares
    }

    fn aiming(&self) -> &[usize] {
        &self.aiming
    }

    fn nominal(&self, position: &[f64]) -> [f64; 3] {
        Self::nominal(self, position)
    }

    fn direction(&self, position: &[f64]) -> [f64; 3] {
        Self::direction(self, position).unwrap_or([f64::NAN; 3])
    }

    fn direction_error(&self, position: &[f64], travel: &[f64], motions: &[f64]) -> [f64; 3] {
        Self::direction_error(self, position, travel, motions).unwrap_or([f64::NAN; 3])
    }

    fn aims(&self, position: &[f64], aims: &mut [[f64; 3]; 3]) {
        let found = self.orientation.as_ref().map(|own| self.run(&own.aims, position, &[], &[]));
        *aims = [[0.0; 3]; 3];
        for (slot, values) in aims.iter_mut().zip(found.unwrap_or_default().chunks(3)) {
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

/// Columns by threes.
fn triples(columns: Vec<Column<'_>>) -> Vec<[Column<'_>; 3]> {
    let mut columns = columns.into_iter();
    let mut triples = Vec::with_capacity(columns.len() / 3);
    while let (Some(x), Some(y), Some(z)) = (columns.next(), columns.next(), columns.next()) {
        triples.push([x, y, z]);
    }
    triples
}

fn written_out(triples: Vec<[Column<'_>; 3]>, rows: usize) -> Vec<[Vec<f64>; 3]> {
    triples.into_iter().map(|triple| triple.map(|column| column.written_out(rows))).collect()
}
