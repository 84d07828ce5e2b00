//! The contestant that has no equations: the product of the matrices of all links, made in numbers at every call.
//!
//! In: a case. Out: the tip by nalgebra's 4x4 matrices, with the actual error motions, less where the generated
//! `nominal` puts it. It keeps products of two error motions, so that it agrees to the second order only. It exists to show
//! what the symbolic product saves.

use nalgebra::{Matrix4, Vector4};

use crate::case::Case;
use crate::chain::Link;
use crate::contest::{Answering, Contestant, Group};
use crate::machines::{excello_921, trunnion_5axis, xyfz_mill};
use crate::ours::{array, leak};

/// A link with its numbers.
#[derive(Debug)]
struct Body {
    link: Link,
    origin: [f64; 3],
}

/// The second order of what the cases hold, mm: angles of 5e-5 rad, fifteen of them at most, over a metre.
const SECOND_ORDER: f64 = (15.0 * 5e-5) * (15.0 * 5e-5 * 1000.0 + 15.0 * 0.02);

/// The contestants of a machine: none for the command, whose cost is that of as many errors.
pub(crate) fn contestants(case: &'static Case, group: Group) -> Vec<Box<dyn Contestant>> {
    let bodies: &'static [Body] = leak(bodies(case));
    macro_rules! of {
        ($machine:ident) => {{
            let constants = $machine::Constants::from_array(array(&case.constants));
            let machine = $machine::Machine { constants };
            boxed(case, group, bodies, move |position| {
                machine.nominal(&$machine::Axes::from_array(array(position)))
            })
        }};
    }
    match case.name {
        "excello-921" => of!(excello_921),
        "xyfz-mill" => of!(xyfz_mill),
        "trunnion-5axis" => of!(trunnion_5axis),
        _ => Vec::new(),
    }
}

fn boxed(
    case: &'static Case,
    group: Group,
    bodies: &'static [Body],
    nominal: impl Fn(&[f64]) -> [f64; 3] + Copy + 'static,
) -> Vec<Box<dyn Contestant>> {
    let sensitive = case.chain.sensitive;
    let error = move |position: &[f64], motions: &[f64]| {
        let (tip, nominal) = (tip(bodies, position, motions), nominal(position));
        std::array::from_fn(|row| if sensitive[row] { tip[row] - nominal[row] } else { 0.0 })
    };
    let mut values = vec![0.0; case.motions.len()];
    match group {
        Group::Equations => vec![contestant(move |state, out| {
            let state = &case.states[state];
            *out = error(&state.position, &state.motions);
        })],
        Group::Error => vec![contestant(move |state, out| {
            let state = &case.states[state];
            case.read(&state.position, &state.reversed, &mut values);
            *out = error(&state.position, &values);
        })],
        Group::Command => Vec::new(),
    }
}

fn contestant(answer: impl FnMut(usize, &mut [f64; 3]) + 'static) -> Box<dyn Contestant> {
    Box::new(Answering { name: "matrices (nalgebra)", tolerance: SECOND_ORDER, answer })
}

fn bodies(case: &Case) -> Vec<Body> {
    let value = |symbol: &model_dsl::algebra::Symbol| {
        let place = case.chain.constants.iter().position(|name| **name == **symbol.name());
        place.map_or(f64::NAN, |place| case.constants[place])
    };
    let body = |link: &Link| Body {
        origin: link.origin.each_ref().map(|part| part.evaluate(value)),
        link: link.clone(),
    };
    case.chain.links.iter().map(body).collect()
}

/// The tip in the frame of the part, by the product of all matrices.
#[inline(never)]
fn tip(bodies: &[Body], position: &[f64], motions: &[f64]) -> [f64; 3] {
    let (mut part, mut tool) = (Matrix4::identity(), Matrix4::identity());
    for body in bodies {
        let branch = if body.link.tool { &mut tool } else { &mut part };
        *branch *= displaced(body, position, motions);
        if let Some(drive) = body.link.drive.as_ref().filter(|drive| drive.rotary) {
            *branch *= turn(drive.axis, drive.sign * position[drive.variable]);
        }
    }
    let back = part.try_inverse().unwrap_or(Matrix4::repeat(f64::NAN));
    let tip = back * (tool * Vector4::new(0.0, 0.0, 0.0, 1.0));
    [tip.x, tip.y, tip.z]
}

/// Where a link stands, with its travel and its small errors.
fn displaced(body: &Body, position: &[f64], motions: &[f64]) -> Matrix4<f64> {
    let mut matrix = Matrix4::identity();
    let mut place = body.origin;
    if let Some(drive) = body.link.drive.as_ref().filter(|drive| !drive.rotary) {
        place[drive.axis] += drive.sign * position[drive.variable];
        for line in &body.link.lines {
            place[line.axis] += line.sign * motions[line.motion] * position[drive.variable];
        }
    }
    for small in &body.link.small {
        let size = small.sign * motions[small.motion];
        if small.angular {
            let (u, v) = ((small.axis + 1) % 3, (small.axis + 2) % 3);
            matrix[(u, v)] -= size;
            matrix[(v, u)] += size;
        } else {
            place[small.axis] += size;
        }
    }
    for (row, part) in place.into_iter().enumerate() {
        matrix[(row, 3)] = part;
    }
    matrix
}

fn turn(axis: usize, angle: f64) -> Matrix4<f64> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (sine, cosine) = angle.sin_cos();
    let mut matrix = Matrix4::identity();
    matrix[(u, u)] = cosine;
    matrix[(v, v)] = cosine;
    matrix[(u, v)] = -sine;
    matrix[(v, u)] = sine;
    matrix
}
