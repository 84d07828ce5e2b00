//! Numbers as controllers read them. In: a number and how many decimals it is to have. Out: its digits, without an exponent and
//! without a negative zero.

/// A number with so many decimals.
pub(super) fn decimal(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|digit| matches!(digit, b'0' | b'.')) => digits.to_owned(),
        _ => text,
    }
}
