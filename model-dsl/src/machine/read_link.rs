//! One link of a chain. In: its mapping. Out: the link, or every mistake in it.

use super::draft::DraftedLink;
use super::fields::{self, items, text, truth};
use super::header::reference;
use super::link::{Along, Branch, Link, LinkKind, Reference};
use super::words::{exact_length, is_name};
use crate::algebra::{Axis, Monomial, Polynomial, Rational, Symbol, to_f64};
use crate::calibration::LARGEST_ANGLE;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::expression;
use crate::notation::infix;
use crate::source::{Span, Spanned};
use crate::suggest::nearest;
use crate::yaml::{Node, NodeKind};

const KINDS: [&str; 6] = ["slide", "rotary", "spindle", "fixed", "tool", "part"];

/// Reads one link of a branch; `default_reference` holds where the link does not say otherwise.
pub(super) fn read_link<'n>(
    node: &'n Node,
    branch: Branch,
    default_reference: Reference,
    diagnostics: &mut Diagnostics,
) -> Option<DraftedLink<'n>> {
    let (word, name_node) = kind_of(node, diagnostics)?;
    let place = if matches!(word, "tool" | "part") { "offset" } else { "origin" };
    let mut known = vec![word, "id", "along", place, "errors", "reference"];
    // Only a rotary axis, and the motors of a beam, can be told that they do not correct.
    match word {
        "rotary" => known.push("corrects"),
        "slide" if node.get("drives").is_some() => known.extend(["drives", "corrects"]),
        "slide" => known.push("drives"),
        _ => {}
    }
    let fields = fields::open(node, "a link", &known, diagnostics)?;
    let name = text(name_node, "the name of a link", diagnostics)?;
    let kind = kind(word, name, name_node.span, diagnostics);
    let id = match fields.get("id") {
        Some(id) => text(id, "an id", diagnostics).map(|text| (text, id.span)),
        None => Some((name, name_node.span)),
    };
    let reference = match fields.get("reference") {
        Some(node) => reference(node, diagnostics),
        None => default_reference,
    };
    let corrects = fields.get("corrects").is_none_or(|node| truth(node, diagnostics) != Some(false));
    let along = along(fields.entry("along"), kind, name_node.span, diagnostics);
    let (origin, origin_spans) = origin(fields.get(place), node.span, diagnostics);
    let errors = fields.get("errors");
    let (id, id_span) = id?;
    if !is_name(id) {
        diagnostics.push(
            Diagnostic::error("E0124", id_span, format!("`{id}` cannot name a link"))
                .label("not a name")
                .help("begin with a letter, followed by letters, digits and `_`"),
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
        corrects,
        span: name_node.span,
    };
    Some(DraftedLink { link, origin_spans, errors, drives: fields.entry("drives") })
}

fn kind_of<'n>(node: &'n Node, diagnostics: &mut Diagnostics) -> Option<(&'static str, &'n Node)> {
    let entries = node.entries().unwrap_or(&[]);
    let is_kind = |key: &Spanned<String>| KINDS.into_iter().find(|word| *word == key.value);
    let found: Vec<_> =
        entries.iter().filter_map(|(key, value)| is_kind(key).map(|word| (word, key, value))).collect();
    match found.as_slice() {
        [] if node.entries().is_none() => {
            // The mapping that is missing here is reported by whoever opens it.
            Some((KINDS[0], node))
        }
        [] => {
            let near = entries.iter().find_map(|(key, _)| nearest(&key.value, KINDS));
            let help = match near {
                Some(word) => format!("did you mean `{word}`?"),
                None => format!("write one of {}", KINDS.join(", ")),
            };
            diagnostics.push(
                Diagnostic::error("E0120", fields::place(node), "this link does not say what it is")
                    .label("the link that begins here")
                    .help(help),
            );
            None
        }
        [(word, _, value)] => Some((*word, *value)),
        [first, second, ..] => {
            diagnostics.push(
                Diagnostic::error("E0121", second.1.span, "a link must have exactly one kind")
                    .label(format!("`{}` here", second.0))
                    .also(first.1.span, format!("and `{}` here", first.0))
                    .help("write each body as its own link after its own `- `"),
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
        format!("write one of {list}, and put another name into `id`")
    };
    diagnostics.push(
        Diagnostic::error("E0122", span, format!("`{name}` is not the letter of a `{word}`"))
            .label("this name")
            .help(help),
    );
    None
}

/// The direction that an axis letter names: X for X and U, and for the rotation A about it.
pub(crate) fn own_direction(letter: char) -> Axis {
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
                    .label("the direction in which its frame moves when programmed forwards is missing")
                    .help("write `along: +X`; a table that carries the part moves along `-X` for +X"),
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
                .help("remove `along`"),
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
                    format!("axis {letter} cannot run along {}", along.axis.letter()),
                )
                .label("this is not its own direction")
                .help(format!(
                    "name the axis after its direction; by ISO 841 this axis runs along +{own} or -{own}"
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
            .help(
                "write `+X`, `-X`, `+Y`, `-Y`, `+Z` or `-Z`; give a small skew angle as an alignment error",
            ),
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
                Diagnostic::error("E0127", node.span, "a direction must have length one")
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
                    "a direction must be one of the frame's own directions",
                )
                .label("this direction is skew")
                .help(straightened(&numbers)),
            );
            None
        }
    }
}

/// What to write for a skew direction: an alignment error is a small angle, and any other one is that of a rotary axis.
fn straightened(direction: &[f64]) -> String {
    let length = direction.iter().map(|part| part * part).sum::<f64>().sqrt();
    let nearest = direction.iter().map(|part| part.abs()).fold(0.0, f64::max);
    let angle = (nearest / length).min(1.0).acos();
    if angle <= LARGEST_ANGLE {
        return format!(
            "use the nearest of +X -X +Y -Y +Z -Z; the remaining {:.2} mrad are an alignment error",
            angle * 1e3
        );
    }
    format!(
        "put a rotary axis with `errors: []` before it, keep that axis at {:.2} deg, and use the nearest of +X -X +Y -Y +Z -Z \
         here",
        angle.to_degrees()
    )
}

fn number(node: &Node) -> Option<f64> {
    match &node.kind {
        NodeKind::Scalar(scalar) => scalar.text.parse().ok(),
        _ => None,
    }
}

fn origin(node: Option<&Node>, span: Span, diagnostics: &mut Diagnostics) -> ([Polynomial; 3], [Span; 3]) {
    let mut origin = [Polynomial::zero(), Polynomial::zero(), Polynomial::zero()];
    let mut spans = [span; 3];
    let Some(node) = node else { return (origin, spans) };
    let entries = items(node, "a place", diagnostics).unwrap_or_default();
    if entries.len() != 3 {
        if matches!(node.kind, NodeKind::Sequence(_)) {
            let message = format!("a place must have three coordinates, this one has {}", entries.len());
            diagnostics.push(
                Diagnostic::error("E0117", node.span, message)
                    .label("X, Y and Z are needed")
                    .help("write all three, with 0 for no offset: `[X1, 0, Z1]`"),
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

/// What a name in a coordinate stands for: a constant; but not what other languages write for numbers.
fn constant(name: &str) -> Option<Symbol> {
    let number = ["nan", "inf", "infinity"].contains(&name.to_ascii_lowercase().as_str());
    (!number).then(|| Symbol::Constant(name.into()))
}

/// The largest number that an offset may hold: a thousand kilometres.
const MOST_MM: f64 = 1e9;
/// The most terms that an offset may expand to.
const MOST_TERMS: usize = 32;

fn coordinate(node: &Node, diagnostics: &mut Diagnostics) -> Polynomial {
    let Some(written) = text(node, "a coordinate", diagnostics) else { return Polynomial::zero() };
    let value = match exact_length(written) {
        Some(length) => Ok(Polynomial::number(length)),
        None => expression::parse(written, &mut constant).map_err(|mistake| {
            let turns = written.contains("sin(") || written.contains("cos(");
            if turns { "a coordinate cannot depend on an axis".to_owned() } else { mistake.message }
        }),
    };
    let bounded = value.and_then(|value| {
        let too_large = value.terms().any(|(_, number)| to_f64(number).abs() > MOST_MM);
        let factors = |monomial: &Monomial| monomial.factors().iter().map(|(_, power)| power).sum::<u32>();
        let product = value.terms().map(|(monomial, _)| monomial).find(|monomial| factors(monomial) > 1);
        if let Some(product) = product {
            let product = Polynomial::monomial(product.clone(), Rational::from_integer(1.into()));
            Err(format!("`{}` is a product of lengths, not a length", infix(&product)))
        } else if too_large {
            Err(format!("it contains a number beyond {MOST_MM:e} mm"))
        } else if value.size() > MOST_TERMS {
            Err(format!("it expands to {} terms, more than {MOST_TERMS}", value.size()))
        } else {
            Ok(value)
        }
    });
    bounded.unwrap_or_else(|mistake| {
        diagnostics.push(
            Diagnostic::error("E0118", node.span, format!("`{written}` is not a valid coordinate"))
                .label(mistake)
                .help("write a length (bare numbers are mm), the name of a constant, or a sum of these"),
        );
        Polynomial::zero()
    })
}
