//! A fitted effect as the compiler takes it.
//!
//! In: an effect with its coefficients. Out: the term as calibration files have it, in mm, rad, s and degC. What was fitted about the
//! middle of a travel, or as sine and cosine, or turned over, is given in the numbers of the vocabulary.

use std::f64::consts::TAU;

use model_dsl::calibration::{CalibratedTerm, Curve, CurveNodes, CurveValues, Factor, SeriesInput};

use super::{Described, natural, turned};
use crate::terms::Shape;

impl Described<'_> {
    /// The term as calibration files have it, in mm, rad, s and degC; a sensor under its number in the study.
    pub(crate) fn calibrated(&self) -> CalibratedTerm {
        let named = |factor: &Factor<usize>| {
            factor.clone().with_load(|load| self.study.loads.get(load).map(|(name, _)| name.clone()))
        };
        let factors = self.fitted.effect.shape.factors().iter().filter_map(named);
        self.calibrated_core().times(factors.collect())
    }

    /// The term without its factors.
    fn calibrated_core(&self) -> CalibratedTerm {
        let first = self.coefficient(0);
        let in_position = || {
            let rows = self.power_rows();
            let value = |row: &Vec<f64>| row.iter().zip(&self.fitted.coefficients).map(|(a, b)| a * b).sum();
            rows.iter().map(value).collect::<Vec<f64>>()
        };
        let (amplitude, phase) = (first.hypot(self.coefficient(1)), self.coefficient(1).atan2(first));
        match self.fitted.effect.shape.core() {
            // Factors of factors there are none.
            Shape::Constant | Shape::Times { .. } | Shape::Instrument(_) => {
                CalibratedTerm::Constant { value: first }
            }
            Shape::Polynomial { axis, .. } => {
                CalibratedTerm::Polynomial { input: SeriesInput::Axis(*axis), coefficients: in_position() }
            }
            Shape::SensorPolynomial { sensor, .. } => CalibratedTerm::Polynomial {
                input: SeriesInput::Sensor(*sensor),
                coefficients: in_position(),
            },
            Shape::Coupling { axis, .. } => {
                let coefficients = in_position().into_iter().skip(1).collect();
                CalibratedTerm::Coupling { axis: *axis, coefficients }
            }
            Shape::Table { axis, nodes, directed, repeats } => CalibratedTerm::Table {
                axis: *axis,
                curve: Curve {
                    nodes: CurveNodes::At(nodes.clone()),
                    values: self.curve(nodes.len(), *directed),
                    repeats: *repeats,
                },
            },
            Shape::Backlash { axis, wind_up } => {
                CalibratedTerm::Backlash { axis: *axis, lost_motion: first, wind_up: *wind_up }
            }
            Shape::ReversalSpike { axis, decay } => {
                CalibratedTerm::ReversalSpike { axis: *axis, height: first, decay: *decay }
            }
            Shape::Cyclic { axis, period, order, center } => {
                let period = period / f64::from(*order);
                let phase = turned(phase - TAU * center / period);
                CalibratedTerm::Cyclic { axis: *axis, period, amplitude, phase }
            }
            Shape::Lag { axis, inertia } => {
                CalibratedTerm::Lag { axis: *axis, gain: 1.0 / first, frequency: natural(*inertia) }
            }
            Shape::Acceleration { axis } => CalibratedTerm::Acceleration { axis: *axis, gain: 1.0 / first },
            Shape::Expansion { axis, sensor, reference } => CalibratedTerm::Expansion {
                axis: *axis,
                sensor: *sensor,
                coefficient: first,
                reference: *reference,
            },
            Shape::Growth { sensor, reference, time_constant } => CalibratedTerm::Growth {
                sensor: *sensor,
                coefficient: first,
                reference: *reference,
                time_constant: *time_constant,
            },
            Shape::Drift { time_constant } => {
                CalibratedTerm::Drift { amplitude: first, time_constant: *time_constant }
            }
            Shape::Vibration { frequency } => {
                CalibratedTerm::Vibration { frequency: *frequency, amplitude, phase }
            }
            Shape::Delay { axis, time } => CalibratedTerm::Delay { axis: *axis, time: first * time },
            Shape::Step { time } => CalibratedTerm::Step { time: *time, size: first },
            Shape::Compliance { load } => {
                CalibratedTerm::Compliance { load: self.study.loads[*load].0.clone(), coefficient: first }
            }
        }
    }

    fn curve(&self, nodes: usize, directed: bool) -> CurveValues {
        let values = &self.fitted.coefficients;
        if directed {
            let (forward, reverse) = values.split_at(nodes.min(values.len()));
            CurveValues::Directed { forward: forward.to_vec(), reverse: reverse.to_vec() }
        } else {
            CurveValues::Both(values.clone())
        }
    }
}
