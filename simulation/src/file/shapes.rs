//! The shape of a path. In: the one key of the file that names it. Out: its geometry.

use model_dsl::diagnostic::Diagnostic;
use model_dsl::quantity::{self, Dimension};
use model_dsl::source::Span;
use model_dsl::yaml::Node;

use super::section::{Context, Section, list, named, word};
use crate::path::{Shape, Stations, Stroke};

/// The keys that name a shape.
pub(super) const SHAPES: [&str; 7] = ["line", "circle", "diamond", "grid", "spiral", "points", "still"];

/// Reads a shape by its key.
pub(super) fn read(key: &str, node: &Node, name: Span, context: &mut Context<'_>) -> Option<Shape> {
    match key {
        "line" => line(node, name, context),
        "circle" => circle(node, name, context),
        "diamond" => diamond(node, name, context),
        "grid" => grid(node, name, context),
        "spiral" => spiral(node, name, context),
        "points" => points(node, context),
        _ => {
            let time = context.size(node, Dimension::TIME, "`still`")?;
            Some(Shape::Still { time: context.bounded(time, node.span, "`still`", false)? })
        }
    }
}

fn line(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Shape> {
    let known = ["axis", "from", "to", "back", "overrun", "stations"];
    let section = Section::open(node, name, "`line`", &known, context)?;
    let strokes = strokes(&section, context);
    let back = match section.get("back") {
        Some(node) => {
            context.choice(node, "`true` or `false`", &["true", "false"]).map(|word| word == "true")
        }
        None => Some(true),
    };
    let angular = strokes.iter().flatten().all(|stroke| context.rotary(stroke.axis)) && strokes.is_some();
    let dimension = if angular { Dimension::ANGLE } else { Dimension::LENGTH };
    let overrun = section.not_negative("overrun", dimension, 0.0, context);
    let stations = section.part("stations", |node, name| stations(node, name, context));
    Some(Shape::Line { strokes: strokes?, back: back?, overrun: overrun?, stations: stations? })
}

/// `axis`, `from` and `to`; or `from` and `to` as mappings of axes to positions.
fn strokes(section: &Section<'_, '_>, context: &mut Context<'_>) -> Option<Vec<Stroke>> {
    let (from, to) = (section.need("from", context), section.need("to", context));
    let (from, to) = (from?, to?);
    if let Some(node) = section.get("axis") {
        let letter = word(node, "`axis` of `line`", context)?;
        let axis = context.axis(letter.value, letter.span)?;
        let dimension = context.dimension(axis);
        let from = context.size(from, dimension, "`from` of `line`");
        let to = context.size(to, dimension, "`to` of `line`");
        return Some(vec![Stroke { axis, from: from?, to: to? }]);
    }
    let (start, end) = (place(from, "`from` of `line`", context)?, place(to, "`to` of `line`", context)?);
    let strokes = start.iter().map(|(axis, from, span)| match end.iter().find(|(other, ..)| other == axis) {
        Some((_, to, _)) => Some(Stroke { axis: *axis, from: *from, to: *to }),
        None => {
            context.report(one_ended(*span));
            None
        }
    });
    let strokes: Vec<Option<Stroke>> = strokes.collect();
    let mut alone = end.iter().filter(|(axis, ..)| !start.iter().any(|(other, ..)| other == axis));
    if let Some((.., span)) = alone.next() {
        context.report(one_ended(*span));
        return None;
    }
    strokes.into_iter().collect()
}

fn one_ended(span: Span) -> Diagnostic {
    Diagnostic::error("E0710", span, "this axis has only one end of the line")
        .help("name it in both `from` and `to`; if it only stands still, name it in `at`")
}

/// A mapping of axes to positions.
fn place(node: &Node, what: &str, context: &mut Context<'_>) -> Option<Vec<(usize, f64, Span)>> {
    let example = "{X: 0 mm, Y: 0 mm}";
    let entries = named(node, &format!("{what} without `axis`"), example, context)?;
    let read: Vec<_> = entries
        .iter()
        .map(|(letter, node)| {
            let axis = context.axis(&letter.value, letter.span)?;
            let words = format!("the position of {}", letter.value);
            let position = context.size(node, context.dimension(axis), &words)?;
            Some((axis, position, letter.span))
        })
        .collect();
    read.into_iter().collect()
}

fn stations(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Stations> {
    let section = Section::open(node, name, "`stations`", &["count", "dwell", "readings"], context)?;
    let count =
        section.need("count", context).and_then(|node| context.whole(node, "`count` of `stations`", 2));
    let dwell = section.positive("dwell", Dimension::TIME, context);
    let readings = section.whole_or("readings", 1, 1, context);
    Some(Stations { count: count?, dwell: dwell?, readings: readings? })
}

fn circle(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Shape> {
    let known = ["plane", "radius", "start", "overshoot", "directions"];
    let section = Section::open(node, name, "`circle`", &known, context)?;
    let plane = plane(&section, context);
    let radius = section.positive("radius", Dimension::LENGTH, context);
    let start = section.quantity_or("start", Dimension::ANGLE, 0.0, context);
    let overshoot = section.not_negative("overshoot", Dimension::ANGLE, 0.0, context);
    let counterclockwise = match section.get("directions") {
        Some(node) => directions(node, context),
        None => Some(vec![true, false]),
    };
    Some(Shape::Circle {
        plane: plane?,
        radius: radius?,
        start: start?,
        overshoot: overshoot?,
        counterclockwise: counterclockwise?,
    })
}

fn directions(node: &Node, context: &mut Context<'_>) -> Option<Vec<bool>> {
    let items = list(node, "`directions` of `circle`", context)?;
    if items.is_empty() {
        let mistake = Diagnostic::error("E0704", node.span, "`directions` of `circle` is empty");
        context.report(mistake.help("write `[ccw, cw]`, or one of them"));
        return None;
    }
    let words: Vec<_> = items.iter().map(|item| context.choice(item, "a sense", &["ccw", "cw"])).collect();
    words.into_iter().map(|word| word.map(|word| word == "ccw")).collect()
}

fn diamond(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Shape> {
    let section = Section::open(node, name, "`diamond`", &["plane", "radius"], context)?;
    let plane = plane(&section, context);
    let radius = section.positive("radius", Dimension::LENGTH, context);
    Some(Shape::Diamond { plane: plane?, radius: radius? })
}

fn grid(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Shape> {
    let section = Section::open(node, name, "`grid`", &["plane", "from", "to", "lines"], context)?;
    let plane = plane(&section, context);
    let mut corner = |key: &str| section.need(key, context).and_then(|node| pair(node, key, context));
    let (from, to) = (corner("from"), corner("to"));
    let lines = section.need("lines", context).and_then(|node| context.whole(node, "`lines` of `grid`", 2));
    Some(Shape::Grid { plane: plane?, from: from?, to: to?, lines: lines? })
}

fn pair(node: &Node, key: &str, context: &mut Context<'_>) -> Option<[f64; 2]> {
    let words = format!("`{key}` of `grid`");
    let items = list(node, &words, context)?;
    let [first, second] = items else {
        let mistake = Diagnostic::error("E0704", node.span, format!("{words} must have two positions"));
        context.report(mistake.help("write one for each axis of the plane: `[0 mm, 0 mm]`"));
        return None;
    };
    let first = context.size(first, Dimension::LENGTH, &words);
    let second = context.size(second, Dimension::LENGTH, &words);
    Some([first?, second?])
}

fn spiral(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Shape> {
    let section = Section::open(node, name, "`spiral`", &["plane", "inner", "outer", "turns"], context)?;
    let plane = plane(&section, context);
    let inner = section.not_negative("inner", Dimension::LENGTH, 0.0, context);
    let outer = section.positive("outer", Dimension::LENGTH, context);
    let turns = section.need("turns", context).and_then(|node| {
        let turns = quantity::read_number(node, "`turns` of `spiral`", context.diagnostics)?;
        context.bounded(turns.value, turns.span, "`turns` of `spiral`", false)
    });
    Some(Shape::Spiral { plane: plane?, inner: inner?, outer: outer?, turns: turns? })
}

/// Two slides: `XY`.
fn plane(section: &Section<'_, '_>, context: &mut Context<'_>) -> Option<[usize; 2]> {
    let node = section.need("plane", context)?;
    let written = word(node, &section.words("plane"), context)?;
    let mut letters = written.value.chars();
    let (Some(first), Some(second), None) = (letters.next(), letters.next(), letters.next()) else {
        let message = format!("`{}` is not a plane", written.value);
        context
            .report(Diagnostic::error("E0709", written.span, message).help("write two axes, such as `XY`"));
        return None;
    };
    let first = context.axis(&first.to_string(), written.span);
    let second = context.axis(&second.to_string(), written.span);
    let plane = [first?, second?];
    if plane[0] == plane[1] || plane.iter().any(|axis| context.rotary(*axis)) {
        let message = format!("`{}` is not a plane", written.value);
        let mistake = Diagnostic::error("E0709", written.span, message);
        context.report(mistake.help("write two different slides, such as `XY`"));
        return None;
    }
    Some(plane)
}

fn points(node: &Node, context: &mut Context<'_>) -> Option<Shape> {
    let items = list(node, "`points`", context)?;
    if items.len() < 2 {
        let mistake = Diagnostic::error("E0704", node.span, "`points` needs at least two points");
        context.report(mistake.help("write `[{X: 0 mm}, {X: 100 mm}]`"));
        return None;
    }
    let points: Vec<_> = items.iter().map(|item| place(item, "a point", context)).collect();
    let points: Option<Vec<_>> = points.into_iter().collect();
    let bare = |point: Vec<(usize, f64, Span)>| point.into_iter().map(|(axis, at, _)| (axis, at)).collect();
    Some(Shape::Points(points?.into_iter().map(bare).collect()))
}
