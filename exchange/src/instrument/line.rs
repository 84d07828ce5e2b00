//! Straight lines through curves. In: values over positions. Out: the least-squares line, or the one through the ends, with the
//! uncertainty of its slope.

use super::curve::Averaged;
use super::setup::Remove;
use super::uncertainty::{Uncertainty, count, mean, together};

/// A line that was taken off a curve: offset + slope * position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Its value at position zero: mm or rad.
    pub offset: f64,
    /// Its slope, in mm or rad for each mm or rad of the axis.
    pub slope: f64,
    /// The uncertainty of the slope from what the curve departs from the line; of a least-squares line through three targets or
    /// more.
    pub from_residual: Option<Uncertainty>,
    /// The uncertainty of the slope from the scatter of whole runs; not known where a direction has fewer than two.
    pub from_runs: Option<Uncertainty>,
}

impl Line {
    /// Its value at a position.
    pub fn at(&self, position: f64) -> f64 {
        self.offset + self.slope * position
    }

    /// Both uncertainties together, or the one that is known.
    ///
    /// The scatter of the means is in the residual too, so that together they are rather too large than too small.
    pub fn uncertainty(&self) -> Option<Uncertainty> {
        match (self.from_residual, self.from_runs) {
            (Some(residual), Some(runs)) => together(&[(1.0, Some(residual)), (1.0, Some(runs))]),
            (one, other) => one.or(other),
        }
    }

    /// The line of a curve that is to be removed; nothing where nothing is, or fewer than two targets are there.
    pub(super) fn of(averaged: &Averaged, remove: Remove) -> Option<Self> {
        let positions = &averaged.curve.positions;
        let centre = averaged.curve.centre();
        if positions.len() < 2 {
            return None;
        }
        let weights = match remove {
            Remove::Line => slope_weights(positions),
            Remove::Ends => end_weights(positions),
            Remove::Nothing => return None,
        };
        let slope: f64 = weights.iter().zip(&centre).map(|(weight, value)| weight * value).sum();
        let offset = match remove {
            Remove::Ends => centre.first()? - slope * positions.first()?,
            _ => mean(&centre) - slope * mean(positions),
        };
        let line = Self { offset, slope, from_residual: None, from_runs: averaged.scatter(&weights) };
        let from_residual = if remove == Remove::Line { line.residual(positions, &centre) } else { None };
        Some(Self { from_residual, ..line })
    }

    /// The uncertainty of the slope of a least-squares line, its residuals being independent.
    fn residual(&self, positions: &[f64], values: &[f64]) -> Option<Uncertainty> {
        let freedom = count(positions.len().checked_sub(2).filter(|freedom| *freedom > 0)?);
        let left = positions.iter().zip(values).map(|(at, value)| value - self.at(*at));
        let squares: f64 = left.map(|left| left * left).sum();
        Some(Uncertainty { standard: (squares / freedom / spread(positions)).sqrt(), freedom })
    }
}

/// The sum of squares about the mean.
fn spread(positions: &[f64]) -> f64 {
    let mean = mean(positions);
    positions.iter().map(|at| (at - mean) * (at - mean)).sum()
}

/// The weights of the values in the slope of their least-squares line.
fn slope_weights(positions: &[f64]) -> Vec<f64> {
    let (mean, spread) = (mean(positions), spread(positions));
    positions.iter().map(|at| (at - mean) / spread).collect()
}

/// The weights of the values in the slope between the ends.
fn end_weights(positions: &[f64]) -> Vec<f64> {
    let mut weights = vec![0.0; positions.len()];
    let length = positions.last().zip(positions.first()).map_or(f64::NAN, |(last, first)| last - first);
    if let Some(first) = weights.first_mut() {
        *first = -1.0 / length;
    }
    if let Some(last) = weights.last_mut() {
        *last = 1.0 / length;
    }
    weights
}
