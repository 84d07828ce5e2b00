//! What a calibration needs to know of rows besides positions. In: a calibration. Out: why it needs the time, where it does.

use model_dsl::calibration::factor::FactorPart;
use model_dsl::calibration::vocabulary::{self, Key, Kind};
use model_dsl::calibration::{CalibratedTerm, Calibration, Factor, Part};

/// What of a calibration depends on the time between rows, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Timed {
    /// How fast the axes move, and no more: without times, rows are of a machine that stands.
    Velocity(String),
    /// What follows behind a time constant, or the ramp of a correction: without times it is not known.
    Memory(String),
}

impl Timed {
    /// The warning where there are no times; none where rows without them cannot be answered.
    #[must_use]
    pub fn standing(&self) -> Option<String> {
        let Self::Velocity(why) = self else { return None };
        Some(format!(
            "warning: there are no times, so all rows are taken as static positions: {why} reads a velocity, which is then zero"
        ))
    }

    /// What it is, in words.
    #[must_use]
    pub fn why(&self) -> &str {
        match self {
            Self::Velocity(why) | Self::Memory(why) => why,
        }
    }
}

/// What of a calibration depends on the time between rows; nothing where nothing does.
#[must_use]
pub fn timed(calibration: &Calibration) -> Option<Timed> {
    let terms = || {
        let motions = calibration.motions.iter();
        motions.flat_map(|motion| {
            let terms = motion.terms.iter().enumerate();
            terms
                .map(|(place, term)| (&term.value, motion.ramp(place)))
                .filter(|(term, _)| term.compensable())
        })
    };
    let named = |term: &CalibratedTerm| format!("the term `{}` of the calibration", term.name());
    let remembering = terms().find_map(|(term, ramp)| match follows(term) {
        true => Some(named(term)),
        false => (ramp > 0.0).then(|| "a `ramp` of the calibration".to_owned()),
    });
    let moving = || terms().find(|(term, _)| reads_velocity(term)).map(|(term, _)| named(term));
    remembering.map(Timed::Memory).or_else(|| moving().map(Timed::Velocity))
}

/// Whether a term follows something behind a time constant.
fn follows(term: &CalibratedTerm) -> bool {
    let entry = term.kind().entry();
    let filtered =
        term.factors().iter().flat_map(Factor::parts).any(|(key, part)| {
            key == "time_constant" && matches!(part, FactorPart::Amount(time) if time > 0.0)
        });
    let is_time = |key: &str| entry.key(key).and_then(Key::kind) == Some(Kind::TIME);
    let behind =
        |(key, part): (&str, Part<'_>)| is_time(key) && matches!(part, Part::Number(time) if time > 0.0);
    filtered || term.parts().into_iter().any(behind)
}

fn reads_velocity(term: &CalibratedTerm) -> bool {
    term.states().any(|(state, _)| state == vocabulary::State::Velocity)
}
