//! Time stamps that lose nothing: a whole number and what is beyond it.
//!
//! Seconds since 1970 have ten digits, and nanoseconds nineteen: more than a number in floating point holds. So a stamp
//! is kept in two parts until the first one is taken off it.

use std::fmt;

use chrono::{DateTime, NaiveDateTime};

use super::cell::BadCell;
use super::error::shown;

/// A time stamp in the unit of its column; its part is NaN where there is none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stamp {
    whole: i64,
    part: f64,
    /// What it counts, for messages and for what may follow it.
    kind: Kind,
}

/// What a stamp counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Units of the column.
    Number,
    /// Seconds since 1970 of a clock on a wall.
    Local,
    /// Seconds since 1970 in universal time.
    Universal,
}

impl Stamp {
    /// No stamp: an empty cell.
    pub(super) const MISSING: Self = Self { whole: 0, part: f64::NAN, kind: Kind::Number };

    /// A whole number of units.
    pub(super) fn whole(whole: i64) -> Self {
        Self { whole, part: 0.0, kind: Kind::Number }
    }

    /// A number as it is, whatever digits it has lost already.
    pub(super) fn number(value: f64) -> Self {
        Self { whole: 0, part: value, kind: Kind::Number }
    }

    /// Ticks since 1970, so many of which are a second.
    pub(super) fn ticks(ticks: i64, in_second: i64, universal: bool) -> Self {
        let kind = if universal { Kind::Universal } else { Kind::Local };
        let whole = ticks.checked_div_euclid(in_second).unwrap_or_default();
        let rest = ticks.checked_rem_euclid(in_second).unwrap_or_default();
        // Both are below 2^31, where a number in floating point is exact.
        Self { whole, part: rest as f64 / in_second as f64, kind }
    }

    /// Days of a sheet, in seconds. Their number is as exact as a microsecond.
    pub(super) fn days(days: f64) -> Self {
        let within = days.fract() * 86_400.0;
        let whole = whole_of(days.trunc() * 86_400.0).saturating_add(whole_of(within.trunc()));
        Self { whole, part: within.fract(), kind: Kind::Local }
    }

    /// The digits of a text, none of them lost. So many as a number in floating point holds are that number.
    pub(super) fn digits(text: &str, value: f64) -> Self {
        if text.bytes().filter(u8::is_ascii_digit).count() <= f64::DIGITS as usize {
            return Self::number(value);
        }
        let exact = || {
            let (whole, part) = text.split_once('.').unwrap_or((text, ""));
            // What has an exponent has no more digits than a number in floating point.
            if !part.bytes().all(|byte| byte.is_ascii_digit()) {
                return None;
            }
            let sign = if whole.starts_with('-') { "-0." } else { "0." };
            Some(Self {
                whole: whole.parse().ok()?,
                part: format!("{sign}{part}0").parse().ok()?,
                kind: Kind::Number,
            })
        };
        exact().unwrap_or_else(|| Self::number(value))
    }

    /// A date and a time of day by ISO 8601: `2026-07-30T23:15:17.123+02:00`, a space in place of the T, the zone or its
    /// colon left out, seconds with as many digits as there are.
    ///
    /// # Errors
    ///
    /// Text that is none.
    pub(super) fn date(text: &str) -> Result<Self, BadCell> {
        let text = text.trim();
        let joined = if text.contains('T') { text.to_owned() } else { text.replacen(' ', "T", 1) };
        // The standard allows a comma before parts of a second; before the zone many write a space.
        let plain = joined.replace(' ', "").replace(',', ".");
        let zoned = || DateTime::parse_from_str(&plain, "%Y-%m-%dT%H:%M:%S%.f%#z").ok();
        let local = || {
            let formats = ["%Y-%m-%dT%H:%M:%S%.f", "%Y-%m-%dT%H:%M"];
            formats.iter().find_map(|format| NaiveDateTime::parse_from_str(&plain, format).ok())
        };
        if let Some(found) = local() {
            let found = found.and_utc();
            return Ok(Self::at(found.timestamp(), found.timestamp_subsec_nanos(), Kind::Local));
        }
        let found = zoned().ok_or_else(|| BadCell {
            message: format!("`{}` is not a date with a time of day", shown(text.as_bytes())),
            help: "write a time such as `2026-07-30T23:15:17.123`, optionally with a zone such as `+02:00`"
                .to_owned(),
        })?;
        Ok(Self::at(found.timestamp(), found.timestamp_subsec_nanos(), Kind::Universal))
    }

    fn at(whole: i64, nanoseconds: u32, kind: Kind) -> Self {
        Self { whole, part: f64::from(nanoseconds) / 1e9, kind }
    }

    /// A date, and a time of day since it.
    pub(super) fn plus(self, later: Self) -> Self {
        Self { whole: self.whole.saturating_add(later.whole), part: self.part + later.part, ..self }
    }

    /// Whether there is none.
    pub(super) fn is_missing(self) -> bool {
        self.part.is_nan()
    }

    /// Whether it is of another kind of clock, so that nothing can be taken off it.
    pub(super) fn differs_in_kind(self, other: Self) -> bool {
        self.kind != other.kind
    }

    /// How much later it is than another one.
    pub(super) fn since(self, earlier: Self) -> f64 {
        // Two numbers in floating point differ as they are.
        if self.whole == 0 && earlier.whole == 0 {
            return self.part - earlier.part;
        }
        let ((own, part), (before, part_before)) = (self.split(), earlier.split());
        let whole = i128::from(own) - i128::from(before);
        whole as f64 + (part - part_before)
    }

    /// The whole number of units, and what is beyond it by less than one.
    fn split(self) -> (i64, f64) {
        let more = self.part.trunc();
        (self.whole.saturating_add(whole_of(more)), self.part - more)
    }
}

/// A number that is whole; what is beyond the largest is the largest.
#[expect(
    clippy::cast_possible_truncation,
    reason = "it is whole, and what is too large is brought to the end"
)]
pub(super) fn whole_of(value: f64) -> i64 {
    value as i64
}

impl fmt::Display for Stamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let date = DateTime::from_timestamp(self.whole, 0).filter(|_| self.kind != Kind::Number);
        match date {
            Some(date) => write!(f, "{}", date.format("%Y-%m-%dT%H:%M:%S"))?,
            None if self.whole == 0 => return write!(f, "{}", self.part),
            None => write!(f, "{}", self.whole)?,
        }
        let part = self.part.abs().to_string();
        write!(f, "{}", part.strip_prefix('0').unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::Stamp;

    /// The stamp of a text of digits.
    fn stamp(text: &str) -> Stamp {
        Stamp::digits(text, text.parse().unwrap())
    }

    #[test]
    fn stamps_of_few_digits_and_of_many_lose_nothing_beside_each_other() {
        let first = stamp("1785453317.5");
        // One has as many digits as a number in floating point holds, the others more.
        for (text, later) in
            [("1785453317.500001", 1e-6), ("1785453317.500002", 2e-6), ("1785453318.25", 0.75)]
        {
            assert!((stamp(text).since(first) - later).abs() < 1e-12, "{text}");
            assert!((first.since(stamp(text)) + later).abs() < 1e-12, "{text}");
        }
        assert_eq!(stamp("4.221").since(stamp("2.163")), 4.221 - 2.163);
    }
}
