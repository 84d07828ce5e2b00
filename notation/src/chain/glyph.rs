//! Frames and joints as pictures. In: a direction of the machine and a place on the page. Out: strokes.
//!
//! The machine is seen from its front: X to the right, Z upwards, Y into the page, drawn upwards to the right.

use std::fmt::Write as _;

use pages::svg::{Drawing, number};

use model_dsl::algebra::Axis;
use model_dsl::machine::{Link, LinkKind};

/// Half the length of a slide's arrow, and the radius of a rotation.
const SIZE: f64 = 24.0;
/// The length of an arm of a frame.
const ARM: f64 = 22.0;

type Point = (f64, f64);

/// A unit length in a direction of the machine, on the page.
fn seen(axis: Axis) -> Point {
    match axis {
        Axis::X => (1.0, 0.0),
        Axis::Y => (0.62, -0.5),
        Axis::Z => (0.0, -1.0),
    }
}

fn along((x, y): Point, (dx, dy): Point, length: f64) -> Point {
    (x + dx * length, y + dy * length)
}

/// The frame of a link: three arrows from its origin.
pub(super) fn frame(drawing: &mut Drawing, origin: Point) {
    for axis in Axis::ALL {
        let direction = seen(axis);
        let tip = along(origin, direction, ARM);
        stroke(drawing, "frame", &[origin, tip], false);
        arrowhead(drawing, "frame", tip, direction, 4.0);
        let (x, y) = along(tip, direction, 6.0);
        let aside = if axis == Axis::Z { 0.0 } else { 3.5 };
        drawing.text((x, y + aside), "quiet middle", &axis.to_string());
    }
}

/// The joint of a link about a point.
pub(super) fn joint(drawing: &mut Drawing, link: &Link, centre: Point) {
    let variable = format!("+{}", link.variable());
    match link.kind {
        LinkKind::Slide(_) => slide(drawing, link, centre, &variable),
        LinkKind::Rotary(_) => turn(drawing, link, centre, Some(&variable)),
        LinkKind::Spindle => turn(drawing, link, centre, None),
        LinkKind::Fixed => weld(drawing, centre),
        LinkKind::Tool => tip(drawing, centre),
        LinkKind::Part => block(drawing, centre),
    }
}

/// A carriage on its line; the full arrowhead is where the programmed position grows.
fn slide(drawing: &mut Drawing, link: &Link, centre: Point, variable: &str) {
    let (dx, dy) = seen(link.along.axis);
    let sign = if link.along.sign < 0 { -1.0 } else { 1.0 };
    let forward = (dx * sign, dy * sign);
    let backward = (-forward.0, -forward.1);
    let (front, back) = (along(centre, forward, SIZE), along(centre, backward, SIZE));
    stroke(drawing, "joint", &[back, front], false);
    arrowhead(drawing, "solid", front, forward, 9.0);
    arrowhead(drawing, "hollow", back, backward, 7.0);
    let (x, y) = (number(centre.0 - 7.0), number(centre.1 - 5.0));
    drawing.element("rect", &[("class", "hollow"), ("x", &x), ("y", &y), ("width", "14"), ("height", "10")]);
    // Beside the full head, clear of the line.
    let label = match link.along.axis {
        Axis::X => (front.0, front.1 + 17.0),
        Axis::Y => (front.0 + 12.0 * sign, front.1 + 4.0),
        Axis::Z => (front.0 + 16.0, front.1 + 5.0 * sign),
    };
    drawing.text(label, "middle", variable);
}

/// An arc around an axis, with its head where the programmed angle grows; a spindle turns freely and has none.
fn turn(drawing: &mut Drawing, link: &Link, centre: Point, variable: Option<&str>) {
    let axis = link.along.axis;
    let direction = seen(axis);
    stroke(drawing, "frame", &[along(centre, direction, -SIZE), along(centre, direction, SIZE)], false);
    let sign = if link.along.sign < 0 { -1.0 } else { 1.0 };
    let (first, second) = (seen(axis.next()), seen(axis.next().next()));
    let at = |degrees: f64| {
        let angle = (sign * degrees).to_radians();
        let on_first = along(centre, first, 0.8 * SIZE * angle.cos());
        along(on_first, second, 0.8 * SIZE * angle.sin())
    };
    let whole = variable.is_none();
    let (start, end) = if whole { (0.0, 360.0) } else { (-60.0, 200.0) };
    let points: Vec<Point> =
        (0..=40).map(|step| at(start + (end - start) * f64::from(step) / 40.0)).collect();
    stroke(drawing, if whole { "joint free" } else { "joint" }, &points, whole);
    if let (Some(variable), [.., before, last]) = (variable, points.as_slice()) {
        let (dx, dy) = (last.0 - before.0, last.1 - before.1);
        let length = dx.hypot(dy).max(1e-6);
        arrowhead(
            drawing,
            "solid",
            along(*last, (dx / length, dy / length), 4.0),
            (dx / length, dy / length),
            9.0,
        );
        drawing.text((centre.0 + 36.0, centre.1 + 26.0), "middle", variable);
    }
}

/// A body that does not move against the one before it: a weld.
fn weld(drawing: &mut Drawing, (x, y): Point) {
    stroke(drawing, "joint", &[(x - 24.0, y + 12.0), (x + 24.0, y + 12.0)], false);
    stroke(drawing, "joint", &[(x, y + 12.0), (x, y - 18.0)], false);
    for side in [-1.0, 1.0] {
        filled(drawing, "solid", &[(x, y), (x, y + 12.0), (x + side * 12.0, y + 12.0)]);
    }
}

/// A tool, its tip downwards.
fn tip(drawing: &mut Drawing, (x, y): Point) {
    filled(drawing, "hollow", &[(x - 9.0, y - 18.0), (x + 9.0, y - 18.0), (x + 9.0, y), (x - 9.0, y)]);
    filled(drawing, "solid", &[(x - 9.0, y), (x + 9.0, y), (x, y + 20.0)]);
}

/// A part.
fn block(drawing: &mut Drawing, (x, y): Point) {
    let (left, right, top, bottom) = (x - 20.0, x + 20.0, y - 14.0, y + 14.0);
    filled(drawing, "hollow", &[(left, top), (right, top), (right, bottom), (left, bottom)]);
    for foot in [left, left + 14.0, left + 28.0] {
        stroke(drawing, "joint", &[(foot, bottom), (foot + 12.0, top)], false);
    }
}

/// An arrowhead with its point at the end of a line of a direction.
fn arrowhead(drawing: &mut Drawing, class: &str, point: Point, direction: Point, length: f64) {
    let (dx, dy) = direction;
    let size = dx.hypot(dy).max(1e-6);
    let forward = (dx / size, dy / size);
    let foot = along(point, forward, -length);
    let aside = (-forward.1, forward.0);
    let (left, right) = (along(foot, aside, 0.45 * length), along(foot, aside, -0.45 * length));
    filled(drawing, class, &[left, point, right]);
}

fn filled(drawing: &mut Drawing, class: &str, points: &[Point]) {
    stroke(drawing, class, points, true);
}

fn stroke(drawing: &mut Drawing, class: &str, points: &[Point], closed: bool) {
    let mut path = String::new();
    for (index, (x, y)) in points.iter().enumerate() {
        let command = if index == 0 { 'M' } else { 'L' };
        let _ = write!(path, "{command}{} {}", number(*x), number(*y));
    }
    if closed {
        path.push('Z');
    }
    drawing.element("path", &[("class", class), ("d", &path)]);
}
