//! The errors of tip and direction of the tool where rotary axes stand elsewhere than they were asked to.
//!
//! In: commands, and where the rotary axes stand with them. Out: both errors in that pose, and what the axes' own angles are wrong by. It
//! exists because error motions belong to the commands and lever arms to the angles at which the axes stand.

use super::super::math::all_finite;
use super::super::real::Real;
use super::super::sample::number;
use super::super::{ErrorMotions, Kinematics, MotionReader, Sample};
use super::Refusal;
use super::motors;
use super::prediction::{Prediction, travels};
use super::turns::Turned;

/// Which part of the error motions counts.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// What is corrected in this cycle.
    Corrected,
    /// All of them, but for what rotary axes correct of their own angles in this cycle.
    Left,
}

/// What was found in a pose.
pub(super) struct Seen {
    /// Error of the tip, mm.
    pub(super) tip: [Real; 3],
    /// Error of the direction, rad.
    pub(super) lean: [Real; 3],
    /// The corrections of the axes' own angles, from zero on: rad.
    pub(super) own: Turned,
}

/// Where the rotary axes stand that aim the tool, and the commands of all that a correction turns.
#[derive(Clone, Copy)]
pub(super) struct Posed {
    pub(super) stands: Turned,
    pub(super) commands: Turned,
}

impl<K: Kinematics + ?Sized, M: ErrorMotions + ?Sized> Prediction<'_, K, M> {
    /// The error of the direction at the position of the sample, without any correction.
    pub(super) fn lean(&mut self, sample: &Sample<'_>) -> Result<[Real; 3], Refusal> {
        let from = MotionReader::new(sample, sample.position, self.states);
        let values = self.motions.read(from, self.values).ok_or(Refusal::NotFinite)?;
        let travel = travels(self.kinematics, sample, sample.position, self.travel)?;
        let lean = self.kinematics.direction_error(sample.position, travel, values.as_ref());
        if all_finite(&lean) { Ok(lean) } else { Err(Refusal::NotFinite) }
    }

    /// The errors at the commands in `out`, with the lever arms of the angles at which the axes stand, for which
    /// [`turn`](Kinematics::turn) was asked before.
    pub(super) fn seen(
        &mut self,
        sample: &Sample<'_>,
        posed: &Posed,
        part: Part,
        out: &mut [Real],
    ) -> Result<Seen, Refusal> {
        let (kinematics, motions) = (self.kinematics, self.motions.motions());
        let from = match part {
            Part::Corrected => MotionReader::of_corrected(sample, out, self.states),
            Part::Left => MotionReader::new(sample, out, self.states),
        };
        let mut values = self.motions.read(from, self.values).ok_or(Refusal::NotFinite)?;
        let mut own = Turned::default();
        for turning in kinematics.turning() {
            let Some(value) = values.as_mut().get_mut(turning.motion) else { return Err(Refusal::NotFinite) };
            let corrected = match part {
                Part::Corrected => *value,
                Part::Left => self.needs.turns.corrected(turning.motion, motions, self.states, sample, out),
            };
            own.add(turning.axis, 0.0, -corrected);
            *value -= corrected;
        }
        match part {
            Part::Corrected => motors::take(kinematics.squaring(), values.as_mut(), &mut self.by_motors),
            Part::Left => motors::subtract(kinematics.squaring(), values.as_mut(), &self.by_motors),
        }
        posed.commands.stand(sample.position, out);
        posed.stands.write(out);
        let travel = travels(kinematics, sample, out, self.travel)?;
        let tip = kinematics.error_with(&self.sines, out, travel, values.as_ref());
        let lean = kinematics.direction_error(out, travel, values.as_ref());
        posed.commands.write(out);
        Ok(Seen { tip, lean, own })
    }
}

impl Posed {
    /// The axes at these angles beyond their targets, and none that corrects its own angle yet.
    pub(super) fn turned(axes: &[usize], angles: [Real; 3], sample: &Sample<'_>) -> Self {
        let mut stands = Turned::default();
        for (&axis, angle) in axes.iter().zip(angles) {
            stands.add(axis, number(sample.position, axis), angle);
        }
        Self { stands, commands: stands }
    }

    /// The same with the corrections of the axes' own angles.
    pub(super) fn with_own(self, own: &Turned, sample: &Sample<'_>) -> Self {
        let mut commands = self.stands;
        for (axis, correction) in own.iter() {
            commands.add(axis, number(sample.position, axis), correction);
        }
        Self { commands, ..self }
    }
}
