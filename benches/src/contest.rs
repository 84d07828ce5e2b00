//! Contestants: everything that answers one question about the states of a machine.
//!
//! In: a function of the number of a state. Out: a contestant. A pass asks it for every state; that is what is timed and
//! counted. The calls are made inside the pass, so that no dynamic call is measured, and through functions that are not
//! inlined, so that Rust has no advantage over C that is linked. All write their answer where it stays: a copy of it would
//! wait until it has arrived in memory, which takes longer than the equations of a lathe.

use std::hint::black_box;

use crate::case::STATES;

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// The error from given error motions.
    Equations,
    /// The error from tables: the whole call of a cycle without a correction.
    Error,
    /// The compensated command.
    Command,
}

impl Group {
    /// All groups.
    pub const ALL: [Self; 3] = [Self::Equations, Self::Error, Self::Command];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Equations => "equations",
            Self::Error => "error",
            Self::Command => "command",
        }
    }
}

/// The machines of the comparison.
pub const MACHINES: [&str; 4] = ["excello-921", "xyfz-mill", "trunnion-5axis", "trunnion-5axis-turning"];

/// What answers.
pub trait Contestant {
    /// Its name.
    fn name(&self) -> &'static str;
    /// How far its answers may be from ours, mm: the second order, for who keeps it.
    fn tolerance(&self) -> f64;
    /// Its answer in a state, mm (and rad).
    fn at(&mut self, state: usize) -> Vec<f64>;
    /// Answers in every state, one after the other.
    fn pass(&mut self);
}

/// A contestant that is a function of the number of a state and of where its answer is to stand.
pub(crate) struct Answering<const N: usize, F> {
    /// Its name.
    pub(crate) name: &'static str,
    /// How far its answers may be from ours, mm.
    pub(crate) tolerance: f64,
    /// The function.
    pub(crate) answer: F,
}

/// Rounding: 1e-12 mm.
pub(crate) const EXACT: f64 = 1e-12;

impl<const N: usize, F: FnMut(usize, &mut [f64; N])> Contestant for Answering<N, F> {
    fn name(&self) -> &'static str {
        self.name
    }
    fn tolerance(&self) -> f64 {
        self.tolerance
    }
    fn at(&mut self, state: usize) -> Vec<f64> {
        let mut out = [f64::NAN; N];
        (self.answer)(state, &mut out);
        out.to_vec()
    }
    fn pass(&mut self) {
        for state in 0..STATES {
            let mut out = [f64::NAN; N];
            (self.answer)(black_box(state), &mut out);
            black_box(&out);
        }
    }
}
