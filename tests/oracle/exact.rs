//! Exact homogeneous transformations over numbers: finite rotations, nothing linearised.
//!
//! In: the bodies of both branches. Out: the tool tip in the part's frame, as it really stands.

use nalgebra::{IsometryMatrix3, Rotation3, Translation3, Vector3};

use super::{Body, Machine, State};

/// The tool tip in the part's frame, mm.
pub(crate) fn tip(machine: &Machine, state: &State) -> [f64; 3] {
    let [part, tool] = machine.bodies(state).map(|branch| {
        branch.iter().fold(IsometryMatrix3::identity(), |product, body| product * displacement(body))
    });
    (part.inverse() * tool).translation.vector.into()
}

/// The displacement from the frame before a body to its own.
fn displacement(body: &Body) -> IsometryMatrix3<f64> {
    let place = shift(body.origin) * shift(body.offset) * turn(body.tilt);
    let error = shift(body.linear) * turn(body.angular);
    let direction = Vector3::from(body.direction);
    if body.turns {
        return place * error * turn((direction * body.position).into());
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
