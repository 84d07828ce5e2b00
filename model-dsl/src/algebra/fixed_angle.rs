//! Angles that never change, such as the 45 degrees of a nutating head. In: degrees, exact. Out: the sine and the cosine of the angle as
//! exact polynomials, whose squares add up to one.
//!
//! A sine or cosine of an angle of a machine file is rarely a fraction, so that it stands as a symbol of its own beside those of rotary
//! axes, and follows the same rule: a squared sine is one minus a squared cosine. Rotations made of such symbols are exact, whatever the
//! angle, and their decimals come in where everything gets numbers. Angles are brought to 0 to 45 degrees first, so that cos(70 deg) and
//! sin(20 deg) are one symbol; at 30, 45 and 60 degrees the values and squares that are fractions are written as such.

use std::fmt;
use std::sync::Arc;

use abbe_runtime::math::sin_cos;
use num_traits::{Signed as _, Zero};

use super::{Name, Polynomial, Rational, Symbol, to_f64};

/// An angle between 0 and 45 degrees that never changes.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FixedAngle {
    degrees: Arc<Rational>,
    name: Name,
}

impl FixedAngle {
    fn new(degrees: Rational) -> Self {
        let name = format!("{degrees} deg").into();
        Self { degrees: Arc::new(degrees), name }
    }

    /// The angle: deg.
    pub fn degrees(&self) -> &Rational {
        &self.degrees
    }

    /// The angle with its unit, `45 deg`; of an angle that is no whole number its fraction.
    pub fn name(&self) -> &Name {
        &self.name
    }

    /// The nearest double of its sine.
    pub fn sine(&self) -> f64 {
        sin_cos(self.radians()).0
    }

    /// The nearest double of its cosine.
    pub fn cosine(&self) -> f64 {
        sin_cos(self.radians()).1
    }

    fn radians(&self) -> f64 {
        to_f64(&self.degrees).to_radians()
    }

    fn is(&self, degrees: i64) -> bool {
        *self.degrees == whole(degrees)
    }

    /// The square of the cosine, where it is a fraction.
    pub(super) fn squared_cosine(&self) -> Option<Rational> {
        let quarters = if self.is(30) { 3 } else { 2 };
        (self.is(30) || self.is(45)).then(|| Rational::new(quarters.into(), 4.into()))
    }
}

impl fmt::Display for FixedAngle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

/// The sine and the cosine of an angle in degrees.
pub fn sine_and_cosine(degrees: &Rational) -> (Polynomial, Polynomial) {
    let turn = whole(360);
    let mut angle = degrees % &turn;
    if angle > whole(180) {
        angle -= &turn;
    } else if angle < whole(-180) {
        angle += &turn;
    }
    let left_handed = angle.is_negative();
    let size = angle.abs();
    let obtuse = size > whole(90);
    let acute = if obtuse { whole(180) - size } else { size };
    let (sine, cosine) = of_acute(acute);
    (if left_handed { -&sine } else { sine }, if obtuse { -&cosine } else { cosine })
}

/// The same of an angle from 0 to 90 degrees.
fn of_acute(degrees: Rational) -> (Polynomial, Polynomial) {
    if degrees > whole(45) {
        let (sine, cosine) = of_half(whole(90) - degrees);
        (cosine, sine)
    } else {
        of_half(degrees)
    }
}

/// The same of an angle from 0 to 45 degrees.
fn of_half(degrees: Rational) -> (Polynomial, Polynomial) {
    if degrees.is_zero() {
        return (Polynomial::zero(), Polynomial::one());
    }
    let angle = FixedAngle::new(degrees);
    let cosine = Polynomial::symbol(Symbol::FixedCos(angle.clone()));
    let sine = if angle.is(30) {
        Polynomial::number(Rational::new(1.into(), 2.into()))
    } else if angle.is(45) {
        cosine.clone()
    } else {
        Polynomial::symbol(Symbol::FixedSin(angle))
    };
    (sine, cosine)
}

fn whole(degrees: i64) -> Rational {
    Rational::from_integer(degrees.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn both(degrees: &str) -> (Polynomial, Polynomial) {
        sine_and_cosine(&super::super::decimal(degrees).expect("a number"))
    }

    /// Over all quadrants and beyond a whole turn, against sines and cosines of floating point.
    #[test]
    fn the_values_are_those_of_the_angle() {
        for tenths in -7300_i32..=7300 {
            let degrees = f64::from(tenths) / 10.0;
            let (sine, cosine) = both(&degrees.to_string());
            let radians = degrees.to_radians();
            let apart = |value: &Polynomial, expected: f64| (value.evaluate(|_| f64::NAN) - expected).abs();
            assert!(apart(&sine, radians.sin()) < 1e-14, "{degrees}");
            assert!(apart(&cosine, radians.cos()) < 1e-14, "{degrees}");
        }
    }

    #[test]
    fn the_squares_add_up_to_one_exactly() {
        for degrees in ["0", "20", "30", "42.5", "45", "60", "70", "90", "111.1", "180", "-45", "-90", "405"]
        {
            let (sine, cosine) = both(degrees);
            assert!((&(&sine * &sine) + &(&cosine * &cosine)).is_one(), "{degrees}");
        }
    }

    /// One value is one polynomial: complements, opposites and whole turns.
    #[test]
    fn equal_values_are_written_alike() {
        assert_eq!(both("20").0, both("70").1);
        assert_eq!(both("-20").0, -&both("20").0);
        assert_eq!(both("160"), (both("20").0, -&both("20").1));
        assert_eq!(both("380"), both("20"));
        assert_eq!(both("45").0, both("45").1);
        assert_eq!(both("60").1, both("30").0);
        assert_eq!(both("30").0, Polynomial::number(Rational::new(1.into(), 2.into())));
        assert_eq!(both("90"), (Polynomial::one(), Polynomial::zero()));
        let (sine, cosine) = both("45");
        assert_eq!(&sine * &cosine, Polynomial::number(Rational::new(1.into(), 2.into())));
    }
}
