//! The compiled equations of one machine, as the runtime sees them.
//!
//! In: axis positions, travels and the values of the error motions. Out: the error at the tool tip and the direction in
//! which each axis can correct it. It exists so that generated code and the compiler's interpreter serve the same
//! [`Compensator`](super::Compensator).

use super::real::Real;
use super::sample::number;

/// The sines and the cosines of the rotary axes that the equations read, in the order of the axes; zero beyond them. ISO 841
/// names three rotary axes: A, B and C.
pub type Sines = ([Real; 3], [Real; 3]);

/// An error motion that is a rotary axis's own angle, actual minus commanded: its positioning error, or its zero.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Turning {
    /// Index of the axis.
    pub axis: usize,
    /// Index of the error motion.
    pub motion: usize,
}

/// What a motor has of an axis, or of an error motion.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Share {
    /// Index of the motor among the axes.
    pub motor: usize,
    /// Index of the axis that it follows, or of the error motion that it corrects.
    pub of: usize,
    /// How far the motor goes for each mm of the axis; or what its own travel is, mm, for each mm or rad of the error motion.
    pub weight: Real,
}

/// Puts motors where the axes that they [follow](Kinematics::following) stand.
pub fn place_motors(following: &[Share], position: &mut [Real]) {
    for share in following {
        if let Some(place) = position.get_mut(share.motor) {
            *place = 0.0;
        }
    }
    for share in following {
        let of = number(position, share.of);
        if let Some(place) = position.get_mut(share.motor) {
            *place += share.weight * of;
        }
    }
}

/// The compiled equations of one machine: what the topology says, with the machine's constants already in it.
///
/// Positions and travels are in mm for slides and in rad for rotary axes. Error motions are in mm for displacements and
/// in rad for rotations. All vectors are in the frame of the part, in the order X, Y, Z.
pub trait Kinematics {
    /// Number of axis positions.
    fn axes(&self) -> usize;

    /// For each free travel symbol, the index of the axis whose position it is by default. A travel is the lever of an
    /// alignment error where that lever is not the axis position itself, such as an incremental travel.
    fn travels(&self) -> &[usize];

    /// Number of error motions.
    fn motions(&self) -> usize;

    /// First-order error of the tool tip relative to the part, actual minus commanded, in mm.
    ///
    /// A direction that is not sensitive is 0.0. A slice of the wrong length gives NaN in all three.
    fn error(&self, position: &[Real], travel: &[Real], motions: &[Real]) -> [Real; 3];

    /// Writes the sines and cosines of rotary axes at a position, as far as the equations read them. A rotary axis that corrects no more
    /// than its [own angle](Self::turning) then stands at the angle of the position wanted: a compensator asks once for what
    /// it passes to [`error_with`](Self::error_with) at each step, and anew where axes turn to [aim](Self::aiming) the tool.
    fn turn(&self, _position: &[Real], _sines: &mut Sines) {}

    /// [`Kinematics::error`], bit for bit, at a position at which [`turn`](Self::turn) writes these.
    #[inline(always)]
    fn error_with(&self, _sines: &Sines, position: &[Real], travel: &[Real], motions: &[Real]) -> [Real; 3] {
        self.error(position, travel, motions)
    }

    /// The error motions that rotary axes correct themselves: those of their own angles, in the order of the axes. An axis that only
    /// slides correct has none here.
    ///
    /// The command c of such an axis is the one for which `c + e(c)` is the angle wanted. Tip and direction of the tool are then where
    /// they belong without any slide's help.
    fn turning(&self) -> &[Turning] {
        &[]
    }

    /// The motors, which are axes that follow others: where a motor stands is the sum of its shares of axes. Behind a crossed
    /// transmission motor A stands at x + y; the two motors of a beam stand both at y. Motors come behind all axes that they follow.
    ///
    /// A motor moves the tip nowhere by itself: its [direction](Self::directions) is zero. Terms read its position and its direction of
    /// motion. Its command follows from those of its axes.
    #[inline(always)]
    fn following(&self) -> &[Share] {
        &[]
    }

    /// The error motions that motors correct by themselves, beside what they follow: each its own error, and the rotation of the beam
    /// that several carry. No slide corrects these then.
    #[inline(always)]
    fn squaring(&self) -> &[Share] {
        &[]
    }

    /// The rotary axes that correct the direction of the tool, in their order: they turn until its error is undone, and the slides take
    /// back what that does to the tip. None: the direction is left as it is, and nothing below of tip and direction is asked for.
    fn aiming(&self) -> &[usize] {
        &[]
    }

    /// The tool tip relative to the part without errors: mm, part frame; a direction that is not sensitive is 0.0. A slice of the wrong
    /// length gives NaN, and so does a machine that corrects no direction of the tool.
    fn nominal(&self, _position: &[Real]) -> [Real; 3] {
        [Real::NAN; 3]
    }

    /// The direction of the tool without errors, from its tip towards the spindle: a vector of length 1 in the part's frame. NaN as in
    /// [`nominal`](Self::nominal).
    fn direction(&self, _position: &[Real]) -> [Real; 3] {
        [Real::NAN; 3]
    }

    /// First-order error of that direction, actual minus nominal, in rad. NaN as in [`nominal`](Self::nominal).
    fn direction_error(&self, _position: &[Real], _travel: &[Real], _motions: &[Real]) -> [Real; 3] {
        [Real::NAN; 3]
    }

    /// For each of the [aiming](Self::aiming) axes, what it turns that direction by for each rad; zero beyond them. NaN as in
    /// [`nominal`](Self::nominal).
    fn aims(&self, _position: &[Real], aims: &mut [[Real; 3]; 3]) {
        *aims = [[Real::NAN; 3]; 3];
    }

    /// For each axis, the displacement of the tool tip relative to the part per mm of programmed motion.
    ///
    /// An axis that does not correct is zero: rotary axes, redundant slides and motors; so are the components in directions
    /// that are not sensitive. A slide whose positive motion moves the tool towards negative X of the part
    /// has -1 there. Writes `directions[axis]`; a slice of the wrong length is filled with NaN.
    fn directions(&self, position: &[Real], directions: &mut [[Real; 3]]);

    /// [`Kinematics::directions`], bit for bit, at a position at which [`turn`](Self::turn) writes these.
    fn directions_with(&self, _sines: &Sines, position: &[Real], directions: &mut [[Real; 3]]) {
        self.directions(position, directions);
    }

    /// Whether the directions depend on the position: not on machines of slides alone, where a compensator then looks for them
    /// once. True where nothing else is said, and true where one cannot be sure.
    fn directions_vary(&self) -> bool {
        true
    }

    /// For each axis, whether its [direction](Self::directions) is known to be zero at every position; empty where nothing is
    /// said. A search for a command then leaves out these axes. A motor whose axes move does not rest, though its direction is zero.
    fn resting(&self) -> &[bool] {
        &[]
    }

    /// The diagonal of `J J^T`, J being the [directions](Self::directions) of all axes as columns, where these vary, but it is known
    /// to be the same at every position, with nothing beside it: of three slides at right angles, however a rotary axis has
    /// turned them. A compensator then need not find out in each cycle what they reach.
    fn squares(&self) -> Option<[Real; 3]> {
        None
    }

    /// [`Kinematics::directions`] where they are the same at every position and known when the code is compiled; none where
    /// nothing else is said. A search for a command then leaves out what is zero.
    fn fixed_directions(&self) -> Option<&'static [[Real; 3]]> {
        None
    }
}
