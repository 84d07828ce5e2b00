//! Faults: what may be wrong with a file.
//!
//! In: nothing. Out: the list of faults, each with what is known of its size before anything is measured.

/// One term of a calibration: the number of its motion, and its place among the motion's terms.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct TermAt {
    pub(crate) motion: usize,
    pub(crate) place: usize,
}

/// Which numbers of a calibration have one factor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Scope {
    Term(TermAt),
    /// All terms of an error motion.
    Motion(usize),
    /// All error motions of an axis, its alignments apart: these are measured by other means.
    Axis(usize),
    /// All angular error motions, alignments apart.
    Angles,
    /// All numbers.
    Everything,
}

/// What may be wrong.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Fault {
    /// Numbers of the calibration are too small by a factor, which is 1 plus the amount: -2 is a wrong sign.
    Size(Scope),
    /// A table was entered from its other end.
    Mirror(TermAt),
    /// A table stands too low on its axis, by the amount, in mm or rad, which is near so many quarters of the step between its nodes:
    /// the way from node to node is straight, so that a large shift is not many small ones.
    Shift { at: TermAt, quarters: i8 },
    /// The values of a table stand so many nodes too low.
    Slip { at: TermAt, nodes: i8 },
    /// A term reads another axis than the one that it names.
    Axis { of: TermAt, named: usize, read: usize },
    /// The curves of the two directions of motion are exchanged.
    Directions(TermAt),
    /// The numbers of two error motions are exchanged.
    Exchange { one: usize, other: usize },
    /// The numbers of an error motion belong to another one.
    Moved { from: usize, to: usize },
    /// A constant of the machine is too small, by the amount, in mm.
    Constant(usize),
    /// The chain has another order.
    Order(String),
    /// The reference temperature of all thermal terms is too low, by the amount, in K.
    Reference,
    /// Two temperature sensors are exchanged.
    Sensors { one: usize, other: usize },
    /// The readings of a recording are too large by a factor, which is 1 plus the amount: -2 is a wrong sign.
    Scale { recording: usize },
}

impl Fault {
    /// Whether there is such a fault or not: the amount is then 1. Others have any amount.
    pub(crate) fn is_whole(&self) -> bool {
        !matches!(
            self,
            Self::Size(_) | Self::Shift { .. } | Self::Constant(_) | Self::Reference | Self::Scale { .. }
        )
    }

    /// The fault that makes files what they were before they were changed to be without this one; `word` is the order of the chain then.
    pub(crate) fn turned_back(&self, word: Option<&str>) -> Self {
        match self {
            Self::Moved { from, to } => Self::Moved { from: *to, to: *from },
            Self::Slip { at, nodes } => Self::Slip { at: *at, nodes: -*nodes },
            Self::Axis { of, named, read } => Self::Axis { of: *of, named: *read, read: *named },
            Self::Order(_) => Self::Order(word.unwrap_or_default().to_owned()),
            other => other.clone(),
        }
    }

    /// Whether its amount is a factor minus 1.
    pub(crate) fn is_factor(&self) -> bool {
        matches!(self, Self::Size(_) | Self::Scale { .. })
    }
}

/// A factor that has a name.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Factor {
    pub(crate) value: f64,
    pub(crate) name: &'static str,
    /// What is mixed up, in words.
    pub(crate) meaning: &'static str,
}

/// The factors by which numbers are wrong when something was mixed up.
pub(crate) const FACTORS: [Factor; 11] = [
    Factor { value: -1.0, name: "sign", meaning: "the sign is wrong" },
    Factor { value: 2.0, name: "size", meaning: "halves were entered for wholes" },
    Factor { value: 0.5, name: "size", meaning: "wholes were entered for halves" },
    Factor { value: ARCSECOND, name: "unit", meaning: "arcseconds were entered as urad" },
    Factor { value: 1.0 / ARCSECOND, name: "unit", meaning: "urad were entered as arcseconds" },
    Factor { value: 1e3, name: "unit", meaning: "the unit is a thousand times too small" },
    Factor { value: 1e-3, name: "unit", meaning: "the unit is a thousand times too large" },
    Factor { value: 25.4, name: "unit", meaning: "inches were entered as millimetres" },
    Factor { value: 1.0 / 25.4, name: "unit", meaning: "millimetres were entered as inches" },
    Factor { value: 0.1, name: "unit", meaning: "the unit is ten times too large" },
    Factor { value: 10.0, name: "unit", meaning: "the unit is ten times too small" },
];

/// An arcsecond in urad.
const ARCSECOND: f64 = 4.848_136_811;
