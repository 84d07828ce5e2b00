//! The commands of motors that move several axes, or that share one.
//!
//! In: the commands of the axes, and the error motions that motors correct by themselves. Out: the command of each motor. It exists
//! because the error of a motor is read where the motor stands, and since two motors of one beam can turn it, as no slide can.

use super::super::real::{APART, Real};
use super::super::sample::number;
use super::super::{Kinematics, Share};
use super::report::{Refusal, SetupError};

/// The greatest number of shares of error motions that motors correct: two of them, with their own error and the rotation of their
/// beam, for each of the slides X Y Z U V W.
pub(super) const MOST: usize = 24;

/// What motors correct by themselves in this cycle.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Corrected {
    /// The values of the error motions, mm or rad, in the order of [`Kinematics::squaring`].
    values: [Real; MOST],
    /// The square of how far the commands of the motors have moved between the last two readings, over all motors: mm^2.
    moved: Real,
}

impl Corrected {
    /// Nothing.
    pub(super) const NONE: Self = Self { values: [0.0; MOST], moved: 0.0 };

    /// The square of how far the commands of the motors have moved with the last reading, beside the axes that they follow: mm^2.
    pub(super) const fn moved(&self) -> Real {
        self.moved
    }

    /// The square of what motors correct by themselves, over all motors: mm^2.
    pub(super) fn square(&self, squaring: &[Share]) -> Real {
        square(squaring, |place| number(&self.values, place))
    }
}

/// The square over all motors of the sum of shares of something, by the places of the shares.
fn square(squaring: &[Share], of: impl Fn(usize) -> Real) -> Real {
    let of_motor = |motor: usize| {
        let own = squaring.iter().enumerate().filter(|(_, share)| share.motor == motor);
        own.fold(0.0, |sum, (place, share)| sum + share.weight * of(place))
    };
    let mut sum = 0.0;
    for (place, share) in squaring.iter().enumerate() {
        // Each motor once, with its first share.
        if !squaring.iter().take(place).any(|before| before.motor == share.motor) {
            let part = of_motor(share.motor);
            sum += part * part;
        }
    }
    sum
}

/// Checks the shares of a machine: motors stand behind all axes that they follow, and what they correct is an error motion.
///
/// # Errors
/// Tells the first entry that is wrong, counted through both lists.
pub(super) fn check_shares<K: Kinematics + ?Sized>(kinematics: &K) -> Result<(), SetupError> {
    let (axes, motions) = (kinematics.axes(), kinematics.motions());
    let (following, squaring) = (kinematics.following(), kinematics.squaring());
    let is_motor = |axis: usize| following.iter().any(|share| share.motor == axis);
    let follows = |share: &Share| share.motor < axes && share.of < axes && !is_motor(share.of);
    let corrects = |share: &Share| is_motor(share.motor) && share.of < motions;
    let wrong = |share: usize| SetupError::Share { share };
    if let Some(share) = following.iter().position(|share| !follows(share) || !share.weight.is_finite()) {
        return Err(wrong(share));
    }
    let before = following.len();
    for (place, share) in squaring.iter().enumerate() {
        if !corrects(share) || !share.weight.is_finite() || place >= MOST {
            return Err(wrong(before.saturating_add(place)));
        }
    }
    Ok(())
}

/// Refuses positions of motors that are not where their axes put them.
#[cold]
#[inline(never)]
pub(super) fn check_positions(following: &[Share], position: &[Real]) -> Result<(), Refusal> {
    for motor in following.iter().map(|share| share.motor) {
        let own = following.iter().filter(|share| share.motor == motor);
        let expected = own.fold(0.0, |sum, share| sum + share.weight * number(position, share.of));
        let found = number(position, motor);
        // Not `>`: also at NaN, which no comparison lets through.
        let fits = (found - expected).abs() <= APART;
        if !fits {
            return Err(Refusal::Motor { axis: motor, expected, found });
        }
    }
    Ok(())
}

/// Keeps what motors correct, and leaves nothing of it in the values.
#[cold]
#[inline(never)]
pub(super) fn take(squaring: &[Share], values: &mut [Real], corrected: &mut Corrected) {
    let before = corrected.values;
    for (share, kept) in squaring.iter().zip(&mut corrected.values) {
        *kept = number(values, share.of);
    }
    let after = &corrected.values;
    corrected.moved = square(squaring, |place| number(after, place) - number(&before, place));
    for share in squaring {
        if let Some(value) = values.get_mut(share.of) {
            *value = 0.0;
        }
    }
}

/// Takes from the values what motors correct in this cycle.
#[cold]
#[inline(never)]
pub(super) fn subtract(squaring: &[Share], values: &mut [Real], corrected: &Corrected) {
    for (place, (share, kept)) in squaring.iter().zip(&corrected.values).enumerate() {
        // The rotation of a beam stands there for each of its motors.
        let again = squaring.iter().take(place).any(|before| before.of == share.of);
        if let Some(value) = values.get_mut(share.of).filter(|_| !again) {
            *value -= kept;
        }
    }
}

/// Writes the commands of the motors: as far as their axes have moved from the target, less what they correct themselves.
#[cold]
#[inline(never)]
pub(super) fn follow<K: Kinematics + ?Sized>(
    kinematics: &K,
    target: &[Real],
    corrected: &Corrected,
    out: &mut [Real],
) {
    for share in kinematics.following() {
        if let Some(command) = out.get_mut(share.motor) {
            *command = number(target, share.motor);
        }
    }
    for share in kinematics.following() {
        let moved = number(out, share.of) - number(target, share.of);
        if let Some(command) = out.get_mut(share.motor) {
            *command += share.weight * moved;
        }
    }
    for (share, value) in kinematics.squaring().iter().zip(&corrected.values) {
        if let Some(command) = out.get_mut(share.motor) {
            *command -= share.weight * value;
        }
    }
}
