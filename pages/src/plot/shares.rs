//! Shares. In: wholes, each of parts that are shares of it. Out: for each whole a flight of bars: each part begins where the part
//! before it ends, and has its name and number above it, so that it is told without a colour.

use super::Plot;
use super::axis::Axis;
use super::frame::{Head, LINE, WIDTH};
use super::look::Tone;
use super::scale::Scale;
use super::series::{rectangle, straight};
use super::words;
use crate::svg::Drawing;

/// One part of a whole.
#[derive(Clone, Debug)]
pub struct Part {
    /// What it is.
    pub label: String,
    /// How much of the whole it is: 1 is all of it.
    pub share: f64,
    /// What stands behind its number, such as its size in a unit; empty for nothing.
    pub note: String,
    /// Its colour.
    pub tone: Tone,
}

/// What is divided.
#[derive(Clone, Debug)]
pub struct Whole {
    /// What it is.
    pub label: String,
    /// Its parts, in order.
    pub parts: Vec<Part>,
}

/// Wholes below one another, with one axis in per cent.
#[derive(Clone, Debug)]
pub struct Shares {
    title: String,
    axis: Axis,
    wholes: Vec<Whole>,
}

impl Shares {
    /// Wholes, the first uppermost; `of` is what the shares are shares of.
    pub fn new(title: &str, of: &str, wholes: Vec<Whole>) -> Self {
        let axis = Axis::exactly(&format!("share of {of}"), "%").reaching(0.0).reaching(100.0);
        Self { title: title.to_owned(), axis, wholes }
    }

    /// All of it in words, for a reader without sight.
    fn description(&self) -> String {
        let sentence = |whole: &Whole| {
            let parts: Vec<String> =
                whole.parts.iter().map(|part| format!("{} {}", part.label, number(part))).collect();
            format!("{}: {}.", whole.label, parts.join("; "))
        };
        self.wholes.iter().map(sentence).collect::<Vec<_>>().join(" ")
    }
}

/// How high a bar is with its name.
const ROW: f64 = 32.0;
const THICK: f64 = 10.0;
/// How high the name of a whole is.
const NAME: f64 = 22.0;
const EDGE: f64 = 10.0;

impl Plot for Shares {
    fn draw(&self) -> Drawing {
        let axis = self.axis.cover(std::iter::empty(), 6);
        let head = Head::new(&self.title, "", Vec::new(), WIDTH);
        let scale = axis.scale(EDGE, WIDTH - 2.0 * EDGE);
        let top = head.height() + 4.0;
        let parts = self.wholes.iter().map(|whole| whole.parts.len()).sum();
        let bottom = top + NAME * super::ticks::count(self.wholes.len()) + ROW * super::ticks::count(parts);
        let mut drawing = Drawing::new(WIDTH, bottom + 2.0 * LINE + 8.0, &self.title);
        drawing.describe(&self.description());
        head.paint(&mut drawing);
        for (tick, text) in axis.ticks.values.iter().zip(&axis.ticks.texts) {
            let Some(x) = scale.shown(*tick) else { continue };
            straight(&mut drawing, if *tick == 0.0 { "f" } else { "g" }, (x, top), (x, bottom + 4.0));
            drawing.text((x, bottom + 17.0), "mid", text);
        }
        drawing.text((EDGE, bottom + 34.0), "", &axis.title);
        if self.wholes.is_empty() {
            drawing.text((EDGE + 6.0, top + 20.0), "q", "no data");
        }
        let mut y = top;
        for whole in &self.wholes {
            drawing.text((EDGE + 4.0, y + 15.0), "t o", &words::cut(&whole.label, WIDTH - 3.0 * EDGE));
            y += NAME;
            let mut begun = 0.0;
            for part in &whole.parts {
                bar(&mut drawing, &scale, part, (begun, y));
                begun += part.share;
                y += ROW;
            }
        }
        drawing
    }
}

/// A part from where the last one ended, its name and number above it.
fn bar(drawing: &mut Drawing, scale: &Scale, part: &Part, (begun, y): (f64, f64)) {
    let number = number(part);
    let room = WIDTH - 4.0 * EDGE - words::width(&number);
    let text = format!("{}: {number}", words::cut(&part.label, room));
    drawing.text((EDGE + 4.0, y + 12.0), "o", &text);
    if let (Some(from), Some(to)) = (scale.held(100.0 * begun), scale.held(100.0 * (begun + part.share))) {
        rectangle(drawing, &format!("m {}", part.tone.class()), (from, y + 17.0), (to, y + 17.0 + THICK));
    }
}

/// The share in per cent and the note.
fn number(part: &Part) -> String {
    let share = super::Unit::exactly("%").text(100.0 * part.share, 3);
    if part.note.is_empty() { share } else { format!("{share}, {}", part.note) }
}
