//! Plots. In: numbers in mm, rad, deg, s or any other unit, with names. Out: drawings with axes in round numbers.
//!
//! It is Abbe's own, since plotting libraries write their colours into the drawing, where light, dark and print cannot change
//! them, and draw no deviation that is magnified on a circle. Here every colour is a class of [`style`]; every series
//! differs in colour and in dash or mark, so that it can be told in black and white as well.
//!
//! ```text
//! Axis, Series, Band, Line -> Cartesian -\
//! Trace                    -> Polar     --> Drawing: inline in a page, or a file with style()
//! Bar                      -> Bars      -/
//! Whole, Part              -> Shares    -/
//! Steps                    -> Histogram (a Cartesian)
//! ```
//!
//! Numbers that are not finite are gaps. A plot without numbers says so. Who has many points thins them first: [`thin`].

mod axis;
mod bars;
mod cartesian;
mod frame;
mod histogram;
mod legend;
mod look;
mod path;
mod polar;
mod scale;
mod series;
mod shares;
mod style;
pub mod thin;
mod ticks;
mod unit;
mod words;

pub use axis::Axis;
pub use bars::{Bar, Bars};
pub use cartesian::{Band, Cartesian, Line};
pub use histogram::{Steps, histogram};
pub use look::{Look, Tone};
pub use polar::{Polar, Trace};
pub use series::{Draw, Series};
pub use shares::{Part, Shares, Whole};
pub use style::{RULES, style};
pub use unit::Unit;

use crate::svg::Drawing;

/// The most marks of one series that a reader can tell apart, and a browser draws at once.
pub const MOST_MARKS: usize = 2000;

/// A plot that can be drawn: alone or beside others.
pub trait Plot {
    /// The drawing.
    fn draw(&self) -> Drawing;
}

/// Several plots in one drawing, so many beside one another; for files of their own. A page lays figures out itself.
pub fn panels(title: &str, plots: &[&dyn Plot], columns: usize) -> Drawing {
    let columns = columns.max(1);
    let drawn: Vec<Drawing> = plots.iter().map(|plot| plot.draw()).collect();
    let wide = drawn.iter().map(|drawing| drawing.size().0).fold(0.0, f64::max);
    let (mut y, mut placed) = (0.0, Vec::new());
    for row in drawn.chunks(columns) {
        let mut x = 0.0;
        for drawing in row {
            placed.push(((x, y), drawing));
            x += wide + GAP;
        }
        y += row.iter().map(|drawing| drawing.size().1).fold(0.0, f64::max) + GAP;
    }
    let mut across = 0.0;
    for _ in 0..columns.min(drawn.len()) {
        across += wide + GAP;
    }
    let mut all = Drawing::new((across - GAP).max(1.0), (y - GAP).max(1.0), title);
    for (at, drawing) in placed {
        all.place(at, drawing);
    }
    all
}

/// Between two panels.
const GAP: f64 = 16.0;

#[cfg(test)]
mod tests;
