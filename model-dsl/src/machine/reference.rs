//! The axis from which an alignment error is counted. In: the links of a machine and its alignment errors. Out: for each of them what the
//! same error is called when ISO 230-1 counts it from another axis, `EA(0Y)C`, said in the machine's own names.
//!
//! An alignment error of Abbe is that of its link against the frame before it. `EA(0Y)C` is that of C against the line of Y: both are the
//! same where nothing else turns one of them about X, and differ by what does, such as `EA0C - EA0Z` for `EA(0Z)C`. Rotary axes
//! stand at zero.

use super::link::{Link, LinkKind};
use super::motion::{Motion, MotionKind, body_sign};
use super::turned::Turned;

/// An error motion as far as it places or turns what stands on its link for good.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'m> {
    /// Its name in ISO 230-1.
    pub(crate) name: &'m str,
    /// The number of its link.
    pub(crate) link: usize,
    /// What it does to the link.
    pub(crate) kind: MotionKind,
    /// Whether that of a slide turns the carriage too.
    pub(crate) rotates: bool,
    /// +1 or -1: the sign with which its value moves its body in bed directions.
    pub(crate) sign: i64,
}

/// What an alignment error is when it is counted from another axis.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Counted {
    /// The id of the other axis.
    pub from: String,
    /// The same in names of the machine: `EA0C`, or `EA0C - EA0Z`.
    pub is: String,
}

/// The error motions of a machine as they place its links.
pub(crate) fn placed<'m>(links: &[Link], motions: &'m [Motion], relative: bool) -> Vec<Placed<'m>> {
    let one = |motion: &'m Motion| {
        let sign = links.get(motion.link).map_or(1, |link| body_sign(motion, link, relative));
        Placed { name: &motion.name, link: motion.link, kind: motion.kind, rotates: motion.rotates, sign }
    };
    motions.iter().map(one).collect()
}

/// What an alignment error is, counted from each axis that shows it; none for any other error motion.
pub(crate) fn counted(links: &[Link], placed: &[Placed<'_>], motion: &Placed<'_>) -> Vec<Counted> {
    let others = links.iter().enumerate().filter(|(number, _)| *number != motion.link);
    let others = others.filter(|(number, _)| are_parallel(links, motion.link, *number));
    let from = |(number, link): (usize, &Link)| {
        let parts = match motion.kind {
            MotionKind::Alignment(_) => turned_between(links, placed, motion, number)?,
            MotionKind::Offset(_) => moved_between(links, placed, motion, number)?,
            _ => return None,
        };
        Some(Counted { from: link.id.clone(), is: sum(&parts, motion) })
    };
    others.filter_map(from).collect()
}

/// Whether all that two links stand on has its error motions in the same directions, with rotary axes at zero. Where a body is turned for
/// good, or an axis leans, what is about X here is about something else there, and no name of ISO 230-1 counts from one to the other.
fn are_parallel(links: &[Link], one: usize, other: usize) -> bool {
    let carrying = |number: &usize| stands_on(links, one, *number) || stands_on(links, other, *number);
    let mut attitudes = (0..links.len()).filter(carrying).map(|number| attitude(links, number));
    let first = attitudes.next();
    attitudes.all(|attitude| Some(attitude) == first)
}

/// By what the frame in which a link moves is turned against the bed, with rotary axes at zero.
fn attitude(links: &[Link], number: usize) -> Vec<&Turned> {
    let before =
        |(at, link): &(usize, &Link)| *at == number || stands_on(links, number, *at) && !link.turns_back();
    let turned = links.iter().enumerate().filter(before).map(|(_, link)| &link.turned);
    turned.filter(|turned| !turned.is_none()).collect()
}

/// What turns a link about a direction, and what turns another: the difference, each with its sign. None where the other one's
/// line does not show a turn about that direction, or is turned along with the link, since it stands on it.
fn turned_between<'m>(
    links: &[Link],
    placed: &[Placed<'m>],
    motion: &Placed<'_>,
    other: usize,
) -> Option<Vec<(&'m str, i64)>> {
    let link = links.get(other)?;
    let has_line = link.is_axis() || link.kind == LinkKind::Spindle;
    let own = turning(links, placed, motion.kind, motion.link);
    let others = turning(links, placed, motion.kind, other);
    let carried = others.iter().any(|(name, _)| *name == motion.name);
    let shows = has_line && !carried && link.along.axis != motion.kind.axis();
    shows.then(|| {
        let left = own.iter().filter(|part| !others.contains(part)).copied();
        let right = others.iter().filter(|part| !own.contains(part)).map(|(name, sign)| (*name, -sign));
        left.chain(right).collect()
    })
}

/// The error motions that turn the line or the axis of a link about a direction for good, with the sign of each.
fn turning<'m>(
    links: &[Link],
    placed: &[Placed<'m>],
    kind: MotionKind,
    number: usize,
) -> Vec<(&'m str, i64)> {
    let about = kind.axis();
    let turns = |part: &&Placed<'_>| match part.kind {
        MotionKind::Alignment(axis) => axis == about && (part.link == number || carries(links, part)),
        MotionKind::Angular(axis) => axis == about && rests(links, part.link),
        _ => false,
    };
    let before = |part: &&Placed<'_>| stands_on(links, number, part.link);
    placed.iter().filter(turns).filter(before).map(|part| (part.name, part.sign)).collect()
}

/// Whether an alignment error turns what stands on its link.
fn carries(links: &[Link], part: &Placed<'_>) -> bool {
    part.rotates || !links.get(part.link).is_some_and(|link| matches!(link.kind, LinkKind::Slide(_)))
}

/// Whether a link does not move, so that its error motions are alignments as well.
fn rests(links: &[Link], number: usize) -> bool {
    links.get(number).is_some_and(|link| matches!(link.kind, LinkKind::Fixed))
}

/// Whether a link is another one, or stands on it.
fn stands_on(links: &[Link], number: usize, other: usize) -> bool {
    let branch = |number: usize| links.get(number).map(|link| link.branch);
    other <= number && branch(number) == branch(other)
}

/// What displaces the axis of a link along a direction against that of a link on which it stands. None where that other one has no
/// axis across the direction, or where something between both turns: then lever arms come in.
fn moved_between<'m>(
    links: &[Link],
    placed: &[Placed<'m>],
    motion: &Placed<'_>,
    other: usize,
) -> Option<Vec<(&'m str, i64)>> {
    let link = links.get(other)?;
    let has_place = matches!(link.kind, LinkKind::Rotary(_) | LinkKind::Spindle);
    let across = link.along.axis != motion.kind.axis();
    let between = |part: &&Placed<'_>| part.link > other && stands_on(links, motion.link, part.link);
    let plain = |part: &Placed<'_>| match part.kind {
        MotionKind::Alignment(_) => part.link == motion.link || !carries(links, part),
        MotionKind::Angular(_) | MotionKind::Linear(_) => !rests(links, part.link),
        MotionKind::Offset(_) => true,
    };
    let fits = has_place && across && stands_on(links, motion.link, other);
    (fits && placed.iter().filter(between).all(plain)).then(|| {
        let moving = placed.iter().filter(between).filter(|part| part.kind == motion.kind);
        moving.map(|part| (part.name, part.sign)).collect()
    })
}

/// A sum of error motions, in the sense of the first.
fn sum(parts: &[(&str, i64)], motion: &Placed<'_>) -> String {
    let mut text = motion.name.to_owned();
    for (name, sign) in parts.iter().filter(|(name, _)| *name != motion.name) {
        text.push_str(if *sign == motion.sign { " + " } else { " - " });
        text.push_str(name);
    }
    text
}

/// Why a name that counts from another axis does not stand for the alignment error without that axis: a sentence; none where it does.
pub(crate) fn difference(name: &str, plain: &str, from: &str, counted: &[Counted]) -> Option<String> {
    match counted.iter().find(|one| one.from == from) {
        Some(one) if one.is == plain => None,
        Some(one) => Some(format!("counted from {from}, {name} is {}", one.is)),
        None => Some(format!("{plain} cannot be counted from {from}")),
    }
}

#[cfg(test)]
mod tests;
