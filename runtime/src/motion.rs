//! Error motions: sums of terms.
//!
//! In: terms of a calibration and the state of the machine. Out: the value of EXX, EBZ, a squareness. It exists because
//! the equations of a machine multiply lever arms with these values and know nothing of what makes them up.

use crate::{Sample, Term, TermState};

/// One error motion of one link: the sum of its terms. Without terms it is zero.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct ErrorMotion<'a> {
    /// The terms, each in mm for a displacement or in rad for a rotation.
    pub terms: &'a [Term<'a>],
}

impl ErrorMotion<'_> {
    /// The value in a state of the machine, in mm or rad; `states` holds one state a term, or the value is NaN.
    #[must_use]
    pub fn value(&self, sample: &Sample<'_>, states: &[TermState]) -> f64 {
        self.sum(states, |term, state| term.value(sample, state))
    }

    /// The part of the value that is corrected in this cycle, see [`Term::corrected`]; in mm or rad.
    #[must_use]
    pub fn corrected(&self, sample: &Sample<'_>, states: &[TermState]) -> f64 {
        self.sum(states, |term, state| term.corrected(sample, state))
    }

    /// The sum over the terms; NaN where there is not one state a term.
    fn sum(&self, states: &[TermState], of: impl Fn(&Term<'_>, &TermState) -> f64) -> f64 {
        if states.len() != self.terms.len() {
            return f64::NAN;
        }
        self.terms.iter().zip(states).fold(0.0, |sum, (term, state)| sum + of(term, state))
    }

    /// Takes the memory of every term over to the cycle of this sample: once a cycle, before the value is asked.
    pub fn advance(&self, sample: &Sample<'_>, states: &mut [TermState]) {
        for (term, state) in self.terms.iter().zip(states) {
            term.advance(sample, state);
        }
    }
}
