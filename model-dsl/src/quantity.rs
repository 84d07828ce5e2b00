//! Quantities: numbers with units, such as `10 um`, `-28.67 urad`, `16.28 1/s` or `11.5 um/m/K`.
//!
//! In: the text of one scalar. Out: its value in the units used everywhere inside (mm, rad, s, degC, N; V, A, % and
//! count as they are) with its dimension, or an error that knows which part of the text is wrong. Findings E0301 to
//! E0309 come from here: see [`QuantityError`] and [`read`].

mod column;
mod dimension;
mod number;
mod reading;
mod unit;

pub use column::unit_in_name;
pub use dimension::Dimension;
pub use number::parse_number;
pub use reading::{read, read_number, read_per_load, read_temperature_step, read_unit};
pub use unit::{UNIT_NAMES, Unit, parse_unit, unit_name, unit_of_word};

use crate::diagnostic::Diagnostic;
use crate::source::Span;
use std::ops::Range;

/// A number with its unit, or without one.
#[derive(Clone, PartialEq, Debug)]
pub struct Quantity {
    /// The value in mm, rad, s, degC, N, V, A, % or count and in ratios of these. A temperature that stands alone is in
    /// degC whatever it was written in (`68 degF` and `293.15 K` are 20); in a ratio, degC and K are the same step.
    pub value: f64,
    /// What kind of quantity it is; [`Dimension::NONE`] for a bare number as well as for a ratio such as `um/m`.
    pub dimension: Dimension,
    /// The text as it was written.
    pub written: String,
    /// Where the number stands in that text, in bytes.
    pub number: Range<usize>,
    /// Where the unit stands in that text, in bytes; empty for a bare number.
    pub unit: Range<usize>,
}

impl Quantity {
    /// Whether no unit was written.
    pub fn is_bare(&self) -> bool {
        self.unit.is_empty()
    }

    /// What it is, in words: `a bare number`, `a ratio`, `a length per temperature`.
    pub fn kind_name(&self) -> String {
        match (self.is_bare(), self.dimension == Dimension::NONE) {
            (true, _) => "a bare number".to_owned(),
            (false, true) => "a ratio".to_owned(),
            (false, false) => self.dimension.name(),
        }
    }

    /// The number as it was written.
    pub fn written_number(&self) -> &str {
        self.written.get(self.number.clone()).unwrap_or("")
    }

    /// The unit as it was written.
    pub fn written_unit(&self) -> &str {
        self.written.get(self.unit.clone()).unwrap_or("")
    }
}

/// Why a text is no quantity.
///
/// Codes: E0301 not a number, E0302 not finite, E0303 a decimal comma, E0304 an unknown unit, E0305 a unit badly put
/// together.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct QuantityError {
    /// The code of the finding.
    pub code: &'static str,
    /// What is wrong, in one sentence.
    pub message: String,
    /// Which bytes of the text are wrong.
    pub range: Range<usize>,
    /// What to write instead.
    pub help: Option<String>,
}

/// Why a text is no unit: E0304 or E0305.
pub type UnitError = QuantityError;

impl QuantityError {
    fn new(code: &'static str, range: Range<usize>, message: impl Into<String>) -> Self {
        let message = message.into();
        Self { code, message, range, help: None }
    }

    fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    fn moved(mut self, bytes: usize) -> Self {
        self.range = self.range.start + bytes..self.range.end + bytes;
        self
    }

    /// The finding, with the place that the wrong part has in the file.
    pub fn diagnostic(self, span: Span) -> Diagnostic {
        let diagnostic = Diagnostic::error(self.code, span, self.message);
        match self.help {
            Some(help) => diagnostic.help(help),
            None => diagnostic,
        }
    }
}

impl std::fmt::Display for QuantityError {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl std::error::Error for QuantityError {}

/// Reads a number with or without a unit; a space between them may be left out.
///
/// # Errors
///
/// Every code of [`QuantityError`].
pub fn parse_quantity(text: &str) -> Result<Quantity, QuantityError> {
    let (value, number) = number::leading_number(text)?;
    let rest = text.get(number.end..).unwrap_or("");
    let unit_start = number.end + (rest.len() - rest.trim_start().len());
    let unit_text = rest.trim();
    let range = unit_start..unit_start + unit_text.len();
    let quantity =
        Quantity { value, dimension: Dimension::NONE, written: text.to_owned(), number, unit: range };
    if unit_text.is_empty() {
        return Ok(quantity);
    }
    let unit = parse_unit(unit_text).map_err(|error| error.moved(unit_start))?;
    let value = finite(unit.to_internal(value), text)?;
    Ok(Quantity { value, dimension: unit.dimension, ..quantity })
}

fn finite(value: f64, text: &str) -> Result<f64, QuantityError> {
    if value.is_finite() {
        return Ok(value);
    }
    let message = format!("`{}` is too large", text.trim());
    Err(QuantityError::new("E0302", 0..text.len(), message))
}

#[cfg(test)]
mod tests;
