//! Exact numbers in print. In: a positive fraction. Out: its digits, as a decimal where it has an end.

use num_traits::One;

use crate::algebra::Rational;

/// The most decimal places that are written out; a longer number stays a fraction.
const MOST_PLACES: usize = 12;

/// A number of the tree, never negative: the sign belongs to the sum it stands in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Number {
    /// The digits over the bar.
    pub numerator: String,
    /// The digits under the bar, unless they are 1.
    pub denominator: Option<String>,
    /// The same as a decimal, where it ends after a few places.
    pub decimal: Option<String>,
}

impl Number {
    /// The digits of a fraction; a minus sign would be dropped.
    pub fn new(value: &Rational) -> Self {
        let (numerator, denominator) = (value.numer().magnitude().to_string(), value.denom().magnitude());
        let whole = denominator.is_one();
        Self { decimal: decimal(value), numerator, denominator: (!whole).then(|| denominator.to_string()) }
    }
}

/// The decimal digits of a fraction whose denominator divides a small power of ten.
fn decimal(value: &Rational) -> Option<String> {
    let ten = Rational::from_integer(10.into());
    let mut scaled = value.clone();
    for places in 0..=MOST_PLACES {
        if scaled.is_integer() {
            return Some(point(&scaled.numer().magnitude().to_string(), places));
        }
        scaled *= &ten;
    }
    None
}

fn point(digits: &str, places: usize) -> String {
    if places == 0 {
        return digits.to_owned();
    }
    let padded = format!("{digits:0>width$}", width = places + 1);
    let (whole, fraction) = padded.split_at(padded.len() - places);
    format!("{whole}.{fraction}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(numerator: i64, denominator: i64) -> Number {
        Number::new(&Rational::new(numerator.into(), denominator.into()))
    }

    #[test]
    fn a_decimal_where_it_ends() {
        assert_eq!(number(1, 2).decimal.as_deref(), Some("0.5"));
        assert_eq!(number(127, 5000).decimal.as_deref(), Some("0.0254"));
        assert_eq!(number(30, 1).decimal.as_deref(), Some("30"));
        assert_eq!(number(30, 1).denominator, None);
        assert_eq!(number(1, 3).decimal, None);
        assert_eq!(number(1, 3).denominator.as_deref(), Some("3"));
    }
}
