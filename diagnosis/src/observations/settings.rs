//! Settings of the instruments: what each does to the readings.
//!
//! In: a stretch of rows and a setting. Out: a column, how a channel sees it; and what the settings of a model add to a reading. A
//! ballbar's centre and length, and the clock, act exactly: their columns are how the reading changes with a little more of them.

use super::{Frame, along, at, dot};
use crate::channel::{Channel, Kind};
use crate::model::Model;
use crate::side::Side;
use crate::study::Study;
use crate::terms::Setting;

impl Frame<'_> {
    /// How a channel sees a setting of its instrument; `None` where it does not.
    pub(crate) fn setting(
        &self,
        study: &Study<'_>,
        scene: usize,
        number: usize,
        setting: Setting,
        model: &Model,
    ) -> Option<Vec<f64>> {
        let channel = &study.scenes[scene].channels[number];
        let radial = |value: &dyn Fn(usize) -> f64| match channel.kind {
            Kind::Radius { .. } => Some((0..self.len()).map(value).collect()),
            _ => None,
        };
        match setting {
            Setting::Offset { channel } => (channel == number).then(|| vec![1.0; self.len()]),
            Setting::RunOffset { channel, run } => (channel == number).then(|| {
                let runs = &study.scenes[scene].recording.run[self.rows.clone()];
                runs.iter().map(|known| if *known == run { 1.0 } else { 0.0 }).collect()
            }),
            Setting::Radius => radial(&|_| -1.0),
            Setting::Eccentricity { direction } | Setting::RunEccentricity { direction, .. } => {
                let Kind::Radius { center, radius } = channel.kind else { return None };
                let spokes = self.spokes(ballbar(scene, model, center, radius).0);
                let runs = &study.scenes[scene].recording.run[self.rows.clone()];
                let counts = |row: usize| match setting {
                    Setting::RunEccentricity { run, .. } => runs[row] == run,
                    _ => true,
                };
                radial(&|row| if counts(row) { -spokes[row][direction] } else { 0.0 })
            }
            Setting::Cosine => {
                let travelled = |d: usize, row: usize| self.nominal[d][row] - self.start[d];
                let way = |row: usize| [travelled(0, row), travelled(1, row), travelled(2, row)];
                let n = self.direction(channel.kind)?;
                Some((0..self.len()).map(|row| -dot(n, way(row))).collect())
            }
            Setting::Clock => self.clock(study, scene, channel, model),
            Setting::Displacement { direction } => {
                self.of_part(study, scene, channel.kind, |read, _| read[direction])
            }
            Setting::Rotation { direction } => {
                let pose = study.scenes[scene].pose.as_ref()?;
                self.of_part(study, scene, channel.kind, |read, place| pose.levers(read, place)[direction])
            }
        }
    }

    /// What a channel that reads a part sees of it, from the direction of the reading and the nominal place of the tip: that from which
    /// the lever arms of error motions are counted too.
    fn of_part(
        &self,
        study: &Study<'_>,
        scene: usize,
        kind: Kind,
        seen: impl Fn([f64; 3], [f64; 3]) -> f64,
    ) -> Option<Vec<f64>> {
        let read = |row: usize| match kind {
            Kind::Tip(d) => Some(along(d)),
            Kind::Normal => Some(self.normal(study, scene, row)),
            _ => None,
        };
        (0..self.len()).map(|row| Some(seen(read(row)?, at(&self.nominal, row)))).collect()
    }

    fn direction(&self, kind: Kind) -> Option<[f64; 3]> {
        match kind {
            Kind::Tip(d) => Some(along(d)),
            Kind::Along(n) => Some(n),
            _ => None,
        }
    }

    /// What a second of delay does to a channel: minus the velocity that it sees.
    fn clock(
        &self,
        study: &Study<'_>,
        scene: usize,
        channel: &Channel<'_>,
        model: &Model,
    ) -> Option<Vec<f64>> {
        if !channel.kind.outside() {
            return None;
        }
        let gains = self.gains(study, scene, channel, model, Side::Drive);
        let mut sum = vec![0.0; self.len()];
        for (axis, own) in study.own.iter().enumerate() {
            let slope = &self.course.shown.axes[axis].clock_slope[self.rows.clone()];
            if let Some(gain) = own.and_then(|own| gains[own].as_ref()) {
                for ((sum, gain), slope) in sum.iter_mut().zip(gain).zip(slope) {
                    *sum += gain * slope;
                }
            }
        }
        Some(sum)
    }

    /// What the instrument's settings in the model add to the reading of a channel, but for those that act exactly.
    pub(crate) fn settings(&self, study: &Study<'_>, scene: usize, number: usize, model: &Model) -> Vec<f64> {
        let mut sum = vec![0.0; self.len()];
        for fitted in &model.effects {
            let setting = fitted.effect.setting_of(scene);
            if let (Some(setting), [coefficient]) = (setting, fitted.coefficients.as_slice())
                && setting.adds()
                && let Some(column) = self.setting(study, scene, number, setting, model)
            {
                for (sum, value) in sum.iter_mut().zip(column) {
                    *sum += coefficient * value;
                }
            }
        }
        sum
    }
}

/// The true centre and radius of a ballbar under a model.
pub(super) fn ballbar(scene: usize, model: &Model, mut center: [f64; 3], mut radius: f64) -> ([f64; 3], f64) {
    for fitted in &model.effects {
        if let [coefficient] = fitted.coefficients.as_slice() {
            match fitted.effect.setting_of(scene) {
                Some(Setting::Eccentricity { direction }) => center[direction] += coefficient,
                Some(Setting::Radius) => radius += coefficient,
                _ => {}
            }
        }
    }
    (center, radius)
}
