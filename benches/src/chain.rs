//! A machine's chain as plain numbers and words, for everything that multiplies its matrices outside Abbe.
//!
//! In: a validated machine. Out: for each link its origin, its travel or turn, and what its error motions do to it, with
//! their signs. It exists because nalgebra, Maxima, SymPy, CasADi and SymForce must all multiply the same matrices, and
//! none of them may take Abbe's product over. The signs are those of the machine file's definition.

use std::fmt::Write;

use model_dsl::algebra::{Axis, Polynomial};
use model_dsl::machine::{Branch, Link as MachineLink, LinkKind, Machine, Motion, MotionKind, Reference};
use model_dsl::sheet::infix;

/// A chain: both branches from the bed outwards, the part's first.
#[derive(Clone, Debug)]
pub struct Chain {
    /// The machine's name.
    pub name: String,
    /// The programmed positions, in the order of the equations.
    pub variables: Vec<String>,
    /// The named offsets.
    pub constants: Vec<String>,
    /// The error motions, in the order given.
    pub motions: Vec<String>,
    /// Whether X, Y and Z of the part are asked for.
    pub sensitive: [bool; 3],
    /// The links.
    pub links: Vec<Link>,
}

/// One link.
#[derive(Clone, Debug)]
pub struct Link {
    /// Whether it carries the tool, and not the part.
    pub tool: bool,
    /// The place of its frame in the frame before it, mm.
    pub origin: [Polynomial; 3],
    /// What its program does.
    pub drive: Option<Drive>,
    /// What turns or shifts its body.
    pub small: Vec<Small>,
    /// What turns its line of motion.
    pub lines: Vec<Line>,
}

/// A programmed motion.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Whether it turns.
    pub rotary: bool,
    /// The direction, 0 to 2.
    pub axis: usize,
    /// +1.0 or -1.0.
    pub sign: f64,
    /// The number of its position in [`Chain::variables`].
    pub variable: usize,
}

/// An error motion of a body.
#[derive(Clone, Debug)]
pub struct Small {
    /// Its number in [`Chain::motions`].
    pub motion: usize,
    /// Whether it is an angle.
    pub angular: bool,
    /// The direction, 0 to 2.
    pub axis: usize,
    /// +1.0 or -1.0.
    pub sign: f64,
}

/// An alignment error of a slide: it shifts the carriage by angle times travel.
#[derive(Clone, Debug)]
pub struct Line {
    /// Its number in [`Chain::motions`].
    pub motion: usize,
    /// The direction in which it shifts, 0 to 2.
    pub axis: usize,
    /// +1.0 or -1.0.
    pub sign: f64,
    /// The travel, where it is not the position of the slide itself.
    pub travel: Option<String>,
}

impl Chain {
    /// The chain of a machine, with its error motions numbered as in `motions`; the others are left out.
    ///
    /// # Errors
    /// Names a link that this description has no words for.
    pub fn new(machine: &Machine, motions: &[String]) -> Result<Self, String> {
        let variables: Vec<String> =
            machine.axes().iter().map(|(_, link)| link.variable().to_string()).collect();
        let links = machine.links.iter().enumerate();
        Ok(Self {
            name: machine.name.clone(),
            constants: machine.constants.iter().map(|constant| constant.name.to_string()).collect(),
            motions: motions.to_vec(),
            sensitive: Axis::ALL.map(|axis| machine.sensitive.contains(&axis)),
            links: links
                .map(|(number, link)| one(machine, motions, &variables, number, link))
                .collect::<Result<_, _>>()?,
            variables,
        })
    }

    /// The description as JSON, for `codegen.py` and `derive.py`.
    pub fn json(&self) -> String {
        let links: Vec<String> = self.links.iter().map(Link::json).collect();
        format!(
            "{{\"name\": {:?}, \"variables\": {:?}, \"constants\": {:?}, \"motions\": {:?}, \"sensitive\": {:?}, \"links\": [{}]}}\n",
            self.name,
            self.variables,
            self.constants,
            self.motions,
            self.sensitive,
            links.join(", ")
        )
    }
}

impl Link {
    fn json(&self) -> String {
        let mut text = String::new();
        let origin = self.origin.each_ref().map(infix);
        let _ = write!(text, "{{\"tool\": {}, \"origin\": {origin:?}, \"drive\": ", self.tool);
        match &self.drive {
            Some(Drive { rotary, axis, sign, variable }) => {
                let _ = write!(
                    text,
                    "{{\"rotary\": {rotary}, \"axis\": {axis}, \"sign\": {sign}, \"variable\": {variable}}}"
                );
            }
            None => text.push_str("null"),
        }
        let small = self.small.iter().map(|Small { motion, angular, axis, sign }| {
            format!("{{\"motion\": {motion}, \"angular\": {angular}, \"axis\": {axis}, \"sign\": {sign}}}")
        });
        let lines = self.lines.iter().map(|Line { motion, axis, sign, travel }| {
            let travel = travel.as_ref().map_or("null".to_owned(), |travel| format!("{travel:?}"));
            format!("{{\"motion\": {motion}, \"axis\": {axis}, \"sign\": {sign}, \"travel\": {travel}}}")
        });
        let (small, lines): (Vec<_>, Vec<_>) = (small.collect(), lines.collect());
        let _ = write!(text, ", \"small\": [{}], \"lines\": [{}]}}", small.join(", "), lines.join(", "));
        text
    }
}

fn one(
    machine: &Machine,
    motions: &[String],
    variables: &[String],
    number: usize,
    link: &MachineLink,
) -> Result<Link, String> {
    if matches!(link.kind, LinkKind::Slide(_)) && link.reference != Reference::Carriage {
        return Err(format!("link {}: errors that act at the bed are not described here", link.id));
    }
    if !link.turned.is_none() {
        return Err(format!("link {}: a frame that is turned for good is not described here", link.id));
    }
    let mut described = Link {
        tool: link.branch == Branch::Tool,
        origin: link.origin.clone(),
        drive: drive(link, variables),
        small: Vec::new(),
        lines: Vec::new(),
    };
    for motion in machine.motions.iter().filter(|motion| motion.link == number) {
        let Some(place) = motions.iter().position(|name| *name == motion.name) else { continue };
        let sign = body_sign(motion, link, machine.relative);
        if is_line(motion, link) {
            if motion.rotates {
                return Err(format!("{}: a line that turns its carriage is not described here", motion.name));
            }
            described.lines.extend(line(motion, link, place, sign));
        } else {
            let (angular, axis) = (motion.kind.angular(), motion.kind.axis().index());
            described.small.push(Small { motion: place, angular, axis, sign });
        }
    }
    Ok(described)
}

fn drive(link: &MachineLink, variables: &[String]) -> Option<Drive> {
    link.kind.letter()?;
    Some(Drive {
        rotary: matches!(link.kind, LinkKind::Rotary(_)),
        axis: link.along.axis.index(),
        sign: plain(link.along.sign),
        variable: variables.iter().position(|name| **name == *link.variable())?,
    })
}

fn is_line(motion: &Motion, link: &MachineLink) -> bool {
    matches!((link.kind, motion.kind), (LinkKind::Slide(_), MotionKind::Alignment(_)))
}

/// Right-handed: a turn about `about` moves `along` towards the third direction, or against it.
fn line(motion: &Motion, link: &MachineLink, place: usize, sign: f64) -> Option<Line> {
    let (about, along) = (motion.kind.axis().index(), link.along.axis.index());
    let side = match (about + 3 - along) % 3 {
        1 => -1.0,
        2 => 1.0,
        _ => return None,
    };
    let travel = motion.travel.as_ref().map(|travel| travel.value.to_string());
    Some(Line { motion: place, axis: 3 - about - along, sign: side * plain(link.along.sign) * sign, travel })
}

/// An error motion moves its own body in bed directions; only along (or about) the axis itself it is counted along it.
fn body_sign(motion: &Motion, link: &MachineLink, relative: bool) -> f64 {
    let own = motion.kind.axis() == link.along.axis
        && match link.kind {
            LinkKind::Slide(_) => matches!(motion.kind, MotionKind::Linear(_)),
            LinkKind::Rotary(_) => motion.kind.angular(),
            _ => false,
        };
    let turned = relative && link.branch == Branch::Workpiece && !is_line(motion, link);
    let side = if own {
        link.along.sign
    } else if turned {
        -1
    } else {
        1
    };
    plain(motion.sign * side)
}

fn plain(sign: i64) -> f64 {
    if sign < 0 { -1.0 } else { 1.0 }
}
