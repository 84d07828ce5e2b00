//! The direction of a link. In: its key `along`, and the angles by which it leans or is turned. Out: the direction of its frame in which it
//! moves, and how that frame is turned against the frame before it; or what is wrong with them.

use super::fields::text;
use super::link::{Along, LinkKind};
use super::read_link::own_direction;
use super::turned::{self, Turned};
use crate::algebra::Axis;
use crate::calibration::LARGEST_ANGLE;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};
use crate::yaml::{Node, NodeKind};

/// The direction of a link: that of its own frame, and how this is turned.
#[derive(Clone, Debug, Default)]
pub(super) struct Direction {
    pub(super) along: Along,
    pub(super) turned: Turned,
}

/// A key with its value.
type Entry<'n> = (&'n Spanned<String>, &'n Node);

/// Reads the direction of a link that is called at `link_span`; `turned` is its key `leans` or `turned`.
pub(super) fn along(
    entry: Option<Entry<'_>>,
    turned: Option<Entry<'_>>,
    kind: Option<LinkKind>,
    link_span: Span,
    diagnostics: &mut Diagnostics,
) -> Option<Direction> {
    let kind = kind?;
    let angles = match turned {
        Some((_, node)) => turned::read(node, diagnostics)?,
        None => Turned::default(),
    };
    let Some((key, node)) = entry else {
        if kind.letter().is_some() {
            diagnostics.push(
                Diagnostic::error("E0102", link_span, "an axis needs the key `along`")
                    .label("the direction in which its frame moves when programmed forwards is missing")
                    .help("write `along: +X`; a table that carries the part moves along `-X` for +X"),
            );
            return None;
        }
        return Some(Direction { turned: angles, ..Direction::default() });
    };
    if matches!(kind, LinkKind::Fixed | LinkKind::Tool | LinkKind::Part) {
        let message = format!("a link of kind `{}` has no direction of motion", kind.word());
        diagnostics.push(
            Diagnostic::error("E0129", key.span, message)
                .label("nothing moves along it")
                .help("remove `along`"),
        );
        return None;
    }
    let direction = direction(node, kind, diagnostics)?;
    let along = direction.along;
    match kind.letter() {
        Some(letter) if own_direction(letter) != along.axis => {
            diagnostics.push(other_direction(node.span, letter, along));
            None
        }
        _ => match turned {
            Some((key, _)) if !direction.turned.is_none() => {
                diagnostics.push(leans_twice(key.span, node.span, &direction.turned));
                None
            }
            Some(_) => Some(Direction { along, turned: angles }),
            None => Some(direction),
        },
    }
}

fn other_direction(span: Span, letter: char, along: Along) -> Diagnostic {
    let own = own_direction(letter).letter();
    Diagnostic::error("E0129", span, format!("axis {letter} cannot run along {}", along.axis.letter()))
        .label("this is not its own direction")
        .help(format!("name the axis after its direction; by ISO 841 this axis runs along +{own} or -{own}"))
}

fn leans_twice(key: Span, vector: Span, turned: &Turned) -> Diagnostic {
    Diagnostic::error("E0129", key, "this axis leans twice")
        .label("by angles here")
        .also(vector, format!("and by {} here", turned.words()))
        .help("write the vector alone, or the angles with a letter such as `along: +B`")
}

fn direction(node: &Node, kind: LinkKind, diagnostics: &mut Diagnostics) -> Option<Direction> {
    if let NodeKind::Sequence(entries) = &node.kind {
        return vector(node, entries, kind, diagnostics);
    }
    let word = text(node, "a direction", diagnostics)?;
    let (sign, letter) = match word.as_bytes() {
        [b'+', letter] | [letter] => (1, *letter as char),
        [b'-', letter] => (-1, *letter as char),
        _ => (0, ' '),
    };
    if sign != 0 && "XYZUVWABC".contains(letter) {
        let along = Along { axis: own_direction(letter), sign };
        return Some(Direction { along, turned: Turned::default() });
    }
    let code = if word.chars().count() > 2 { "E0128" } else { "E0127" };
    diagnostics.push(
        Diagnostic::error(code, node.span, format!("`{word}` is not a direction"))
            .label("a direction is a sign and a letter")
            .help("write `+X`, `-X`, `+Y`, `-Y`, `+Z` or `-Z`; give a rotary axis that leans a vector, `[0, 1, 1]`"),
    );
    None
}

fn vector(node: &Node, entries: &[Node], kind: LinkKind, diagnostics: &mut Diagnostics) -> Option<Direction> {
    let numbers: Option<Vec<f64>> = entries.iter().map(number).collect();
    let Some(numbers) = numbers.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok()) else {
        diagnostics.push(
            Diagnostic::error("E0127", node.span, "a direction vector has three numbers")
                .label("this list")
                .help("write `+X`, `-X`, `+Y`, `-Y`, `+Z` or `-Z`"),
        );
        return None;
    };
    let along: Vec<_> = Axis::ALL.into_iter().zip(numbers).filter(|(_, value)| *value != 0.0).collect();
    match along.as_slice() {
        [(axis, value)] if value.abs() == 1.0 || matches!(kind, LinkKind::Rotary(_)) => {
            let along = Along { axis: *axis, sign: if *value > 0.0 { 1 } else { -1 } };
            Some(Direction { along, turned: Turned::default() })
        }
        [_] | [] => {
            diagnostics.push(
                Diagnostic::error("E0127", node.span, "a direction must have length one")
                    .label("this vector is not of length one")
                    .help("write `+X` for [1, 0, 0]"),
            );
            None
        }
        _ => skew(node.span, numbers, kind, diagnostics),
    }
}

/// A vector in no direction of the frame: a rotary axis leans, and anything else does not.
fn skew(span: Span, vector: [f64; 3], kind: LinkKind, diagnostics: &mut Diagnostics) -> Option<Direction> {
    let from_straight = from_straight(vector);
    let leaning = kind.letter().and_then(|letter| towards(own_direction(letter), vector));
    if from_straight > LARGEST_ANGLE
        && matches!(kind, LinkKind::Rotary(_))
        && let Some(direction) = leaning
    {
        return Some(direction);
    }
    let help = if from_straight <= LARGEST_ANGLE {
        format!(
            "use the nearest of +X -X +Y -Y +Z -Z; the remaining {:.2} mrad are an alignment error",
            from_straight * 1e3
        )
    } else if matches!(kind, LinkKind::Rotary(_)) {
        "give the axis the letter of a direction along which the vector has a component: A for X, B for Y, C for Z"
            .to_owned()
    } else {
        turned_before(kind, leaning)
    };
    diagnostics.push(
        Diagnostic::error("E0128", span, "a direction must be one of the frame's own directions")
            .label("this direction is skew")
            .help(help),
    );
    None
}

/// The angle to the nearest direction of the frame, rad.
fn from_straight(vector: [f64; 3]) -> f64 {
    let nearest = vector.iter().map(|part| part.abs()).fold(0.0, f64::max);
    let length = vector.iter().map(|part| (part / nearest).powi(2)).sum::<f64>().sqrt();
    (1.0 / length).min(1.0).acos()
}

/// The lean of an axis whose vector has a part along its own direction.
fn towards(own: Axis, vector: [f64; 3]) -> Option<Direction> {
    let along = vector[own.index()];
    let sign = if along < 0.0 { -1 } else { 1 };
    let forwards = vector.map(|part| if along < 0.0 { -part } else { part });
    let turned = (along != 0.0).then(|| Turned::towards(own, forwards)).flatten()?;
    Some(Direction { along: Along { axis: own, sign }, turned })
}

/// What to write for a slide or a spindle, which stands on a body that is turned.
fn turned_before(kind: LinkKind, leaning: Option<Direction>) -> String {
    let angles = leaning.map_or_else(|| "{A: 45 deg}".to_owned(), |direction| direction.turned.words());
    let along = kind.letter().map_or('Z', |letter| own_direction(letter).letter());
    format!(
        "put `- {{fixed: lean, turned: {angles}}}` before it, write `along: +{along}` or `-{along}`, and turn the links on it back \
         with another fixed link"
    )
}

fn number(node: &Node) -> Option<f64> {
    match &node.kind {
        NodeKind::Scalar(scalar) => scalar.text.parse().ok().filter(|number: &f64| number.is_finite()),
        _ => None,
    }
}
