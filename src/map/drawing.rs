//! The map as a drawing. In: the slides of a workspace and the error over it. Out: SVG: arrows in slices, or curves where but one
//! slide moves.

use std::f64::consts::PI;

use abbe_runtime::Kinematics;
use model_dsl::equations::Equations;
use pages::plot::{Axis, Cartesian, Draw, Look, Plot, Series, Tone, Unit, panels, style};
use workshop::rows::field::Field;

use super::space::{Slide, Space};

/// Arrows along the longer side of a slice, and the fewest along the shorter one.
const ALONG: u16 = 9;
const FEWEST: u16 = 3;

/// Points of a curve.
const POINTS: u16 = 201;

/// The longest arrow of a slice goes at most so far, counted in the distance of the arrows: neighbours mostly go the same way.
const REACH: f64 = 1.5;

/// The picture of the error over the slides.
pub(super) fn draw<K: Kinematics + ?Sized>(
    equations: &Equations,
    space: &Space,
    slides: &[Slide],
    field: &mut Field<'_, '_, K>,
) -> String {
    let letter = |axis: usize| equations.axes.get(axis).map_or_else(String::new, |axis| axis.letter.clone());
    let state = state(equations, space, slides);
    let title = format!("Predicted error of {}", equations.machine);
    let plots = match slides {
        [one] => vec![curves(equations, *one, &state, field)],
        _ => {
            let slices: Vec<Slice> =
                planes(slides).into_iter().map(|plane| Slice::of(plane, field)).collect();
            let scale = Scale::of(&slices);
            slices.iter().map(|slice| slice.plot(&letter, &scale, &state)).collect()
        }
    };
    let plots: Vec<&dyn Plot> = plots.iter().map(|plot| -> &dyn Plot { plot }).collect();
    panels(&title, &plots, 3).file(&style())
}

/// How the machine stands, in words.
fn state(equations: &Equations, space: &Space, slides: &[Slide]) -> String {
    let middle = space.middle();
    let others = equations.axes.iter().zip(&middle).enumerate();
    let others = others.filter(|(axis, _)| slides.iter().all(|slide| slide.axis != *axis));
    let stands: Vec<String> = others
        .map(|(_, (axis, place))| {
            let (place, unit) = if axis.rotary { (place * 180.0 / PI, "deg") } else { (*place, "mm") };
            format!("{} {}", axis.letter, Unit::exactly(unit).given(place))
        })
        .collect();
    let at = if stands.is_empty() { String::new() } else { format!(", at {}", stands.join(", ")) };
    format!("all axes at rest after a motion forward{at}")
}

/// A slice that is to be drawn: two slides, and where the third one stands.
#[derive(Clone, Copy)]
struct Plane {
    sides: [Slide; 2],
    third: Option<(usize, f64, &'static str)>,
}

/// Every pair of slides, with the third one at its least place, its middle and its greatest.
fn planes(slides: &[Slide]) -> Vec<Plane> {
    let mut planes = Vec::new();
    for (number, one) in slides.iter().enumerate() {
        for other in slides.iter().skip(number + 1) {
            let third = slides.iter().find(|third| third.axis != one.axis && third.axis != other.axis);
            let sides = [*one, *other];
            match third {
                None => planes.push(Plane { sides, third: None }),
                Some(Slide { axis, stretch, .. }) => {
                    let places =
                        [(stretch.low, "least"), (stretch.middle(), "middle"), (stretch.high, "greatest")];
                    planes.extend(
                        places.map(|(place, name)| Plane { sides, third: Some((*axis, place, name)) }),
                    );
                }
            }
        }
    }
    planes
}

/// The errors of a plane: the place in it, and the error in it, mm.
struct Slice {
    plane: Plane,
    errors: Vec<([f64; 2], [f64; 2])>,
    /// The distance of the arrows.
    spacing: f64,
}

impl Slice {
    fn of<K: Kinematics + ?Sized>(plane: Plane, field: &mut Field<'_, '_, K>) -> Self {
        let [one, other] = plane.sides;
        let longest = one.stretch.length().max(other.stretch.length());
        let counts = plane.sides.map(|side| count(side.stretch.length() / longest));
        let mut errors = Vec::new();
        for x in places(one, counts[0]) {
            for y in places(other, counts[1]) {
                let mut moved = vec![(one.axis, x), (other.axis, y)];
                moved.extend(plane.third.map(|(axis, place, _)| (axis, place)));
                if let Some(error) = field.at(&moved) {
                    let part = |side: Slide| error.get(side.direction).copied().unwrap_or_default();
                    errors.push(([x, y], [part(one), part(other)]));
                }
            }
        }
        let spacing =
            plane.sides.iter().zip(counts).map(|(side, count)| side.stretch.length() / f64::from(count - 1));
        Self { plane, errors, spacing: spacing.fold(f64::INFINITY, f64::min) }
    }

    fn longest(&self) -> f64 {
        self.errors.iter().map(|(_, [x, y])| x.hypot(*y)).fold(0.0, f64::max)
    }

    fn plot(&self, letter: &dyn Fn(usize) -> String, scale: &Scale, state: &str) -> Cartesian {
        let [one, other] = self.plane.sides;
        let names = [letter(one.axis), letter(other.axis)];
        let at = self.plane.third.map_or_else(String::new, |(axis, place, name)| {
            format!(" at {} {} ({name})", letter(axis), Unit::exactly("mm").given(place))
        });
        let longest = self.longest();
        let told = match longest > 0.0 {
            true => {
                format!("Largest error in this plane: {}; {state}.", Unit::of("mm", longest).text(longest, 3))
            }
            false => format!("No error in this plane; {state}."),
        };
        let axis = |name: &str| Axis::exactly(&format!("position of {name}"), "mm");
        let mut plot = Cartesian::new(
            &format!("Error in {} and {}{at}", names[0], names[1]),
            axis(&names[0]),
            axis(&names[1]),
        )
        .subtitle(&told)
        .sized(480.0, 300.0)
        .equal();
        let dots = self.errors.iter().map(|(place, _)| (place[0], place[1])).collect();
        plot = plot.series(Series::new("place", Look::of(0).toned(Tone::Quiet), Draw::Marks, dots));
        let arrows = self.errors.iter().flat_map(|(from, error)| arrow(*from, *error, scale.magnification));
        let name = format!("error, drawn {}:1", grouped(scale.magnification));
        plot = plot.series(Series::new(&name, Look::of(0), Draw::Line, arrows.collect()));
        plot.series(scale.bar(self))
    }
}

/// From a share of the longer side to arrows along it.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "held between the two ends; NaN is 0"
)]
fn count(share: f64) -> u16 {
    (((share * f64::from(ALONG - 1)).round() as u16) + 1).clamp(FEWEST, ALONG)
}

fn places(slide: Slide, count: u16) -> impl Iterator<Item = f64> {
    let step = slide.stretch.length() / f64::from(count.max(2) - 1);
    (0..count).map(move |number| slide.stretch.low + f64::from(number) * step)
}

/// A shaft and two barbs.
fn arrow(from: [f64; 2], error: [f64; 2], magnification: f64) -> Vec<(f64, f64)> {
    let [x, y] = error.map(|part| part * magnification);
    if x == 0.0 && y == 0.0 {
        return Vec::new();
    }
    let tip = (from[0] + x, from[1] + y);
    // Back from the tip by a quarter of the length, to both sides.
    let barb = |side: f64| (tip.0 - 0.25 * x + side * 0.12 * y, tip.1 - 0.25 * y - side * 0.12 * x);
    let gap = (f64::NAN, f64::NAN);
    vec![(from[0], from[1]), tip, gap, barb(1.0), tip, barb(-1.0), gap]
}

/// How errors are drawn, alike in all slices.
struct Scale {
    magnification: f64,
    /// The error that the bar shows, mm.
    shown: f64,
}

impl Scale {
    fn of(slices: &[Slice]) -> Self {
        let longest = slices.iter().map(Slice::longest).fold(0.0, f64::max);
        let room = |slice: &Slice| REACH * slice.spacing / slice.longest();
        let room = slices.iter().map(room).filter(|room| room.is_finite()).fold(f64::INFINITY, f64::min);
        if longest > 0.0 && room.is_finite() {
            let magnification = round_down(room, &[8.0, 6.0, 5.0, 4.0, 3.0, 2.5, 2.0, 1.5]);
            Self { magnification, shown: round_down(longest, &[5.0, 2.0]) }
        } else {
            Self { magnification: 1.0, shown: 0.0 }
        }
    }

    /// The bar, below all arrows.
    fn bar(&self, slice: &Slice) -> Series {
        let [one, other] = slice.plane.sides;
        let ends = slice.errors.iter().map(|(place, error)| place[1] + self.magnification * error[1]);
        let lowest = ends.fold(other.stretch.low, f64::min);
        let (x, y) = (one.stretch.low, lowest - 0.6 * slice.spacing);
        let (end, half) = (x + self.shown * self.magnification, 0.12 * slice.spacing);
        let gap = (f64::NAN, f64::NAN);
        let points = match self.shown > 0.0 {
            true => vec![
                (x, y - half),
                (x, y + half),
                gap,
                (x, y),
                (end, y),
                gap,
                (end, y - half),
                (end, y + half),
            ],
            false => Vec::new(),
        };
        let name = format!("bar: {} of error", Unit::of("mm", self.shown).text(self.shown, 1));
        Series::new(
            if points.is_empty() { "" } else { &name },
            Look::of(0).toned(Tone::Ink),
            Draw::Line,
            points,
        )
    }
}

/// A round number that is not above the number: one of the digits, the greatest first, or 1, in its decade.
fn round_down(value: f64, digits: &[f64]) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    let first = digits.iter().find(|first| *first * decade <= value * (1.0 + 1e-9));
    first.unwrap_or(&1.0) * decade
}

/// A magnification with spaces between thousands.
fn grouped(value: f64) -> String {
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// The error over the one slide that moves, a curve for each direction.
fn curves<K: Kinematics + ?Sized>(
    equations: &Equations,
    slide: Slide,
    state: &str,
    field: &mut Field<'_, '_, K>,
) -> Cartesian {
    let letter = equations.axes.get(slide.axis).map_or("?", |axis| axis.letter.as_str());
    let at: Vec<(f64, [f64; 3])> =
        places(slide, POINTS).filter_map(|place| Some((place, field.at(&[(slide.axis, place)])?))).collect();
    let x = Axis::exactly(&format!("position of {letter}"), "mm");
    let mut plot =
        Cartesian::new(&format!("Error along {letter}"), x, Axis::new("error", "mm").reaching(0.0))
            .subtitle(&format!("{state}."))
            .sized(640.0, 360.0);
    for (number, row) in equations.rows.iter().enumerate() {
        let part = |error: &[f64; 3]| error.get(row.direction.index()).copied().unwrap_or(f64::NAN);
        let points = at.iter().map(|(place, error)| (*place, part(error))).collect();
        let name = format!("error in {}", row.direction.letter());
        plot = plot.series(Series::new(&name, Look::of(number), Draw::Line, points));
    }
    plot
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnifications_are_round_and_never_larger_than_asked() {
        let asked = [1.0, 1.9, 2.0, 4.99, 5.0, 9.9, 1234.0, 0.0031];
        let round = [1.0, 1.0, 2.0, 2.0, 5.0, 5.0, 1000.0, 0.002];
        for (asked, round) in asked.into_iter().zip(round) {
            assert!((round_down(asked, &[5.0, 2.0]) / round - 1.0).abs() < 1e-9, "{asked}");
        }
        assert_eq!([2000.0, 500.0].map(grouped), ["2\u{202f}000", "500"]);
    }

    #[test]
    fn an_arrow_goes_from_its_place_along_the_error() {
        let points = arrow([10.0, 20.0], [0.003, -0.004], 1000.0);
        assert_eq!((points[0], points[1]), ((10.0, 20.0), (13.0, 16.0)));
        let back = |point: (f64, f64)| (point.0 - 13.0) * 0.6 + (point.1 - 16.0) * -0.8;
        // Both barbs lie behind the tip, on either side.
        assert!(back(points[3]) < 0.0 && (back(points[3]) - back(points[5])).abs() < 1e-9);
        assert!(arrow([0.0; 2], [0.0; 2], 1e3).is_empty());
    }
}
