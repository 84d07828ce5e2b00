//! The sheet: what a printed page of equations says, format aside.
//!
//! In: derived [`Equations`] and the choice of names. Out: a [`Sheet`]: the statements as trees of sums, products and letters, the lists
//! of motions and quantities, and the sentences, in printing order. Order, signs, brackets and how a name is split into letter and
//! subscript are decided here, once; a [`Writer`] only spells it, so that no two formats can say different things. Plain
//! text and JSON are here, since generated code and calibrations need them; the crate `notation` has all others.

mod brackets;
mod factored;
pub mod json;
mod letter;
mod number;
pub mod text;
mod tree;
pub mod wrap;
mod writer;

use std::collections::BTreeSet;

use crate::algebra::{Axis, Monomial, Polynomial, Rational, Symbol};
use crate::equations::{AxisInfo, Equations, Motion, Names, Row, Term};
use crate::machine::{Branch, Counted, Link, LinkKind, Reference};

pub use brackets::Brackets;
pub use letter::{Base, Greek, Letter};
pub use number::Number;
pub use text::{direction_error_lines, error_lines, infix};
pub use tree::{Angle, Expression, Function, Signed};
pub use writer::{Piece, Signs, Writer, line, pieces};

/// An equation: a letter and what it equals.
pub struct Statement {
    /// The left side.
    pub left: Letter,
    /// The right side.
    pub right: Expression,
}

/// The equations of one direction, as in (3-23) and (3-25) of the Excello report.
pub struct SheetRow {
    /// The direction, in the part's frame.
    pub direction: Axis,
    /// Nominal position, offsets and error in one sum.
    pub position: Statement,
    /// The error, motion by motion.
    pub error: Statement,
    /// The nominal position: what changes as the axes move.
    pub nominal: Expression,
    /// The offsets: constants alone.
    pub offsets: Expression,
    /// The nominal position with the offsets.
    pub whole: Expression,
}

/// An error motion in the list.
pub struct MotionEntry {
    /// By the chosen name.
    pub letter: Letter,
    /// By the name of ISO 230-1.
    pub iso: String,
    /// In words.
    pub meaning: String,
    /// `mm` or `rad`.
    pub unit: &'static str,
    /// Whether it is counted against the ISO sense.
    pub against_iso: bool,
    /// Its lever arm in each row, where it has one.
    pub arms: Vec<Option<Expression>>,
}

/// A position, travel or constant in the list.
pub struct QuantityEntry {
    /// Its name.
    pub letter: Letter,
    /// In words, unit included.
    pub meaning: String,
    /// Where its value comes from: a file, a program.
    pub value: String,
}

/// A page of equations.
pub struct Sheet {
    /// The machine's name.
    pub machine: String,
    /// A line for people.
    pub title: Option<String>,
    /// Where the model was published.
    pub source: Option<String>,
    /// What carries the tool and the part.
    pub chain: Vec<String>,
    /// The brackets that have a name, each before those in which it stands.
    pub brackets: Vec<Statement>,
    /// One for each sensitive direction.
    pub rows: Vec<SheetRow>,
    /// Those of the direction of the tool, where it is derived.
    pub orientation: Vec<SheetRow>,
    /// The error motions.
    pub motions: Vec<MotionEntry>,
    /// Positions, travels and constants.
    pub quantities: Vec<QuantityEntry>,
    /// The conventions in force, a sentence each.
    pub conventions: Vec<String>,
}

impl Sheet {
    /// Settles what a page says.
    pub fn new(equations: &Equations, names: Names) -> Self {
        let written = Brackets::new(equations, taken_names(equations, &[names]));
        Self {
            machine: equations.machine.clone(),
            title: equations.title.clone(),
            source: equations.source.clone(),
            chain: chain(equations),
            brackets: written
                .definitions()
                .map(|(left, right)| Statement { left: left.clone(), right })
                .collect(),
            rows: equations.rows.iter().map(|one| row(one, equations, names, &written, of_tip)).collect(),
            orientation: equations
                .orientation
                .iter()
                .map(|one| row(one, equations, names, &written, Letter::of_tool))
                .collect(),
            motions: motions(equations, names, &written),
            quantities: quantities(equations),
            conventions: conventions(equations, names, &written),
        }
    }

    /// The name and the title in one line.
    pub fn heading(&self) -> String {
        match &self.title {
            Some(title) => format!("{}: {title}", self.machine),
            None => self.machine.clone(),
        }
    }
}

/// The letter of a direction of the tip, or of its error.
fn of_tip(direction: Axis, difference: bool) -> Letter {
    let front = if difference { "dP" } else { "P" };
    Letter::position(format!("{front}{}", direction.letter().to_ascii_lowercase()), direction, difference)
}

/// The names of positions, travels and constants, and of error motions by these names.
pub fn taken_names(equations: &Equations, names: &[Names]) -> BTreeSet<String> {
    let quantities = quantities(equations).into_iter().map(|entry| entry.letter.plain);
    let motions = equations.motions.iter();
    let motions = motions.flat_map(|motion| names.iter().map(|names| motion.printed(*names).to_owned()));
    quantities.chain(motions).collect()
}

fn row(
    row: &Row,
    equations: &Equations,
    names: Names,
    written: &Brackets,
    letter: fn(Axis, bool) -> Letter,
) -> SheetRow {
    let letter = |difference| letter(row.direction, difference);
    let nominal = row.nominal.part(moves);
    let offsets = row.nominal.part(|monomial| !moves(monomial));
    let mut parts = written.parts(&nominal);
    parts.extend(written.parts(&offsets));
    parts.push(tree::plus(letter(true)));
    let terms = row.terms.iter().filter_map(|term| {
        let motion = equations.motions.get(term.motion)?;
        Some(written.term(&motion.printed_arm(&term.arm, names), Letter::motion(motion, names)))
    });
    SheetRow {
        direction: row.direction,
        position: Statement { left: letter(false), right: tree::sum(parts) },
        error: Statement { left: letter(true), right: tree::sum(terms.collect()) },
        nominal: written.sum(&nominal),
        offsets: written.sum(&offsets),
        whole: written.sum(&row.nominal),
    }
}

/// Whether a monomial changes as the axes move.
fn moves(monomial: &Monomial) -> bool {
    monomial
        .factors()
        .iter()
        .any(|(symbol, _)| !matches!(symbol, Symbol::Constant(_) | Symbol::FixedCos(_) | Symbol::FixedSin(_)))
}

fn motions(equations: &Equations, names: Names, written: &Brackets) -> Vec<MotionEntry> {
    let arm = |row: &Row, number: usize| {
        let found: Option<&Term> = row.terms.iter().find(|term| term.motion == number);
        let motion = equations.motions.get(number);
        found.zip(motion).map(|(term, motion)| written.expression(&motion.printed_arm(&term.arm, names)))
    };
    let known = equations.names().motions;
    let counted = |number: usize| known.get(number).map_or(&[][..], |known| known.counted.as_slice());
    let entry = |(number, motion): (usize, &Motion)| MotionEntry {
        letter: Letter::motion(motion, names),
        iso: motion.name.clone(),
        meaning: meaning(equations, motion, counted(number)),
        unit: if motion.angular { "rad" } else { "mm" },
        against_iso: motion.is_printed_against_iso(names),
        arms: equations.rows.iter().map(|row| arm(row, number)).collect(),
    };
    equations.motions.iter().enumerate().map(entry).collect()
}

/// What an error motion is; of the place of a rotary axis also its names in ISO 230-7 and, counted from another axis, ISO 230-1.
fn meaning(equations: &Equations, motion: &Motion, counted: &[Counted]) -> String {
    if !is_place_of_rotary(equations, motion) {
        return motion.meaning.clone();
    }
    let (letter, id) = (motion.kind.letter(), &motion.link);
    let same = counted.iter().filter(|one| one.is == motion.name);
    let same: String = same.map(|one| format!(", E{letter}(0{}){id}", one.from)).collect();
    format!("{}; also {letter}O{id}{same}", motion.meaning)
}

fn is_place_of_rotary(equations: &Equations, motion: &Motion) -> bool {
    let link = equations.links.get(motion.body);
    motion.alignment && link.is_some_and(|link| matches!(link.kind, LinkKind::Rotary(_)))
}

fn quantities(equations: &Equations) -> Vec<QuantityEntry> {
    let entry = |name: &str, meaning: String, value: String| QuantityEntry {
        letter: Letter::named(name),
        meaning,
        value,
    };
    let positions = equations.axes.iter().map(|axis| {
        let unit = if axis.rotary { "rad" } else { "mm" };
        match axis.is_motor() {
            true => entry(
                &axis.variable,
                format!("travel of motor {}: {} ({unit})", axis.letter, followed(equations, axis)),
                "that of its axes".to_owned(),
            ),
            false => {
                let meaning = format!("position of axis {} ({unit})", axis.letter);
                entry(&axis.variable, meaning, "programmed".to_owned())
            }
        }
    });
    let travels = equations.travels.iter().map(|travel| {
        let letter = equations.axes.get(travel.axis).map_or("", |axis| &axis.letter);
        let meaning = format!("travel of {letter} from the place where its alignment was measured (mm)");
        entry(&travel.name, meaning, format!("the position of {letter} unless another is given"))
    });
    let constants = equations.constants.iter().map(|constant| {
        if constant.direction.is_some() {
            let meaning = constant.meaning.as_deref().unwrap_or("part of the direction of the tool");
            let value = "from the calibration's tools".to_owned();
            return entry(&constant.name, format!("{meaning} (a pure number, in the tool's frame)"), value);
        }
        let meaning = constant.meaning.as_deref().unwrap_or("constant of the machine");
        let value = constant.default.map(|own| format!("{own} mm unless a calibration gives another value"));
        let value = value.unwrap_or_else(|| "from the calibration".to_owned());
        entry(&constant.name, format!("{meaning} (mm)"), value)
    });
    positions.chain(travels).chain(constants).collect()
}

/// The sum of axes that a motor follows, `x + y`.
pub(crate) fn followed(equations: &Equations, motor: &AxisInfo) -> String {
    let part = |(axis, weight): &(usize, Rational)| {
        let axis = equations.axes.get(*axis).map(|axis| axis.variable.clone()).unwrap_or_default();
        &Polynomial::symbol(Symbol::Position(axis)) * &Polynomial::number(weight.clone())
    };
    infix(&motor.follows.iter().map(part).collect::<Polynomial>())
}

/// Both branches in words, from the bed outwards.
fn chain(equations: &Equations) -> Vec<String> {
    let branch = |branch, what: &str| {
        let links = equations.links.iter().filter(|link| link.branch == branch);
        let bodies: Vec<String> = links.map(link_in_words).collect();
        let bodies = if bodies.is_empty() { "at rest".to_owned() } else { bodies.join(", then ") };
        format!("From the bed to {what}: {bodies}.")
    };
    vec![branch(Branch::Workpiece, "the part"), branch(Branch::Tool, "the tool")]
}

fn link_in_words(link: &Link) -> String {
    let sign = if link.along.sign < 0 { '-' } else { '+' };
    let along = link.along.axis;
    let id = &link.id;
    let what = match link.kind {
        LinkKind::Slide(_) => format!("{id} (slides along {sign}{along})"),
        LinkKind::Rotary(_) => format!("{id} (turns about {sign}{along}{})", leaning(link)),
        LinkKind::Spindle => format!("spindle {id} (about {along})"),
        kind => format!("{} {id}{}", kind.word(), turned(link)),
    };
    if link.origin.iter().all(crate::algebra::Polynomial::is_zero) {
        return what;
    }
    let [x, y, z] = link.origin.each_ref().map(infix);
    format!("{what} at [{x}, {y}, {z}]")
}

/// By what the axis of a rotary axis leans.
fn leaning(link: &Link) -> String {
    if link.turned.is_none() { String::new() } else { format!(", leaning by {}", link.turned.words()) }
}

/// By what a body that is at rest is turned.
fn turned(link: &Link) -> String {
    if link.turned.is_none() { String::new() } else { format!(" (turned by {})", link.turned.words()) }
}

/// In which directions the error motions of links count whose frames are turned for good.
fn turned_frames(equations: &Equations) -> Option<String> {
    let turned = equations.links.iter().filter(|link| !link.turned.is_none());
    let ids: Vec<&str> = turned.map(|link| link.id.as_str()).collect();
    (!ids.is_empty()).then(|| {
        format!(
            "Error motions of {} are along and about the directions of its own frame, which constant angles turn about X, then Y, then Z; \
             the name of an axis that leans is that of its direction there.",
            ids.join(" and of ")
        )
    })
}

/// In which sense a motion of the part's branch is counted, and about which points bodies turn.
fn senses(equations: &Equations) -> Vec<String> {
    let mut sentences = Vec::new();
    if equations.relative {
        sentences.push(
            "Error motions are those of the tool relative to the part. On the part's branch, every motion except the link's own \
             is the opposite of the motion of the body. The alignment error of a slide rotates a line and is the same from \
             either side."
                .to_owned(),
        );
    } else {
        sentences.push(
            "An error motion is that of its own body, in the directions of the frame before it, on either branch.".to_owned(),
        );
    }
    let bed = |link: &&Link| matches!(link.kind, LinkKind::Slide(_)) && link.reference == Reference::Bed;
    let about_bed: Vec<&str> = equations.links.iter().filter(bed).map(|link| link.id.as_str()).collect();
    sentences.push(if about_bed.is_empty() {
        "Rotations of a slide act about its origin, which travels with it.".to_owned()
    } else {
        format!("Rotations of {} act about an origin fixed to the bed.", about_bed.join(", "))
    });
    sentences
}

/// Which rotary axes correct their own angles, and which leave them to the slides.
fn own_angles(equations: &Equations, names: Names) -> Vec<String> {
    let own: Vec<&str> = equations
        .turning()
        .iter()
        .filter_map(|own| equations.motions.get(own.motion))
        .map(|motion| motion.printed(names))
        .collect();
    let left = equations.axes.iter().filter(|axis| axis.rotary && !axis.corrects_angle);
    let left: Vec<&str> = left.map(|axis| axis.letter.as_str()).collect();
    let corrected = (!own.is_empty())
        .then(|| format!("A rotary axis corrects the error of its own angle by itself: {}.", own.join(", ")));
    let left = (!left.is_empty())
        .then(|| format!("Slides correct the effect of the own angle of {} at the tip.", left.join(" and ")));
    corrected.into_iter().chain(left).chain(aimed(equations)).collect()
}

/// Which rotary axes correct the direction of the tool.
fn aimed(equations: &Equations) -> Option<String> {
    let axes = equations.aiming().into_iter().filter_map(|axis| equations.axes.get(axis));
    let axes: Vec<&str> = axes.map(|axis| axis.letter.as_str()).collect();
    (!axes.is_empty()).then(|| {
        format!(
            "The direction of the tool is corrected by {}. Slides undo the effect of this on the tip.",
            axes.join(" and ")
        )
    })
}

fn conventions(equations: &Equations, names: Names, written: &Brackets) -> Vec<String> {
    let mut sentences: Vec<String> = [
        "P is the position of the tool tip relative to the part at the nominal contact point, in the part's frame, in mm.",
        "Each P is the sum of the nominal position, the offsets and the error dP. Compensation adds -dP.",
        "The equations are of first order: products of two error motions are dropped. The nominal part is exact.",
        "Displacements are in mm; rotations are in rad and right-handed.",
        "The error motion of a slide in its own direction is actual minus commanded.",
        "Error motions are named as in ISO 230-1: E, a direction (X Y Z along, A B C about), the body. A zero before the body \
         marks an alignment error.",
    ]
    .map(str::to_owned)
    .to_vec();
    if !equations.orientation.is_empty() {
        sentences.push(
            "I, J, K are the direction of the tool from its tip towards the spindle, in the part's frame, a vector of length 1. \
             dI, dJ, dK are its error in rad, which slides do not change."
                .to_owned(),
        );
    }
    sentences.extend(senses(equations));
    sentences.extend(turned_frames(equations));
    if equations.axes.iter().any(|axis| axis.rotary) {
        sentences.push("Rotary axes rotate by large angles. Their sines and cosines are exact.".to_owned());
        sentences.extend(own_angles(equations, names));
    }
    if equations.motions.iter().any(|motion| is_place_of_rotary(equations, motion)) {
        sentences.push(
            "The place of a rotary axis is EX0C here and XOC in ISO 230-7. EA(0Y)C, in the notation of ISO 230-1, is counted \
             from Y; it is shown beside EA0C if both are the same."
                .to_owned(),
        );
    }
    if written.definitions().next().is_some() {
        sentences.push("A bracket that occurs more than once has a name that begins with L.".to_owned());
    }
    let against: Vec<&str> = equations
        .motions
        .iter()
        .filter(|motion| motion.is_printed_against_iso(names))
        .map(|motion| motion.printed(names))
        .collect();
    if !against.is_empty() {
        sentences.push(format!("Counted against the sense of ISO 230-1: {}.", against.join(", ")));
    }
    if !equations.unseen.is_empty() {
        let unseen: Vec<&str> = equations.unseen.iter().map(|motion| motion.printed(names)).collect();
        sentences
            .push(format!("Without effect, because they have no lever arm here: {}.", unseen.join(", ")));
    }
    let absent: Vec<String> = Axis::ALL
        .into_iter()
        .filter(|axis| equations.row(*axis).is_none())
        .map(|axis| axis.to_string())
        .collect();
    if !absent.is_empty() {
        sentences.push(format!(
            "Not derived, because the machine file does not call it sensitive: {}.",
            absent.join(", ")
        ));
    }
    sentences
}

#[cfg(test)]
mod tests;
