//! Frames. In: a title, fitted axes, a legend. Out: where the region of the points lies, and everything around it.

use super::axis::Covered;
use super::legend::{self, Entry};
use super::scale::Scale;
use super::series::{rectangle, straight};
use super::words;
use crate::svg::Drawing;

/// How wide a drawing is by default: two stand beside each other on a page, and one on a telephone.
pub(super) const WIDTH: f64 = 480.0;
/// How high the region of the points is by default.
pub(super) const HEIGHT: f64 = 210.0;
/// How high a line of text is.
pub(super) const LINE: f64 = 16.0;
/// Room at the edges.
const EDGE: f64 = 10.0;

/// Title, lines below it and legend: what every plot has above it.
pub(super) struct Head<'p> {
    title: Vec<String>,
    subtitle: Vec<String>,
    entries: Vec<Entry<'p>>,
    room: f64,
}

impl<'p> Head<'p> {
    pub(super) fn new(title: &str, subtitle: &str, entries: Vec<Entry<'p>>, width: f64) -> Self {
        let room = width - 2.0 * EDGE;
        Self { title: words::lines(title, room), subtitle: words::lines(subtitle, room), entries, room }
    }

    pub(super) fn height(&self) -> f64 {
        let lines = self.title.len() + self.subtitle.len();
        let text = if lines == 0 { 0.0 } else { LINE * super::ticks::count(lines) };
        text + legend::height(&self.entries, self.room) + 6.0
    }

    pub(super) fn paint(&self, drawing: &mut Drawing) {
        let mut y = 0.0;
        let lines =
            self.title.iter().map(|line| ("t", line)).chain(self.subtitle.iter().map(|line| ("q", line)));
        for (class, line) in lines {
            y += LINE;
            drawing.text((EDGE, y - 3.0), class, line);
        }
        legend::paint(drawing, &self.entries, (EDGE, y + 2.0), self.room);
    }
}

/// The region of the points with its axes.
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
    pub(super) x: Scale,
    pub(super) y: Scale,
}

impl Frame {
    /// The region below `top`, so high and wide; the numbers of the axes stand left of it and below.
    pub(super) fn new(x: &Covered, y: &Covered, top: f64, width: f64, height: f64) -> Self {
        let numbers = y.ticks.texts.iter().map(|text| words::width(text)).fold(0.0, f64::max);
        let last = x.ticks.texts.last().map_or(0.0, |text| words::width(text) / 2.0);
        let (left, right) = (EDGE + numbers + 6.0, width - EDGE.max(last));
        let top = top + LINE + 6.0;
        let bottom = top + height;
        Self { left, right, top, bottom, x: x.scale(left, right), y: y.scale(bottom, top) }
    }

    /// What stands below the region: numbers and title.
    pub(super) const BELOW: f64 = 40.0;

    /// Grid, numbers and titles.
    pub(super) fn paint(&self, drawing: &mut Drawing, x: &Covered, y: &Covered) {
        for (tick, text) in y.ticks.values.iter().zip(&y.ticks.texts) {
            let Some(at) = self.y.shown(*tick) else { continue };
            let class = if *tick == 0.0 { "f" } else { "g" };
            straight(drawing, class, (self.left, at), (self.right, at));
            drawing.text((self.left - 6.0, at + 4.0), "e", text);
        }
        let mut free = f64::NEG_INFINITY;
        for (tick, text) in x.ticks.values.iter().zip(&x.ticks.texts) {
            let Some(at) = self.x.shown(*tick) else { continue };
            straight(drawing, "g", (at, self.top), (at, self.bottom + 4.0));
            let half = words::width(text) / 2.0;
            if at - half > free {
                drawing.text((at, self.bottom + 17.0), "mid", text);
                free = at + half + 6.0;
            }
        }
        rectangle(drawing, "f", (self.left, self.top), (self.right, self.bottom));
        drawing.text((EDGE, self.top - 10.0), "", &y.title);
        drawing.text((self.right, self.bottom + 34.0), "e", &x.title);
        if x.empty || y.empty {
            let middle = ((self.left + self.right) / 2.0, (self.top + self.bottom) / 2.0);
            drawing.text(middle, "q mid", "no data");
        }
    }
}
