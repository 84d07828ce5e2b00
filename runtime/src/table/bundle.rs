//! Curves of one axis that lie side by side.
//!
//! In: terms that are tables over the same even nodes of the same axis, known when the code is compiled. Out: all their values at
//! a position. It exists because the error motions of an axis are mostly measured at the same places: what stands side by side is
//! found once, chosen by direction once, and read as one row, which a vector unit takes several numbers of at a time.

use super::place::Even;
use super::{Nodes, Table, TableError, between};
use crate::{Direction, Term};

/// Tables over the same even nodes of one axis, a row for each node and one more: the last row stands twice, so that every node
/// has one above it.
///
/// It reads what its tables read, bit for bit.
///
/// ```
/// use abbe_runtime::{Bundle, Table, TableError, Term, Values};
/// let exx = Table::uniform(0.0, 50.0, Values::Both(&[0.0, 0.002, 0.003]))?;
/// let eyx = Table::uniform(0.0, 50.0, Values::Both(&[0.001, 0.0, 0.001]))?;
/// let terms = [exx, eyx].map(|table| Term::Table { axis: 0, table });
/// assert!(Bundle::<2, 4>::new([&terms[0], &terms[1]]).is_ok());
/// let other = Term::Constant { value: 0.001 };
/// assert_eq!(Bundle::<2, 4>::new([&terms[0], &other]), Err(TableError::Unlike { index: 1 }));
/// # Ok::<(), TableError>(())
/// ```
#[derive(Clone, PartialEq, Debug)]
pub struct Bundle<const CURVES: usize, const ROWS: usize> {
    axis: usize,
    even: Even,
    /// Whether a curve depends on the direction of motion.
    directed: bool,
    forward: [[f64; CURVES]; ROWS],
    reverse: [[f64; CURVES]; ROWS],
}

impl<const CURVES: usize, const ROWS: usize> Bundle<CURVES, ROWS> {
    /// Tables side by side, in their order.
    ///
    /// # Errors
    /// Refuses no table at all, a term that is not a table over the axis and the even nodes of the first, and another number of rows
    /// than that of the nodes and one.
    pub const fn new(terms: [&Term<'_>; CURVES]) -> Result<Self, TableError> {
        let [Term::Table { axis, table: Table { nodes: Nodes::Even(even), .. } }, ..] = terms.as_slice()
        else {
            return Err(if CURVES == 0 { TableError::Empty } else { TableError::Unlike { index: 0 } });
        };
        let expected = even.last.saturating_add(2);
        if ROWS != expected {
            return Err(TableError::Lengths { expected, found: ROWS });
        }
        let none = [[0.0; CURVES]; ROWS];
        let mut bundle = Self { axis: *axis, even: *even, directed: false, forward: none, reverse: none };
        let mut column = 0;
        while column < CURVES {
            let Some(table) = bundle.like(terms[column]) else {
                return Err(TableError::Unlike { index: column });
            };
            fill(&mut bundle.forward, column, table.forward);
            fill(&mut bundle.reverse, column, table.reverse);
            column = column.saturating_add(1);
        }
        bundle.directed = differ(bundle.forward.as_flattened(), bundle.reverse.as_flattened());
        Ok(bundle)
    }

    /// The table of a term, if it is over the axis and the nodes of the bundle.
    const fn like<'t>(&self, term: &Term<'t>) -> Option<Table<'t>> {
        match term {
            Term::Table { axis, table } => match table.nodes {
                Nodes::Even(even) if *axis == self.axis && even.is(self.even) => Some(*table),
                Nodes::Even(_) | Nodes::At(_) => None,
            },
            _ => None,
        }
    }

    /// The value of each table where its axis is, on the curves of its direction; none where there is no such axis.
    #[inline(always)]
    pub(crate) fn read(&self, position: &[f64], direction: &[Direction]) -> Option<[f64; CURVES]> {
        let rows = match direction.get(self.axis)? {
            Direction::Negative if self.directed => &self.reverse,
            Direction::Positive | Direction::Negative => &self.forward,
        };
        let (below, part) = self.even.place(*position.get(self.axis)?);
        let [low, high] = rows.get(below..)?.first_chunk()?;
        let mut values = *low;
        for (value, high) in values.iter_mut().zip(high) {
            *value = between(*value, *high, part);
        }
        Some(values)
    }
}

/// Writes a curve into a column, its last value into all rows beyond it.
const fn fill<const CURVES: usize>(rows: &mut [[f64; CURVES]], column: usize, mut curve: &[f64]) {
    let mut row = 0;
    while row < rows.len() {
        if let [value, later @ ..] = curve {
            rows[row][column] = *value;
            curve = if later.is_empty() { curve } else { later };
        }
        row = row.saturating_add(1);
    }
}

/// Whether numbers are others than these, which are as many.
const fn differ(mut numbers: &[f64], mut others: &[f64]) -> bool {
    while let ([number, numbers_after @ ..], [other, others_after @ ..]) = (numbers, others) {
        if number.to_bits() != other.to_bits() {
            return true;
        }
        (numbers, others) = (numbers_after, others_after);
    }
    false
}
