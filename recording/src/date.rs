//! When something was measured. In: a date as ISO 8601 writes it. Out: seconds, a month, and text again.
//!
//! It is the calendar and the clock of whoever measured: recordings of one machine are put in order by it, and a zone that is written
//! is taken off, so that all of them count alike.

use std::fmt;

use chrono::{DateTime, Datelike, NaiveDate};
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::yaml::Node;

/// A moment of the Gregorian calendar, of years 1 to 9999.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Moment {
    /// Seconds since 1970 began.
    seconds: i64,
}

/// The seconds at which the year 1 begins.
const FIRST: i64 = -62_135_596_800;

/// The code for what is no date.
const NO_DATE: &str = "E0631";

impl Moment {
    /// The moment so many seconds after 1970 began; nothing outside years 1 to 9999.
    #[must_use]
    pub fn new(seconds: i64) -> Option<Self> {
        let year = DateTime::from_timestamp(seconds, 0)?.year();
        (1..=9999).contains(&year).then_some(Self { seconds })
    }

    /// The first moment there is.
    #[must_use]
    pub fn first() -> Self {
        Self { seconds: FIRST }
    }

    /// A date with a time of day: nothing where there is no such day or time.
    #[must_use]
    pub fn of([year, month, day]: [i64; 3], [hour, minute, second]: [i64; 3]) -> Option<Self> {
        let small = |number: i64| u32::try_from(number).ok();
        let date = NaiveDate::from_ymd_opt(i32::try_from(year).ok()?, small(month)?, small(day)?)?;
        let moment = date.and_hms_opt(small(hour)?, small(minute)?, small(second)?)?;
        Self::new(moment.and_utc().timestamp())
    }

    /// Reads `2026-07-09`, `2026-07-09 22:59` and `2026-07-09T22:59:28`, with `Z` or `+02:00` behind a time.
    #[must_use]
    pub fn read(text: &str) -> Option<Self> {
        let text = text.trim();
        let (date, time) = match text.split_once(['T', 't', ' ']) {
            Some((date, time)) => (date, Some(time)),
            None => (text, None),
        };
        let date = numbers::<3>(date, '-', [4, 2, 2])?;
        let Some(time) = time else { return Self::of(date, [0; 3]) };
        let (time, zone) = match time.strip_suffix(['Z', 'z']) {
            Some(time) => (time, 0),
            None => zoned(time)?,
        };
        // Parts of a second order nothing.
        let (time, part) = time.split_once('.').unwrap_or((time, "0"));
        if part.is_empty() || !part.bytes().all(|digit| digit.is_ascii_digit()) {
            return None;
        }
        let whole = numbers::<3>(time, ':', [2, 2, 2]);
        let clock =
            whole.or_else(|| numbers::<2>(time, ':', [2, 2]).map(|[hour, minute]| [hour, minute, 0]))?;
        Self::new(Self::of(date, clock)?.seconds.checked_sub(zone)?)
    }

    /// Seconds since 1970 began.
    #[must_use]
    pub fn seconds(self) -> i64 {
        self.seconds
    }

    /// `2026-07`.
    #[must_use]
    pub fn month(self) -> String {
        self.written("%Y-%m")
    }

    /// `2026-07-09`.
    #[must_use]
    pub fn day(self) -> String {
        self.written("%Y-%m-%d")
    }

    fn written(self, form: &str) -> String {
        DateTime::from_timestamp(self.seconds, 0)
            .map(|moment| moment.format(form).to_string())
            .unwrap_or_default()
    }
}

impl fmt::Display for Moment {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.written("%Y-%m-%dT%H:%M:%S"))
    }
}

/// When a recording was made, where its file says so.
#[must_use]
pub fn date_of(root: &Node) -> Option<Moment> {
    Moment::read(root.get("date")?.text()?)
}

/// Reports a date that is none (E0631).
pub(super) fn check_date(node: &Node, diagnostics: &mut Diagnostics) {
    let read = node.text().and_then(Moment::read);
    if read.is_none() {
        let found = node.text().map_or_else(|| node.kind_name().to_owned(), |text| format!("`{text}`"));
        let mistake = Diagnostic::error(NO_DATE, node.span, format!("`date` must be a date, found {found}"));
        diagnostics.push(mistake.help("write `2026-07-09`, or `2026-07-09T22:59:28` with the time"));
    }
}

/// Numbers of so many digits each.
fn numbers<const N: usize>(text: &str, between: char, digits: [usize; N]) -> Option<[i64; N]> {
    let mut found = [0; N];
    let mut parts = text.split(between);
    for (number, digits) in found.iter_mut().zip(digits) {
        let part = parts
            .next()
            .filter(|part| part.len() == digits && part.bytes().all(|digit| digit.is_ascii_digit()))?;
        *number = part.parse().ok()?;
    }
    parts.next().is_none().then_some(found)
}

/// A time of day, and the seconds by which its zone is ahead.
fn zoned(time: &str) -> Option<(&str, i64)> {
    let Some(place) = time.find(['+', '-']) else { return Some((time, 0)) };
    let (clock, zone) = time.split_at_checked(place)?;
    let (sign, zone) = (if zone.starts_with('-') { -1 } else { 1 }, zone.get(1..)?);
    let parts =
        numbers::<2>(zone, ':', [2, 2]).or_else(|| numbers::<1>(zone, ':', [2]).map(|[hour]| [hour, 0]));
    let [hour, minute] = parts.filter(|[hour, minute]| *hour < 24 && *minute < 60)?;
    Some((clock, sign * (hour * 3600 + minute * 60)))
}

#[cfg(test)]
mod tests {
    use super::Moment;

    #[test]
    fn dates_are_counted_as_calendars_do() {
        let seconds = |text| Moment::read(text).map(Moment::seconds);
        assert_eq!(seconds("1970-01-01"), Some(0));
        assert_eq!(seconds("2000-03-01"), Some(951_868_800));
        assert_eq!(seconds("2026-07-09T22:59:28"), Some(1_783_637_968));
        assert_eq!(seconds("2026-07-09 22:59"), Some(1_783_637_940));
        assert_eq!(seconds("2026-07-09T22:59:28Z"), seconds("2026-07-10T00:59:28+02:00"));
        assert_eq!(seconds("2026-07-09T22:59:28.75"), seconds("2026-07-09T17:59:28-05"));
    }

    #[test]
    fn every_day_comes_back_as_it_was_written() {
        for text in ["0001-01-01", "1900-02-28", "2000-02-29", "2024-12-31", "9999-12-31"] {
            let read = Moment::read(text).unwrap();
            assert_eq!((read.day(), read.to_string()), (text.to_owned(), format!("{text}T00:00:00")));
        }
        assert_eq!(Moment::read("2026-07-09").unwrap().month(), "2026-07");
    }

    #[test]
    fn what_is_no_day_is_none() {
        let wrong = [
            "2026",
            "2026-7-9",
            "2026-02-29",
            "1900-02-29",
            "2026-13-01",
            "2026-04-31",
            "0000-01-01",
            "2026-07-09T24:00",
            "2026-07-09T1:00",
            "2026-07-09T10:00+25:00",
            "2026-07-09T10:00:00.",
            "09.07.2026",
            "",
            "2026-07-09T",
        ];
        for text in wrong {
            assert_eq!(Moment::read(text), None, "{text}");
        }
    }
}
