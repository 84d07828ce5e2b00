//! Problems and their solutions. In: points. Out: the linear system that all methods solve, and what each makes of it.

use nalgebra::{DMatrix, DVector};

use crate::coefficient::Coefficient;
use crate::datum::{Datum, Freedom};
use crate::number;
use crate::points::Point;

/// The system `residual = jacobian * dA`, the zeros of the parts taken off both sides.
pub(crate) struct Problem {
    /// What a relative change of 1 of each coefficient makes of each reading, mm.
    pub(crate) jacobian: DMatrix<f64>,
    /// What the calibration leaves of each reading, mm.
    pub(crate) residual: DVector<f64>,
    /// The zeros.
    pub(crate) datum: Datum,
    /// For each coefficient the piece that it belongs to.
    pub(crate) pieces: Vec<usize>,
}

impl Problem {
    /// The system of some points.
    pub(crate) fn of(points: &[&Point], coefficients: &[Coefficient], freedom: Freedom<'_>) -> Self {
        let datum = Datum::of(points, freedom);
        let share = |row: usize, column: usize| {
            points.get(row).and_then(|point| point.shares.get(column)).copied().unwrap_or(0.0)
        };
        let jacobian = DMatrix::from_fn(points.len(), coefficients.len(), share);
        let left = points.iter().map(|point| point.deviation - point.expected);
        let residual = DVector::from_iterator(points.len(), left);
        Self {
            jacobian: datum.without_columns(&jacobian),
            residual: datum.without(&residual),
            datum,
            pieces: coefficients.iter().map(|coefficient| coefficient.piece).collect(),
        }
    }

    /// How many readings there are.
    pub(crate) fn rows(&self) -> usize {
        self.residual.len()
    }

    /// The readings that are left for the coefficients when each zero has taken its own.
    pub(crate) fn free_rows(&self) -> f64 {
        number(self.rows()) - number(self.datum.freedoms())
    }

    /// What relative changes leave of the readings, mm.
    pub(crate) fn left(&self, change: &DVector<f64>) -> DVector<f64> {
        &self.residual - &self.jacobian * change
    }

    /// The root mean square of what each reading would show of a model that had not seen it, with the model's leverage
    /// of each reading; nothing where a reading stands alone for a part of the model.
    pub(crate) fn leave_one_out(&self, left: &DVector<f64>, leverage: &[f64]) -> Option<f64> {
        let mut sum = 0.0;
        for (row, value) in left.iter().enumerate() {
            let own = self.datum.leverage(row) + leverage.get(row).copied().unwrap_or(0.0);
            if own > 1.0 - 1e-9 {
                return None;
            }
            sum += (value / (1.0 - own)).powi(2);
        }
        (!left.is_empty()).then(|| (sum / number(left.len())).sqrt())
    }
}

/// Relative changes, and what they rest on.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    /// The relative change of each coefficient.
    pub(crate) change: DVector<f64>,
    /// Which coefficients were allowed to move.
    pub(crate) moved: Vec<bool>,
    /// The standard uncertainty of each relative change; nothing where no reading is left to tell the noise.
    pub(crate) spread: Vec<Option<f64>>,
    /// The relative changes, a row each, whose squares sum up to their covariance; nothing where the noise is not known.
    pub(crate) root: Option<DMatrix<f64>>,
    /// How much each reading decides its own prediction, 0 to 1.
    pub(crate) leverage: Vec<f64>,
    /// The standard deviation of the readings that the rest shows, mm.
    pub(crate) noise: Option<f64>,
    /// What `ridge` expects relative changes to be: their standard deviation.
    pub(crate) expected: Option<f64>,
    /// For each coefficient those that would do nearly as well in its place.
    pub(crate) alternatives: Vec<Vec<usize>>,
}

/// The standard deviation of the readings from a sum of squares and what is free in it.
pub(crate) fn noise(sum: f64, free: f64) -> Option<f64> {
    (free > 1e-6).then(|| (sum / free).max(0.0).sqrt())
}
