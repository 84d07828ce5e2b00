//! Error motions: sums of terms.
//!
//! In: terms of a calibration and the state of the machine. Out: the value of EXX, EBZ, a squareness. It exists because
//! the equations of a machine multiply lever arms with these values and know nothing of what makes them up.

mod reader;

use super::real::Real;
use super::sample::OneSample;
use super::{Sample, Term, TermState};

pub use self::reader::MotionReader;

/// The error motions of a machine with their numbers: a slice that a program has put together, or a calibration that the
/// compiler has written as code.
///
/// What is compiled in says the same twice: as terms, and as code that reads exactly these terms and nothing else. A
/// controller gains by it what is known before it runs: which term a motion is, where the nodes of its table lie.
pub trait ErrorMotions {
    /// One number for each error motion, in mm or rad.
    ///
    /// A calibration that was compiled in gives an array, which need never lie in memory.
    type Values<'k>: AsRef<[Real]> + AsMut<[Real]>;

    /// The error motions, in the order of the kinematics.
    fn motions(&self) -> &[ErrorMotion<'_>];

    /// The value of each of them, in the order of [`motions`](Self::motions); none where what is read is not of such a
    /// machine.
    ///
    /// `kept` has a place for each; what stays there is what [`read_moved`](Self::read_moved) needs of it.
    fn read<'k>(&self, from: MotionReader<'_>, kept: &'k mut [Real]) -> Option<Self::Values<'k>>;

    /// [`read`](Self::read) once more in the same state of the machine, but at positions that differ for axes that correct:
    /// those that have a [direction](super::Kinematics::directions), and motors that follow them.
    #[inline]
    fn read_moved<'k>(&self, from: MotionReader<'_>, kept: &'k mut [Real]) -> Option<Self::Values<'k>> {
        self.read(from, kept)
    }
}

impl ErrorMotions for [ErrorMotion<'_>] {
    type Values<'k> = &'k mut [Real];

    fn motions(&self) -> &[ErrorMotion<'_>] {
        self
    }

    #[inline]
    fn read<'k>(&self, mut from: MotionReader<'_>, kept: &'k mut [Real]) -> Option<&'k mut [Real]> {
        let values = kept.get_mut(..self.len())?;
        for (motion, value) in self.iter().zip(&mut *values) {
            *value = from.motion(motion);
        }
        Some(values)
    }
}

/// One error motion of one link: the sum of its terms, each times the factors before it. Without terms it is zero.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct ErrorMotion<'a> {
    /// The terms, each in mm for a displacement or in rad for a rotation.
    pub terms: &'a [Term<'a>],
}

impl ErrorMotion<'_> {
    /// The value in a state of the machine, in mm or rad; `states` holds one state a term, or the value is NaN.
    #[must_use]
    #[inline]
    pub fn value(&self, sample: &Sample<'_>, states: &[TermState]) -> Real {
        self.read(&mut OneSample::new(sample), states, false)
    }

    /// The part of the value that is corrected in this cycle, see [`Term::corrected`]; in mm or rad.
    #[must_use]
    #[inline]
    pub fn corrected(&self, sample: &Sample<'_>, states: &[TermState]) -> Real {
        self.read(&mut OneSample::new(sample), states, true)
    }

    /// [`value`](Self::value) in what is read, or [`corrected`](Self::corrected): the sum over the terms, each times the factors before
    /// it; NaN where there is not one state a term.
    #[inline]
    pub(crate) fn read(&self, from: &mut OneSample<'_>, states: &[TermState], corrected: bool) -> Real {
        match (self.terms, states) {
            ([term], [state]) => term.read_one(from, state, corrected),
            (terms, states) if terms.len() == states.len() => {
                let (mut sum, mut factors) = (0.0, None);
                for (term, state) in terms.iter().zip(states) {
                    let value = term.read_one(from, state, corrected);
                    let product = factors.map_or(value, |before: Real| before * value);
                    if term.is_factor() {
                        factors = Some(product);
                    } else {
                        sum += product;
                        factors = None;
                    }
                }
                sum
            }
            _ => Real::NAN,
        }
    }

    /// Both of these where one table or one number makes them, as in most motions: without a state, and without the way
    /// through all other terms. None elsewhere.
    #[inline]
    fn read_alone(&self, from: &mut OneSample<'_>) -> Option<Real> {
        match self.terms {
            [Term::Table { axis, table }] => Some(from.table(table, *axis)),
            [Term::Constant { value }] => Some(*value),
            _ => None,
        }
    }

    /// Takes the memory of every term over to the cycle of this sample: once a cycle, before the value is asked.
    pub fn advance(&self, sample: &Sample<'_>, states: &mut [TermState]) {
        for (term, state) in self.terms.iter().zip(states) {
            term.advance(sample, state);
        }
    }
}
