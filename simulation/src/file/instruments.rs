//! The instrument of a path file. In: its one key, or its name alone. Out: the instrument with its faults.

use model_dsl::diagnostic::Diagnostic;
use model_dsl::quantity::{self, Dimension};
use model_dsl::source::{Span, Spanned};
use model_dsl::suggest::nearest;
use model_dsl::yaml::Node;

use super::section::{Context, FORM, Section, list, word};
use crate::instrument::{Instrument, Normal};

const INSTRUMENTS: [&str; 6] = ["position", "ballbar", "linear", "straightness", "angular", "probe"];

/// Reads `instrument`.
pub(super) fn read(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Instrument> {
    if let Some(text) = node.text() {
        let nothing = Node { span: node.span, kind: model_dsl::yaml::NodeKind::Mapping(Vec::new()) };
        return of_kind(text.trim(), node.span, &nothing, context);
    }
    match node.entries() {
        Some([(kind, inside)]) => of_kind(&kind.value, kind.span, inside, context),
        Some([_, (second, _), ..]) => {
            let mistake = Diagnostic::error("E0707", second.span, "a path must have one instrument");
            context.report(mistake.help("write one path file for each instrument"));
            None
        }
        _ => {
            let span = if node.entries().is_some() { name } else { node.span };
            let mistake = Diagnostic::error("E0707", span, "`instrument` names no instrument");
            context.report(mistake.help(format!("write one of {}", INSTRUMENTS.join(", "))));
            None
        }
    }
}

fn of_kind(kind: &str, span: Span, node: &Node, context: &mut Context<'_>) -> Option<Instrument> {
    match kind {
        "position" => position(node, context),
        "ballbar" => ballbar(node, span, context),
        "linear" => linear(node, span, context),
        "straightness" => straightness(node, span, context),
        "angular" => angular(node, span, context),
        "probe" => probe(node, span, context),
        _ => {
            let mistake = Diagnostic::error("E0707", span, format!("unknown instrument `{kind}`"));
            let help = format!("write one of {}", INSTRUMENTS.join(", "));
            context.report(match nearest(kind, INSTRUMENTS) {
                Some(near) => mistake.suggest(Some(near)),
                None => mistake.help(help),
            });
            None
        }
    }
}

/// A list of directions and rotary axes; without one, what the machine derives.
fn position(node: &Node, context: &mut Context<'_>) -> Option<Instrument> {
    if node.entries().is_some_and(<[_]>::is_empty) {
        let angles: Vec<usize> = (0..context.names.axes.len()).filter(|axis| context.rotary(*axis)).collect();
        if angles.len() == context.names.axes.len() {
            return Some(Instrument::Position { directions: [false; 3], angles });
        }
        let sensitive = model_dsl::algebra::Axis::ALL.map(|axis| context.machine.sensitive.contains(&axis));
        return Some(Instrument::Position { directions: sensitive, angles: Vec::new() });
    }
    let items = list(node, "`position`", context)?;
    let (mut directions, mut angles) = ([false; 3], Vec::new());
    for item in items {
        let letter = word(item, "an entry of `position`", context)?;
        let upper = letter.value.to_ascii_uppercase();
        if let Some(slot) =
            "XYZ".find(&upper).filter(|_| upper.len() == 1).and_then(|at| directions.get_mut(at))
        {
            *slot = true;
            continue;
        }
        let axis = context.axis(&upper, letter.span)?;
        if !context.rotary(axis) {
            let message = format!("`{}` is neither a direction nor a rotary axis", letter.value);
            context.report(
                Diagnostic::error("E0711", letter.span, message).help("write x, y, z or a rotary axis"),
            );
            return None;
        }
        angles.push(axis);
    }
    if angles.is_empty() == (directions == [false; 3]) {
        let message = "`position` must read either directions or angles";
        context.report(
            Diagnostic::error(FORM, node.span, message).help("write `[x, y]`, or a rotary axis: `[c]`"),
        );
        return None;
    }
    Some(Instrument::Position { directions, angles })
}

fn ballbar(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Instrument> {
    let known = ["center", "radius", "eccentricity", "offset"];
    let section = Section::open(node, name, "`ballbar`", &known, context)?;
    let center = section.part("center", |node, _| place(node, "`center` of `ballbar`", context));
    let radius = match section.get("radius") {
        Some(_) => section.positive("radius", Dimension::LENGTH, context).map(Some),
        None => Some(None),
    };
    let eccentricity = section.part("eccentricity", |node, name| {
        let section = Section::open(node, name, "`eccentricity`", &["x", "y", "z"], context)?;
        let [x, y, z] = ["x", "y", "z"].map(|key| section.quantity_or(key, Dimension::LENGTH, 0.0, context));
        Some([x?, y?, z?])
    });
    let offset = section.quantity_or("offset", Dimension::LENGTH, 0.0, context);
    Some(Instrument::Ballbar {
        center: center?,
        radius: radius?,
        eccentricity: eccentricity?.unwrap_or_default(),
        offset: offset?,
    })
}

fn linear(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Instrument> {
    let section = Section::open(node, name, "`linear`", &["axis", "direction", "cosine"], context)?;
    let axis = axis(&section, context);
    let direction = match section.get("direction") {
        Some(node) => direction(node, &section.words("direction"), false, context),
        None => axis.map(|axis| own_direction(axis, context)),
    };
    let cosine = section.quantity_or("cosine", Dimension::ANGLE, 0.0, context);
    Some(Instrument::Linear { axis: axis?, direction: direction?, cosine: cosine? })
}

fn straightness(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Instrument> {
    let section = Section::open(node, name, "`straightness`", &["axis", "direction"], context)?;
    let axis = axis(&section, context);
    let direction = section
        .need("direction", context)
        .and_then(|node| direction(node, &section.words("direction"), false, context));
    Some(Instrument::Straightness { axis: axis?, direction: direction? })
}

fn angular(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Instrument> {
    let section = Section::open(node, name, "`angular`", &["axis", "direction"], context)?;
    let axis = match section.get("axis") {
        Some(_) => axis(&section, context).map(Some),
        None => Some(None),
    };
    let about = section
        .need("direction", context)
        .and_then(|node| direction(node, &section.words("direction"), true, context));
    Some(Instrument::Angular { axis: axis?, about: about? })
}

fn probe(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Instrument> {
    let section = Section::open(node, name, "`probe`", &["normal"], context)?;
    let normal = section.need("normal", context)?;
    if normal.text() == Some("radial") {
        return Some(Instrument::Probe { normal: Normal::Radial(None) });
    }
    let direction = direction(normal, &section.words("normal"), false, context)?;
    Some(Instrument::Probe { normal: Normal::Fixed(direction) })
}

fn axis(section: &Section<'_, '_>, context: &mut Context<'_>) -> Option<usize> {
    let letter = word(section.need("axis", context)?, &section.words("axis"), context)?;
    context.axis(letter.value, letter.span)
}

/// The direction after which an axis is named; those of rotary axes too.
fn own_direction(axis: usize, context: &Context<'_>) -> [f64; 3] {
    let letter = context.names.axes.get(axis).map_or("", |axis| axis.letter.as_str());
    unit(letter).unwrap_or([0.0, 0.0, 1.0])
}

fn unit(letter: &str) -> Option<[f64; 3]> {
    match letter {
        "X" | "U" | "A" => Some([1.0, 0.0, 0.0]),
        "Y" | "V" | "B" => Some([0.0, 1.0, 0.0]),
        "Z" | "W" | "C" => Some([0.0, 0.0, 1.0]),
        _ => None,
    }
}

/// `X`, `-X`, or a list of three numbers; `A`, `B`, `C` where a rotation is meant.
fn direction(node: &Node, what: &str, rotation: bool, context: &mut Context<'_>) -> Option<[f64; 3]> {
    if let Some(items) = node.items() {
        return vector(node, items, what, context);
    }
    let written = word(node, what, context)?;
    let (sign, letter) = match written.value.strip_prefix('-') {
        Some(letter) => (-1.0, letter),
        None => (1.0, written.value.trim_start_matches('+')),
    };
    let fits = "XYZ".contains(letter) || rotation && "ABC".contains(letter);
    let found = unit(letter).filter(|_| fits && letter.len() == 1);
    if found.is_none() {
        let message = format!("`{}` is not a direction", written.value);
        let help = "write `X`, `-X`, `Y`, `-Y`, `Z`, `-Z`, or three numbers: `[1, 0, 0]`";
        context.report(Diagnostic::error("E0709", written.span, message).help(help));
    }
    found.map(|direction| direction.map(|entry| sign * entry))
}

fn vector(node: &Node, items: &[Node], what: &str, context: &mut Context<'_>) -> Option<[f64; 3]> {
    let mut entry = |item: &Node| quantity::read_number(item, what, context.diagnostics);
    let numbers: Vec<Option<Spanned<f64>>> = items.iter().map(&mut entry).collect();
    let numbers: Vec<f64> =
        numbers.into_iter().collect::<Option<Vec<_>>>()?.iter().map(|one| one.value).collect();
    let length = numbers.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
    match <[f64; 3]>::try_from(numbers) {
        Ok(entries) if length > 0.0 && length.is_finite() => Some(entries.map(|entry| entry / length)),
        _ => {
            let mistake =
                Diagnostic::error("E0709", node.span, format!("{what} must be a vector of three numbers"));
            context.report(mistake.help("write three numbers, not all zero: `[0, 0.6, 0.8]`"));
            None
        }
    }
}

/// Three lengths.
fn place(node: &Node, what: &str, context: &mut Context<'_>) -> Option<[f64; 3]> {
    let items = list(node, what, context)?;
    let lengths: Vec<Option<f64>> =
        items.iter().map(|item| context.size(item, Dimension::LENGTH, what)).collect();
    let lengths = lengths.into_iter().collect::<Option<Vec<f64>>>()?;
    match <[f64; 3]>::try_from(lengths) {
        Ok(place) => Some(place),
        Err(_) => {
            let mistake = Diagnostic::error(FORM, node.span, format!("{what} must have three lengths"));
            context.report(mistake.help("write `[275 mm, 140 mm, 70 mm]`"));
            None
        }
    }
}
