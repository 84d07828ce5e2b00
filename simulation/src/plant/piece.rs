//! Pieces: the terms of error motions, ready to be evaluated sample by sample.
//!
//! In: the terms of a calibration, the state of the machine. Out: the value of each term in mm or rad. This is a second
//! reading of what the terms mean, beside the runtime's, for all of them: also those that no controller can compensate.

use std::f64::consts::TAU;

use model_dsl::calibration::{CalibratedTerm, SeriesInput};

use super::curve::PiecewiseLinear;
use super::servo::{Before, Servo, first_order};
use super::{PlantError, State};

/// One term.
#[derive(Clone, Debug)]
pub(super) enum Piece {
    Constant(f64),
    Polynomial {
        input: SeriesInput,
        coefficients: Vec<f64>,
    },
    Table {
        axis: usize,
        curve: PiecewiseLinear,
    },
    Backlash {
        axis: usize,
        lost_motion: f64,
        wind_up: f64,
    },
    ReversalSpike {
        axis: usize,
        height: f64,
        decay: f64,
    },
    Cyclic {
        axis: usize,
        period: f64,
        amplitude: f64,
        phase: f64,
    },
    /// A lag that is not the axis's own: what a loop that follows the axis adds.
    Lag {
        axis: usize,
        loop_of: Servo,
    },
    Acceleration {
        axis: usize,
        gain: f64,
    },
    Expansion {
        axis: usize,
        sensor: usize,
        coefficient: f64,
        reference: f64,
    },
    Growth {
        sensor: usize,
        coefficient: f64,
        reference: f64,
        time_constant: f64,
    },
    Drift {
        amplitude: f64,
        time_constant: f64,
    },
    Vibration {
        frequency: f64,
        amplitude: f64,
        phase: f64,
    },
    Coupling {
        axis: usize,
        coefficients: Vec<f64>,
    },
    Compliance {
        load: usize,
        coefficient: f64,
    },
    Delay {
        axis: usize,
        time: f64,
    },
    Step {
        time: f64,
        size: f64,
    },
    /// The axis's own lag, which the position loop makes: nothing to add.
    Loop,
}

/// What a term remembers from sample to sample.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Memory {
    /// The take-up, the filtered value: nothing before the first sample.
    value: Option<f64>,
    /// What went in at the sample before.
    input: f64,
    /// The time of the sample before, s.
    time: f64,
    /// The loop of a lag.
    answered: Before,
}

impl Piece {
    /// Takes a term over, its factors apart. `loads` are the names of the load channels, which grow by those not met before.
    pub(super) fn of(term: &CalibratedTerm, loads: &mut Vec<String>) -> Result<Self, PlantError> {
        Ok(match term {
            &CalibratedTerm::Constant { value } => Self::Constant(value),
            CalibratedTerm::Polynomial { input, coefficients } => {
                Self::Polynomial { input: *input, coefficients: coefficients.clone() }
            }
            CalibratedTerm::Table { axis, curve } => {
                Self::Table { axis: *axis, curve: PiecewiseLinear::of(curve)? }
            }
            &CalibratedTerm::Backlash { axis, lost_motion, wind_up } => {
                Self::Backlash { axis, lost_motion, wind_up }
            }
            &CalibratedTerm::ReversalSpike { axis, height, decay } => {
                Self::ReversalSpike { axis, height, decay }
            }
            &CalibratedTerm::Cyclic { axis, period, amplitude, phase } => {
                Self::Cyclic { axis, period, amplitude, phase }
            }
            &CalibratedTerm::Lag { axis, gain, frequency } => {
                let root = TAU * frequency;
                let inertia = if frequency > 0.0 { 1.0 / (root * root) } else { 0.0 };
                Self::Lag { axis, loop_of: Servo::of(1.0 / gain, inertia) }
            }
            &CalibratedTerm::Acceleration { axis, gain } => Self::Acceleration { axis, gain },
            &CalibratedTerm::Expansion { axis, sensor, coefficient, reference } => {
                Self::Expansion { axis, sensor, coefficient, reference }
            }
            &CalibratedTerm::Growth { sensor, coefficient, reference, time_constant } => {
                Self::Growth { sensor, coefficient, reference, time_constant }
            }
            &CalibratedTerm::Drift { amplitude, time_constant } => Self::Drift { amplitude, time_constant },
            &CalibratedTerm::Vibration { frequency, amplitude, phase } => {
                Self::Vibration { frequency, amplitude, phase }
            }
            CalibratedTerm::Coupling { axis, coefficients } => {
                Self::Coupling { axis: *axis, coefficients: coefficients.clone() }
            }
            CalibratedTerm::Compliance { load, coefficient } => {
                Self::Compliance { load: number_of(load, loads), coefficient: *coefficient }
            }
            &CalibratedTerm::Delay { axis, time } => Self::Delay { axis, time },
            &CalibratedTerm::Step { time, size } => Self::Step { time, size },
            CalibratedTerm::Times { core, .. } => return Self::of(core, loads),
        })
    }

    /// The value of the term at a sample, in mm or rad; what it remembers goes on to this sample.
    pub(super) fn value(&self, state: &State<'_>, memory: &mut Memory) -> f64 {
        match self {
            &Self::Constant(value) => value,
            Self::Polynomial { input, coefficients } => {
                let at = match *input {
                    SeriesInput::Axis(axis) => state.position(axis),
                    SeriesInput::Sensor(sensor) => state.temperature(sensor),
                };
                series(coefficients, at)
            }
            Self::Table { axis, curve } => curve.value(state.position(*axis), state.direction(*axis)),
            &Self::Backlash { axis, lost_motion, wind_up } => {
                -0.5 * lost_motion * take_up(state, axis, wind_up, memory)
            }
            &Self::ReversalSpike { axis, height, decay } => {
                let since = state.time - state.reversal(axis);
                // Before the first reversal there is no spike.
                if since.is_nan() { 0.0 } else { -height * state.direction(axis) * (-since / decay).exp() }
            }
            &Self::Cyclic { axis, period, amplitude, phase } => {
                amplitude * (TAU * state.position(axis) / period + phase).sin()
            }
            &Self::Lag { axis, loop_of } => {
                if state.begins {
                    memory.answered = Before::default();
                }
                if let Servo::Lead { time } = loop_of {
                    return time * state.velocity(axis);
                }
                let position = state.position(axis);
                loop_of.answer(&mut memory.answered, state.time, position) - position
            }
            &Self::Acceleration { axis, gain } => -state.acceleration(axis) / gain,
            &Self::Expansion { axis, sensor, coefficient, reference } => {
                coefficient * (state.temperature(sensor) - reference) * state.position(axis)
            }
            &Self::Growth { sensor, coefficient, reference, time_constant } => {
                let now = state.temperature(sensor);
                let behind = if time_constant > 0.0 {
                    let Memory { value, input, time, .. } = memory;
                    filtered(state.time, now, time_constant, (value, input, time))
                } else {
                    now
                };
                coefficient * (behind - reference)
            }
            &Self::Drift { amplitude, time_constant } => -amplitude * (-state.time / time_constant).exp_m1(),
            &Self::Vibration { frequency, amplitude, phase } => {
                amplitude * (TAU * frequency * state.time + phase).sin()
            }
            Self::Coupling { axis, coefficients } => {
                let at = state.position(*axis);
                at * series(coefficients, at)
            }
            &Self::Compliance { load, coefficient } => coefficient * state.load(load),
            &Self::Delay { axis, time } => state.position_at(axis, state.time - time) - state.position(axis),
            &Self::Step { time, size } => {
                if state.time >= time {
                    size
                } else {
                    0.0
                }
            }
            Self::Loop => 0.0,
        }
    }
}

/// The number of a load channel, which is a new one where it was not met before.
pub(super) fn number_of(load: &str, loads: &mut Vec<String>) -> usize {
    let known = loads.iter().position(|name| name == load);
    known.unwrap_or_else(|| {
        loads.push(load.to_owned());
        loads.len() - 1
    })
}

/// The polynomial with coefficients from the constant upwards.
fn series(coefficients: &[f64], at: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * at + coefficient)
}

/// The take-up of a play: the direction, or the u within [-1, 1] that follows the position by `2 dq / w`.
fn take_up(state: &State<'_>, axis: usize, wind_up: f64, memory: &mut Memory) -> f64 {
    let position = state.position(axis);
    if wind_up <= 0.0 {
        return state.direction(axis);
    }
    if position.is_nan() {
        return f64::NAN;
    }
    let moved = match memory.value.filter(|_| !state.is_displaced(axis)) {
        None => state.direction(axis),
        Some(before) => (before + 2.0 * (position - memory.input) / wind_up).clamp(-1.0, 1.0),
    };
    *memory = Memory { value: Some(moved), input: position, time: state.time, ..*memory };
    moved
}

/// An input behind a first-order filter that starts at the first input and takes it as linear between samples.
/// Between samples it remembers the last output, the last input and their time.
pub(super) fn filtered(
    time: f64,
    input: f64,
    time_constant: f64,
    (value, last_input, last_time): (&mut Option<f64>, &mut f64, &mut f64),
) -> f64 {
    if !input.is_finite() {
        return value.unwrap_or(input);
    }
    let output = match *value {
        None => input,
        Some(before) => first_order(before, *last_input, input, (time - *last_time) / time_constant),
    };
    (*value, *last_input, *last_time) = (Some(output), input, time);
    output
}
