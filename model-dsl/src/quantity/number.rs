//! Decimal numbers as people write them in YAML: `2`, `+2`, `-.5`, `5.`, `1e-3`.

use super::{QuantityError, finite};
use std::ops::Range;

/// Reads a number that fills the text, white space around it aside.
///
/// # Errors
///
/// E0301 not a number, E0302 not finite, E0303 a decimal comma.
pub fn parse_number(text: &str) -> Result<f64, QuantityError> {
    let (value, range) = leading_number(text)?;
    let rest = text.get(range.end..).unwrap_or("");
    if rest.trim().is_empty() {
        return Ok(value);
    }
    let message = format!("`{}` is not a number", text.trim());
    Err(QuantityError::new("E0301", trimmed(text), message)
        .help("write a bare number such as `2`, `-0.5` or `1e-3`"))
}

/// Reads the number at the beginning of a text and tells where it stands.
pub(super) fn leading_number(text: &str) -> Result<(f64, Range<usize>), QuantityError> {
    let start = trimmed(text).start;
    let body = text.get(start..).unwrap_or("");
    let length = number_length(body);
    let written = body.get(..length).unwrap_or("");
    let Ok(value) = written.parse::<f64>() else {
        return Err(not_a_number(text));
    };
    let range = start..start + length;
    if let Some(error) = decimal_comma(text, &range) {
        return Err(error);
    }
    let value = finite(value, written).map_err(|error| error.moved(start))?;
    Ok((value, range))
}

fn trimmed(text: &str) -> Range<usize> {
    let start = text.len() - text.trim_start().len();
    start..start + text.trim().len()
}

/// How many bytes at the beginning belong to a number; none where there is no digit.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes.iter().skip(from).take_while(|byte| byte.is_ascii_digit()).count();
    let is = |at: usize, any: &[u8]| bytes.get(at).is_some_and(|byte| any.contains(byte));
    let sign = usize::from(is(0, b"+-"));
    let whole = digits(sign);
    let mut end = sign + whole;
    let mut fraction = 0;
    if is(end, b".") {
        fraction = digits(end + 1);
        end += 1 + fraction;
    }
    if whole + fraction == 0 {
        return 0;
    }
    if is(end, b"eE") {
        let exponent = end + 1 + usize::from(is(end + 1, b"+-"));
        let length = digits(exponent);
        if length > 0 {
            end = exponent + length;
        }
    }
    end
}

fn decimal_comma(text: &str, number: &Range<usize>) -> Option<QuantityError> {
    let rest = text.get(number.end..)?;
    let decimals = rest.strip_prefix(',')?;
    let length = decimals.bytes().take_while(u8::is_ascii_digit).count();
    if length == 0 {
        return None;
    }
    let whole = text.get(number.clone())?;
    let decimals = decimals.get(..length)?;
    let range = number.start..number.end + 1 + length;
    let message = format!("`{whole},{decimals}` has a decimal comma");
    Some(QuantityError::new("E0303", range, message).help(format!("write a point: `{whole}.{decimals}`")))
}

fn not_a_number(text: &str) -> QuantityError {
    let range = trimmed(text);
    let written = text.trim();
    let bare = written.trim_start_matches(['+', '-', '.']).to_ascii_lowercase();
    if ["nan", "inf", "infinity"].iter().any(|word| bare.split_whitespace().next() == Some(word)) {
        let message = format!("`{written}` is not a finite number");
        return QuantityError::new("E0302", range, message)
            .help("leave the entry out, or write the number that was measured");
    }
    let error = QuantityError::new("E0301", range, format!("`{written}` does not begin with a number"));
    if written.starts_with(['\u{2212}', '\u{2013}']) {
        return error.help("write the minus sign as `-`");
    }
    error.help("write a number and its unit, such as `10 um`")
}
