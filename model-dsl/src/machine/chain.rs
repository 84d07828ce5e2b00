//! The chain of a machine file: links as written, checked one by one and against each other.
//!
//! In: `topology` or `chain`. Out: links in order from the bed outwards, the part's branch
//! first, each with the node of its `errors` for [`super::motion`] to read.

use super::constants::{exact_length, is_name};
use super::fields::{Fields, items, text};
use super::header::reference;
use super::link::{Along, Branch, Link, LinkKind, Reference};
use super::topology;
use crate::algebra::{Axis, Polynomial, Symbol, to_f64};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::expression;
use crate::source::{Span, Spanned};
use crate::suggest::nearest;
use crate::yaml::{Node, NodeKind};

/// The most links that a machine may have.
const MOST_LINKS: usize = 48;
const KINDS: [&str; 6] = ["slide", "rotary", "spindle", "fixed", "tool", "part"];

/// The links of a machine in order.
pub(super) struct Chain<'n> {
    pub(super) topology: Option<String>,
    pub(super) links: Vec<DraftedLink<'n>>,
}

/// A link, and what is still to be read of it.
pub(super) struct DraftedLink<'n> {
    pub(super) link: Link,
    pub(super) origin_spans: [Span; 3],
    pub(super) errors: Option<&'n Node>,
}

/// Reads `topology` or `chain`, exactly one of which must stand.
pub(super) fn read<'n>(
    fields: &mut Fields<'n>,
    reference: Reference,
    diagnostics: &mut Diagnostics,
) -> Option<Chain<'n>> {
    let word = fields.take_entry("topology");
    let chain = fields.take_entry("chain");
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
                    .label("the chain is spelled out here")
                    .also(word.span, "and given by a word here")
                    .help("take one of them out"),
            );
            None
        }
        (None, None) => {
            diagnostics.push(
                Diagnostic::error("E0109", fields.span(), "a machine needs a `topology` or a `chain`")
                    .label("neither stands in this file")
                    .help("write `topology: XYFZ`, or the chain link by link"),
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
    let mut fields = Fields::open(node, "a chain", diagnostics)?;
    let mut links = Vec::new();
    for (name, branch) in [("workpiece", Branch::Workpiece), ("tool", Branch::Tool)] {
        let Some(list) = fields.take(name) else { continue };
        if matches!(list.kind, NodeKind::Null) {
            continue;
        }
        for item in items(list, "a branch of the chain", diagnostics).unwrap_or_default() {
            links.extend(link(item, branch, reference, diagnostics));
        }
    }
    fields.finish(diagnostics);
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
                .help("join links that do not move against each other into one offset"),
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
    if tools == 0 {
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
            diagnostics.push(
                Diagnostic::error("E0123", link.span, format!("axis {letter} stands twice in the chain"))
                    .label("again here")
                    .also(first.span, "first here")
                    .help("a second slide in the same direction is U, V or W"),
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
                diagnostics.push(misplaced(&drafted.link, branch));
            }
        }
    }
}

/// A tool or part that stands on the other branch, or not at the end of its own.
fn misplaced(link: &Link, branch: Branch) -> Diagnostic {
    let word = link.kind.word();
    let own = if branch == Branch::Tool { "tool" } else { "workpiece" };
    let message = if link.branch == branch {
        format!("the {word} is not at the end of its branch")
    } else {
        format!("the {word} stands on the wrong branch")
    };
    Diagnostic::error("E0126", link.span, message)
        .label("not here")
        .help(format!("move it to the end of `{own}:`"))
}

fn link<'n>(
    node: &'n Node,
    branch: Branch,
    default_reference: Reference,
    diagnostics: &mut Diagnostics,
) -> Option<DraftedLink<'n>> {
    let mut fields = Fields::open(node, "a link", diagnostics)?;
    let (word, name_node) = kind_of(&mut fields, node, diagnostics)?;
    let name = text(name_node, "the name of a link", diagnostics)?;
    let kind = kind(word, name, name_node.span, diagnostics);
    let id = match fields.take("id") {
        Some(id) => text(id, "an id", diagnostics).map(|text| (text, id.span)),
        None => Some((name, name_node.span)),
    };
    let reference = match fields.take("reference") {
        Some(node) => reference(node, diagnostics),
        None => default_reference,
    };
    let along = along(fields.take_entry("along"), kind, name_node.span, diagnostics);
    let (origin, origin_spans) = origin(&mut fields, kind, node.span, diagnostics);
    let errors = fields.take("errors");
    fields.finish(diagnostics);
    let (id, id_span) = id?;
    if !is_name(id) {
        diagnostics.push(
            Diagnostic::error("E0124", id_span, format!("`{id}` cannot name a link"))
                .label("not a name")
                .help("begin with a letter and go on with letters, digits and `_`"),
        );
        return None;
    }
    let link = Link {
        id: id.to_owned(),
        kind: kind?,
        branch,
        along: along?,
        origin,
        reference,
        span: name_node.span,
    };
    Some(DraftedLink { link, origin_spans, errors })
}

fn kind_of<'n>(
    fields: &mut Fields<'n>,
    node: &Node,
    diagnostics: &mut Diagnostics,
) -> Option<(&'static str, &'n Node)> {
    let mut found: Vec<_> = KINDS
        .iter()
        .filter_map(|word| fields.take_entry(word).map(|(key, value)| (*word, key, value)))
        .collect();
    match found.len() {
        0 => {
            let mut error = Diagnostic::error("E0120", node.span, "this link does not say what it is")
                .label(format!("one of {} is missing", KINDS.join(", ")));
            if let NodeKind::Mapping(entries) = &node.kind
                && let Some(word) = entries.iter().find_map(|(key, _)| nearest(&key.value, KINDS))
            {
                error = error.help(format!("did you mean `{word}`?"));
            }
            diagnostics.push(error);
            None
        }
        1 => found.pop().map(|(word, _, value)| (word, value)),
        _ => {
            diagnostics.push(
                Diagnostic::error("E0121", found[1].1.span, "a link is one thing only")
                    .label(format!("`{}` here", found[1].0))
                    .also(found[0].1.span, format!("and `{}` here", found[0].0))
                    .help("give each body a link of its own, behind its own `- `"),
            );
            None
        }
    }
}

fn kind(word: &str, name: &str, span: Span, diagnostics: &mut Diagnostics) -> Option<LinkKind> {
    let (letters, make): (&str, fn(char) -> LinkKind) = match word {
        "slide" => ("XYZUVW", LinkKind::Slide),
        "rotary" => ("ABC", LinkKind::Rotary),
        "spindle" => return Some(LinkKind::Spindle),
        "fixed" => return Some(LinkKind::Fixed),
        "tool" => return Some(LinkKind::Tool),
        _ => return Some(LinkKind::Part),
    };
    let mut characters = name.chars();
    if let (Some(letter), None) = (characters.next(), characters.next())
        && letters.contains(letter)
    {
        return Some(make(letter));
    }
    let list = letters.chars().map(String::from).collect::<Vec<_>>().join(", ");
    let upper = name.to_ascii_uppercase();
    let help = if upper.chars().count() == 1 && letters.contains(&upper) {
        format!("did you mean `{upper}`?")
    } else {
        format!("write one of {list}; another name goes into `id`")
    };
    diagnostics.push(
        Diagnostic::error("E0122", span, format!("`{name}` is not the letter of a `{word}`"))
            .label("this name")
            .help(help),
    );
    None
}

/// The direction that an axis letter names: X for X and U, and for the rotation A about it.
fn own_direction(letter: char) -> Axis {
    match letter {
        'X' | 'U' | 'A' => Axis::X,
        'Y' | 'V' | 'B' => Axis::Y,
        _ => Axis::Z,
    }
}

fn along(
    entry: Option<(&Spanned<String>, &Node)>,
    kind: Option<LinkKind>,
    link_span: Span,
    diagnostics: &mut Diagnostics,
) -> Option<Along> {
    let kind = kind?;
    let Some((key, node)) = entry else {
        if kind.letter().is_some() {
            diagnostics.push(
                Diagnostic::error("E0102", link_span, "an axis needs the key `along`")
                    .label("which way does its frame move when it is programmed to move forward?")
                    .help("write `along: +X`; a table that carries the part runs `-X` for +X"),
            );
            return None;
        }
        return Some(Along { axis: Axis::Z, sign: 1 });
    };
    if matches!(kind, LinkKind::Fixed | LinkKind::Tool | LinkKind::Part) {
        let message = format!("a link of kind `{}` has no direction of motion", kind.word());
        diagnostics.push(
            Diagnostic::error("E0129", key.span, message)
                .label("nothing moves along it")
                .help("take `along` out"),
        );
        return None;
    }
    let along = direction(node, diagnostics)?;
    match kind.letter() {
        Some(letter) if own_direction(letter) != along.axis => {
            let own = own_direction(letter).letter();
            diagnostics.push(
                Diagnostic::error(
                    "E0129",
                    node.span,
                    format!("axis {letter} does not run along {}", along.axis.letter()),
                )
                .label("not its own direction")
                .help(format!(
                    "by ISO 841 it runs along +{own} or -{own}; name the axis after its direction"
                )),
            );
            None
        }
        _ => Some(along),
    }
}

fn direction(node: &Node, diagnostics: &mut Diagnostics) -> Option<Along> {
    if let NodeKind::Sequence(entries) = &node.kind {
        return unit_vector(node, entries, diagnostics);
    }
    let word = text(node, "a direction", diagnostics)?;
    let (sign, letter) = match word.as_bytes() {
        [b'+', letter] | [letter] => (1, *letter as char),
        [b'-', letter] => (-1, *letter as char),
        _ => (0, ' '),
    };
    if sign != 0 && "XYZUVWABC".contains(letter) {
        return Some(Along { axis: own_direction(letter), sign });
    }
    let code = if word.chars().count() > 2 { "E0128" } else { "E0127" };
    diagnostics.push(
        Diagnostic::error(code, node.span, format!("`{word}` is not a direction"))
            .label("a direction is a sign and a letter")
            .help("write `+X`, `-X`, `+Y`, `-Y`, `+Z` or `-Z`; skew ways are given as alignment errors"),
    );
    None
}

fn unit_vector(node: &Node, entries: &[Node], diagnostics: &mut Diagnostics) -> Option<Along> {
    let numbers: Option<Vec<f64>> = entries.iter().map(number).collect();
    let numbers = numbers.filter(|numbers| numbers.len() == 3);
    let Some(numbers) = numbers else {
        diagnostics.push(
            Diagnostic::error("E0127", node.span, "a direction vector has three numbers")
                .label("this list")
                .help("write `+X`, `-X`, `+Y`, `-Y`, `+Z` or `-Z`"),
        );
        return None;
    };
    let along: Vec<_> = Axis::ALL.into_iter().zip(&numbers).filter(|(_, value)| **value != 0.0).collect();
    match along.as_slice() {
        [(axis, value)] if value.abs() == 1.0 => {
            Some(Along { axis: *axis, sign: if **value > 0.0 { 1 } else { -1 } })
        }
        [_] | [] => {
            diagnostics.push(
                Diagnostic::error("E0127", node.span, "a direction has length one")
                    .label("this vector is not of length one")
                    .help("write `+X` for [1, 0, 0]"),
            );
            None
        }
        _ => {
            diagnostics.push(
                Diagnostic::error(
                    "E0128",
                    node.span,
                    "a direction runs along one of the frame's own directions",
                )
                .label("this direction is skew")
                .help("take the nearest of +X -X +Y -Y +Z -Z; the angle that is left is an alignment error"),
            );
            None
        }
    }
}

fn number(node: &Node) -> Option<f64> {
    match &node.kind {
        NodeKind::Scalar(scalar) => scalar.text.parse().ok(),
        _ => None,
    }
}

fn origin(
    fields: &mut Fields<'_>,
    kind: Option<LinkKind>,
    span: Span,
    diagnostics: &mut Diagnostics,
) -> ([Polynomial; 3], [Span; 3]) {
    let mut origin = [Polynomial::zero(), Polynomial::zero(), Polynomial::zero()];
    let mut spans = [span; 3];
    let key = if matches!(kind, Some(LinkKind::Tool | LinkKind::Part)) { "offset" } else { "origin" };
    let Some(node) = fields.take(key) else { return (origin, spans) };
    let entries = items(node, "a place", diagnostics).unwrap_or_default();
    if entries.len() != 3 {
        if matches!(node.kind, NodeKind::Sequence(_)) {
            let message = format!("a place has three coordinates, this one has {}", entries.len());
            diagnostics.push(
                Diagnostic::error("E0117", node.span, message)
                    .label("X, Y and Z are needed")
                    .help("write all three, 0 where there is no offset: `[X1, 0, Z1]`"),
            );
        }
        return (origin, spans);
    }
    for ((entry, slot), span) in entries.iter().zip(&mut origin).zip(&mut spans) {
        *span = entry.span;
        *slot = coordinate(entry, diagnostics);
    }
    (origin, spans)
}

/// The largest number that an offset may hold: a thousand kilometres.
const MOST_MM: f64 = 1e9;

fn coordinate(node: &Node, diagnostics: &mut Diagnostics) -> Polynomial {
    let Some(written) = text(node, "a coordinate", diagnostics) else { return Polynomial::zero() };
    let value = match exact_length(written) {
        Some(length) => Ok(Polynomial::number(length)),
        None => expression::parse(written, &mut |name| Some(Symbol::Constant(name.into())))
            .map_err(|mistake| mistake.message),
    };
    let bounded = value.and_then(|value| {
        let too_large = value.terms().any(|(_, number)| to_f64(number).abs() > MOST_MM);
        if too_large { Err(format!("it holds a number beyond {MOST_MM:e} mm")) } else { Ok(value) }
    });
    bounded.unwrap_or_else(|mistake| {
        diagnostics.push(
            Diagnostic::error("E0118", node.span, format!("`{written}` is not a coordinate"))
                .label(mistake)
                .help("write a length (bare numbers are mm), the name of a constant, or a sum of such"),
        );
        Polynomial::zero()
    })
}
