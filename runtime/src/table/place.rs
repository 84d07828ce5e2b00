//! Reading curves with even steps.
//!
//! In: the position of an axis, and its direction. Out: the value there. It exists because the curves of an axis
//! mostly have the same nodes, so that a place that was found for one of them serves all.

use super::super::Direction;
use super::super::real::{Real, split};
use super::{Nodes, Table, between, read_at, within_a_turn};

/// Even nodes: the first, how many of them there are for each mm or rad, and the last.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Even {
    pub(super) start: Real,
    pub(super) per_unit: Real,
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
    part: Real,
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
        position: &[Real],
        direction: &[Direction],
        known: &mut Option<Place>,
    ) -> Real {
        if let (Nodes::Even(even), Some(place)) = (self.nodes, &*known)
            && place.is(axis, even)
        {
            return place.read(self.curve(place.direction));
        }
        let (Some(&position), Some(&direction)) = (position.get(axis), direction.get(axis)) else {
            return Real::NAN;
        };
        self.read_anew(axis, position, direction, known)
    }

    /// [`read`](Self::read) where no place is known.
    #[inline(always)]
    fn read_anew(
        &self,
        axis: usize,
        position: Real,
        direction: Direction,
        known: &mut Option<Place>,
    ) -> Real {
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
    pub(super) fn new(even: Even, axis: usize, position: Real, direction: Direction) -> Self {
        let (below, part) = even.place(position);
        let above = below.saturating_add(1).min(even.last.index());
        Self { axis, even, below, above, part, direction }
    }

    /// Reads a curve.
    #[inline]
    pub(super) fn read(&self, curve: &[Real]) -> Real {
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
    pub(super) fn place(self, position: Real) -> (usize, Real) {
        let count = self.count(position);
        let last = self.last.index();
        let count = if self.last.repeats() { within_a_turn(count, last as Real) } else { count };
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
    const fn count(self, position: Real) -> Real {
        (position - self.start) * self.per_unit
    }
}

/// The value at a node.
#[inline]
fn node(curve: &[Real], index: usize) -> Real {
    curve.get(index).copied().unwrap_or(Real::NAN)
}

/// The number of even nodes that a table may have: as many as [`split`] tells apart.
pub(super) const MOST: usize = 1 << 24;
