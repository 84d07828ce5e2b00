//! One cell: a number, nothing, or why it is neither.

use super::super::cells::thousands;
use super::error::shown;
use super::stamp::{Stamp, whole_of};

/// What is wrong with a cell, and what to write instead.
pub(super) struct BadCell {
    pub(super) message: String,
    pub(super) help: String,
}

/// The number of a cell with a decimal point, or with a comma; NaN where it is empty, `nan` or `null`.
///
/// # Errors
///
/// Text that is no number, and numbers that are not finite.
pub(super) fn number(cell: &[u8], decimal_comma: bool) -> Result<f64, BadCell> {
    let text = std::str::from_utf8(cell).unwrap_or("?");
    if decimal_comma && (text.contains('.') || text.contains(',')) {
        return with_comma(cell, text);
    }
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() || value.is_nan() => Ok(value),
        Ok(_) => Err(not_finite(cell)),
        Err(_) if text.is_empty() || text.eq_ignore_ascii_case("null") => Ok(f64::NAN),
        Err(_) => Err(not_a_number(cell, text)),
    }
}

/// The number of a text with a decimal comma.
fn with_comma(cell: &[u8], text: &str) -> Result<f64, BadCell> {
    if text.contains('.') {
        return Err(BadCell {
            message: format!("`{}` has a point, but the decimal sign is a comma", shown(cell)),
            help: "write a comma instead of a point in every number, or remove `decimal` from the recording file"
                .to_owned(),
        });
    }
    number(text.replacen(',', ".", 1).as_bytes(), false)
        .map_err(|bad| BadCell { message: format!("`{}` is not a number", shown(cell)), ..bad })
}

/// The time stamp of a cell, with all its digits.
///
/// # Errors
///
/// Those of [`number`], and a date where numbers are.
pub(super) fn stamp(cell: &[u8], decimal_comma: bool) -> Result<Stamp, BadCell> {
    let text = std::str::from_utf8(cell).unwrap_or("?");
    let value = number(cell, decimal_comma).map_err(|bad| match Stamp::date(text) {
        Ok(_) => is_date(&format!("`{}`", shown(cell))),
        Err(_) => bad,
    })?;
    if !decimal_comma {
        return Ok(Stamp::digits(text, value));
    }
    Ok(Stamp::digits(&text.replacen(',', ".", 1), value))
}

/// The time stamp of cells that are dates: one, or a date and a time of day.
///
/// # Errors
///
/// Text that is no date.
pub(super) fn date(cells: &[&[u8]]) -> Result<Stamp, BadCell> {
    let texts: Vec<_> = cells.iter().map(|cell| String::from_utf8_lossy(cell)).collect();
    if texts.iter().all(|text| text.is_empty()) {
        return Ok(Stamp::MISSING);
    }
    Stamp::date(&texts.join(" "))
}

/// A date where the recording file has numbers.
pub(super) fn is_date(what: &str) -> BadCell {
    BadCell {
        message: format!("{what} is a date, not a number"),
        help: "write `unit: date` for this channel in the recording file".to_owned(),
    }
}

/// A number where the recording file has dates.
pub(super) fn is_no_date(what: &str) -> BadCell {
    BadCell {
        message: format!("{what} is a number, not a date"),
        help: "write the unit of the times, `unit: s`, instead of `unit: date` in the recording file"
            .to_owned(),
    }
}

fn not_finite(cell: &[u8]) -> BadCell {
    BadCell {
        message: format!("`{}` is not a finite number", shown(cell)),
        help: "leave the cell empty if nothing was measured".to_owned(),
    }
}

fn not_a_number(cell: &[u8], text: &str) -> BadCell {
    if let Some(help) = thousands(text) {
        return BadCell { message: format!("`{}` has a comma", shown(cell)), help };
    }
    let with_point = text.replacen(',', ".", 1);
    if text.contains(',') && with_point.parse::<f64>().is_ok() {
        return BadCell {
            message: format!("`{}` has a decimal comma", shown(cell)),
            help: format!(
                "write a point, `{with_point}`, in the whole file, or `data: {{file: ..., decimal: \",\"}}` in the recording file"
            ),
        };
    }
    let help = if text.starts_with(['\u{2212}', '\u{2013}']) {
        "write the minus sign as `-`"
    } else {
        "write a number such as `-0.5` or `1e-3`; leave the cell empty if nothing was measured"
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
    // Tables that passed through floating point have `1.0` or `1.000e+00`.
    let whole = || text.parse::<f64>().ok().filter(|number| number.fract() == 0.0 && number.abs() < 1e15);
    text.parse().ok().or_else(|| whole().map(whole_of)).ok_or_else(|| BadCell {
        message: match text {
            "" => "the row has no run".to_owned(),
            _ => format!("`{}` is not a whole number", shown(cell)),
        },
        help: "number the repeats 1, 2, 3, with one number in every row".to_owned(),
    })
}
