//! The error that a calibration predicts.
//!
//! In: the state of the machine in one cycle, and what the terms remember. Out: the error at the tool tip there, or at other
//! positions in the same state. It exists beside the search for the command, which asks it again and again.

use super::super::math::all_finite;
use super::super::real::Real;
use super::super::sample::number;
use super::super::{ErrorMotions, Kinematics, MotionReader, Sample, Sines, TermState};
use super::known::Known;
use super::motors::{self, Corrected};
use super::turns::{Turned, Turns};
use super::{Convergence, Needs, Refusal, copy, same_length};

/// The equations of a machine, its error motions, and the storage in which they are evaluated.
#[derive(Debug)]
pub(super) struct Prediction<'a, K: Kinematics + ?Sized, M: ErrorMotions + ?Sized> {
    pub(super) kinematics: &'a K,
    pub(super) motions: &'a M,
    /// What each term remembers.
    pub(super) states: &'a mut [TermState],
    /// The value of each error motion.
    pub(super) values: &'a mut [Real],
    /// The value of each free travel.
    pub(super) travel: &'a mut [Real],
    /// What the equations need of rotary axes in this cycle.
    pub(super) sines: Sines,
    /// What motors correct by themselves in this cycle.
    pub(super) by_motors: Corrected,
    pub(super) needs: Needs,
}

impl<'a, K: Kinematics + ?Sized, M: ErrorMotions + ?Sized> Prediction<'a, K, M> {
    /// Begins a cycle: checks the sample, takes the memories over to it, and gives the error at its position.
    #[inline]
    pub(super) fn begin(&mut self, sample: &Sample<'_>) -> Result<[Real; 3], Refusal> {
        self.check(sample)?;
        if self.kinematics.motors_correct() {
            self.by_motors = Corrected::NONE;
        }
        self.advance(sample);
        self.kinematics.turn(sample.position, &mut self.sines);
        let error = self.error(sample, sample.position)?;
        if all_finite(&error) { Ok(error) } else { Err(Refusal::NotFinite) }
    }

    /// Checks the sample.
    #[inline]
    fn check(&self, sample: &Sample<'_>) -> Result<(), Refusal> {
        let axes = self.kinematics.axes();
        same_length("position", axes, sample.position.len())?;
        same_length("direction", axes, sample.direction.len())?;
        if sample.velocity.len() != self.needs.velocities {
            same_length("velocity", axes, sample.velocity.len())?;
        }
        if !sample.travel.is_empty() {
            same_length("travel", self.kinematics.travels().len(), sample.travel.len())?;
        }
        if sample.temperature.len() < self.needs.sensors {
            same_length("temperature", self.needs.sensors, sample.temperature.len())?;
        }
        if !sample.is_finite() {
            return Err(Refusal::NotFinite);
        }
        if self.kinematics.has_motors() {
            motors::check_positions(self.kinematics.following(), sample.position)?;
        }
        if sample.time_step < 0.0 {
            return Err(Refusal::NegativeTimeStep { time_step: sample.time_step });
        }
        Ok(())
    }

    /// Takes the memory of every term over to the sample.
    #[inline]
    pub(super) fn advance(&mut self, sample: &Sample<'_>) {
        if self.needs.memory {
            self.remember(sample);
        }
    }

    fn remember(&mut self, sample: &Sample<'_>) {
        let mut rest = &mut *self.states;
        for motion in self.motions.motions() {
            let Some((states, others)) = rest.split_at_mut_checked(motion.terms.len()) else { return };
            motion.advance(sample, states);
            rest = others;
        }
    }

    /// The error at a position in the state of the sample, the rotary axes where they are there; memories are read only.
    #[inline(always)]
    pub(super) fn error(&mut self, sample: &Sample<'_>, position: &[Real]) -> Result<[Real; 3], Refusal> {
        let from = MotionReader::new(sample, position, self.states);
        let values = self.motions.read(from, self.values);
        sum(self.kinematics, &self.sines, sample, position, self.travel, values)
    }

    /// [`error`](Self::error) where a part of it is corrected in later cycles, without what rotary axes and motors have corrected in this
    /// one.
    #[cold]
    #[inline(never)]
    pub(super) fn error_behind_ramp(
        &mut self,
        sample: &Sample<'_>,
        turned: Option<&Turned>,
        out: &mut [Real],
    ) -> Result<[Real; 3], Refusal> {
        let from = MotionReader::new(sample, out, self.states);
        let mut values = self.motions.read(from, self.values).ok_or(Refusal::NotFinite)?;
        motors::subtract(self.kinematics.squaring(), values.as_mut(), &self.by_motors);
        let Some(turned) = turned else {
            return sum(self.kinematics, &self.sines, sample, out, self.travel, Some(values));
        };
        let (turns, motions) = (&self.needs.turns, self.motions.motions());
        for (motion, value) in values.as_mut().iter_mut().enumerate() {
            *value -= turns.corrected(motion, motions, self.states, sample, out);
        }
        let error = standing(self.kinematics, &self.sines, (sample, turned), out, self.travel, Some(values));
        turned.write(out);
        error
    }

    /// Writes the commands of the motors behind those of the axes that they follow.
    #[inline]
    pub(super) fn let_motors_follow(&self, target: &[Real], out: &mut [Real]) {
        if self.kinematics.has_motors() {
            motors::follow(self.kinematics, target, &self.by_motors, out);
        }
    }

    /// The square of how far motors went with the last reading by what they correct themselves: mm^2.
    #[inline]
    pub(super) fn motors_moved(&self) -> Real {
        if self.kinematics.motors_correct() { self.by_motors.moved() } else { 0.0 }
    }

    /// The square of what motors correct by themselves: mm^2.
    #[inline]
    pub(super) fn by_motors_squared(&self) -> Real {
        if self.kinematics.motors_correct() { self.by_motors.square(self.kinematics.squaring()) } else { 0.0 }
    }

    /// Searches for the commands of the rotary axes that correct their own angles, and writes them to `out`, with the position of the
    /// sample for all others. None where there are none; then nothing is written.
    #[inline]
    pub(super) fn turn(
        &self,
        sample: &Sample<'_>,
        convergence: &Convergence,
        out: &mut [Real],
    ) -> Result<Option<Turned>, Refusal> {
        let turns = &self.needs.turns;
        if !self.kinematics.axes_turn() || turns.is_empty() {
            return Ok(None);
        }
        copy(sample.position, out);
        turns.search(self.motions.motions(), self.states, sample, convergence, out).map(Some)
    }

    /// The part of the error that is left to slides in this cycle, where rotary axes have their commands; leaves in `out` the angles
    /// wanted in their place.
    #[inline(never)]
    pub(super) fn left_to_slides<const READING: bool>(
        &mut self,
        sample: &Sample<'_>,
        turned: &Turned,
        out: &mut [Real],
    ) -> Result<[Real; 3], Refusal> {
        let from = MotionReader::of_corrected(sample, out, self.states);
        let values = without(&self.needs.turns, values::<READING, _>(self.motions, from, self.values));
        let values = left_by_motors(self.kinematics, values, &mut self.by_motors);
        standing(self.kinematics, &self.sines, (sample, turned), out, self.travel, values)
    }

    /// The part of the error at the target that is corrected in this cycle.
    #[cold]
    #[inline(never)]
    pub(super) fn corrected_at_target(&mut self, sample: &Sample<'_>) -> Result<[Real; 3], Refusal> {
        self.corrected::<FIRST>(sample, sample.position)
    }

    /// The part of the error that is corrected in this cycle; memories are read only.
    #[inline(always)]
    pub(super) fn corrected<const READING: bool>(
        &mut self,
        sample: &Sample<'_>,
        position: &[Real],
    ) -> Result<[Real; 3], Refusal> {
        let from = MotionReader::of_corrected(sample, position, self.states);
        let values = values::<READING, _>(self.motions, from, self.values);
        let values = left_by_motors(self.kinematics, values, &mut self.by_motors);
        sum(self.kinematics, &self.sines, sample, position, self.travel, values)
    }
}

/// A reading of the error motions that is the first one in a cycle of the part that is corrected.
pub(super) const FIRST: bool = false;

/// A reading at a position that differs from that of the one before for axes that correct; where nothing is ramped, that one may have been of
/// the whole error.
pub(super) const AGAIN: bool = true;

/// The values of the error motions.
#[inline(always)]
fn values<'k, const READING: bool, M: ErrorMotions + ?Sized>(
    motions: &M,
    from: MotionReader<'_>,
    kept: &'k mut [Real],
) -> Option<M::Values<'k>> {
    if READING == AGAIN { motions.read_moved(from, kept) } else { motions.read(from, kept) }
}

/// The values of the error motions without those of own angles, which rotary axes correct.
#[inline]
fn without<V: AsMut<[Real]>>(turns: &Turns, mut values: Option<V>) -> Option<V> {
    let numbers = values.as_mut()?.as_mut();
    for motion in turns.motions() {
        if let Some(value) = numbers.get_mut(motion) {
            *value = 0.0;
        }
    }
    values
}

/// The values of the error motions without those that motors correct, which are kept apart.
#[inline(always)]
fn left_by_motors<K: Kinematics + ?Sized, V: AsMut<[Real]>>(
    kinematics: &K,
    mut values: Option<V>,
    kept: &mut Corrected,
) -> Option<V> {
    if kinematics.motors_correct() {
        motors::take(kinematics.squaring(), values.as_mut()?.as_mut(), kept);
    }
    values
}

/// [`sum`] with the lever arms of rotary axes that stand at the angles wanted, which are left in `out`.
#[inline(always)]
fn standing<K: Kinematics + ?Sized>(
    kinematics: &K,
    sines: &Sines,
    (sample, turned): (&Sample<'_>, &Turned),
    out: &mut [Real],
    travel: &mut [Real],
    values: Option<impl AsRef<[Real]>>,
) -> Result<[Real; 3], Refusal> {
    turned.stand(sample.position, out);
    sum(kinematics, sines, sample, out, travel, values)
}

/// The sum of lever arms times the error motions.
///
/// # Errors
/// Refuses error motions that were not read.
#[inline(always)]
fn sum<K: Kinematics + ?Sized>(
    kinematics: &K,
    sines: &Sines,
    sample: &Sample<'_>,
    position: &[Real],
    travel: &mut [Real],
    values: Option<impl AsRef<[Real]>>,
) -> Result<[Real; 3], Refusal> {
    let values = values.ok_or(Refusal::NotFinite)?;
    let travel = travels(kinematics, sample, position, travel)?;
    Ok(kinematics.error_with(sines, position, travel, values.as_ref()))
}

/// The free travels: those of the sample, or where it has none the positions of their axes.
#[inline(always)]
pub(super) fn travels<'t, K: Kinematics + ?Sized>(
    kinematics: &K,
    sample: &'t Sample<'_>,
    position: &[Real],
    travel: &'t mut [Real],
) -> Result<&'t [Real], Refusal> {
    if !sample.travel.is_empty() {
        return Ok(sample.travel);
    }
    for (travel, &axis) in travel.iter_mut().zip(kinematics.travels()) {
        *travel = number(position, axis);
    }
    same_length("work.travel", kinematics.travels().len(), travel.len())?;
    Ok(travel)
}
