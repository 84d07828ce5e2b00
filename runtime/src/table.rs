//! Measured curves: piecewise linear tables, one for both directions of motion or one for each.
//!
//! In: nodes and values, borrowed and checked once. Out: the value at a position, held constant outside the table. It
//! exists because most published calibrations are tables, and the controller must read them in bounded time.

mod bundle;
mod place;

use core::fmt;

use super::Direction;
use super::math::{all_finite, floor};
use super::real::Real;

pub use self::bundle::Bundle;
pub(crate) use self::place::Place;
use self::place::{Even, Last, MOST};

/// The values of a table at its nodes: one curve, or one for each direction of motion.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Values<'a> {
    /// One curve for both directions.
    Both(&'a [Real]),
    /// A curve for each direction, over the same nodes.
    Directed {
        /// Values while the last real motion was positive.
        forward: &'a [Real],
        /// Values while the last real motion was negative.
        reverse: &'a [Real],
    },
}

impl<'a> Values<'a> {
    /// The curve of a direction.
    const fn curve(self, direction: Direction) -> &'a [Real] {
        match (self, direction) {
            (Self::Both(values), _)
            | (Self::Directed { forward: values, .. }, Direction::Positive)
            | (Self::Directed { reverse: values, .. }, Direction::Negative) => values,
        }
    }
}

impl<'a> From<&'a [Real]> for Values<'a> {
    fn from(values: &'a [Real]) -> Self {
        Self::Both(values)
    }
}

/// Why a table was refused.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TableError {
    /// There is no value.
    Empty,
    /// Two slices that belong together differ in length.
    Lengths {
        /// The length asked for: that of the nodes, or of the forward curve.
        expected: usize,
        /// The length found.
        found: usize,
    },
    /// There are more than 2^24 even nodes.
    TooLong,
    /// The step between nodes is not finite, or so near to zero that its inverse is not.
    Step,
    /// A node does not lie above the one before it.
    NotAscending {
        /// Index of that node.
        index: usize,
    },
    /// A start, a node or a value is NaN or infinite.
    NotFinite,
    /// A table of one node cannot repeat itself.
    Lone,
    /// In a [`Bundle`], a term is not a table over the axis and the even nodes of the first.
    Unlike {
        /// Index of that term.
        index: usize,
    },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "the table has no values"),
            Self::Lengths { expected, found } => {
                write!(f, "the table needs {expected} values in each curve, found {found}")
            }
            Self::TooLong => write!(f, "the table has more than {MOST} even nodes"),
            Self::Step => write!(f, "the step between nodes is zero, close to zero or not finite"),
            Self::NotAscending { index } => {
                write!(f, "node {index} (counted from 0) is not above the one before it")
            }
            Self::NotFinite => write!(f, "a start, a node or a value is not a finite number"),
            Self::Lone => write!(f, "a table of one node cannot repeat"),
            Self::Unlike { index } => {
                write!(
                    f,
                    "term {index} (counted from 0) is not a table over the axis and the even nodes of the first"
                )
            }
        }
    }
}

impl core::error::Error for TableError {}

/// Where the nodes of a table lie.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Nodes<'a> {
    Even(Even),
    At {
        at: &'a [Real],
        /// Whether the table repeats itself after its last node.
        repeats: bool,
    },
}

/// A piecewise linear curve over the position of an axis, held constant outside its nodes, or [repeated](Self::repeating).
///
/// ```
/// use abbe_runtime::{Direction, Table, Values};
/// let table = Table::uniform(0.0, 55.0, Values::Both(&[-0.0005, 0.005, 0.0115]))?;
/// assert_eq!(table.value(27.5, Direction::Positive), 0.00225);
/// assert_eq!(table.value(900.0, Direction::Positive), 0.0115);
/// # Ok::<(), abbe_runtime::TableError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Table<'a> {
    nodes: Nodes<'a>,
    /// One for each direction, so that reading them has nothing to decide; one curve for both stands twice.
    forward: &'a [Real],
    reverse: &'a [Real],
}

impl<'a> Table<'a> {
    /// A table whose nodes lie at `start`, `start + step`, `start + 2 step` and so on (mm or rad); read in constant time.
    /// The step may be negative: published tables run from 0 to -110 mm as well.
    ///
    /// # Errors
    /// Refuses a table without values or with more than 2^24, curves that differ in length, a step of zero or nearly so (its
    /// inverse must be finite) and numbers that are not finite.
    pub const fn uniform(start: Real, step: Real, values: Values<'a>) -> Result<Self, TableError> {
        // Reading multiplies, which takes less time than to divide.
        let per_unit = 1.0 / step;
        if !step.is_finite() || !per_unit.is_finite() {
            return Err(TableError::Step);
        }
        if !start.is_finite() {
            return Err(TableError::NotFinite);
        }
        if let Err(error) = check_values(values, None) {
            return Err(error);
        }
        let nodes = values.curve(Direction::Positive).len();
        if nodes > MOST {
            return Err(TableError::TooLong);
        }
        let last = nodes.saturating_sub(1);
        Ok(Self::new(Nodes::Even(Even { start, per_unit, last: Last::new(last, false) }), values))
    }

    /// A table whose nodes lie at the positions `at` (mm or rad), strictly ascending; read by binary search.
    ///
    /// # Errors
    /// Refuses a table without values, slices that differ in length, nodes out of order and numbers that are not finite.
    pub const fn at(at: &'a [Real], values: Values<'a>) -> Result<Self, TableError> {
        if let Err(error) = check_values(values, Some(at.len())) {
            return Err(error);
        }
        if !all_finite(at) {
            return Err(TableError::NotFinite);
        }
        let (mut rest, mut index) = (at, 0_usize);
        while let [before, others @ ..] = rest {
            index = index.saturating_add(1);
            if let [node, ..] = others
                && *node <= *before
            {
                return Err(TableError::NotAscending { index });
            }
            rest = others;
        }
        Ok(Self::new(Nodes::At { at, repeats: false }, values))
    }

    /// The table, which begins again after its last node: over a rotary axis that turns on and on, or over a screw whose turns are
    /// alike. The last node is then the first one of the next turn; where their values differ, the table jumps there.
    ///
    /// ```
    /// use abbe_runtime::{Direction, Table, Values};
    /// let turn = Table::uniform(0.0, 90.0, Values::Both(&[0.0, 1.0, 2.0, 1.0, 0.0]))?.repeating()?;
    /// assert_eq!(turn.value(720.0 + 45.0, Direction::Positive), 0.5);
    /// assert_eq!(turn.value(-90.0, Direction::Positive), 1.0);
    /// # Ok::<(), abbe_runtime::TableError>(())
    /// ```
    ///
    /// # Errors
    /// Refuses a table of one node, which has no length to repeat.
    pub const fn repeating(self) -> Result<Self, TableError> {
        let nodes = match self.nodes {
            Nodes::Even(even) if even.last.index() > 0 => {
                Nodes::Even(Even { last: Last::new(even.last.index(), true), ..even })
            }
            Nodes::At { at, .. } if at.len() > 1 => Nodes::At { at, repeats: true },
            Nodes::Even(_) | Nodes::At { .. } => return Err(TableError::Lone),
        };
        Ok(Self { nodes, ..self })
    }

    const fn new(nodes: Nodes<'a>, values: Values<'a>) -> Self {
        let (forward, reverse) = (values.curve(Direction::Positive), values.curve(Direction::Negative));
        Self { nodes, forward, reverse }
    }

    /// The values while an axis moves in a direction.
    #[inline]
    const fn curve(&self, direction: Direction) -> &'a [Real] {
        match direction {
            Direction::Positive => self.forward,
            Direction::Negative => self.reverse,
        }
    }

    /// The value at a position, on the curve of the given direction; NaN at NaN.
    #[must_use]
    #[inline]
    pub fn value(&self, position: Real, direction: Direction) -> Real {
        match self.nodes {
            Nodes::Even(even) => Place::new(even, 0, position, direction).read(self.curve(direction)),
            Nodes::At { at, repeats } => read_at(self.curve(direction), at, repeats, position),
        }
    }
}

/// Checks the curves: not empty, of the same length (`expected`, where given), finite.
const fn check_values(values: Values<'_>, expected: Option<usize>) -> Result<(), TableError> {
    let (forward, reverse) = (values.curve(Direction::Positive), values.curve(Direction::Negative));
    let expected = match expected {
        Some(expected) => expected,
        None => forward.len(),
    };
    if forward.len() != expected {
        return Err(TableError::Lengths { expected, found: forward.len() });
    }
    if reverse.len() != expected {
        return Err(TableError::Lengths { expected, found: reverse.len() });
    }
    if expected == 0 {
        return Err(TableError::Empty);
    }
    if all_finite(forward) && all_finite(reverse) { Ok(()) } else { Err(TableError::NotFinite) }
}

/// Reads a curve over ascending nodes by binary search. Ends are held; NaN at NaN.
fn read_at(values: &[Real], at: &[Real], repeats: bool, position: Real) -> Real {
    if position.is_nan() {
        return Real::NAN;
    }
    let position = match (at.first(), at.last()) {
        (Some(first), Some(last)) if repeats => first + within_a_turn(position - first, last - first),
        _ => position,
    };
    let above = at.partition_point(|&node| node <= position);
    let Some(index) = above.checked_sub(1) else {
        return values.first().copied().unwrap_or(Real::NAN);
    };
    match (at.get(index), at.get(above), values.get(index), values.get(above)) {
        (Some(&from), Some(&to), Some(&low), Some(&high)) => {
            between(low, high, (position - from) / (to - from))
        }
        _ => values.last().copied().unwrap_or(Real::NAN),
    }
}

/// What is left of a way after all whole turns of a length: from 0 to that length, which rounding may reach; NaN at what is not finite.
#[inline]
fn within_a_turn(way: Real, length: Real) -> Real {
    way - length * floor(way / length)
}

/// Linear interpolation; exactly `low` at 0.
#[inline]
fn between(low: Real, high: Real, part: Real) -> Real {
    low + (high - low) * part
}
