//! Squareness from two straightnesses against one square. In: the slopes of both measurements. Out: the alignment error of the
//! machine between the two axes.
//!
//! A line of motion that is turned by an angle about the third axis makes a slope in the straightness of its own axis; so does
//! a square that is laid on askew, in both measurements alike. The difference of the two turns is the squareness and the
//! square's own error. What a turn of the line displaces the tool by is in the lever arms of the machine's equations.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::Span;

use super::line::Line;
use super::setup::{Measurement, Reference};
use super::uncertainty::{Uncertainty, mean, of_mean, together};
use super::view::{View, cross, dot, unit};

/// An alignment error that two measurements give.
#[derive(Clone, Debug)]
pub struct Squareness {
    /// The alignment error: an index into the motions of the equations.
    pub motion: usize,
    /// The square.
    pub reference: String,
    /// The angle, rad, in the sense of the machine file.
    pub angle: f64,
    /// Its uncertainty: of both slopes, and of the square where that was given.
    pub uncertainty: Option<Uncertainty>,
    /// The error of the square: given, or found by turning it over; nothing where it counts as perfect.
    pub square: Option<f64>,
    /// Whether the square was turned over, so that its error falls out.
    pub turned: bool,
    /// The straightnesses: indices of motions.
    pub from: [usize; 2],
    /// The angle of each set-up, rad, where the square was laid on several times.
    pub set_ups: Vec<f64>,
}

/// One straightness with its line, as the instrument read it.
#[derive(Clone, Copy)]
pub(super) struct Side<'s> {
    pub(super) measurement: &'s Measurement,
    pub(super) line: Line,
}

/// Both straightnesses of one set-up of a square, the edge of the first axis first.
struct Pair {
    about: usize,
    /// The turn of each line of motion relative to its edge, rad.
    turns: [f64; 2],
    uncertainty: Option<Uncertainty>,
}

/// The squareness that a square gives, from all its set-ups: the mean of theirs, and the scatter of it where there are several.
pub(super) fn of_set_ups(
    (name, known): (&str, Option<&Reference>),
    sides: &[Side<'_>],
    view: &View<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Squareness> {
    let mut placements: Vec<u8> = sides.iter().map(|side| side.measurement.placement).collect();
    placements.sort_unstable();
    placements.dedup();
    let mut all = Vec::new();
    for placement in placements {
        let own: Vec<Side<'_>> =
            sides.iter().copied().filter(|side| side.measurement.placement == placement).collect();
        all.push(of((name, known), &own, view, diagnostics)?);
    }
    let angles: Vec<f64> = all.iter().map(|one| one.angle).collect();
    let squares: Option<Vec<f64>> = all.iter().map(|one| one.square).collect();
    let first = all.into_iter().next()?;
    if angles.len() < 2 {
        return Some(first);
    }
    // What the set-ups differ by holds the scatter of each; the error of the square is the same in all of them.
    let own = known.and_then(|known| known.uncertainty).filter(|_| !first.turned).unwrap_or(0.0);
    let uncertainty = together(&[(1.0, of_mean(&angles)), (1.0, Some(Uncertainty::given(own)))]);
    Some(Squareness {
        angle: mean(&angles),
        uncertainty,
        square: squares.map(|squares| mean(&squares)),
        set_ups: angles,
        ..first
    })
}

/// The squareness that one set-up of a square gives. E0912 where they do not give one.
fn of(
    (name, known): (&str, Option<&Reference>),
    sides: &[Side<'_>],
    view: &View<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Squareness> {
    let place = sides.first()?.measurement.reference.as_ref()?.span;
    let (turned, upright): (Vec<Side<'_>>, Vec<Side<'_>>) =
        sides.iter().copied().partition(|side| side.measurement.turned);
    let Some(pair) = Pair::of(&upright, view) else {
        diagnostics.push(not_a_pair(name, place));
        return None;
    };
    let Some((motion, gain)) = alignment(&pair, &upright, view) else {
        diagnostics.push(no_alignment(name, place));
        return None;
    };
    let over = Pair::of(&turned, view).filter(|other| other.about == pair.about);
    if let Some(known) = known.filter(|known| over.is_some() && known.angle.is_some()) {
        diagnostics.push(angle_and_turned(name, known.name.span, place));
        return None;
    }
    let turns = match &over {
        Some(over) => pair.with_turned(over),
        None => pair.with_angle(known),
    };
    let from = [0, 1].map(|side| upright.get(side).map_or(0, |side| side.measurement.motion.value));
    Some(Squareness {
        motion,
        reference: name.to_owned(),
        angle: turns.angle / gain,
        uncertainty: together(&[(1.0 / gain, turns.uncertainty)]),
        square: turns.square,
        turned: over.is_some(),
        from,
        set_ups: Vec::new(),
    })
}

fn not_a_pair(name: &str, place: Span) -> Diagnostic {
    let message = format!(
        "the measurements against `{name}` are not the straightnesses of two axes in each other's direction"
    );
    let help = "measure two straightnesses, such as EYX and EXY, or remove `reference`";
    Diagnostic::error("E0912", place, message).help(help)
}

fn no_alignment(name: &str, place: Span) -> Diagnostic {
    let message = format!(
        "the machine file has no alignment error between the axes measured against `{name}`, or two of them"
    );
    let help = "write the measured angle under `errors`, with the sign convention of the machine file";
    Diagnostic::error("E0912", place, message).help(help)
}

fn angle_and_turned(name: &str, given: Span, place: Span) -> Diagnostic {
    let message = format!("the error of `{name}` cancels because it was turned over, but it is also given");
    let mistake = Diagnostic::error("E0912", given, message).also(place, "measured with it turned over");
    mistake.help("remove `angle`, and compare it with the angle in the report")
}

/// How much more the second line of motion is turned than the first, and the square's error.
struct Turns {
    angle: f64,
    uncertainty: Option<Uncertainty>,
    square: Option<f64>,
}

impl Pair {
    /// With what is known of the square; without it the square counts as perfect.
    fn with_angle(&self, known: Option<&Reference>) -> Turns {
        let square = known.and_then(|known| known.angle);
        let own = known.and_then(|known| known.uncertainty).unwrap_or(0.0);
        Turns {
            angle: self.difference() + square.unwrap_or(0.0),
            uncertainty: together(&[(1.0, self.uncertainty), (1.0, Some(Uncertainty::given(own)))]),
            square,
        }
    }

    /// With the square turned over for the other pair: its error is in both with opposite signs.
    fn with_turned(&self, over: &Self) -> Turns {
        let (one, other) = (self.difference(), over.difference());
        Turns {
            angle: f64::midpoint(one, other),
            uncertainty: together(&[(0.5, self.uncertainty), (0.5, over.uncertainty)]),
            square: Some((other - one) / 2.0),
        }
    }
}

impl Pair {
    fn of(sides: &[Side<'_>], view: &View<'_>) -> Option<Self> {
        let [one, other] = sides else { return None };
        let along = |side: &Side<'_>| recording::own_direction(view.equations, side.measurement.axis);
        let across = |side: &Side<'_>| view.direction(side.measurement.motion.value);
        let about = number(cross(along(one)?, along(other)?))?;
        let straight =
            |side: &Side<'_>, other: &Side<'_>| Some(dot(across(side)?, along(other)?).abs() == 1.0);
        if !(straight(one, other)? && straight(other, one)?) {
            return None;
        }
        // The first edge lies along the axis that follows the third one, in the order X Y Z X.
        let is_first = |side: &Side<'_>| Some(number(along(side)?)? == (about + 1) % 3);
        let (first, second) = if is_first(one)? { (one, other) } else { (other, one) };
        // The line is that of the motion in the sense of the machine file; here counts what the instrument read.
        let turn = |side: &Side<'_>| {
            let read = side.line.slope * view.shown(side.measurement.motion.value)?;
            Some(read / turned_by(side, about, view)?)
        };
        Some(Self {
            about,
            turns: [turn(first)?, turn(second)?],
            uncertainty: together(&[(1.0, first.line.uncertainty()), (1.0, second.line.uncertainty())]),
        })
    }

    /// How much more the second line is turned than the first, relative to the edges.
    fn difference(&self) -> f64 {
        let [first, second] = self.turns;
        second - first
    }
}

/// The slope that a reading gets for each rad by which the line of motion is turned: +1 or -1.
fn turned_by(side: &Side<'_>, about: usize, view: &View<'_>) -> Option<f64> {
    let along = recording::own_direction(view.equations, side.measurement.axis)?;
    let slope = dot(cross(unit(about)?, along), view.direction(side.measurement.motion.value)?);
    (slope.abs() == 1.0).then_some(slope)
}

/// The only alignment error that turns one of the two lines about the third axis, and how much it changes their difference by.
fn alignment(pair: &Pair, sides: &[Side<'_>], view: &View<'_>) -> Option<(usize, f64)> {
    let sign = |side: &Side<'_>| {
        let along = recording::own_direction(view.equations, side.measurement.axis)?;
        Some(if number(along)? == (pair.about + 1) % 3 { -1.0 } else { 1.0 })
    };
    let gain = |motion: usize| -> Option<f64> {
        let mut sum = 0.0;
        for side in sides {
            let slope = dot(
                view.slopes(motion, side.measurement.axis),
                view.direction(side.measurement.motion.value)?,
            );
            sum += sign(side)? * slope / turned_by(side, pair.about, view)?;
        }
        Some(sum)
    };
    let motions =
        view.equations.motions.iter().enumerate().filter(|(_, motion)| motion.alignment && motion.angular);
    let all: Vec<(usize, f64)> = motions.filter_map(|(number, _)| Some((number, gain(number)?))).collect();
    let mut seen = all.into_iter().filter(|(_, gain)| gain.abs() > 0.5);
    let found = seen.next()?;
    seen.next().is_none().then_some(found)
}

/// The number of a direction along X, Y or Z, either way.
fn number(direction: [f64; 3]) -> Option<usize> {
    direction.iter().position(|part| part.abs() == 1.0)
}
