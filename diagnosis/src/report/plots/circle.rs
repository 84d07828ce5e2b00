//! Circles. In: passes around a circle. Out: a polar plot of each: measured, model before and model after.

use pages::plot::{Draw, Look, Polar, Trace};

use super::{Captions, Figure, LEFT};
use crate::pictures::{Circle, Pass, Picture};

const CAPTION: &str = "Deviations from the nominal circle: measured, predicted by the known calibration (before) and predicted \
     with the findings (after). The plot states the magnification. The instrument's zero and the centre of the circle are \
     removed. Of many passes, at most the first and the last of each sense are drawn. Steps at the axes are backlash or \
     friction; an ellipse along the axes means different scales. An ellipse at 45 degrees is a squareness if it is the same in \
     both senses, and a mismatch of the position loops' gains if it rotates by 90 degrees with the sense.";

const RESIDUAL: &str = "The residuals of the known calibration and, if there are findings, the residuals with them, at a larger magnification.";

pub(super) fn figures(picture: &Picture, captions: &mut Captions) -> Vec<Figure> {
    let Some(circle) = &picture.circle else { return Vec::new() };
    let unchanged = picture.channels.iter().all(|channel| channel.unchanged);
    if !circle.passes.iter().any(calibrated) {
        let drawn = |pass: &Pass| Figure::new(deviations(circle, pass, unchanged), captions.once(CAPTION));
        return circle.passes.iter().map(drawn).collect();
    }
    // What the known calibration says hides what it lacks: that is drawn beside it.
    let mut figures = Vec::new();
    for sense in [true, false] {
        if let Some(pass) = circle.passes.iter().find(|pass| pass.against_the_clock == sense) {
            figures.push(Figure::new(deviations(circle, pass, unchanged), captions.once(CAPTION)));
            figures.push(Figure::new(residuals(circle, pass, unchanged), captions.once(RESIDUAL)));
        }
    }
    figures
}

/// Whether the known calibration says anything here; without one, its trace is the nominal circle.
fn calibrated(pass: &Pass) -> bool {
    pass.points.iter().any(|point| point[2].abs() > 1e-9)
}

/// What is left, before and after.
fn residuals(circle: &Circle, pass: &Pass, unchanged: bool) -> Polar {
    let plot = empty("Residual", circle, pass);
    let left = |from: usize| pass.points.iter().map(|point| (point[0], point[1] - point[from])).collect();
    let trace = |name: &str, look, draw, points| Trace { name: name.to_owned(), look, draw, points };
    let measured = if pass.held_out { Draw::Hollow } else { Draw::Line };
    if unchanged {
        return plot.trace(trace(LEFT, Look::of(0), measured, left(3)));
    }
    let before = trace("before", Look::of(0), measured, left(2));
    plot.trace(before).trace(trace("after", Look::of(1), Draw::Line, left(3)))
}

fn empty(what: &str, circle: &Circle, pass: &Pass) -> Polar {
    let sense = if pass.against_the_clock { "counter-clockwise" } else { "clockwise" };
    let held_out = if pass.held_out { ", held out" } else { "" };
    let title = format!("{what}, run {}, {sense}{held_out}", pass.run);
    let directions = [circle.directions[0].as_str(), circle.directions[1].as_str()];
    let plot = Polar::new(&title, directions, circle.radius, "mm");
    match circle.of {
        0..=2 => plot,
        of => plot.subtitle(&format!("one of {of} passes in both senses")),
    }
}

/// Measured, as the known calibration has it, and with the findings.
fn deviations(circle: &Circle, pass: &Pass, unchanged: bool) -> Polar {
    let mut plot = empty("Deviations", circle, pass);
    let all = circle.passes.iter().flat_map(|pass| &pass.points).flat_map(|point| &point[1..]);
    plot = all.filter(|deviation| deviation.is_finite()).fold(Ends::default(), Ends::with).reach(plot);
    let trace = |name: &str, look, draw, part: usize| Trace {
        name: name.to_owned(),
        look,
        draw,
        points: pass.points.iter().map(|point| (point[0], point[part])).collect(),
    };
    let measured = if pass.held_out { Draw::Hollow } else { Draw::Line };
    plot = plot.trace(trace("measured", Look::of(0), measured, 1));
    if calibrated(pass) {
        plot = plot.trace(trace("model before", Look::of(2), Draw::Line, 2));
    }
    if unchanged { plot } else { plot.trace(trace("model after", Look::of(1), Draw::Line, 3)) }
}

/// The least and the greatest deviation of all passes, so that they can be compared.
#[derive(Default)]
struct Ends(Option<(f64, f64)>);

impl Ends {
    fn with(self, deviation: &f64) -> Self {
        let (low, high) = self.0.unwrap_or((*deviation, *deviation));
        Self(Some((low.min(*deviation), high.max(*deviation))))
    }

    fn reach(self, plot: Polar) -> Polar {
        match self.0 {
            Some((low, high)) => plot.reaching(low).reaching(high),
            None => plot,
        }
    }
}
