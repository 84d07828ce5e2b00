//! Constant angles by which a link is turned: `leans` of a rotary axis, `turned` of a fixed link. In: the angles, or the direction of an axis
//! as a vector. Out: rotations one after the other, whose sines and cosines stay exact.
//!
//! Both are one thing, a frame that is turned against the frame before it. The axis of a nutating head turns in a frame that leans, with the
//! error motions of any axis in its own directions, and behind it the lean is turned back. So nothing else in the compiler has to know of
//! it: a matrix of Rodrigues for each direction would be a second kind of rotation beside that about X, Y and Z, and would leave open in
//! which directions the error motions of such an axis count.

use num_traits::{Signed as _, Zero};

use super::fields;
use crate::algebra::{Axis, Rational, decimal, sine_and_cosine};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::yaml::Node;

/// The most decimal places of an angle in degrees: doubles near 100 deg are 1e-14 deg apart, and a few roundings on the way from a vector to
/// its angles leave less than 1e-12 deg.
const MOST_PLACES: usize = 12;

/// Constant angles about X, then about Y, then about Z of the frame before: right-handed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Turned {
    degrees: [Rational; 3],
}

impl Turned {
    /// Whether it turns nothing.
    pub fn is_none(&self) -> bool {
        self.degrees.iter().all(Zero::is_zero)
    }

    /// The rotations as they stand in a product of matrices, the first on its left: `Rz Ry Rx`; deg. Those by no angle are left out.
    pub fn rotations(&self) -> impl DoubleEndedIterator<Item = (Axis, &Rational)> {
        let all = Axis::ALL.into_iter().zip(&self.degrees).rev();
        all.filter(|(_, degrees)| !degrees.is_zero())
    }

    /// The rotations of the way back, in the same order of writing: `Rx Ry Rz` of the opposite angles.
    pub fn back(&self) -> impl Iterator<Item = (Axis, Rational)> {
        self.rotations().rev().map(|(axis, degrees)| (axis, -degrees))
    }

    /// A direction of the turned frame, seen from the frame before it.
    pub fn carry(&self, vector: [f64; 3]) -> [f64; 3] {
        self.rotations().rev().fold(vector, |vector, (axis, degrees)| rotated(vector, axis, degrees))
    }

    /// A direction of the frame before it, seen from the turned one.
    pub fn carry_back(&self, vector: [f64; 3]) -> [f64; 3] {
        self.rotations().fold(vector, |vector, (axis, degrees)| rotated(vector, axis, &-degrees))
    }

    /// The lean that brings a direction of a frame, `own`, to a vector with a positive part along it: two rotations at most.
    pub(super) fn towards(own: Axis, vector: [f64; 3]) -> Option<Self> {
        let size = vector.iter().fold(0.0_f64, |size, part| size.max(part.abs()));
        let [x, y, z] = vector.map(|part| part / size);
        let angles = match own {
            Axis::X => [0.0, (-z).atan2(x.hypot(y)), y.atan2(x)],
            Axis::Y => [z.atan2(x.hypot(y)), 0.0, (-x).atan2(y)],
            Axis::Z => [(-y).atan2(x.hypot(z)), x.atan2(z), 0.0],
        };
        let [a, b, c] = angles.map(|angle| rounded(angle.to_degrees()));
        Some(Self { degrees: [a?, b?, c?] })
    }

    /// The angles as a machine file writes them: `{A: 45 deg}`.
    pub fn words(&self) -> String {
        let angle = |(axis, degrees): (Axis, &Rational)| {
            format!("{}: {} deg", axis.rotation_letter(), decimals(degrees))
        };
        let angles: Vec<String> = self.rotations().rev().map(angle).collect();
        format!("{{{}}}", angles.join(", "))
    }
}

fn rotated(vector: [f64; 3], axis: Axis, degrees: &Rational) -> [f64; 3] {
    let (sine, cosine) = sine_and_cosine(degrees);
    // They hold no symbols that are not numbers.
    let (sine, cosine) = (sine.evaluate(|_| f64::NAN), cosine.evaluate(|_| f64::NAN));
    let (u, v) = (axis.next().index(), axis.next().next().index());
    let mut rotated = vector;
    rotated[u] = cosine * vector[u] - sine * vector[v];
    rotated[v] = sine * vector[u] + cosine * vector[v];
    rotated
}

/// Reads the angles of a link.
pub(super) fn read(node: &Node, diagnostics: &mut Diagnostics) -> Option<Turned> {
    let fields = fields::open(node, "the angles of a link", &["A", "B", "C"], diagnostics)?;
    let mut read = |axis: Axis| match fields.get(&axis.rotation_letter().to_string()) {
        Some(node) => angle(node, diagnostics),
        None => Some(Rational::zero()),
    };
    let [x, y, z] = Axis::ALL.map(&mut read);
    Some(Turned { degrees: [x?, y?, z?] })
}

fn angle(node: &Node, diagnostics: &mut Diagnostics) -> Option<Rational> {
    let written = fields::text(node, "an angle", diagnostics)?;
    let number = written.strip_suffix("deg").map(str::trim_end).and_then(decimal);
    let reason = match &number {
        None => "not a number of degrees",
        Some(degrees) if degrees.abs() > Rational::from_integer(180.into()) => "more than half a turn",
        Some(degrees) if !is_short(degrees) => "more decimal places than an angle may have",
        Some(_) => return number,
    };
    diagnostics.push(
        Diagnostic::error("E0151", node.span, format!("`{written}` is not a constant angle"))
            .label(reason)
            .help(format!(
                "write it in degrees, `45 deg`, from -180 to 180 deg and with {MOST_PLACES} decimal places at most"
            )),
    );
    None
}

/// Whether an angle has at most [`MOST_PLACES`] decimal places.
fn is_short(degrees: &Rational) -> bool {
    (degrees * scale()).is_integer()
}

fn scale() -> Rational {
    Rational::from_integer(num_traits::pow(10.into(), MOST_PLACES))
}

fn rounded(degrees: f64) -> Option<Rational> {
    decimal(&format!("{degrees:.MOST_PLACES$}"))
}

/// The decimals of an angle, without zeros behind the last digit.
fn decimals(degrees: &Rational) -> String {
    let sign = if degrees.is_negative() { "-" } else { "" };
    let digits = (degrees * scale()).to_integer().magnitude().to_string();
    let padded = format!("{digits:0>width$}", width = MOST_PLACES + 1);
    let (whole, fraction) = padded.split_at(padded.len() - MOST_PLACES);
    match fraction.trim_end_matches('0') {
        "" => format!("{sign}{whole}"),
        fraction => format!("{sign}{whole}.{fraction}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn towards(own: Axis, vector: [f64; 3]) -> Turned {
        Turned::towards(own, vector).expect("angles")
    }

    #[test]
    fn usual_heads_lean_by_the_angles_of_their_prospectus() {
        assert_eq!(towards(Axis::Y, [0.0, 1.0, 1.0]).words(), "{A: 45 deg}");
        assert_eq!(towards(Axis::Y, [0.0, 0.707, 0.707]).words(), "{A: 45 deg}");
        assert_eq!(towards(Axis::Z, [0.0, -1.0, 1.0]).words(), "{A: 45 deg}");
        assert_eq!(towards(Axis::X, [3.0, 0.0, -3.0]).words(), "{B: 45 deg}");
        assert_eq!(towards(Axis::Z, [1.0, 0.0, 1.0]).words(), "{B: 45 deg}");
        assert_eq!(towards(Axis::Y, [0.0, 1e300, 1e300]).words(), "{A: 45 deg}");
    }

    /// Whatever the vector, the lean carries the axis to it.
    #[test]
    fn a_lean_brings_the_axis_to_the_vector() {
        for own in Axis::ALL {
            for (a, b) in [(0.0, 0.3), (-2.0, 0.0), (0.7, -1.9), (-0.2, -0.4), (5.0, 5.0)] {
                let mut vector = [0.0; 3];
                vector[own.index()] = 1.0;
                vector[own.next().index()] = a;
                vector[own.next().next().index()] = b;
                let mut start = [0.0; 3];
                start[own.index()] = vector.iter().map(|part| part * part).sum::<f64>().sqrt();
                let carried = towards(own, vector).carry(start);
                let near = |left: [f64; 3], right: [f64; 3]| {
                    left.iter().zip(right).all(|(left, right)| (left - right).abs() < 1e-12)
                };
                assert!(near(carried, vector), "{own:?} {vector:?} {carried:?}");
                assert!(near(towards(own, vector).carry_back(vector), start));
            }
        }
    }

    #[test]
    fn angles_are_written_as_they_were_read() {
        for (text, written) in [(42.5, "42.5"), (-0.125, "-0.125"), (7.0, "7"), (-90.0, "-90")] {
            assert_eq!(decimals(&rounded(text).expect("a number")), written);
        }
    }
}
