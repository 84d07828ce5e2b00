//! Terms with their numbers: one piece of physics each, added to one error motion.

use abbe_runtime::{Input, Table, TableError, Term, Values};
use std::fmt;

/// The names of all terms as calibration files write them.
pub const TERM_NAMES: [&str; 14] = [
    "constant",
    "polynomial",
    "table",
    "backlash",
    "reversal-spike",
    "cyclic",
    "lag",
    "acceleration",
    "expansion",
    "growth",
    "drift",
    "vibration",
    "coupling",
    "compliance",
];

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
        /// w, in the axis's mm or rad, not negative; 0: the play is taken up at once.
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
        /// w/(2 pi), Hz, not negative; 0: a loop of first order.
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
}

/// What a polynomial is a polynomial of.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SeriesInput {
    /// The position of an axis, mm or rad.
    Axis(usize),
    /// The temperature of a sensor, degC.
    Sensor(usize),
}

/// A measured curve over an axis.
#[derive(Clone, PartialEq, Debug)]
pub struct Curve {
    /// Where it was measured, in the axis's mm or rad.
    pub nodes: CurveNodes,
    /// What was measured there, mm or rad; one value a node.
    pub values: CurveValues,
}

/// The positions at which a curve was measured.
#[derive(Clone, PartialEq, Debug)]
pub enum CurveNodes {
    /// Equal steps; the step may be negative, but not zero.
    Uniform {
        /// The first node.
        start: f64,
        /// From one node to the next.
        step: f64,
    },
    /// Any positions, strictly ascending.
    At(Vec<f64>),
}

/// The values of a curve.
#[derive(Clone, PartialEq, Debug)]
pub enum CurveValues {
    /// The same in both directions of motion.
    Both(Vec<f64>),
    /// One curve for each direction of motion, of equal length.
    Directed {
        /// While the axis moves in its positive direction.
        forward: Vec<f64>,
        /// While it moves in its negative direction.
        reverse: Vec<f64>,
    },
}

impl Curve {
    /// The curve as the runtime reads it.
    ///
    /// # Errors
    ///
    /// What the runtime refuses; a curve read from a file without findings has none of it.
    pub fn runtime(&self) -> Result<Table<'_>, TableError> {
        let values = match &self.values {
            CurveValues::Both(values) => Values::Both(values),
            CurveValues::Directed { forward, reverse } => Values::Directed { forward, reverse },
        };
        match &self.nodes {
            CurveNodes::Uniform { start, step } => Table::uniform(*start, *step, values),
            CurveNodes::At(at) => Table::at(at, values),
        }
    }

    /// The positions of its nodes, in the axis's mm or rad, in the order of the values.
    pub fn positions(&self) -> Vec<f64> {
        match &self.nodes {
            CurveNodes::At(places) => places.clone(),
            // Every step is one value further.
            CurveNodes::Uniform { start, step } => {
                let further = |place: &mut f64, _: &f64| Some(std::mem::replace(place, *place + step));
                self.values.forward().iter().scan(*start, further).collect()
            }
        }
    }

    /// Its first and its last node; nothing where it has none.
    pub fn ends(&self) -> Option<[f64; 2]> {
        let positions = self.positions();
        Some([*positions.first()?, *positions.last()?])
    }
}

impl CurveValues {
    /// The values while the axis moves in its positive direction.
    pub fn forward(&self) -> &[f64] {
        match self {
            Self::Both(values) => values,
            Self::Directed { forward, .. } => forward,
        }
    }
}

/// Why a term has no counterpart in the runtime.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NotCompensable {
    /// The term of this name depends on what a controller cannot know in time.
    Term(&'static str),
    /// The table is not one that the runtime reads.
    Table(TableError),
}

impl fmt::Display for NotCompensable {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Term(name) => write!(formatter, "`{name}` cannot be compensated in real time"),
            Self::Table(error) => error.fmt(formatter),
        }
    }
}

impl std::error::Error for NotCompensable {}

impl CalibratedTerm {
    /// The term's name in calibration files, one of [`TERM_NAMES`].
    pub fn name(&self) -> &'static str {
        match self {
            Self::Constant { .. } => "constant",
            Self::Polynomial { .. } => "polynomial",
            Self::Table { .. } => "table",
            Self::Backlash { .. } => "backlash",
            Self::ReversalSpike { .. } => "reversal-spike",
            Self::Cyclic { .. } => "cyclic",
            Self::Lag { .. } => "lag",
            Self::Acceleration { .. } => "acceleration",
            Self::Expansion { .. } => "expansion",
            Self::Growth { .. } => "growth",
            Self::Drift { .. } => "drift",
            Self::Vibration { .. } => "vibration",
            Self::Coupling { .. } => "coupling",
            Self::Compliance { .. } => "compliance",
        }
    }

    /// Whether a controller can compensate the term in real time.
    pub fn compensable(&self) -> bool {
        self.refusal().is_none()
    }

    fn refusal(&self) -> Option<NotCompensable> {
        match self {
            Self::ReversalSpike { .. }
            | Self::Acceleration { .. }
            | Self::Drift { .. }
            | Self::Vibration { .. }
            | Self::Compliance { .. } => Some(NotCompensable::Term(self.name())),
            _ => None,
        }
    }

    /// The term as the runtime evaluates it, with the same indices of axes and sensors; of a backlash, the physics without
    /// a ramp, which [`Calibration::runtime`](super::Calibration::runtime) knows.
    ///
    /// # Errors
    ///
    /// [`NotCompensable::Term`] for the terms that [`CalibratedTerm::compensable`] denies.
    pub fn runtime(&self) -> Result<Term<'_>, NotCompensable> {
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
            _ => return Err(NotCompensable::Term(self.name())),
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
