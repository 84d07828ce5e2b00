//! Factors, sample by sample.
//!
//! In: the factors of a term, the state of the machine. Out: the number that the term is multiplied with. As the pieces, this
//! is a second reading of what they mean, beside the runtime's.

use std::f64::consts::TAU;

use model_dsl::calibration::Factor;

use super::State;
use super::piece::filtered;
use super::servo::first_order;

/// What a factor remembers from sample to sample.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FactorMemory {
    /// The filtered temperature, the warmth, the turns: nothing before the first sample.
    value: Option<f64>,
    /// What went in at the sample before.
    input: f64,
    /// The time of the sample before, s.
    time: f64,
}

/// The value of a factor at a sample, in mm, rad, s, degC and the unit of a load; what it remembers goes on to this sample.
pub(super) fn value(factor: &Factor<usize>, state: &State<'_>, memory: &mut FactorMemory) -> f64 {
    match factor {
        &Factor::Position { axis, power, within } => within.hold(state.position(axis)).powi(i32::from(power)),
        &Factor::Direction { axis } => state.direction(axis),
        &Factor::Velocity { axis, within } => within.hold(state.velocity(axis)),
        &Factor::Speed { axis, within } => within.hold(state.velocity(axis).abs()),
        &Factor::Fading { axis, over } => (-state.velocity(axis).abs() / over).exp(),
        &Factor::Acceleration { axis, within } => within.hold(state.acceleration(axis)),
        &Factor::Temperature { sensor, reference, time_constant, within } => {
            let now = state.temperature(sensor);
            let behind = if time_constant > 0.0 {
                let FactorMemory { value, input, time } = memory;
                filtered(state.time, now, time_constant, (value, input, time))
            } else {
                now
            };
            within.hold(behind) - reference
        }
        &Factor::Play { sensor, reference, width } => {
            memory.slip(state.temperature(sensor), width) - reference
        }
        &Factor::Warmth { axis, time_constant, rise } => {
            memory.warm(state, rise * state.velocity(axis).abs(), time_constant)
        }
        &Factor::Load { load, within } => within.hold(state.load(load)),
        &Factor::Half { load, at } => 1.0 / (1.0 + state.load(load).abs() / at),
        &Factor::Turn { axis, period, phase } => (TAU * state.position(axis) / period + phase).sin(),
        &Factor::Spin { load, rate, phase } => {
            (TAU * memory.turn(state.time, rate * state.load(load)) + phase).sin()
        }
        Factor::Curve { axis, at, values } => on_curve(at, values, state.position(*axis)),
        &Factor::After { time } => f64::from(u8::from(state.time >= time)),
    }
}

impl FactorMemory {
    /// Lets the memory follow a temperature, up to half a width behind it.
    fn slip(&mut self, now: f64, width: f64) -> f64 {
        if now.is_finite() {
            let before = self.value.unwrap_or(now);
            self.value = Some(before.max(now - 0.5 * width).min(now + 0.5 * width));
        }
        self.value.unwrap_or(now)
    }

    /// Lets the memory follow the warmth that a lasting speed makes, from zero. Between legs the axis rests.
    fn warm(&mut self, state: &State<'_>, lasting: f64, time_constant: f64) -> f64 {
        let Some(before) = self.value else {
            *self = Self { value: Some(0.0), input: lasting, time: state.time };
            return 0.0;
        };
        if !lasting.is_finite() {
            return before;
        }
        let (from, to) = if state.begins { (0.0, 0.0) } else { (self.input, lasting) };
        let warmth = first_order(before, from, to, (state.time - self.time) / time_constant);
        *self = Self { value: Some(warmth), input: lasting, time: state.time };
        warmth
    }

    /// Goes on by the turns that a frequency makes since the sample before.
    fn turn(&mut self, time: f64, frequency: f64) -> f64 {
        let turns = match self.value {
            None => 0.0,
            Some(before) if frequency.is_finite() => {
                before + 0.5 * (self.input + frequency) * (time - self.time)
            }
            Some(before) => return before,
        };
        *self = Self { value: Some(turns), input: frequency, time };
        turns
    }
}

/// A curve over ascending nodes, linear between them, held constant outside; NaN at NaN.
pub(super) fn on_curve(at: &[f64], values: &[f64], position: f64) -> f64 {
    if position.is_nan() {
        return f64::NAN;
    }
    let after = at.partition_point(|node| *node <= position);
    let value = |index: usize| values.get(index).copied().unwrap_or(f64::NAN);
    if after == 0 || after >= at.len() {
        return value(after.saturating_sub(1));
    }
    match (at.get(after - 1), at.get(after)) {
        (Some(left), Some(right)) => {
            let share = (position - left) / (right - left);
            value(after - 1) * (1.0 - share) + value(after) * share
        }
        _ => f64::NAN,
    }
}
