//! From the chain to the equations: the first-order product of homogeneous transformations.
//!
//! In: a validated [`Machine`]. Out: its [`Equations`], with warnings for what the machine
//! file names in vain. Each link is a matrix from the frame before it to its own; the product
//! along the tool's branch, seen from the inverse of the product along the part's branch,
//! is the tool relative to the part (equation (3-15) of the Excello report, (A.11) of NISTIR 6722).
//! Its origin gives the rows of the tool tip, its rotation the turns that an angular instrument sees, and the direction
//! of the tool where the machine file asks for it. All are vectors, and are carried through the links one by one: the whole
//! product, whose rotation grows threefold with every rotary axis, is nowhere written out.

mod link_matrix;
mod meaning;

use std::f64::consts::TAU;

use num_traits::One;

use crate::algebra::{Axis, FirstOrder, Htm, Name, Polynomial, Rational, Symbol};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::equations::{AxisInfo, ConstantInfo, Equations, Motion, Row, Term, TravelInfo};
use crate::machine::{
    Branch, Element, ElementKind, Link, LinkKind, Machine, MotionKind, Motor, Orientation, body_sign,
};

pub use link_matrix::matrix as link_matrix;
pub use meaning::{NamedMotion, named};

/// Derives the error equations of a machine; warnings go to `diagnostics`.
pub fn derive(machine: &Machine, diagnostics: &mut Diagnostics) -> Equations {
    let (tip, turn) = relative(machine);
    let tip = &tip;
    let direction = machine.orientation.is_derived().then(|| relative_direction(machine));
    let kept = seen_motions(machine, tip, direction.as_ref());
    warn_unseen(machine, &kept, diagnostics);
    let rows = rows(machine, tip, &kept);
    warn_undriven(machine, &rows, diagnostics);
    let travels = travels(machine, &kept);
    let unseen = (0..machine.motions.len()).filter(|number| kept.binary_search(number).is_err());
    Equations {
        machine: machine.name.clone(),
        title: machine.title.clone(),
        source: machine.source.clone(),
        links: machine.links.clone(),
        relative: machine.relative,
        axes: axes(machine, tip, direction.as_ref()).into_iter().chain(motors(machine, &kept)).collect(),
        constants: constants(machine),
        motions: kept.iter().map(|number| motion(machine, *number, &travels)).collect(),
        unseen: unseen.map(|number| motion(machine, number, &travels)).collect(),
        travels,
        rows,
        orientation: direction.iter().flat_map(|entries| rows_of(machine, entries, &kept)).collect(),
        turns: turn.each_ref().map(|entry| terms(machine, entry, &kept)),
    }
}

/// The tool tip in the part's frame, to first order in the machine's motions by their numbers.
pub fn relative_position(machine: &Machine) -> [FirstOrder; 3] {
    relative(machine).0
}

/// The direction of the tool in the part's frame, a vector of length 1 to first order in the machine's motions by their numbers.
pub fn relative_direction(machine: &Machine) -> [FirstOrder; 3] {
    let direction = match machine.tool_direction() {
        Some(parts) => parts.map(|name| Polynomial::symbol(Symbol::Constant(name.clone()))),
        None => {
            let along = machine.tool_axis();
            Axis::ALL.map(|axis| Polynomial::integer(if axis == along.axis { along.sign } else { 0 }))
        }
    };
    let direction = direction.map(FirstOrder::nominal);
    inwards(machine).fold(direction, |direction, link| link.carry(&direction))
}

/// The tool tip in the frame of the part, and the small rotation of the tool by the errors, in its directions.
fn relative(machine: &Machine) -> ([FirstOrder; 3], [FirstOrder; 3]) {
    inwards(machine).fold(Default::default(), |(tip, turn), link| (link.place(&tip), seen_from(&link, &turn)))
}

/// The matrices from the tool inwards to the bed, and on to the part.
fn inwards(machine: &Machine) -> impl Iterator<Item = Htm> {
    let links = |branch| machine.branch(branch).map(|(number, _)| link_matrix(machine, number));
    let from_bed: Vec<Htm> = links(Branch::Tool).collect();
    from_bed.into_iter().rev().chain(links(Branch::Workpiece).map(|link| link.inverse()))
}

/// The rotation by the errors of a link and of what stands on it, in the frame before the link.
fn seen_from(link: &Htm, turn: &[FirstOrder; 3]) -> [FirstOrder; 3] {
    let (own, carried) = (link.turn(), link.turned(turn));
    std::array::from_fn(|axis| &own[axis] + &carried[axis])
}

fn is_sensitive(machine: &Machine, direction: Axis) -> bool {
    machine.sensitive.contains(&direction)
}

/// The motions that some sensitive direction sees, or the direction of the tool where that is derived, or that a rotary axis
/// corrects itself, by their numbers in the machine.
fn seen_motions(machine: &Machine, tip: &[FirstOrder; 3], direction: Option<&[FirstOrder; 3]>) -> Vec<usize> {
    let rows = Axis::ALL.into_iter().zip(tip).filter(|(direction, _)| is_sensitive(machine, *direction));
    let entries = rows.map(|(_, entry)| entry).chain(direction.into_iter().flatten());
    let seen = entries.flat_map(|entry| entry.error_part().map(|(motion, _)| motion));
    let corrected = (0..machine.motions.len()).filter(|motion| is_own_angle(machine, *motion));
    let mut seen: Vec<usize> = seen.chain(corrected).collect();
    seen.sort_unstable();
    seen.dedup();
    seen
}

/// Whether a motion is the angle of a rotary axis that corrects it itself.
fn is_own_angle(machine: &Machine, motion: usize) -> bool {
    let motion = &machine.motions[motion];
    let link = &machine.links[motion.link];
    let rotary = matches!(link.kind, LinkKind::Rotary(_));
    rotary && link.corrects && motion.kind.angular() && motion.kind.axis() == link.along.axis
}

fn rows(machine: &Machine, tip: &[FirstOrder; 3], kept: &[usize]) -> Vec<Row> {
    rows_of(machine, tip, kept).into_iter().filter(|row| is_sensitive(machine, row.direction)).collect()
}

/// A row for each of the three entries of a vector.
fn rows_of(machine: &Machine, vector: &[FirstOrder; 3], kept: &[usize]) -> Vec<Row> {
    let entries = Axis::ALL.into_iter().zip(vector);
    entries.map(|(direction, entry)| row(machine, direction, entry, kept)).collect()
}

fn row(machine: &Machine, direction: Axis, entry: &FirstOrder, kept: &[usize]) -> Row {
    Row { direction, nominal: entry.nominal_part().clone(), terms: terms(machine, entry, kept) }
}

/// The motions that an entry holds, with their factors: displacements, then angles, then alignments.
fn terms(machine: &Machine, entry: &FirstOrder, kept: &[usize]) -> Vec<Term> {
    let mut terms: Vec<Term> = entry
        .error_part()
        .filter_map(|(number, arm)| {
            kept.binary_search(&number).ok().map(|motion| Term { motion, arm: arm.clone() })
        })
        .collect();
    terms.sort_by_key(|term| {
        let kind =
            kept.get(term.motion).and_then(|number| machine.motions.get(*number)).map(|motion| motion.kind);
        (kind.map(|kind| (kind.alignment(), kind.angular())), term.motion)
    });
    terms
}

fn motion(machine: &Machine, number: usize, travels: &[TravelInfo]) -> Motion {
    let motion = &machine.motions[number];
    let link = &machine.links[motion.link];
    let motor = motion.motor.and_then(|motor| machine.motors.get(motor));
    Motion {
        name: motion.name.clone(),
        symbol: motion.symbol.clone(),
        angular: motion.kind.angular(),
        direction: motion.kind.axis(),
        alignment: motion.kind.alignment(),
        symbol_against_iso: motion.sign < 0,
        link: motor.map_or_else(|| link.id.clone(), |motor| motor.name.value.clone()),
        axis: match motion.motor {
            Some(motor) => Some(machine.axes().len() + motor),
            None => machine.axes().iter().position(|(axis, _)| *axis == motion.link),
        },
        body: motion.link,
        by_motor: motor.map(|motor| motor.moves.clone()).unwrap_or_default(),
        kind: motion.kind,
        sign: body_sign(motion, link, machine.relative),
        travel: motion
            .travel
            .as_ref()
            .and_then(|travel| travels.iter().position(|known| known.name == travel.value)),
        rotates: motion.rotates,
        meaning: match motor {
            Some(motor) => format!("error of motor {}", motor.name.value),
            None => meaning::of(motion, link),
        },
    }
}

fn constants(machine: &Machine) -> Vec<ConstantInfo> {
    let constant = |constant: &crate::machine::Constant| ConstantInfo {
        name: constant.name.clone(),
        meaning: constant.meaning.clone(),
        default: constant.default,
        direction: constant.direction,
    };
    machine.constants.iter().map(constant).collect()
}

fn travels(machine: &Machine, kept: &[usize]) -> Vec<TravelInfo> {
    let axes = machine.axes();
    let mut travels: Vec<TravelInfo> = Vec::new();
    for motion in kept.iter().map(|number| &machine.motions[*number]) {
        let axis = axes.iter().position(|(link, _)| *link == motion.link);
        if let (Some(travel), Some(axis)) = (&motion.travel, axis)
            && !travels.iter().any(|known| known.name == travel.value)
        {
            travels.push(TravelInfo { name: travel.value.clone(), axis });
        }
    }
    travels
}

fn axes(machine: &Machine, tip: &[FirstOrder; 3], direction: Option<&[FirstOrder; 3]>) -> Vec<AxisInfo> {
    let mut correcting: Vec<(Axis, Branch)> = Vec::new();
    let mut axes = Vec::new();
    for (_, link) in machine.axes() {
        let rotary = matches!(link.kind, LinkKind::Rotary(_));
        let effect = effect(machine, tip, &link.variable());
        let first = !correcting.iter().any(|(axis, _)| *axis == link.along.axis);
        let corrects = !rotary && first && effect.iter().any(|entry| !entry.is_zero());
        if corrects {
            correcting.push((link.along.axis, link.branch));
        }
        axes.push(AxisInfo {
            letter: link.kind.letter().map(String::from).unwrap_or_default(),
            variable: link.variable(),
            rotary,
            along: link.along.axis,
            branch: link.branch,
            effect: corrects.then_some(effect),
            corrects_angle: rotary && link.corrects,
            aim: direction.and_then(|direction| aim(machine, link, direction)),
            elements: elements(machine, link),
            follows: Vec::new(),
            squares: Vec::new(),
        });
    }
    axes
}

/// The motors as axes that follow the others, behind these.
fn motors(machine: &Machine, kept: &[usize]) -> Vec<AxisInfo> {
    let places = machine.axes();
    let axis_of = |link: usize| places.iter().position(|(axis, _)| *axis == link);
    let motor = |(number, motor): (usize, &Motor)| {
        let home = machine.links.get(motor.follows.first()?.0)?;
        Some(AxisInfo {
            letter: motor.name.value.clone(),
            variable: motor.variable(),
            rotary: false,
            along: home.along.axis,
            branch: home.branch,
            effect: None,
            corrects_angle: false,
            elements: elements_of(machine, &motor.name.value).collect(),
            aim: None,
            follows: motor
                .follows
                .iter()
                .filter_map(|(link, weight)| Some((axis_of(*link)?, weight.clone())))
                .collect(),
            squares: squares(machine, number, kept),
        })
    };
    machine.motors.iter().enumerate().filter_map(motor).collect()
}

/// What a motor of a beam corrects by itself: its own error, and the rotation of the beam over its lever.
fn squares(machine: &Machine, number: usize, kept: &[usize]) -> Vec<(usize, Rational)> {
    let motor = &machine.motors[number];
    let Some(beam) = motor.beam.as_ref().filter(|beam| beam.corrects) else { return Vec::new() };
    let weight = |motion: &crate::machine::Motion| {
        if motion.motor == Some(number) {
            return Some(Rational::one());
        }
        let (link, _) = motor.follows.first()?;
        let turns = motion.link == *link && motion.kind == MotionKind::Angular(beam.about);
        let sign = Rational::from_integer(body_sign(motion, &machine.links[*link], machine.relative).into());
        turns.then(|| &beam.arm * sign)
    };
    let motions = kept.iter().enumerate();
    motions.filter_map(|(place, motion)| Some((place, weight(&machine.motions[*motion])?))).collect()
}

/// What an axis that corrects the direction of the tool turns it by for each rad; none where it turns it nowhere.
fn aim(machine: &Machine, link: &Link, direction: &[FirstOrder; 3]) -> Option<[Polynomial; 3]> {
    let rotary = matches!(link.kind, LinkKind::Rotary(_));
    if machine.orientation != Orientation::Corrected || !rotary || !link.corrects {
        return None;
    }
    let name = link.variable();
    let aim = direction.each_ref().map(|entry| by_angle(entry.nominal_part(), &name));
    aim.iter().any(|entry| !entry.is_zero()).then_some(aim)
}

/// The derivative by an angle, which stands in sines and cosines.
fn by_angle(value: &Polynomial, angle: &Name) -> Polynomial {
    let (sine, cosine) = (Symbol::Sin(angle.clone()), Symbol::Cos(angle.clone()));
    let of_sine = &value.derivative(&sine) * &Polynomial::symbol(cosine.clone());
    let of_cosine = &value.derivative(&cosine) * &Polynomial::symbol(sine);
    &of_sine - &of_cosine
}

/// What repeats along the travel of an axis.
fn elements(machine: &Machine, link: &Link) -> Vec<Element> {
    let rotary = matches!(link.kind, LinkKind::Rotary(_));
    let itself = rotary.then_some(Element { kind: ElementKind::Axis, period: TAU });
    let letter = link.kind.letter().map(String::from).unwrap_or_default();
    itself.into_iter().chain(elements_of(machine, &letter).collect::<Vec<_>>()).collect()
}

/// What the machine file says of the drive of an axis or a motor.
fn elements_of<'m>(machine: &'m Machine, name: &'m str) -> impl Iterator<Item = Element> + 'm {
    let drives = machine.drives.iter().filter(move |drive| drive.axis.value == name);
    drives.flat_map(|drive| drive.elements.iter().copied())
}

/// The nominal displacement of the tip for each mm of a slide, zero in insensitive directions.
fn effect(machine: &Machine, tip: &[FirstOrder; 3], variable: &Name) -> [Polynomial; 3] {
    let position = Symbol::Position(variable.clone());
    Axis::ALL.map(|direction| {
        if is_sensitive(machine, direction) {
            tip[direction.index()].nominal_part().derivative(&position)
        } else {
            Polynomial::zero()
        }
    })
}

fn warn_unseen(machine: &Machine, kept: &[usize], diagnostics: &mut Diagnostics) {
    for (number, motion) in machine.motions.iter().enumerate() {
        if let Some(span) = motion.span
            && kept.binary_search(&number).is_err()
        {
            let help = if machine.sensitive.len() == Axis::ALL.len() {
                "remove it: it has no lever arm at the tool tip"
            } else {
                "remove it, or add a direction to `sensitive`"
            };
            diagnostics.push(
                Diagnostic::warning("W0201", span, format!("no sensitive direction sees {}", motion.name))
                    .label("it drops out of the equations")
                    .help(help),
            );
        }
    }
}

fn warn_undriven(machine: &Machine, rows: &[Row], diagnostics: &mut Diagnostics) {
    for (direction, span) in &machine.sensitive_spans {
        let driven = rows.iter().filter(|row| row.direction == *direction).any(|row| {
            let moves =
                |symbol: &Symbol| matches!(symbol, Symbol::Position(_) | Symbol::Cos(_) | Symbol::Sin(_));
            row.nominal.symbols().iter().any(moves)
        });
        if !driven {
            diagnostics.push(
                Diagnostic::warning("W0202", *span, format!("no axis moves in direction {direction}"))
                    .label("its error is derived but cannot be compensated")
                    .help("remove it from `sensitive` unless you want to know its error"),
            );
        }
    }
}
