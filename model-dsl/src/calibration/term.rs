//! Terms with their numbers: one piece of physics each, added to one error motion.

mod curve;
mod parts;

pub use curve::{Curve, CurveNodes, CurveValues};
pub use parts::Part;
pub(super) use parts::PlainParts;

use abbe_runtime::{Input, TableError, Term};
use std::fmt;

use super::factor::{Factor, FactorKind, Within};
use super::vocabulary::TermKind;

/// One term of an error motion, in mm, rad, s and degC.
///
/// An `axis` is an index into the machine's axes, a `sensor` one into the calibration's sensors. q is the position of the
/// axis, v its velocity, a its acceleration, d its direction of motion (+1 or -1), t the time since the recording began.
/// The value of a term is in mm or rad, as its error motion is.
#[derive(Clone, PartialEq, Debug)]
pub enum CalibratedTerm {
    /// An offset, an alignment.
    Constant {
        /// The value, mm or rad.
        value: f64,
    },
    /// The sum of `c_k q^k` or `c_k T^k`.
    Polynomial {
        /// What it is a polynomial of.
        input: SeriesInput,
        /// c_0, c_1, ...: mm or rad per power of mm, rad or degC.
        coefficients: Vec<f64>,
    },
    /// A measured curve, piecewise linear, held constant outside.
    Table {
        /// The axis along which it was measured.
        axis: usize,
        /// The curve.
        curve: Curve,
    },
    /// `-B/2 d`, or with a wind-up w the play operator `-B/2 u`, u following q by `2 dq/w` within [-1, 1].
    Backlash {
        /// The axis whose direction counts.
        axis: usize,
        /// B, mm or rad.
        lost_motion: f64,
        /// w, in the axis's mm or rad, not negative; 0: the backlash is taken up at once.
        wind_up: f64,
    },
    /// `-H d exp(-(t - t_reversal)/tau)`: a spike after each reversal.
    ReversalSpike {
        /// The axis that reverses.
        axis: usize,
        /// H, mm or rad.
        height: f64,
        /// tau, s, greater than zero.
        decay: f64,
    },
    /// `A sin(2 pi q/P + f)`.
    Cyclic {
        /// The axis.
        axis: usize,
        /// P, in the axis's mm or rad, greater than zero.
        period: f64,
        /// A, mm or rad.
        amplitude: f64,
        /// f, rad.
        phase: f64,
    },
    /// The lag of a position loop, `-v/K` in steady state. With a natural frequency w the loop is of second order,
    /// `q'' = w^2 (q_cmd - q) - (w^2/K) q'`, and rings where its damping `w/(2 K)` is below 1; without, it is
    /// `q' = K (q_cmd - q)`. Below zero K is that of a drive that leads, because its feed-forward is too large:
    /// `q = q_cmd - v/K`, v the velocity of the command.
    Lag {
        /// The axis.
        axis: usize,
        /// K, 1/s, not zero; greater than zero where there is a natural frequency.
        gain: f64,
        /// w/(2 pi), Hz, not negative; 0: a first-order loop.
        frequency: f64,
    },
    /// `-a/K`.
    Acceleration {
        /// The axis.
        axis: usize,
        /// K, 1/s^2, greater than zero.
        gain: f64,
    },
    /// `c (T - T0) q`.
    Expansion {
        /// The axis.
        axis: usize,
        /// The sensor of T.
        sensor: usize,
        /// c, mm or rad per mm or rad of the axis and degC.
        coefficient: f64,
        /// T0, degC.
        reference: f64,
    },
    /// `c (T* - T0)`, T* being T through a first-order filter.
    Growth {
        /// The sensor of T.
        sensor: usize,
        /// c, mm or rad per degC.
        coefficient: f64,
        /// T0, degC.
        reference: f64,
        /// The filter's time constant, s, not negative; 0: no filter.
        time_constant: f64,
    },
    /// `A (1 - exp(-t/tau))`.
    Drift {
        /// A, mm or rad.
        amplitude: f64,
        /// tau, s, greater than zero.
        time_constant: f64,
    },
    /// `A sin(2 pi f t + phase)`.
    Vibration {
        /// f, 1/s, greater than zero.
        frequency: f64,
        /// A, mm or rad.
        amplitude: f64,
        /// The phase, rad.
        phase: f64,
    },
    /// The sum of `c_k q^k`, k from 1, of another axis.
    Coupling {
        /// The other axis.
        axis: usize,
        /// c_1, c_2, ...: mm or rad per power of the axis's mm or rad.
        coefficients: Vec<f64>,
    },
    /// `c F`.
    Compliance {
        /// The load's channel.
        load: String,
        /// c, mm or rad per N, V, A, % or count.
        coefficient: f64,
    },
    /// `q(t - T) - q(t)`: the axis is where it was told to be a time T ago.
    Delay {
        /// The axis.
        axis: usize,
        /// T, s; below zero the axis is early.
        time: f64,
    },
    /// 0 before a time, and the size from it on: an event.
    Step {
        /// The time, s.
        time: f64,
        /// The size, mm or rad.
        size: f64,
    },
    /// A term times factors. Around a constant it is a `product`. A lag there is its steady state, `-v/K`.
    Times {
        /// The term, which has no factors itself: mm or rad for each unit of their product.
        core: Box<CalibratedTerm>,
        /// The factors, at least one.
        factors: Vec<Factor>,
    },
}

/// What a polynomial is a polynomial of.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SeriesInput {
    /// The position of an axis, mm or rad.
    Axis(usize),
    /// The temperature of a sensor, degC.
    Sensor(usize),
}

/// Why a term has no counterpart in the runtime.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NotCompensable {
    /// The term depends on what a controller cannot know in time.
    Term(TermKind),
    /// A factor depends on it.
    Factor(FactorKind),
    /// The table is not one that the runtime reads.
    Table(TableError),
}

impl fmt::Display for NotCompensable {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Term(kind) => write!(formatter, "`{}` cannot be compensated in real time", kind.name()),
            Self::Factor(kind) => {
                write!(formatter, "the factor `{}` cannot be compensated in real time", kind.name())
            }
            Self::Table(error) => error.fmt(formatter),
        }
    }
}

impl std::error::Error for NotCompensable {}

impl CalibratedTerm {
    /// The term's name in calibration files.
    pub fn name(&self) -> &'static str {
        self.kind().name()
    }

    /// The term times factors; itself where there are none.
    #[must_use]
    pub fn times(self, factors: Vec<Factor>) -> Self {
        if factors.is_empty() { self } else { Self::Times { core: Box::new(self), factors } }
    }

    /// The term without its factors.
    pub fn core(&self) -> &Self {
        match self {
            Self::Times { core, .. } => core,
            plain => plain,
        }
    }

    /// The term with a lag that has factors as what it is, `-v/K` times them; any other as it is.
    #[must_use]
    pub fn in_steady_state(&self) -> Self {
        match self {
            Self::Times { core, factors } => match **core {
                Self::Lag { axis, gain, .. } => {
                    let velocity = Factor::Velocity { axis, within: Within::EVERYWHERE };
                    let factors = std::iter::once(velocity).chain(factors.iter().cloned());
                    Self::Constant { value: -1.0 / gain }.times(factors.collect())
                }
                _ => self.clone(),
            },
            plain => plain.clone(),
        }
    }

    /// The positions of an axis at which it was measured, in mm or rad: the nodes of its table, and of the curves among its factors.
    pub fn nodes(&self, axis: usize) -> Vec<f64> {
        let mut nodes = match self.core() {
            Self::Table { axis: over, curve } if *over == axis => curve.positions(),
            _ => Vec::new(),
        };
        for factor in self.factors() {
            if let Factor::Curve { axis: over, at, .. } = factor
                && *over == axis
            {
                nodes.extend(at);
            }
        }
        nodes
    }

    /// Its factors; none of most terms.
    pub fn factors(&self) -> &[Factor] {
        match self {
            Self::Times { factors, .. } => factors,
            _ => &[],
        }
    }

    /// Why no controller can compensate the term in real time, and what of it; nothing where one can.
    pub fn not_compensable(&self) -> Option<(NotCompensable, &'static str)> {
        let of_factors = self.factors().iter().find_map(|factor| {
            let kind = factor.kind();
            kind.entry().not_compensable.map(|reason| (NotCompensable::Factor(kind), reason))
        });
        let kind = self.kind();
        kind.entry().not_compensable.map(|reason| (NotCompensable::Term(kind), reason)).or(of_factors)
    }

    /// Whether a controller can compensate the term in real time.
    pub fn compensable(&self) -> bool {
        self.not_compensable().is_none()
    }

    /// The term as the runtime evaluates it, its factors before it, with the same indices of axes and sensors; of a backlash,
    /// the physics without a ramp, which [`Calibration::runtime`](super::Calibration::runtime) knows.
    ///
    /// # Errors
    ///
    /// The reason for what [`CalibratedTerm::compensable`] denies, or [`NotCompensable::Table`].
    pub fn runtime(&self) -> Result<Vec<Term<'_>>, NotCompensable> {
        let factors = self.factors().iter().map(|factor| factor.runtime().map(Term::Factor));
        factors.chain([self.core().runtime_core()]).collect()
    }

    /// The term itself as the runtime evaluates it.
    fn runtime_core(&self) -> Result<Term<'_>, NotCompensable> {
        let term = match self {
            Self::Constant { value } => Term::Constant { value: *value },
            Self::Polynomial { input, coefficients } => {
                Term::Polynomial { input: (*input).into(), coefficients }
            }
            Self::Coupling { axis, coefficients } => Term::Coupling { axis: *axis, coefficients },
            Self::Table { axis, curve } => {
                let table = curve.runtime().map_err(NotCompensable::Table)?;
                Term::Table { axis: *axis, table }
            }
            &Self::Backlash { axis, lost_motion, wind_up } => {
                Term::Backlash { axis, lost_motion, wind_up, ramp: 0.0 }
            }
            &Self::Cyclic { axis, period, amplitude, phase } => {
                Term::Cyclic { axis, period, amplitude, phase }
            }
            &Self::Lag { axis, gain, frequency: _ } => Term::Lag { axis, gain },
            &Self::Expansion { axis, sensor, coefficient, reference } => {
                Term::Expansion { axis, sensor, coefficient, reference }
            }
            &Self::Growth { sensor, coefficient, reference, time_constant } => {
                Term::Growth { sensor, coefficient, reference, time_constant }
            }
            // What a time behind is, a controller knows to first order.
            &Self::Delay { axis, time } => Term::Lag { axis, gain: 1.0 / time },
            _ => return Err(NotCompensable::Term(self.kind())),
        };
        Ok(term)
    }
}

impl From<SeriesInput> for Input {
    fn from(input: SeriesInput) -> Self {
        match input {
            SeriesInput::Axis(axis) => Self::Axis(axis),
            SeriesInput::Sensor(sensor) => Self::Sensor(sensor),
        }
    }
}
