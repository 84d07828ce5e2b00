//! A crossed transmission. In: `transmission`, for each motor a sum of slides. Out: its motors, each with what its error does to the
//! slides: the inverse of the map, exact.

use num_traits::{One, Zero};

use super::super::draft::Chain;
use super::super::fields::{self, text};
use super::{Motor, Moved, signed, slide};
use crate::algebra::{Rational, Symbol};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::expression;
use crate::machine::MotionKind;
use crate::source::{Span, Spanned};
use crate::yaml::Node;

/// The motors of a machine file; none where one of them is wrong, which is reported.
pub(super) fn read(node: Option<&Node>, chain: &Chain<'_>, diagnostics: &mut Diagnostics) -> Vec<Motor> {
    let Some(node) = node else { return Vec::new() };
    let Some(entries) = node.entries() else {
        let message = format!("`transmission` must be a mapping of motors, found {}", node.kind_name());
        diagnostics.push(
            Diagnostic::error("E0103", node.span, message).help("write `transmission: {A: X + Y, B: X - Y}`"),
        );
        return Vec::new();
    };
    let read = |(name, value): &(Spanned<String>, Node), diagnostics: &mut Diagnostics| {
        Some((name.clone(), sum(&name.value, value, chain, diagnostics)?))
    };
    let rows: Vec<_> = entries.iter().filter_map(|entry| read(entry, diagnostics)).collect();
    if rows.len() != entries.len() {
        return Vec::new();
    }
    inverted(rows, fields::place(node), chain, diagnostics).unwrap_or_default()
}

/// Where a motor stands: slides by their numbers, each with how far the motor goes for a mm of it.
type Sum = Vec<(usize, Rational)>;

fn sum(motor: &str, node: &Node, chain: &Chain<'_>, diagnostics: &mut Diagnostics) -> Option<Sum> {
    let written = text(node, "a sum of slides", diagnostics)?;
    let refused = |reason: String| {
        Diagnostic::error(
            "E0149",
            node.span,
            format!("`{written}` does not give the position of motor {motor}"),
        )
        .label(reason)
        .help("write a sum of slides with optional factors, such as `X + Y` or `2*X - Y`")
    };
    let mut named = |name: &str| Some(Symbol::Position(name.into()));
    let polynomial = match expression::parse(written, &mut named) {
        Ok(polynomial) => polynomial,
        Err(mistake) => {
            diagnostics.push(refused(mistake.message));
            return None;
        }
    };
    let mut sum = Sum::new();
    for (monomial, weight) in polynomial.terms() {
        let [(Symbol::Position(name), 1)] = monomial.factors() else {
            let reason =
                if monomial.is_one() { "an offset is not a travel" } else { "this is not a sum of slides" };
            diagnostics.push(refused(reason.to_owned()));
            return None;
        };
        sum.push((slide(name, node.span, chain, diagnostics)?, weight.clone()));
    }
    if sum.is_empty() {
        diagnostics.push(refused("it does not move any slide".to_owned()));
        return None;
    }
    Some(sum)
}

/// The motors, from where each stands; none where they do not make the motion of their slides.
fn inverted(
    rows: Vec<(Spanned<String>, Sum)>,
    span: Span,
    chain: &Chain<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Motor>> {
    let mut slides: Vec<usize> = rows.iter().flat_map(|(_, sum)| sum.iter().map(|(link, _)| *link)).collect();
    slides.sort_unstable();
    slides.dedup();
    let weight = |sum: &Sum, link: usize| {
        sum.iter().find(|(own, _)| *own == link).map_or_else(Rational::zero, |(_, weight)| weight.clone())
    };
    let matrix = rows.iter().map(|(_, sum)| slides.iter().map(|link| weight(sum, *link)).collect()).collect();
    let inverse = (rows.len() == slides.len()).then(|| inverse(matrix)).flatten();
    let Some(inverse) = inverse else {
        let letters: Vec<&str> = slides.iter().map(|link| chain.links[*link].link.id.as_str()).collect();
        let message = format!("{} motors do not determine the motion of {}", rows.len(), letters.join(", "));
        diagnostics.push(
            Diagnostic::error("E0149", span, message)
                .label("the positions of the motors must determine those of the slides, and vice versa")
                .help(
                    "give as many motors as slides that they move, and none that is a sum of the others; list two motors of one \
                     slide under `drives`",
                ),
        );
        return None;
    };
    let moved = |motor: usize| {
        slides.iter().zip(&inverse).filter_map(move |(link, row)| {
            let along = chain.links.get(*link)?.link.along;
            let weight = row.get(motor)? * signed(along.sign);
            (!weight.is_zero()).then_some(Moved { link: *link, kind: MotionKind::Linear(along.axis), weight })
        })
    };
    let motor = |(number, (name, follows)): (usize, (Spanned<String>, Sum))| Motor {
        name,
        follows,
        moves: moved(number).collect(),
        beam: None,
    };
    Some(rows.into_iter().enumerate().map(motor).collect())
}

/// The inverse of a square matrix, by Gauss and Jordan; none where there is none.
fn inverse(matrix: Vec<Vec<Rational>>) -> Option<Vec<Vec<Rational>>> {
    let size = matrix.len();
    let unit = |row: usize| {
        (0..size).map(move |column| if column == row { Rational::one() } else { Rational::zero() })
    };
    let mut rows: Vec<Vec<Rational>> =
        matrix.into_iter().enumerate().map(|(row, own)| own.into_iter().chain(unit(row)).collect()).collect();
    for column in 0..size {
        let pivot = (column..size).find(|row| !rows[*row][column].is_zero())?;
        rows.swap(column, pivot);
        let scale = rows[column][column].clone();
        rows[column].iter_mut().for_each(|entry| *entry = &*entry / &scale);
        let own = rows[column].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(row, _)| *row != column) {
            let factor = row[column].clone();
            row.iter_mut().zip(&own).for_each(|(entry, own)| *entry = &*entry - &factor * own);
        }
    }
    Some(rows.into_iter().map(|row| row[size..].to_vec()).collect())
}
