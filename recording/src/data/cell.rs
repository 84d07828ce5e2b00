//! One cell: a number, nothing, or why it is neither.

use super::error::shown;

/// What is wrong with a cell, and what to write instead.
pub(super) struct BadCell {
    pub(super) message: String,
    pub(super) help: String,
}

/// The number of a cell; NaN where it is empty, `nan` or `null`.
///
/// # Errors
///
/// Text that is no number, and numbers that are not finite.
pub(super) fn number(cell: &[u8]) -> Result<f64, BadCell> {
    let text = std::str::from_utf8(cell).unwrap_or("?");
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() || value.is_nan() => Ok(value),
        Ok(_) => Err(not_finite(cell)),
        Err(_) if text.is_empty() || text.eq_ignore_ascii_case("null") => Ok(f64::NAN),
        Err(_) => Err(not_a_number(cell, text)),
    }
}

fn not_finite(cell: &[u8]) -> BadCell {
    BadCell {
        message: format!("`{}` is not a finite number", shown(cell)),
        help: "leave the cell empty where nothing was measured".to_owned(),
    }
}

fn not_a_number(cell: &[u8], text: &str) -> BadCell {
    let with_point = text.replacen(',', ".", 1);
    if text.contains(',') && with_point.parse::<f64>().is_ok() {
        return BadCell {
            message: format!("`{}` has a decimal comma", shown(cell)),
            help: format!("write a point, `{with_point}`, in the whole file"),
        };
    }
    let help = if text.starts_with(['\u{2212}', '\u{2013}']) {
        "write the minus sign as `-`"
    } else {
        "write a number such as `-0.5` or `1e-3`; leave the cell empty where nothing was measured"
    };
    BadCell { message: format!("`{}` is not a number", shown(cell)), help: help.to_owned() }
}

/// The number of a run, which every row must have.
///
/// # Errors
///
/// Text that is no whole number.
pub(super) fn run(cell: &[u8]) -> Result<i64, BadCell> {
    let text = std::str::from_utf8(cell).unwrap_or("?");
    // Tables that passed through floating point have `1.0`.
    let whole = text.split_once('.').filter(|(_, zeros)| zeros.bytes().all(|byte| byte == b'0'));
    let whole = whole.map_or(text, |(whole, _)| whole);
    whole.parse().map_err(|_| BadCell {
        message: match text {
            "" => "the row does not tell its run".to_owned(),
            _ => format!("`{}` is not a whole number", shown(cell)),
        },
        help: "number the repeats 1, 2, 3, one number in every row".to_owned(),
    })
}
