//! The few functions of analysis that the runtime and the generated code need.
//!
//! In: numbers. Out: numbers, NaN where the argument is NaN. It exists because `core` has no root and no exponential: they
//! come from libm, or from the standard library with the feature `std`. Sine and cosine are Abbe's own.

mod sine;

pub use sine::{sin_cos, sin_cos_each};

/// Sine of an angle in rad.
#[must_use]
pub fn sin(angle: f64) -> f64 {
    sin_cos(angle).0
}

/// Square root; NaN for a negative number.
#[must_use]
pub fn sqrt(value: f64) -> f64 {
    #[cfg(feature = "std")]
    return value.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrt(value);
}

/// The greatest whole number that is not above a number; NaN at NaN.
#[must_use]
pub fn floor(value: f64) -> f64 {
    #[cfg(feature = "std")]
    return value.floor();
    #[cfg(not(feature = "std"))]
    return libm::floor(value);
}

/// The exponential less one, `exp(value) - 1`, exact to the last digits for small values.
#[must_use]
pub fn exp_m1(value: f64) -> f64 {
    #[cfg(feature = "std")]
    return value.exp_m1();
    #[cfg(not(feature = "std"))]
    return libm::expm1(value);
}

/// Whether there is no NaN and nothing infinite among these numbers.
#[inline]
pub(crate) const fn all_finite(numbers: &[f64]) -> bool {
    nothing(0.0, numbers) == 0.0
}

/// `sum`, and NaN where one of the numbers is not finite: nothing times a finite number is nothing, NaN times any other.
#[inline]
pub(crate) const fn nothing(mut sum: f64, numbers: &[f64]) -> f64 {
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
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a + factor * b`, component by component.
#[inline]
#[must_use]
pub fn add_scaled(a: [f64; 3], factor: f64, b: [f64; 3]) -> [f64; 3] {
    [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]]
}

/// Euclidean length of a vector.
#[must_use]
pub fn length(a: [f64; 3]) -> f64 {
    sqrt(dot(a, a))
}
