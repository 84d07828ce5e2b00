//! Sine and cosine, of one angle and of several at once.
//!
//! In: angles in rad. Out: their sines and cosines: the same bits on every processor, for one angle and for several. It exists
//! because the sines of rotary axes took half the time of a five-axis machine's equations: libraries look at each angle to see
//! what to do with it, so that several cannot be worked out side by side.
//!
//! An angle is measured from the nearest multiple of a quarter turn, to twice the digits of a number, and two polynomials give
//! sine and cosine of what it is beside that. Which quarter it is decides, by two bits, about their order and their signs, so that nothing is ever asked.

use super::super::eighth::{FARTHEST, QUARTER, QUARTERS, ROUNDS, TO_SIGN, cosine, far, sine};
use super::super::real::Real;

/// Sine and cosine of an angle in rad, in this order; both NaN where it is not finite.
///
/// Up to a million rad each is within 0.8 of a unit in the last place, within 1.1 where the angle is a multiple of a quarter turn
/// as near as a number comes to it. Beyond, they are those of the standard library or of libm.
///
/// In `single`, each is within 0.8 of a unit in the last place up to 3000 rad, and NaN beyond.
#[inline]
#[must_use]
pub fn sin_cos(angle: Real) -> (Real, Real) {
    if angle.abs() <= FARTHEST { near(angle) } else { far(angle) }
}

/// The sines and the cosines of several angles, bit for bit those of [`sin_cos`], in less time than one after the other.
#[inline(always)]
#[must_use]
pub fn sin_cos_each<const N: usize>(angles: [Real; N]) -> ([Real; N], [Real; N]) {
    match angles.iter().fold(true, |all, angle| all & (angle.abs() <= FARTHEST)) {
        true => each(angles, near),
        false => each(angles, sin_cos),
    }
}

#[inline(always)]
fn each<const N: usize>(angles: [Real; N], of: impl Fn(Real) -> (Real, Real)) -> ([Real; N], [Real; N]) {
    let (mut sines, mut cosines) = (angles, angles);
    for (sine, cosine) in sines.iter_mut().zip(&mut cosines) {
        (*sine, *cosine) = of(*sine);
    }
    (sines, cosines)
}

/// Both, of an angle that is no farther than [`FARTHEST`].
#[inline]
fn near(angle: Real) -> (Real, Real) {
    let bits = (angle * QUARTERS + ROUNDS).to_bits();
    let (rest, tail) = beside(angle, Real::from_bits(bits) - ROUNDS);
    let (sine, cosine) = (sine(rest, tail).to_bits(), cosine(rest, tail).to_bits());
    // In odd quarters they change places; the sine is negative in the third and fourth, the cosine in the second and third.
    let exchanged = (sine ^ cosine) & (bits & 1).wrapping_neg();
    let (below, left) = ((bits & 2) << TO_SIGN, (bits.wrapping_add(1) & 2) << TO_SIGN);
    (Real::from_bits(sine ^ exchanged ^ below), Real::from_bits(cosine ^ exchanged ^ left))
}

/// What is left of an angle beside a number of quarters, and what that lacks.
#[inline]
fn beside(angle: Real, quarters: Real) -> (Real, Real) {
    let first = angle - quarters * QUARTER[0];
    let second = quarters * QUARTER[1];
    let rest = first - second;
    let lacking = quarters * QUARTER[2] - ((first - rest) - second);
    let whole = rest - lacking;
    (whole, (rest - whole) - lacking)
}
