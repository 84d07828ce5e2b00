//! What a term reads, of one row or of many.
//!
//! In: a [`Sample`], or lanes of samples. Out: positions, velocities, temperatures, directions, and tables read there. It
//! exists so that the formula of a term is written once.

use super::Sample;
use crate::table::{LanePlace, Place};
use crate::{Bundle, Direction, Lanes, Real, Table};

/// What a term reads; NaN where there is none.
pub(crate) trait Readings {
    /// One number, or one for each row.
    type Number: Real;

    /// Position of an axis, in mm or rad.
    fn position(&self, axis: usize) -> Self::Number;

    /// Velocity of an axis, in mm/s or rad/s.
    fn velocity(&self, axis: usize) -> Self::Number;

    /// Temperature of a sensor, in degC.
    fn temperature(&self, sensor: usize) -> Self::Number;

    /// Direction of an axis: +1 or -1.
    fn sign(&self, axis: usize) -> Self::Number;

    /// A table at the position of an axis, on the curve of its direction.
    fn table(&mut self, table: &Table<'_>, axis: usize) -> Self::Number;
}

/// One sample, or its state at another position.
#[derive(Debug)]
pub(crate) struct OneSample<'a> {
    position: &'a [f64],
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
    pub(crate) const fn at(sample: &'a Sample<'a>, position: &'a [f64]) -> Self {
        Self { position, direction: sample.direction, others: sample, place: None }
    }

    /// The same, no table being read yet, for a machine of so many axes: a number that the compiler of Rust knows from here
    /// on. None where there are others.
    #[inline]
    pub(crate) fn sized<const AXES: usize>(self) -> Option<Self> {
        let position: &[f64; AXES] = self.position.try_into().ok()?;
        let direction: &[Direction; AXES] = self.direction.try_into().ok()?;
        Some(Self { position, direction, others: self.others, place: None })
    }

    /// The values of tables that lie side by side; none where there is no such axis.
    // Always: see `MotionReader::term`.
    #[inline(always)]
    pub(crate) fn bundle<const CURVES: usize, const ROWS: usize>(
        &self,
        bundle: &Bundle<CURVES, ROWS>,
    ) -> Option<[f64; CURVES]> {
        bundle.read(self.position, self.direction)
    }
}

impl Readings for OneSample<'_> {
    type Number = f64;

    #[inline]
    fn position(&self, axis: usize) -> f64 {
        number(self.position, axis)
    }

    #[inline]
    fn velocity(&self, axis: usize) -> f64 {
        number(self.others.velocity, axis)
    }

    #[inline]
    fn temperature(&self, sensor: usize) -> f64 {
        number(self.others.temperature, sensor)
    }

    #[inline]
    fn sign(&self, axis: usize) -> f64 {
        self.direction.get(axis).map_or(f64::NAN, |direction| direction.sign())
    }

    // Always: see `MotionReader::term`.
    #[inline(always)]
    fn table(&mut self, table: &Table<'_>, axis: usize) -> f64 {
        table.read(axis, self.position, self.direction, &mut self.place)
    }
}

/// The samples of [`Lanes::WIDTH`] rows.
#[derive(Debug)]
pub(crate) struct LaneSample<'a> {
    /// Position of each axis.
    pub(crate) position: &'a [Lanes],
    /// Velocity of each axis.
    pub(crate) velocity: &'a [Lanes],
    /// Temperature of each sensor.
    pub(crate) temperature: &'a [Lanes],
    /// Direction of each axis.
    pub(crate) direction: &'a [[Direction; Lanes::WIDTH]],
    /// Where the table that was read last found the positions.
    pub(crate) place: Option<LanePlace>,
}

impl Readings for LaneSample<'_> {
    type Number = Lanes;

    fn position(&self, axis: usize) -> Lanes {
        lanes(self.position, axis)
    }

    fn velocity(&self, axis: usize) -> Lanes {
        lanes(self.velocity, axis)
    }

    fn temperature(&self, sensor: usize) -> Lanes {
        lanes(self.temperature, sensor)
    }

    fn sign(&self, axis: usize) -> Lanes {
        match self.direction.get(axis) {
            Some(directions) => Lanes::new(directions.map(Direction::sign)),
            None => f64::NAN.into(),
        }
    }

    fn table(&mut self, table: &Table<'_>, axis: usize) -> Lanes {
        match self.direction.get(axis) {
            Some(directions) => {
                table.read_lanes(axis, lanes(self.position, axis), directions, &mut self.place)
            }
            None => f64::NAN.into(),
        }
    }
}

/// The number at an index; NaN where there is none.
#[inline]
pub(crate) fn number(slice: &[f64], index: usize) -> f64 {
    slice.get(index).copied().unwrap_or(f64::NAN)
}

/// The lanes at an index; NaN where there are none.
pub(crate) fn lanes(slice: &[Lanes], index: usize) -> Lanes {
    slice.get(index).copied().unwrap_or(f64::NAN.into())
}
