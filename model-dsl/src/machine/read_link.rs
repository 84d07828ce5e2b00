//! One link of a chain. In: its mapping. Out: the link, or every mistake in it.

use super::draft::DraftedLink;
use super::fields::{self, items, text, truth};
use super::header::reference;
use super::link::{Branch, Link, LinkKind, Reference};
use super::pointing;
use super::read_along::{Direction, along};
use super::words::{exact_length, is_name};
use crate::algebra::{Axis, Monomial, Polynomial, Rational, Symbol, to_f64};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::expression;
use crate::sheet::infix;
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
    // Only a rotary axis, and the motors of a beam, can be told that they do not correct. A lean is that of an axis, whose body stays
    // upright; a fixed body is turned with all that stands on it.
    match word {
        "rotary" => known.extend(["corrects", "leans"]),
        "fixed" => known.push("turned"),
        "tool" => known.push("direction"),
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
    let turned = fields.entry("leans").or_else(|| fields.entry("turned"));
    let direction = along(fields.entry("along"), turned, kind, name_node.span, diagnostics);
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
    let Direction { along, turned } = direction?;
    let link = Link {
        id: id.to_owned(),
        kind: kind?,
        branch,
        along,
        origin,
        turned,
        reference,
        corrects,
        span: name_node.span,
    };
    let direction = match fields.get("direction") {
        Some(node) => Some(pointing::read(node, diagnostics)?),
        None => None,
    };
    Some(DraftedLink { link, origin_spans, errors, direction, drives: fields.entry("drives") })
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
        // The cosine of a constant angle is a number.
        let lengths = |monomial: &Monomial| -> u32 {
            let lengths = monomial.factors().iter().filter(|(symbol, _)| symbol.fixed_value().is_none());
            lengths.map(|(_, power)| power).sum()
        };
        let product = value.terms().map(|(monomial, _)| monomial).find(|monomial| lengths(monomial) > 1);
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
