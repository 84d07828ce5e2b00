//! Steps: what stands between the frame before a link and its own, one displacement or rotation each.
//!
//! In: a link with the numbers of its constants. Out: its steps in order, and each taken by the stands of many rows. The
//! order, and the point about which a rotation acts, are those of [`crate::derivation::link_matrix`].

use crate::algebra::{Axis, Rational, Symbol, to_f64};
use crate::equations::{Equations, Motion};
use crate::machine::{Link, LinkKind, MotionKind, Moved, Reference};

use super::Columns;
use super::walk::{Quaternion, Stand};

/// One displacement or rotation, from a frame to the one before it.
#[derive(Clone, Debug)]
pub(super) enum Step {
    /// A place that never changes: mm.
    Place([f64; 3]),
    /// The travel of a slide.
    Travel { axis: usize, direction: usize, sign: f64 },
    /// A rotation by an angle that never changes, rad.
    Fixed { about: Axis, angle: f64 },
    /// The rotation of a rotary axis.
    Rotary { axis: usize, about: Axis, sign: f64 },
    /// A displacement by an error motion.
    Shift(Part),
    /// A rotation by error motions: their rotation vector.
    Turn(Vec<Part>),
    /// What a line of motion that is turned about its beginning adds to the travel.
    Line { angle: Part, along: Axis, travel: Travel, sign: f64 },
}

/// An error motion along or about a direction, with the sign that its value has there, or the weight of the error of a motor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    motion: usize,
    axis: Axis,
    sign: f64,
}

/// The travel in the lever of an alignment error, and the sense in which it counts along the line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Travel {
    /// The number of a free travel, or else of the axis whose position it is.
    free: Option<usize>,
    axis: usize,
    sign: f64,
}

/// The steps from the frame before a link to its own.
pub(super) fn of_link(equations: &Equations, number: usize, link: &Link, constants: &[f64]) -> Vec<Step> {
    let own = equations.motions.iter().enumerate();
    let own = own.filter(|(_, motion)| motion.body == number && motion.by_motor.is_empty());
    let own: Vec<(Part, &Motion)> = own.map(|(number, motion)| (Part::of(number, motion), motion)).collect();
    let motors = by_motors(equations, number);
    let parts = |kind: &dyn Fn(&Motion) -> bool| -> Vec<Part> {
        own.iter().filter(|(_, motion)| kind(motion)).map(|(part, _)| *part).collect()
    };
    let slide = matches!(link.kind, LinkKind::Slide(_));
    let aligned = |motion: &Motion| matches!(motion.kind, MotionKind::Alignment(_));
    let with_motors = |mut own: Vec<Part>, angular: bool| {
        own.extend(motors.iter().filter(|(kind, _)| kind.angular() == angular).map(|(_, part)| *part));
        own
    };
    let shifts = with_motors(parts(&|motion| matches!(motion.kind, MotionKind::Linear(_))), false);
    let turns = with_motors(parts(&|motion| matches!(motion.kind, MotionKind::Angular(_))), true);
    let error = || shifts.iter().map(|part| Step::Shift(*part)).chain([Step::Turn(turns.clone())]);
    let offsets = parts(&|motion| matches!(motion.kind, MotionKind::Offset(_)));
    let tilts = parts(&|motion| !slide && aligned(motion));

    let fixed = |about: Axis, degrees: &Rational| Step::Fixed { about, angle: to_f64(degrees).to_radians() };
    let mut steps = vec![Step::Place(place(equations, link, constants))];
    steps.extend(link.turned.rotations().map(|(about, degrees)| fixed(about, degrees)));
    steps.extend(offsets.into_iter().map(Step::Shift));
    steps.push(Step::Turn(tilts));
    let variable = link.variable();
    let axis = equations.axes.iter().position(|axis| axis.variable == variable);
    let sign = sign(link.along.sign);
    match (link.kind, axis) {
        (LinkKind::Slide(_), Some(axis)) => {
            let mut carriage = vec![Step::Travel { axis, direction: link.along.axis.index(), sign }];
            carriage.extend(own.iter().filter(|(_, motion)| aligned(motion)).map(|(angle, motion)| {
                let travel = Travel { free: motion.travel, axis, sign };
                Step::Line { angle: *angle, along: link.along.axis, travel, sign: 1.0 }
            }));
            carriage.push(Step::Turn(parts(&|motion| aligned(motion) && motion.rotates)));
            match link.reference {
                Reference::Bed => steps.extend(error().chain(carriage)),
                Reference::Carriage => steps.extend(carriage.into_iter().chain(error())),
            }
        }
        (LinkKind::Rotary(_), Some(axis)) => {
            steps.extend(error().chain([Step::Rotary { axis, about: link.along.axis, sign }]));
            steps.extend(link.turned.back().map(|(about, degrees)| fixed(about, &degrees)));
        }
        _ => steps.extend(error()),
    }
    steps.retain(|step| !matches!(step, Step::Turn(parts) if parts.is_empty()));
    steps
}

/// What the errors of motors do to a link.
fn by_motors(equations: &Equations, link: usize) -> Vec<(MotionKind, Part)> {
    let moved = |(number, motion): (usize, &Motion)| -> Vec<(MotionKind, Part)> {
        let own = motion.by_motor.iter().filter(|moved| moved.link == link);
        let part =
            |moved: &Moved| Part { motion: number, axis: moved.kind.axis(), sign: to_f64(&moved.weight) };
        own.map(|moved| (moved.kind, part(moved))).collect()
    };
    equations.motions.iter().enumerate().flat_map(moved).collect()
}

/// The place of a link's frame at zero; NaN where a constant has no value.
fn place(equations: &Equations, link: &Link, constants: &[f64]) -> [f64; 3] {
    let value = |symbol: &Symbol| {
        let number = equations.constants.iter().position(|constant| constant.name == *symbol.name());
        number.and_then(|number| constants.get(number)).copied().unwrap_or(f64::NAN)
    };
    link.origin.each_ref().map(|sum| sum.evaluate(value))
}

fn sign(of: i64) -> f64 {
    if of < 0 { -1.0 } else { 1.0 }
}

impl Part {
    fn of(number: usize, motion: &Motion) -> Self {
        Self { motion: number, axis: motion.kind.axis(), sign: sign(motion.sign) }
    }

    fn opposite(self) -> Self {
        Self { sign: -self.sign, ..self }
    }
}

impl Step {
    /// The way back: a displacement back, a rotation by the opposite rotation vector.
    pub(super) fn inverse(self) -> Self {
        match self {
            Self::Place(place) => Self::Place(place.map(|part| -part)),
            Self::Travel { axis, direction, sign } => Self::Travel { axis, direction, sign: -sign },
            Self::Fixed { about, angle } => Self::Fixed { about, angle: -angle },
            Self::Rotary { axis, about, sign } => Self::Rotary { axis, about, sign: -sign },
            Self::Shift(part) => Self::Shift(part.opposite()),
            Self::Turn(parts) => Self::Turn(parts.into_iter().map(Part::opposite).collect()),
            Self::Line { angle, along, travel, sign } => Self::Line { angle, along, travel, sign: -sign },
        }
    }

    /// Takes the stands of all rows through the step; the rotation of the tool only where it is `turning` that counts.
    pub(super) fn take(&self, columns: &Columns<'_>, turning: bool, stands: &mut [Stand]) {
        match self {
            Self::Place(place) => stands.iter_mut().for_each(|stand| {
                stand.place.iter_mut().zip(place).for_each(|(part, by)| *part += by);
            }),
            Self::Travel { axis, direction, sign } => {
                for (stand, position) in stands.iter_mut().zip(columns.position(*axis)) {
                    stand.place[*direction] += sign * position;
                }
            }
            Self::Fixed { about, angle } => stands.iter_mut().for_each(|stand| stand.carry(*about, *angle)),
            Self::Rotary { axis, about, sign } => {
                for (stand, position) in stands.iter_mut().zip(columns.position(*axis)) {
                    stand.carry(*about, sign * position);
                }
            }
            Self::Shift(part) => {
                let Some(values) = columns.motion(part.motion) else { return };
                for (stand, value) in stands.iter_mut().zip(values) {
                    stand.away[part.axis.index()] += part.sign * value;
                }
            }
            Self::Turn(parts) => turn(parts, columns, turning, stands),
            Self::Line { angle, along, travel, sign } => {
                line(*angle, *along, travel, *sign, columns, stands);
            }
        }
    }
}

fn turn(parts: &[Part], columns: &Columns<'_>, turning: bool, stands: &mut [Stand]) {
    let acting = parts.iter().filter_map(|part| Some((part, columns.motion(part.motion)?)));
    let mut acting: Vec<_> = acting.collect();
    if acting.is_empty() {
        return;
    }
    for stand in stands {
        let mut vector = [0.0; 3];
        for (part, values) in &mut acting {
            vector[part.axis.index()] += part.sign * values.next().unwrap_or(f64::NAN);
        }
        stand.turn(&Quaternion::of(vector), turning);
    }
}

/// A line of length `t` along `u` that is turned by an angle about `a` ends aside of its end by `t (sin a x u + (cos - 1) u)`.
fn line(angle: Part, along: Axis, travel: &Travel, sign: f64, columns: &Columns<'_>, stands: &mut [Stand]) {
    let Some(values) = columns.motion(angle.motion).filter(|_| angle.axis != along) else { return };
    let (aside, side) = match along == angle.axis.next() {
        true => (along.next(), 1.0),
        false => (along.next().next(), -1.0),
    };
    let turned = |lengths: &mut dyn Iterator<Item = f64>| {
        for ((stand, value), length) in stands.iter_mut().zip(values).zip(lengths) {
            let mut vector = [0.0; 3];
            vector[angle.axis.index()] = angle.sign * value;
            let half = Quaternion::of(vector);
            let (sine, cosine) = (half.vector[angle.axis.index()], half.scalar);
            let length = sign * travel.sign * length;
            stand.away[aside.index()] += side * length * 2.0 * sine * cosine;
            stand.away[along.index()] -= length * 2.0 * sine * sine;
        }
    };
    match travel.free {
        Some(number) => turned(&mut columns.travel(number)),
        None => turned(&mut columns.position(travel.axis)),
    }
}
