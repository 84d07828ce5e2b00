//! What a term reads.
//!
//! In: a [`Sample`], and a position that need not be its own. Out: positions, velocities, temperatures, directions, and tables read
//! there. It exists because the inverse reads the same state at one position after the other.

use super::super::real::Real;
use super::super::table::Place;
use super::super::{Bundle, Direction, Table};
use super::Sample;

/// One sample, or its state at another position.
#[derive(Debug)]
pub(crate) struct OneSample<'a> {
    position: &'a [Real],
    direction: &'a [Direction],
    /// All else of the sample.
    others: &'a Sample<'a>,
    /// Where the table that was read last found its position.
    place: Option<Place>,
}

impl<'a> OneSample<'a> {
    #[inline]
    pub(crate) const fn new(sample: &'a Sample<'a>) -> Self {
        Self::at(sample, sample.position)
    }

    /// The state of a sample at another position.
    #[inline]
    pub(crate) const fn at(sample: &'a Sample<'a>, position: &'a [Real]) -> Self {
        Self { position, direction: sample.direction, others: sample, place: None }
    }

    /// The same, no table being read yet, for a machine of so many axes: a number that the compiler of Rust knows from here
    /// on. None where there are others.
    #[inline]
    pub(crate) fn sized<const AXES: usize>(self) -> Option<Self> {
        let position: &[Real; AXES] = self.position.try_into().ok()?;
        let direction: &[Direction; AXES] = self.direction.try_into().ok()?;
        Some(Self { position, direction, others: self.others, place: None })
    }

    /// The values of tables that lie side by side; none where there is no such axis.
    #[inline(always)]
    pub(crate) fn bundle<const CURVES: usize, const ROWS: usize>(
        &self,
        bundle: &Bundle<CURVES, ROWS>,
    ) -> Option<[Real; CURVES]> {
        bundle.read(self.position, self.direction)
    }

    /// Position of an axis, in mm or rad; NaN where there is none, as below.
    #[inline]
    pub(crate) fn position(&self, axis: usize) -> Real {
        number(self.position, axis)
    }

    /// Velocity of an axis, in mm/s or rad/s.
    #[inline]
    pub(crate) fn velocity(&self, axis: usize) -> Real {
        number(self.others.velocity, axis)
    }

    /// Temperature of a sensor, in degC.
    #[inline]
    pub(crate) fn temperature(&self, sensor: usize) -> Real {
        number(self.others.temperature, sensor)
    }

    /// Direction of an axis: +1 or -1.
    #[inline]
    pub(crate) fn sign(&self, axis: usize) -> Real {
        self.direction.get(axis).map_or(Real::NAN, |direction| direction.sign())
    }

    /// A table at the position of an axis, on the curve of its direction.
    #[inline(always)]
    pub(crate) fn table(&mut self, table: &Table<'_>, axis: usize) -> Real {
        table.read(axis, self.position, self.direction, &mut self.place)
    }
}

/// The number at an index; NaN where there is none.
#[inline]
pub(crate) fn number(slice: &[Real], index: usize) -> Real {
    slice.get(index).copied().unwrap_or(Real::NAN)
}
