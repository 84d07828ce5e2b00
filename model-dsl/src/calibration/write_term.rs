//! One term as it is written. In: a term and the names of its machine. Out: its parameters, in mm, rad, s and degC.

use super::names::{MachineNames, MotionName};
use super::sensors::Sensors;
use super::spelling::{Item, number, quantity, word};
use super::term::{CalibratedTerm, Curve, CurveNodes, CurveValues, SeriesInput};

/// What stands for a motion or an axis that the machine lacks; no machine has one of this name.
pub(super) const UNKNOWN: &str = "?";

type Parameters = Vec<(&'static str, Item)>;

/// What the terms of one error motion are written against.
pub(super) struct Context<'a> {
    pub(super) names: &'a MachineNames,
    pub(super) sensors: &'a Sensors,
    pub(super) motion: Option<&'a MotionName>,
}

/// The parameters of a term, in the order in which the manual lists them.
pub(super) fn parameters(term: &CalibratedTerm, context: &Context<'_>) -> Parameters {
    let motion = context.motion_unit();
    let value = |value: f64| one(quantity(value, motion));
    match term {
        CalibratedTerm::Constant { value: constant } => vec![("value", value(*constant))],
        CalibratedTerm::Polynomial { input, coefficients } => polynomial(*input, coefficients, context),
        CalibratedTerm::Table { axis, curve } => table(*axis, curve, context),
        CalibratedTerm::Coupling { axis, coefficients } => {
            let input = SeriesInput::Axis(*axis);
            polynomial(input, coefficients, context)
        }
        CalibratedTerm::Backlash { axis, lost_motion, wind_up } => {
            let wind_up =
                (*wind_up != 0.0).then(|| ("wind_up", one(quantity(*wind_up, context.axis_unit(*axis)))));
            let parameters = vec![("lost_motion", value(*lost_motion))];
            context.on_axis(*axis, parameters.into_iter().chain(wind_up).collect())
        }
        CalibratedTerm::ReversalSpike { axis, height, decay } => {
            context.on_axis(*axis, vec![("height", value(*height)), ("decay", one(quantity(*decay, "s")))])
        }
        CalibratedTerm::Cyclic { axis, period, amplitude, phase } => {
            let period = one(quantity(*period, context.axis_unit(*axis)));
            let parameters =
                vec![("period", period), ("amplitude", value(*amplitude)), ("phase", angle(*phase))];
            context.on_axis(*axis, parameters)
        }
        CalibratedTerm::Lag { axis, gain, frequency } => {
            let unit = ratio(context.axis_unit(*axis), motion, "s");
            let frequency = (*frequency != 0.0).then(|| ("frequency", one(quantity(*frequency, "Hz"))));
            let parameters = vec![("gain", one(quantity(*gain, &unit)))];
            context.on_axis(*axis, parameters.into_iter().chain(frequency).collect())
        }
        CalibratedTerm::Acceleration { axis, gain } => {
            let unit = ratio(context.axis_unit(*axis), motion, "s^2");
            context.on_axis(*axis, vec![("gain", one(quantity(*gain, &unit)))])
        }
        CalibratedTerm::Expansion { axis, sensor, coefficient, reference } => {
            let unit = ratio(motion, context.axis_unit(*axis), "K");
            context.on_axis(*axis, thermal(context.sensor(*sensor), *coefficient, &unit, *reference))
        }
        CalibratedTerm::Growth { sensor, coefficient, reference, time_constant } => {
            let unit = format!("{motion}/K");
            let filter =
                (*time_constant != 0.0).then(|| ("time_constant", one(quantity(*time_constant, "s"))));
            let parameters = thermal(context.sensor(*sensor), *coefficient, &unit, *reference);
            parameters.into_iter().chain(filter).collect()
        }
        CalibratedTerm::Drift { amplitude, time_constant } => {
            vec![("amplitude", value(*amplitude)), ("time_constant", one(quantity(*time_constant, "s")))]
        }
        CalibratedTerm::Vibration { frequency, amplitude, phase } => {
            let frequency = one(quantity(*frequency, "Hz"));
            vec![("frequency", frequency), ("amplitude", value(*amplitude)), ("phase", angle(*phase))]
        }
        CalibratedTerm::Compliance { load, coefficient } => {
            let coefficient = quantity(*coefficient, &format!("{motion}/N"));
            vec![("load", one(word(load))), ("coefficient", one(coefficient))]
        }
    }
}

fn polynomial(input: SeriesInput, coefficients: &[f64], context: &Context<'_>) -> Parameters {
    let mut parameters = match input {
        SeriesInput::Axis(axis) => {
            vec![("axis", context.axis(axis)), ("per", one(context.axis_unit(axis).to_owned()))]
        }
        SeriesInput::Sensor(sensor) => vec![("sensor", context.sensor(sensor))],
    };
    parameters.push(("unit", one(context.motion_unit().to_owned())));
    parameters.push(("coefficients", numbers(coefficients)));
    parameters
}

fn table(axis: usize, curve: &Curve, context: &Context<'_>) -> Parameters {
    let unit = context.axis_unit(axis);
    let mut parameters = vec![("axis", context.axis(axis))];
    match &curve.nodes {
        CurveNodes::Uniform { start, step } => {
            parameters.push(("start", one(quantity(*start, unit))));
            parameters.push(("step", one(quantity(*step, unit))));
        }
        CurveNodes::At(at) => {
            parameters.push(("at", numbers(at)));
            parameters.push(("per", one(unit.to_owned())));
        }
    }
    parameters.push(("unit", one(context.motion_unit().to_owned())));
    match &curve.values {
        CurveValues::Both(values) => parameters.push(("values", numbers(values))),
        CurveValues::Directed { forward, reverse } => {
            parameters.push(("forward", numbers(forward)));
            parameters.push(("reverse", numbers(reverse)));
        }
    }
    parameters
}

fn thermal(sensor: Item, coefficient: f64, unit: &str, reference: f64) -> Parameters {
    let coefficient = one(quantity(coefficient, unit));
    vec![("sensor", sensor), ("coefficient", coefficient), ("reference", one(quantity(reference, "degC")))]
}

impl Context<'_> {
    /// The unit of the error motion.
    pub(super) fn motion_unit(&self) -> &'static str {
        unit(self.motion.is_some_and(|motion| motion.angular))
    }

    fn axis_unit(&self, axis: usize) -> &'static str {
        unit(self.names.axes.get(axis).is_some_and(|axis| axis.rotary))
    }

    fn axis(&self, axis: usize) -> Item {
        one(word(self.letter(axis)))
    }

    fn letter(&self, axis: usize) -> &str {
        self.names.axes.get(axis).map_or(UNKNOWN, |axis| axis.letter.as_str())
    }

    /// Parameters of a term on an axis, which is named where it is not that of the motion's own link.
    fn on_axis(&self, axis: usize, mut parameters: Parameters) -> Parameters {
        if self.motion.and_then(|motion| motion.axis.as_deref()) != Some(self.letter(axis)) {
            parameters.push(("axis", self.axis(axis)));
        }
        parameters
    }

    /// A sensor by its name. Any word would name one, so that what is not there is a list.
    fn sensor(&self, sensor: usize) -> Item {
        match self.sensors.iter().nth(sensor) {
            Some(known) => one(word(&known.name.value)),
            None => Item::List(Vec::new()),
        }
    }
}

fn unit(angular: bool) -> &'static str {
    if angular { "rad" } else { "mm" }
}

/// A unit over another and over a third: `1/s` where the first two cancel, or `mm/rad/s`.
fn ratio(above: &str, below: &str, rest: &str) -> String {
    if above == below { format!("1/{rest}") } else { format!("{above}/{below}/{rest}") }
}

fn one(text: String) -> Item {
    Item::One(text)
}

fn angle(value: f64) -> Item {
    one(quantity(value, "rad"))
}

fn numbers(values: &[f64]) -> Item {
    Item::List(values.iter().map(|value| number(*value)).collect())
}
