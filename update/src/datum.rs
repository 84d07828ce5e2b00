//! Datums: the zero of each part, which a set-up puts where it likes, and its rotation, where that is free.
//!
//! In: directions of readings and the set-up of each. Out: an orthonormal basis of what displacements of the parts in
//! the free directions and their free rotations make of all readings. What lies in it says nothing of the machine and is taken off
//! everything.

use nalgebra::{DMatrix, DVector};

use crate::matrix::{extend, without};
use crate::points::Point;
use crate::setup::{Setup, effects};

/// What is free of the parts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Freedom<'s> {
    /// The set-ups.
    pub(crate) setups: &'s [Setup],
    /// The directions in which a part is displaced freely.
    pub(crate) directions: [bool; 3],
    /// The same of a part whose datum is free: all directions that the machine's equations know.
    pub(crate) sensitive: [bool; 3],
}

impl Freedom<'_> {
    /// The directions in which the part of a set-up is displaced freely.
    pub(crate) fn directions(&self, setup: &Setup) -> [bool; 3] {
        if setup.pose.is_some() { self.sensitive } else { self.directions }
    }
}

/// What free zeros and rotations of the parts can make of the readings.
#[derive(Clone, Debug)]
pub(crate) struct Datum {
    basis: Vec<DVector<f64>>,
}

impl Datum {
    /// The free displacements and rotations of every set-up among the points.
    pub(crate) fn of(points: &[&Point], freedom: Freedom<'_>) -> Self {
        let mut basis = Vec::new();
        for (number, setup) in freedom.setups.iter().enumerate() {
            let directions = freedom.directions(setup);
            let own: Vec<Option<Vec<f64>>> = points
                .iter()
                .map(|point| (point.setup == number).then(|| effects(point, setup, directions)))
                .collect();
            let count = own.iter().flatten().next().map_or(0, Vec::len);
            for effect in 0..count {
                let seen =
                    own.iter().map(|effects| effects.as_ref().and_then(|known| known.get(effect)).copied());
                extend(
                    &mut basis,
                    DVector::from_iterator(points.len(), seen.map(|seen| seen.unwrap_or(0.0))),
                );
            }
        }
        Self { basis }
    }

    /// How many displacements and rotations are free.
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
