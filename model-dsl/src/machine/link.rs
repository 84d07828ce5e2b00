//! The links of a chain: what moves, along what, seen from where.

use super::turned::Turned;
use crate::algebra::{Axis, Name, Polynomial};
use crate::source::Span;

/// One of the two branches that start at the bed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Branch {
    /// From the bed to the part.
    Workpiece,
    /// From the bed to the tool tip.
    Tool,
}

/// What kind of body a link is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkKind {
    /// A carriage on straight ways; the letter is X, Y, Z, U, V or W.
    Slide(char),
    /// A rotary axis with large angles; the letter is A, B or C.
    Rotary(char),
    /// A spindle: it turns freely, so its own angle is neither commanded nor an error.
    Spindle,
    /// A body that does not move by program: a turret, a chuck.
    Fixed,
    /// The tool; its offset leads to the tip.
    Tool,
    /// The part.
    Part,
}

impl LinkKind {
    /// The place of an axis in the order X Y Z U V W A B C; other links come after.
    pub fn axis_rank(self) -> usize {
        let order = "XYZUVWABC";
        self.letter().and_then(|letter| order.find(letter)).unwrap_or(order.len())
    }

    /// The axis letter, where a program moves the link.
    pub fn letter(self) -> Option<char> {
        match self {
            Self::Slide(letter) | Self::Rotary(letter) => Some(letter),
            _ => None,
        }
    }

    /// The word of the machine file.
    pub fn word(self) -> &'static str {
        match self {
            Self::Slide(_) => "slide",
            Self::Rotary(_) => "rotary",
            Self::Spindle => "spindle",
            Self::Fixed => "fixed",
            Self::Tool => "tool",
            Self::Part => "part",
        }
    }
}

/// The frame direction of positive programmed motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Along {
    /// The direction, or the axis of rotation.
    pub axis: Axis,
    /// +1 or -1.
    pub sign: i64,
}

impl Default for Along {
    /// Along +Z.
    fn default() -> Self {
        Self { axis: Axis::Z, sign: 1 }
    }
}

/// The point about which a link's rotations act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// The origin that travels with the carriage (the sources' convention).
    Carriage,
    /// The carriage's origin at zero, which stays with the bed.
    Bed,
}

/// One body of the chain.
#[derive(Clone, Debug)]
pub struct Link {
    /// The name that makes the names of its error motions; by default the axis letter.
    pub id: String,
    /// What it is.
    pub kind: LinkKind,
    /// On which branch it stands.
    pub branch: Branch,
    /// The direction of positive programmed motion, or of a spindle's axis.
    pub along: Along,
    /// The place of its frame at zero, in the frame before it: mm.
    pub origin: [Polynomial; 3],
    /// By which constant angles its frame is turned against the frame before it. A rotary axis turns that back behind itself: its axis
    /// leans, and its body at zero does not.
    pub turned: Turned,
    /// About which point its rotations act.
    pub reference: Reference,
    /// Whether a rotary axis corrects the error of its own angle itself, and the motors of a beam the rotation of that; else it is left
    /// to the slides, as far as they reach.
    pub corrects: bool,
    /// Where it stands in the machine file.
    pub span: Span,
}

impl Link {
    /// Whether a program moves it.
    pub fn is_axis(&self) -> bool {
        self.kind.letter().is_some()
    }

    /// Whether what stands on it is turned with its frame: the body of a rotary axis that leans is not.
    pub fn turns_back(&self) -> bool {
        matches!(self.kind, LinkKind::Rotary(_))
    }

    /// The name of its programmed position, `x` for axis X; empty for a link that no program moves.
    pub fn variable(&self) -> Name {
        self.kind.letter().map(|letter| letter.to_ascii_lowercase().to_string()).unwrap_or_default().into()
    }
}
