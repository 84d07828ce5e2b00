//! Which motion of the axes undoes an error of the tool tip.
//!
//! In: J, the direction of the tip for each axis (three rows, a column for each axis). Out: `J^+ E`, the shortest motion of
//! the axes that makes the part of E which they can make. It exists because a machine may have one slide or six, in
//! directions that a rotary table has turned, and directions that nothing reaches.

use super::super::math::{add_scaled, dot, length, sqrt};
use super::super::real::{DEPENDENT, Real};
use super::report::GREATEST_AMPLIFICATION;

/// What rounding leaves of the square of a scalar product of two unit vectors at right angles: a few units in the last
/// place of 1, squared.
const ROUNDING: Real = 64.0 * Real::EPSILON * Real::EPSILON;

/// The pseudo-inverse of `A = J J^T`, which is zero where nothing is reached.
///
/// `J^+ = J^T A^+`, so that an axis with direction d moves by `d . (A^+ E)`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Reach {
    /// The diagonal of A, where it is known to be all of it.
    squares: Option<[Real; 3]>,
    /// The diagonal of `A^+`, where A is diagonal.
    straight: [Real; 3],
    /// Where it is not, `A^+ = sum of p p^T` over these vectors p.
    vectors: [[Real; 3]; 3],
    /// Whether it is not.
    skew: bool,
}

impl Reach {
    /// Nothing is reached.
    const NOTHING: Self = Self { squares: None, straight: ZERO, vectors: [ZERO; 3], skew: false };

    /// The directions reached by axes that move the tip along these columns.
    pub(super) fn new(columns: &[[Real; 3]]) -> Self {
        let (squares, skew) = squares(columns);
        let vectors = if skew { conjugate(columns, &basis(columns)) } else { [ZERO; 3] };
        Self { squares: None, straight: inverses(squares), vectors, skew }
    }

    /// [`new`](Self::new) where A is diagonal; none where it is not.
    #[inline(always)]
    pub(super) fn at_right_angles(columns: &[[Real; 3]]) -> Option<Self> {
        let (squares, skew) = squares(columns);
        (!skew).then(|| Self { straight: inverses(squares), ..Self::NOTHING })
    }

    /// [`new`](Self::new) where A is known to be diagonal, from its diagonal.
    #[inline(always)]
    pub(super) fn straight(squares: [Real; 3]) -> Self {
        Self { squares: Some(squares), straight: inverses(squares), ..Self::NOTHING }
    }

    /// `A^+ E`.
    #[inline]
    pub(super) fn apply(&self, error: [Real; 3]) -> [Real; 3] {
        let ([a, b, c], [x, y, z]) = (self.straight, error);
        let straight = [a * x, b * y, c * z];
        if self.skew { self.apply_vectors(error) } else { straight }
    }

    /// Whether the axes may have to move more than [`GREATEST_AMPLIFICATION`] times as far as the tip. Slides at right angles that
    /// move the tip as far as themselves never have to.
    #[inline(always)]
    pub(super) fn may_amplify(&self) -> bool {
        let bound = GREATEST_AMPLIFICATION * GREATEST_AMPLIFICATION;
        self.skew || self.straight.iter().any(|weight| *weight > bound)
    }

    /// The squares of how far the axes move to correct an error, and of the part of it that they correct.
    pub(super) fn moved_and_corrected(&self, columns: Columns<'_>, error: [Real; 3]) -> [Real; 2] {
        let corrected = self.tip(columns, self.apply(error));
        [self.distance_squared(error), dot(corrected, corrected)]
    }

    /// `A v = J J^T v`: what the tip does when each axis moves along these columns by its share of v.
    #[inline(always)]
    pub(super) fn tip(&self, columns: Columns<'_>, v: [Real; 3]) -> [Real; 3] {
        match self.squares {
            Some([a, b, c]) => add_scaled(ZERO, 1.0, [a * v[0], b * v[1], c * v[2]]),
            None => columns.tip(v),
        }
    }

    /// The square of the length over all axes of the motion `J^+ E`, which is `E . A^+ E`. It is NaN where a part of E is
    /// not finite, be it reached or not.
    #[inline]
    pub(super) fn distance_squared(&self, error: [Real; 3]) -> Real {
        let ([a, b, c], [x, y, z]) = (self.straight, error);
        let straight = a * x * x + b * y * y + c * z * z;
        if self.skew { self.distance_squared_vectors(error) } else { straight }
    }

    /// [`distance_squared`](Self::distance_squared) where A is not diagonal: a sum of squares, which no rounding makes negative.
    #[inline(always)]
    fn distance_squared_vectors(&self, error: [Real; 3]) -> Real {
        self.vectors.iter().fold(0.0, |sum, &vector| {
            let part = dot(vector, error);
            sum + part * part
        })
    }

    /// [`apply`](Self::apply) where A is not diagonal.
    #[inline(always)]
    fn apply_vectors(&self, error: [Real; 3]) -> [Real; 3] {
        self.vectors.iter().fold(ZERO, |sum, &vector| add_scaled(sum, dot(vector, error), vector))
    }
}

/// The vector of length 0.
const ZERO: [Real; 3] = [0.0; 3];

/// The direction of the tip for each axis: the columns of J.
#[derive(Clone, Copy, Debug)]
pub(super) enum Columns<'c> {
    /// The same at every position, and known when the code is compiled: nothing is left then of what is zero, or one.
    Known(&'static [[Real; 3]]),
    /// Found for a position.
    Found {
        columns: &'c [[Real; 3]],
        /// Which of them are known to be zero everywhere; empty where nothing is known.
        resting: &'c [bool],
    },
}

impl Columns<'_> {
    /// `A v`, axis by axis.
    #[inline(always)]
    fn tip(self, v: [Real; 3]) -> [Real; 3] {
        match self {
            Self::Known(columns) => {
                let mut sum = ZERO;
                for column in columns {
                    let (share, [x, y, z], &[a, b, c]) = (product(column, v), sum, column);
                    sum = [added(x, a, share), added(y, b, share), added(z, c, share)];
                }
                sum
            }
            Self::Found { columns, resting } => {
                let moving = columns.iter().enumerate().filter(|(axis, _)| resting.get(*axis) != Some(&true));
                moving.fold(ZERO, |sum, (_, &column)| add_scaled(sum, dot(column, v), column))
            }
        }
    }

    /// Writes each target less its axis's share of the pull.
    #[inline]
    pub(super) fn correct(self, target: &[Real], pull: [Real; 3], commands: &mut [Real]) {
        let mut axes = commands.iter_mut().zip(target);
        self.shares(pull, |share| {
            if let Some((command, &target)) = axes.next() {
                *command = target - share;
            }
        });
    }

    /// Goes through the shares of v that the axes take, in their order.
    #[inline(always)]
    fn shares(self, v: [Real; 3], mut each: impl FnMut(Real)) {
        match self {
            Self::Known(columns) => {
                for column in columns {
                    each(product(column, v));
                }
            }
            Self::Found { columns, resting } => {
                for (axis, &column) in columns.iter().enumerate() {
                    let rests = resting.get(axis) == Some(&true);
                    each(if rests { 0.0 } else { dot(column, v) });
                }
            }
        }
    }
}

/// The scalar product, without what is zero.
#[inline(always)]
fn product(known: &[Real; 3], v: [Real; 3]) -> Real {
    // Nothing is added to a zero below zero, so that the first sum is none.
    known.iter().zip(v).fold(-0.0, |sum, (&part, v)| added(sum, part, v))
}

/// `sum + known * number`, or the sum where the one that is known is zero.
#[inline(always)]
fn added(sum: Real, known: Real, number: Real) -> Real {
    if known == 0.0 { sum } else { sum + known * number }
}

/// [`Columns::tip`] of columns that were found.
fn tip(columns: &[[Real; 3]], v: [Real; 3]) -> [Real; 3] {
    columns.iter().fold(ZERO, |sum, &column| add_scaled(sum, dot(column, v), column))
}

/// The diagonal of A, and whether there is more beside it than rounding leaves. There is nothing for slides at right
/// angles along the axes of the part, or turned with it through any angle when there are three alike.
#[inline(always)]
fn squares(columns: &[[Real; 3]]) -> ([Real; 3], bool) {
    let mut squares = ZERO;
    let mut mixed = ZERO;
    for &[x, y, z] in columns {
        squares = add_scaled(squares, 1.0, [x * x, y * y, z * z]);
        mixed = add_scaled(mixed, 1.0, [y * z, z * x, x * y]);
    }
    let [xx, yy, zz] = squares;
    let bounds = [yy * zz, zz * xx, xx * yy];
    let skew = mixed.iter().zip(bounds).any(|(mixed, bound)| mixed * mixed > bound * ROUNDING);
    (squares, skew)
}

/// The diagonal of `A^+` where A is diagonal, from that of A.
#[inline(always)]
fn inverses(squares: [Real; 3]) -> [Real; 3] {
    squares.map(|square| if square > DEPENDENT * DEPENDENT { 1.0 / square } else { 0.0 })
}

/// An orthonormal basis of what the columns span, by Gram-Schmidt. Columns that vanish or depend on others add nothing.
fn basis(columns: &[[Real; 3]]) -> [[Real; 3]; 3] {
    let mut basis = [ZERO; 3];
    for found in 0..basis.len() {
        let next = farthest(columns, &basis);
        let reach = length(next);
        // Also ends at NaN, which no comparison lets through.
        let reached = reach > DEPENDENT;
        if !reached {
            break;
        }
        if let Some(place) = basis.get_mut(found) {
            *place = add_scaled(ZERO, 1.0 / reach, next);
        }
    }
    basis
}

/// What is left of the column that the basis covers least.
fn farthest(columns: &[[Real; 3]], basis: &[[Real; 3]; 3]) -> [Real; 3] {
    columns.iter().fold(ZERO, |best, &column| {
        // Twice, since once leaves rounding errors of the size of what it took away.
        let rest = without(without(column, basis), basis);
        if dot(rest, rest) > dot(best, best) { rest } else { best }
    })
}

/// A vector without its parts along an orthonormal basis.
fn without(vector: [Real; 3], basis: &[[Real; 3]; 3]) -> [Real; 3] {
    basis.iter().fold(vector, |rest, &unit| add_scaled(rest, -dot(unit, rest), unit))
}

/// Vectors that span the same as the basis, with `p_i^T A p_j` 1 for i = j and 0 otherwise.
fn conjugate(columns: &[[Real; 3]], basis: &[[Real; 3]; 3]) -> [[Real; 3]; 3] {
    let mut vectors = [ZERO; 3];
    for (place, &unit) in basis.iter().enumerate() {
        let image = tip(columns, unit);
        let rest = vectors.iter().fold(unit, |rest, &p| add_scaled(rest, -dot(p, image), p));
        let weight = dot(rest, tip(columns, rest));
        if let Some(vector) = vectors.get_mut(place)
            && weight > 0.0
        {
            *vector = add_scaled(ZERO, 1.0 / sqrt(weight), rest);
        }
    }
    vectors
}

#[cfg(test)]
mod tests {
    use super::super::super::math::sin_cos;
    use super::*;

    /// `J J^+ E` for the given columns.
    fn made(columns: &[[Real; 3]], error: [Real; 3]) -> [Real; 3] {
        tip(columns, Reach::new(columns).apply(error))
    }

    /// What some sums and roots of numbers around 1 round by: 1e-12 in 64 bits.
    const ROUNDED: Real = 4096.0 * Real::EPSILON;

    fn assert_close(a: [Real; 3], b: [Real; 3]) {
        assert!(length(add_scaled(a, -1.0, b)) < ROUNDED, "{a:?} is not {b:?}");
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
        assert!((dot(columns[0], pull) - 2.0).abs() < ROUNDED);
        assert!((dot(columns[1], pull) - 5.0).abs() < ROUNDED);
    }

    #[test]
    fn slides_at_right_angles_move_as_any_others() {
        let (sine, cosine) = sin_cos(0.7);
        let turned = [[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]];
        let lathe = [[0.0; 3], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]];
        let doubled = [[2.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 1.0], [0.0, 1.5, 0.0]];
        for columns in [&turned[..], &lathe, &doubled] {
            assert!(!squares(columns).1, "{columns:?}");
            let (reach, general) = (Reach::new(columns), conjugate(columns, &basis(columns)));
            for error in [[1.0, 0.0, 0.0], [0.3, -0.2, 0.7], [0.0, 5.0, 1.0]] {
                assert_close(
                    reach.apply(error),
                    Reach { vectors: general, skew: true, ..reach }.apply(error),
                );
            }
        }
    }

    #[test]
    fn a_slide_that_leans_in_any_plane_is_not_straight() {
        for (slide, towards) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
            for lean in [64.0 * Real::EPSILON, -1e-3] {
                let mut columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
                columns[slide][towards] = lean;
                assert!(squares(&columns).1, "{columns:?}");
                assert_close(made(&columns, [0.3, -0.2, 0.7]), [0.3, -0.2, 0.7]);
            }
        }
    }

    #[test]
    fn what_a_slide_reaches_by_a_little_is_reached_and_what_rounding_leaves_is_not() {
        for lean in [0.0, 0.5] {
            let columns = |reach| [[reach, 0.0, 0.0], [0.0, 1.0, lean], [0.0, 0.0, 1.0]];
            let error = [0.3, -0.2, 0.7];
            assert_close(made(&columns(1e3 * DEPENDENT), error), error);
            assert_close(made(&columns(1e-3 * DEPENDENT), error), [0.0, -0.2, 0.7]);
        }
    }

    /// Two slides along one line, the second turned away and back again: across the line they reach nothing but what rounding leaves.
    #[test]
    fn what_turning_there_and_back_leaves_is_not_reached() {
        let turned = |[x, y]: [Real; 2], angle: Real| {
            let (sine, cosine) = sin_cos(angle);
            [cosine * x - sine * y, sine * x + cosine * y]
        };
        for step in 0..1000_i16 {
            let (line, away) = (turned([1.0, 0.0], Real::from(step) * 0.01), Real::from(step) * 0.037);
            let again = turned(turned(line, away), -away);
            let reach = Reach::new(&[[line[0], line[1], 0.0], [again[0], again[1], 0.0]]);
            let pull = reach.apply([-line[1], line[0], 0.0]);
            assert!(length(pull) < 1.0, "{step}: {pull:?}");
        }
    }

    #[test]
    fn what_is_known_is_what_is_found() {
        const LATHE: &[[Real; 3]] = &[[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]];
        const LEANING: &[[Real; 3]] = &[[0.6, -0.8, 0.0], [0.0; 3], [0.0, 0.0, 2.0], [0.1, 0.2, -0.3]];
        let v = [0.3, -0.2, 0.7];
        for (columns, resting) in [(&[][..], &[][..]), (LATHE, &[false; 2]), (LEANING, &[false, true, false])]
        {
            let [known, found, rested] = [
                Columns::Known(columns),
                Columns::Found { columns, resting: &[] },
                Columns::Found { columns, resting },
            ];
            let commands = [known, found, rested].map(|columns| {
                assert_close(columns.tip(v), found.tip(v));
                let mut commands = [Real::NAN; 4];
                columns.correct(&[5.0, -6.0, 7.0, 8.0], v, &mut commands);
                commands.map(Real::to_bits)
            });
            assert_eq!(commands, [commands[0]; 3]);
        }
    }

    #[test]
    fn the_distance_is_that_which_all_axes_go() {
        let straight = [[2.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0; 3], [0.0, 1.5, 0.0]];
        let skew = [[0.6, -0.8, 0.0], [0.0; 3], [0.0, 0.0, 2.0], [0.1, 0.2, -0.3]];
        for columns in [&straight[..], &skew] {
            let reach = Reach::new(columns);
            for error in [[1.0, 0.0, 0.0], [0.3, -0.2, 0.7], [0.0, 5.0, 1.0]] {
                let pull = reach.apply(error);
                let gone: Real = columns.iter().map(|column| dot(*column, pull).powi(2)).sum();
                let found = reach.distance_squared(error);
                assert!((found - gone).abs() < ROUNDED * gone, "{found} is not {gone}");
            }
        }
    }

    #[test]
    fn what_is_not_finite_is_at_no_distance_even_where_nothing_reaches() {
        let reach = Reach::new(&[[1.0, 0.0, 0.0]]);
        for number in [Real::NAN, Real::INFINITY] {
            assert!(!reach.distance_squared([number, 0.0, 0.0]).is_finite());
            assert!(reach.distance_squared([0.0, number, 0.0]).is_nan());
        }
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
