//! Sine and cosine, of one angle and of several at once.
//!
//! In: angles in rad. Out: their sines and cosines: the same bits on every processor, for one angle and for several. It exists
//! because the sines of rotary axes took half the time of a five-axis machine's equations: libraries look at each angle to see
//! what to do with it, so that several cannot be worked out side by side.
//!
//! An angle is measured from the nearest multiple of a quarter turn, to twice the digits of a number, and two polynomials give
//! sine and cosine of what it is beside that: those of `fdlibm` (Sun Microsystems, 1993), which most libraries go back to.
//! Which quarter it is decides, by two bits, about their order and their signs, so that nothing is ever asked.

/// Angles up to here, in rad, keep all their digits on the way to the nearest quarter: 159 000 turns.
const FARTHEST: f64 = 1e6;

/// Quarter turns in a radian.
const QUARTERS: f64 = core::f64::consts::FRAC_2_PI;

/// A quarter turn in three parts. The first two have 33 bits, so that their products with any number of quarters that is used
/// here are exact.
const QUARTER: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// 1.5 times 2 to the power 52: what is added to it loses its fraction, and leaves its last digits in the last bits.
const ROUNDS: f64 = 6_755_399_441_055_744.0;

/// Sine and cosine of an angle in rad, in this order; both NaN where it is not finite.
///
/// Up to a million rad each is within 0.8 of a unit in the last place, within 1.1 where the angle is a multiple of a quarter turn
/// as near as a number comes to it. Beyond, they are those of the standard library or of libm.
#[inline]
#[must_use]
pub fn sin_cos(angle: f64) -> (f64, f64) {
    if angle.abs() <= FARTHEST { near(angle) } else { far(angle) }
}

/// The sines and the cosines of several angles, bit for bit those of [`sin_cos`], in less time than one after the other.
#[inline(always)]
#[must_use]
pub fn sin_cos_each<const N: usize>(angles: [f64; N]) -> ([f64; N], [f64; N]) {
    match angles.iter().fold(true, |all, angle| all & (angle.abs() <= FARTHEST)) {
        true => each(angles, near),
        false => each(angles, sin_cos),
    }
}

#[inline(always)]
fn each<const N: usize>(angles: [f64; N], of: impl Fn(f64) -> (f64, f64)) -> ([f64; N], [f64; N]) {
    let (mut sines, mut cosines) = (angles, angles);
    for (sine, cosine) in sines.iter_mut().zip(&mut cosines) {
        (*sine, *cosine) = of(*sine);
    }
    (sines, cosines)
}

/// Both, of an angle that is no farther than [`FARTHEST`].
#[inline]
fn near(angle: f64) -> (f64, f64) {
    let bits = (angle * QUARTERS + ROUNDS).to_bits();
    let (rest, tail) = beside(angle, f64::from_bits(bits) - ROUNDS);
    let (sine, cosine) = (sine(rest, tail).to_bits(), cosine(rest, tail).to_bits());
    // In odd quarters they change places; the sine is negative in the third and fourth, the cosine in the second and third.
    let exchanged = (sine ^ cosine) & (bits & 1).wrapping_neg();
    let (below, left) = ((bits & 2) << 62, (bits.wrapping_add(1) & 2) << 62);
    (f64::from_bits(sine ^ exchanged ^ below), f64::from_bits(cosine ^ exchanged ^ left))
}

/// What is left of an angle beside a number of quarters, and what that lacks.
#[inline]
fn beside(angle: f64, quarters: f64) -> (f64, f64) {
    let first = angle - quarters * QUARTER[0];
    let second = quarters * QUARTER[1];
    let rest = first - second;
    let lacking = quarters * QUARTER[2] - ((first - rest) - second);
    let whole = rest - lacking;
    (whole, (rest - whole) - lacking)
}

/// The sine of an angle within an eighth of a turn, and of what it lacks.
#[inline]
fn sine(angle: f64, tail: f64) -> f64 {
    let square = angle * angle;
    let higher = 8.333_333_333_322_49e-3
        + square * (-1.984_126_982_985_795e-4 + square * 2.755_731_370_707_006_8e-6)
        + square * (square * square) * (-2.505_076_025_340_686_3e-8 + square * 1.589_690_995_211_55e-10);
    let cube = square * angle;
    angle - ((square * (0.5 * tail - cube * higher) - tail) + cube * 1.666_666_666_666_663_2e-1)
}

/// The cosine of an angle within an eighth of a turn, and of what it lacks.
#[inline]
fn cosine(angle: f64, tail: f64) -> f64 {
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
fn far(angle: f64) -> (f64, f64) {
    #[cfg(feature = "std")]
    return angle.sin_cos();
    #[cfg(not(feature = "std"))]
    return libm::sincos(angle);
}
