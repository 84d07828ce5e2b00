//! Reading curves with even steps, at one position or at several side by side.
//!
//! In: positions of an axis, and the direction of each. Out: the values there. It exists because the curves of an axis
//! mostly have the same nodes, so that a place that was found for one of them serves all; and because branches and a cast
//! to an index are what keeps a processor from reading several side by side.

use super::{Nodes, Table, between, read_at};
use crate::{Direction, Lanes, Real};

/// 2^52: adding it to a number from 0 to 2^51 rounds that to a whole number, which stands in the last bits of the sum.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// The bits of a sum with [`WHOLE`] that hold the whole number.
const BITS: u64 = (1 << 52) - 1;

/// Where a position of an axis lies between even nodes, or where several of its positions do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Located<I, T> {
    axis: usize,
    nodes: Even,
    /// Indices of the nodes below and above; beyond the ends both are the end.
    below: I,
    above: I,
    /// The part of the way from one to the other, within [-1, 1].
    part: T,
}

/// Where one position lies.
pub(crate) type Place = Located<usize, f64>;

/// Where positions side by side lie.
pub(crate) type LanePlace = Located<[usize; Lanes::WIDTH], Lanes>;

/// Even nodes: start and step, to the bit, and the index of the last one.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Even {
    start: u64,
    step: u64,
    last: usize,
}

impl Table<'_> {
    /// The value at a position of an axis, on the curve of a direction; NaN at NaN.
    ///
    /// `known` is the place that another table found at the same positions, if any, and is then this table's.
    #[inline]
    pub(crate) fn read(
        &self,
        axis: usize,
        position: f64,
        direction: Direction,
        known: &mut Option<Place>,
    ) -> f64 {
        let curve = self.curve(direction);
        match self.nodes {
            Nodes::Uniform { start, step } => {
                self.place(axis, start, step, known, |nodes| Place::new(position, axis, nodes)).read(curve)
            }
            Nodes::At(at) => read_at(curve, at, position),
        }
    }

    /// The value in each lane, on the curve of its direction: [`read`](Self::read), bit for bit.
    pub(crate) fn read_lanes(
        &self,
        axis: usize,
        position: Lanes,
        directions: &[Direction; Lanes::WIDTH],
        known: &mut Option<LanePlace>,
    ) -> Lanes {
        let mut curves = directions.iter().map(|direction| self.curve(*direction));
        match self.nodes {
            Nodes::Uniform { start, step } => {
                let place =
                    self.place(axis, start, step, known, |nodes| LanePlace::new(position, axis, nodes));
                if core::ptr::eq(self.forward, self.reverse) {
                    place.read(|| self.forward)
                } else {
                    place.read(|| curves.next().unwrap_or_default())
                }
            }
            Nodes::At(at) => {
                position.map(|position| curves.next().map_or(f64::NAN, |curve| read_at(curve, at, position)))
            }
        }
    }

    /// The place that is known, where it is one between this table's nodes, or a new one.
    #[inline]
    fn place<'k, I, T>(
        &self,
        axis: usize,
        start: f64,
        step: f64,
        known: &'k mut Option<Located<I, T>>,
        find: impl FnOnce(Even) -> Located<I, T>,
    ) -> &'k Located<I, T> {
        let last = self.forward.len().saturating_sub(1);
        let nodes = Even { start: start.to_bits(), step: step.to_bits(), last };
        known.take_if(|place| place.axis != axis || place.nodes != nodes);
        known.get_or_insert_with(|| find(nodes))
    }
}

impl Place {
    fn new(position: f64, axis: usize, nodes: Even) -> Self {
        let [below, above, part] = nodes.locate(position);
        Self { axis, nodes, below: whole(below), above: whole(above), part }
    }

    /// Reads a curve.
    #[inline]
    fn read(&self, curve: &[f64]) -> f64 {
        between(node(curve, self.below), node(curve, self.above), self.part)
    }
}

impl LanePlace {
    fn new(position: Lanes, axis: usize, nodes: Even) -> Self {
        let [below, above, part] = nodes.locate(position);
        Self { axis, nodes, below: below.numbers().map(whole), above: above.numbers().map(whole), part }
    }

    /// Reads a curve in each lane.
    #[inline]
    fn read<'v>(&self, mut curve: impl FnMut() -> &'v [f64]) -> Lanes {
        let (mut low, mut high) = (self.part, self.part);
        let nodes = self.below.iter().zip(&self.above);
        for ((low, high), (below, above)) in low.iter_mut().zip(high.iter_mut()).zip(nodes) {
            let curve = curve();
            (*low, *high) = (node(curve, *below), node(curve, *above));
        }
        between(low, high, self.part)
    }
}

impl Even {
    /// The nodes below and above a position, counted from 0, and the part of the way between them.
    #[inline]
    fn locate<T: Real>(self, position: T) -> [T; 3] {
        let (zero, one, end) = (T::from(0.0), T::from(1.0), T::from(self.last as f64));
        let count = (position - f64::from_bits(self.start).into()) / f64::from_bits(self.step).into();
        // NaN counts as the first node here, and remains in the part.
        let inside = count.above(zero, count, zero);
        let inside = end.above(inside, inside, end);
        let below = floor(inside);
        let above = below + count.above(zero, one, zero);
        let part = count - below;
        let part = part.above(one, one, part);
        [below, end.above(above, above, end), (-one).above(part, -one, part)]
    }
}

/// The value at a node.
#[inline]
fn node(curve: &[f64], index: usize) -> f64 {
    curve.get(index).copied().unwrap_or(f64::NAN)
}

/// The greatest whole number that is not above a number from 0 to 2^51.
#[inline]
fn floor<T: Real>(number: T) -> T {
    let nearest = (number + WHOLE.into()) - WHOLE.into();
    nearest.above(number, nearest - 1.0.into(), nearest)
}

/// A whole number from 0 to 2^51 as an index.
#[inline]
fn whole(number: f64) -> usize {
    ((number + WHOLE).to_bits() & BITS) as usize
}
