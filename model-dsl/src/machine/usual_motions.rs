//! The error motions that a link has where the file does not list them.

use super::draft::Chain;
use super::link::{Link, LinkKind};
use super::motion::{Motion, MotionKind};
use crate::algebra::Axis;

/// The usual error motions of a link: six for an axis, five for a spindle (its own angle is
/// free), none for a body at rest; and the alignment errors that the topology makes independent.
pub(super) fn usual(number: usize, chain: &Chain<'_>) -> Vec<Motion> {
    let Some(drafted) = chain.links.get(number) else { return Vec::new() };
    let link = &drafted.link;
    let mut kinds: Vec<MotionKind> = Vec::new();
    if link.is_axis() || link.kind == LinkKind::Spindle {
        kinds.extend(Axis::ALL.map(MotionKind::Linear));
        let free = (link.kind == LinkKind::Spindle).then_some(link.along.axis);
        kinds.extend(Axis::ALL.into_iter().filter(|axis| Some(*axis) != free).map(MotionKind::Angular));
    }
    kinds.extend(independent_alignments(link, chain));
    kinds.into_iter().map(|kind| Motion::plain(number, link, kind, None)).collect()
}

/// The alignment errors of one axis against those that come before it in the order X Y Z U V W A B C.
///
/// The first slide fixes one direction of the frame and is aligned by definition; the second
/// fixes the rest but for one angle; every further slide has the two angles across its ways.
/// A rotary axis has two tilts, two offsets and a zero, unless it stands alone.
fn independent_alignments(link: &Link, chain: &Chain<'_>) -> Vec<MotionKind> {
    let before: Vec<&Link> = chain
        .links
        .iter()
        .map(|drafted| &drafted.link)
        .filter(|other| other.is_axis() && other.kind.axis_rank() < link.kind.axis_rank())
        .collect();
    let across = Axis::ALL.into_iter().filter(|axis| *axis != link.along.axis);
    match link.kind {
        LinkKind::Slide(_) => {
            let mut datums: Vec<Axis> = before.iter().map(|other| other.along.axis).collect();
            datums.sort_unstable();
            datums.dedup();
            match datums.as_slice() {
                [] => Vec::new(),
                [datum] if *datum != link.along.axis => {
                    across.filter(|axis| axis != datum).map(MotionKind::Alignment).collect()
                }
                _ => across.map(MotionKind::Alignment).collect(),
            }
        }
        LinkKind::Rotary(_) if !before.is_empty() => across
            .clone()
            .map(MotionKind::Offset)
            .chain(across.map(MotionKind::Alignment))
            .chain([MotionKind::Alignment(link.along.axis)])
            .collect(),
        _ => Vec::new(),
    }
}
