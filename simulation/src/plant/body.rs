//! Bodies: the links of a chain with numbers in them.
//!
//! In: a validated machine, the values of its constants, positions and error motions. Out: the frame of the tool tip and
//! that of the part, as they really stand: finite rotations, nothing linearised. The signs and places of the error
//! motions are read from the machine's conventions here a second time, so that no first-order code is needed or believed.

use model_dsl::algebra::{Axis, Symbol, to_f64};
use model_dsl::calibration::MachineNames;
use model_dsl::machine::{Branch, Link, LinkKind, Machine, Motion, MotionKind, Moved, Reference};
use nalgebra::{Rotation3, Vector3};

use super::PlantError;

/// A frame, seen from another one: a rotation and the place of the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) rotation: Rotation3<f64>,
    pub(super) origin: Vector3<f64>,
}

impl Frame {
    fn identity() -> Self {
        Self { rotation: Rotation3::identity(), origin: Vector3::zeros() }
    }

    /// Goes on by a displacement in the present frame's directions.
    fn shift(&mut self, by: Vector3<f64>) {
        self.origin += self.rotation * by;
    }

    /// Goes on by a finite rotation about the direction of `by`, through its length in rad.
    fn turn(&mut self, by: Vector3<f64>) {
        if by != Vector3::zeros() {
            self.rotation *= Rotation3::from_scaled_axis(by);
        }
    }
}

/// One link.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// The place of its frame at zero, in the frame before it: mm.
    origin: Vector3<f64>,
    /// The direction of positive programmed motion, or the axis of rotation.
    direction: Vector3<f64>,
    /// The axis that moves it.
    axis: Option<usize>,
    turns: bool,
    /// How the body's frame is turned for good against the frame before it; a rotary axis turns that back behind itself.
    turned: Rotation3<f64>,
    /// Whether rotations act about the origin that stays with the bed.
    bed: bool,
    errors: Vec<BodyError>,
}

/// An error motion as it moves its body.
#[derive(Clone, Copy, Debug)]
struct BodyError {
    /// Its number among the names of the machine.
    motion: usize,
    /// From the calibration's value to bed directions: +1 or -1, or the weight of the error of a motor.
    sign: f64,
    place: Place,
    direction: usize,
}

#[derive(Clone, Copy, Debug)]
enum Place {
    /// Displaces the body.
    Shift,
    /// Turns the body.
    Turn,
    /// Displaces the place of a rotary axis or spindle.
    Offset,
    /// Tilts a rotary axis or spindle.
    Tilt,
    /// Turns the line of motion of a slide, and its carriage where `carriage` says so.
    Line { carriage: bool },
}

/// What the error motions of a body add up to.
#[derive(Default)]
struct Errors {
    shift: Vector3<f64>,
    turn: Vector3<f64>,
    offset: Vector3<f64>,
    tilt: Vector3<f64>,
    aside: Vector3<f64>,
    carriage: Vector3<f64>,
}

impl Body {
    /// Goes on from the frame before the body to its own.
    fn step(&self, frame: &mut Frame, positions: &[f64], motions: &[f64]) {
        let position = self.axis.and_then(|axis| positions.get(axis)).copied().unwrap_or(0.0);
        let along = self.direction * position;
        let errors = self.errors(along, motions);
        frame.shift(self.origin);
        frame.rotation *= self.turned;
        frame.shift(errors.offset);
        frame.turn(errors.tilt);
        if self.turns || self.bed {
            frame.shift(errors.shift);
            frame.turn(errors.turn);
        }
        if self.turns {
            frame.turn(along);
            frame.rotation *= self.turned.inverse();
            return;
        }
        frame.shift(along + errors.aside);
        frame.turn(errors.carriage);
        if !self.bed {
            frame.shift(errors.shift);
            frame.turn(errors.turn);
        }
    }

    /// Adds up the error motions; `along` is the programmed travel of a slide.
    fn errors(&self, along: Vector3<f64>, motions: &[f64]) -> Errors {
        let mut errors = Errors::default();
        for error in &self.errors {
            let value = error.sign * motions.get(error.motion).copied().unwrap_or(0.0);
            let slot = match error.place {
                Place::Shift => &mut errors.shift,
                Place::Turn => &mut errors.turn,
                Place::Offset => &mut errors.offset,
                Place::Tilt => &mut errors.tilt,
                Place::Line { carriage } => {
                    let mut angle = Vector3::zeros();
                    add(&mut angle, error.direction, value);
                    errors.aside += turned_aside(angle, along);
                    if carriage {
                        errors.carriage += angle;
                    }
                    continue;
                }
            };
            add(slot, error.direction, value);
        }
        errors
    }
}

/// How far the end of a line leaves its place when the line is turned about its beginning.
fn turned_aside(angle: Vector3<f64>, line: Vector3<f64>) -> Vector3<f64> {
    if angle == Vector3::zeros() {
        Vector3::zeros()
    } else {
        Rotation3::from_scaled_axis(angle) * line - line
    }
}

fn add(vector: &mut Vector3<f64>, direction: usize, value: f64) {
    if let Some(entry) = vector.get_mut(direction) {
        *entry += value;
    }
}

/// The frame at the end of a branch that begins at the bed.
pub(super) fn end(bodies: &[Body], positions: &[f64], motions: &[f64]) -> Frame {
    let mut frame = Frame::identity();
    bodies.iter().for_each(|body| body.step(&mut frame, positions, motions));
    frame
}

/// The direction in which a rotary axis turns its body, in bed directions, without errors.
pub(super) fn direction_of(bodies: &[Body], axis: usize, positions: &[f64]) -> Option<Vector3<f64>> {
    let mut frame = Frame::identity();
    for body in bodies {
        if body.axis == Some(axis) {
            return Some(frame.rotation * (body.turned * body.direction));
        }
        body.step(&mut frame, positions, &[]);
    }
    None
}

/// The bodies of one branch, from the bed outwards.
pub(super) fn branch(
    machine: &Machine,
    branch: Branch,
    names: &MachineNames,
    constants: &[f64],
) -> Result<Vec<Body>, PlantError> {
    machine.branch(branch).map(|(number, link)| body(machine, number, link, names, constants)).collect()
}

fn body(
    machine: &Machine,
    number: usize,
    link: &Link,
    names: &MachineNames,
    constants: &[f64],
) -> Result<Body, PlantError> {
    let letter = link.kind.letter().map(String::from);
    let axis = match &letter {
        Some(letter) => {
            Some(names.axis(letter).ok_or_else(|| PlantError::OtherMachine(format!("axis {letter}")))?)
        }
        None => None,
    };
    // A motion that the names lack has no numbers: it is zero.
    let known = |motion: &Motion| names.motions.iter().position(|name| name.name == motion.name);
    let own = machine.motions.iter().filter(|motion| motion.link == number && motion.motor.is_none());
    let errors = own.filter_map(|motion| Some(body_error(motion, known(motion)?, link, machine.relative)));
    let of_motors = machine.motions.iter().filter_map(|motion| {
        let motor = machine.motors.get(motion.motor?)?;
        Some((known(motion)?, motor.moves.iter().filter(|moved| moved.link == number)))
    });
    let of_motors = of_motors.flat_map(|(motion, moves)| moves.map(move |moved| motor_error(motion, moved)));
    let mut direction = Vector3::zeros();
    if axis.is_some() {
        add(&mut direction, link.along.axis.index(), if link.along.sign < 0 { -1.0 } else { 1.0 });
    }
    Ok(Body {
        origin: origin(link, names, constants)?,
        direction,
        axis,
        turns: matches!(link.kind, LinkKind::Rotary(_)),
        turned: turned(link),
        bed: link.reference == Reference::Bed && matches!(link.kind, LinkKind::Slide(_)),
        errors: errors.chain(of_motors).collect(),
    })
}

/// Each rotation in turn is about a direction of the frame before the link: X, then Y, then Z.
fn turned(link: &Link) -> Rotation3<f64> {
    link.turned.rotations().fold(Rotation3::identity(), |turned, (axis, degrees)| {
        let mut vector = Vector3::zeros();
        add(&mut vector, axis.index(), to_f64(degrees).to_radians());
        turned * Rotation3::from_scaled_axis(vector)
    })
}

fn origin(link: &Link, names: &MachineNames, constants: &[f64]) -> Result<Vector3<f64>, PlantError> {
    let mut missing = None;
    let coordinates = link.origin.each_ref().map(|sum| {
        sum.evaluate(|symbol| match symbol {
            Symbol::Constant(name) => {
                let at = names.constants.iter().position(|(known, _)| known.as_str() == &**name);
                at.and_then(|at| constants.get(at)).copied().unwrap_or_else(|| {
                    missing = Some(name.to_string());
                    f64::NAN
                })
            }
            // An origin holds constants only.
            _ => 0.0,
        })
    });
    match missing {
        Some(name) => Err(PlantError::OtherMachine(format!("constant {name}"))),
        None => Ok(Vector3::from(coordinates)),
    }
}

/// What the error of a motor does to a body.
fn motor_error(motion: usize, moved: &Moved) -> BodyError {
    let place = if moved.kind.angular() { Place::Turn } else { Place::Shift };
    BodyError { motion, sign: to_f64(&moved.weight), place, direction: moved.kind.axis().index() }
}

fn body_error(motion: &Motion, known: usize, link: &Link, relative: bool) -> BodyError {
    let slide = matches!(link.kind, LinkKind::Slide(_));
    let (place, direction) = match motion.kind {
        MotionKind::Linear(axis) => (Place::Shift, axis),
        MotionKind::Angular(axis) => (Place::Turn, axis),
        MotionKind::Offset(axis) => (Place::Offset, axis),
        MotionKind::Alignment(axis) if slide => (Place::Line { carriage: motion.rotates }, axis),
        MotionKind::Alignment(axis) => (Place::Tilt, axis),
    };
    let sign = sense(motion, link, direction, relative);
    BodyError { motion: known, sign, place, direction: direction.index() }
}

/// The sign from a motion's value to bed directions.
///
/// An error motion moves its own body. Only what goes the link's own way is counted along `along`, so that it is actual
/// minus commanded. With `motions: relative` the motions are those of the tool seen from the part, so every other sign
/// turns on the part's branch; but the line of a slide is turned the same way from whichever side it is seen.
fn sense(motion: &Motion, link: &Link, direction: Axis, relative: bool) -> f64 {
    let own_way = direction == link.along.axis
        && match link.kind {
            LinkKind::Slide(_) => matches!(motion.kind, MotionKind::Linear(_)),
            LinkKind::Rotary(_) => matches!(motion.kind, MotionKind::Angular(_) | MotionKind::Alignment(_)),
            _ => false,
        };
    let line = matches!(link.kind, LinkKind::Slide(_)) && matches!(motion.kind, MotionKind::Alignment(_));
    if own_way {
        return if link.along.sign < 0 { -1.0 } else { 1.0 };
    }
    if relative && link.branch == Branch::Workpiece && !line { -1.0 } else { 1.0 }
}
