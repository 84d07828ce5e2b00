//! Where the tool stands on its way from link to link: a point, what it is away from it, and how the tool is turned.
//!
//! In: finite rotations. Out: the same seen from the next frame. A rotation by errors is a quaternion, of which the vector
//! is small where the angle is: what it adds to a point is small too, and is no difference of large numbers.

use abbe_runtime::math::sin_cos;

use crate::algebra::Axis;

/// One row: the tool tip in the present frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stand {
    /// Where it would stand without errors: mm.
    pub(super) place: [f64; 3],
    /// By what it is away from there.
    pub(super) away: [f64; 3],
    /// By what the errors have turned the tool, in the directions of the present frame.
    pub(super) turned: Quaternion,
}

/// A rotation by an angle about a direction: the cosine of half the angle, and the direction times its sine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quaternion {
    pub(super) scalar: f64,
    pub(super) vector: [f64; 3],
}

impl Default for Quaternion {
    fn default() -> Self {
        Self { scalar: 1.0, vector: [0.0; 3] }
    }
}

impl Stand {
    /// Goes through the rotation of a rotary axis, which is no error: everything turns with it.
    pub(super) fn carry(&mut self, about: Axis, angle: f64) {
        let (sine, cosine) = sin_cos(angle);
        let (u, v) = (about.next().index(), about.next().next().index());
        for vector in [&mut self.place, &mut self.away, &mut self.turned.vector] {
            (vector[u], vector[v]) =
                (cosine * vector[u] - sine * vector[v], sine * vector[u] + cosine * vector[v]);
        }
    }

    /// Goes through a rotation by errors.
    pub(super) fn turn(&mut self, by: &Quaternion, turning: bool) {
        let real = [0, 1, 2].map(|d| self.place[d] + self.away[d]);
        let moved = by.moves(real);
        self.away.iter_mut().zip(moved).for_each(|(part, moved)| *part += moved);
        if turning {
            self.turned = by.after(&self.turned);
        }
    }
}

impl Quaternion {
    /// The rotation of a rotation vector, rad.
    pub(super) fn of(vector: [f64; 3]) -> Self {
        let half = vector.map(|part| 0.5 * part);
        let (cardinal, cosine) = half_turn(dot(half, half));
        Self { scalar: cosine, vector: half.map(|part| part * cardinal) }
    }

    /// By what it moves a point: `2 (w v x p + v x (v x p))`.
    fn moves(&self, point: [f64; 3]) -> [f64; 3] {
        let once = cross(self.vector, point);
        let twice = cross(self.vector, once);
        [0, 1, 2].map(|d| 2.0 * (self.scalar * once[d] + twice[d]))
    }

    /// This rotation after another one.
    fn after(&self, first: &Self) -> Self {
        let across = cross(self.vector, first.vector);
        Self {
            scalar: self.scalar * first.scalar - dot(self.vector, first.vector),
            vector: [0, 1, 2]
                .map(|d| self.scalar * first.vector[d] + first.scalar * self.vector[d] + across[d]),
        }
    }

    /// The rotation vector, rad, of less than half a turn.
    pub(super) fn rotation_vector(&self) -> [f64; 3] {
        let sine = dot(self.vector, self.vector).sqrt();
        // Of no rotation at all the vector is that of its half angle, twice.
        let factor = if sine == 0.0 { 2.0 } else { 2.0 * sine.atan2(self.scalar) / sine };
        self.vector.map(|part| factor * part)
    }
}

/// sin(h)/h and cos(h), of the square of h.
///
/// Up to a tenth of a rad, which no error is beyond, by their series: the first terms left out are below 3e-18.
fn half_turn(square: f64) -> (f64, f64) {
    const NEAR: f64 = 0.01;
    if square <= NEAR {
        let cardinal = [72.0, 42.0, 20.0, 6.0];
        let cosine = [90.0, 56.0, 30.0, 12.0, 2.0];
        let sum = |divisors: &[f64]| divisors.iter().fold(1.0, |sum, divisor| 1.0 - square / divisor * sum);
        (sum(&cardinal), sum(&cosine))
    } else {
        let angle = square.sqrt();
        let (sine, cosine) = sin_cos(angle);
        (sine / angle, cosine)
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
