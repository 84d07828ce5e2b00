//! Datums: the zero of each part, which a setting-up puts where it likes, and its rotation, where that is free.
//!
//! In: directions of readings and the setting-up of each. Out: an orthonormal basis of what displacements of the parts in
//! the free directions and their free rotations make of all readings. What lies in it says nothing of the machine and is taken off
//! everything.

use nalgebra::{DMatrix, DVector};

use crate::matrix::{extend, without};
use crate::points::Point;
use crate::setting::{Setting, effects};

/// What is free of the parts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Freedom<'s> {
    /// The settings-up.
    pub(crate) settings: &'s [Setting],
    /// The directions in which a part is displaced freely.
    pub(crate) directions: [bool; 3],
    /// The same of a part whose datum is free: all directions that the machine's equations know.
    pub(crate) sensitive: [bool; 3],
}

impl Freedom<'_> {
    /// The directions in which the part of a setting-up is displaced freely.
    pub(crate) fn directions(&self, setting: &Setting) -> [bool; 3] {
        if setting.lie.is_some() { self.sensitive } else { self.directions }
    }
}

/// What free zeros and rotations of the parts can make of the readings.
#[derive(Clone, Debug)]
pub(crate) struct Datum {
    basis: Vec<DVector<f64>>,
}

impl Datum {
    /// The free displacements and rotations of every setting-up among the points.
    pub(crate) fn of(points: &[&Point], freedom: Freedom<'_>) -> Self {
        let mut basis = Vec::new();
        for (number, setting) in freedom.settings.iter().enumerate() {
            let directions = freedom.directions(setting);
            let own: Vec<Option<Vec<f64>>> = points
                .iter()
                .map(|point| (point.setting == number).then(|| effects(point, setting, directions)))
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
