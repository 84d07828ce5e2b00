//! Bases that grow column by column. In: columns. Out: orthonormal vectors that span them, and what lies outside.

use nalgebra::DVector;

/// What is left of a column must be more than this share of it, or it lies in the basis but for rounding.
const INSIDE: f64 = 1e-11;

/// Adds a column to an orthonormal basis; says whether it lay outside.
pub(crate) fn extend(basis: &mut Vec<DVector<f64>>, column: DVector<f64>) -> bool {
    let left = without(basis, &column);
    let norm = left.norm();
    let outside = norm.is_finite() && norm > 0.0;
    if outside {
        basis.push(left / norm);
    }
    outside
}

/// What of a column lies outside an orthonormal basis; exactly zero where that is rounding.
pub(crate) fn without(basis: &[DVector<f64>], column: &DVector<f64>) -> DVector<f64> {
    let mut left = column.clone();
    // Twice is enough: what the first pass leaves by rounding, the second one takes.
    for _ in 0..2 {
        for vector in basis {
            let part = vector.dot(&left);
            left.axpy(-part, vector, 1.0);
        }
    }
    if left.norm() > INSIDE * column.norm() { left } else { DVector::zeros(column.len()) }
}
