//! The names of a machine that its calibration may use, and how they are looked up.

use crate::quantity::Dimension;

/// The names of one machine: what a calibration of it can speak of.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct MachineNames {
    /// The machine's name, for messages.
    pub machine: String,
    /// Constants with their values in mm where the machine file gives one itself, in the machine's order.
    pub constants: Vec<(String, Option<f64>)>,
    /// Axes in the machine's order.
    pub axes: Vec<AxisName>,
    /// Error motions in the machine's order.
    pub motions: Vec<MotionName>,
    /// Error motions of the machine without a lever at the tool tip: a calibration may have numbers of them, which have no effect.
    pub unseen: Vec<MotionName>,
}

/// An axis by its letter.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct AxisName {
    /// Upper-case letter or link id: `X`, `C`.
    pub letter: String,
    /// Whether positions on it are angles (rad) rather than lengths (mm).
    pub rotary: bool,
}

/// An error motion by its ISO 230-1 name.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MotionName {
    /// The name: `EXX`, `EC0Y`.
    pub name: String,
    /// Whether it is an angle (rad) rather than a length (mm).
    pub angular: bool,
    /// Letter of the axis of its link; none for a spindle or a fixed link.
    pub axis: Option<String>,
    /// Whether it is the motion of that axis along itself, or about itself: EXX of X, ECC of C.
    pub own: bool,
}

impl MachineNames {
    /// The index of the axis with this letter.
    pub fn axis(&self, letter: &str) -> Option<usize> {
        self.axes.iter().position(|axis| axis.letter == letter)
    }

    /// The index of an error motion; alignment errors also as `C0Y` and `COY`.
    pub fn motion(&self, name: &str) -> Option<usize> {
        named(&self.motions, name)
    }

    /// The index of an error motion without a lever, under the same spellings.
    pub fn unseen_motion(&self, name: &str) -> Option<usize> {
        named(&self.unseen, name)
    }

    /// The axis whose own motion, actual minus commanded, an error motion is: X for EXX, C for ECC.
    pub fn own_axis(&self, motion: &MotionName) -> Option<usize> {
        motion.axis.as_deref().filter(|_| motion.own).and_then(|letter| self.axis(letter))
    }

    /// The kind of position that the axis of this index has.
    pub fn axis_dimension(&self, axis: usize) -> Dimension {
        match self.axes.get(axis) {
            Some(AxisName { rotary: true, .. }) => Dimension::ANGLE,
            _ => Dimension::LENGTH,
        }
    }

    /// The letters of the axes, for help lines: `X, Y and Z`.
    pub(super) fn axis_letters(&self) -> String {
        let letters: Vec<_> = self.axes.iter().map(|axis| axis.letter.as_str()).collect();
        letters.join(", ")
    }
}

impl MotionName {
    /// The kind of quantity that the motion is.
    pub fn dimension(&self) -> Dimension {
        if self.angular { Dimension::ANGLE } else { Dimension::LENGTH }
    }
}

/// The index of a motion by its name.
fn named(motions: &[MotionName], name: &str) -> Option<usize> {
    let exact = motions.iter().position(|motion| motion.name == name);
    exact.or_else(|| {
        let alignment = alignment_name(name)?;
        motions.iter().position(|motion| motion.name == alignment)
    })
}

/// `EC0Y` for `C0Y`, `COY` and `ECOY`; nothing for what is not spelled like an alignment error.
fn alignment_name(name: &str) -> Option<String> {
    let body = name.strip_prefix('E').unwrap_or(name);
    let direction = body.chars().next().filter(|letter| "ABCXYZ".contains(*letter))?;
    let link = body.get(1..)?.strip_prefix(['0', 'O'])?;
    (!link.is_empty()).then(|| format!("E{direction}0{link}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alignment_errors_have_three_spellings() {
        for name in ["EC0Y", "C0Y", "COY", "ECOY"] {
            assert_eq!(alignment_name(name).as_deref(), Some("EC0Y"), "{name}");
        }
        for name in ["EXX", "XX", "", "E", "C0", "\u{b5}0Y", "c0Y"] {
            assert_eq!(alignment_name(name), None, "{name}");
        }
    }
}
