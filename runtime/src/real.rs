//! The numbers that equations can be evaluated in.
//!
//! In: the arithmetic of [`f64`]. Out: the same for one number and for [`Lanes`](crate::Lanes) of them. It exists so that
//! an equation is written once and answers alike for one position and for many.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::math;

/// A number, or several side by side on which every operation works alike.
///
/// What it does to each number is what [`f64`] does, in the same order, so that the bits are the same either way.
pub trait Real:
    Copy
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Sine and cosine of an angle in rad, in this order.
    #[must_use]
    fn sin_cos(self) -> (Self, Self);

    /// The sines and the cosines of several angles in rad, bit for bit those of [`Real::sin_cos`].
    #[must_use]
    fn sin_cos_each<const N: usize>(angles: [Self; N]) -> ([Self; N], [Self; N]);

    /// Square root; NaN for a negative number.
    #[must_use]
    fn sqrt(self) -> Self;

    /// The exponential less one, exact to the last digits for small values.
    #[must_use]
    fn exp_m1(self) -> Self;

    /// `then` where this is above `bound`, and `otherwise` where it is not or is NaN.
    #[must_use]
    fn above(self, bound: Self, then: Self, otherwise: Self) -> Self;

    /// Whether any of the numbers is above `bound`.
    #[must_use]
    fn any_above(self, bound: f64) -> bool;
}

impl Real for f64 {
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        math::sin_cos(self)
    }

    #[inline(always)]
    fn sin_cos_each<const N: usize>(angles: [Self; N]) -> ([Self; N], [Self; N]) {
        math::sin_cos_each(angles)
    }

    #[inline]
    fn sqrt(self) -> Self {
        math::sqrt(self)
    }

    #[inline]
    fn exp_m1(self) -> Self {
        math::exp_m1(self)
    }

    #[inline]
    fn above(self, bound: Self, then: Self, otherwise: Self) -> Self {
        if self > bound { then } else { otherwise }
    }

    #[inline]
    fn any_above(self, bound: f64) -> bool {
        self > bound
    }
}
