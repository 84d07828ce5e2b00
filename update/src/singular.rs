//! Singular values: the scaled system, its decomposition and its pseudo-inverse.
//!
//! In: the columns of the system. Out: the solution of least scaled change (NISTIR 6722, equations 19, 28 and E8 to E20). Each
//! column is divided by its greatest absolute value, one of zeros by 1; singular values up to `rows * norm * 2.2e-16` count
//! as zero, the norm being the root of the sum of all squares.

use nalgebra::{DMatrix, DVector};

use crate::number;
use crate::solution::{Problem, Solution, noise};

/// The system `columns / scale = U S V'`.
pub(crate) struct Decomposition {
    u: DMatrix<f64>,
    v: DMatrix<f64>,
    scale: Vec<f64>,
    /// Whether any reading shows the coefficient.
    seen: Vec<bool>,
    /// From the largest to the smallest, one for each column.
    pub(crate) singular: Vec<f64>,
    /// Up to this they count as zero.
    pub(crate) tolerance: f64,
    /// How many do not.
    pub(crate) rank: usize,
}

/// How columns are scaled before they are decomposed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scaling {
    /// The greatest absolute value of each column is 1, as in the report.
    Greatest,
    /// They stay as they are: relative changes.
    None,
}

impl Decomposition {
    /// Decomposes a matrix; `share` of its norm is the tolerance. Nothing where the iteration does not end.
    pub(crate) fn of(columns: &DMatrix<f64>, scaling: Scaling, share: Option<f64>) -> Option<Self> {
        let scale: Vec<f64> = columns
            .column_iter()
            .map(|column| match column.amax() {
                greatest if greatest > 0.0 && scaling == Scaling::Greatest => greatest.recip(),
                _ => 1.0,
            })
            .collect();
        let seen: Vec<bool> = columns.column_iter().map(|column| column.amax() > 0.0).collect();
        if columns.is_empty() {
            return Some(Self::of_nothing(columns.nrows()));
        }
        let mut scaled = columns.clone();
        for (mut column, scale) in scaled.column_iter_mut().zip(&scale) {
            column *= *scale;
        }
        let (rows, unknowns) = scaled.shape();
        let share = share.unwrap_or(number(rows) * f64::EPSILON);
        let tolerance = share * scaled.norm();
        // Rows of zeros make the decomposition tell every direction of the coefficients, also those that are not seen.
        let tall = scaled.resize(rows.max(unknowns), unknowns, 0.0);
        let decomposed = tall.try_svd(true, true, f64::EPSILON, ITERATIONS)?;
        let singular: Vec<f64> = decomposed.singular_values.iter().copied().collect();
        let rank = singular.iter().filter(|value| **value > tolerance).count();
        let (u, v) = (decomposed.u?, decomposed.v_t?.transpose());
        let u = u.rows(0, rows).into_owned();
        singular.iter().all(|value| value.is_finite()).then_some(Self {
            u,
            v,
            scale,
            seen,
            singular,
            tolerance,
            rank,
        })
    }

    /// The decomposition of a system without coefficients.
    fn of_nothing(rows: usize) -> Self {
        Self {
            u: DMatrix::zeros(rows, 0),
            v: DMatrix::zeros(0, 0),
            scale: Vec::new(),
            seen: Vec::new(),
            singular: Vec::new(),
            tolerance: 0.0,
            rank: 0,
        }
    }

    /// The solution of a problem of which this is the decomposition.
    pub(crate) fn solve(&self, problem: &Problem) -> Solution {
        let factors: Vec<f64> = self.counted().map(f64::recip).collect();
        let change = self.combined(&problem.residual, &factors);
        let left = problem.left(&change);
        let noise = noise(left.norm_squared(), problem.free_rows() - number(self.rank));
        let spread = self.spread(&factors).into_iter().map(|one| noise.map(|noise| noise * one));
        Solution {
            moved: self.seen.clone(),
            spread: spread.collect(),
            root: noise.map(|noise| self.root(&factors) * noise),
            leverage: self.leverage(&vec![1.0; self.rank]),
            noise,
            expected: None,
            alternatives: vec![Vec::new(); change.len()],
            change,
        }
    }

    /// The singular values that count.
    pub(crate) fn counted(&self) -> impl Iterator<Item = f64> {
        self.singular.iter().copied().take(self.rank)
    }

    /// The components of readings along the singular directions that count.
    pub(crate) fn components(&self, readings: &DVector<f64>) -> Vec<f64> {
        (0..self.rank).map(|k| self.u.column(k).dot(readings)).collect()
    }

    /// The relative changes that readings demand, each singular direction with its factor.
    pub(crate) fn combined(&self, readings: &DVector<f64>, factors: &[f64]) -> DVector<f64> {
        let mut scaled = DVector::zeros(self.scale.len());
        for (k, (component, factor)) in self.components(readings).iter().zip(factors).enumerate() {
            scaled.axpy(component * factor, &self.v.column(k), 1.0);
        }
        // What no reading shows stays, but for rounding.
        let unscaled = scaled.iter().zip(&self.scale).zip(&self.seen);
        let unscaled = unscaled.map(|((d, scale), seen)| if *seen { d * scale } else { 0.0 });
        DVector::from_iterator(self.scale.len(), unscaled)
    }

    /// Whether any reading shows each coefficient.
    pub(crate) fn seen(&self) -> &[bool] {
        &self.seen
    }

    /// The root of the sum of squares of the factors in each relative change.
    pub(crate) fn spread(&self, factors: &[f64]) -> Vec<f64> {
        let one = |(coefficient, scale): (usize, &f64)| {
            let square =
                |(k, factor): (usize, &f64)| self.v.get((coefficient, k)).map(|v| (v * factor).powi(2));
            let sum: f64 = factors.iter().enumerate().filter_map(square).sum();
            scale * sum.sqrt()
        };
        self.scale.iter().enumerate().map(one).collect()
    }

    /// The relative changes that one unit along each singular direction makes, each direction with its factor: a row for each
    /// coefficient, a column for each factor.
    pub(crate) fn root(&self, factors: &[f64]) -> DMatrix<f64> {
        DMatrix::from_fn(self.scale.len(), factors.len(), |coefficient, k| {
            let scale = self.scale.get(coefficient).copied().unwrap_or(0.0);
            let factor = factors.get(k).copied().unwrap_or(0.0);
            self.v.get((coefficient, k)).map_or(0.0, |v| v * factor * scale)
        })
    }

    /// The diagonal of the matrix that makes predictions of readings, each singular direction with its weight.
    pub(crate) fn leverage(&self, weights: &[f64]) -> Vec<f64> {
        let one = |row: usize| {
            let weighted = |(k, weight): (usize, &f64)| self.u.get((row, k)).map(|u| u * u * weight);
            weights.iter().enumerate().filter_map(weighted).sum()
        };
        (0..self.u.nrows()).map(one).collect()
    }

    /// The directions of the scaled coefficients that no reading shows, a column each.
    pub(crate) fn null_space(&self) -> DMatrix<f64> {
        self.v.columns(self.rank, self.v.ncols() - self.rank).into_owned()
    }
}

/// Far more than the decomposition of a matrix of finite numbers needs.
const ITERATIONS: usize = 100_000;

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix of three independent columns, their sums and a column of zeros, of very different sizes.
    fn dependent() -> DMatrix<f64> {
        let column = |k: i32| DVector::from_fn(12, |row, _| (0.3 + number(row) * f64::from(k + 1)).sin());
        let [a, b, c] = [0, 1, 2].map(column);
        let columns = [a.clone() * 1e-6, b.clone() * 40.0, c.clone(), &a + &b, (&b - &c) * 1e3, &a * 0.0];
        DMatrix::from_columns(&columns)
    }

    #[test]
    fn the_rank_is_that_of_the_independent_columns_and_scales_are_those_of_the_report() {
        let decomposition = Decomposition::of(&dependent(), Scaling::Greatest, None).unwrap();
        assert_eq!((decomposition.rank, decomposition.null_space().ncols()), (3, 3));
        for (column, scale) in dependent().column_iter().zip(&decomposition.scale) {
            let greatest = column.amax() * scale;
            assert!((greatest - 1.0).abs() < 1e-12 || (greatest == 0.0 && *scale == 1.0));
        }
        assert!(decomposition.tolerance > 0.0 && decomposition.singular.is_sorted_by(|a, b| a >= b));
    }

    #[test]
    fn of_all_best_solutions_it_is_the_one_of_least_scaled_change() {
        let columns = dependent();
        let decomposition = Decomposition::of(&columns, Scaling::Greatest, None).unwrap();
        let readings = DVector::from_fn(12, |row, _| number(row * row) - 20.0);
        let factors: Vec<f64> = decomposition.counted().map(f64::recip).collect();
        let solution = decomposition.combined(&readings, &factors);
        // What is left is at right angles to every column: it is least.
        let left = &readings - &columns * &solution;
        for column in columns.column_iter() {
            assert!(column.dot(&left).abs() <= 1e-9 * column.norm() * readings.norm());
        }
        // The scaled solution is at right angles to all that no reading shows: it is shortest.
        let scaled = DVector::from_iterator(6, solution.iter().zip(&decomposition.scale).map(|(d, s)| d / s));
        for direction in decomposition.null_space().column_iter() {
            assert!(direction.dot(&scaled).abs() <= 1e-9 * scaled.norm());
        }
    }
}
