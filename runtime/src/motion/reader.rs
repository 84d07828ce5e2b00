//! Error motions read one after the other in one state of the machine.
//!
//! In: a sample, and the memories of all terms. Out: the value of each error motion, or of each term, in its turn. It exists
//! so that motions that are known when the code is compiled and motions that come from a file go through the same formulas.

use super::super::real::Real;
use super::super::sample::OneSample;
use super::super::{Bundle, ErrorMotion, Sample, Term, TermState};

/// Reads the terms of a machine's error motions, each in its turn, in one state of the machine.
///
/// It is what [`ErrorMotions::read`](super::super::ErrorMotions::read) is given.
#[derive(Debug)]
pub struct MotionReader<'a> {
    from: OneSample<'a>,
    /// The memories of all terms.
    states: &'a [TermState],
    /// How many terms were read.
    read: usize,
    /// Whether what is read is the part that is corrected in this cycle, see [`Term::corrected`].
    corrected: bool,
}

impl<'a> MotionReader<'a> {
    /// A reader of what the error motions are at a position, in the state of a sample.
    #[inline]
    pub(crate) const fn new(sample: &'a Sample<'a>, position: &'a [Real], states: &'a [TermState]) -> Self {
        Self { from: OneSample::at(sample, position), states, read: 0, corrected: false }
    }

    /// A reader of the part of them that is corrected in this cycle.
    #[inline]
    pub(crate) const fn of_corrected(
        sample: &'a Sample<'a>,
        position: &'a [Real],
        states: &'a [TermState],
    ) -> Self {
        Self { from: OneSample::at(sample, position), states, read: 0, corrected: true }
    }

    /// A reader of the same, from the first term on, for a machine of so many axes whose motions have so many terms: numbers
    /// that the compiler of Rust knows from here on. None where they are others.
    #[must_use]
    #[inline]
    pub fn sized<const AXES: usize, const TERMS: usize>(self) -> Option<Self> {
        let states: &[TermState; TERMS] = self.states.try_into().ok()?;
        Some(Self { from: self.from.sized::<AXES>()?, states, read: 0, corrected: self.corrected })
    }

    /// The value of the next term, in mm or rad; NaN where it has no memory left.
    #[inline(always)]
    #[must_use]
    pub fn term(&mut self, term: &Term<'_>) -> Real {
        let Some(state) = self.states.get(self.read) else { return Real::NAN };
        self.read = self.read.saturating_add(1);
        term.read_one(&mut self.from, state, self.corrected)
    }

    /// The values of tables that lie side by side, in mm or rad; none where there is no such axis.
    #[inline(always)]
    #[must_use]
    pub fn bundle<const CURVES: usize, const ROWS: usize>(
        &self,
        bundle: &Bundle<CURVES, ROWS>,
    ) -> Option<[Real; CURVES]> {
        self.from.bundle(bundle)
    }

    /// The value of the next term, which was read before its turn.
    #[inline]
    #[must_use]
    pub fn known(&mut self, value: Real) -> Real {
        self.pass_over(1);
        value
    }

    /// Leaves out the next so many terms.
    #[inline]
    pub fn pass_over(&mut self, terms: usize) {
        // Wraps only where no such slice can exist.
        self.read = self.read.wrapping_add(terms);
    }

    /// The value of the next error motion, in mm or rad; NaN where its terms have no memories left.
    #[inline]
    pub(super) fn motion(&mut self, motion: &ErrorMotion<'_>) -> Real {
        let first = self.read;
        self.pass_over(motion.terms.len());
        match motion.read_alone(&mut self.from) {
            Some(value) => value,
            None => {
                let states = self.states.get(first..self.read).unwrap_or_default();
                motion.read(&mut self.from, states, self.corrected)
            }
        }
    }
}
