//! One link as a homogeneous transformation from the frame before it to its own.
//!
//! A slide is its origin, its travel and its small errors; the errors act at the origin that
//! travels (`reference: carriage`) or at the one that stays (`bed`). A rotary axis is its
//! origin, its errors in the directions of the frame before it, then its large rotation. The axis of one that leans
//! stands in a frame that constant angles turn, errors included, and these are turned back behind it; a fixed link
//! that is turned leaves everything that stands on it so.

use crate::algebra::{Axis, FirstOrder, Htm, Polynomial, Rational, Symbol};
use crate::machine::{Link, LinkKind, Machine, Motion, MotionKind, Reference, body_sign};

/// The matrix of a link, by its number in [`Machine::links`]; the errors are numbered as in [`Machine::motions`].
pub fn matrix(machine: &Machine, number: usize) -> Htm {
    let Some(link) = machine.links.get(number) else { return Htm::identity() };
    let own: Vec<(usize, &Motion)> = machine
        .motions
        .iter()
        .enumerate()
        .filter(|(_, motion)| motion.link == number && motion.motor.is_none())
        .collect();
    let place = Htm::translation(link.origin.clone().map(FirstOrder::nominal));
    let origin = link.turned.rotations().fold(place, |frame, (axis, degrees)| turned(&frame, axis, degrees));
    let (aligned, displaced): (Vec<_>, Vec<_>) =
        own.into_iter().partition(|(_, motion)| motion.kind.alignment());
    let displaced = by_motors(machine, number).then(&small(machine, link, displaced.into_iter()));
    let aligned = alignment(machine, link, aligned);
    match (link.kind, link.reference) {
        (LinkKind::Rotary(_), _) => {
            let turn = Htm::rotation(link.along.axis, &link.variable(), link.along.sign);
            let body = origin.then(&aligned).then(&displaced).then(&turn);
            link.turned.back().fold(body, |frame, (axis, degrees)| turned(&frame, axis, &degrees))
        }
        (LinkKind::Slide(_), Reference::Carriage) => {
            origin.then(&travel(link)).then(&aligned).then(&displaced)
        }
        (LinkKind::Slide(_), Reference::Bed) => origin.then(&displaced).then(&travel(link)).then(&aligned),
        _ => origin.then(&aligned).then(&displaced),
    }
}

/// A frame that goes on by a constant angle.
fn turned(frame: &Htm, axis: Axis, degrees: &Rational) -> Htm {
    frame.then(&Htm::fixed_rotation(axis, degrees))
}

/// The programmed travel of a slide.
fn travel(link: &Link) -> Htm {
    let position = Polynomial::symbol(Symbol::Position(link.variable()));
    let signed = &position * &Polynomial::integer(link.along.sign);
    let mut translation = <[FirstOrder; 3]>::default();
    translation[link.along.axis.index()] = FirstOrder::nominal(signed);
    Htm::translation(translation)
}

/// The small displacement by the error motions of a body.
fn small<'m>(machine: &Machine, link: &Link, motions: impl Iterator<Item = (usize, &'m Motion)>) -> Htm {
    let mut rotations = <[FirstOrder; 3]>::default();
    let mut translations = <[FirstOrder; 3]>::default();
    for (number, motion) in motions {
        let sign = Polynomial::integer(body_sign(motion, link, machine.relative));
        let error = FirstOrder::error(number, sign);
        let slots = if motion.kind.angular() { &mut rotations } else { &mut translations };
        let slot = &mut slots[motion.kind.axis().index()];
        *slot = &*slot + &error;
    }
    Htm::small(rotations, translations)
}

/// The small displacement of a link by the errors of motors.
fn by_motors(machine: &Machine, link: usize) -> Htm {
    let mut rotations = <[FirstOrder; 3]>::default();
    let mut translations = <[FirstOrder; 3]>::default();
    for (number, motion) in machine.motions.iter().enumerate() {
        let motor = motion.motor.and_then(|motor| machine.motors.get(motor));
        for moved in motor.iter().flat_map(|motor| &motor.moves).filter(|moved| moved.link == link) {
            let error = FirstOrder::error(number, Polynomial::number(moved.weight.clone()));
            let slots = if moved.kind.angular() { &mut rotations } else { &mut translations };
            let slot = &mut slots[moved.kind.axis().index()];
            *slot = &*slot + &error;
        }
    }
    Htm::small(rotations, translations)
}

/// The small displacement by the alignment errors of an axis. The line of motion of a slide is
/// turned, `angle x (direction * travel)`, and the carriage with it only where `rotates` says so;
/// a rotary axis or a spindle is displaced and tilted as a whole.
fn alignment(machine: &Machine, link: &Link, motions: Vec<(usize, &Motion)>) -> Htm {
    let (lines, bodies): (Vec<_>, Vec<_>) = motions.into_iter().partition(|(_, motion)| {
        matches!((link.kind, motion.kind), (LinkKind::Slide(_), MotionKind::Alignment(_)))
    });
    let turned = lines.iter().filter(|(_, motion)| motion.rotates).copied();
    let body = small(machine, link, bodies.into_iter().chain(turned));
    let mut translations = <[FirstOrder; 3]>::default();
    for (number, motion) in lines {
        let along = link.along.axis;
        let about = motion.kind.axis();
        let Some((direction, side)) = cross(about, along) else { continue };
        let travel = match &motion.travel {
            Some(travel) => Symbol::Travel(travel.value.clone()),
            None => Symbol::Position(link.variable()),
        };
        let sign = side * link.along.sign * body_sign(motion, link, machine.relative);
        let arm = &Polynomial::symbol(travel) * &Polynomial::integer(sign);
        let slot = &mut translations[direction.index()];
        *slot = &*slot + &FirstOrder::error(number, arm);
    }
    Htm::translation(translations).then(&body)
}

/// The cross product of two directions: a direction and a sign, or nothing where they are the same.
fn cross(left: Axis, right: Axis) -> Option<(Axis, i64)> {
    if left == right {
        None
    } else if right == left.next() {
        Some((right.next(), 1))
    } else {
        Some((left.next(), -1))
    }
}
