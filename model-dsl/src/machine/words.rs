//! Names and lengths as machine files write them. In: text. Out: whether it is one, or its value.

use crate::algebra::{Rational, decimal};

/// Whether a text can name a constant, a symbol or a link.
pub(super) fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// The units of length with their size in mm; a unit stands before one that it ends in.
const LENGTHS: [(&str, &str); 9] = [
    ("mm", "1"),
    ("um", "0.001"),
    ("\u{b5}m", "0.001"),
    ("nm", "0.000001"),
    ("cm", "10"),
    ("mil", "0.0254"),
    ("uin", "0.0000254"),
    ("in", "25.4"),
    ("m", "1000"),
];

/// A length in mm as an exact fraction, from a bare number (mm) or a number with a unit of length.
pub(super) fn exact_length(text: &str) -> Option<Rational> {
    let text = text.trim();
    let with_unit = || {
        let (number, size) =
            LENGTHS.iter().find_map(|(unit, size)| Some((text.strip_suffix(unit)?, size)))?;
        Some(decimal(number.trim_end())? * decimal(size)?)
    };
    decimal(text).or_else(with_unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_of_any_unit_are_exact() {
        for (text, millimetres) in [
            ("120", "120"),
            ("120mm", "120"),
            ("2 mil", "0.0508"),
            ("1 in", "25.4"),
            ("1e3 um", "1"),
            ("-3 cm", "-30"),
            ("2 m", "2000"),
        ] {
            assert_eq!(exact_length(text), decimal(millimetres), "{text}");
        }
        for text in ["mm", "2 deg", "X1", "2 mm mm", ""] {
            assert_eq!(exact_length(text), None, "{text}");
        }
    }
}
