//! Two motors of one beam. In: the `drives` of a slide, each with its place along the beam. Out: both motors: their errors displace the
//! slide at its reference point and turn it, as the lever says.
//!
//! At the place r along the beam the slide goes `e(r) = e1 + (e2 - e1) (r - r1) / (r2 - r1)`. At r = 0, the origin of the carriage, that is
//! a positioning error; its slope is a rotation.

use super::super::draft::Chain;
use super::super::fields::{self, text};
use super::super::link::{Along, Reference};
use super::super::words::exact_length;
use super::{Beam, Motor, Moved, signed};
use crate::algebra::{Axis, Rational};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::machine::MotionKind;
use crate::source::Spanned;
use crate::yaml::Node;

/// The motors of all beams; a slide that `crossed` motors move already has none.
pub(super) fn read(chain: &Chain<'_>, crossed: &[Motor], diagnostics: &mut Diagnostics) -> Vec<Motor> {
    let mut motors = Vec::new();
    for (number, drafted) in chain.links.iter().enumerate() {
        let Some((key, node)) = drafted.drives else { continue };
        let follows = |motor: &Motor| motor.follows.iter().any(|(link, _)| *link == number);
        if let Some(motor) = crossed.iter().find(|motor| follows(motor)) {
            let message = format!("slide {} has its motors in two places", drafted.link.id);
            diagnostics.push(
                Diagnostic::error("E0150", key.span, message)
                    .label("as the motors of a beam here")
                    .also(motor.name.span, "and as a motor of `transmission` here")
                    .help("remove one of them"),
            );
        } else if drafted.link.reference == Reference::Bed {
            diagnostics.push(
                Diagnostic::error("E0150", key.span, "the motors of a beam move with its carriage")
                    .label("`reference: bed` makes it rotate about a fixed point")
                    .help("write `reference: carriage` for this slide"),
            );
        } else {
            motors.extend(of_slide(number, node, chain, diagnostics).into_iter().flatten());
        }
    }
    motors
}

/// A motor while it is being read: its name, the direction along the beam and the place there.
type Placed = (Spanned<String>, Axis, Rational);

fn of_slide(
    number: usize,
    node: &Node,
    chain: &Chain<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<[Motor; 2]> {
    let link = &chain.links.get(number)?.link;
    let wrong = |message: String, label: &str| {
        Diagnostic::error("E0150", node.span, message)
            .label(label)
            .help("write two motors with their places along the beam: `drives: {Y1: {x: -400 mm}, Y2: {x: 400 mm}}`")
    };
    let Some(entries) = node.entries() else {
        let message = format!("`drives` must be a mapping of motors, found {}", node.kind_name());
        diagnostics.push(wrong(message, "not a mapping"));
        return None;
    };
    let placed: Vec<Placed> =
        entries.iter().filter_map(|(name, value)| placed(name, value, link.along, diagnostics)).collect();
    if placed.len() != entries.len() {
        return None;
    }
    let Ok([first, second]) = <[Placed; 2]>::try_from(placed) else {
        let message = format!("slide {} has {} drives", link.id, entries.len());
        diagnostics.push(wrong(message, "exactly two motors determine the position and the angle of a beam"));
        return None;
    };
    if first.1 != second.1 || first.2 == second.2 {
        let message = format!("the drives of slide {} are not along a beam", link.id);
        diagnostics.push(wrong(message, "they need two places in one direction"));
        return None;
    }
    Some(motors(number, [first, second], link.along, link.corrects))
}

fn placed(
    name: &Spanned<String>,
    node: &Node,
    along: Along,
    diagnostics: &mut Diagnostics,
) -> Option<Placed> {
    let what = format!("drive {}", name.value);
    let across: Vec<Axis> = Axis::ALL.into_iter().filter(|axis| *axis != along.axis).collect();
    let keys: Vec<String> =
        across.iter().map(|axis| axis.letter().to_ascii_lowercase().to_string()).collect();
    let known: Vec<&str> = keys.iter().map(String::as_str).collect();
    let fields = fields::open(node, &what, &known, diagnostics)?;
    let mut given =
        across.into_iter().zip(&known).filter_map(|(axis, key)| fields.get(key).map(|node| (axis, node)));
    let (Some((axis, place)), None) = (given.next(), given.next()) else {
        diagnostics.push(
            Diagnostic::error("E0150", name.span, format!("{what} needs a place along its beam"))
                .label(format!("`{}` in the frame of the slide", known.join("` or `")))
                .help(format!("write `{}: {{{}: -400 mm}}`", name.value, known.first().unwrap_or(&"x"))),
        );
        return None;
    };
    let written = text(place, "a place", diagnostics)?;
    let Some(length) = exact_length(written) else {
        diagnostics.push(
            Diagnostic::error("E0150", place.span, format!("`{written}` is not a valid place of a drive"))
                .label("not a length")
                .help("write a number with its unit, such as `-400 mm`; a constant is not allowed, because lever arms are divided by the span"),
        );
        return None;
    };
    Some((name.clone(), axis, length))
}

/// Both motors; a rotation about `beam x along` moves a place r along the beam by r along the slide.
fn motors(link: usize, [first, second]: [Placed; 2], along: Along, corrects: bool) -> [Motor; 2] {
    let across = first.1;
    let (about, side) =
        if along.axis == across.next() { (along.axis.next(), 1) } else { (across.next(), -1) };
    let span = &second.2 - &first.2;
    let motor = |own: &Placed, other: &Placed, end: i64| {
        let displaced = signed(end * along.sign) * &other.2 / &span;
        let turned = signed(-end * along.sign * side) / &span;
        let moved = |kind, weight| Moved { link, kind, weight };
        Motor {
            name: own.0.clone(),
            follows: vec![(link, signed(1))],
            moves: vec![
                moved(MotionKind::Linear(along.axis), displaced),
                moved(MotionKind::Angular(about), turned),
            ],
            beam: Some(Beam { about, arm: signed(along.sign * side) * &own.2, corrects }),
        }
    };
    [motor(&first, &second, 1), motor(&second, &first, -1)]
}
