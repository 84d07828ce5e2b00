//! What no table of positions holds. In: a term. Out: how large it is for a unit of what it depends on.

use model_dsl::calibration::vocabulary::State;
use model_dsl::calibration::{CalibratedTerm, SeriesInput};

/// A term that is lost with any table of positions, or a part of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Beyond {
    /// The number of its error motion.
    pub motion: usize,
    /// The term's name.
    pub term: &'static str,
    /// What it is there, mm or rad; nothing where that has no one size.
    pub size: Option<f64>,
    /// For what: `for each degC`.
    pub per: &'static str,
    /// The axis whose position multiplies it.
    pub times: Option<usize>,
}

impl Beyond {
    /// What of a term depends on more than positions and directions.
    pub(super) fn of(motion: usize, term: &CalibratedTerm) -> Option<Self> {
        let lost = |size: f64, per| {
            Some(Self { motion, term: term.name(), size: Some(size.abs()), per, times: None })
        };
        match term {
            CalibratedTerm::Backlash { lost_motion, wind_up, .. } if *wind_up > 0.0 => {
                lost(*lost_motion, "while the lost motion is taken up after a reversal")
            }
            CalibratedTerm::Polynomial { input: SeriesInput::Sensor(_), .. } => {
                Some(Self { motion, term: term.name(), size: None, per: "with the temperature", times: None })
            }
            CalibratedTerm::Expansion { coefficient, axis, .. } => Some(Self {
                motion,
                term: term.name(),
                size: Some(coefficient.abs()),
                per: "for each degC from its reference",
                times: Some(*axis),
            }),
            CalibratedTerm::Growth { coefficient, .. } => {
                lost(*coefficient, "for each degC from its reference")
            }
            CalibratedTerm::Lag { gain, .. } => lost(1000.0 / 60.0 / gain, "at a feed of 1000 mm/min"),
            CalibratedTerm::ReversalSpike { height, .. } => lost(*height, "at a reversal"),
            CalibratedTerm::Acceleration { gain, .. } => lost(1000.0 / gain, "at 1 m/s^2"),
            CalibratedTerm::Drift { amplitude, .. } => lost(*amplitude, "in the end"),
            CalibratedTerm::Vibration { amplitude, .. } => lost(*amplitude, "as an amplitude"),
            CalibratedTerm::Compliance { coefficient, .. } => lost(*coefficient, "for each unit of its load"),
            CalibratedTerm::Times { core, .. } if winds_up(core) => Some(Self {
                motion,
                term: term.name(),
                size: None,
                per: "while the lost motion is taken up after a reversal",
                times: None,
            }),
            other => other.states().any(|(state, _)| is_beyond(state)).then(|| Self {
                motion,
                term: other.name(),
                size: None,
                per: "with quantities other than positions",
                times: None,
            }),
        }
    }
}

/// Whether a play is taken up over some travel.
fn winds_up(term: &CalibratedTerm) -> bool {
    matches!(term, CalibratedTerm::Backlash { wind_up, .. } if *wind_up > 0.0)
}

/// Whether no table of positions holds what depends on this. What a product depends on, its factors say.
fn is_beyond(state: State) -> bool {
    !matches!(
        state,
        State::Nothing | State::Position | State::OtherPosition | State::Direction | State::Factors
    )
}
