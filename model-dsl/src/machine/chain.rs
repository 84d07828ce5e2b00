//! The chain of a machine file: its links, checked against each other.
//!
//! In: `topology` or `chain`. Out: links in order from the bed outwards, the part's branch
//! first, each with the node of its `errors` for [`super::read_motion`] to read.

use super::draft::{Chain, DraftedLink};
use super::fields::{self, Fields, items, place, text};
use super::link::{Branch, Link, LinkKind, Reference};
use super::read_link::read_link;
use super::topology;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};
use crate::yaml::{Node, NodeKind};

/// The most links that a machine may have.
const MOST_LINKS: usize = 48;
/// Reads `topology` or `chain`, exactly one of which must stand.
pub(super) fn read<'n>(
    root: &Node,
    fields: Fields<'n>,
    reference: Reference,
    diagnostics: &mut Diagnostics,
) -> Option<Chain<'n>> {
    let word = fields.entry("topology");
    let chain = fields.entry("chain");
    match (word, chain) {
        (Some((_, node)), None) => {
            let word = text(node, "a topology", diagnostics)?;
            let mut chain = topology::expand(word, node.span, diagnostics)?;
            chain.links.iter_mut().for_each(|drafted| drafted.link.reference = reference);
            Some(chain)
        }
        (None, Some((key, node))) => branches(key, node, reference, diagnostics),
        (Some((word, _)), Some((chain, _))) => {
            diagnostics.push(
                Diagnostic::error("E0109", chain.span, "a machine has a `topology` or a `chain`, not both")
                    .label("the chain is written out here")
                    .also(word.span, "and a word gives it here")
                    .help("remove one of them"),
            );
            None
        }
        (None, None) => {
            diagnostics.push(
                Diagnostic::error("E0109", place(root), "a machine needs a `topology` or a `chain`")
                    .label("this file has neither")
                    .help("write `topology: XYFZ`, or write out the chain link by link"),
            );
            None
        }
    }
}

fn branches<'n>(
    key: &Spanned<String>,
    node: &'n Node,
    reference: Reference,
    diagnostics: &mut Diagnostics,
) -> Option<Chain<'n>> {
    let fields = fields::open(node, "a chain", &["workpiece", "tool"], diagnostics)?;
    let mut links = Vec::new();
    for (name, branch) in [("workpiece", Branch::Workpiece), ("tool", Branch::Tool)] {
        let Some(list) = fields.get(name) else { continue };
        if matches!(list.kind, NodeKind::Null) {
            continue;
        }
        for item in items(list, "a branch of the chain", diagnostics).unwrap_or_default() {
            links.extend(read_link(item, branch, reference, diagnostics));
        }
    }
    whole(key.span, &links, diagnostics);
    Some(Chain { topology: None, links })
}

/// Checks that hold of the chain as a whole.
fn whole(span: Span, links: &[DraftedLink<'_>], diagnostics: &mut Diagnostics) {
    if links.len() > MOST_LINKS {
        let message = format!("the chain has {} links, more than {MOST_LINKS}", links.len());
        diagnostics.push(
            Diagnostic::error("E0115", span, message)
                .label("this chain")
                .help("combine links that do not move relative to each other into one offset"),
        );
    }
    if !links.iter().any(|drafted| drafted.link.is_axis()) && !diagnostics.has_errors() {
        diagnostics.push(
            Diagnostic::error("E0116", span, "no link of the chain moves")
                .label("this chain")
                .help("add a `slide` or a `rotary`"),
        );
    }
    let tools = links.iter().filter(|drafted| drafted.link.kind == LinkKind::Tool).count();
    if tools == 0 && !diagnostics.has_errors() {
        diagnostics.push(
            Diagnostic::error("E0125", span, "the chain has no tool")
                .label("the tool branch must end in a tool")
                .help("end it with `- tool: tip` and its `offset`"),
        );
    }
    distinct(links, diagnostics);
    ends(links, diagnostics);
}

fn distinct(links: &[DraftedLink<'_>], diagnostics: &mut Diagnostics) {
    for (at, drafted) in links.iter().enumerate() {
        let link = &drafted.link;
        let mut earlier = links.iter().take(at).map(|earlier| &earlier.link);
        if let Some(first) =
            earlier.clone().find(|first| link.is_axis() && first.kind.letter() == link.kind.letter())
        {
            let letter = link.kind.letter().unwrap_or_default();
            let help = match link.kind {
                LinkKind::Rotary(_) => {
                    "a machine has one rotary axis about each of X, Y and Z: A, B, C; for arms of six axes see \"what a machine file \
                     cannot say\" in docs/reference/machine-file.md"
                }
                _ => "name a second slide in the same direction U, V or W",
            };
            diagnostics.push(
                Diagnostic::error("E0123", link.span, format!("axis {letter} occurs twice in the chain"))
                    .label("again here")
                    .also(first.span, "first here")
                    .help(help),
            );
        } else if let Some(first) = earlier.find(|first| first.id == link.id) {
            diagnostics.push(
                Diagnostic::error("E0124", link.span, format!("two links are called `{}`", link.id))
                    .label("again here")
                    .also(first.span, "first here")
                    .help("give one of them another `id`"),
            );
        }
    }
}

/// The tool ends the tool's branch and the part ends the part's.
fn ends(links: &[DraftedLink<'_>], diagnostics: &mut Diagnostics) {
    for (kind, branch) in [(LinkKind::Tool, Branch::Tool), (LinkKind::Part, Branch::Workpiece)] {
        let last = links.iter().rposition(|drafted| drafted.link.branch == branch);
        for (at, drafted) in links.iter().enumerate().filter(|(_, drafted)| drafted.link.kind == kind) {
            if Some(at) != last {
                let again = last.and_then(|last| links.get(last)).is_some_and(|last| last.link.kind == kind);
                diagnostics.push(misplaced(&drafted.link, branch, again));
            }
        }
    }
}

/// A tool or part that stands on the other branch, or not at the end of its own; `again` where one stands at that end besides.
fn misplaced(link: &Link, branch: Branch, again: bool) -> Diagnostic {
    let word = link.kind.word();
    let own = if branch == Branch::Tool { "tool" } else { "workpiece" };
    if again && link.kind == LinkKind::Tool {
        let mistake =
            Diagnostic::error("E0126", link.span, "the chain has a second tool").label("not the last link");
        return mistake.help("keep one tool; list exchangeable tools under `tools:` in the calibration");
    }
    let message = if link.branch == branch {
        format!("the {word} is not at the end of its branch")
    } else {
        format!("the {word} is on the wrong branch")
    };
    Diagnostic::error("E0126", link.span, message)
        .label("not here")
        .help(format!("move it to the end of `{own}:`"))
}
