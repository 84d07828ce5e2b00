//! What the runtime needs to know of numbers of 32 bits.
//!
//! In: numbers. Out: roots, sums of small parts, whole numbers, and how small is nothing. It exists so that everything else is written
//! once for both kinds of numbers: what differs between them stands here, and under the same names in `double`.

/// The numbers that this runtime calculates with.
pub type Real = f32;

/// A full turn, rad.
pub(crate) const TAU: Real = core::f32::consts::TAU;

/// A step that ends a search, mm or rad: 1 nm, a sixtieth of a step of a position near a metre; two steps of an angle near a turn. What
/// is left behind it is the rate at which the error changes times as much: a picometre by 1 mm/m.
pub(crate) const TOLERANCE: Real = 1e-6;

/// Whether a search may end at one of two neighbouring commands and never settle between them.
pub(crate) const COARSE: bool = true;

/// A direction that the slides reach only by moving a hundred thousand times as far as the tip counts as out of reach. Rounding leaves
/// a tenth of it of a direction that none reaches: sines and cosines are known to some 6e-8, and sums of a few of them to 1e-6. What is
/// reached by less than one in `GREATEST_AMPLIFICATION` is refused where it is asked for.
pub(crate) const DEPENDENT: Real = 1e-5;

/// How far the position of a motor may be from where its axes put it, mm. Below 4 m a position is rounded by up to 0.12 um: that of the
/// motor, those of two axes, their product with a share and the sum together by 0.6 um.
pub(crate) const APART: Real = 1e-3;

/// A part of a whole that counts as none: eight times what a number near 1 is rounded by.
pub(crate) const NOTHING: Real = 1e-6;

/// Square root; NaN for a negative number.
#[must_use]
pub fn sqrt(value: Real) -> Real {
    #[cfg(feature = "std")]
    return value.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrtf(value);
}

/// The greatest whole number that is not above a number; NaN at NaN.
#[must_use]
pub fn floor(value: Real) -> Real {
    #[cfg(feature = "std")]
    return value.floor();
    #[cfg(not(feature = "std"))]
    return libm::floorf(value);
}

/// The exponential less one, `exp(value) - 1`, exact to the last digits for small values.
#[must_use]
pub fn exp_m1(value: Real) -> Real {
    #[cfg(feature = "std")]
    return value.exp_m1();
    #[cfg(not(feature = "std"))]
    return libm::expm1f(value);
}

/// The angle of a part of a turn and a phase, rad, but for whole turns; for a sine. An encoder has 50 000 periods in a metre, whose
/// angle would have steps of a thirtieth of a radian.
#[inline(always)]
pub(crate) fn angle(turns: Real, phase: Real) -> Real {
    TAU * (turns - floor(turns)) + phase
}

/// What a sum has lost by rounding, and gets with the next part.
pub(crate) type Lost = Real;

/// A sum that goes on over many cycles, and a small part that is added to it. What rounding takes is kept: a temperature behind a filter
/// of an hour, whose cycle takes 0.1 ms, would else stand still until it is 34 K away.
#[inline(always)]
pub(crate) fn add(sum: Real, lost: &mut Lost, part: Real) -> Real {
    let part = part + *lost;
    let next = sum + part;
    let of_part = next - sum;
    *lost = (sum - (next - of_part)) + (part - of_part);
    next
}

/// A clock or a ramp a step further, by at least the smallest step that it can go: it never stands still.
#[inline(always)]
pub(crate) fn onward(from: Real, step: Real) -> Real {
    let next = from + step;
    match (next == from, step > 0.0, step < 0.0) {
        (true, true, _) => from.next_up(),
        (true, _, true) => from.next_down(),
        _ => next,
    }
}

/// The greatest whole number that is not above a number of steps, and what is left of it. What is below zero, too large or NaN gives a
/// whole number from 2^24 on.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the whole part is asked for, and a number below zero has none"
)]
pub(crate) fn split(number: Real) -> (usize, Real) {
    // One instruction each of a processor for numbers of 32 bits. A cast has no way to fail: it stops at both ends.
    let whole = number as u32;
    let left = number - whole as Real;
    // Not `<`: also at NaN, which no comparison lets through.
    let whole = if left >= 0.0 { whole } else { u32::MAX };
    (usize::try_from(whole).unwrap_or(usize::MAX), left)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten million parts of which each alone would be lost: a hundred-millionth each of a sum of 1.
    #[test]
    fn small_parts_add_up() {
        let (mut sum, mut lost) = (1.0, 0.0);
        for _ in 0..10_000_000 {
            sum = add(sum, &mut lost, 1e-8);
        }
        // 1e-8 itself is rounded by 6e-17, ten million times; what was lost last is not in the sum yet.
        assert!((sum - 1.1).abs() <= Real::EPSILON, "{sum}");
        assert_eq!(1.0 + 1e-8, 1.0_f32, "the parts are not small enough to show it");
    }

    #[test]
    fn clocks_go_on_and_stand_still_in_no_time() {
        for from in [0.0, 1.0, 4096.0, 3e7, -7.0] {
            for step in [1e-4, 1e-30] {
                assert!(onward(from, step) > from && onward(from, -step) < from, "{from} {step}");
            }
            assert_eq!(onward(from, 0.0), from);
        }
        assert_eq!(onward(2.0, 0.5), 2.5);
        assert!(onward(1.0, Real::NAN).is_nan());
    }

    #[test]
    fn whole_numbers_and_what_is_left() {
        for (number, whole, left) in
            [(0.0, 0, 0.0), (0.75, 0, 0.75), (1.0_f32.next_down(), 0, 1.0_f32.next_down()), (41.5, 41, 0.5)]
        {
            assert_eq!(split(number), (whole, left));
        }
        for none in [-1e-9, -5.0, Real::NEG_INFINITY, Real::INFINITY, Real::NAN, 1e12] {
            assert!(split(none).0 >= 1 << 24, "{none}");
        }
        assert!(split(Real::NAN).1.is_nan());
    }

    /// A period of an encoder, a metre away from its zero.
    #[test]
    fn whole_turns_of_an_angle_are_left_out() {
        let turns: Real = 50_000.25;
        assert!((angle(turns, 0.1) - (TAU * 0.25 + 0.1)).abs() <= TAU * Real::EPSILON);
        assert!((angle(-turns, 0.0) - TAU * 0.75).abs() <= TAU * Real::EPSILON);
    }
}
