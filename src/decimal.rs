//! Numbers as text with nine decimal places. In: a number. Out: the text that the standard library writes for `{:.9}`, but
//! for the sign of a zero. It exists because a table of positions is little else than such numbers, and the library's way
//! takes several times as long.

use std::fmt::Write;

/// Decimal places: of a millimetre a picometre, so that rounding never shows.
const PLACES: usize = 9;

/// The value of each decimal place in units of the last one, beginning with the last.
const POWERS: [u32; PLACES] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// One, in units of the last place.
const ONE: u64 = 1_000_000_000;

/// The longest text that is written here: a sign, 2^64 units of the last place, the point.
const LONGEST: usize = 22;

/// Room for the text of a number.
#[derive(Default)]
pub(crate) struct Decimal {
    text: String,
    digits: [u8; LONGEST],
}

impl Decimal {
    /// The number with fixed places, rounded to the nearest, half to even; a zero has no sign.
    pub(crate) fn text(&mut self, number: f64) -> &[u8] {
        match units(number.abs()) {
            Some(units) => self.write(units, number < 0.0),
            None => {
                self.text.clear();
                // Writing into a string cannot fail.
                let _ = write!(self.text, "{number:.PLACES$}");
                self.text.as_bytes()
            }
        }
    }

    /// Writes from the last digit to the first.
    fn write(&mut self, units: u64, negative: bool) -> &[u8] {
        let negative = negative && units > 0;
        let mut left = LONGEST;
        let mut put = |byte: u8| {
            left = left.saturating_sub(1);
            if let Some(place) = self.digits.get_mut(left) {
                *place = byte;
            }
        };
        // The number of places is fixed, so that no division waits for the one before it.
        let places = (units % ONE) as u32;
        for power in POWERS {
            put(DIGITS[(places / power % 10) as usize]);
        }
        put(b'.');
        let mut whole = units / ONE;
        loop {
            put(DIGITS[(whole % 10) as usize]);
            whole /= 10;
            if whole == 0 {
                break;
            }
        }
        if negative {
            put(b'-');
        }
        self.digits.get(left..).unwrap_or_default()
    }
}

/// The digits.
const DIGITS: [u8; 10] = *b"0123456789";

/// A number that is not negative in units of the last place, rounded to the nearest, half to even; none where that does
/// not fit, and for NaN.
///
/// A double is `m 2^e` with m below 2^53, so that `m 10^9` is exact in 128 bits, and what e cuts off is exact too.
fn units(number: f64) -> Option<u64> {
    let bits = number.to_bits();
    let (exponent, fraction) = (bits >> 52, bits & ((1 << 52) - 1));
    let (mantissa, exponent) = if exponent == 0 { (fraction, 1) } else { (fraction | 1 << 52, exponent) };
    // The library writes numbers from 2^53 on, infinity, NaN and numbers with a sign.
    let cut = u32::try_from(1075_u64.checked_sub(exponent)?).ok()?;
    let exact = u128::from(mantissa) * u128::from(ONE);
    // 2^53 10^9 is below 2^83: such a number is below half a unit, and rounds to zero.
    if cut > 84 {
        return Some(0);
    }
    let (whole, rest, half) = (exact >> cut, exact & ((1 << cut) - 1), (1_u128 << cut) / 2);
    let up = rest > half || rest == half && cut > 0 && whole % 2 == 1;
    u64::try_from(whole + u128::from(up)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the library writes, a zero without its sign.
    fn expected(number: f64) -> String {
        let text = format!("{number:.PLACES$}");
        let zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
        if zero { text.trim_start_matches('-').to_owned() } else { text }
    }

    fn assert_same(number: f64) {
        let mut decimal = Decimal::default();
        for number in [number, -number] {
            let text = std::str::from_utf8(decimal.text(number)).unwrap();
            assert_eq!(text, expected(number), "{:#x}", number.to_bits());
        }
    }

    #[test]
    fn a_zero_has_no_sign() {
        let mut decimal = Decimal::default();
        assert_eq!(decimal.text(-1e-12), b"0.000000000");
        assert_eq!(decimal.text(-0.0), b"0.000000000");
        assert_eq!(decimal.text(-1.5), b"-1.500000000");
    }

    #[test]
    fn halves_go_to_the_even_side() {
        // 1024 has ten binary places, so that these end in a 5 in the tenth decimal one.
        for odd in (1..4096_u32).step_by(2) {
            assert_same(f64::from(odd) / 1024.0);
        }
        let mut decimal = Decimal::default();
        assert_eq!(decimal.text(1.0 / 1024.0), b"0.000976562");
        assert_eq!(decimal.text(3.0 / 1024.0), b"0.002929688");
    }

    #[test]
    fn every_size_of_number_is_what_the_library_writes() {
        let mut state = 1_u64;
        for exponent in 0..2048_u64 {
            for _ in 0..40 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                assert_same(f64::from_bits(exponent << 52 | state >> 12));
            }
            for fraction in [0, 1, (1 << 52) - 1, 1 << 51] {
                assert_same(f64::from_bits(exponent << 52 | fraction));
            }
        }
    }

    #[test]
    fn numbers_of_machines_and_their_neighbours() {
        let mut state = 7_u64;
        for _ in 0..200_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            // Up to 2000 mm in steps of 0.5e-9: every other one lies as near to a half as a double can.
            let number = (state % 4_000_000_000_000) as f64 * 0.5e-9;
            assert_same(number);
            assert_same(number.next_up());
            assert_same(number.next_down());
        }
    }
}
