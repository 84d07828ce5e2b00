//! Curves of one axis that lie side by side.
//!
//! In: terms that are tables over the same even nodes of the same axis, known when the code is compiled. Out: all their values at
//! a position. It exists because the error motions of an axis are mostly measured at the same places: what stands side by side is
//! found once, chosen by direction once, and read as one row, which a vector unit takes several numbers of at a time.

use super::super::real::Real;
use super::super::{Direction, Term};
use super::place::Even;
use super::{Nodes, Table, TableError};

/// Tables over the same even nodes of one axis, a row for each node: what each table is there, and by how much it rises to the next
/// one, which then need not be found when it is read.
///
/// It reads what its tables read, bit for bit.
///
/// ```
/// use abbe_runtime::{Bundle, Table, TableError, Term, Values};
/// let exx = Table::uniform(0.0, 50.0, Values::Both(&[0.0, 0.002, 0.003]))?;
/// let eyx = Table::uniform(0.0, 50.0, Values::Both(&[0.001, 0.0, 0.001]))?;
/// let terms = [exx, eyx].map(|table| Term::Table { axis: 0, table });
/// assert!(Bundle::<2, 3>::new([&terms[0], &terms[1]]).is_ok());
/// let other = Term::Constant { value: 0.001 };
/// assert_eq!(Bundle::<2, 3>::new([&terms[0], &other]), Err(TableError::Unlike { index: 1 }));
/// # Ok::<(), TableError>(())
/// ```
#[derive(Clone, PartialEq, Debug)]
pub struct Bundle<const CURVES: usize, const ROWS: usize> {
    axis: usize,
    even: Even,
    /// Whether a curve depends on the direction of motion.
    directed: bool,
    /// For each node the curves of both directions, at [`FORWARD`] and [`REVERSE`].
    rows: [[Row<CURVES>; 2]; ROWS],
}

/// The places of the curves that are read while the last real motion was positive or negative.
const FORWARD: usize = 0;
const REVERSE: usize = 1;

/// Curves from a node to the next one; they rise by nothing from the last node on.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Row<const CURVES: usize> {
    values: Side<CURVES>,
    rises: Side<CURVES>,
}

/// Numbers side by side, of which a vector unit takes two at a time from where they lie.
#[derive(Clone, Copy, PartialEq, Debug)]
#[repr(align(16))]
struct Side<const CURVES: usize>([Real; CURVES]);

impl<const CURVES: usize, const ROWS: usize> Bundle<CURVES, ROWS> {
    /// Tables side by side, in their order.
    ///
    /// # Errors
    /// Refuses no table at all, a term that is not a table over the axis and the even nodes of the first, and another number of rows
    /// than that of the nodes.
    pub const fn new(terms: [&Term<'_>; CURVES]) -> Result<Self, TableError> {
        let [Term::Table { axis, table: Table { nodes: Nodes::Even(even), .. } }, ..] = terms.as_slice()
        else {
            return Err(if CURVES == 0 { TableError::Empty } else { TableError::Unlike { index: 0 } });
        };
        let expected = even.last.index().saturating_add(1);
        if ROWS != expected {
            return Err(TableError::Lengths { expected, found: ROWS });
        }
        let none = Row { values: Side([0.0; CURVES]), rises: Side([0.0; CURVES]) };
        let mut bundle = Self { axis: *axis, even: *even, directed: false, rows: [[none; 2]; ROWS] };
        let mut column = 0;
        while column < CURVES {
            let Some(table) = bundle.like(terms[column]) else {
                return Err(TableError::Unlike { index: column });
            };
            fill(&mut bundle.rows, FORWARD, column, table.forward);
            fill(&mut bundle.rows, REVERSE, column, table.reverse);
            bundle.directed |= differ(table.forward, table.reverse);
            column = column.saturating_add(1);
        }
        Ok(bundle)
    }

    /// The table of a term, if it is over the axis and the nodes of the bundle.
    const fn like<'t>(&self, term: &Term<'t>) -> Option<Table<'t>> {
        match term {
            Term::Table { axis, table } => match table.nodes {
                Nodes::Even(even) if *axis == self.axis && even.is(self.even) => Some(*table),
                Nodes::Even(_) | Nodes::At { .. } => None,
            },
            _ => None,
        }
    }

    /// The value of each table where its axis is, on the curves of its direction; none where there is no such axis.
    #[inline(always)]
    pub(crate) fn read(&self, position: &[Real], direction: &[Direction]) -> Option<[Real; CURVES]> {
        let side = match direction.get(self.axis)? {
            Direction::Negative if self.directed => REVERSE,
            Direction::Positive | Direction::Negative => FORWARD,
        };
        let (below, part) = self.even.place(*position.get(self.axis)?);
        let Row { values: Side(values), rises: Side(rises) } =
            self.rows.as_flattened().get(below.wrapping_mul(2) | side)?;
        let mut read = *values;
        for (value, rise) in read.iter_mut().zip(rises) {
            // What `between` does, which has the rise to find.
            *value += *rise * part;
        }
        Some(read)
    }
}

/// Writes a curve into a column of one side.
const fn fill<const CURVES: usize>(
    rows: &mut [[Row<CURVES>; 2]],
    side: usize,
    column: usize,
    mut curve: &[Real],
) {
    let mut row = 0;
    while let [value, later @ ..] = curve
        && row < rows.len()
    {
        rows[row][side].values.0[column] = *value;
        if let [next, ..] = later {
            rows[row][side].rises.0[column] = *next - *value;
        }
        curve = later;
        row = row.saturating_add(1);
    }
}

/// Whether numbers are others than these, which are as many.
const fn differ(mut numbers: &[Real], mut others: &[Real]) -> bool {
    while let ([number, numbers_after @ ..], [other, others_after @ ..]) = (numbers, others) {
        if number.to_bits() != other.to_bits() {
            return true;
        }
        (numbers, others) = (numbers_after, others_after);
    }
    false
}
