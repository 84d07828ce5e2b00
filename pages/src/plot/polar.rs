//! Polar plots. In: deviations from a nominal circle, by angle. Out: the circle with the deviations magnified on it, and how
//! much they are magnified.

use std::f64::consts::TAU;

use super::Plot;
use super::frame::{Head, LINE, WIDTH};
use super::legend::Entry;
use super::look::Look;
use super::series::{Draw, straight};
use super::ticks::{self, count};
use super::unit::Unit;
use super::words;
use crate::svg::{Drawing, number};

/// Deviations by angle, in order; an arc need not be a whole turn, and what is not finite is a gap.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Its name: what it is, and in which sense it was run.
    pub name: String,
    /// Its colour, dash and mark.
    pub look: Look,
    /// How it is drawn.
    pub draw: Draw,
    /// Angle, rad, from the first direction to the second; and radial deviation, outward positive, in the plot's unit.
    pub points: Vec<(f64, f64)>,
}

/// Deviations from a circle.
#[derive(Clone, Debug)]
pub struct Polar {
    title: String,
    subtitle: String,
    directions: [String; 2],
    radius: f64,
    unit: String,
    with: Vec<f64>,
    traces: Vec<Trace>,
}

impl Polar {
    /// A circle of a nominal radius, both in `unit`; `directions` are what lies right and what lies up: `+X`, `+Y`.
    pub fn new(title: &str, directions: [&str; 2], radius: f64, unit: &str) -> Self {
        Self {
            title: title.to_owned(),
            subtitle: String::new(),
            directions: directions.map(str::to_owned),
            radius,
            unit: unit.to_owned(),
            with: Vec::new(),
            traces: Vec::new(),
        }
    }

    /// What stands in smaller weight below the title.
    pub fn subtitle(self, subtitle: &str) -> Self {
        Self { subtitle: subtitle.to_owned(), ..self }
    }

    /// The rings reach to this deviation in any case; plots with the same ends can be compared.
    pub fn reaching(mut self, deviation: f64) -> Self {
        self.with.push(deviation);
        self
    }

    /// Adds a trace in front of those that are there.
    pub fn trace(mut self, trace: Trace) -> Self {
        self.traces.push(trace);
        self
    }
}

/// The radius of the whole drawing, and of what stays free in its middle, in pixels.
const OUTER: f64 = 165.0;
const INNER: f64 = 45.0;

/// How deviations are laid out on the circle.
struct Rings {
    /// The deviation of one division, in the plot's unit.
    division: f64,
    /// Its width in pixels.
    width: f64,
    /// The radius of the nominal circle in pixels.
    nominal: f64,
    /// Divisions inside and outside of it.
    inside: f64,
    outside: f64,
    /// By how much a deviation is drawn larger than the circle; nothing where the circle has no radius.
    magnification: Option<f64>,
}

impl Rings {
    fn new(low: f64, high: f64, radius: f64) -> Self {
        let (low, high) = (low.min(0.0), high.max(0.0));
        let (low, high) = if high - low > 1e-12 { (low, high) } else { (-1e-3, 1e-3) };
        let division = ticks::step(low, high, 8);
        let divisions = |end: f64| (end / division - 1e-9).ceil().max(1.0);
        let (inside, outside) = (divisions(-low), divisions(high));
        let room = (OUTER - INNER) / (inside + outside);
        let nominal = OUTER - outside * room;
        // A round magnification, and divisions as wide as it makes them.
        let exact = room / division / (nominal / radius);
        let magnification = (exact.is_finite() && exact > 0.0).then(|| rounded_down(exact));
        let width = magnification.map_or(room, |magnification| magnification * division * nominal / radius);
        Self { division, width, nominal, inside, outside, magnification }
    }

    fn radius(&self, deviation: f64) -> f64 {
        self.nominal + deviation / self.division * self.width
    }
}

/// Two significant digits, not above the number.
fn rounded_down(value: f64) -> f64 {
    let step = 10f64.powf(value.log10().floor() - 1.0);
    (value / step + 1e-9).floor() * step
}

impl Plot for Polar {
    fn draw(&self) -> Drawing {
        let known = || self.traces.iter().flat_map(|trace| &trace.points).filter(|point| point.0.is_finite());
        let ends = ticks::ends(known().map(|point| point.1));
        let reached = ends
            .and_then(|(low, high)| ticks::ends([low, high].into_iter().chain(self.with.iter().copied())));
        let rings = reached.map_or_else(
            || Rings::new(0.0, 0.0, self.radius),
            |(low, high)| Rings::new(low, high, self.radius),
        );
        let named = self.traces.iter().filter(|trace| !trace.name.is_empty());
        let entries =
            named.map(|trace| Entry { name: &trace.name, look: trace.look, draw: trace.draw }).collect();
        let head = Head::new(&self.title, &self.subtitle, entries, WIDTH);
        let notes = words::lines(&self.note(&rings), WIDTH - 20.0);
        let middle = (WIDTH / 2.0, head.height() + 22.0 + OUTER);
        let below = middle.1 + OUTER + 40.0;
        let mut drawing = Drawing::new(WIDTH, below + LINE * count(notes.len()), &self.title);
        head.paint(&mut drawing);
        self.web(&mut drawing, middle, &rings);
        for trace in &self.traces {
            let place = |(angle, deviation): &(f64, f64)| {
                let known = angle.is_finite() && deviation.abs() <= ticks::LARGEST;
                known.then(|| at(middle, *angle, rings.radius(*deviation)))
            };
            let places: Vec<_> = trace.points.iter().map(place).collect();
            trace.look.paint(&mut drawing, trace.draw, &places);
        }
        if ends.is_none() {
            drawing.text(middle, "q mid", "no data");
        }
        for (row, line) in notes.iter().enumerate() {
            drawing.text((10.0, below + LINE * (count(row + 1) - 1.0)), "q", line);
        }
        drawing
    }
}

impl Polar {
    /// Rings, spokes and their names.
    fn web(&self, drawing: &mut Drawing, middle: (f64, f64), rings: &Rings) {
        let mut ring = -rings.inside;
        while ring <= rings.outside {
            let class = if ring == 0.0 { "l ci" } else { "g" };
            let radius = number(rings.radius(ring * rings.division));
            let (x, y) = (number(middle.0), number(middle.1));
            drawing.element("circle", &[("class", class), ("cx", &x), ("cy", &y), ("r", &radius)]);
            ring += 1.0;
        }
        let ends =
            [rings.radius(-rings.inside * rings.division), rings.radius(rings.outside * rings.division)];
        for spoke in 0..8u8 {
            let angle = TAU * f64::from(spoke) / 8.0;
            straight(drawing, "g", at(middle, angle, ends[0]), at(middle, angle, ends[1]));
            let (x, y) = at(middle, angle, ends[1] + 10.0);
            let class = if angle.cos() > 0.1 {
                ""
            } else if angle.cos() < -0.1 {
                "e"
            } else {
                "mid"
            };
            let name = match spoke {
                0 => format!("{} 0°", self.directions[0]),
                2 => format!("{} 90°", self.directions[1]),
                other => format!("{}°", u16::from(other) * 45),
            };
            drawing.text((x, y + 4.0), class, &name);
        }
    }

    fn note(&self, rings: &Rings) -> String {
        let unit = Unit::of(&self.unit, rings.division);
        // A number stays on the line of its unit.
        let whole = |text: String| text.replace(' ', "\u{a0}");
        let division = format!("1 division = {}", whole(unit.text(rings.division, 1)));
        let radius = whole(Unit::of(&self.unit, self.radius).given(self.radius));
        match rings.magnification {
            Some(magnification) => format!(
                "{division}, drawn {}:1 relative to the circle of radius {radius}; heavy ring: nominal; outward: longer",
                ticks::text(magnification, 0.0)
            ),
            None => format!("{division}; heavy ring: nominal; outward: longer"),
        }
    }
}

/// The place at an angle and a radius around the middle; angles turn against the clock.
fn at(middle: (f64, f64), angle: f64, radius: f64) -> (f64, f64) {
    (middle.0 + radius * angle.cos(), middle.1 - radius * angle.sin())
}

#[cfg(test)]
mod tests {
    use super::{INNER, OUTER, Rings};

    #[test]
    fn the_magnification_is_what_is_drawn() {
        for (low, high, radius) in
            [(-0.0031, 0.0044, 150.0), (0.0, 0.021, 50.0), (-1.0, 0.0, 300.0), (-1e-5, 2e-6, 75.0)]
        {
            let rings = Rings::new(low, high, radius);
            // Pixels for each mm of deviation, against pixels for each mm of the circle.
            let deviation = (rings.radius(high) - rings.radius(low)) / (high - low);
            let circle = rings.radius(0.0) / radius;
            assert!((deviation / circle / rings.magnification.unwrap() - 1.0).abs() < 1e-9);
            assert!(rings.radius(high) <= OUTER + 1e-9 && rings.radius(low) >= INNER - 1e-9);
        }
    }

    #[test]
    fn a_circle_without_a_radius_claims_no_magnification() {
        assert_eq!(Rings::new(-1.0, 1.0, 0.0).magnification, None);
        assert_eq!(Rings::new(-1.0, 1.0, f64::NAN).magnification, None);
    }
}
