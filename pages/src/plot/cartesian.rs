//! Plots with two axes. In: series, intervals, places with names. Out: a drawing.

use super::Plot;
use super::axis::{Axis, Covered};
use super::frame::{Frame, HEIGHT, Head, WIDTH};
use super::legend::Entry;
use super::series::{Series, rectangle, straight};
use super::words;
use crate::svg::Drawing;

/// The highest region of a plot whose axes have one scale.
const HIGHEST: f64 = 420.0;

/// An interval of one of the axes, drawn behind the points across the whole plot.
#[derive(Clone, Debug)]
pub struct Band {
    from: f64,
    to: f64,
    label: String,
    of_x: bool,
}

impl Band {
    /// From one number of the horizontal axis to another; the label stands at its top.
    pub fn of_x(from: f64, to: f64, label: &str) -> Self {
        Self { from, to, label: label.to_owned(), of_x: true }
    }

    /// The same of the vertical axis.
    pub fn of_y(from: f64, to: f64, label: &str) -> Self {
        Self { of_x: false, ..Self::of_x(from, to, label) }
    }
}

/// A place on the horizontal axis with a name above it, such as a frequency that was found.
#[derive(Clone, Debug)]
pub struct Line {
    at: f64,
    label: String,
}

impl Line {
    /// A vertical line at a number of the horizontal axis.
    pub fn new(at: f64, label: &str) -> Self {
        Self { at, label: label.to_owned() }
    }
}

/// A plot with two axes.
#[derive(Clone, Debug)]
pub struct Cartesian {
    title: String,
    subtitle: String,
    x: Axis,
    y: Axis,
    series: Vec<Series>,
    bands: Vec<Band>,
    lines: Vec<Line>,
    size: (f64, f64),
    equal: bool,
}

impl Cartesian {
    /// A plot of nothing yet.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        Self {
            title: title.to_owned(),
            subtitle: String::new(),
            x,
            y,
            series: Vec::new(),
            bands: Vec::new(),
            lines: Vec::new(),
            size: (WIDTH, HEIGHT),
            equal: false,
        }
    }

    /// What stands in smaller weight below the title, such as how many of the samples are shown.
    pub fn subtitle(self, subtitle: &str) -> Self {
        Self { subtitle: subtitle.to_owned(), ..self }
    }

    /// Adds a series in front of those that are there.
    pub fn series(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Adds an interval behind the points.
    pub fn band(mut self, band: Band) -> Self {
        self.bands.push(band);
        self
    }

    /// Adds a place with a name.
    pub fn line(mut self, line: Line) -> Self {
        self.lines.push(line);
        self
    }

    /// Width of the drawing, and height of the region of the points, in pixels.
    pub fn sized(self, width: f64, height: f64) -> Self {
        Self { size: (width.max(200.0), height.max(60.0)), ..self }
    }

    /// A mm is as long up as it is across, so that shapes keep theirs: the plot is as high as that makes it, within reason.
    pub fn equal(self) -> Self {
        Self { equal: true, ..self }
    }

    /// The subtitle, and how many points lie where the axes do not reach.
    fn told(&self, x: &Covered, y: &Covered) -> String {
        let points = self.series.iter().flat_map(|series| &series.points);
        let beyond = points.filter(|point| x.beyond(point.0) || y.beyond(point.1)).count();
        let told = match beyond {
            0 => return self.subtitle.clone(),
            1 => "1 point is outside the axes".to_owned(),
            more => format!("{more} points are outside the axes"),
        };
        if self.subtitle.is_empty() { told } else { format!("{}; {told}", self.subtitle) }
    }

    fn entries(&self) -> Vec<Entry<'_>> {
        let named = self.series.iter().filter(|series| !series.name.is_empty());
        named.map(|series| Entry { name: &series.name, look: series.look, draw: series.draw }).collect()
    }
}

impl Plot for Cartesian {
    fn draw(&self) -> Drawing {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let whole = || points().filter(|(x, y)| x.is_finite() && y.is_finite());
        let marked = self.lines.iter().map(|line| line.at);
        let x = self.x.cover(whole().map(|point| point.0).chain(marked), 8);
        let y = self.y.cover(whole().map(|point| point.1), 6);
        let (width, height) = if self.equal { alike(&x, &y, self.size) } else { self.size };
        let subtitle = self.told(&x, &y);
        let head = Head::new(&self.title, &subtitle, self.entries(), width);
        let labels = Labels::new(&self.lines, |at| Frame::new(&x, &y, 0.0, width, height).x.place(at), width);
        let frame = Frame::new(&x, &y, head.height() + labels.height(), width, height);
        let mut drawing = Drawing::new(width, frame.bottom + Frame::BELOW, &self.title);
        head.paint(&mut drawing);
        self.bands.iter().for_each(|band| paint_band(&mut drawing, &frame, band));
        frame.paint(&mut drawing, &x, &y);
        for series in &self.series {
            let place = |point: &(f64, f64)| Some((frame.x.place(point.0)?, frame.y.place(point.1)?));
            let places: Vec<_> = series.points.iter().map(place).collect();
            series.look.paint(&mut drawing, series.draw, &places);
        }
        labels.paint(&mut drawing, &frame);
        drawing
    }
}

/// The size at which both axes have one scale; where it would be too high the plot gets narrower.
fn alike(x: &Covered, y: &Covered, (width, height): (f64, f64)) -> (f64, f64) {
    let frame = Frame::new(x, y, 0.0, width, height);
    let across = frame.right - frame.left;
    let ratio = y.extent() / x.extent();
    if !(ratio.is_finite() && ratio > 0.0) {
        return (width, height);
    }
    let high = (across * ratio).min(HIGHEST);
    (width - across + high / ratio, high)
}

fn paint_band(drawing: &mut Drawing, frame: &Frame, band: &Band) {
    let scale = if band.of_x { &frame.x } else { &frame.y };
    let (Some(from), Some(to)) = (scale.held(band.from), scale.held(band.to)) else { return };
    let (one, other) = if band.of_x {
        ((from, frame.top), (to, frame.bottom))
    } else {
        ((frame.left, from), (frame.right, to))
    };
    rectangle(drawing, "b", one, other);
    let room = frame.right - one.0.min(other.0) - 6.0;
    let at = (one.0.min(other.0) + 3.0, one.1.min(other.1) + 13.0);
    drawing.text(at, "q o", &words::cut(&band.label, room));
}

/// Names of places above the region, in as many rows as it takes to keep them apart.
struct Labels<'l> {
    placed: Vec<(f64, f64, &'l str)>,
    rows: f64,
    width: f64,
}

/// Where a name begins: right of its line, or left of it where there is no room.
fn beside(at: f64, room: f64, width: f64) -> f64 {
    if at + 3.0 + room <= width - 2.0 { at + 3.0 } else { (at - 3.0 - room).max(2.0) }
}

impl<'l> Labels<'l> {
    fn new(lines: &'l [Line], place: impl Fn(f64) -> Option<f64>, width: f64) -> Self {
        let mut lines: Vec<(f64, &str)> =
            lines.iter().filter_map(|line| Some((place(line.at)?, line.label.as_str()))).collect();
        lines.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut ends: Vec<f64> = Vec::new();
        let mut placed = Vec::new();
        for (at, label) in lines {
            let room = words::width(label);
            let left = beside(at, room, width);
            let row = ends.iter().position(|end| *end < left).unwrap_or(ends.len());
            ends.resize(ends.len().max(row + 1), 0.0);
            ends[row] = left + room + 8.0;
            placed.push((at, if row == 0 { 0.0 } else { super::ticks::count(row) }, label));
        }
        Self { rows: if ends.is_empty() { 0.0 } else { super::ticks::count(ends.len()) }, placed, width }
    }

    fn height(&self) -> f64 {
        if self.rows == 0.0 { 0.0 } else { self.rows * super::frame::LINE + 4.0 }
    }

    /// Row 0 is the uppermost; a line reaches up to its name.
    fn paint(&self, drawing: &mut Drawing, frame: &Frame) {
        let above = frame.top - super::frame::LINE - 10.0;
        for (at, row, _) in &self.placed {
            let y = above - (self.rows - 1.0 - row) * super::frame::LINE;
            straight(drawing, "v", (*at, y - 10.0), (*at, frame.bottom));
        }
        for (at, row, label) in &self.placed {
            let y = above - (self.rows - 1.0 - row) * super::frame::LINE;
            drawing.text((beside(*at, words::width(label), self.width), y), "o", label);
        }
    }
}
