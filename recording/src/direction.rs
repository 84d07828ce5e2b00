//! Directions in a set-up: `X`, `-X`, `B`, or three numbers. Out: unit vectors of the part's frame.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::machine::{Branch, Link};
use model_dsl::quantity;
use model_dsl::source::Spanned;
use model_dsl::yaml::Node;

/// Reads a direction; for an instrument that reads an angle also as the rotation about it, A, B or C.
pub(super) fn read_direction(
    node: &Node,
    angular: bool,
    diagnostics: &mut Diagnostics,
) -> Option<Spanned<[f64; 3]>> {
    if let Some(items) = node.items() {
        return read_vector(node, items, diagnostics);
    }
    let found = node.text().and_then(|text| named(text.trim(), angular));
    if found.is_none() {
        let written = node.text().map_or_else(|| node.kind_name().to_owned(), |text| format!("`{text}`"));
        let mistake = Diagnostic::error("E0617", node.span, format!("{written} is not a direction"));
        let help = if angular { "write A, B or C, or -A" } else { "write X, Y or Z, or -X" };
        diagnostics.push(mistake.help(format!("{help}, or three numbers such as `[1, 1, 0]`")));
    }
    found.map(|direction| Spanned::new(direction, node.span))
}

fn named(text: &str, angular: bool) -> Option<[f64; 3]> {
    let (sign, letter) = match text.strip_prefix('-') {
        Some(letter) => (-1.0, letter),
        None => (1.0, text.strip_prefix('+').unwrap_or(text)),
    };
    match letter {
        "X" => Some([sign, 0.0, 0.0]),
        "Y" => Some([0.0, sign, 0.0]),
        "Z" => Some([0.0, 0.0, sign]),
        "A" if angular => Some([sign, 0.0, 0.0]),
        "B" if angular => Some([0.0, sign, 0.0]),
        "C" if angular => Some([0.0, 0.0, sign]),
        _ => None,
    }
}

fn read_vector(node: &Node, items: &[Node], diagnostics: &mut Diagnostics) -> Option<Spanned<[f64; 3]>> {
    let wrong = |message: String| {
        Diagnostic::error("E0617", node.span, message).help("write three numbers such as `[1, 1, 0]`")
    };
    let [x, y, z] = items else {
        diagnostics.push(wrong(format!("a direction must have three numbers, found {}", items.len())));
        return None;
    };
    let mut read = |node| quantity::read_number(node, "a component of a direction", diagnostics);
    let (x, y, z) = (read(x), read(y), read(z));
    let vector = unit([x?.value, y?.value, z?.value]);
    if vector.is_none() {
        diagnostics.push(wrong("a direction cannot have length zero".to_owned()));
    }
    vector.map(|vector| Spanned::new(vector, node.span))
}

/// The vector of length one; none where the length is zero, or too small or large to tell the direction.
pub(super) fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(vector, vector).sqrt();
    (length.is_normal()).then(|| vector.map(|component| component / length))
}

/// The inner product.
pub(super) fn dot(left: [f64; 3], right: [f64; 3]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

/// The direction in which the tool moves relative to the part, or about which it turns, while the axis runs in its
/// positive sense; all other axes at zero.
pub fn own_direction(equations: &Equations, axis: usize) -> Option<[f64; 3]> {
    let letter = &equations.axes.get(axis)?.letter;
    let mut links = equations.links.iter();
    let link = links.find(|link| link.kind.letter().is_some_and(|own| own.to_string() == *letter))?;
    let on_part = link.branch == Branch::Workpiece;
    let sign = if (link.along.sign < 0) == on_part { 1.0 } else { -1.0 };
    let mut direction = [0.0; 3];
    if let Some(component) = direction.get_mut(link.along.axis.index()) {
        *component = sign;
    }
    // Bodies that are turned for good carry what stands on them: the axis, and the part.
    let carrying = |body: &&Link, branch| body.branch == branch && !body.turns_back();
    let before = equations.links.iter().take_while(|body| body.id != link.id);
    let before: Vec<&Link> = before.filter(|body| carrying(body, link.branch)).collect();
    let in_bed =
        before.into_iter().rev().fold(link.turned.carry(direction), |found, body| body.turned.carry(found));
    let to_part = equations.links.iter().filter(|body| carrying(body, Branch::Workpiece));
    Some(to_part.fold(in_bed, |found, body| body.turned.carry_back(found)))
}
