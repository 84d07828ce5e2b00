//! What the runtime needs to know of numbers of 64 bits.
//!
//! In: numbers. Out: roots, sums of small parts, whole numbers, and how small is nothing. It exists so that everything else is written
//! once for both kinds of numbers: what differs between them stands here, and under the same names in `single`.

/// The numbers that this runtime calculates with.
pub type Real = f64;

/// A full turn, rad.
pub(crate) const TAU: Real = core::f64::consts::TAU;

/// A step that ends a search, mm or rad: far below what any drive resolves.
pub(crate) const TOLERANCE: Real = 1e-10;

/// Whether a search may end at one of two neighbouring commands and never settle between them.
pub(crate) const COARSE: bool = false;

/// A direction that the slides reach only by moving a thousand million times as far as the tip counts as out of reach. Rounding leaves
/// as much of a direction that none reaches: sines and cosines are known to some 1e-16, and sums of a few of them to 1e-14. What is
/// reached by less than one in `GREATEST_AMPLIFICATION` is refused where it is asked for.
pub(crate) const DEPENDENT: Real = 1e-9;

/// How far the position of a motor may be from where its axes put it, mm: what fine scales resolve, and far above what sums of positions
/// round by.
pub(crate) const APART: Real = 1e-6;

/// A part of a whole that counts as none: sums of time steps round.
pub(crate) const NOTHING: Real = 1e-9;

/// Square root; NaN for a negative number.
#[must_use]
pub fn sqrt(value: Real) -> Real {
    #[cfg(feature = "std")]
    return value.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrt(value);
}

/// The greatest whole number that is not above a number; NaN at NaN.
#[must_use]
pub fn floor(value: Real) -> Real {
    #[cfg(feature = "std")]
    return value.floor();
    #[cfg(not(feature = "std"))]
    return libm::floor(value);
}

/// The exponential less one, `exp(value) - 1`, exact to the last digits for small values.
#[must_use]
pub fn exp_m1(value: Real) -> Real {
    #[cfg(feature = "std")]
    return value.exp_m1();
    #[cfg(not(feature = "std"))]
    return libm::expm1(value);
}

/// The angle of a part of a turn and a phase, rad; for a sine.
#[inline(always)]
pub(crate) fn angle(turns: Real, phase: Real) -> Real {
    TAU * turns + phase
}

/// What a sum has lost by rounding: nothing that counts.
pub(crate) type Lost = ();

/// A sum that goes on over many cycles, and a small part that is added to it.
#[inline(always)]
pub(crate) fn add(sum: Real, (): &mut Lost, part: Real) -> Real {
    sum + part
}

/// A clock or a ramp a step further.
#[inline(always)]
pub(crate) fn onward(from: Real, step: Real) -> Real {
    from + step
}

/// A sum of this and a smaller number has 28 binary digits behind the point, in the last of its bits.
const FIXED: Real = (1_u64 << 24) as Real;

/// The bits of these digits.
const FRACTION: u64 = (1 << 28) - 1;

/// The greatest whole number that is not above a number of steps, and what is left of it. What is no more than 2^-29 below a whole number
/// is that number. What is further below zero, too large or NaN gives a whole number from 2^24 on.
#[inline]
pub(crate) fn split(number: Real) -> (usize, Real) {
    let bits = (number + FIXED).to_bits();
    let left = number - (Real::from_bits(bits & !FRACTION) - FIXED);
    let whole = bits.wrapping_sub(FIXED.to_bits()) >> FRACTION.count_ones();
    (usize::try_from(whole).unwrap_or(usize::MAX), if left < 0.0 { 0.0 } else { left })
}
