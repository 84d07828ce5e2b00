//! What an instrument's file holds, as it counts itself: targets, runs of readings over them, units where the file has any.

use model_dsl::quantity::Unit;
use model_dsl::source::{SourceFile, Span};

/// The readings of one file. Nothing is converted: targets and deviations are in the file's units and counting.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The file with its text, for findings.
    pub source: SourceFile,
    /// The targets, in the file's order; no two are the same.
    pub targets: Vec<f64>,
    /// The unit of the targets, where the file or its format tells it.
    pub target_unit: Option<Unit>,
    /// The unit of the deviations, where the file or its format tells it.
    pub deviation_unit: Option<Unit>,
    /// The runs, in the file's order.
    pub runs: Vec<Run>,
    /// Whether the file's flags speak of one direction or of both; nothing where it has none.
    pub flagged: Option<Flagged>,
    /// What the file says of itself, for people: machine, serial number, date and so on.
    pub about: Vec<(String, String)>,
}

/// What the flags of a file say of its directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flagged {
    /// All runs go one way.
    OneWay,
    /// Runs go both ways in turn.
    BothWays,
}

/// One run over the targets.
#[derive(Clone, Debug)]
pub struct Run {
    /// Its number in the file.
    pub number: u32,
    /// Which way the targets counted during it, where the file says so itself, in a column of directions.
    pub told: Option<Sense>,
    /// Its readings, in the order in which the file lists them.
    pub readings: Vec<Reading>,
    /// Where the file lists the first of them.
    pub span: Span,
}

/// One reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// The target: an index into [`Measured::targets`].
    pub target: usize,
    /// The deviation.
    pub deviation: f64,
}

/// Which way targets were counted through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// From the least target to the greatest.
    Ascending,
    /// From the greatest to the least.
    Descending,
}

impl Run {
    /// The sense in which the file lists the run; nothing for a single reading or a list that turns.
    pub(crate) fn listed(&self, targets: &[f64]) -> Option<Sense> {
        let at = |reading: &Reading| targets.get(reading.target).copied().unwrap_or(f64::NAN);
        let steps =
            || self.readings.windows(2).filter_map(|pair| Some((at(pair.first()?), at(pair.last()?))));
        match (steps().next(), steps().all(|(one, next)| next > one), steps().all(|(one, next)| next < one)) {
            (None, ..) => None,
            (_, true, _) => Some(Sense::Ascending),
            (_, _, true) => Some(Sense::Descending),
            _ => None,
        }
    }
}

impl Sense {
    /// The other sense.
    pub(crate) fn turned(self) -> Self {
        match self {
            Self::Ascending => Self::Descending,
            Self::Descending => Self::Ascending,
        }
    }
}
