//! Sines and cosines within an eighth of a turn, to 64 bits, and how angles get there.
//!
//! In: an angle near zero, and what it lacks. Out: its sine and its cosine. It exists beside that of 32 bits since polynomials are as
//! long as numbers have digits. These are those of `fdlibm` (Sun Microsystems, 1993), which most libraries go back to.

use super::real::Real;

/// Angles up to here, in rad, keep all their digits on the way to the nearest quarter: 159 000 turns.
pub(crate) const FARTHEST: Real = 1e6;

/// Quarter turns in a radian.
pub(crate) const QUARTERS: Real = core::f64::consts::FRAC_2_PI;

/// A quarter turn in three parts. The first two have 33 bits, so that their products with any number of quarters that is used
/// here are exact.
pub(crate) const QUARTER: [Real; 3] =
    [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// 1.5 times 2 to the power 52: what is added to it loses its fraction, and leaves its last digits in the last bits.
pub(crate) const ROUNDS: Real = 6_755_399_441_055_744.0;

/// How far to the left the second bit from the right is to go, to become the sign of a number.
pub(crate) const TO_SIGN: u32 = 62;

/// The sine of an angle within an eighth of a turn, and of what it lacks.
#[inline]
pub(crate) fn sine(angle: Real, tail: Real) -> Real {
    let square = angle * angle;
    let higher = 8.333_333_333_322_49e-3
        + square * (-1.984_126_982_985_795e-4 + square * 2.755_731_370_707_006_8e-6)
        + square * (square * square) * (-2.505_076_025_340_686_3e-8 + square * 1.589_690_995_211_55e-10);
    let cube = square * angle;
    angle - ((square * (0.5 * tail - cube * higher) - tail) + cube * 1.666_666_666_666_663_2e-1)
}

/// The cosine of an angle within an eighth of a turn, and of what it lacks.
#[inline]
pub(crate) fn cosine(angle: Real, tail: Real) -> Real {
    let square = angle * angle;
    let fourth = square * square;
    let higher = square
        * (4.166_666_666_666_66e-2
            + square * (-1.388_888_888_887_411e-3 + square * 2.480_158_728_947_673e-5))
        + fourth
            * fourth
            * (-2.755_731_435_139_066_3e-7
                + square * (2.087_572_321_298_175e-9 + square * -1.135_964_755_778_819_5e-11));
    let half = 0.5 * square;
    let most = 1.0 - half;
    most + (((1.0 - most) - half) + (square * higher - angle * tail))
}

/// Both, of an angle that is farther or none.
#[cold]
#[inline(never)]
pub(crate) fn far(angle: Real) -> (Real, Real) {
    #[cfg(feature = "std")]
    return angle.sin_cos();
    #[cfg(not(feature = "std"))]
    return libm::sincos(angle);
}
