//! What an error motion is, in words. In: a motion and its link, or its name alone. Out: a line for people.

use crate::algebra::Polynomial;
use crate::machine::{
    Along, Branch, Link, LinkKind, Motion, MotionKind, Reference, Turned, kind_of, own_direction, parse_name,
};
use crate::source::Span;

/// An error motion of an axis, as its name alone tells it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NamedMotion {
    /// The name as Abbe prints it: `EA0C` for `AOC` and `EA(0Y)C`.
    pub name: String,
    /// What it is, in words.
    pub meaning: String,
    /// What it does to its link.
    pub kind: MotionKind,
    /// The letter of the axis.
    pub axis: char,
    /// Whether the axis turns.
    pub rotary: bool,
    /// The axis from which the name counts it.
    pub counted_from: Option<String>,
}

/// An error motion by its name, of an axis with a letter of ISO 841 and no other id; none for a name that is not one. The place of
/// a slide is none: that is its origin.
pub fn named(name: &str) -> Option<NamedMotion> {
    let axis = name.chars().last().filter(|letter| "XYZUVWABC".contains(*letter))?;
    let rotary = "ABC".contains(axis);
    let parsed = parse_name(name, &axis.to_string())?;
    let kind = kind_of(&parsed)?;
    if matches!(kind, MotionKind::Offset(_)) && !rotary {
        return None;
    }
    let link = Link {
        id: axis.to_string(),
        kind: if rotary { LinkKind::Rotary(axis) } else { LinkKind::Slide(axis) },
        branch: Branch::Tool,
        along: Along { axis: own_direction(axis), sign: 1 },
        origin: std::array::from_fn(|_| Polynomial::zero()),
        turned: Turned::default(),
        reference: Reference::Carriage,
        corrects: true,
        span: Span::default(),
    };
    let motion = Motion::plain(0, &link, kind, None);
    let meaning = of(&motion, &link);
    Some(NamedMotion { name: motion.name, meaning, kind, axis, rotary, counted_from: parsed.counted_from })
}

/// A short description: "positioning error of X", "squareness: Y turned about Z".
pub(super) fn of(motion: &Motion, link: &Link) -> String {
    let id = &link.id;
    let along = link.along.axis;
    let slide = matches!(link.kind, LinkKind::Slide(_));
    let rotary = matches!(link.kind, LinkKind::Rotary(_));
    match motion.kind {
        MotionKind::Linear(axis) if slide && axis == along => format!("positioning error of {id}"),
        MotionKind::Linear(axis) if slide => format!("straightness error of {id} in {axis}"),
        MotionKind::Angular(axis) if slide && axis == along => format!("roll of {id}"),
        MotionKind::Angular(axis) if slide => format!("rotation of {id} about {axis} (pitch or yaw)"),
        MotionKind::Linear(axis) if rotary && axis == along => format!("axial error motion of {id}"),
        MotionKind::Linear(axis) if rotary => format!("radial error motion of {id} in {axis}"),
        MotionKind::Angular(axis) if rotary && axis == along => format!("angular positioning error of {id}"),
        MotionKind::Angular(axis) => format!("tilt of {id} about {axis}"),
        MotionKind::Linear(axis) => format!("displacement of {id} in {axis}"),
        MotionKind::Offset(axis) => format!("place of the axis of {id} in {axis}"),
        MotionKind::Alignment(axis) if slide => {
            format!("alignment: line of motion of {id} turned about {axis}")
        }
        MotionKind::Alignment(axis) if rotary && axis == along => format!("zero position of {id}"),
        MotionKind::Alignment(axis) => format!("tilt of the axis of {id} about {axis}"),
    }
}
