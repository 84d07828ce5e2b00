//! A term by its keys. In: a term. Out: what stands behind each of its keys, and the other way. It exists so that whoever reads,
//! writes or changes terms needs no list of them: the keys are those of the [vocabulary](super::super::vocabulary).

use std::slice;

use super::{CalibratedTerm, CurveNodes, CurveValues, SeriesInput};
use crate::calibration::factor::Factor;
use crate::calibration::vocabulary::{State, TIMES, TermKind};

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
    /// The factors of a product.
    Factors(&'t [Factor]),
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
            TermKind::Delay => CalibratedTerm::Delay { axis: axis?, time: number("time")? },
            TermKind::Step => CalibratedTerm::Step { time: number("time")?, size: number("size")? },
            // The factors come to it as to any other term.
            TermKind::Product => CalibratedTerm::Constant { value: number("value")? },
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
            Self::Delay { .. } => TermKind::Delay,
            Self::Step { .. } => TermKind::Step,
            Self::Times { core, .. } => match core.kind() {
                TermKind::Constant => TermKind::Product,
                other => other,
            },
        }
    }

    /// What stands behind each key of the vocabulary that this term has, settings beside it apart. The factors of a term are among
    /// them only of a `product`, which is not without them.
    pub fn parts(&self) -> Vec<(&'static str, Part<'_>)> {
        use Part::{Axis, Factors, Load, Number, Numbers, Sensor, Unit};
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
                parts.extend(curve.period().map(|period| ("period", Number(period))));
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
            Self::Delay { axis, time } => vec![("axis", Axis(*axis)), ("time", Number(*time))],
            Self::Step { time, size } => vec![("time", Number(*time)), ("size", Number(*size))],
            Self::Times { core, factors } => {
                let mut parts = core.parts();
                if self.kind() == TermKind::Product {
                    parts.push((TIMES, Factors(factors)));
                }
                parts
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
            Self::Step { size, .. } => vec![("size", slice::from_mut(size))],
            Self::Lag { .. } | Self::Acceleration { .. } | Self::Delay { .. } => Vec::new(),
            Self::Times { core, .. } => core.linear_mut(),
        }
    }

    /// The largest size, mm or rad, that its numbers tell by themselves; 0 where the states of the machine make it.
    pub fn told_size(&self) -> f64 {
        let mut own = self.clone();
        let numbers = own.linear_mut().into_iter().flat_map(|(_, numbers)| numbers.iter().copied());
        let told: Vec<f64> = match self.kind() {
            TermKind::Constant
            | TermKind::Table
            | TermKind::Backlash
            | TermKind::ReversalSpike
            | TermKind::Cyclic
            | TermKind::Vibration
            | TermKind::Step
                if self.factors().is_empty() =>
            {
                numbers.collect()
            }
            // Where an axis travels far from its zero, the coefficients of a polynomial are large, and what they add up to is small. A drift
            // may never reach its amplitude.
            _ => Vec::new(),
        };
        told.into_iter().map(f64::abs).fold(0.0, f64::max)
    }

    /// How it grows with an axis or a sensor: its highest coefficient that is not zero, mm or rad for each power of mm, rad or degC, that
    /// power, and what it grows with. None where it does not grow, or where other states say how far.
    pub fn growth(&self) -> Option<(f64, usize, SeriesInput)> {
        let highest = |coefficients: &[f64], least: usize, input: SeriesInput| {
            let place = coefficients.iter().rposition(|coefficient| *coefficient != 0.0)?;
            Some((*coefficients.get(place)?, place.saturating_add(least), input))
        };
        match self {
            Self::Polynomial { input, coefficients } => highest(coefficients, 0, *input),
            Self::Coupling { axis, coefficients } => highest(coefficients, 1, SeriesInput::Axis(*axis)),
            Self::Growth { sensor, coefficient, .. } => Some((*coefficient, 1, SeriesInput::Sensor(*sensor))),
            _ => None,
        }
    }

    /// The term reading another sensor, where it reads one. Its factors stay.
    #[must_use]
    pub fn with_sensor(mut self, number: usize) -> Self {
        match &mut self {
            Self::Polynomial { input: SeriesInput::Sensor(sensor), .. }
            | Self::Expansion { sensor, .. }
            | Self::Growth { sensor, .. } => *sensor = number,
            Self::Times { core, .. } => **core = core.as_ref().clone().with_sensor(number),
            _ => {}
        }
        self
    }

    /// The term with each of its factors changed.
    #[must_use]
    pub fn with_factors(mut self, change: impl FnMut(Factor) -> Factor) -> Self {
        if let Self::Times { factors, .. } = &mut self {
            *factors = std::mem::take(factors).into_iter().map(change).collect();
        }
        self
    }

    /// The term reading another axis, where it reads one. Its numbers stay, whether they are per mm or per rad of it, and so do
    /// its factors.
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
            | Self::Expansion { axis, .. }
            | Self::Delay { axis, .. } => *axis = number,
            Self::Times { core, .. } => **core = core.as_ref().clone().with_axis(number),
            Self::Constant { .. }
            | Self::Polynomial { .. }
            | Self::Growth { .. }
            | Self::Drift { .. }
            | Self::Vibration { .. }
            | Self::Compliance { .. }
            | Self::Step { .. } => {}
        }
        self
    }

    /// What stands behind a key; nothing where this term does not have it.
    pub fn part(&self, key: &str) -> Option<Part<'_>> {
        self.parts().into_iter().find(|(known, _)| *known == key).map(|(_, part)| part)
    }

    /// The number of the axis that the term reads, its factors apart, if it reads one.
    pub fn axis(&self) -> Option<usize> {
        self.parts().into_iter().find_map(|(_, part)| match part {
            Part::Axis(axis) => Some(axis),
            _ => None,
        })
    }

    /// The number of the sensor that the term reads, its factors apart, if it reads one.
    pub fn sensor(&self) -> Option<usize> {
        self.parts().into_iter().find_map(|(_, part)| match part {
            Part::Sensor(sensor) => Some(sensor),
            _ => None,
        })
    }

    /// What the term and its factors depend on, with the axis where it is the state of one.
    pub fn states(&self) -> impl Iterator<Item = (State, Option<usize>)> {
        let core = match self.core() {
            Self::Polynomial { input: SeriesInput::Sensor(_), .. } => State::Temperature,
            core => core.kind().entry().state,
        };
        let factors = self.factors().iter().map(|factor| (factor.kind().entry().state, factor.axis()));
        std::iter::once((core, self.axis())).chain(factors)
    }

    /// The term with each reference of a temperature changed, its own and those of its factors.
    #[must_use]
    pub fn with_references(mut self, change: &impl Fn(f64) -> f64) -> Self {
        match &mut self {
            Self::Expansion { reference, .. } | Self::Growth { reference, .. } => {
                *reference = change(*reference)
            }
            Self::Times { core, factors } => {
                **core = core.as_ref().clone().with_references(change);
                for factor in factors {
                    if let Factor::Temperature { reference, .. } | Factor::Play { reference, .. } = factor {
                        *reference = change(*reference);
                    }
                }
            }
            _ => {}
        }
        self
    }

    /// The numbers of all sensors that the term and its factors read.
    pub fn sensors(&self) -> impl Iterator<Item = usize> {
        self.sensor().into_iter().chain(self.factors().iter().filter_map(Factor::sensor))
    }

    /// The loads that the term and its factors read.
    pub fn loads(&self) -> impl Iterator<Item = &str> {
        let own = match self.core() {
            Self::Compliance { load, .. } => Some(load.as_str()),
            _ => None,
        };
        own.into_iter().chain(self.factors().iter().filter_map(Factor::load).map(String::as_str))
    }
}
