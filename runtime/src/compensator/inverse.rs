//! Which motion of the axes undoes an error of the tool tip.
//!
//! In: J, the direction of the tip for each axis (three rows, a column for each axis). Out: `J^+ E`, the shortest motion of
//! the axes that makes the part of E which they can make. It exists because a machine may have one slide or six, in
//! directions that a rotary table has turned, and directions that nothing reaches.

use crate::math::{add_scaled, dot, length};

/// A direction that the slides reach only by moving ten thousand times as far as the tip counts as out of reach.
const DEPENDENT: f64 = 1e-4;

/// The pseudo-inverse of `A = J J^T`: `A^+ = sum of p p^T` over the vectors p, which are zero where nothing is reached.
///
/// `J^+ = J^T A^+`, so that an axis with direction d moves by `d . (A^+ E)`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Reach {
    vectors: [[f64; 3]; 3],
}

impl Reach {
    /// The directions reached by axes that move the tip along these columns, by Gram-Schmidt: first an orthonormal basis
    /// of what they span, then a basis conjugate under A. Columns that vanish or depend on others add nothing.
    pub(super) fn new(columns: &[[f64; 3]]) -> Self {
        let mut basis = [[0.0; 3]; 3];
        for found in 0..basis.len() {
            let next = farthest(columns, &basis);
            let reach = length(next);
            // Also ends at NaN, which no comparison lets through.
            if reach.partial_cmp(&DEPENDENT).is_none_or(core::cmp::Ordering::is_le) {
                break;
            }
            if let Some(place) = basis.get_mut(found) {
                *place = add_scaled([0.0; 3], 1.0 / reach, next);
            }
        }
        Self { vectors: conjugate(columns, &basis) }
    }

    /// `A^+ E`.
    pub(super) fn apply(&self, error: [f64; 3]) -> [f64; 3] {
        self.vectors.iter().fold([0.0; 3], |sum, &vector| add_scaled(sum, dot(vector, error), vector))
    }
}

/// `A v = J J^T v`: what the tip does when each axis moves by its share of v.
pub(super) fn tip(columns: &[[f64; 3]], v: [f64; 3]) -> [f64; 3] {
    columns.iter().fold([0.0; 3], |sum, &column| add_scaled(sum, dot(column, v), column))
}

/// What is left of the column that the basis covers least.
fn farthest(columns: &[[f64; 3]], basis: &[[f64; 3]; 3]) -> [f64; 3] {
    columns.iter().fold([0.0; 3], |best, &column| {
        // Twice, since once leaves rounding errors of the size of what it took away.
        let rest = without(without(column, basis), basis);
        if dot(rest, rest) > dot(best, best) { rest } else { best }
    })
}

/// A vector without its parts along an orthonormal basis.
fn without(vector: [f64; 3], basis: &[[f64; 3]; 3]) -> [f64; 3] {
    basis.iter().fold(vector, |rest, &unit| add_scaled(rest, -dot(unit, rest), unit))
}

/// Vectors that span the same as the basis, with `p_i^T A p_j` 1 for i = j and 0 otherwise.
fn conjugate(columns: &[[f64; 3]], basis: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut vectors = [[0.0; 3]; 3];
    for (place, &unit) in basis.iter().enumerate() {
        let image = tip(columns, unit);
        let rest = vectors.iter().fold(unit, |rest, &p| add_scaled(rest, -dot(p, image), p));
        let weight = dot(rest, tip(columns, rest));
        if let Some(vector) = vectors.get_mut(place)
            && weight > 0.0
        {
            *vector = add_scaled([0.0; 3], 1.0 / crate::math::sqrt(weight), rest);
        }
    }
    vectors
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `J J^+ E` for the given columns.
    fn made(columns: &[[f64; 3]], error: [f64; 3]) -> [f64; 3] {
        tip(columns, Reach::new(columns).apply(error))
    }

    fn assert_close(a: [f64; 3], b: [f64; 3]) {
        assert!(length(add_scaled(a, -1.0, b)) < 1e-12, "{a:?} is not {b:?}");
    }

    #[test]
    fn three_skew_slides_make_every_error() {
        let columns = [[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.1, 0.2, -0.97]];
        assert_close(made(&columns, [0.3, -0.2, 0.7]), [0.3, -0.2, 0.7]);
    }

    #[test]
    fn skew_axes_move_by_the_solved_amounts() {
        // 2 (1, 0) + 5 (0.6, 0.8) = (5, 4)
        let columns = [[1.0, 0.0, 0.0], [0.6, 0.8, 0.0]];
        let pull = Reach::new(&columns).apply([5.0, 4.0, 9.0]);
        assert!((dot(columns[0], pull) - 2.0).abs() < 1e-12);
        assert!((dot(columns[1], pull) - 5.0).abs() < 1e-12);
    }

    #[test]
    fn parallel_slides_share_and_vanishing_ones_rest() {
        let columns = [[1.0, 0.0, 0.0], [0.0; 3], [-1.0, 0.0, 0.0]];
        let pull = Reach::new(&columns).apply([0.4, 1.0, 1.0]);
        let moves = columns.map(|column| dot(column, pull));
        assert_close(moves, [0.2, 0.0, -0.2]);
    }

    #[test]
    fn no_slide_makes_nothing() {
        assert_close(made(&[], [1.0, 2.0, 3.0]), [0.0; 3]);
        assert_close(made(&[[0.0, 1e-9, 0.0]], [1.0, 2.0, 3.0]), [0.0; 3]);
    }
}
