//! The error budget of a machine by a word. In: the word and the chain. Out: which of the usual error motions stay.
//!
//! `eight` keeps the location errors that are left of a five-axis machine when the part and the tool are set up: the squarenesses of three
//! slides, two tilts of each rotary axis, and how far their axes pass each other. Every other location error moves the tip as these do
//! together with another place of the part (three lengths, three angles) or of the tool tip (three lengths).

use super::draft::{Chain, DraftedLink};
use super::fields::choice;
use super::link::{Branch, Link, LinkKind};
use super::motion::{Motion, MotionKind};
use crate::algebra::Axis;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};
use crate::yaml::Node;

/// Which error motions a machine has where its links do not list them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Budget {
    /// All of each link, and the alignment errors that are independent.
    Full,
    /// The eight location errors of a five-axis machine.
    Eight,
}

/// Reads the word of a machine file.
pub(super) fn read(node: &Node, diagnostics: &mut Diagnostics) -> Spanned<Budget> {
    let budget = match choice(node, "an error budget", &["full", "eight"], diagnostics) {
        Some("eight") => Budget::Eight,
        _ => Budget::Full,
    };
    Spanned::new(budget, node.span)
}

/// What a budget leaves of the usual error motions of a chain. A chain that it does not fit is reported.
pub(super) fn kept(
    budget: Spanned<Budget>,
    chain: &Chain<'_>,
    motions: Vec<Motion>,
    diagnostics: &mut Diagnostics,
) -> Vec<Motion> {
    if budget.value == Budget::Full {
        return motions;
    }
    let links: Vec<&Link> = chain.links.iter().map(|drafted| &drafted.link).collect();
    match rotary_axes(&links) {
        Ok([first, second]) => {
            listed(budget.span, &chain.links, diagnostics);
            let passing = passing(&links, first, second);
            motions.into_iter().filter(|motion| is_kept(&links, motion, passing)).collect()
        }
        Err(reason) => {
            diagnostics.push(does_not_fit(budget.span, &reason));
            motions
        }
    }
}

fn does_not_fit(span: Span, reason: &str) -> Diagnostic {
    Diagnostic::error("E0147", span, "the machine does not fit the error budget `eight`")
        .label(reason)
        .help("write `budget: full`, or list the `errors` of each link")
}

/// The numbers of the two rotary axes, of a chain with three slides square to each other; or why it is another one.
fn rotary_axes(links: &[&Link]) -> Result<[usize; 2], String> {
    let directions = |rotary: bool| -> Vec<Axis> {
        let axes = links.iter().filter(|link| link.is_axis());
        let mut found: Vec<Axis> = axes
            .filter(|link| matches!(link.kind, LinkKind::Rotary(_)) == rotary)
            .map(|link| link.along.axis)
            .collect();
        found.sort_unstable();
        found
    };
    if let Some(link) = links.iter().find(|link| !link.turned.is_none()) {
        let leans = if link.turns_back() { "leans" } else { "is turned" };
        return Err(format!("its axes run along X, Y and Z, and {} {leans}", link.id));
    }
    let slides = directions(false);
    if slides != Axis::ALL {
        return Err(format!("it is for three slides X, Y, Z, but the chain has {}", slides.len()));
    }
    let is_rotary = |link: &Link| matches!(link.kind, LinkKind::Rotary(_));
    let rotary = |(_, link): &(usize, &&Link)| is_rotary(link);
    let numbers: Vec<usize> = links.iter().enumerate().filter(rotary).map(|(number, _)| number).collect();
    let carried = links.iter().enumerate().find_map(|(number, link)| {
        let below = links.iter().take(number).rfind(|below| is_rotary(below) && below.branch == link.branch);
        below.filter(|_| matches!(link.kind, LinkKind::Slide(_))).map(|below| (&link.id, &below.id))
    });
    if let Some((slide, below)) = carried {
        return Err(format!("it is for rotary axes on the slides, but slide {slide} is carried by {below}"));
    }
    <[usize; 2]>::try_from(numbers)
        .map_err(|numbers| format!("it is for two rotary axes, but the chain has {}", numbers.len()))
}

/// A link that lists its errors says something else than the budget.
fn listed(span: Span, links: &[DraftedLink<'_>], diagnostics: &mut Diagnostics) {
    for (drafted, errors) in links.iter().filter_map(|drafted| drafted.errors.map(|errors| (drafted, errors)))
    {
        diagnostics.push(
            Diagnostic::error(
                "E0147",
                errors.span,
                format!("link {} has its own list of errors", drafted.link.id),
            )
            .label("this list")
            .also(span, "and the budget of the whole machine is here")
            .help("remove one of them"),
        );
    }
}

/// How far the axes pass each other, along the direction across both: an offset of the one that stands on the other, and of two on
/// different branches that of the part's.
fn passing(links: &[&Link], first: usize, second: usize) -> Option<(usize, MotionKind)> {
    let (one, other) = (links.get(first)?, links.get(second)?);
    let across = Axis::ALL.into_iter().find(|axis| *axis != one.along.axis && *axis != other.along.axis)?;
    let number = if one.branch == other.branch || other.branch == Branch::Workpiece { second } else { first };
    Some((number, MotionKind::Offset(across)))
}

/// Squarenesses, tilts of rotary axes without their zeros, and how far these pass each other.
fn is_kept(links: &[&Link], motion: &Motion, passing: Option<(usize, MotionKind)>) -> bool {
    let Some(link) = links.get(motion.link) else { return false };
    match motion.kind {
        MotionKind::Alignment(axis) => link.is_axis() && axis != link.along.axis,
        kind => passing == Some((motion.link, kind)),
    }
}

#[cfg(test)]
mod tests;
