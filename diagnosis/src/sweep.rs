//! Sweeping: least squares on a matrix of products, one column at a time, there and back.
//!
//! In: the products of columns with one another and with a response, which is last. Out: coefficients, their covariance
//! and the sum of squares that remains, for whatever columns are swept in. A column that the others already hold is not
//! taken in, so that what cannot be told apart cannot blow up.

use nalgebra::DMatrix;

/// A matrix of products in which some columns have been swept in. Columns are scaled to unit length.
#[derive(Clone, Debug)]
pub(crate) struct Swept {
    matrix: DMatrix<f64>,
    lengths: Vec<f64>,
    taken: Vec<bool>,
    /// The logarithm of the determinant of the products of the columns that are in.
    log_determinant: f64,
}

/// Minus twice the log-likelihood of the residuals, up to a constant: their sum of squares is `remaining`, their number `samples`.
pub(crate) fn misfit(remaining: f64, samples: f64) -> f64 {
    samples * (remaining.max(f64::MIN_POSITIVE) / samples.max(1.0)).ln()
}

/// The share of a column's length that must be left beside the others for it to be taken in.
const INDEPENDENT: f64 = 1e-9;

impl Swept {
    /// Nothing swept in yet.
    pub(crate) fn new(products: &DMatrix<f64>) -> Self {
        let size = products.nrows();
        let lengths: Vec<f64> = (0..size)
            .map(|column| match products[(column, column)].sqrt() {
                length if length > 0.0 && length.is_finite() => length,
                _ => 0.0,
            })
            .collect();
        let inverse = |column: usize| if lengths[column] > 0.0 { 1.0 / lengths[column] } else { 0.0 };
        let response = size - 1;
        let scale = |column: usize| if column == response { 1.0 } else { inverse(column) };
        let matrix =
            DMatrix::from_fn(size, size, |row, column| products[(row, column)] * scale(row) * scale(column));
        Self { matrix, lengths, taken: vec![false; size], log_determinant: 0.0 }
    }

    fn response(&self) -> usize {
        self.matrix.nrows() - 1
    }

    /// The sum of squares that remains.
    pub(crate) fn remaining(&self) -> f64 {
        self.matrix[(self.response(), self.response())]
    }

    /// Whether a column has been swept in.
    pub(crate) fn has(&self, column: usize) -> bool {
        self.taken[column]
    }

    /// The share of a column's squared length that the swept columns do not hold.
    pub(crate) fn independence(&self, column: usize) -> f64 {
        if self.taken[column] { 0.0 } else { self.matrix[(column, column)] }
    }

    /// Sweeps a column in, unless the others hold it already; says whether it did.
    pub(crate) fn take(&mut self, column: usize) -> bool {
        if self.taken[column] || self.matrix[(column, column)] <= INDEPENDENT {
            return false;
        }
        self.log_determinant += self.log_square(column);
        self.pivot(column, 1.0);
        self.taken[column] = true;
        true
    }

    /// Sweeps a column out again.
    pub(crate) fn drop(&mut self, column: usize) {
        if self.taken[column] {
            self.pivot(column, -1.0);
            self.taken[column] = false;
            self.log_determinant -= self.log_square(column);
        }
    }

    /// The logarithm of the squared length of a column, as far as the swept ones leave it.
    fn log_square(&self, column: usize) -> f64 {
        self.matrix[(column, column)].ln() + 2.0 * self.lengths[column].ln()
    }

    /// The logarithm of the determinant of the products of the columns that have been swept in.
    pub(crate) fn log_determinant(&self) -> f64 {
        self.log_determinant
    }

    fn pivot(&mut self, pivot: usize, sign: f64) {
        let d = self.matrix[(pivot, pivot)];
        let line: Vec<f64> = self.matrix.column(pivot).iter().copied().collect();
        for (column, factor) in line.iter().enumerate() {
            if column == pivot || *factor == 0.0 {
                continue;
            }
            let factor = factor / d;
            for (target, value) in self.matrix.column_mut(column).iter_mut().zip(&line) {
                *target -= value * factor;
            }
        }
        for (other, value) in line.iter().enumerate() {
            let value = sign * value / d;
            self.matrix[(other, pivot)] = value;
            self.matrix[(pivot, other)] = value;
        }
        self.matrix[(pivot, pivot)] = -1.0 / d;
    }

    /// How much the remaining sum of squares falls when these columns, not yet in, are taken in.
    pub(crate) fn promise(&self, columns: &[usize]) -> (f64, usize) {
        let open: Vec<usize> =
            columns.iter().copied().filter(|c| self.independence(*c) > INDEPENDENT).collect();
        self.quadratic(&open, 1.0)
    }

    /// How much the remaining sum of squares rises when these columns, which are in, are dropped.
    pub(crate) fn worth(&self, columns: &[usize]) -> f64 {
        let inside: Vec<usize> = columns.iter().copied().filter(|column| self.taken[*column]).collect();
        self.quadratic(&inside, -1.0).0
    }

    /// b' A^-1 b with A the sign times the products among the columns and b those with the response; and the rank of A.
    fn quadratic(&self, columns: &[usize], sign: f64) -> (f64, usize) {
        let response = self.response();
        if let [column] = columns {
            let b = self.matrix[(*column, response)];
            return (b * b / (sign * self.matrix[(*column, *column)]), 1);
        }
        let size = columns.len();
        let place = |at: usize| if at == size { response } else { columns[at] };
        let mut small =
            DMatrix::from_fn(size + 1, size + 1, |row, column| self.matrix[(place(row), place(column))]);
        if sign < 0.0 {
            let corner = small[(size, size)];
            small.neg_mut();
            small[(size, size)] = corner;
        }
        let before = small[(size, size)];
        let limits: Vec<f64> = (0..size).map(|at| small[(at, at)] * INDEPENDENT).collect();
        let mut rank = 0;
        for (pivot, limit) in limits.into_iter().enumerate() {
            let d = small[(pivot, pivot)];
            if d <= limit.max(f64::MIN_POSITIVE) {
                continue;
            }
            rank += 1;
            for row in pivot + 1..=size {
                let factor = small[(row, pivot)] / d;
                for column in pivot + 1..=size {
                    let value = small[(pivot, column)];
                    small[(row, column)] -= factor * value;
                }
            }
        }
        (before - small[(size, size)], rank)
    }

    /// The coefficient of a column that is in; 0 of others.
    pub(crate) fn coefficient(&self, column: usize) -> f64 {
        if self.taken[column] { self.matrix[(column, self.response())] / self.lengths[column] } else { 0.0 }
    }

    /// The sign that the coefficient of a column would have if it were taken in.
    pub(crate) fn sign(&self, column: usize) -> f64 {
        self.matrix[(column, self.response())].signum()
    }

    /// The covariance of two coefficients, for noise of unit variance; 0 where one is not in.
    pub(crate) fn covariance(&self, a: usize, b: usize) -> f64 {
        if self.taken[a] && self.taken[b] {
            -self.matrix[(a, b)] / (self.lengths[a] * self.lengths[b])
        } else {
            0.0
        }
    }

    /// The squared length of a sum of columns, none of them in, with these coefficients: as far as the swept ones leave it.
    pub(crate) fn energy(&self, columns: &[usize], coefficients: &[f64]) -> f64 {
        let scaled: Vec<(usize, f64)> = columns
            .iter()
            .zip(coefficients)
            .map(|(column, c)| (*column, c * self.lengths[*column]))
            .collect();
        let products = scaled
            .iter()
            .flat_map(|(a, left)| scaled.iter().map(move |(b, right)| left * right * self.matrix[(*a, *b)]));
        products.sum()
    }

    /// The correlation of two columns, as far as the swept ones leave them.
    pub(crate) fn likeness(&self, a: usize, b: usize) -> f64 {
        let sizes = self.independence(a) * self.independence(b);
        if sizes > 0.0 { self.matrix[(a, b)] / sizes.sqrt() } else { 0.0 }
    }
}

#[cfg(test)]
mod tests;
