//! What is answered: plain data. In: nothing. Out: limits, and passes that tell apart what they cannot.

use model_dsl::calibration::TermKind;

use crate::injection::kind::Kind;
use crate::posterior::Posterior;
use crate::size::Scale;
use crate::subject::Subject;
use crate::trial::{Other, Trial};

/// What a recording could show.
#[derive(Clone, Debug)]
pub struct Limits {
    /// The recording's file, or that of the path.
    pub file: String,
    /// Its title.
    pub title: Option<String>,
    /// The machine's name.
    pub machine: String,
    /// The verdict on the recording as it is, and the names found in it.
    pub verdict: &'static str,
    /// What was found in the recording as it is: `EXX backlash`.
    pub known: Vec<String>,
    /// Rows.
    pub rows: usize,
    /// The seed.
    pub seed: u64,
    /// Kinds that the recording shows already.
    pub already: Vec<Already>,
    /// One entry for each other kind in each motion, by axes.
    pub all: Vec<Limit>,
    /// Extra passes that tell apart what this one cannot, where they were looked for.
    pub advice: Option<Advice>,
}

/// The limit of one kind in one motion.
#[derive(Clone, Debug)]
pub struct Limit {
    /// What was asked.
    pub subject: Subject,
    /// The motion: `EXX`.
    pub motion: String,
    /// The axis: `X`.
    pub axis: String,
    /// Other motions in which the kind shows alike.
    pub alike: Vec<String>,
    /// What else was drawn: `period 21 to 34 mm`.
    pub drawn: String,
    /// What its size is.
    pub scale: Scale,
    /// From which strength on nine of ten are found; nothing where none was found at any size.
    pub found: Option<Found>,
    /// All trials.
    pub trials: Vec<Trial>,
    /// The largest strength that was tried.
    pub largest: f64,
    /// Where none was found: what was claimed in its place, the most frequent first.
    pub instead: Vec<String>,
}

/// The limit of a kind that is found from some size on.
#[derive(Clone, Debug)]
pub struct Found {
    /// The share found over the strength.
    pub posterior: Posterior,
    /// The strength that nine of ten trials find.
    pub strength: f64,
    /// Its relative standard uncertainty.
    pub uncertainty: f64,
    /// Half of the interval of 95 % of an effect of that strength, in the unit of strength; nothing where no trial had one.
    pub half: Option<f64>,
    /// The share of the trials that found it in which its own name stood first.
    pub first: f64,
    /// Other names for it in half of the trials that found it, or more: it is never told apart from them here.
    pub others: Vec<Other>,
}

/// A kind that the recording shows already as it is: what more there might be of it adds to that, and cannot be asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Already {
    /// The motion: `EXX`.
    pub motion: String,
    /// The term: `backlash`.
    pub term: String,
}

impl Limit {
    /// `backlash of EXX`, `cyclic of EXX`; a play that winds up is a backlash too.
    pub fn name(&self) -> String {
        match self.subject.kind {
            Kind::WindUp => format!("{} {} with wind-up", self.motion, TermKind::Backlash.name()),
            Kind::Term(term) => format!("{} {}", self.motion, term.name()),
        }
    }

    /// The size of the limit as it is told; nothing where there is none.
    pub fn size(&self) -> Option<f64> {
        self.found.as_ref().map(|found| self.scale.told(found.strength))
    }

    /// Half of the interval at the limit as it is told.
    pub fn half(&self) -> Option<f64> {
        let found = self.found.as_ref()?;
        Some(self.scale.half(found.strength, found.half?))
    }
}

/// An extra pass and what it settles.
#[derive(Clone, Debug)]
pub struct Pass {
    /// What is driven: `X from 0 to 400 mm and back at 50 mm/s, Z at 200 mm`.
    pub words: String,
    /// How long it takes, s.
    pub time: f64,
    /// What it tells apart.
    pub settles: Vec<Pair>,
}

/// Two names of which a recording cannot tell which is right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pair {
    /// The effect: `EXX backlash`.
    pub effect: String,
    /// What else it may be: `EBX backlash`; nothing where it is not found at all.
    pub other: Option<String>,
}

/// What extra passes do for a recording.
#[derive(Clone, Debug, Default)]
pub struct Advice {
    /// The passes, in the order in which they were chosen: each counts on those before it.
    pub passes: Vec<Pass>,
    /// What no move of the library settles.
    pub left: Vec<Pair>,
}
