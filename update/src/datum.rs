//! Datums: the zero of each part, which a setting-up puts where it likes.
//!
//! In: directions of readings and the setting-up of each. Out: an orthonormal basis of what displacements of the parts in
//! the free directions make of all readings. What lies in it says nothing of the machine and is taken off everything.

use nalgebra::{DMatrix, DVector};

use crate::matrix::{extend, without};
use crate::points::Point;

/// What free zeros of the parts can make of the readings.
#[derive(Clone, Debug)]
pub(crate) struct Datum {
    basis: Vec<DVector<f64>>,
}

impl Datum {
    /// The free displacements of every setting-up among the points, in the directions that are free.
    pub(crate) fn of(points: &[&Point], free: [bool; 3]) -> Self {
        let mut settings: Vec<usize> = points.iter().map(|point| point.setting).collect();
        settings.sort_unstable();
        settings.dedup();
        let mut basis = Vec::new();
        for setting in settings {
            for (part, _) in free.iter().enumerate().filter(|(_, free)| **free) {
                let seen = points.iter().map(|point| {
                    let component = point.direction.get(part).copied().unwrap_or(0.0);
                    if point.setting == setting { component } else { 0.0 }
                });
                extend(&mut basis, DVector::from_iterator(points.len(), seen));
            }
        }
        Self { basis }
    }

    /// How many displacements are free.
    pub(crate) fn freedoms(&self) -> usize {
        self.basis.len()
    }

    /// What no displacement of a part can make.
    pub(crate) fn without(&self, values: &DVector<f64>) -> DVector<f64> {
        without(&self.basis, values)
    }

    /// The same of every column.
    pub(crate) fn without_columns(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let cleaned: Vec<DVector<f64>> =
            columns.column_iter().map(|column| self.without(&column.into_owned())).collect();
        if cleaned.is_empty() { columns.clone() } else { DMatrix::from_columns(&cleaned) }
    }

    /// The share of each reading that goes into the zeros: the diagonal of their projection.
    pub(crate) fn leverage(&self, point: usize) -> f64 {
        self.basis.iter().filter_map(|vector| vector.get(point)).map(|part| part * part).sum()
    }

    /// The basis itself, to go on from.
    pub(crate) fn basis(&self) -> Vec<DVector<f64>> {
        self.basis.clone()
    }
}
