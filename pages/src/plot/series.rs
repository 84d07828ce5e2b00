//! Series. In: points and a name. Out: marks or a line in a drawing.

use super::look::{Look, Tone};
use super::path;
use crate::svg::Drawing;

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draw {
    /// A mark at each point.
    Marks,
    /// Hollow marks: what was held out.
    Hollow,
    /// A line through the points; what is not finite is a gap.
    Line,
    /// Both.
    MarkedLine,
}

/// Points of one kind.
#[derive(Clone, Debug)]
pub struct Series {
    pub(super) name: String,
    pub(super) points: Vec<(f64, f64)>,
    pub(super) look: Look,
    pub(super) draw: Draw,
}

impl Series {
    /// A series; a name that is empty stands in no legend.
    pub fn new(name: &str, look: Look, draw: Draw, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.to_owned(), points, look, draw }
    }
}

impl Look {
    /// Draws places in this look.
    pub(super) fn paint(self, drawing: &mut Drawing, draw: Draw, places: &[Option<(f64, f64)>]) {
        if matches!(draw, Draw::Line | Draw::MarkedLine) {
            self.line(drawing, &path::line(places.iter().copied()));
        }
        if draw != Draw::Line {
            let hollow = draw == Draw::Hollow || !self.mark.closed();
            let marks = path::marks(self.mark, places.iter().flatten().copied());
            let class = format!("{} {}", if hollow { "h" } else { "m" }, self.tone.class());
            if !marks.is_empty() {
                drawing.element("path", &[("class", &class), ("d", &marks)]);
            }
        }
    }

    fn line(self, drawing: &mut Drawing, path: &str) {
        if path.is_empty() {
            return;
        }
        let class = format!("l {}", self.tone.class());
        let mut attributes = vec![("class", class.as_str()), ("d", path)];
        if !self.dash.is_empty() {
            attributes.push(("stroke-dasharray", self.dash));
        }
        drawing.element("path", &attributes);
    }
}

/// A straight line of the drawing's own.
pub(super) fn straight(drawing: &mut Drawing, class: &str, from: (f64, f64), to: (f64, f64)) {
    let path = path::line([Some(from), Some(to)].into_iter());
    drawing.element("path", &[("class", class), ("d", &path)]);
}

/// A rectangle between two corners.
pub(super) fn rectangle(drawing: &mut Drawing, class: &str, one: (f64, f64), other: (f64, f64)) {
    let numbers = [one.0.min(other.0), one.1.min(other.1), (other.0 - one.0).abs(), (other.1 - one.1).abs()];
    let [x, y, width, height] = numbers.map(crate::svg::number);
    drawing
        .element("rect", &[("class", class), ("x", &x), ("y", &y), ("width", &width), ("height", &height)]);
}

/// The class of a line in a tone.
pub(super) fn stroke(tone: Tone) -> String {
    format!("l {}", tone.class())
}
