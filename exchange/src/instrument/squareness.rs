//! Squareness from two straightnesses against one square. In: the slopes of both measurements. Out: the alignment error of the
//! machine between the two axes.
//!
//! A line of motion that is turned by an angle about the third axis makes a slope in the straightness of its own axis; so does
//! a square that is laid on askew, in both measurements alike. The difference of the two turns is the squareness and the
//! square's own error. What a turn of the line displaces the tool by is in the lever arms of the machine's equations.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};

use super::line::Line;
use super::setup::{Measurement, Reference};
use super::uncertainty::{Uncertainty, together};
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
}

/// One straightness with its line, as the instrument read it.
#[derive(Clone, Copy)]
pub(super) struct Side<'s> {
    pub(super) measurement: &'s Measurement,
    pub(super) line: Line,
}

/// Both straightnesses of one setting-up of a square, the edge of the first axis first.
struct Pair {
    about: usize,
    /// The turn of each line of motion relative to its edge, rad.
    turns: [f64; 2],
    uncertainty: Option<Uncertainty>,
}

/// The squareness that a square gives, from all measurements against it. E0912 where they do not give one.
pub(super) fn of(
    reference: (&str, Option<&Reference>),
    sides: &[Side<'_>],
    view: &View<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Squareness> {
    let (name, known) = reference;
    let place = sides.first()?.measurement.reference.as_ref()?.span;
    let mut refuse = |why: String, help: &str| -> Option<Squareness> {
        diagnostics.push(Diagnostic::error("E0912", place, why).help(help));
        None
    };
    let setting = |turned: bool| -> Vec<Side<'_>> {
        sides.iter().filter(|side| side.measurement.turned == turned).copied().collect()
    };
    let (upright, turned) = (setting(false), setting(true));
    let Some(pair) = Pair::of(&upright, view) else {
        return refuse(
            format!(
                "the measurements against `{name}` are not the straightnesses of two axes towards each other"
            ),
            "a squareness takes two, such as EYX and EXY; leave `reference` out elsewhere",
        );
    };
    let Some((motion, gain)) = alignment(&pair, &upright, view) else {
        return refuse(
            format!(
                "the machine file has no alignment error between the axes measured against `{name}`, or two of them"
            ),
            "write the angle that was measured under `errors`, in the sense of the machine file",
        );
    };
    let from =
        [0, 1].map(|side| upright.get(side).map_or(0, |side: &Side<'_>| side.measurement.motion.value));
    let plain = pair.difference();
    let over = Pair::of(&turned, view).filter(|other| other.about == pair.about);
    let (angle, square, uncertainty) = match &over {
        Some(over) => {
            let both = [(0.5 / gain, pair.uncertainty), (0.5 / gain, over.uncertainty)];
            ((plain + over.difference()) / 2.0, Some((over.difference() - plain) / 2.0), together(&both))
        }
        None => {
            let square = known.and_then(|known| known.angle);
            let own = known.and_then(|known| known.uncertainty).map(Uncertainty::given);
            let parts = [(1.0 / gain, pair.uncertainty), (1.0 / gain, own.or(Some(Uncertainty::given(0.0))))];
            (plain + square.unwrap_or(0.0), square, together(&parts))
        }
    };
    Some(Squareness {
        motion,
        reference: name.to_owned(),
        angle: angle / gain,
        uncertainty,
        square,
        turned: over.is_some(),
        from,
    })
}

impl Pair {
    fn of(sides: &[Side<'_>], view: &View<'_>) -> Option<Self> {
        let [one, other] = sides else { return None };
        let along =
            |side: &Side<'_>| diagnosis::recording::own_direction(view.equations, side.measurement.axis);
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
    let along = diagnosis::recording::own_direction(view.equations, side.measurement.axis)?;
    let slope = dot(cross(unit(about)?, along), view.direction(side.measurement.motion.value)?);
    (slope.abs() == 1.0).then_some(slope)
}

/// The only alignment error that turns one of the two lines about the third axis, and how much it changes their difference by.
fn alignment(pair: &Pair, sides: &[Side<'_>], view: &View<'_>) -> Option<(usize, f64)> {
    let sign = |side: &Side<'_>| {
        let along = diagnosis::recording::own_direction(view.equations, side.measurement.axis)?;
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
