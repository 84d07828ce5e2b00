//! Which angles of the rotary axes undo an error of the tool's direction.
//!
//! In: what each rotary axis turns the direction by. Out: the shortest turn of the axes that brings the direction back, as far as they
//! can without turning too far. It exists beside the same question of the tip, since here every five-axis machine has a pose in which one
//! of its axes turns nothing, and works there every day.

use super::super::Kinematics;
use super::super::math::{add_scaled, dot, length, sqrt};
use super::super::real::Real;
use super::report::GREATEST_AMPLIFICATION;

/// ISO 841 names three rotary axes: A, B and C.
pub(super) const AXES: usize = 3;

/// The least square that an error is divided by: an axis turns at most a hundred times as far as the direction.
const LEAST: Real = 1.0 / (GREATEST_AMPLIFICATION * GREATEST_AMPLIFICATION);

/// The columns of T, which turn the direction, and how far they turn it.
///
/// The direction d of the tool is a vector of length 1, so that `T T^T` has no more than two squares s^2 that are not zero, across d: s is
/// how far the direction goes that way where the axes turn by 1 rad together. An error that way takes `1 / s` times itself of the axes.
/// Where s is less than 1/100, as in front of the pose in which C lies along the tool, it takes `s / (1/100)^2` times itself: never more
/// than 100 times, without a jump in front of that pose or in it, and nothing in it. What then stays of the error is told.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Tilts {
    columns: [[Real; 3]; AXES],
    /// The greater of the two squares.
    greater: Real,
    /// The lesser.
    less: Real,
}

impl Tilts {
    /// Those of a machine at a position.
    pub(super) fn at<K: Kinematics + ?Sized>(kinematics: &K, position: &[Real]) -> Self {
        let mut columns = [[0.0; 3]; AXES];
        kinematics.aims(position, &mut columns);
        Self::new(columns)
    }

    fn new(columns: [[Real; 3]; AXES]) -> Self {
        let [first, second, third] = columns;
        let trace: Real = columns.iter().map(|column| dot(*column, *column)).sum();
        let pairs = [[first, second], [second, third], [third, first]];
        let product: Real = pairs.into_iter().map(|[left, right]| area_squared(left, right)).sum();
        let greater = (trace + sqrt((trace * trace - 4.0 * product).max(0.0))) / 2.0;
        // Not by the difference from the trace, of which rounding would leave nothing that is small.
        let less = if greater > 0.0 { (product / greater).min(greater) } else { 0.0 };
        Self { columns, greater, less }
    }

    /// The angles of the axes that turn the direction by as much of this as they may, rad.
    ///
    /// Where they would turn by more than `most` together since they turn the direction too little one way, they turn by so much that
    /// way, or by as much as the error there, whichever is more: a limit cuts what the pose makes of an error, and not the error.
    pub(super) fn angles(&self, lean: [Real; 3], most: Real) -> [Real; AXES] {
        let hard = self.hardest(lean);
        let easy = add_scaled(lean, -1.0, hard);
        let first = cut(self.undone(easy, self.greater), most.max(length(easy)));
        let room = sqrt((most * most - dot(first, first)).max(0.0));
        add_scaled(first, 1.0, cut(self.undone(hard, self.less), room.max(length(hard))))
    }

    /// The part of an error in the direction in which the axes turn the tool least.
    fn hardest(&self, lean: [Real; 3]) -> [Real; 3] {
        let gap = self.greater - self.less;
        if gap > 0.0 {
            let of_greater = add_scaled([0.0; 3], self.greater / gap, lean);
            add_scaled(of_greater, -1.0 / gap, self.turned(self.shares(lean)))
        } else {
            [0.0; 3]
        }
    }

    /// The angles that undo an error in a direction in which the axes turn the tool by the root of this.
    fn undone(&self, lean: [Real; 3], square: Real) -> [Real; AXES] {
        self.shares(lean).map(|share| share / square.max(LEAST))
    }

    /// What these angles turn the direction by, rad.
    pub(super) fn turned(&self, angles: [Real; AXES]) -> [Real; 3] {
        self.columns.iter().zip(angles).fold([0.0; 3], |sum, (&column, angle)| add_scaled(sum, angle, column))
    }

    fn shares(&self, vector: [Real; 3]) -> [Real; AXES] {
        self.columns.map(|column| dot(column, vector))
    }
}

/// A turn, shortened to a bound where it is longer.
fn cut(turn: [Real; AXES], bound: Real) -> [Real; AXES] {
    let wanted = length(turn);
    if wanted > bound { turn.map(|angle| angle * (bound / wanted)) } else { turn }
}

/// The square of the area between two vectors.
fn area_squared([a, b, c]: [Real; 3], [d, e, f]: [Real; 3]) -> Real {
    let across = [b * f - c * e, c * d - a * f, a * e - b * d];
    dot(across, across)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tool stands along Z; what turns it moves its end in X and Y.
    fn axes(columns: [[Real; 2]; AXES]) -> Tilts {
        Tilts::new(columns.map(|[x, y]| [x, y, 0.0]))
    }

    fn left(tilts: &Tilts, lean: [Real; 3]) -> [Real; 3] {
        add_scaled(lean, -1.0, tilts.turned(tilts.angles(lean, Real::INFINITY)))
    }

    const LEAN: [Real; 3] = [30e-6, -40e-6, 0.0];

    /// Its length.
    const SIZE: Real = 50e-6;

    /// Whether a number is the expected one, of something of this size: a few sums round, and axes turn up to a hundred times as far.
    fn near(found: Real, expected: Real, size: Real) -> bool {
        (found - expected).abs() <= 1024.0 * Real::EPSILON * size
    }

    #[test]
    fn two_axes_turn_any_way() {
        for second in [[0.0, 1.0], [0.6, 0.8], [-0.999, 0.02], [0.3, 0.02]] {
            let tilts = axes([[1.0, 0.0], second, [0.0; 2]]);
            // What is rounded of the one square is divided by the other, which is down to a ten thousandth.
            let rounded = Real::EPSILON * SIZE / LEAST;
            assert!(length(left(&tilts, LEAN)) <= rounded, "{second:?}");
        }
        // 2 (1, 0) + 5 (0.6, 0.8) = (5, 4)
        let [first, second, third] =
            axes([[1.0, 0.0], [0.6, 0.8], [0.0; 2]]).angles([5.0, 4.0, 0.0], Real::INFINITY);
        assert!(near(first, 2.0, 2.0) && near(second, 5.0, 5.0) && third == 0.0);
    }

    #[test]
    fn three_axes_share() {
        // The least squares of 2 = u + v and 3 = w.
        let [u, v, w] = axes([[1.0, 0.0], [1.0, 0.0], [0.0, -1.0]]).angles([2.0, 3.0, 0.0], Real::INFINITY);
        assert!(near(u, 1.0, 1.0) && near(v, 1.0, 1.0) && near(w, -3.0, 3.0));
    }

    #[test]
    fn one_axis_turns_its_own_way_and_none_nowhere() {
        let one = axes([[0.0; 2], [0.5, 0.0], [0.0; 2]]);
        let [_, angle, _] = one.angles(LEAN, Real::INFINITY);
        assert!(near(angle, 60e-6, SIZE));
        assert!(near(length(add_scaled(left(&one, LEAN), -1.0, [0.0, LEAN[1], 0.0])), 0.0, SIZE));
        assert_eq!(axes([[0.0; 2]; AXES]).angles(LEAN, Real::INFINITY), [0.0; AXES]);
        // In front of its singular pose a single axis is held to the limit as the second of two is: 40 urad / 0.02 are 2 mrad.
        let weak = axes([[0.0, 0.02], [0.0; 2], [0.0; 2]]);
        let [free, limited] = [Real::INFINITY, 1e-3].map(|most| weak.angles([0.0, -40e-6, 0.0], most)[0]);
        assert!(near(free, -2e-3, 2e-3) && near(limited, -1e-3, 1e-3), "{free} {limited}");
    }

    /// In front of the pose in which the second axis turns nothing: the exact answer as far as it is no more than a hundred times the
    /// error, and from there less and less, without a jump.
    #[test]
    fn no_axis_turns_more_than_a_hundred_times_as_far() {
        let second = |reach: Real| {
            axes([[1.0, 0.0], [0.0, reach], [0.0; 2]]).angles(LEAN, Real::INFINITY)[1] / LEAN[1]
        };
        for (reach, gain) in [
            (1.0, 1.0),
            (0.02, 50.0),
            (0.01, 100.0),
            (0.009, 90.0),
            (-0.005, -50.0),
            (1e-6, 0.01),
            (0.0, 0.0),
        ] {
            assert!(near(second(reach), gain, gain.abs()), "{reach}: {} is not {gain}", second(reach));
        }
        let skew = |reach: Real| axes([[0.8, 0.6], [0.8, 0.6 + reach], [0.0; 2]]);
        for step in -2000_i16..2000 {
            let reach = Real::from(step) * 1e-5;
            let (here, next) =
                (skew(reach).angles(LEAN, Real::INFINITY), skew(reach + 1e-5).angles(LEAN, Real::INFINITY));
            assert!(
                length(here) <= GREATEST_AMPLIFICATION * length(LEAN) * (1.0 + 1024.0 * Real::EPSILON),
                "{reach}: {here:?}"
            );
            assert!(
                length(add_scaled(here, -1.0, next)) < 0.1 * GREATEST_AMPLIFICATION * length(LEAN),
                "{reach}"
            );
        }
    }

    /// A limit cuts the turn that the pose makes large, to what is left of it; not one that is no larger than the error.
    #[test]
    fn a_limit_cuts_what_the_pose_makes_of_an_error() {
        let tilts = axes([[1.0, 0.0], [0.0, 0.02], [0.0; 2]]);
        let [easy, hard, _] = tilts.angles(LEAN, 50e-6);
        assert!(near(easy, LEAN[0], SIZE) && near(hard, -40e-6, SIZE), "{easy} {hard}");
        let [easy, hard, _] = tilts.angles(LEAN, 1e-3);
        assert!(near(easy, LEAN[0], SIZE) && near(easy.hypot(hard), 1e-3, 1e-3) && hard < 0.0);
        assert_eq!(tilts.angles(LEAN, 3e-3), tilts.angles(LEAN, Real::INFINITY));
        for most in [0.0, 1e-9] {
            let [easy, hard, _] = tilts.angles(LEAN, most);
            assert!(near(easy, LEAN[0], SIZE) && near(hard, LEAN[1], SIZE));
        }
    }

    #[test]
    fn small_axes_are_no_lever_either() {
        let small = axes([[1e-4, 0.0], [0.0, 1e-5], [0.0; 2]]);
        assert!(length(small.angles(LEAN, Real::INFINITY)) < length(LEAN));
    }
}
