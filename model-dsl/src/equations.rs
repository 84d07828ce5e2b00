//! The error equations: the last form before printing, checking, evaluating and generating code.
//!
//! Defined by its rows: for each sensitive direction d,
//! `P_d = nominal_d + sum over j of arm_dj * e_j`,
//! where `P` is the tool tip relative to the part in the part's frame (mm), `e_j` the error
//! motions (mm or rad) and `arm_dj` their lever arms, exact polynomials of positions,
//! constants and the sines and cosines of rotary axes. An error motion that a direction does
//! not see has no term there; no arm is zero. The direction of the tool, where the machine
//! file asks for it, is three rows of the same kind, in pure numbers. The rotation of the tool
//! relative to the part is the same kind of sum, `w_a = sum over j of turn_aj * e_j` for a = A, B, C: what an angular
//! instrument and the encoder of a rotary stage see.

use std::fmt;

use abbe_runtime::{Share, Turning};

use crate::algebra::{Axis, Name, Polynomial, Rational, to_f64};
use crate::calibration::{AxisName, MachineNames, MotionName, TurningTool};
use crate::machine::reference::{Placed, counted};
use crate::machine::{Branch, Element, Link, MotionKind, Moved};

/// The error equations of one machine.
#[derive(Clone, Debug)]
pub struct Equations {
    /// The machine's name.
    pub machine: String,
    /// Its title.
    pub title: Option<String>,
    /// Where its model was published.
    pub source: Option<String>,
    /// Its links, each branch from the bed outwards, the part's branch first.
    pub links: Vec<Link>,
    /// Whether error motions are those of the tool relative to the part, not of their own bodies.
    pub relative: bool,
    /// Its programmed axes, in the order X Y Z U V W A B C, and behind them its motors, which follow these.
    pub axes: Vec<AxisInfo>,
    /// The free travels in levers of alignment errors, in order of their axes.
    pub travels: Vec<TravelInfo>,
    /// The named offsets.
    pub constants: Vec<ConstantInfo>,
    /// The error motions that some row sees, by axis, alignment errors last.
    pub motions: Vec<Motion>,
    /// The error motions of the machine that no row sees: none of them has a lever at the tool tip, nor turns the direction of the
    /// tool where that is derived.
    pub unseen: Vec<Motion>,
    /// One row for each sensitive direction, in order.
    pub rows: Vec<Row>,
    /// The direction of the tool from its tip towards the spindle, in the part's frame: I, J, K, a vector of length 1, with its error in
    /// rad, whichever directions are sensitive. Three rows in the order X, Y, Z; none where the machine file does not request it
    /// (`orientation: true`). The error is square to the nominal direction: to first order a length does not change.
    pub orientation: Vec<Row>,
    /// The rotation of the tool relative to the part by the errors, rad, right-handed about X, Y, Z of the part's
    /// frame, whichever directions are sensitive: for each of the three the angles that it sees, with their factors,
    /// which are pure numbers (+1 and -1, or sines and cosines of rotary axes). Of the motions above only: one that
    /// turns the tool and moves no point of it is in neither.
    pub turns: [Vec<Term>; 3],
}

/// A programmed axis.
#[derive(Clone, Debug)]
pub struct AxisInfo {
    /// The axis letter, `X`.
    pub letter: String,
    /// The name of its programmed position, `x`: mm, or rad for a rotary axis.
    pub variable: Name,
    /// Whether it turns.
    pub rotary: bool,
    /// The direction of its motion, or the axis of its rotation.
    pub along: Axis,
    /// Which branch it moves.
    pub branch: Branch,
    /// The displacement of the tool tip relative to the part for each mm of programmed motion,
    /// in the part's frame, zero in insensitive directions; `None` where the axis does not
    /// correct errors: a rotary axis, or a second slide in the direction of another.
    pub effect: Option<[Polynomial; 3]>,
    /// Whether it corrects the error of its own angle itself: a rotary axis, unless the machine file leaves it to the slides.
    pub corrects_angle: bool,
    /// What it turns the direction of the tool by for each rad, in the part's frame, pure numbers; `None` where it does not correct that
    /// direction: a slide, a rotary axis that corrects nothing or turns the tool nowhere, and all axes but where the machine file says
    /// `orientation: true`.
    pub aim: Option<[Polynomial; 3]>,
    /// What repeats along its travel: a rotary axis itself, then what the machine file says of the drive.
    pub elements: Vec<Element>,
    /// Of a motor, which is no link of the chain, where it stands: for each axis that it follows, by its number, how far the motor goes
    /// for each mm of it. Empty for an axis that a program moves.
    pub follows: Vec<(usize, Rational)>,
    /// Of a motor the error motions that it corrects by itself, with what its own travel is for each mm or rad of them.
    pub squares: Vec<(usize, Rational)>,
}

/// A free travel in the lever of an alignment error.
#[derive(Clone, Debug)]
pub struct TravelInfo {
    /// Its name, `dz`.
    pub name: Name,
    /// The number in [`Equations::axes`] of the axis whose position it is by default.
    pub axis: usize,
}

/// A named offset.
#[derive(Clone, Debug)]
pub struct ConstantInfo {
    /// Its name, `X1`.
    pub name: Name,
    /// What it means.
    pub meaning: Option<String>,
    /// The value that a calibration may leave out: mm, or the part of a direction.
    pub default: Option<f64>,
    /// Of a part of the tool's direction, a pure number, which part it is; none of an offset.
    pub direction: Option<Axis>,
}

/// An error motion of the machine.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The name of ISO 230-1: `EXX`, `EC0Y`.
    pub name: String,
    /// The symbol of the machine file; the name where it gives none.
    pub symbol: String,
    /// Whether it is an angle (rad) or a displacement (mm).
    pub angular: bool,
    /// The direction along which it displaces, or about which it turns.
    pub direction: Axis,
    /// Whether it is an alignment error of an axis.
    pub alignment: bool,
    /// Whether the machine file counts its symbol against the ISO sense. Under its name it never is.
    pub symbol_against_iso: bool,
    /// The link that it belongs to, or the motor.
    pub link: String,
    /// The number in [`Equations::axes`] of that link, where a program moves it, or of that motor.
    pub axis: Option<usize>,
    /// The number of that link in [`Equations::links`].
    pub body: usize,
    /// What it does to its link.
    pub kind: MotionKind,
    /// Of the error of a motor, what one mm of it does to bodies; empty for the error motion of a link.
    pub by_motor: Vec<Moved>,
    /// +1 or -1: the sign with which its value displaces or turns its link in bed directions.
    pub sign: i64,
    /// The number in [`Equations::travels`] of the free travel that stands in its lever for the position.
    pub travel: Option<usize>,
    /// Whether an alignment error of a slide turns the carriage too.
    pub rotates: bool,
    /// What it is, in words.
    pub meaning: String,
}

/// One direction of the equations.
#[derive(Clone, Debug)]
pub struct Row {
    /// The direction, in the part's frame.
    pub direction: Axis,
    /// The position without error.
    pub nominal: Polynomial,
    /// The error, motion by motion: displacements, then angles, then alignments.
    pub terms: Vec<Term>,
}

/// An error motion with its lever arm in one direction, or with its factor in a rotation.
#[derive(Clone, Debug)]
pub struct Term {
    /// The number of the motion in [`Equations::motions`].
    pub motion: usize,
    /// The lever arm: a pure number for a displacement, mm for an angle; in a rotation or a direction of the tool a pure number.
    pub arm: Polynomial,
}

impl AxisInfo {
    /// Whether a correction moves it: for the tip, or for its own angle.
    pub fn corrects(&self) -> bool {
        self.effect.is_some() || self.corrects_angle
    }

    /// Whether it is a motor, which follows axes and which no program moves by itself.
    pub fn is_motor(&self) -> bool {
        !self.follows.is_empty()
    }
}

/// By which names error motions are printed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Names {
    /// The names of ISO 230-1: `EBX`.
    Iso,
    /// The machine file's symbols: `eyx`.
    #[default]
    Symbols,
}

impl Motion {
    /// The name to print.
    pub fn printed(&self, names: Names) -> &str {
        match names {
            Names::Iso => &self.name,
            Names::Symbols => &self.symbol,
        }
    }

    /// Whether the printed name counts against the ISO sense.
    pub fn is_printed_against_iso(&self, names: Names) -> bool {
        names == Names::Symbols && self.symbol_against_iso
    }

    /// The motion as it places its link.
    fn placed(&self) -> Placed<'_> {
        Placed { name: &self.name, link: self.body, kind: self.kind, rotates: self.rotates, sign: self.sign }
    }

    /// Whether it is the error of a motor that shares a beam with another one: both together are the positioning error and a rotation
    /// of the slide, at the same positions.
    pub fn shares_beam(&self) -> bool {
        self.by_motor.iter().any(|moved| moved.kind.angular())
    }

    /// An arm of the motion as that of what is printed.
    pub fn printed_arm(&self, arm: &Polynomial, names: Names) -> Polynomial {
        if self.is_printed_against_iso(names) { -arm } else { arm.clone() }
    }
}

impl Equations {
    /// The row of a direction, where that direction is sensitive.
    pub fn row(&self, direction: Axis) -> Option<&Row> {
        self.rows.iter().find(|row| row.direction == direction)
    }

    /// The lever arm of a motion in a direction; zero where it has none.
    pub fn arm(&self, direction: Axis, motion: usize) -> Polynomial {
        arm_in(self.row(direction), motion)
    }

    /// A row of the direction of the tool, where that is derived.
    pub fn orientation_row(&self, direction: Axis) -> Option<&Row> {
        self.orientation.iter().find(|row| row.direction == direction)
    }

    /// What a motion changes of the direction of the tool in a direction of the part's frame, for each rad of it: a pure number; zero
    /// where it changes nothing, and where no direction is derived.
    pub fn tilt(&self, direction: Axis, motion: usize) -> Polynomial {
        arm_in(self.orientation_row(direction), motion)
    }

    /// The rotation of the tool relative to the part about a direction of the part's frame, right-handed, for each rad
    /// of a motion: a pure number. Zero where it does not turn the tool about that direction, as no displacement does,
    /// and no alignment error of a slide whose carriage does not turn with its line.
    pub fn turn(&self, direction: Axis, motion: usize) -> Polynomial {
        let terms = &self.turns[direction.index()];
        terms.iter().find(|term| term.motion == motion).map(|term| term.arm.clone()).unwrap_or_default()
    }

    /// The axis whose own motion, actual minus commanded, an error motion is: X for EXX, C for ECC.
    pub fn own_axis(&self, motion: &Motion) -> Option<usize> {
        let number = motion.axis?;
        let axis = self.axes.get(number)?;
        if axis.is_motor() {
            return Some(number);
        }
        let own = !motion.alignment && motion.angular == axis.rotary && motion.direction == axis.along;
        own.then_some(number)
    }

    /// The number of the motion of an axis in its own direction: a displacement along a slide, a rotation about a rotary axis.
    pub fn own_motion(&self, axis: usize) -> Option<usize> {
        self.motions.iter().position(|motion| self.own_axis(motion) == Some(axis))
    }

    /// The error motions that rotary axes correct themselves: actual minus commanded angle, the zero of the axis among them. In the
    /// order of the axes.
    pub fn turning(&self) -> Vec<Turning> {
        let own = |(number, axis): (usize, &AxisInfo)| {
            let is_own = move |motion: &Motion| {
                motion.axis == Some(number) && motion.angular && motion.direction == axis.along
            };
            let motions = self.motions.iter().enumerate().filter(move |(_, motion)| is_own(motion));
            motions.map(move |(motion, _)| Turning { axis: number, motion }).collect::<Vec<_>>()
        };
        self.axes.iter().enumerate().filter(|(_, axis)| axis.corrects_angle).flat_map(own).collect()
    }

    /// The rotary axes that correct the direction of the tool, in their order; none where it is only told, or not derived.
    pub fn aiming(&self) -> Vec<usize> {
        let aiming = self.axes.iter().enumerate().filter(|(_, axis)| axis.aim.is_some());
        aiming.map(|(number, _)| number).collect()
    }

    /// For each axis, whether no error of the tip moves it in a search for a command; empty where all move.
    pub fn resting(&self) -> Vec<bool> {
        let rest: Vec<bool> =
            self.axes.iter().map(|axis| axis.effect.is_none() && !axis.is_motor()).collect();
        if rest.contains(&true) { rest } else { Vec::new() }
    }

    /// The diagonal of `J J^T`, J being the effects of all axes as columns, where these vary, but it is made of numbers and has
    /// nothing beside it: three slides at right angles, however rotary axes have turned them.
    ///
    /// None as well where it is not looked for, in a chain so long that the products would take longer than the derivation.
    pub fn squares(&self) -> Option<[f64; 3]> {
        const MOST_TERMS: usize = 100;
        let effects: Vec<_> = self.axes.iter().filter_map(|axis| axis.effect.as_ref()).collect();
        let mut parts = effects.iter().flat_map(|effect| effect.iter());
        let varies = parts.clone().any(|part| part.as_fixed().is_none());
        if !varies || parts.any(|part| part.size() > MOST_TERMS) {
            return None;
        }
        let entry = |row: usize, column: usize| -> Polynomial {
            effects.iter().map(|effect| &effect[row] * &effect[column]).collect()
        };
        let beside = [(0, 1), (0, 2), (1, 2)];
        if !beside.into_iter().all(|(row, column)| entry(row, column).is_zero()) {
            return None;
        }
        let [x, y, z] = [0, 1, 2].map(|place| entry(place, place).as_fixed());
        Some([x?, y?, z?])
    }

    /// Where motors stand: for each axis that one follows, its share.
    pub fn following(&self) -> Vec<Share> {
        self.shares(|axis| &axis.follows)
    }

    /// The error motions that motors correct by themselves.
    pub fn squaring(&self) -> Vec<Share> {
        self.shares(|axis| &axis.squares)
    }

    fn shares(&self, of: impl Fn(&AxisInfo) -> &[(usize, Rational)]) -> Vec<Share> {
        let share =
            |motor| move |(of, weight): &(usize, Rational)| Share { motor, of: *of, weight: to_f64(weight) };
        let axes = self.axes.iter().enumerate();
        axes.flat_map(|(motor, axis)| of(axis).iter().map(share(motor)).collect::<Vec<_>>()).collect()
    }

    /// Whether a program moves the axis of this number: it is no motor.
    pub fn programs(&self, axis: usize) -> bool {
        self.axes.get(axis).is_some_and(|axis| !axis.is_motor())
    }

    /// How many axes a program moves: those before the motors.
    pub fn programmed(&self) -> usize {
        self.axes.iter().filter(|axis| !axis.is_motor()).count()
    }

    /// The constants that are offsets, with their numbers: all but the parts of the tool's direction.
    pub fn offsets(&self) -> impl Iterator<Item = (usize, &ConstantInfo)> {
        self.constants.iter().enumerate().filter(|(_, constant)| constant.direction.is_none())
    }

    /// The names that a calibration of the machine may use.
    pub fn names(&self) -> MachineNames {
        let axis_letter = |axis: usize| self.axes.get(axis).map(|axis| axis.letter.clone());
        let all = || self.motions.iter().chain(&self.unseen);
        let placed: Vec<Placed<'_>> = all().map(Motion::placed).collect();
        let named = |motion: &Motion| MotionName {
            name: motion.name.clone(),
            angular: motion.angular,
            axis: motion.axis.and_then(axis_letter),
            own: self.own_axis(motion).is_some(),
            counted: counted(&self.links, &placed, &motion.placed()),
        };
        MachineNames {
            machine: self.machine.clone(),
            constants: self.constants.iter().map(|known| (known.name.to_string(), known.default)).collect(),
            turning: TurningTool::new(
                &self.links,
                self.constants.iter().map(|constant| (&constant.name, constant.direction)),
            ),
            axes: self
                .axes
                .iter()
                .map(|axis| AxisName {
                    letter: axis.letter.clone(),
                    rotary: axis.rotary,
                    follows: axis.follows.iter().map(|(of, weight)| (*of, to_f64(weight))).collect(),
                })
                .collect(),
            motions: self.motions.iter().map(named).collect(),
            unseen: self.unseen.iter().map(named).collect(),
        }
    }
}

/// The lever arm of a motion in a row; zero where it has none.
fn arm_in(row: Option<&Row>, motion: usize) -> Polynomial {
    let term = row.and_then(|row| row.terms.iter().find(|term| term.motion == motion));
    term.map(|term| term.arm.clone()).unwrap_or_default()
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.letter())
    }
}

#[cfg(test)]
mod tests {
    use crate::compile_word;
    use crate::diagnostic::Diagnostics;

    /// ISO 230-1 spells in a name what the fields say; an axis along itself has one motion of the kind that it programs.
    #[test]
    fn motions_are_what_their_names_say() {
        for word in ["FX", "XYFZ", "CXYFZA"] {
            let equations = compile_word(word, &mut Diagnostics::new()).unwrap().equations;
            let names = equations.names();
            for (motion, named) in equations.motions.iter().zip(&names.motions) {
                let direction = motion.direction;
                let letter = if motion.angular { direction.rotation_letter() } else { direction.letter() };
                let zero = if motion.alignment { "0" } else { "" };
                assert_eq!(motion.name, format!("E{letter}{zero}{}", motion.link));
                assert_eq!(names.own_axis(named), equations.own_axis(motion), "{}", motion.name);
            }
            for (number, axis) in equations.axes.iter().enumerate() {
                let own = equations.own_motion(number).map(|motion| equations.motions[motion].name.as_str());
                let (letter, along) = (&axis.letter, axis.along);
                let direction = if axis.rotary { along.rotation_letter() } else { along.letter() };
                assert_eq!(own, Some(format!("E{direction}{letter}").as_str()), "{word}");
            }
        }
    }
}
