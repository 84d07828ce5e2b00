//! Terms: one piece of physics each, as a function of the machine's state.
//!
//! In: parameters of a calibration in mm, rad, s, degC, and the [`Sample`] of this cycle. Out: the term's share of one
//! error motion. It exists because an error motion is the sum of such pieces and nothing else.

mod check;

use core::f64::consts::TAU;

use crate::math::{exp_m1, sin};
use crate::{Direction, Sample, Table};

/// What a polynomial reads.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Input {
    /// The position of the axis of this index, in mm or rad.
    Axis(usize),
    /// The temperature of the sensor of this index, in degC.
    Sensor(usize),
}

/// One piece of physics: it adds its value, in mm or rad, to the error motion in whose list it stands.
///
/// Below, q is the position of the axis, v its velocity, d its direction of motion (+1 or -1) and T the temperature of the
/// sensor. Axes and sensors are indices into the slices of a [`Sample`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Term<'a> {
    /// `value`: an offset, an alignment.
    Constant {
        /// The value in mm or rad.
        value: f64,
    },
    /// The sum of `c_k q^k`, or of `c_k T^k`, from k = 0: scale, straightness, pitch; a component against temperature.
    Polynomial {
        /// The position or temperature it is a polynomial of.
        input: Input,
        /// The coefficients from k = 0 on, in mm or rad per unit of the input to the power k.
        coefficients: &'a [f64],
    },
    /// The sum of `c_k q^k` from k = 1, q of another axis: sag and cross-talk of a body that is not rigid.
    Coupling {
        /// The other axis.
        axis: usize,
        /// The coefficients from k = 1 on.
        coefficients: &'a [f64],
    },
    /// A measured curve over q, by direction where the table has two curves.
    Table {
        /// The axis whose position and direction are read.
        axis: usize,
        /// The curve.
        table: Table<'a>,
    },
    /// `-B/2 d`: play. With a wind-up w above 0 it is `-B/2 u`, where u within [-1, 1] follows q by `2 dq / w`.
    Backlash {
        /// The axis.
        axis: usize,
        /// Lost motion B, in mm or rad: the axis lags by half of it behind every motion.
        lost_motion: f64,
        /// Wind-up w, in mm or rad: the travel after a reversal over which the play is taken up; 0: at once.
        wind_up: f64,
    },
    /// `A sin(2 pi q / P + f)`: pitch error of a screw, interpolation error of an encoder.
    Cyclic {
        /// The axis.
        axis: usize,
        /// Period P, in mm or rad.
        period: f64,
        /// Amplitude A, in mm or rad.
        amplitude: f64,
        /// Phase f, in rad.
        phase: f64,
    },
    /// `c (T - T0) q`: a scale that grows with temperature.
    Expansion {
        /// The axis.
        axis: usize,
        /// The sensor.
        sensor: usize,
        /// Coefficient c, per degC (for a slide; 11.5e-6 for steel).
        coefficient: f64,
        /// Reference temperature T0, in degC.
        reference: f64,
    },
    /// `c (T* - T0)`: growth of a spindle or a structure. T* is T behind a first-order filter that starts at the first T.
    Growth {
        /// The sensor.
        sensor: usize,
        /// Coefficient c, in mm or rad per degC.
        coefficient: f64,
        /// Reference temperature T0, in degC.
        reference: f64,
        /// Time constant of the filter, in s; 0: no filter.
        time_constant: f64,
    },
    /// `-v / K`: the following error of a position loop in its steady state.
    Lag {
        /// The axis.
        axis: usize,
        /// Gain K of the position loop, in 1/s.
        gain: f64,
    },
}

/// What a term remembers from cycle to cycle: the take-up of a play, the filtered temperature of a growth.
///
/// Every term has one, in the order of the terms; most never touch it. The default is that of a machine just started.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct TermState {
    /// Take-up u within [-1, 1], or filtered temperature in degC; none before the first cycle.
    memory: Option<f64>,
    /// Position of the axis in the cycle before, in mm or rad.
    last: f64,
}

impl Term<'_> {
    /// The value of the term in a state of the machine, in mm or rad; NaN where the sample lacks what it reads.
    ///
    /// The memory is read and not advanced, so that an inverse may ask at as many positions as it needs. A term that has
    /// not been advanced yet answers as in its first cycle.
    #[must_use]
    pub fn value(&self, sample: &Sample<'_>, state: &TermState) -> f64 {
        match *self {
            Self::Constant { value } => value,
            Self::Polynomial { input, coefficients } => horner(coefficients, read(input, sample)),
            Self::Coupling { axis, coefficients } => {
                let position = sample.position(axis);
                position * horner(coefficients, position)
            }
            Self::Table { axis, table } => sample
                .direction(axis)
                .map_or(f64::NAN, |direction| table.value(sample.position(axis), direction)),
            Self::Backlash { axis, lost_motion, wind_up } => {
                -0.5 * lost_motion * take_up(sample, axis, wind_up, state)
            }
            Self::Cyclic { axis, period, amplitude, phase } => {
                amplitude * sin(TAU * (sample.position(axis) / period) + phase)
            }
            Self::Expansion { axis, sensor, coefficient, reference } => {
                coefficient * (sample.temperature(sensor) - reference) * sample.position(axis)
            }
            Self::Growth { sensor, coefficient, reference, time_constant } => {
                let now = sample.temperature(sensor);
                let filtered = if time_constant > 0.0 { state.memory.unwrap_or(now) } else { now };
                coefficient * (filtered - reference)
            }
            Self::Lag { axis, gain } => -sample.velocity(axis) / gain,
        }
    }

    /// Takes the term's memory over to the cycle of this sample: once a cycle, before its value is asked.
    ///
    /// A sample that lacks what the term reads, or holds NaN there, leaves the memory as it was.
    pub fn advance(&self, sample: &Sample<'_>, state: &mut TermState) {
        match *self {
            Self::Backlash { axis, wind_up, .. } if wind_up > 0.0 => {
                advance_play(sample, axis, wind_up, state);
            }
            Self::Growth { sensor, time_constant, .. } if time_constant > 0.0 => {
                advance_filter(sample, sensor, time_constant, state);
            }
            _ => {}
        }
    }
}

/// What a polynomial reads from the sample.
fn read(input: Input, sample: &Sample<'_>) -> f64 {
    match input {
        Input::Axis(axis) => sample.position(axis),
        Input::Sensor(sensor) => sample.temperature(sensor),
    }
}

/// The polynomial with the given coefficients from the constant upwards; NaN at NaN, even where it has no coefficient.
fn horner(coefficients: &[f64], at: f64) -> f64 {
    coefficients.iter().rev().fold(0.0 * at, |sum, coefficient| sum * at + coefficient)
}

/// The take-up of a play: the direction itself, or where there is a wind-up the u of the play operator.
fn take_up(sample: &Sample<'_>, axis: usize, wind_up: f64, state: &TermState) -> f64 {
    let direction = sample.direction(axis).map_or(f64::NAN, Direction::sign);
    if wind_up > 0.0 { state.memory.unwrap_or(direction) } else { direction }
}

/// The play operator: u follows the position by 2 dq / w and stops at -1 and +1. It starts taken up in the direction
/// of the first sample.
fn advance_play(sample: &Sample<'_>, axis: usize, wind_up: f64, state: &mut TermState) {
    let position = sample.position(axis);
    let Some(direction) = sample.direction(axis) else { return };
    if !position.is_finite() {
        return;
    }
    let moved = state.memory.map(|u| u + 2.0 * (position - state.last) / wind_up);
    state.memory = Some(moved.unwrap_or(direction.sign()).clamp(-1.0, 1.0));
    state.last = position;
}

/// The filter T* += (T - T*) (1 - exp(-dt / tau)): exact for a temperature that holds through the step.
fn advance_filter(sample: &Sample<'_>, sensor: usize, time_constant: f64, state: &mut TermState) {
    let now = sample.temperature(sensor);
    if !now.is_finite() || !sample.time_step.is_finite() {
        return;
    }
    let before = state.memory.unwrap_or(now);
    let share = -exp_m1(-sample.time_step.max(0.0) / time_constant);
    state.memory = Some(before + (now - before) * share);
}
