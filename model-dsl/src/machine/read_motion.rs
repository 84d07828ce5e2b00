//! The `errors` of links. In: a list of names, or a map from names to symbols and senses; or
//! nothing, for the usual set. Out: the error motions of the machine, in printing order.

use super::draft::{Chain, DraftedLink};
use super::fields::{self, choice, items, text, truth};
use super::link::{Link, LinkKind};
use super::motion::{Motion, MotionKind, MotionName, parse_name};
use super::reference;
use super::usual_motions::usual;
use super::words::is_name;
use crate::algebra::{Axis, Name};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};
use crate::suggest::nearest;
use crate::yaml::{Node, NodeKind};

/// Collects the error motions of all links, in printing order.
pub(super) fn collect(chain: &Chain<'_>, diagnostics: &mut Diagnostics) -> Vec<Motion> {
    let mut motions = Vec::new();
    for (number, drafted) in chain.links.iter().enumerate() {
        match drafted.errors {
            Some(node) => listed(node, number, drafted, chain, &mut motions, diagnostics),
            None => motions.extend(usual(number, chain)),
        }
    }
    motions.sort_by_key(|motion| {
        let rank = chain.links.get(motion.link).map(|drafted| drafted.link.kind.axis_rank());
        (motion.kind.alignment(), rank, motion.link, motion.kind.angular(), motion.kind.axis())
    });
    motions
}

fn listed(
    node: &Node,
    number: usize,
    drafted: &DraftedLink<'_>,
    chain: &Chain<'_>,
    motions: &mut Vec<Motion>,
    diagnostics: &mut Diagnostics,
) {
    let mut add = |name: &str, span: Span, details: Option<&Node>, diagnostics: &mut Diagnostics| {
        let Some(mut found) = named(name, span, number, drafted, chain, diagnostics) else { return };
        if let Some(node) = details {
            detail(node, &mut found, &drafted.link, diagnostics);
        }
        match motions.iter().find(|known| known.name == found.name) {
            Some(known) => diagnostics.push(
                Diagnostic::error("E0141", span, format!("error motion {} is listed twice", found.name))
                    .label("again here")
                    .also(known.span.unwrap_or(span), "first here")
                    .help("list each error motion once"),
            ),
            None => motions.push(found),
        }
    };
    match &node.kind {
        NodeKind::Null => {}
        NodeKind::Mapping(entries) => {
            for (key, value) in entries {
                add(&key.value, key.span, Some(value), diagnostics);
            }
        }
        _ => {
            for item in items(node, "`errors`", diagnostics).unwrap_or_default() {
                let Some(name) = text(item, "an error motion", diagnostics) else { continue };
                add(name, item.span, None, diagnostics);
            }
        }
    }
}

fn named(
    name: &str,
    span: Span,
    number: usize,
    drafted: &DraftedLink<'_>,
    chain: &Chain<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Motion> {
    let link = &drafted.link;
    let parsed = parse_name(name, &link.id);
    let Some((parsed, kind)) = parsed.and_then(|parsed| kind_of(&parsed).map(|kind| (parsed, kind))) else {
        diagnostics.push(misnamed(name, span, link, chain));
        return None;
    };
    let allowed = match kind {
        MotionKind::Offset(_) => matches!(link.kind, LinkKind::Rotary(_) | LinkKind::Spindle),
        MotionKind::Alignment(_) => link.is_axis() || link.kind == LinkKind::Spindle,
        _ => true,
    };
    if !allowed {
        diagnostics.push(misaligned(name, span, kind, link));
        return None;
    }
    Some(Motion { counted_from: parsed.counted_from, ..Motion::plain(number, link, kind, Some(span)) })
}

/// Reports each alignment error that the file counts from an axis from which it is another one.
pub(super) fn check_references(
    motions: &[Motion],
    chain: &Chain<'_>,
    relative: bool,
    diagnostics: &mut Diagnostics,
) {
    let links: Vec<Link> = chain.links.iter().map(|drafted| drafted.link.clone()).collect();
    let placed = reference::placed(&links, motions, relative);
    for (motion, own) in motions.iter().zip(&placed) {
        let (Some(from), Some(span), Some(link)) =
            (&motion.counted_from, motion.span, links.get(motion.link))
        else {
            continue;
        };
        let name = format!("E{}(0{from}){}", motion.kind.letter(), link.id);
        let counted = reference::counted(&links, &placed, own);
        if let Some(reason) = reference::difference(&name, &motion.name, from, &counted) {
            let same: Vec<&str> =
                counted.iter().filter(|one| one.is == motion.name).map(|one| one.from.as_str()).collect();
            let error = Diagnostic::error("E0146", span, format!("{name} differs from {} here", motion.name))
                .label(reason);
            let help = format!("write `{}`, which is counted from the frame before {}", motion.name, link.id);
            diagnostics.push(match same.as_slice() {
                [] => error.help(help),
                axes => error.help(format!("{help}; it is the same if counted from {}", axes.join(", "))),
            });
        }
    }
}

/// An alignment error that its link cannot have.
fn misaligned(name: &str, span: Span, kind: MotionKind, link: &Link) -> Diagnostic {
    let word = link.kind.word();
    let error = Diagnostic::error("E0143", span, format!("link {} has no alignment error {name}", link.id));
    if matches!(link.kind, LinkKind::Slide(_)) {
        return error
            .label("only the axis of a `rotary` or a `spindle` has a place of its own")
            .help("the place of a slide is its `origin`");
    }
    error.label(format!("a link of kind `{word}` has no axis that could be misaligned")).help(format!(
        "did you mean `E{}{}`?",
        kind.letter(),
        link.id
    ))
}

pub(crate) fn kind_of(name: &MotionName) -> Option<MotionKind> {
    let (axis, angular) = match name.letter {
        'X' => (Axis::X, false),
        'Y' => (Axis::Y, false),
        'Z' => (Axis::Z, false),
        'A' => (Axis::X, true),
        'B' => (Axis::Y, true),
        'C' => (Axis::Z, true),
        _ => return None,
    };
    Some(match (name.alignment, angular) {
        (false, false) => MotionKind::Linear(axis),
        (false, true) => MotionKind::Angular(axis),
        (true, false) => MotionKind::Offset(axis),
        (true, true) => MotionKind::Alignment(axis),
    })
}

/// A name that is not one of this link: it names another link, or none.
fn misnamed(name: &str, span: Span, link: &Link, chain: &Chain<'_>) -> Diagnostic {
    let other =
        chain.links.iter().map(|drafted| &drafted.link).find(|other| parse_name(name, &other.id).is_some());
    if let Some(other) = other {
        return Diagnostic::error("E0140", span, format!("error motion {name} belongs to link {}", other.id))
            .label(format!("this is link {}", link.id))
            .help(format!("move it to the `errors` of link {}", other.id));
    }
    let mut known: Vec<String> = "XYZABC".chars().map(|letter| format!("E{letter}{}", link.id)).collect();
    known.extend("ABC".chars().map(|letter| format!("E{letter}0{}", link.id)));
    let error = Diagnostic::error("E0140", span, format!("error motion `{name}` names no link"))
        .label(format!("a motion of this link ends in `{}`", link.id));
    match nearest(name, known.iter().map(String::as_str)) {
        Some(near) => error.help(format!("did you mean `{near}`?")),
        None => error.help(format!("motions of this link: {}", known.join(", "))),
    }
}

/// Reads what stands behind a motion: a symbol, or a mapping with symbol, sign, travel and rotates.
fn detail(node: &Node, motion: &mut Motion, link: &Link, diagnostics: &mut Diagnostics) {
    match &node.kind {
        NodeKind::Null => {}
        NodeKind::Scalar(_) => symbol(node, motion, diagnostics),
        _ => {
            let known = ["symbol", "sign", "travel", "rotates"];
            let Some(fields) = fields::open(node, "an error motion", &known, diagnostics) else { return };
            if let Some(node) = fields.get("symbol") {
                symbol(node, motion, diagnostics);
            }
            if let Some(node) = fields.get("sign") {
                let word = choice(node, "a sign", &["1", "+1", "-1"], diagnostics);
                motion.sign = if word == Some("-1") { -1 } else { 1 };
                if motion.sign < 0 && motion.symbol == motion.name {
                    diagnostics.push(sign_without_symbol(node, motion));
                }
            }
            let travel = fields.entry("travel");
            let rotates = fields.entry("rotates");
            for (key, _) in travel.iter().chain(&rotates) {
                aligned_only(key, motion, link, diagnostics);
            }
            if let Some((_, node)) = travel {
                motion.travel = name(node, "a travel", diagnostics).map(|name| Spanned::new(name, node.span));
            }
            if let Some((_, node)) = rotates {
                motion.rotates = truth(node, diagnostics) == Some(true);
            }
        }
    }
}

/// A name of ISO 230-1 has one sense; another one needs a name of its own.
fn sign_without_symbol(node: &Node, motion: &Motion) -> Diagnostic {
    Diagnostic::error(
        "E0142",
        node.span,
        format!("`sign: -1` needs a symbol counted against {}", motion.name),
    )
    .label("the sign belongs to the symbol")
    .help(format!("give it a symbol, `{}: {{symbol: a, sign: -1}}`, or remove it", motion.name))
}

/// `travel` and `rotates` say how an alignment error of a slide acts; elsewhere they mean nothing.
fn aligned_only(key: &Spanned<String>, motion: &Motion, link: &Link, diagnostics: &mut Diagnostics) {
    let slide = matches!(link.kind, LinkKind::Slide(_));
    if !slide || !motion.kind.alignment() {
        let message = format!("`{}` has no meaning for {}", key.value, motion.name);
        diagnostics.push(
            Diagnostic::error("E0142", key.span, message)
                .label("only an alignment error of a slide has it")
                .help("remove it"),
        );
    }
}

fn symbol(node: &Node, motion: &mut Motion, diagnostics: &mut Diagnostics) {
    if let Some(symbol) = name(node, "a symbol", diagnostics) {
        motion.symbol = symbol.to_string();
        motion.symbol_span = Some(node.span);
    }
}

fn name(node: &Node, what: &str, diagnostics: &mut Diagnostics) -> Option<Name> {
    let written = text(node, what, diagnostics)?;
    if is_name(written) {
        return Some(written.into());
    }
    diagnostics.push(
        Diagnostic::error("E0142", node.span, format!("`{written}` cannot be {what}"))
            .label("not a name")
            .help("begin with a letter, followed by letters, digits and `_`"),
    );
    None
}
