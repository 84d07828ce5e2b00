//! Paths: where a program sends the axes, and when a recording looks.
//!
//! In: a shape, a feed, a rate, a number of runs. Out: a [`Timeline`], which knows the commanded position at any time and
//! the instants of the recording. Positions are those of the axes in mm and rad, times in s. Speed is constant along each
//! leg, or trapezoidal where an acceleration is given.

mod leg;
mod shape;
mod timeline;

pub use shape::{Shape, Stations, Stroke};
pub use timeline::{Instant, Timeline};

use std::fmt;

/// A path and the way it is driven.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// Where each axis stands that the shape does not move, and the centre of round shapes: a list of positions for each
    /// axis, one for each run, from the beginning again where there are more runs; none stands for zero.
    pub at: Vec<Vec<f64>>,
    /// The shape.
    pub shape: Shape,
    /// The speed along the path, mm/s; rad/s where only rotary axes move.
    pub feed: f64,
    /// The acceleration at both ends of every leg, in the feed's unit per s; at once where there is none.
    pub acceleration: Option<f64>,
    /// Readings a second; without meaning where the shape stops at stations.
    pub rate: f64,
    /// How often the path is driven.
    pub runs: u32,
    /// From the last reading of a run to the beginning of the next, s.
    pub pause: f64,
}

/// The most instants that a path may have.
pub const MOST_INSTANTS: usize = 20_000_000;

/// Why a path cannot be driven.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PathError {
    /// The shape has no length, and nothing else tells how long it lasts.
    NoLength,
    /// This number must be greater than zero.
    NotPositive(&'static str),
    /// It would take more than [`MOST_INSTANTS`] readings.
    TooLong,
    /// The shape names an axis that the machine lacks.
    NoAxis(usize),
}

impl fmt::Display for PathError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoLength => formatter.write_str("the path has no length: all its points are the same"),
            Self::NotPositive(what) => write!(formatter, "{what} of a path must be greater than zero"),
            Self::TooLong => write!(formatter, "the path takes more than {MOST_INSTANTS} readings"),
            Self::NoAxis(axis) => {
                write!(formatter, "the path moves axis number {axis}, which the machine lacks")
            }
        }
    }
}

impl std::error::Error for PathError {}

impl Path {
    /// Lays the path out in time. `rotary` tells for each axis of the machine whether it turns.
    ///
    /// # Errors
    ///
    /// Every kind of [`PathError`].
    pub fn timeline(&self, rotary: &[bool]) -> Result<Timeline, PathError> {
        self.check(rotary.len())?;
        Timeline::of(self, rotary)
    }

    /// The plane, the axis positions of the centre in the first run and the radius, where the path is a circle.
    pub fn circle(&self, axes: usize) -> Option<([usize; 2], Vec<f64>, f64)> {
        match &self.shape {
            Shape::Circle { plane, radius, .. } => Some((*plane, self.base(axes, 0), *radius)),
            _ => None,
        }
    }

    /// Where the axes stand in a run, counted from 0, before the shape moves them.
    fn base(&self, axes: usize, run: usize) -> Vec<f64> {
        let of_axis = |axis: usize| {
            let list = self.at.get(axis)?;
            list.get(run.checked_rem(list.len())?).copied()
        };
        (0..axes).map(|axis| of_axis(axis).unwrap_or(0.0)).collect()
    }

    /// No fewer instants than these come of it: told before anything is laid out, so that no number makes it endless.
    fn least_instants(&self) -> f64 {
        let of_run = match &self.shape {
            Shape::Line { stations: Some(stations), .. } => {
                f64::from(stations.count) * f64::from(stations.readings.max(1))
            }
            Shape::Grid { lines, .. } => f64::from(*lines),
            Shape::Circle { counterclockwise, .. } => counterclockwise.len() as f64,
            Shape::Points(points) => points.len() as f64,
            _ => 1.0,
        };
        // A run is laid out leg by leg: some hundred bytes each.
        of_run.max(64.0) * f64::from(self.runs)
    }

    fn check(&self, axes: usize) -> Result<(), PathError> {
        let positive = |value: f64, what| {
            if value > 0.0 && value.is_finite() { Ok(()) } else { Err(PathError::NotPositive(what)) }
        };
        positive(self.feed, "the feed")?;
        positive(self.acceleration.unwrap_or(1.0), "the acceleration")?;
        positive(self.rate, "the rate")?;
        positive(f64::from(self.runs), "the number of runs")?;
        if self.runs > 1 {
            positive(self.pause, "the pause")?;
        }
        if self.least_instants() > MOST_INSTANTS as f64 {
            return Err(PathError::TooLong);
        }
        match self.shape.axes().into_iter().find(|axis| *axis >= axes) {
            Some(axis) => Err(PathError::NoAxis(axis)),
            None => Ok(()),
        }
    }
}
