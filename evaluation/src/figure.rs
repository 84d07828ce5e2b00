//! One figure: a number, or why there is none, with what it rests on. In: what was computed. Out: plain data.

use std::f64::consts::PI;

/// One figure of a standard.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The symbol, in plain letters: `R_up`.
    pub symbol: &'static str,
    /// The name.
    pub name: &'static str,
    /// Where it is defined.
    pub source: &'static str,
    /// The value in mm or rad.
    pub value: Given,
    /// The unit.
    pub unit: Unit,
    /// What it rests on.
    pub rests: Rests,
}

/// A value, or why it cannot be given.
#[derive(Clone, Debug, PartialEq)]
pub enum Given {
    /// The value: mm or rad.
    Value(f64),
    /// Why the recording cannot give it; it goes on from "cannot be given from this recording, because".
    Not(String),
}

impl Given {
    /// The value, where there is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Value(value) => Some(*value),
            Self::Not(_) => None,
        }
    }

    /// The reason, where there is no value.
    pub fn reason(&self) -> Option<&str> {
        match self {
            Self::Value(_) => None,
            Self::Not(reason) => Some(reason),
        }
    }
}

impl From<Result<f64, String>> for Given {
    fn from(result: Result<f64, String>) -> Self {
        match result {
            Ok(value) if value.is_finite() => Self::Value(value),
            Ok(_) => Self::Not("its readings are too large for the calculation".to_owned()),
            Err(reason) => Self::Not(reason),
        }
    }
}

/// What a figure rests on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rests {
    /// Target positions; none for circles.
    pub targets: Option<usize>,
    /// Readings.
    pub readings: usize,
    /// Runs: the least and the greatest number of readings at a target in one direction; for circles the number of traces,
    /// twice.
    pub runs: [usize; 2],
}

/// What a value is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unit {
    /// A length, mm.
    #[default]
    Length,
    /// An angle, rad.
    Angle,
}

impl Unit {
    /// The unit of values, `mm` or `rad`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Length => "mm",
            Self::Angle => "rad",
        }
    }

    /// The unit that people read deviations in, and how many of it are in one of this.
    pub fn fine(self) -> (&'static str, f64) {
        match self {
            Self::Length => ("um", 1e3),
            Self::Angle => ("arcsec", 180.0 * 3600.0 / PI),
        }
    }

    /// The unit that people read positions in, and how many of it are in one of this.
    pub fn coarse(self) -> (&'static str, f64) {
        match self {
            Self::Length => ("mm", 1.0),
            Self::Angle => ("deg", 180.0 / PI),
        }
    }

    /// A position in words: `120 mm`.
    pub(crate) fn place(self, position: f64) -> String {
        let (unit, scale) = self.coarse();
        let text = format!("{:.4}", position * scale);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        format!("{} {unit}", if text == "-0" { "0" } else { text })
    }
}

/// What read the position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sensor {
    /// The instrument: the tool relative to the part.
    #[default]
    Instrument,
    /// The drives' own feedback: what came in after the drive is not seen.
    Feedback,
}

impl Sensor {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Instrument => "instrument",
            Self::Feedback => "feedback",
        }
    }
}
