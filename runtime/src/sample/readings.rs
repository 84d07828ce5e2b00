//! What a term reads, of one row or of many.
//!
//! In: a [`Sample`], or lanes of samples. Out: positions, velocities, temperatures, directions, and tables read there. It
//! exists so that the formula of a term is written once.

use super::Sample;
use crate::table::{LanePlace, Place};
use crate::{Direction, Lanes, Real, Table};

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

/// One sample.
#[derive(Debug)]
pub(crate) struct OneSample<'a> {
    pub(crate) sample: Sample<'a>,
    /// Where the table that was read last found its position.
    place: Option<Place>,
}

impl<'a> OneSample<'a> {
    pub(crate) const fn new(sample: Sample<'a>) -> Self {
        Self { sample, place: None }
    }
}

impl Readings for OneSample<'_> {
    type Number = f64;

    #[inline]
    fn position(&self, axis: usize) -> f64 {
        self.sample.position(axis)
    }

    #[inline]
    fn velocity(&self, axis: usize) -> f64 {
        self.sample.velocity(axis)
    }

    #[inline]
    fn temperature(&self, sensor: usize) -> f64 {
        self.sample.temperature(sensor)
    }

    #[inline]
    fn sign(&self, axis: usize) -> f64 {
        self.sample.direction(axis).map_or(f64::NAN, Direction::sign)
    }

    // Always: see `MotionReader::term`.
    #[inline(always)]
    fn table(&mut self, table: &Table<'_>, axis: usize) -> f64 {
        table.read(axis, &self.sample, &mut self.place)
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

/// The lanes at an index; NaN where there are none.
pub(crate) fn lanes(slice: &[Lanes], index: usize) -> Lanes {
    slice.get(index).copied().unwrap_or(f64::NAN.into())
}
