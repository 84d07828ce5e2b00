//! The product of finite matrices, in numbers: where errors take the tool, nothing linearised.
//!
//! In: equations with the values of their constants; then positions, travels and error motions in columns. Out: the error of
//! the tool tip and the rotation of the tool relative to the part, in the part's frame. The equations say the same to first
//! order in the error motions; this is for errors that are known, and whose products with one another count.
//!
//! The matrices are not multiplied out: the tip is carried from the tool to the bed and on to the part, link by link, and
//! what errors move it by is kept apart from where it stands, so that small errors keep all their digits.

mod step;
mod walk;

use std::iter;

use crate::equations::Equations;
use crate::machine::Branch;

use step::Step;
use walk::Stand;

/// A machine as the product of the matrices of its links, with numbers for its constants.
#[derive(Clone, Debug)]
pub struct ExactProduct {
    /// From the tool tip to the bed, and from there to the part.
    steps: Vec<Step>,
    sensitive: [bool; 3],
}

/// What error motions do to the tool, a number for each row.
#[derive(Clone, Debug, PartialEq)]
pub struct Displaced {
    /// The error of the tool tip relative to the part: X, Y, Z, mm; 0 in directions that are not sensitive.
    pub tip: [Vec<f64>; 3],
    /// The rotation vector of the tool relative to the part: rad about X, Y, Z; where it was asked for.
    pub turn: Option<[Vec<f64>; 3]>,
}

/// The states of the machine in some rows: columns of one length, by the numbers of the equations. What a column lacks is NaN.
#[derive(Clone, Copy, Debug)]
pub struct Columns<'c> {
    /// The position of every axis: mm or rad.
    pub positions: &'c [&'c [f64]],
    /// The free travels: mm.
    pub travels: &'c [&'c [f64]],
    /// The error motions: mm or rad; `None` where one is zero in all rows.
    pub motions: &'c [Option<&'c [f64]>],
}

impl ExactProduct {
    /// Prepares a machine with the values of its constants (mm), in the order of its equations.
    pub fn new(equations: &Equations, constants: &[f64]) -> Self {
        let steps = |branch: Branch| {
            let links = equations.links.iter().enumerate().filter(move |(_, link)| link.branch == branch);
            links.flat_map(|(number, link)| step::of_link(equations, number, link, constants))
        };
        let inwards: Vec<Step> = steps(Branch::Tool).collect();
        let to_part = steps(Branch::Workpiece).map(Step::inverse);
        let mut sensitive = [false; 3];
        equations.rows.iter().for_each(|row| sensitive[row.direction.index()] = true);
        Self { steps: inwards.into_iter().rev().chain(to_part).collect(), sensitive }
    }

    /// The error of the tip in every row, and the rotation of the tool where it is `turning` that counts.
    pub fn displaced(&self, columns: &Columns<'_>, turning: bool) -> Displaced {
        let mut stands = vec![Stand::default(); columns.rows()];
        for step in &self.steps {
            step.take(columns, turning, &mut stands);
        }
        let tip = |d: usize| match self.sensitive[d] {
            true => stands.iter().map(|stand| stand.away[d]).collect(),
            false => vec![0.0; stands.len()],
        };
        let turn = turning.then(|| {
            let turns: Vec<[f64; 3]> = stands.iter().map(|stand| stand.turned.rotation_vector()).collect();
            [0, 1, 2].map(|d| turns.iter().map(|turn| turn[d]).collect())
        });
        Displaced { tip: [tip(0), tip(1), tip(2)], turn }
    }
}

impl<'c> Columns<'c> {
    fn rows(&self) -> usize {
        let motions = self.motions.iter().flatten();
        let columns = self.positions.iter().chain(self.travels).chain(motions);
        columns.map(|column| column.len()).max().unwrap_or_default()
    }

    fn position(&self, axis: usize) -> impl Iterator<Item = f64> + use<'c> {
        endless(self.positions.get(axis).copied().unwrap_or_default())
    }

    fn travel(&self, number: usize) -> impl Iterator<Item = f64> + use<'c> {
        endless(self.travels.get(number).copied().unwrap_or_default())
    }

    /// Nothing where the motion is zero in all rows.
    fn motion(&self, number: usize) -> Option<impl Iterator<Item = f64> + use<'c>> {
        self.motions.get(number).copied().flatten().map(endless)
    }
}

fn endless(column: &[f64]) -> impl Iterator<Item = f64> {
    column.iter().copied().chain(iter::repeat(f64::NAN))
}
