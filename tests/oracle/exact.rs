//! Exact homogeneous transformations over numbers: finite rotations, nothing linearised.
//!
//! In: the bodies of both branches. Out: the tool tip in the part's frame, as it really stands, how the tool is turned, and where it points.

use nalgebra::{IsometryMatrix3, Rotation3, Translation3, Vector3};

use super::{Body, Machine, State};

/// The tool tip in the part's frame, mm.
pub(crate) fn tip(machine: &Machine, state: &State) -> [f64; 3] {
    pose(machine, state).translation.vector.into()
}

/// The direction of the tool from its tip towards the spindle, in the part's frame.
pub(crate) fn direction(machine: &Machine, state: &State) -> [f64; 3] {
    (pose(machine, state).rotation * Vector3::from(machine.tool_axis(state))).into()
}

/// By what the tool is turned away from where it stands without errors: a rotation vector in the part's frame, rad.
pub(crate) fn turn_by_errors(machine: &Machine, state: &State) -> [f64; 3] {
    turn_between(machine, &State { errors: Default::default(), ..state.clone() }, state)
}

/// By what the tool in a state is turned away from where it stands in another: a rotation vector in the part's frame, rad.
pub(crate) fn turn_between(machine: &Machine, wanted: &State, real: &State) -> [f64; 3] {
    let turned = pose(machine, real).rotation * pose(machine, wanted).rotation.inverse();
    // The skew part is the sine of the angle along the axis: sharp for small angles, where the cosine is 1 to rounding.
    let skew = (turned.matrix() - turned.matrix().transpose()) / 2.0;
    let sine = Vector3::new(skew[(2, 1)], skew[(0, 2)], skew[(1, 0)]);
    let length = sine.norm();
    if length == 0.0 { [0.0; 3] } else { (sine * (length.asin() / length)).into() }
}

/// The tool in the part's frame.
fn pose(machine: &Machine, state: &State) -> IsometryMatrix3<f64> {
    let [part, tool] = machine.bodies(state).map(|branch| {
        branch.iter().fold(IsometryMatrix3::identity(), |product, body| product * displacement(body))
    });
    part.inverse() * tool
}

/// The displacement from the frame before a body to its own.
fn displacement(body: &Body) -> IsometryMatrix3<f64> {
    let [a, b, c] = body.turned;
    let lean = Rotation3::from_euler_angles(a, b, c);
    let place = shift(body.origin) * lean * shift(body.offset) * turn(body.tilt);
    let error = shift(body.linear) * turn(body.angular);
    let direction = Vector3::from(body.direction);
    if body.turns {
        return place * error * turn((direction * body.position).into()) * lean.inverse();
    }
    let travel = shift((direction * body.position).into());
    let (line, carriage) = line(body);
    if body.bed { place * error * travel * line * carriage } else { place * travel * line * carriage * error }
}

/// What turned lines add to the travel, and the turn of a carriage that follows them.
fn line(body: &Body) -> (IsometryMatrix3<f64>, IsometryMatrix3<f64>) {
    let mut aside = Vector3::zeros();
    let mut followed = Vector3::zeros();
    for line in &body.lines {
        let angle = Vector3::from(line.angle);
        let travel = Vector3::from(body.direction) * line.travel;
        aside += Rotation3::from_scaled_axis(angle) * travel - travel;
        if line.rotates {
            followed += angle;
        }
    }
    (shift(aside.into()), turn(followed.into()))
}

fn shift(by: [f64; 3]) -> IsometryMatrix3<f64> {
    IsometryMatrix3::from_parts(Translation3::from(by), Rotation3::identity())
}

fn turn(by: [f64; 3]) -> IsometryMatrix3<f64> {
    IsometryMatrix3::from_parts(Translation3::identity(), Rotation3::from_scaled_axis(by.into()))
}
