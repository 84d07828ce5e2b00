//! Names and lengths as machine files write them. In: text. Out: whether it is one, or its value.

use crate::algebra::{Rational, decimal};

/// Whether a text can name a constant, a symbol or a link.
pub(super) fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// A length in mm as an exact fraction, from a bare number (mm) or a number with a unit of length.
pub(super) fn exact_length(text: &str) -> Option<Rational> {
    if let Some(number) = decimal(text.trim()) {
        return Some(number);
    }
    let (number, unit) = text.trim().split_once(' ')?;
    let per_mm = match unit.trim() {
        "mm" => "1",
        "m" => "1000",
        "um" => "0.001",
        "in" => "25.4",
        _ => return None,
    };
    Some(decimal(number)? * decimal(per_mm)?)
}
