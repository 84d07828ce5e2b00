//! Terms: one piece of physics each, as a function of the machine's state.
//!
//! In: parameters of a calibration in mm, rad, s, degC, and the [`Sample`] of this cycle. Out: the term's share of one
//! error motion. It exists because an error motion is the sum of such pieces and nothing else.

pub(crate) mod check;
pub(crate) mod memory;

use self::memory::{advance_filter, advance_play, follow, followed, take_up};
use super::math::sin;
use super::real::{Real, angle};
use super::sample::OneSample;
use super::{Factor, Sample, Table};

pub use self::memory::TermState;

/// What a polynomial reads.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Input {
    /// The position of the axis of this index, in mm or rad.
    Axis(usize),
    /// The temperature of the sensor of this index, in degC.
    Sensor(usize),
}

/// One piece of physics: it adds its value, in mm or rad, to the error motion in whose list it stands. A
/// [`Factor`](Self::Factor) adds nothing: the term behind it is multiplied with it.
///
/// Below, q is the position of the axis, v its velocity, d its direction of motion (+1 or -1) and T the temperature of the
/// sensor. Axes and sensors are indices into the slices of a [`Sample`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Term<'a> {
    /// `value`: an offset, an alignment.
    Constant {
        /// The value in mm or rad.
        value: Real,
    },
    /// The sum of `c_k q^k`, or of `c_k T^k`, from k = 0: scale, straightness, pitch; a component against temperature.
    Polynomial {
        /// The position or temperature it is a polynomial of.
        input: Input,
        /// The coefficients from k = 0 on, in mm or rad per unit of the input to the power k.
        coefficients: &'a [Real],
    },
    /// The sum of `c_k q^k` from k = 1, q of another axis: sag and cross-talk of a body that is not rigid.
    Coupling {
        /// The other axis.
        axis: usize,
        /// The coefficients from k = 1 on.
        coefficients: &'a [Real],
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
        lost_motion: Real,
        /// Wind-up w, in mm or rad: the travel after a reversal over which the play is taken up; 0: at once.
        wind_up: Real,
        /// Ramp, in s: the time over which the correction of a whole reversal is spread; 0: it is made at once. The play
        /// itself knows nothing of it: see [`Term::corrected`].
        ramp: Real,
    },
    /// `A sin(2 pi q / P + f)`: pitch error of a screw, interpolation error of an encoder.
    Cyclic {
        /// The axis.
        axis: usize,
        /// Period P, in mm or rad.
        period: Real,
        /// Amplitude A, in mm or rad.
        amplitude: Real,
        /// Phase f, in rad.
        phase: Real,
    },
    /// `c (T - T0) q`: a scale that grows with temperature.
    Expansion {
        /// The axis.
        axis: usize,
        /// The sensor.
        sensor: usize,
        /// Coefficient c, per degC (for a slide; 11.5e-6 for steel).
        coefficient: Real,
        /// Reference temperature T0, in degC.
        reference: Real,
    },
    /// `c (T* - T0)`: growth of a spindle or a structure. T* is T behind a first-order filter that starts at the first T.
    Growth {
        /// The sensor.
        sensor: usize,
        /// Coefficient c, in mm or rad per degC.
        coefficient: Real,
        /// Reference temperature T0, in degC.
        reference: Real,
        /// Time constant of the filter, in s; 0: no filter.
        time_constant: Real,
    },
    /// `-v / K`: the following error of a position loop in its steady state.
    Lag {
        /// The axis.
        axis: usize,
        /// Gain K of the position loop, in 1/s.
        gain: Real,
    },
    /// A state that the next term of the list is multiplied with; several in a row are multiplied with one another.
    Factor(Factor<'a>),
}

impl Term<'_> {
    /// The value of the term in a state of the machine, in mm or rad, or of a factor in its own unit; NaN where the sample lacks
    /// what it reads.
    ///
    /// The memory is read and not advanced, so that an inverse may ask at as many positions as it needs. A term that has
    /// not been advanced yet answers as in its first cycle.
    #[must_use]
    #[inline]
    pub fn value(&self, sample: &Sample<'_>, state: &TermState) -> Real {
        self.read_one(&mut OneSample::new(sample), state, false)
    }

    /// The value in what is read; `memory` is what the term remembers, none before its first cycle.
    #[inline(always)]
    pub(crate) fn read(&self, from: &mut OneSample<'_>, memory: Option<&Real>) -> Real {
        match *self {
            Self::Constant { value } => value,
            Self::Polynomial { input: Input::Axis(axis), coefficients } => {
                horner(coefficients, from.position(axis))
            }
            Self::Polynomial { input: Input::Sensor(sensor), coefficients } => {
                horner(coefficients, from.temperature(sensor))
            }
            Self::Coupling { axis, coefficients } => {
                let position = from.position(axis);
                position * horner(coefficients, position)
            }
            Self::Table { axis, ref table } => from.table(table, axis),
            Self::Backlash { axis, lost_motion, wind_up, .. } => {
                -0.5 * lost_motion * take_up(from, axis, wind_up, memory)
            }
            Self::Cyclic { axis, period, amplitude, phase } => {
                amplitude * sin(angle(from.position(axis) / period, phase))
            }
            Self::Expansion { axis, sensor, coefficient, reference } => {
                let warmer = from.temperature(sensor) - reference;
                coefficient * warmer * from.position(axis)
            }
            Self::Growth { sensor, coefficient, reference, time_constant } => {
                let now = from.temperature(sensor);
                let filtered = if time_constant > 0.0 { memory.copied().unwrap_or(now) } else { now };
                coefficient * (filtered - reference)
            }
            Self::Lag { axis, gain } => -from.velocity(axis) / gain,
            Self::Factor(ref factor) => factor.read(from, memory),
        }
    }

    /// The part of the value that is corrected in this cycle, in mm or rad: all of it, but for a backlash with a ramp.
    ///
    /// A drive cannot make the move that a reversal asks for at once: told to, it overshoots. Behind a ramp r the
    /// correction follows the take-up u by no more than `2 dt / r` a cycle, as CRADA Y1293-0207 spreads its
    /// compensation move over steps, and ends exactly on it; a reversal on the way turns it back from where it is.
    #[must_use]
    #[inline]
    pub fn corrected(&self, sample: &Sample<'_>, state: &TermState) -> Real {
        self.read_one(&mut OneSample::new(sample), state, true)
    }

    /// [`value`](Self::value) in what is read of one sample, or [`corrected`](Self::corrected).
    #[inline(always)]
    pub(crate) fn read_one(&self, from: &mut OneSample<'_>, state: &TermState, corrected: bool) -> Real {
        match *self {
            Self::Backlash { axis, lost_motion, wind_up, ramp } if ramp > 0.0 && corrected => {
                -0.5 * lost_motion * followed(state, take_up(from, axis, wind_up, state.remembered()))
            }
            _ => self.read(from, state.remembered()),
        }
    }

    /// Takes the term's memory over to the cycle of this sample: once a cycle, before its value is asked.
    ///
    /// A sample that lacks what the term reads, or holds NaN there, leaves the memory as it was.
    pub fn advance(&self, sample: &Sample<'_>, state: &mut TermState) {
        match *self {
            Self::Backlash { axis, wind_up, ramp, .. } => {
                if wind_up > 0.0 {
                    advance_play(sample, axis, wind_up, state);
                }
                if ramp > 0.0 {
                    let now = take_up(&OneSample::new(sample), axis, wind_up, state.remembered());
                    follow(now, sample.time_step, ramp, state);
                }
            }
            Self::Growth { sensor, time_constant, .. } if time_constant > 0.0 => {
                advance_filter(sample, sensor, time_constant, state);
            }
            Self::Factor(ref factor) => factor.advance(sample, state),
            _ => {}
        }
    }
}

/// The polynomial with the given coefficients from the constant upwards; NaN at NaN, even where it has no coefficient.
fn horner(coefficients: &[Real], at: Real) -> Real {
    coefficients.iter().rev().fold(0.0 * at, |sum, &coefficient| sum * at + coefficient)
}
