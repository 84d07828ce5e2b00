//! The error that a calibration predicts.
//!
//! In: the state of the machine in one cycle, and what the terms remember. Out: the error at the tool tip there, or at other
//! positions in the same state. It exists beside the search for the command, which asks it again and again.

use super::inverse::Columns;
use super::{Needs, Refusal, same_length};
use crate::math::all_finite;
use crate::sample::number;
use crate::{ErrorMotions, Kinematics, MotionReader, Sample, Sines, TermState};

/// The equations of a machine, its error motions, and the storage in which they are evaluated.
#[derive(Debug)]
pub(super) struct Prediction<'a, K: Kinematics + ?Sized, M: ErrorMotions + ?Sized> {
    pub(super) kinematics: &'a K,
    pub(super) motions: &'a M,
    /// What each term remembers.
    pub(super) states: &'a mut [TermState],
    /// The value of each error motion.
    pub(super) values: &'a mut [f64],
    /// The value of each free travel.
    pub(super) travel: &'a mut [f64],
    /// What the equations need of rotary axes in this cycle.
    pub(super) sines: Sines,
    pub(super) needs: Needs,
}

impl<K: Kinematics + ?Sized, M: ErrorMotions + ?Sized> Prediction<'_, K, M> {
    /// Begins a cycle: checks the sample, takes the memories over to it, and gives the error at its position.
    #[inline]
    pub(super) fn begin(&mut self, sample: &Sample<'_>) -> Result<[f64; 3], Refusal> {
        self.check(sample)?;
        self.advance(sample);
        self.sines = self.kinematics.sines(sample.position);
        let error = self.error(sample, sample.position);
        if all_finite(&error) { Ok(error) } else { Err(Refusal::NotFinite) }
    }

    /// Checks the sample.
    #[inline]
    fn check(&self, sample: &Sample<'_>) -> Result<(), Refusal> {
        let axes = self.kinematics.axes();
        same_length("position", axes, sample.position.len())?;
        same_length("direction", axes, sample.direction.len())?;
        if self.needs.velocity || !sample.velocity.is_empty() {
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
    #[inline]
    pub(super) fn error(&mut self, sample: &Sample<'_>, position: &[f64]) -> [f64; 3] {
        let read = self.motions.read(MotionReader::new(sample, position, self.states), self.values);
        self.sum(read, sample, position)
    }

    /// The part of the error that is corrected in this cycle; memories are read only.
    #[inline]
    pub(super) fn corrected(&mut self, sample: &Sample<'_>, position: &[f64]) -> [f64; 3] {
        let read = self.motions.read(MotionReader::of_corrected(sample, position, self.states), self.values);
        self.sum(read, sample, position)
    }

    /// [`corrected`](Self::corrected) at a position that differs from that of the last reading for axes that correct; where
    /// nothing is ramped, that reading may have been of the whole error.
    #[inline]
    pub(super) fn corrected_again(&mut self, sample: &Sample<'_>, position: &[f64]) -> [f64; 3] {
        let read =
            self.motions.read_moved(MotionReader::of_corrected(sample, position, self.states), self.values);
        self.sum(read, sample, position)
    }

    /// The directions of the axes: those that are known when the code is compiled, or else these.
    #[inline]
    pub(super) fn columns<'c, T>(&self, found: &'c [[T; 3]]) -> Columns<'c, T> {
        self.kinematics.fixed_directions().map_or(Columns::Found(found), Columns::Known)
    }

    /// The sum of lever arms times the error motions; NaN where they were not read.
    #[inline]
    fn sum(&mut self, read: bool, sample: &Sample<'_>, position: &[f64]) -> [f64; 3] {
        if !read {
            return [f64::NAN; 3];
        }
        let travel = if sample.travel.is_empty() {
            for (travel, &axis) in self.travel.iter_mut().zip(self.kinematics.travels()) {
                *travel = number(position, axis);
            }
            &*self.travel
        } else {
            sample.travel
        };
        self.kinematics.error_with(&self.sines, position, travel, self.values)
    }
}
