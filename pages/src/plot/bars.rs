//! Bars. In: names and numbers. Out: horizontal bars, each below its name and with its number behind it.

use super::Plot;
use super::axis::Axis;
use super::frame::{Head, LINE, WIDTH};
use super::look::Tone;
use super::series::{rectangle, straight};
use super::words;
use crate::svg::Drawing;

/// One bar.
#[derive(Clone, Debug)]
pub struct Bar {
    /// What it is.
    pub label: String,
    /// How long it is, in the unit of the axis.
    pub value: f64,
    /// A second number, drawn as an upright stroke: the greatest value beside the rms.
    pub further: Option<f64>,
}

/// Horizontal bars with one axis.
#[derive(Clone, Debug)]
pub struct Bars {
    title: String,
    subtitle: String,
    axis: Axis,
    bars: Vec<Bar>,
    width: f64,
}

impl Bars {
    /// Bars along an axis, the first uppermost; the subtitle tells what bar and stroke are.
    pub fn new(title: &str, subtitle: &str, axis: Axis, bars: Vec<Bar>) -> Self {
        Self { title: title.to_owned(), subtitle: subtitle.to_owned(), axis, bars, width: WIDTH }
    }

    /// The width of the drawing, in pixels.
    pub fn wide(self, width: f64) -> Self {
        Self { width: width.max(200.0), ..self }
    }
}

/// How high a bar is, with its name and the room below.
const ROW: f64 = 36.0;
const THICK: f64 = 11.0;
const EDGE: f64 = 10.0;

impl Plot for Bars {
    fn draw(&self) -> Drawing {
        let numbers = self.bars.iter().flat_map(|bar| [Some(bar.value), bar.further]).flatten();
        let axis = self.axis.clone().reaching(0.0).cover(numbers.filter(|number| number.is_finite()), 6);
        let head = Head::new(&self.title, &self.subtitle, Vec::new(), self.width);
        let texts: Vec<String> = self.bars.iter().map(|bar| numbers_of(bar, &axis.unit)).collect();
        let room = texts.iter().map(|text| words::width(text)).fold(0.0, f64::max) + 12.0;
        let scale = axis.scale(EDGE, (self.width - EDGE - room).max(EDGE + 60.0));
        let top = head.height() + 4.0;
        let bottom = top + ROW * super::ticks::count(self.bars.len());
        let mut drawing = Drawing::new(self.width, bottom + 2.0 * LINE + 8.0, &self.title);
        head.paint(&mut drawing);
        for (tick, text) in axis.ticks.values.iter().zip(&axis.ticks.texts) {
            let Some(x) = scale.shown(*tick) else { continue };
            straight(&mut drawing, if *tick == 0.0 { "f" } else { "g" }, (x, top), (x, bottom + 4.0));
            drawing.text((x, bottom + 17.0), "mid", text);
        }
        drawing.text((EDGE, bottom + 34.0), "", &axis.title);
        if self.bars.is_empty() {
            drawing.text((EDGE + 6.0, top + 20.0), "q", "no data");
        }
        let mut y = top;
        for (bar, text) in self.bars.iter().zip(&texts) {
            drawing.text((EDGE + 4.0, y + 14.0), "", &words::cut(&bar.label, self.width - 2.0 * EDGE));
            let (from, to) = (y + 19.0, y + 19.0 + THICK);
            let mut end = scale.held(0.0).unwrap_or(EDGE);
            if let (Some(zero), Some(x)) = (scale.held(0.0), scale.place(bar.value)) {
                rectangle(&mut drawing, &format!("m {}", Tone::One.class()), (zero, from), (x, to));
                end = end.max(x);
            }
            if let Some(x) = bar.further.and_then(|further| scale.place(further)) {
                straight(&mut drawing, &super::series::stroke(Tone::Ink), (x, from - 2.0), (x, to + 2.0));
                end = end.max(x);
            }
            drawing.text((end + 8.0, to - 1.5), "", text);
            y += ROW;
        }
        drawing
    }
}

fn numbers_of(bar: &Bar, unit: &super::Unit) -> String {
    let value = unit.text(bar.value, 3);
    match bar.further {
        Some(further) => format!("{value}; {}", unit.text(further, 3)),
        None => value,
    }
}
