//! The state of the machine at one sample.
//!
//! In: the histories of all axes, the temperatures and loads of the sample. Out: what terms, factors and effects of the plant ask for,
//! by the number of the axis, sensor or load.

use super::factor;
use super::history::History;

/// The state of the machine at one sample: mm, rad, s, degC, units of the loads.
///
/// Axes, sensors and loads go by number; what is not there is NaN.
#[derive(Clone, Copy, Debug)]
pub struct State<'s> {
    /// The number of the sample.
    pub row: usize,
    /// Time since the recording began.
    pub time: f64,
    /// Whether a leg begins here.
    pub(super) begins: bool,
    /// The first row of the leg, and the one behind its last.
    pub(super) leg: (usize, usize),
    pub(super) times: &'s [f64],
    pub(super) histories: &'s [History],
    pub(super) temperatures: &'s [f64],
    pub(super) loads: &'s [f64],
}

impl State<'_> {
    fn at(&self, axis: usize, column: impl Fn(&History) -> &Vec<f64>) -> f64 {
        let history = self.histories.get(axis);
        history.and_then(|history| column(history).get(self.row)).copied().unwrap_or(f64::NAN)
    }

    /// The position of an axis behind its position loop.
    pub fn position(&self, axis: usize) -> f64 {
        self.at(axis, |history| &history.position)
    }

    /// The position of an axis at another time, between samples on the arc on which it is accelerated; before the leg that of its first
    /// sample, behind it that of its last.
    pub(super) fn position_at(&self, axis: usize, time: f64) -> f64 {
        let rows = self.leg.0..self.leg.1;
        let positions = self.histories.get(axis).and_then(|history| history.position.get(rows.clone()));
        let (Some(times), Some(positions)) = (self.times.get(rows), positions) else { return f64::NAN };
        let after = times.partition_point(|known| *known <= time);
        let straight = factor::on_curve(times, positions, time);
        match (after.checked_sub(1).and_then(|before| times.get(before)), times.get(after)) {
            (Some(before), Some(behind)) => {
                straight - 0.5 * arc(times, positions, after) * (time - before) * (behind - time)
            }
            _ => straight,
        }
    }

    /// The velocity of an axis.
    pub fn velocity(&self, axis: usize) -> f64 {
        self.at(axis, |history| &history.velocity)
    }

    /// The acceleration of an axis.
    pub fn acceleration(&self, axis: usize) -> f64 {
        self.at(axis, |history| &history.acceleration)
    }

    /// The direction of an axis's last real motion: +1 or -1.
    pub fn direction(&self, axis: usize) -> f64 {
        self.at(axis, |history| &history.direction)
    }

    /// Whether an axis begins a leg here, elsewhere than it ended the last one.
    pub(super) fn is_displaced(&self, axis: usize) -> bool {
        let history = self.histories.get(axis);
        history.is_some_and(|history| history.displaced.get(self.row) == Some(&true))
    }

    /// The time at which an axis reversed last; NaN before the first reversal.
    pub fn reversal(&self, axis: usize) -> f64 {
        self.at(axis, |history| &history.reversal)
    }

    /// The temperature of a sensor, numbered as in the calibration.
    pub fn temperature(&self, sensor: usize) -> f64 {
        self.temperatures.get(sensor).copied().unwrap_or(f64::NAN)
    }

    /// A load, numbered as in [`Plant::loads`](super::Plant::loads).
    pub fn load(&self, load: usize) -> f64 {
        self.loads.get(load).copied().unwrap_or(f64::NAN)
    }
}

/// The acceleration on the way to a sample: the smaller of those at its two ends. Where they differ in sign, or one end is that of the leg,
/// the way is straight: a path may turn there at once.
fn arc(times: &[f64], positions: &[f64], sample: usize) -> f64 {
    let around = sample.checked_sub(2).zip(sample.checked_add(1));
    let Some((times, positions)) =
        around.and_then(|(first, last)| Some((times.get(first..=last)?, positions.get(first..=last)?)))
    else {
        return 0.0;
    };
    let speeds: Vec<f64> = positions
        .windows(2)
        .zip(times.windows(2))
        .map(|(position, time)| (position[1] - position[0]) / (time[1] - time[0]))
        .collect();
    let at_end = |end: usize| 2.0 * (speeds[end + 1] - speeds[end]) / (times[end + 2] - times[end]);
    let (one, other) = (at_end(0), at_end(1));
    if one * other > 0.0 { one.signum() * one.abs().min(other.abs()) } else { 0.0 }
}
