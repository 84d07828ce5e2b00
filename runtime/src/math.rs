//! The few functions of analysis that the runtime and the generated code need.
//!
//! In: numbers. Out: numbers, NaN where the argument is NaN. It exists because `core` has no root and no exponential: they
//! come from libm, or from the standard library with the feature `std`. Sine and cosine are Abbe's own.

mod sine;

use super::real::Real;

pub use super::real::{exp_m1, floor, sqrt};
pub use sine::{sin_cos, sin_cos_each};

/// Sine of an angle in rad.
#[must_use]
pub fn sin(angle: Real) -> Real {
    sin_cos(angle).0
}

/// Whether there is no NaN and nothing infinite among these numbers.
#[inline]
pub(crate) const fn all_finite(numbers: &[Real]) -> bool {
    nothing(0.0, numbers) == 0.0
}

/// `sum`, and NaN where one of the numbers is not finite: nothing times a finite number is nothing, NaN times any other.
#[inline]
pub(crate) const fn nothing(mut sum: Real, numbers: &[Real]) -> Real {
    let mut rest = numbers;
    while let [first, others @ ..] = rest {
        sum += *first * 0.0;
        rest = others;
    }
    sum
}

/// Scalar product of two vectors.
#[inline]
#[must_use]
pub fn dot(a: [Real; 3], b: [Real; 3]) -> Real {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a + factor * b`, component by component.
#[inline]
#[must_use]
pub fn add_scaled(a: [Real; 3], factor: Real, b: [Real; 3]) -> [Real; 3] {
    [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]]
}

/// Euclidean length of a vector.
#[must_use]
pub fn length(a: [Real; 3]) -> Real {
    sqrt(dot(a, a))
}
