//! The names of a machine that its calibration may use, and how they are looked up.

use crate::algebra::{Axis, Name, Polynomial, Symbol};
use crate::machine::reference::difference;
use crate::machine::{Counted, Link, LinkKind, without_reference};
use crate::quantity::Dimension;

/// The names of one machine: what a calibration of it can speak of.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct MachineNames {
    /// The machine's name, for messages.
    pub machine: String,
    /// Constants with their values in mm where the machine file gives one itself, in the machine's order.
    pub constants: Vec<(String, Option<f64>)>,
    /// Where each tool has a direction of its own, what that is made of; its parts are the last of the constants.
    pub turning: Option<TurningTool>,
    /// Axes in the machine's order.
    pub axes: Vec<AxisName>,
    /// Error motions in the machine's order.
    pub motions: Vec<MotionName>,
    /// Error motions of the machine without a lever at the tool tip: a calibration may have numbers of them, which have no effect.
    pub unseen: Vec<MotionName>,
}

/// A tool whose direction is another one with each tool of a calibration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TurningTool {
    /// The constants, by their numbers, that are the parts of its direction.
    pub direction: [usize; 3],
    /// The constants that are the coordinates of its tip, none for a coordinate that is zero; nothing at all where a coordinate is
    /// something else, or its constant stands in another one too.
    pub offset: Option<[Option<usize>; 3]>,
}

impl TurningTool {
    /// Of the links of a machine and its constants, each with the part of a direction that it is; none where there is no such part.
    pub fn new<'m>(
        links: &[Link],
        constants: impl Iterator<Item = (&'m Name, Option<Axis>)> + Clone,
    ) -> Option<Self> {
        let part = |wanted| constants.clone().position(|(_, part)| part == Some(wanted));
        let [x, y, z] = Axis::ALL.map(part);
        Some(Self { direction: [x?, y?, z?], offset: offset(links, constants.map(|(name, _)| name)) })
    }
}

/// The constants of the tool's coordinates: see [`TurningTool::offset`].
fn offset<'m>(
    links: &[Link],
    constants: impl Iterator<Item = &'m Name> + Clone,
) -> Option<[Option<usize>; 3]> {
    let tool = links.iter().find(|link| link.kind == LinkKind::Tool)?;
    let used = |name: &Name| {
        let places = links.iter().flat_map(|link| &link.origin);
        places.filter(|place| place.symbols().contains(&Symbol::Constant(name.clone()))).count()
    };
    let alone = |place: &Polynomial| -> Option<Option<usize>> {
        if place.is_zero() {
            return Some(None);
        }
        let symbols = place.symbols();
        let name = symbols.first().filter(|symbol| *place == Polynomial::symbol((*symbol).clone()))?.name();
        let number = constants.clone().position(|known| known == name)?;
        (used(name) == 1).then_some(Some(number))
    };
    let [x, y, z] = tool.origin.each_ref().map(alone);
    Some([x?, y?, z?])
}

/// An axis by its letter.
#[derive(Clone, PartialEq, Debug)]
pub struct AxisName {
    /// Upper-case letter or link id: `X`, `C`.
    pub letter: String,
    /// Whether positions on it are angles (rad) rather than lengths (mm).
    pub rotary: bool,
    /// Of a motor the axes that it follows, by their numbers, each with how far the motor goes for each mm of it; empty for an axis
    /// that a program moves.
    pub follows: Vec<(usize, f64)>,
}

impl AxisName {
    /// Whether it is a motor, which follows axes and which no program moves by itself.
    pub fn is_motor(&self) -> bool {
        !self.follows.is_empty()
    }

    /// Where the motor stands when the axes stand at positions by their numbers; none for an axis that a program moves.
    pub fn followed(&self, position: impl Fn(usize) -> f64) -> Option<f64> {
        let sum = || self.follows.iter().fold(0.0, |sum, (of, weight)| sum + weight * position(*of));
        self.is_motor().then(sum)
    }
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
    /// What an alignment error is, counted from each other axis that shows it.
    pub counted: Vec<Counted>,
}

impl MachineNames {
    /// The constants that are offsets: all but the parts of the tool's direction.
    pub fn offsets(&self) -> impl Iterator<Item = &(String, Option<f64>)> + Clone {
        let parts = self.turning.map(|turning| turning.direction);
        let is_part = move |number: &usize| parts.is_some_and(|parts| parts.contains(number));
        self.constants.iter().enumerate().filter(move |(number, _)| !is_part(number)).map(|(_, known)| known)
    }

    /// The index of the axis with this letter.
    pub fn axis(&self, letter: &str) -> Option<usize> {
        self.axes.iter().position(|axis| axis.letter == letter)
    }

    /// The index of an error motion; alignment errors also as `C0Y` and `COY`, and as `EC(0X)Y` where it is the same counted from X.
    pub fn motion(&self, name: &str) -> Option<usize> {
        named(&self.motions, name)
    }

    /// The index of an error motion without a lever, under the same spellings.
    pub fn unseen_motion(&self, name: &str) -> Option<usize> {
        named(&self.unseen, name)
    }

    /// Why a name such as `EC(0X)Y` is not that of an alignment error of this machine, though `EC0Y` is.
    pub fn miscounted(&self, name: &str) -> Option<String> {
        let (plain, from) = without_reference(name)?;
        let plain = alignment_name(&plain)?;
        let known = self.motions.iter().chain(&self.unseen).find(|motion| motion.name == plain)?;
        difference(name, &plain, from, &known.counted)
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
    let of = |name: &str| motions.iter().position(|motion| motion.name == name);
    if let Some((plain, from)) = without_reference(name) {
        let found = of(&alignment_name(&plain)?)?;
        let motion = motions.get(found)?;
        return difference(name, &motion.name, from, &motion.counted).is_none().then_some(found);
    }
    of(name).or_else(|| of(&alignment_name(name)?))
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

    /// C stands on the bed; Z is out of line about X, and Y is not.
    #[test]
    fn alignment_errors_may_be_counted_from_another_axis_where_that_is_the_same() {
        let names = crate::compile_word("CFXYZ", &mut crate::diagnostic::Diagnostics::new());
        let names = names.expect("a word").equations.names();
        let own = names.motion("EA0C");
        assert!(own.is_some());
        for name in ["EA(0Y)C", "EA(OY)C", "A(0Y)C", "AOC", "A0C", "EAOC"] {
            assert_eq!((names.motion(name), names.miscounted(name)), (own, None), "{name}");
        }
        for (name, reason) in [
            ("EA(0Z)C", Some("counted from Z, EA(0Z)C is EA0C - EA0Z")),
            ("EA(0X)C", Some("EA0C cannot be counted from X")),
            ("EA(0Y)Q", None),
            ("EA(Y)C", None),
            ("EA(0)C", None),
        ] {
            assert_eq!((names.motion(name), names.miscounted(name).as_deref()), (None, reason), "{name}");
        }
    }
}
