//! Several numbers side by side.
//!
//! In: the same quantity in several rows. Out: sums, products and functions of it, row by row. It exists so that the
//! compiler of Rust finds loops of a fixed length in which it can use the vector unit of the processor.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::{Real, math};

/// The same quantity in [`Lanes::WIDTH`] rows, one row a lane.
///
/// Each operation is that of [`f64`] in every lane; no lane sees another.
///
/// ```
/// use abbe_runtime::Lanes;
/// let x = Lanes::from_fn(|row| row as f64);
/// let y = x * x + Lanes::from(0.5);
/// assert_eq!(y.lane(3), 9.5);
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(align(64))]
pub struct Lanes([f64; Lanes::WIDTH]);

impl Lanes {
    /// The number of lanes.
    pub const WIDTH: usize = 8;

    /// The lanes from their numbers.
    #[inline]
    #[must_use]
    pub const fn new(numbers: [f64; Self::WIDTH]) -> Self {
        Self(numbers)
    }

    /// The lanes that a function gives for 0, 1, 2 and so on.
    #[inline]
    #[must_use]
    pub fn from_fn(of: impl FnMut(usize) -> f64) -> Self {
        Self(core::array::from_fn(of))
    }

    /// The numbers of all lanes.
    #[inline]
    #[must_use]
    pub const fn numbers(self) -> [f64; Self::WIDTH] {
        self.0
    }

    /// The number of one lane; NaN where there is none.
    #[inline]
    #[must_use]
    pub fn lane(&self, lane: usize) -> f64 {
        self.0.get(lane).copied().unwrap_or(f64::NAN)
    }

    /// Puts a number into one lane; a lane that there is not stays out.
    #[inline]
    pub fn set(&mut self, lane: usize, number: f64) {
        if let Some(slot) = self.0.get_mut(lane) {
            *slot = number;
        }
    }

    /// The numbers of all lanes, to be changed one by one.
    #[inline]
    pub(crate) fn iter_mut(&mut self) -> core::slice::IterMut<'_, f64> {
        self.0.iter_mut()
    }

    /// A function of every lane.
    #[inline]
    pub(crate) fn map(mut self, mut of: impl FnMut(f64) -> f64) -> Self {
        for number in &mut self.0 {
            *number = of(*number);
        }
        self
    }

    /// A function of every lane and its counterpart.
    #[inline]
    pub(crate) fn zip(mut self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        for (number, other) in self.0.iter_mut().zip(&other.0) {
            *number = of(*number, *other);
        }
        self
    }
}

impl From<f64> for Lanes {
    /// The same number in every lane.
    #[inline]
    fn from(number: f64) -> Self {
        Self([number; Self::WIDTH])
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Div for Lanes {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl Real for Lanes {
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sines, cosines) = math::sin_cos_each(self.0);
        (Self(sines), Self(cosines))
    }

    #[inline]
    fn sin_cos_each<const N: usize>(angles: [Self; N]) -> ([Self; N], [Self; N]) {
        let (mut sines, mut cosines) = (angles, angles);
        for (sine, cosine) in sines.iter_mut().zip(&mut cosines) {
            (*sine, *cosine) = sine.sin_cos();
        }
        (sines, cosines)
    }

    #[inline]
    fn sqrt(self) -> Self {
        self.map(math::sqrt)
    }

    #[inline]
    fn exp_m1(self) -> Self {
        self.map(math::exp_m1)
    }

    #[inline]
    fn above(self, bound: Self, mut then: Self, otherwise: Self) -> Self {
        let numbers = self.0.iter().zip(&bound.0).zip(&otherwise.0);
        for (then, ((number, bound), otherwise)) in then.0.iter_mut().zip(numbers) {
            *then = if number > bound { *then } else { *otherwise };
        }
        then
    }

    #[inline]
    fn any_above(self, bound: f64) -> bool {
        self.0.iter().any(|number| *number > bound)
    }
}
