//! The error motions of a machine: which link has which, by what name and in what sense.
//!
//! In: the `errors` of each link, or nothing for the usual set. Out: one ordered list. Names
//! are those of ISO 230-1: `E`, a direction (X Y Z along, A B C about), a link; with a zero
//! between (`EC0Y`, also read as C0Y or COY) an alignment error of an axis.

use super::chain::{Chain, DraftedLink};
use super::constants::{Constant, is_name};
use super::fields::{Fields, choice, items, text};
use super::link::{Branch, Link, LinkKind};
use crate::algebra::{Axis, Name};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};
use crate::suggest::nearest;
use crate::yaml::{Node, NodeKind};

/// What an error motion does to its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MotionKind {
    /// Displaces it along a direction: mm.
    Linear(Axis),
    /// Turns it about a direction, right-handed: rad.
    Angular(Axis),
    /// Displaces the place of a rotary axis or spindle: mm.
    Offset(Axis),
    /// Turns the line of motion of a slide, or tilts a rotary axis or spindle: rad.
    Alignment(Axis),
}

impl MotionKind {
    /// Whether it is an angle.
    pub fn angular(self) -> bool {
        matches!(self, Self::Angular(_) | Self::Alignment(_))
    }

    /// Whether it belongs to the alignment of an axis, not to its motion.
    pub fn alignment(self) -> bool {
        matches!(self, Self::Offset(_) | Self::Alignment(_))
    }

    /// Its direction, or the direction about which it turns.
    pub fn axis(self) -> Axis {
        match self {
            Self::Linear(axis) | Self::Angular(axis) | Self::Offset(axis) | Self::Alignment(axis) => axis,
        }
    }

    /// The letter of ISO 230-1: X Y Z for a displacement, A B C for a rotation.
    pub fn letter(self) -> char {
        if self.angular() { self.axis().rotation_letter() } else { self.axis().letter() }
    }

    fn name(self, id: &str) -> String {
        let zero = if self.alignment() { "0" } else { "" };
        format!("E{}{zero}{id}", self.letter())
    }
}

/// One error motion of one link.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The name of ISO 230-1: EXX, EC0Y.
    pub name: String,
    /// The symbol to print; the name where the file gives none.
    pub symbol: String,
    /// The number of its link in [`super::Machine::links`].
    pub link: usize,
    /// What it does.
    pub kind: MotionKind,
    /// -1 where the file counts it against the ISO sense.
    pub sign: i64,
    /// The free travel in the lever of an alignment error, where it is not the position.
    pub travel: Option<Spanned<Name>>,
    /// Whether an alignment error turns the carriage too.
    pub rotates: bool,
    /// Where the file names it itself.
    pub span: Option<Span>,
}

/// A name split into its parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MotionName {
    /// X Y Z A B or C.
    pub letter: char,
    /// Whether a zero (or the letter O) stands before the link.
    pub alignment: bool,
    /// The link's id.
    pub link: String,
}

/// Reads a name for a link of the given id: `EXX`, `EC0Y`, `C0Y`, `COY`.
pub fn parse_name(name: &str, id: &str) -> Option<MotionName> {
    let front = name.strip_suffix(id)?;
    let (letters, alignment) = match front.strip_suffix(['0', 'O']) {
        Some(letters) => (letters, true),
        None => (front, false),
    };
    let letter = match (letters.as_bytes(), alignment) {
        ([b'E', letter], _) | ([letter], true) => *letter as char,
        _ => return None,
    };
    "XYZABC".contains(letter).then(|| MotionName { letter, alignment, link: id.to_owned() })
}

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

/// The usual error motions of a link: six for an axis, five for a spindle (its own angle is
/// free), none for a body at rest; and the alignment errors that the topology makes independent.
fn usual(number: usize, chain: &Chain<'_>) -> Vec<Motion> {
    let Some(drafted) = chain.links.get(number) else { return Vec::new() };
    let link = &drafted.link;
    let mut kinds: Vec<MotionKind> = Vec::new();
    if link.is_axis() || link.kind == LinkKind::Spindle {
        kinds.extend(Axis::ALL.map(MotionKind::Linear));
        let free = (link.kind == LinkKind::Spindle).then_some(link.along.axis);
        kinds.extend(Axis::ALL.into_iter().filter(|axis| Some(*axis) != free).map(MotionKind::Angular));
    }
    kinds.extend(independent_alignments(link, chain));
    kinds.into_iter().map(|kind| motion(number, link, kind, None)).collect()
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

fn motion(number: usize, link: &Link, kind: MotionKind, span: Option<Span>) -> Motion {
    let name = kind.name(&link.id);
    Motion { symbol: name.clone(), name, link: number, kind, sign: 1, travel: None, rotates: false, span }
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
    let kind = parse_name(name, &link.id).and_then(|parsed| kind_of(&parsed));
    let Some(kind) = kind else {
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
    Some(motion(number, link, kind, Some(span)))
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
    error.label(format!("a link of kind `{word}` has no axis that could be out of line")).help(format!(
        "did you mean `E{}{}`?",
        kind.letter(),
        link.id
    ))
}

fn kind_of(name: &MotionName) -> Option<MotionKind> {
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
            let Some(mut fields) = Fields::open(node, "an error motion", diagnostics) else { return };
            if let Some(node) = fields.take("symbol") {
                symbol(node, motion, diagnostics);
            }
            if let Some(node) = fields.take("sign") {
                let word = choice(node, "a sign", &["1", "+1", "-1"], diagnostics);
                motion.sign = if word == Some("-1") { -1 } else { 1 };
            }
            let travel = fields.take_entry("travel");
            let rotates = fields.take_entry("rotates");
            fields.finish(diagnostics);
            for (key, _) in travel.iter().chain(&rotates) {
                aligned_only(key, motion, link, diagnostics);
            }
            if let Some((_, node)) = travel {
                motion.travel = name(node, "a travel", diagnostics).map(|name| Spanned::new(name, node.span));
            }
            if let Some((_, node)) = rotates {
                motion.rotates =
                    choice(node, "`true` or `false`", &["true", "false"], diagnostics) == Some("true");
            }
        }
    }
}

/// `travel` and `rotates` say how an alignment error of a slide acts; elsewhere they mean nothing.
fn aligned_only(key: &Spanned<String>, motion: &Motion, link: &Link, diagnostics: &mut Diagnostics) {
    let slide = matches!(link.kind, LinkKind::Slide(_));
    if !slide || !motion.kind.alignment() {
        let message = format!("`{}` has no meaning for {}", key.value, motion.name);
        diagnostics.push(
            Diagnostic::error("E0142", key.span, message)
                .label("only an alignment error of a slide has it")
                .help("take it out"),
        );
    }
}

fn symbol(node: &Node, motion: &mut Motion, diagnostics: &mut Diagnostics) {
    if let Some(symbol) = name(node, "a symbol", diagnostics) {
        motion.symbol = symbol.to_string();
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
            .help("begin with a letter and go on with letters, digits and `_`"),
    );
    None
}

/// One name means one thing: positions, constants, travels, symbols and ISO names are distinct.
/// Constants stay distinct in lower case too, since they become fields of generated code.
pub(super) fn check_names(
    motions: &[Motion],
    constants: &[Constant],
    chain: &Chain<'_>,
    diagnostics: &mut Diagnostics,
) {
    let mut names = Names::default();
    for drafted in chain.links.iter().filter(|drafted| drafted.link.is_axis()) {
        names.take(&drafted.link.variable(), "the position of an axis", drafted.link.span, diagnostics);
    }
    for constant in constants {
        names.take(&constant.name, CONSTANT, constant.span, diagnostics);
    }
    for motion in motions {
        let link = chain.links.get(motion.link).map(|drafted| drafted.link.span);
        let span = motion.span.or(link).unwrap_or_default();
        if let Some(travel) = &motion.travel {
            names.take(&travel.value, TRAVEL, travel.span, diagnostics);
        }
        names.take(&motion.symbol, "an error motion", span, diagnostics);
        if motion.symbol != motion.name {
            names.take(&motion.name, "an error motion", span, diagnostics);
        }
    }
}

const CONSTANT: &str = "a constant";
const TRAVEL: &str = "a travel";

/// The names taken so far, what each stands for, and where.
#[derive(Default)]
struct Names(Vec<(String, &'static str, Span)>);

impl Names {
    fn take(&mut self, name: &str, what: &'static str, span: Span, diagnostics: &mut Diagnostics) {
        let same = |known: &str, other: &str| {
            known == name || (what == CONSTANT && other == CONSTANT && known.eq_ignore_ascii_case(name))
        };
        match self.0.iter().find(|(known, other, _)| same(known, other)) {
            Some((_, other, _)) if what == TRAVEL && *other == TRAVEL => {}
            Some((known, other, first)) => diagnostics.push(
                Diagnostic::error("E0135", span, format!("`{name}` would stand for two things"))
                    .label(format!("for {what} here"))
                    .also(*first, format!("`{known}` stands for {other} here"))
                    .help("choose another name; upper and lower case do not tell constants apart"),
            ),
            None => self.0.push((name.to_owned(), what, span)),
        }
    }
}

/// The sign with which a motion displaces or turns its own body in bed directions.
///
/// The link's own direction is counted along `along`, so that it is actual minus commanded.
/// With `motions: relative`, every other motion on the part's branch turns; an alignment
/// error does not, since a line of motion is turned the same way from whichever side it is seen.
pub(crate) fn body_sign(motion: &Motion, link: &Link, relative: bool) -> i64 {
    let own = match (link.kind, motion.kind) {
        (LinkKind::Slide(_), MotionKind::Linear(axis)) => axis == link.along.axis,
        (LinkKind::Rotary(_), MotionKind::Angular(axis) | MotionKind::Alignment(axis)) => {
            axis == link.along.axis
        }
        _ => false,
    };
    if own {
        motion.sign * link.along.sign
    } else if relative && link.branch == Branch::Workpiece && !motion.kind.alignment() {
        -motion.sign
    } else {
        motion.sign
    }
}
