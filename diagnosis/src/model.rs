//! Models: which effects act, where, and how strongly.

use crate::side::Side;
use crate::terms::{Setting, Shape};

/// One effect: a term at a place.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Effect {
    pub(crate) place: Place,
    pub(crate) shape: Shape,
}

/// Where an effect acts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Place {
    /// In an error motion of the machine, by its number in the equations.
    Motion { motion: usize, side: Side },
    /// In the instrument of a recording, by its number in the study.
    Instrument { recording: usize },
}

/// An effect with its coefficients, in mm, rad, s and degC.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Fitted {
    pub(crate) effect: Effect,
    pub(crate) coefficients: Vec<f64>,
}

/// All effects that act together, beside those of the calibration.
pub(crate) type Model = Vec<Fitted>;

impl Effect {
    /// A setting of the instrument of a recording.
    pub(crate) fn setting(recording: usize, setting: Setting) -> Self {
        Self { place: Place::Instrument { recording }, shape: Shape::Instrument(setting) }
    }

    /// The setting, where it is one of the instrument of this recording.
    pub(crate) fn setting_of(&self, recording: usize) -> Option<Setting> {
        match (&self.shape, self.place) {
            (Shape::Instrument(setting), Place::Instrument { recording: of }) if of == recording => {
                Some(*setting)
            }
            _ => None,
        }
    }

    /// The error motion, where it acts in one.
    pub(crate) fn motion(&self) -> Option<usize> {
        match self.place {
            Place::Motion { motion, .. } => Some(motion),
            Place::Instrument { .. } => None,
        }
    }

    /// Whether two act in the same motion and show, or do not show, in the drive's own feedback.
    pub(crate) fn same_place(&self, other: &Self) -> bool {
        match (self.place, other.place) {
            (Place::Motion { motion: a, side: one }, Place::Motion { motion: b, side: two }) => {
                a == b && one.at_drive() == two.at_drive()
            }
            (a, b) => a == b,
        }
    }

    /// The side, where it acts in the machine.
    pub(crate) fn side(&self) -> Option<Side> {
        match self.place {
            Place::Motion { side, .. } => Some(side),
            Place::Instrument { .. } => None,
        }
    }
}
