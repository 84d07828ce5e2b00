//! Exact coefficients. In: decimal text. Out: a fraction of two integers of any size.
//!
//! Coefficients are exact so that two derivations of one equation are equal or not, never
//! equal up to rounding.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};

/// An exact fraction of integers of any size.
pub type Rational = BigRational;

/// The most decimal places, or powers of ten, that a number in a file may have.
const MOST_PLACES: i64 = 40;

/// Reads a decimal number (`12`, `-0.25`, `+3e-4`) exactly; `None` where it is not one, or
/// has more than forty places or powers of ten.
pub fn decimal(text: &str) -> Option<Rational> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i64>().ok()?),
        None => (text, 0),
    };
    let (negative, digits) = match mantissa.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, mantissa.strip_prefix('+').unwrap_or(mantissa)),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let all_digits = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    if whole.is_empty() && fraction.is_empty() || !all_digits(whole) || !all_digits(fraction) {
        return None;
    }
    let places = i64::try_from(fraction.len()).ok()?;
    let power = exponent.checked_sub(places)?;
    if power.abs() > MOST_PLACES || whole.len() > 40 {
        return None;
    }
    let value: BigInt = format!("0{whole}{fraction}").parse().ok()?;
    let scale = num_traits::pow(BigInt::from(10), usize::try_from(power.unsigned_abs()).ok()?);
    let value = if negative { -value } else { value };
    Some(if power < 0 { Rational::new(value, scale) } else { Rational::from_integer(value * scale) })
}

/// The nearest double.
pub fn to_f64(value: &Rational) -> f64 {
    if value.is_zero() {
        0.0
    } else if value.is_one() {
        1.0
    } else {
        value.to_f64().unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_exact() {
        let tenth = Rational::new(1.into(), 10.into());
        assert_eq!(decimal("0.1"), Some(tenth.clone()));
        assert_eq!(decimal("1e-1"), Some(tenth.clone()));
        assert_eq!(decimal("-.1"), Some(-tenth));
        assert_eq!(decimal("2.50e2"), Some(Rational::from_integer(250.into())));
        assert_eq!(decimal("+7."), Some(Rational::from_integer(7.into())));
    }

    #[test]
    fn forty_digits_and_places_are_the_most() {
        let digits = |count: usize| "7".repeat(count);
        assert_eq!(decimal(&digits(40)).map(|value| value.to_string()), Some(digits(40)));
        assert_eq!((decimal(&digits(41)), decimal(&digits(42))), (None, None));
        assert!(decimal("1e40").is_some() && decimal("1e-40").is_some());
        assert_eq!((decimal("1e41"), decimal("1e-41")), (None, None));
    }

    #[test]
    fn what_is_not_a_number_or_is_absurd_is_refused() {
        // Integers of any size may be written with underscores in Rust, and numbers of a file may not.
        for text in ["", ".", "1,5", "x", "1e", "1e999999999", "--1", "0x1", "1_0", "1.5_0", "1.-5", "_1.5"] {
            assert_eq!(decimal(text), None, "{text}");
        }
    }
}
