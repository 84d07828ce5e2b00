//! Reading curves with even steps.
//!
//! In: the position of an axis, and its direction. Out: the value there. It exists because the curves of an axis
//! mostly have the same nodes, so that a place that was found for one of them serves all.

use super::{Nodes, Table, between, read_at, within_a_turn};
use crate::Direction;

/// Even nodes: the first, how many of them there are for each mm or rad, and the last.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Even {
    pub(super) start: f64,
    pub(super) per_unit: f64,
    pub(super) last: Last,
}

/// The index of the last node, and whether what lies beyond it is read from the first one on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Last(usize);

impl Last {
    pub(super) const fn new(index: usize, repeats: bool) -> Self {
        // No table has half as many nodes as there are numbers.
        Self(index << 1 | repeats as usize)
    }

    #[inline(always)]
    pub(super) const fn index(self) -> usize {
        self.0 >> 1
    }

    #[inline(always)]
    const fn repeats(self) -> bool {
        self.0 & 1 == 1
    }
}

/// Where an axis lies between even nodes, and the direction in which it moves there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    axis: usize,
    even: Even,
    /// Indices of the nodes below and above; at the last node and beyond both are the last.
    below: usize,
    above: usize,
    /// The part of the way from one to the other, from 0 to less than 1; 0 beyond the ends.
    part: f64,
    direction: Direction,
}

impl Table<'_> {
    /// The value where an axis is, on the curve of its direction; NaN where there is no such axis.
    ///
    /// `known` is the place that another table found at the same position, if any, and is then this table's.
    #[inline(always)]
    pub(crate) fn read(
        &self,
        axis: usize,
        position: &[f64],
        direction: &[Direction],
        known: &mut Option<Place>,
    ) -> f64 {
        if let (Nodes::Even(even), Some(place)) = (self.nodes, &*known)
            && place.is(axis, even)
        {
            return place.read(self.curve(place.direction));
        }
        let (Some(&position), Some(&direction)) = (position.get(axis), direction.get(axis)) else {
            return f64::NAN;
        };
        self.read_anew(axis, position, direction, known)
    }

    /// [`read`](Self::read) where no place is known.
    #[inline(always)]
    fn read_anew(&self, axis: usize, position: f64, direction: Direction, known: &mut Option<Place>) -> f64 {
        let curve = self.curve(direction);
        match self.nodes {
            Nodes::Even(even) => known.insert(Place::new(even, axis, position, direction)).read(curve),
            Nodes::At { at, repeats } => read_at(curve, at, repeats, position),
        }
    }
}

impl Place {
    /// Whether this is the place of an axis between these nodes.
    #[inline(always)]
    fn is(&self, axis: usize, even: Even) -> bool {
        self.axis == axis && self.even.is(even)
    }

    #[inline(always)]
    pub(super) fn new(even: Even, axis: usize, position: f64, direction: Direction) -> Self {
        let (below, part) = even.place(position);
        let above = below.saturating_add(1).min(even.last.index());
        Self { axis, even, below, above, part, direction }
    }

    /// Reads a curve.
    #[inline]
    pub(super) fn read(&self, curve: &[f64]) -> f64 {
        between(node(curve, self.below), node(curve, self.above), self.part)
    }
}

impl Even {
    /// Whether these are the same nodes.
    #[inline(always)]
    pub(super) const fn is(self, other: Self) -> bool {
        // Bits compare faster than numbers; none of these is NaN.
        self.start.to_bits() == other.start.to_bits()
            && self.per_unit.to_bits() == other.per_unit.to_bits()
            && self.last.0 == other.last.0
    }

    /// The index of the node below a position, not above the last one, and what is left of a step from there; NaN is left of NaN.
    #[inline(always)]
    pub(super) fn place(self, position: f64) -> (usize, f64) {
        let count = self.count(position);
        let last = self.last.index();
        let count = if self.last.repeats() { within_a_turn(count, last as f64) } else { count };
        let (below, part) = split(count);
        if below < last {
            (below, part)
        } else {
            core::hint::cold_path();
            (if count < 0.0 { 0 } else { last }, count.clamp(0.0, 0.0))
        }
    }

    /// How many steps a position lies behind the first node.
    #[inline]
    const fn count(self, position: f64) -> f64 {
        (position - self.start) * self.per_unit
    }
}

/// The value at a node.
#[inline]
fn node(curve: &[f64], index: usize) -> f64 {
    curve.get(index).copied().unwrap_or(f64::NAN)
}

/// The number of even nodes that a table may have: as many as [`split`] tells apart.
pub(super) const MOST: usize = 1 << 24;

/// A sum of it and a smaller number has 28 binary digits behind the point, in the last of its bits.
const FIXED: f64 = MOST as f64;

/// The bits of these digits.
const FRACTION: u64 = (1 << 28) - 1;

/// The greatest whole number that is not above a number of steps, and what is left of it. What is no more than 2^-29 below a whole number
/// is that number. What is further below zero, too large or NaN gives a whole number from [`MOST`] on.
#[inline]
fn split(number: f64) -> (usize, f64) {
    let bits = (number + FIXED).to_bits();
    let left = number - (f64::from_bits(bits & !FRACTION) - FIXED);
    let whole = bits.wrapping_sub(FIXED.to_bits()) >> FRACTION.count_ones();
    (usize::try_from(whole).unwrap_or(usize::MAX), if left < 0.0 { 0.0 } else { left })
}
