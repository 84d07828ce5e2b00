//! Faults: what may be wrong with a file.
//!
//! In: nothing. Out: the kinds of faults, and the factors by which numbers are wrong when something was mixed up.

/// One term of a calibration: the number of its motion, and its place among the motion's terms.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct TermAt {
    pub(crate) motion: usize,
    pub(crate) place: usize,
}

/// Numbers of a calibration that are wrong by one factor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Scope {
    Term(TermAt),
    /// All terms of an error motion.
    Motion(usize),
    /// All error motions of an axis but its alignments, which are measured by other means.
    Axis(usize),
    /// All angular error motions but the alignments.
    Angles,
    /// All numbers.
    Everything,
}

/// What may be wrong.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Fault {
    /// Numbers of the calibration have to be multiplied by 1 plus the amount. An amount of -2 is a wrong sign.
    Size(Scope),
    /// The values of a table are in reverse order.
    Mirror(TermAt),
    /// The amount, mm or rad, has to be added to the nodes of a table. It is expected near this many quarters of a node step. A table is
    /// straight between its nodes, so a large shift does something else than many small ones.
    Shift { at: TermAt, quarters: i8 },
    /// This many node steps have to be added to the nodes of a table.
    Slip { at: TermAt, nodes: i8 },
    /// A term reads another axis than the one that it names.
    Axis { of: TermAt, named: usize, read: usize },
    /// The curves of the two directions of motion are exchanged.
    Directions(TermAt),
    /// The numbers of two error motions are exchanged.
    Exchange { one: usize, other: usize },
    /// The numbers of an error motion belong to another one.
    Moved { from: usize, to: usize },
    /// The amount, mm, has to be added to a constant of the machine.
    Constant(usize),
    /// The chain has another order.
    Order(String),
    /// The amount, K, has to be added to the reference temperature of all thermal terms.
    Reference,
    /// Two temperature sensors are exchanged: each has the readings of the other.
    Sensors { one: usize, other: usize },
    /// The readings of a recording are too large by a factor of 1 plus the amount. An amount of -2 is a wrong sign.
    Scale { recording: usize },
}

impl Fault {
    /// Whether the fault is either there or not, so that its amount is 1. The others have any amount.
    pub(crate) fn is_whole(&self) -> bool {
        !matches!(
            self,
            Self::Size(_) | Self::Shift { .. } | Self::Constant(_) | Self::Reference | Self::Scale { .. }
        )
    }

    /// The fault that turns the change back: in files that were changed to be without this fault, it makes what was read. `word` is the
    /// topology word that was read.
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

/// The factors by which numbers have to be multiplied when something was mixed up. With each one the list holds its inverse.
pub(crate) const FACTORS: [Factor; 11] = [
    Factor { value: -1.0, name: "sign", meaning: "the sign is wrong" },
    Factor { value: 2.0, name: "size", meaning: "half values were entered instead of full values" },
    Factor { value: 0.5, name: "size", meaning: "full values were entered instead of half values" },
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
