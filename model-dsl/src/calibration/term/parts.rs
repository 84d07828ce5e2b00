//! A term by its keys. In: a term. Out: what stands behind each of its keys, and the other way. It exists so that whoever reads,
//! writes or changes terms needs no list of them: the keys are those of the [vocabulary](super::super::vocabulary).

use std::slice;

use super::{CalibratedTerm, CurveNodes, CurveValues, SeriesInput};
use crate::calibration::vocabulary::TermKind;

/// What stands behind a key of a term, in mm, rad, s and degC.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Part<'t> {
    /// A number. One that may be left out is 0 there.
    Number(f64),
    /// A list of numbers.
    Numbers(&'t [f64]),
    /// An axis, by its number.
    Axis(usize),
    /// A sensor, by its number.
    Sensor(usize),
    /// A load, by its name.
    Load(&'t str),
    /// The unit of numbers that stand bare.
    Unit,
}

/// What was read of a term each of whose keys says one thing.
#[derive(Debug, Default)]
pub(in crate::calibration) struct PlainParts {
    pub(in crate::calibration) axis: Option<usize>,
    pub(in crate::calibration) sensor: Option<usize>,
    pub(in crate::calibration) load: Option<String>,
    pub(in crate::calibration) numbers: Vec<(&'static str, f64)>,
}

impl PlainParts {
    /// The term of these parts; nothing where one is missing, or where the term is not plain.
    pub(in crate::calibration) fn term(self, kind: TermKind) -> Option<CalibratedTerm> {
        let number =
            |key: &str| self.numbers.iter().find(|(known, _)| *known == key).map(|(_, value)| *value);
        let (axis, sensor) = (self.axis, self.sensor);
        Some(match kind {
            TermKind::Constant => CalibratedTerm::Constant { value: number("value")? },
            TermKind::Backlash => CalibratedTerm::Backlash {
                axis: axis?,
                lost_motion: number("lost_motion")?,
                wind_up: number("wind_up")?,
            },
            TermKind::ReversalSpike => CalibratedTerm::ReversalSpike {
                axis: axis?,
                height: number("height")?,
                decay: number("decay")?,
            },
            TermKind::Cyclic => CalibratedTerm::Cyclic {
                axis: axis?,
                period: number("period")?,
                amplitude: number("amplitude")?,
                phase: number("phase")?,
            },
            TermKind::Lag => {
                CalibratedTerm::Lag { axis: axis?, gain: number("gain")?, frequency: number("frequency")? }
            }
            TermKind::Acceleration => CalibratedTerm::Acceleration { axis: axis?, gain: number("gain")? },
            TermKind::Expansion => CalibratedTerm::Expansion {
                axis: axis?,
                sensor: sensor?,
                coefficient: number("coefficient")?,
                reference: number("reference")?,
            },
            TermKind::Growth => CalibratedTerm::Growth {
                sensor: sensor?,
                coefficient: number("coefficient")?,
                reference: number("reference")?,
                time_constant: number("time_constant")?,
            },
            TermKind::Drift => CalibratedTerm::Drift {
                amplitude: number("amplitude")?,
                time_constant: number("time_constant")?,
            },
            TermKind::Vibration => CalibratedTerm::Vibration {
                frequency: number("frequency")?,
                amplitude: number("amplitude")?,
                phase: number("phase")?,
            },
            TermKind::Compliance => {
                CalibratedTerm::Compliance { coefficient: number("coefficient")?, load: self.load? }
            }
            TermKind::Polynomial | TermKind::Table | TermKind::Coupling => return None,
        })
    }
}

impl CalibratedTerm {
    /// Which term of the vocabulary it is.
    pub fn kind(&self) -> TermKind {
        match self {
            Self::Constant { .. } => TermKind::Constant,
            Self::Polynomial { .. } => TermKind::Polynomial,
            Self::Table { .. } => TermKind::Table,
            Self::Backlash { .. } => TermKind::Backlash,
            Self::ReversalSpike { .. } => TermKind::ReversalSpike,
            Self::Cyclic { .. } => TermKind::Cyclic,
            Self::Lag { .. } => TermKind::Lag,
            Self::Acceleration { .. } => TermKind::Acceleration,
            Self::Expansion { .. } => TermKind::Expansion,
            Self::Growth { .. } => TermKind::Growth,
            Self::Drift { .. } => TermKind::Drift,
            Self::Vibration { .. } => TermKind::Vibration,
            Self::Coupling { .. } => TermKind::Coupling,
            Self::Compliance { .. } => TermKind::Compliance,
        }
    }

    /// What stands behind each key of the vocabulary that this term has, settings beside it apart.
    pub fn parts(&self) -> Vec<(&'static str, Part<'_>)> {
        use Part::{Axis, Load, Number, Numbers, Sensor, Unit};
        match self {
            Self::Constant { value } => vec![("value", Number(*value))],
            Self::Polynomial { input: SeriesInput::Axis(axis), coefficients }
            | Self::Coupling { axis, coefficients } => {
                vec![
                    ("axis", Axis(*axis)),
                    ("per", Unit),
                    ("unit", Unit),
                    ("coefficients", Numbers(coefficients)),
                ]
            }
            Self::Polynomial { input: SeriesInput::Sensor(sensor), coefficients } => {
                vec![("sensor", Sensor(*sensor)), ("unit", Unit), ("coefficients", Numbers(coefficients))]
            }
            Self::Table { axis, curve } => {
                let mut parts = vec![("axis", Axis(*axis)), ("unit", Unit)];
                match &curve.nodes {
                    CurveNodes::Uniform { start, step } => {
                        parts.extend([("start", Number(*start)), ("step", Number(*step))]);
                    }
                    CurveNodes::At(at) => parts.extend([("at", Numbers(at)), ("per", Unit)]),
                }
                match &curve.values {
                    CurveValues::Both(values) => parts.push(("values", Numbers(values))),
                    CurveValues::Directed { forward, reverse } => {
                        parts.extend([("forward", Numbers(forward)), ("reverse", Numbers(reverse))]);
                    }
                }
                parts
            }
            Self::Backlash { axis, lost_motion, wind_up } => vec![
                ("axis", Axis(*axis)),
                ("lost_motion", Number(*lost_motion)),
                ("wind_up", Number(*wind_up)),
            ],
            Self::ReversalSpike { axis, height, decay } => {
                vec![("axis", Axis(*axis)), ("height", Number(*height)), ("decay", Number(*decay))]
            }
            Self::Cyclic { axis, period, amplitude, phase } => vec![
                ("axis", Axis(*axis)),
                ("period", Number(*period)),
                ("amplitude", Number(*amplitude)),
                ("phase", Number(*phase)),
            ],
            Self::Lag { axis, gain, frequency } => {
                vec![("axis", Axis(*axis)), ("gain", Number(*gain)), ("frequency", Number(*frequency))]
            }
            Self::Acceleration { axis, gain } => vec![("axis", Axis(*axis)), ("gain", Number(*gain))],
            Self::Expansion { axis, sensor, coefficient, reference } => vec![
                ("axis", Axis(*axis)),
                ("sensor", Sensor(*sensor)),
                ("coefficient", Number(*coefficient)),
                ("reference", Number(*reference)),
            ],
            Self::Growth { sensor, coefficient, reference, time_constant } => vec![
                ("sensor", Sensor(*sensor)),
                ("coefficient", Number(*coefficient)),
                ("reference", Number(*reference)),
                ("time_constant", Number(*time_constant)),
            ],
            Self::Drift { amplitude, time_constant } => {
                vec![("amplitude", Number(*amplitude)), ("time_constant", Number(*time_constant))]
            }
            Self::Vibration { frequency, amplitude, phase } => vec![
                ("frequency", Number(*frequency)),
                ("amplitude", Number(*amplitude)),
                ("phase", Number(*phase)),
            ],
            Self::Compliance { load, coefficient } => {
                vec![("load", Load(load)), ("coefficient", Number(*coefficient))]
            }
        }
    }

    /// The numbers in which the term is linear, by their keys.
    pub fn linear_mut(&mut self) -> Vec<(&'static str, &mut [f64])> {
        match self {
            Self::Constant { value } => vec![("value", slice::from_mut(value))],
            Self::Polynomial { coefficients, .. } | Self::Coupling { coefficients, .. } => {
                vec![("coefficients", coefficients)]
            }
            Self::Table { curve, .. } => match &mut curve.values {
                CurveValues::Both(values) => vec![("values", values)],
                CurveValues::Directed { forward, reverse } => {
                    vec![("forward", forward), ("reverse", reverse)]
                }
            },
            Self::Backlash { lost_motion, .. } => vec![("lost_motion", slice::from_mut(lost_motion))],
            Self::ReversalSpike { height, .. } => vec![("height", slice::from_mut(height))],
            Self::Cyclic { amplitude, .. }
            | Self::Drift { amplitude, .. }
            | Self::Vibration { amplitude, .. } => {
                vec![("amplitude", slice::from_mut(amplitude))]
            }
            Self::Expansion { coefficient, .. }
            | Self::Growth { coefficient, .. }
            | Self::Compliance { coefficient, .. } => vec![("coefficient", slice::from_mut(coefficient))],
            Self::Lag { .. } | Self::Acceleration { .. } => Vec::new(),
        }
    }

    /// The term reading another sensor, where it reads one.
    #[must_use]
    pub fn with_sensor(mut self, number: usize) -> Self {
        match &mut self {
            Self::Polynomial { input: SeriesInput::Sensor(sensor), .. }
            | Self::Expansion { sensor, .. }
            | Self::Growth { sensor, .. } => *sensor = number,
            _ => {}
        }
        self
    }

    /// The term reading another axis, where it reads one. Its numbers stay, whether they are per mm or per rad of it.
    #[must_use]
    pub fn with_axis(mut self, number: usize) -> Self {
        match &mut self {
            Self::Polynomial { input: SeriesInput::Axis(axis), .. }
            | Self::Coupling { axis, .. }
            | Self::Table { axis, .. }
            | Self::Backlash { axis, .. }
            | Self::ReversalSpike { axis, .. }
            | Self::Cyclic { axis, .. }
            | Self::Lag { axis, .. }
            | Self::Acceleration { axis, .. }
            | Self::Expansion { axis, .. } => *axis = number,
            Self::Constant { .. }
            | Self::Polynomial { .. }
            | Self::Growth { .. }
            | Self::Drift { .. }
            | Self::Vibration { .. }
            | Self::Compliance { .. } => {}
        }
        self
    }

    /// What stands behind a key; nothing where this term does not have it.
    pub fn part(&self, key: &str) -> Option<Part<'_>> {
        self.parts().into_iter().find(|(known, _)| *known == key).map(|(_, part)| part)
    }

    /// The number of the axis that the term reads, if it reads one.
    pub fn axis(&self) -> Option<usize> {
        self.parts().into_iter().find_map(|(_, part)| match part {
            Part::Axis(axis) => Some(axis),
            _ => None,
        })
    }

    /// The number of the sensor that the term reads, if it reads one.
    pub fn sensor(&self) -> Option<usize> {
        self.parts().into_iter().find_map(|(_, part)| match part {
            Part::Sensor(sensor) => Some(sensor),
            _ => None,
        })
    }
}
