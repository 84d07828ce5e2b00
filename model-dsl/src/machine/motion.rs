//! Error motions: what a link does beside what it was told.
//!
//! Names are those of ISO 230-1: `E`, a direction (X Y Z along, A B C about), a link; with a
//! zero between (`EC0Y`, also read as C0Y or COY) an alignment error of an axis, and with a zero and another axis between, `EC(0X)Y`,
//! the same counted from that axis.

use super::link::{Branch, Link, LinkKind};
use crate::algebra::{Axis, Name};
use crate::source::{Span, Spanned};

/// What an error motion does to its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MotionKind {
    /// Displaces it along a direction: mm.
    Linear(Axis),
    /// Turns it about a direction, right-handed: rad.
    Angular(Axis),
    /// Displaces the place of a rotary axis or spindle: mm.
    Offset(Axis),
    /// Turns the line of motion of a slide, or tilts a rotary axis or spindle: rad.
    Alignment(Axis),
}

impl MotionKind {
    /// Whether it is an angle.
    pub fn angular(self) -> bool {
        matches!(self, Self::Angular(_) | Self::Alignment(_))
    }

    /// Whether it belongs to the alignment of an axis, not to its motion.
    pub fn alignment(self) -> bool {
        matches!(self, Self::Offset(_) | Self::Alignment(_))
    }

    /// Its direction, or the direction about which it turns.
    pub fn axis(self) -> Axis {
        match self {
            Self::Linear(axis) | Self::Angular(axis) | Self::Offset(axis) | Self::Alignment(axis) => axis,
        }
    }

    /// The letter of ISO 230-1: X Y Z for a displacement, A B C for a rotation.
    pub fn letter(self) -> char {
        if self.angular() { self.axis().rotation_letter() } else { self.axis().letter() }
    }

    fn name(self, id: &str) -> String {
        let zero = if self.alignment() { "0" } else { "" };
        format!("E{}{zero}{id}", self.letter())
    }
}

/// One error motion of one link.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The name of ISO 230-1: EXX, EC0Y.
    pub name: String,
    /// The symbol to print; the name where the file gives none.
    pub symbol: String,
    /// Where the file gives the symbol.
    pub symbol_span: Option<Span>,
    /// The number of its link in [`super::Machine::links`].
    pub link: usize,
    /// What it does.
    pub kind: MotionKind,
    /// -1 where the symbol is counted against the ISO sense; the motion under its name never is.
    pub sign: i64,
    /// The free travel in the lever of an alignment error, where it is not the position.
    pub travel: Option<Spanned<Name>>,
    /// Whether an alignment error turns the carriage too.
    pub rotates: bool,
    /// Where the file names it itself.
    pub span: Option<Span>,
    /// The axis from which the file counts it, in a name such as `EA(0Y)C`.
    pub counted_from: Option<String>,
    /// The number in [`super::Machine::motors`] of the motor whose own error it is. It then moves what that motor moves, of which the
    /// link and the kind above are the first.
    pub motor: Option<usize>,
}

/// A name split into its parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MotionName {
    /// X Y Z A B or C.
    pub letter: char,
    /// Whether a zero (or the letter O) stands before the link.
    pub alignment: bool,
    /// The link's id.
    pub link: String,
    /// The id of the axis from which it is counted: Y of `EA(0Y)C`.
    pub counted_from: Option<String>,
}

/// A name without the axis from which it is counted, and that axis: `EA0C` and Y for `EA(0Y)C`. The zero may be the letter O.
pub fn without_reference(name: &str) -> Option<(String, &str)> {
    let (front, rest) = name.split_once('(')?;
    let (inner, id) = rest.split_once(')')?;
    let from = inner.strip_prefix(['0', 'O']).filter(|from| !from.is_empty())?;
    Some((format!("{front}0{id}"), from))
}

/// Reads a name for a link of the given id: `EXX`, `EC0Y`, `C0Y`, `COY`, `EC(0X)Y`.
pub fn parse_name(name: &str, id: &str) -> Option<MotionName> {
    if let Some((plain, from)) = without_reference(name) {
        let counted_from = Some(from.to_owned());
        return parse_name(&plain, id)
            .filter(|known| known.alignment)
            .map(|known| MotionName { counted_from, ..known });
    }
    let front = name.strip_suffix(id)?;
    let (letters, alignment) = match front.strip_suffix(['0', 'O']) {
        Some(letters) => (letters, true),
        None => (front, false),
    };
    let letter = match (letters.as_bytes(), alignment) {
        ([b'E', letter], _) | ([letter], true) => *letter as char,
        _ => return None,
    };
    "XYZABC".contains(letter).then(|| MotionName {
        letter,
        alignment,
        link: id.to_owned(),
        counted_from: None,
    })
}

impl Motion {
    /// A motion under its own name, in the ISO sense.
    pub(crate) fn plain(number: usize, link: &Link, kind: MotionKind, span: Option<Span>) -> Self {
        let name = kind.name(&link.id);
        let symbol = name.clone();
        Self {
            name,
            symbol,
            symbol_span: None,
            link: number,
            kind,
            sign: 1,
            travel: None,
            rotates: false,
            span,
            counted_from: None,
            motor: None,
        }
    }
}

/// The sign with which a motion displaces or turns its own body in bed directions.
///
/// The link's own direction is counted along `along`, so that it is actual minus commanded.
/// With `motions: relative`, every other motion on the part's branch turns; but the alignment
/// error of a slide does not, since a line of motion is turned the same way from whichever side it is seen.
pub(crate) fn body_sign(motion: &Motion, link: &Link, relative: bool) -> i64 {
    let own = match (link.kind, motion.kind) {
        (LinkKind::Slide(_), MotionKind::Linear(axis)) => axis == link.along.axis,
        (LinkKind::Rotary(_), MotionKind::Angular(axis) | MotionKind::Alignment(axis)) => {
            axis == link.along.axis
        }
        _ => false,
    };
    let line = matches!((link.kind, motion.kind), (LinkKind::Slide(_), MotionKind::Alignment(_)));
    if own {
        link.along.sign
    } else if relative && link.branch == Branch::Workpiece && !line {
        -1
    } else {
        1
    }
}
