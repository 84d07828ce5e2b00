//! Published equations against derived ones, term by term.
//!
//! In: a machine, its equations, and an equation file as text. Out: a [`Report`] with one verdict for each
//! error motion in each printed equation, or located mistakes in the file. Both sides are canonical
//! polynomials, so that a verdict never depends on how an expression is written.
//!
//! An equation file holds `#` comments, `[section]` headers and lines `NAME = expression`, continued by
//! indentation. `Px` is the nominal position and the error together, `dPx` or `Ex` the error alone, in x, y or
//! z; `I`, `J`, `K` and `dI`, `dJ`, `dK` are the same of the direction of the tool. A section `[significant]` lists a
//! selection: motions that occur nowhere in it are left out, not missing.
//! A section `[carriage X]` lists entries `T(i,j)` of the homogeneous transformation of one link, and
//! `[carriage X significant]` a selection of its error motions. `let gamma = -EAX` gives a letter to a motion
//! or position for the rest of a section.

mod compare;
mod read;
mod report;
mod syntax;
mod vocabulary;

#[cfg(test)]
mod tests;

use crate::algebra::{Axis, Polynomial};
use crate::diagnostic::Diagnostics;
use crate::equations::Equations;
use crate::machine::Machine;
use crate::source::{SourceFile, Span};

/// Compares an equation file with a machine's equations; `None` where the file has mistakes.
pub fn check(
    machine: &Machine,
    equations: &Equations,
    file: &SourceFile,
    diagnostics: &mut Diagnostics,
) -> Option<Report> {
    let sections = read::sections(machine, equations, file, diagnostics)?;
    Some(compare::report(machine, equations, file, &sections))
}

/// What a printed equation is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// `Px`: the nominal position and the error in a direction.
    Position(Axis),
    /// `dPx` or `Ex`: the error alone.
    Error(Axis),
    /// `I`: the direction of the tool along a direction of the part, and its error.
    Direction(Axis),
    /// `dI`: the error of the tool's direction alone.
    DirectionError(Axis),
    /// `T(i,j)`: an entry of a link's homogeneous transformation.
    Entry {
        /// The number of the link in [`Machine::links`].
        link: usize,
        /// The row, from 1 to 4, as printed.
        row: usize,
        /// The column, from 1 to 4, as printed.
        column: usize,
    },
}

/// How a printed term stands to the derived one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Derived, but not printed.
    Missing,
    /// Printed, but not derived.
    Extra,
    /// Printed with the opposite sign.
    OppositeSign,
    /// Printed with another lever arm, or another coefficient.
    OtherLever,
    /// Derived, but left out of a selection by its authors.
    LeftOut,
    /// The same on both sides.
    Agrees,
}

impl Verdict {
    /// Every verdict, disagreement first.
    pub const ALL: [Self; 6] =
        [Self::Missing, Self::Extra, Self::OppositeSign, Self::OtherLever, Self::LeftOut, Self::Agrees];

    /// Whether print and derivation contradict each other.
    pub fn disagrees(self) -> bool {
        !matches!(self, Self::Agrees | Self::LeftOut)
    }

    /// The words of the report.
    pub fn words(self) -> &'static str {
        match self {
            Self::Missing => "missing",
            Self::Extra => "extra",
            Self::OppositeSign => "opposite sign",
            Self::OtherLever => "other lever",
            Self::LeftOut => "left out",
            Self::Agrees => "agrees",
        }
    }

    /// The verdict on two values of one thing; zero stands for absence.
    fn on(derived: &Polynomial, printed: &Polynomial) -> Self {
        if derived == printed {
            Self::Agrees
        } else if printed.is_zero() {
            Self::Missing
        } else if derived.is_zero() {
            Self::Extra
        } else if *printed == -derived {
            Self::OppositeSign
        } else {
            Self::OtherLever
        }
    }
}

/// The nominal part of an equation on both sides.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Nominal {
    /// As derived.
    pub derived: Polynomial,
    /// As printed.
    pub printed: Polynomial,
}

impl Nominal {
    /// Whether both are equal.
    pub fn agrees(&self) -> bool {
        self.derived == self.printed
    }
}

/// One error motion in one equation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The name of ISO 230-1.
    pub name: String,
    /// The machine's symbol.
    pub symbol: String,
    /// The derived lever arm of what the symbol counts; zero where there is none.
    pub derived: Polynomial,
    /// The printed one.
    pub printed: Polynomial,
    /// How they stand to each other.
    pub verdict: Verdict,
}

/// One printed equation, compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Comparison {
    /// The section it stands in, where that has a name.
    pub section: Option<String>,
    /// The left side as printed.
    pub left: String,
    /// What it is about.
    pub target: Target,
    /// Where the left side stands in the file.
    pub span: Span,
    /// Its line in the file, from 1.
    pub line: usize,
    /// The part without error motions.
    pub nominal: Nominal,
    /// Every error motion that one of the sides has, in the machine's order.
    pub findings: Vec<Finding>,
    /// The printed products of error motions, which the first order drops; they do not disagree.
    pub second_order: Polynomial,
}

impl Comparison {
    /// Whether the equation agrees with the derivation.
    pub fn agrees(&self) -> bool {
        self.nominal.agrees() && !self.findings.iter().any(|finding| finding.verdict.disagrees())
    }

    /// Every term that contradicts the derivation, in a line each: place, verdict, name, both sides.
    pub fn contradictions(&self) -> Vec<String> {
        report::contradictions(self)
    }
}

/// An equation file, compared with a machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// The machine's name.
    pub machine: String,
    /// The file's name.
    pub file: String,
    /// The equations in the file's order.
    pub equations: Vec<Comparison>,
    /// Sensitive directions that a file of position or error equations says nothing about.
    pub unchecked: Vec<Axis>,
}

impl Report {
    /// Whether the whole file agrees with the machine.
    pub fn agrees(&self) -> bool {
        self.equations.iter().all(Comparison::agrees)
    }

    /// How many error motions have a verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        let findings = self.equations.iter().flat_map(|one| &one.findings);
        findings.filter(|finding| finding.verdict == verdict).count()
    }

    /// The report in words: disagreement first, then every term in a line, then a summary.
    pub fn text(&self) -> String {
        report::text(self)
    }
}

/// Where two polynomials differ, monomial by monomial, each with its derived or, where extra, printed value.
pub fn differences(derived: &Polynomial, printed: &Polynomial) -> Vec<(Verdict, Polynomial)> {
    compare::differences(derived, printed)
}
