//! What the points cannot tell apart. In: the directions of the coefficients that no reading shows. Out: as many
//! relations, each of few coefficients: one that the points do not show at all, or one whose effect others make too.

use nalgebra::DMatrix;

/// One relation: the effect of a coefficient is one of the others' at every point, or nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Alike {
    /// The coefficient.
    pub(crate) coefficient: usize,
    /// Those that make the same together; none where no point shows it.
    pub(crate) others: Vec<usize>,
}

/// A pivot must be as large; the columns are orthonormal, and small ones would blow up rounding.
const PIVOTS: [f64; 2] = [1e-2, 1e-7];

/// What is smaller beside the pivot is rounding.
const ROUNDING: f64 = 1e-6;

/// The relations: elimination from the last coefficient, so that the ones that stand first in a file, the simplest of
/// each motion, explain the later ones.
pub(crate) fn relations(null_space: &DMatrix<f64>) -> Vec<Alike> {
    let mut rows = null_space.transpose();
    let mut pivots: Vec<Option<usize>> = vec![None; rows.nrows()];
    for least in PIVOTS {
        for coefficient in (0..rows.ncols()).rev() {
            if pivots.contains(&Some(coefficient)) {
                continue;
            }
            let open = (0..rows.nrows()).filter(|row| pivots[*row].is_none());
            let greatest = open.max_by(|left, right| {
                rows[(*left, coefficient)].abs().total_cmp(&rows[(*right, coefficient)].abs())
            });
            if let Some(row) = greatest.filter(|row| rows[(*row, coefficient)].abs() > least) {
                eliminate(&mut rows, row, coefficient);
                pivots[row] = Some(coefficient);
            }
        }
    }
    let mut found: Vec<Alike> = pivots
        .iter()
        .enumerate()
        .filter_map(|(row, pivot)| {
            let coefficient = (*pivot)?;
            let others = (0..rows.ncols())
                .filter(|other| *other != coefficient && rows[(row, *other)].abs() > ROUNDING);
            Some(Alike { coefficient, others: others.collect() })
        })
        .collect();
    found.sort_by_key(|alike| alike.coefficient);
    found
}

/// Makes a pivot 1 and everything else in its column 0.
fn eliminate(rows: &mut DMatrix<f64>, pivot: usize, column: usize) {
    let size = rows[(pivot, column)];
    for other in 0..rows.ncols() {
        rows[(pivot, other)] /= size;
    }
    for row in (0..rows.nrows()).filter(|row| *row != pivot) {
        let factor = rows[(row, column)];
        for other in 0..rows.ncols() {
            let part = rows[(pivot, other)];
            rows[(row, other)] -= factor * part;
        }
        rows[(row, column)] = 0.0;
    }
}
