//! Dual numbers: values with a first derivative, whose square is nothing.
//!
//! In: the bodies of both branches, every error a pure derivative. Out: the tool tip in the part's frame and its first-order
//! change. The product of two errors vanishes in the arithmetic of each number, not in an algebra of expressions.

use std::ops::{Add, Mul, Neg};

use super::{Body, Machine, State};

/// `value + change * epsilon` with `epsilon^2 = 0`.
#[derive(Clone, Copy, Debug, Default)]
struct Dual {
    value: f64,
    change: f64,
}

/// A rigid frame: rows of a rotation, and a place.
#[derive(Clone, Copy, Debug)]
struct Frame {
    rotation: [[Dual; 3]; 3],
    place: [Dual; 3],
}

/// The tool tip in the part's frame and its change by the errors and rates of the state, mm.
pub(crate) fn tip(machine: &Machine, state: &State) -> ([f64; 3], [f64; 3]) {
    let [part, tool] = machine
        .bodies(state)
        .map(|branch| branch.iter().fold(Frame::rest(), |product, body| product.then(&frame(body))));
    let gap: [Dual; 3] = std::array::from_fn(|row| tool.place[row] + -part.place[row]);
    let seen: [Dual; 3] = std::array::from_fn(|column| {
        (0..3).fold(Dual::default(), |sum, row| sum + part.rotation[row][column] * gap[row])
    });
    (seen.map(|part| part.value), seen.map(|part| part.change))
}

fn frame(body: &Body) -> Frame {
    let origin = body.origin.map(plain);
    let position = Dual { value: body.position, change: body.rate };
    let way = body.direction.map(|part| plain(part) * position);
    let place = Frame::shift(origin)
        .then(&lean(body.turned))
        .then(&Frame::shift(body.offset.map(small)))
        .then(&Frame::turns(body.tilt.map(small)));
    let error = Frame::shift(body.linear.map(small)).then(&Frame::turns(body.angular.map(small)));
    if body.turns {
        let [a, b, c] = body.turned.map(|angle| -angle);
        let back = lean([a, 0.0, 0.0]).then(&lean([0.0, b, 0.0])).then(&lean([0.0, 0.0, c]));
        return place.then(&error).then(&Frame::turns(way)).then(&back);
    }
    let mut carriage = Frame::shift(way);
    for line in &body.lines {
        let turned = cross(line.angle, body.direction.map(|part| part * line.travel));
        carriage = carriage.then(&Frame::shift(turned.map(small)));
        if line.rotates {
            carriage = carriage.then(&Frame::turns(line.angle.map(small)));
        }
    }
    if body.bed { place.then(&error).then(&carriage) } else { place.then(&carriage).then(&error) }
}

/// Turned for good: about X, then Y, then Z of the outer frame, so that the last of these stands first in the product.
fn lean([a, b, c]: [f64; 3]) -> Frame {
    let one = |angles: [f64; 3]| Frame::turns(angles.map(plain));
    one([0.0, 0.0, c]).then(&one([0.0, b, 0.0])).then(&one([a, 0.0, 0.0]))
}

fn plain(value: f64) -> Dual {
    Dual { value, change: 0.0 }
}

fn small(change: f64) -> Dual {
    Dual { value: 0.0, change }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl Dual {
    fn sin(self) -> Self {
        Self { value: self.value.sin(), change: self.change * self.value.cos() }
    }

    fn cos(self) -> Self {
        Self { value: self.value.cos(), change: -self.change * self.value.sin() }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, change: self.change + other.change }
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, change: -self.change }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            change: self.value * other.change + self.change * other.value,
        }
    }
}

impl Frame {
    fn rest() -> Self {
        Self::shift([Dual::default(); 3])
    }

    fn shift(place: [Dual; 3]) -> Self {
        let rotation = std::array::from_fn(|row| {
            std::array::from_fn(|column| plain(f64::from(u8::from(row == column))))
        });
        Self { rotation, place }
    }

    /// Turned about X, then Y, then Z; two of the angles are zero or all are small, so that their order does not matter.
    fn turns(angles: [Dual; 3]) -> Self {
        (0..3).fold(Self::rest(), |turned, axis| {
            let mut turn = Self::rest();
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            turn.rotation[u][u] = angles[axis].cos();
            turn.rotation[v][v] = angles[axis].cos();
            turn.rotation[v][u] = angles[axis].sin();
            turn.rotation[u][v] = -angles[axis].sin();
            turned.then(&turn)
        })
    }

    fn then(&self, inner: &Self) -> Self {
        let product = |row: usize, column: [Dual; 3]| {
            (0..3).fold(Dual::default(), |sum, k| sum + self.rotation[row][k] * column[k])
        };
        let rotation = std::array::from_fn(|row| {
            std::array::from_fn(|column| product(row, std::array::from_fn(|k| inner.rotation[k][column])))
        });
        let place = std::array::from_fn(|row| self.place[row] + product(row, inner.place));
        Self { rotation, place }
    }
}
