//! What an error motion is, in words. In: a motion and its link. Out: a line for people.

use crate::machine::{Link, LinkKind, Motion, MotionKind};

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
        MotionKind::Alignment(axis) if rotary && axis == along => format!("zero of {id}"),
        MotionKind::Alignment(axis) => format!("tilt of the axis of {id} about {axis}"),
    }
}
