//! Terms that a calibration knows already. In: a term with its numbers. Out: its shape and its coefficients.

use model_dsl::calibration::{CalibratedTerm, Curve, CurveNodes, CurveValues, SeriesInput};

use super::Shape;
use super::factor::known_times;

/// The shape and the coefficients of a calibrated term; `load` finds the channel of a load by name. `None` where the
/// recording lacks it.
pub(crate) fn known(
    term: &CalibratedTerm,
    load: &dyn Fn(&str) -> Option<usize>,
) -> Option<(Shape, Vec<f64>)> {
    let pair = match term {
        CalibratedTerm::Constant { value } => (Shape::Constant, vec![*value]),
        CalibratedTerm::Polynomial { input, coefficients } => {
            let (degree, center, scale) = (coefficients.len().saturating_sub(1), 0.0, 1.0);
            let shape = match *input {
                SeriesInput::Axis(axis) => Shape::Polynomial { axis, degree, center, scale },
                SeriesInput::Sensor(sensor) => Shape::SensorPolynomial { sensor, degree, center, scale },
            };
            (shape, coefficients.clone())
        }
        CalibratedTerm::Table { axis, curve } => table(*axis, curve),
        CalibratedTerm::Backlash { axis, lost_motion, wind_up } => {
            (Shape::Backlash { axis: *axis, wind_up: *wind_up }, vec![*lost_motion])
        }
        CalibratedTerm::ReversalSpike { axis, height, decay } => {
            (Shape::ReversalSpike { axis: *axis, decay: *decay }, vec![*height])
        }
        CalibratedTerm::Cyclic { axis, period, amplitude, phase } => {
            (Shape::Cyclic { axis: *axis, period: *period, order: 1, center: 0.0 }, wave(*amplitude, *phase))
        }
        CalibratedTerm::Lag { axis, gain, frequency } => {
            (Shape::Lag { axis: *axis, inertia: inertia(*frequency) }, vec![1.0 / gain])
        }
        CalibratedTerm::Acceleration { axis, gain } => {
            (Shape::Acceleration { axis: *axis }, vec![1.0 / gain])
        }
        CalibratedTerm::Expansion { axis, sensor, coefficient, reference } => {
            (Shape::Expansion { axis: *axis, sensor: *sensor, reference: *reference }, vec![*coefficient])
        }
        CalibratedTerm::Growth { sensor, coefficient, reference, time_constant } => (
            Shape::Growth { sensor: *sensor, reference: *reference, time_constant: *time_constant },
            vec![*coefficient],
        ),
        CalibratedTerm::Drift { amplitude, time_constant } => {
            (Shape::Drift { time_constant: *time_constant }, vec![*amplitude])
        }
        CalibratedTerm::Vibration { frequency, amplitude, phase } => {
            (Shape::Vibration { frequency: *frequency }, wave(*amplitude, *phase))
        }
        CalibratedTerm::Coupling { axis, coefficients } => {
            let degree = coefficients.len();
            (Shape::Coupling { axis: *axis, degree, scale: 1.0 }, coefficients.clone())
        }
        CalibratedTerm::Compliance { load: name, coefficient } => {
            (Shape::Compliance { load: load(name)? }, vec![*coefficient])
        }
        CalibratedTerm::Delay { axis, time } => (Shape::Delay { axis: *axis, time: *time }, vec![1.0]),
        CalibratedTerm::Step { time, size } => (Shape::Step { time: *time }, vec![*size]),
        CalibratedTerm::Times { .. } => {
            let steady = term.in_steady_state();
            return known_times(steady.core(), steady.factors(), load);
        }
    };
    Some(pair)
}

/// 1/w^2 of a loop's natural frequency in Hz; 0 for a first-order loop.
fn inertia(frequency: f64) -> f64 {
    let natural = std::f64::consts::TAU * frequency;
    if frequency > 0.0 { 1.0 / (natural * natural) } else { 0.0 }
}

/// A sin(x + f) as coefficients of sin x and cos x.
fn wave(amplitude: f64, phase: f64) -> Vec<f64> {
    vec![amplitude * phase.cos(), amplitude * phase.sin()]
}

fn table(axis: usize, curve: &Curve) -> (Shape, Vec<f64>) {
    let (mut values, directed) = match &curve.values {
        CurveValues::Both(values) => (values.clone(), false),
        CurveValues::Directed { forward, reverse } => ([forward.as_slice(), reverse].concat(), true),
    };
    let count = if directed { values.len() / 2 } else { values.len() };
    let mut nodes = nodes(&curve.nodes, count);
    if nodes.first() > nodes.last() {
        nodes.reverse();
        values.chunks_mut(count.max(1)).for_each(<[f64]>::reverse);
    }
    (Shape::Table { axis, nodes, directed, repeats: curve.repeats }, values)
}

fn nodes(nodes: &CurveNodes, count: usize) -> Vec<f64> {
    match nodes {
        CurveNodes::At(at) => at.clone(),
        CurveNodes::Uniform { start, step } => std::iter::successors(Some(0.0), |number| Some(number + 1.0))
            .take(count)
            .map(|number| start + step * number)
            .collect(),
    }
}
