//! Factors: states that a term is multiplied with. In: the states of the machine in a stretch of rows. Out: the value of each
//! factor in every row, and columns multiplied with them.

use std::f64::consts::TAU;

use model_dsl::calibration::{CalibratedTerm, Factor};

use super::{Shape, known};
use crate::states::Rows;

/// What it is, physically, and how large it may well be.
pub(super) const MEANING: &str = "A product of states of the machine, in a form that has no name. The states show where to \
    look.";

/// What a factor remembers from one stretch of rows to the next.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FactorMemory {
    /// The filtered temperature, the warmth, the turns: nothing before the first row.
    value: Option<f64>,
    /// What went in at the row before.
    input: f64,
    /// The time of the row before, s.
    time: f64,
}

/// The shape and the coefficients of a term with factors; `load` finds the channel of a load by name. `None` where the recording
/// lacks one.
pub(super) fn known_times(
    core: &CalibratedTerm,
    factors: &[Factor],
    load: &dyn Fn(&str) -> Option<usize>,
) -> Option<(Shape, Vec<f64>)> {
    let (core, coefficients) = known(core, load)?;
    let factors: Option<Vec<Factor<usize>>> =
        factors.iter().map(|factor| factor.clone().with_load(|name| load(&name))).collect();
    Some((Shape::Times { core: Box::new(core), factors: factors? }, coefficients))
}

/// Multiplies columns with factors, row by row.
pub(super) fn multiply(
    factors: &[Factor<usize>],
    rows: &Rows<'_>,
    memories: &mut Vec<FactorMemory>,
    out: &mut [Vec<f64>],
) {
    memories.resize(factors.len(), FactorMemory::default());
    for (factor, memory) in factors.iter().zip(memories) {
        let values = values(factor, rows, memory);
        for column in out.iter_mut() {
            column.iter_mut().zip(&values).for_each(|(entry, value)| *entry *= value);
        }
    }
}

/// The value of a factor in every row.
fn values(factor: &Factor<usize>, rows: &Rows<'_>, memory: &mut FactorMemory) -> Vec<f64> {
    let of = |column: &[f64], value: &dyn Fn(f64) -> f64| column.iter().map(|entry| value(*entry)).collect();
    match factor {
        &Factor::Position { axis, power, within } => {
            of(rows.axis(axis).position, &|q| within.hold(q).powi(i32::from(power)))
        }
        &Factor::Direction { axis } => rows.axis(axis).direction.to_vec(),
        &Factor::Velocity { axis, within } => of(rows.axis(axis).velocity, &|v| within.hold(v)),
        &Factor::Speed { axis, within } => of(rows.axis(axis).velocity, &|v| within.hold(v.abs())),
        &Factor::Fading { axis, over } => of(rows.axis(axis).velocity, &|v| (-v.abs() / over).exp()),
        &Factor::Acceleration { axis, within } => of(rows.axis(axis).acceleration, &|a| within.hold(a)),
        &Factor::Temperature { sensor, reference, time_constant, within } => {
            let behind = memory.filtered(rows, rows.temperature(sensor), time_constant);
            of(&behind, &|temperature| within.hold(temperature) - reference)
        }
        &Factor::Play { sensor, reference, width } => {
            let follow = |temperature: &f64| memory.slip(*temperature, width) - reference;
            rows.temperature(sensor).iter().map(follow).collect()
        }
        &Factor::Warmth { axis, time_constant, rise } => {
            memory.warmed(rows, rows.axis(axis).velocity, rise, time_constant)
        }
        &Factor::Load { load, within } => of(rows.load(load), &|force| within.hold(force)),
        &Factor::Half { load, at } => of(rows.load(load), &|force| 1.0 / (1.0 + force.abs() / at)),
        &Factor::Turn { axis, period, phase } => {
            of(rows.axis(axis).position, &|q| (TAU * q / period + phase).sin())
        }
        &Factor::Spin { load, rate, phase } => {
            let turned = memory.turned(rows.time, rows.load(load), rate);
            of(&turned, &|turns| (TAU * turns + phase).sin())
        }
        Factor::Curve { axis, at, values } => of(rows.axis(*axis).position, &|q| on_curve(at, values, q)),
        &Factor::After { time } => of(rows.time, &|now| f64::from(u8::from(now >= time))),
    }
}

impl FactorMemory {
    /// Temperatures behind a first-order filter that starts at the first of them, straight between rows.
    fn filtered(&mut self, rows: &Rows<'_>, temperatures: &[f64], time_constant: f64) -> Vec<f64> {
        if time_constant <= 0.0 {
            return temperatures.to_vec();
        }
        let each = temperatures.iter().zip(rows.time);
        each.map(|(temperature, time)| {
            if !temperature.is_finite() {
                return self.value.unwrap_or(*temperature);
            }
            let behind = match self.value {
                None => *temperature,
                Some(_) => self.behind(*time, (self.input, *temperature), time_constant),
            };
            *self = Self { value: Some(behind), input: *temperature, time: *time };
            behind
        })
        .collect()
    }

    /// The output of the filter at a time, its input going straight from one value to another since the row before.
    fn behind(&self, time: f64, (from, to): (f64, f64), time_constant: f64) -> f64 {
        let before = self.value.unwrap_or(to);
        let step = time - self.time;
        if step <= 0.0 {
            return before;
        }
        let slope = (to - from) / step;
        let left = before - from + slope * time_constant;
        to - slope * time_constant + left * (-step / time_constant).exp()
    }

    /// Follows a temperature, up to half a width behind it.
    fn slip(&mut self, now: f64, width: f64) -> f64 {
        if now.is_finite() {
            let before = self.value.unwrap_or(now);
            self.value = Some(before.max(now - 0.5 * width).min(now + 0.5 * width));
        }
        self.value.unwrap_or(now)
    }

    /// How warm the motion has made it, from zero. Between legs the axis rests.
    fn warmed(&mut self, rows: &Rows<'_>, velocity: &[f64], rise: f64, time_constant: f64) -> Vec<f64> {
        let each = velocity.iter().zip(rows.time).enumerate();
        each.map(|(row, (velocity, time))| {
            let lasting = rise * velocity.abs();
            let warmth = match self.value {
                None => 0.0,
                Some(before) if !lasting.is_finite() => return before,
                Some(_) if rows.begins(row) => self.behind(*time, (0.0, 0.0), time_constant),
                Some(_) => self.behind(*time, (self.input, lasting), time_constant),
            };
            *self = Self { value: Some(warmth), input: lasting, time: *time };
            warmth
        })
        .collect()
    }

    /// How often something has turned whose frequency is `rate` for each unit of a channel.
    pub(super) fn turned(&mut self, time: &[f64], channel: &[f64], rate: f64) -> Vec<f64> {
        let each = channel.iter().zip(time);
        each.map(|(unit, time)| {
            let frequency = rate * unit;
            let turns = match self.value {
                None => 0.0,
                Some(before) if !frequency.is_finite() => return before,
                Some(before) => before + 0.5 * (self.input + frequency) * (time - self.time),
            };
            *self = Self { value: Some(turns), input: frequency, time: *time };
            turns
        })
        .collect()
    }
}

/// A curve over ascending nodes, linear between them, held constant outside; NaN at NaN.
fn on_curve(at: &[f64], values: &[f64], position: f64) -> f64 {
    if position.is_nan() {
        return f64::NAN;
    }
    let after = at.partition_point(|node| *node <= position);
    if after == 0 || after == at.len() {
        return values.get(after.saturating_sub(1)).copied().unwrap_or(f64::NAN);
    }
    let share = (position - at[after - 1]) / (at[after] - at[after - 1]);
    values[after - 1] + share * (values[after] - values[after - 1])
}
