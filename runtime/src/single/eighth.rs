//! Sines and cosines within an eighth of a turn, to 32 bits, and how angles get there.
//!
//! In: an angle near zero, and what it lacks. Out: its sine and its cosine. It exists since the sines of 32 bits of most libraries are
//! worked out in 64. The polynomials are those of the library Cephes (S. L. Moshier, `sinf.c`).

use super::real::Real;

/// Angles up to here, in rad, keep all their digits on the way to the nearest quarter: 477 turns.
pub(crate) const FARTHEST: Real = 3000.0;

/// Quarter turns in a radian.
pub(crate) const QUARTERS: Real = core::f32::consts::FRAC_2_PI;

/// A quarter turn in three parts. The first two have 13 bits, so that their products with any number of quarters that is used
/// here, up to 11 bits, are exact.
pub(crate) const QUARTER: [Real; 3] = [1.570_800_8, -4.454_516e-6, 6.077_100_6e-11];

/// 1.5 times 2 to the power 23: what is added to it loses its fraction, and leaves its last digits in the last bits.
pub(crate) const ROUNDS: Real = 12_582_912.0;

/// How far to the left the second bit from the right is to go, to become the sign of a number.
pub(crate) const TO_SIGN: u32 = 30;

/// The sine of an angle within an eighth of a turn, and of what it lacks.
#[inline]
pub(crate) fn sine(angle: Real, tail: Real) -> Real {
    let square = angle * angle;
    let higher = 8.332_161e-3 + square * -1.951_529_6e-4;
    let cube = square * angle;
    angle - ((square * (0.5 * tail - cube * higher) - tail) + cube * 1.666_665_5e-1)
}

/// The cosine of an angle within an eighth of a turn, and of what it lacks.
#[inline]
pub(crate) fn cosine(angle: Real, tail: Real) -> Real {
    let square = angle * angle;
    let higher = square * (4.166_664_6e-2 + square * (-1.388_731_6e-3 + square * 2.443_315_8e-5));
    let half = 0.5 * square;
    let most = 1.0 - half;
    most + (((1.0 - most) - half) + (square * higher - angle * tail))
}

/// Both, of an angle that is farther or none: NaN. The steps of such an angle are greater than 0.2 mrad, and what an axis does between
/// two of them is not known.
#[cold]
#[inline(never)]
pub(crate) fn far(_: Real) -> (Real, Real) {
    (Real::NAN, Real::NAN)
}
