//! Parameters: fitted effects in the words and units of calibration files.
//!
//! In: an effect with its coefficients and their covariance. Out: named parameters with 95 % intervals; in `calibrated` the term
//! as the compiler takes it. Amplitude and phase of a wave, the coefficients of a polynomial of the position and the gain of a loop
//! are functions of what was fitted; their variances follow to first order.

mod calibrated;
mod over_travel;

use std::f64::consts::{FRAC_PI_4, TAU};

use model_dsl::calibration::factor::dimension_of;
use model_dsl::calibration::vocabulary::{Role, TIMES};
use model_dsl::calibration::{Factor, MotionName};
use model_dsl::quantity::Dimension;
use nalgebra::DVector;

use crate::alternatives::factor_state;
use crate::certainty::{Certainty, WIDTH_95};
use crate::diagnosis::{Estimate, Parameter, ParameterValue};
use crate::model::Fitted;
use crate::recording::AngleUnit;
use crate::study::Study;
use crate::terms::{Shape, polynomial_in_position};

/// A fitted effect and how certain it is.
pub(crate) struct Described<'f> {
    study: &'f Study<'f>,
    fitted: &'f Fitted,
    certainty: &'f Certainty,
    /// Recorded units for one internal unit of the motion, and their name.
    motion_unit: (f64, &'static str),
}

/// The unit in which an axis is spoken of: for one mm, or one rad of a rotary axis.
pub(crate) fn axis_unit(study: &Study<'_>, axis: usize) -> (f64, &'static str) {
    if !study.equations.axes[axis].rotary { (1.0, "mm") } else { angle_unit(study) }
}

/// The unit in which the recordings speak of angles of rotary axes.
pub(crate) fn angle_unit(study: &Study<'_>) -> (f64, &'static str) {
    let degrees = study.scenes.iter().any(|scene| scene.recording.angle_unit == AngleUnit::Degree);
    if degrees { (180.0 / std::f64::consts::PI, "deg") } else { (1.0, "rad") }
}

/// The unit of an error motion: mm; rad; that of the recordings for the turning of a rotary axis.
pub(crate) fn motion_unit(study: &Study<'_>, motion: usize) -> (f64, &'static str) {
    let known = &study.equations.motions[motion];
    match known.axis {
        Some(axis) if known.angular && study.own[axis] == Some(motion) => axis_unit(study, axis),
        _ if known.angular => (1.0, "rad"),
        _ => (1.0, "mm"),
    }
}

impl<'f> Described<'f> {
    /// An effect of the machine or of an instrument.
    pub(crate) fn new(study: &'f Study<'f>, fitted: &'f Fitted, certainty: &'f Certainty) -> Self {
        let motion_unit = fitted.effect.motion().map_or((1.0, "mm"), |motion| motion_unit(study, motion));
        Self { study, fitted, certainty, motion_unit }
    }

    fn coefficient(&self, number: usize) -> f64 {
        self.fitted.coefficients.get(number).copied().unwrap_or_default()
    }

    /// A function of the coefficients and the nonlinear parameter with this gradient.
    fn derived(&self, value: f64, gradient: &[f64], unit: (f64, String)) -> Estimate {
        let covariance = &self.certainty.covariance;
        let size = covariance.nrows();
        let gradient = DVector::from_fn(size, |row, _| gradient.get(row).copied().unwrap_or_default());
        let variance = gradient.dot(&(covariance * &gradient)).max(0.0);
        let (factor, unit) = unit;
        let (value, half) = (value * factor, WIDTH_95 * variance.sqrt() * factor.abs());
        Estimate { value, ci95: (value - half, value + half), unit }
    }

    fn linear(&self, number: usize, factor: f64, unit: String) -> Estimate {
        let mut gradient = vec![0.0; number + 1];
        gradient[number] = 1.0;
        let estimate = self.derived(self.coefficient(number), &gradient, (factor, unit));
        match self.told_beside(number) {
            true => estimate.of_one_sign(),
            false => estimate,
        }
    }

    /// Whether a coefficient is told from nothing for the nonlinear parameter as it was found.
    fn told_beside(&self, number: usize) -> bool {
        let covariance = &self.certainty.covariance;
        let last = covariance.nrows() - 1;
        if self.fitted.effect.shape.nonlinear().is_none() || number >= last || covariance[(last, last)] <= 0.0
        {
            return false;
        }
        let along = covariance[(number, last)];
        let given = covariance[(number, number)] - along * along / covariance[(last, last)];
        self.coefficient(number).abs() > WIDTH_95 * given.max(0.0).sqrt()
    }

    /// The same effect in the richer form that the data lean to.
    fn richer(&self) -> Option<Self> {
        let richer = self.certainty.richer.as_ref()?;
        let certainty = &richer.certainty;
        Some(Self { fitted: &richer.fitted, certainty, study: self.study, motion_unit: self.motion_unit })
    }

    /// The nonlinear parameter, with its own interval; where none is known, its variance stands last.
    fn nonlinear(&self, factor: f64, unit: &str) -> Estimate {
        let value = self.fitted.effect.shape.nonlinear().map_or(0.0, |parameter| parameter.value);
        if let Some((low, high)) = self.certainty.nonlinear {
            let ci95 = (low * factor, high * factor);
            return Estimate { value: value * factor, ci95, unit: unit.to_owned() };
        }
        let mut gradient = vec![0.0; self.certainty.covariance.nrows()];
        if let Some(last) = gradient.last_mut() {
            *last = 1.0;
        }
        self.derived(value, &gradient, (factor, unit.to_owned()))
    }

    fn per(&self, under: &str, power: usize) -> String {
        per(self.motion_unit.1, under, power)
    }

    /// The parameters, in the order of calibration files. Where the data lean to a richer form, the intervals hold its numbers
    /// too.
    pub(crate) fn parameters(&self) -> Vec<Parameter> {
        match self.fitted.effect.shape.factors() {
            [] => self.of_form(),
            factors => self.scaled(factors),
        }
    }

    /// The parameters of a term with factors: in mm, rad and s, its linear numbers for each unit of the factors.
    fn scaled(&self, factors: &[Factor<usize>]) -> Vec<Parameter> {
        let names = self.study.equations.names();
        let motion = self.fitted.effect.motion().and_then(|motion| names.motions.get(motion));
        let own = motion.map_or(Dimension::LENGTH, MotionName::dimension).per(dimension_of(factors, &names));
        let entry = self.calibrated().kind().entry();
        let is_linear =
            |name: &str| entry.key(name).is_some_and(|key| matches!(key.role, Role::Linear | Role::Value));
        let internal = Self { motion_unit: (1.0, ""), ..*self };
        let mut parameters = internal.of_form();
        // The numbers of a list belong to powers of the position.
        let (first, per) = match self.fitted.effect.shape.core() {
            Shape::Polynomial { axis, .. } => (0, names.axis_dimension(*axis)),
            Shape::Coupling { axis, .. } => (1, names.axis_dimension(*axis)),
            Shape::SensorPolynomial { .. } => (0, Dimension::TEMPERATURE),
            Shape::Expansion { axis, .. } => (1, names.axis_dimension(*axis).times(Dimension::TEMPERATURE)),
            Shape::Growth { .. } => (1, Dimension::TEMPERATURE),
            Shape::Compliance { .. } => (1, Dimension::FORCE),
            _ => (0, Dimension::NONE),
        };
        let unit = |place: i8| match own.per(per.power(place.saturating_add(first))) {
            Dimension::NONE => String::new(),
            known => known.internal_unit(),
        };
        for parameter in parameters.iter_mut().filter(|parameter| is_linear(parameter.name)) {
            match &mut parameter.value {
                ParameterValue::Fitted(estimate) => estimate.unit = unit(0),
                ParameterValue::List(estimates) => {
                    (0..).zip(estimates).for_each(|(place, estimate)| estimate.unit = unit(place));
                }
                _ => {}
            }
        }
        let words = factors.iter().map(|factor| factor_state(self.study, factor));
        let words = ParameterValue::Name(words.collect::<Vec<_>>().join(" * "));
        parameters.push(Parameter { name: TIMES, value: words });
        parameters
    }

    /// The parameters of the form that was fitted, and of a richer one.
    fn of_form(&self) -> Vec<Parameter> {
        let mut parameters = self.as_fitted();
        let richer = self.richer().map(|richer| richer.as_fitted()).unwrap_or_default();
        for parameter in &mut parameters {
            if let Some(other) = richer.iter().find(|other| other.name == parameter.name) {
                parameter.value.hold(&other.value);
            }
        }
        parameters
    }

    fn as_fitted(&self) -> Vec<Parameter> {
        let (factor, unit) = self.motion_unit;
        let study = self.study;
        let plain = |name, number| Parameter::fitted(name, self.linear(number, factor, unit.to_owned()));
        match self.fitted.effect.shape.core() {
            Shape::Constant => vec![plain("value", 0)],
            Shape::Polynomial { axis, .. } => {
                vec![
                    axis_name(study, *axis),
                    Parameter::list("coefficients", self.powers(axis_unit(study, *axis))),
                ]
            }
            Shape::SensorPolynomial { sensor, .. } => {
                vec![sensor_name(study, *sensor), Parameter::list("coefficients", self.powers((1.0, "K")))]
            }
            Shape::Coupling { axis, .. } => {
                let list = self.powers(axis_unit(study, *axis)).into_iter().skip(1).collect();
                vec![axis_name(study, *axis), Parameter::list("coefficients", list)]
            }
            Shape::Table { axis, nodes, directed, .. } => {
                let (axis_factor, axis_unit) = axis_unit(study, *axis);
                let places = nodes.iter().map(|node| node * axis_factor).collect();
                let at = Parameter { name: "at", value: ParameterValue::Places(places, axis_unit) };
                let values = 0..self.fitted.coefficients.len();
                let mut list: Vec<Estimate> =
                    values.map(|number| self.linear(number, factor, unit.to_owned())).collect();
                let mut parameters = vec![axis_name(study, *axis), at];
                if *directed {
                    let reverse = list.split_off(nodes.len().min(list.len()));
                    parameters.push(Parameter::list("forward", list));
                    parameters.push(Parameter::list("reverse", reverse));
                } else {
                    parameters.push(Parameter::list("values", list));
                }
                parameters
            }
            Shape::Backlash { axis, wind_up } => {
                let (axis_factor, axis_unit) = axis_unit(study, *axis);
                let mut parameters = vec![plain("lost_motion", 0)];
                if *wind_up > 0.0 {
                    parameters.push(Parameter::fitted("wind_up", self.nonlinear(axis_factor, axis_unit)));
                }
                parameters
            }
            Shape::ReversalSpike { .. } => {
                vec![plain("height", 0), Parameter::fitted("decay", self.nonlinear(1.0, "s"))]
            }
            Shape::Cyclic { axis, order, .. } => {
                let (axis_factor, axis_unit) = axis_unit(study, *axis);
                let own = axis_factor / f64::from(*order);
                let period = Parameter::fitted("period", self.nonlinear(own, axis_unit));
                [vec![period], self.wave()].concat()
            }
            Shape::Vibration { .. } => {
                let frequency = Parameter::fitted("frequency", self.nonlinear(1.0, "Hz"));
                [vec![frequency], self.wave()].concat()
            }
            Shape::Lag { inertia, .. } => {
                let mut parameters = vec![Parameter::fitted("gain", self.reciprocal("1/s"))];
                if *inertia > 0.0 {
                    parameters.push(Parameter::fitted("frequency", self.frequency()));
                }
                parameters
            }
            Shape::Acceleration { .. } => vec![Parameter::fitted("gain", self.reciprocal("1/s^2"))],
            Shape::Expansion { axis, sensor, reference } => {
                let (axis_factor, axis_unit) = axis_unit(study, *axis);
                let unit = if axis_unit == unit {
                    "1/K".to_owned()
                } else {
                    format!("{}/K", self.per(axis_unit, 1))
                };
                let coefficient = self.linear(0, factor / axis_factor, unit);
                vec![
                    sensor_name(study, *sensor),
                    Parameter::fitted("coefficient", coefficient),
                    Parameter::given("reference", *reference, "degC"),
                ]
            }
            Shape::Growth { sensor, reference, time_constant } => {
                let mut parameters = vec![
                    sensor_name(study, *sensor),
                    Parameter::fitted("coefficient", self.linear(0, factor, self.per("K", 1))),
                    Parameter::given("reference", *reference, "degC"),
                ];
                if *time_constant > 0.0 {
                    parameters.push(Parameter::fitted("time_constant", self.nonlinear(1.0, "s")));
                }
                parameters
            }
            Shape::Drift { .. } => {
                vec![plain("amplitude", 0), Parameter::fitted("time_constant", self.nonlinear(1.0, "s"))]
            }
            Shape::Compliance { load } => {
                let (name, load_unit) = &study.loads[*load];
                vec![
                    Parameter { name: "load", value: ParameterValue::Name(name.clone()) },
                    Parameter::fitted("coefficient", self.linear(0, factor, self.per(load_unit, 1))),
                ]
            }
            Shape::Delay { axis, time } => {
                vec![
                    axis_name(study, *axis),
                    Parameter::fitted("time", self.linear(0, *time, "s".to_owned())),
                ]
            }
            Shape::Step { time } => vec![Parameter::given("time", *time, "s"), plain("size", 0)],
            // Factors of factors there are none.
            Shape::Times { .. } => Vec::new(),
            Shape::Instrument(_) => vec![plain("offset", 0)],
        }
    }

    /// The rows that turn coefficients into those of powers of the position or temperature itself, from power 0 on. Where
    /// the recordings' free zeros hold the power 0, it is nothing that could be told.
    fn power_rows(&self) -> Vec<Vec<f64>> {
        let mut rows = polynomial_in_position(self.fitted.effect.shape.core());
        let untold = self.coefficient(0) == 0.0 && self.certainty.covariance[(0, 0)] == 0.0;
        if let (true, Some(row)) = (untold, rows.first_mut()) {
            row.fill(0.0);
        }
        rows
    }

    /// Coefficients of powers of the position or temperature itself, from power 0 on.
    fn powers(&self, (factor, under): (f64, &str)) -> Vec<Estimate> {
        let rows = self.power_rows();
        let power = |(power, row): (usize, &Vec<f64>)| {
            let value = row.iter().zip(&self.fitted.coefficients).map(|(a, b)| a * b).sum();
            let scale = self.motion_unit.0 / factor.powi(i32::try_from(power).unwrap_or_default());
            self.derived(value, row, (scale, self.per(under, power)))
        };
        rows.iter().enumerate().map(power).collect()
    }

    /// Amplitude and phase of a sin x + b cos x.
    fn wave(&self) -> Vec<Parameter> {
        let (a, b) = (self.coefficient(0), self.coefficient(1));
        let (amplitude, phase) = (a.hypot(b), b.atan2(a));
        let square = (amplitude * amplitude).max(f64::MIN_POSITIVE);
        let (factor, unit) = self.motion_unit;
        // Calibrations count the phase from position 0, where the period has gone on from the middle of the travel.
        let (back, turning) = match *self.fitted.effect.shape.core() {
            Shape::Cyclic { period, order, center, .. } => {
                let turns = TAU * center * f64::from(order) / period;
                (turns, turns / period)
            }
            _ => (0.0, 0.0),
        };
        vec![
            Parameter::fitted(
                "amplitude",
                self.derived(amplitude, &[a / amplitude, b / amplitude], (factor, unit.to_owned())),
            ),
            Parameter::fitted("phase", self.phase(turned(phase - back), [-b / square, a / square, turning])),
        ]
    }

    /// The phase of a wave. Where the period, or the frequency, is so uncertain that it alone leaves the phase at position 0 open,
    /// the interval is that of the phase for the period as it is told: how well the wave is known where it was measured.
    fn phase(&self, value: f64, gradient: [f64; 3]) -> Estimate {
        let covariance = &self.certainty.covariance;
        let part = |row: usize, column: usize| covariance.get((row, column)).copied().unwrap_or_default();
        let along = gradient[0] * part(0, 2) + gradient[1] * part(1, 2) + gradient[2] * part(2, 2);
        let given = if part(2, 2) > 0.0 { along * along / part(2, 2) } else { 0.0 };
        let whole = self.derived(value, &gradient, (1.0, "rad".to_owned()));
        if whole.ci95.1 - value < FRAC_PI_4 {
            return whole;
        }
        let half = (whole.ci95.1 - value) / WIDTH_95;
        let half = WIDTH_95 * (half * half - given).max(0.0).sqrt();
        Estimate { ci95: (value - half, value + half), ..whole }
    }

    /// 1 / coefficient; its interval is that of the coefficient turned over, since the gain itself is not near normal.
    fn reciprocal(&self, unit: &str) -> Estimate {
        let value = self.coefficient(0);
        let half = WIDTH_95 * self.certainty.covariance[(0, 0)].max(0.0).sqrt();
        // Both ends lie on the side of the value: beyond zero is another sign, at an infinite gain.
        let ends = match value < 0.0 {
            true => (1.0 / (value + half).min(-1e-9), 1.0 / (value - half)),
            false => (1.0 / (value + half), 1.0 / (value - half).max(1e-9)),
        };
        Estimate { value: 1.0 / value, ci95: ends, unit: unit.to_owned() }
    }

    /// The natural frequency of a loop; its ends are those of the inertia turned over.
    fn frequency(&self) -> Estimate {
        let inertia = self.nonlinear(1.0, "s^2");
        let ends = (natural(inertia.ci95.1), natural(inertia.ci95.0.max(1e-3 * inertia.value)));
        Estimate { value: natural(inertia.value), ci95: ends, unit: "Hz".to_owned() }
    }
}

/// A phase between -pi and pi.
fn turned(phase: f64) -> f64 {
    phase - TAU * (phase / TAU).round()
}

/// The natural frequency of a loop with the inertia 1/w^2, Hz; 0 for a first-order loop.
fn natural(inertia: f64) -> f64 {
    if inertia > 0.0 { 1.0 / (TAU * inertia.sqrt()) } else { 0.0 }
}

/// `mm/K`, `rad/mm^2`, `1/mm` for mm/mm^2; empty for mm/mm.
fn per(over: &str, under: &str, power: usize) -> String {
    let (over, power) = if over == under && power > 0 { ("1", power - 1) } else { (over, power) };
    match power {
        0 if over == "1" => String::new(),
        0 => over.to_owned(),
        1 => format!("{over}/{under}"),
        _ => format!("{over}/{under}^{power}"),
    }
}

fn axis_name(study: &Study<'_>, axis: usize) -> Parameter {
    Parameter { name: "axis", value: ParameterValue::Name(study.equations.axes[axis].letter.clone()) }
}

fn sensor_name(study: &Study<'_>, sensor: usize) -> Parameter {
    Parameter { name: "sensor", value: ParameterValue::Name(study.sensors[sensor].clone()) }
}

impl Estimate {
    /// Where the interval holds 0, the same width of the logarithm in its place: an amplitude grows with a time constant that
    /// outlasts the recording, and does not change its sign with it.
    fn of_one_sign(self) -> Self {
        let half = (self.ci95.1 - self.value) / self.value.abs();
        if half < 1.0 || !half.is_finite() {
            return self;
        }
        let ends = [self.value * (-half).exp(), self.value * half.exp()];
        Self { ci95: (ends[0].min(ends[1]), ends[0].max(ends[1])), ..self }
    }
}

impl ParameterValue {
    /// Widens intervals so that they hold those of the same parameters elsewhere.
    fn hold(&mut self, other: &Self) {
        let widen = |own: &mut Estimate, other: &Estimate| {
            own.ci95 = (own.ci95.0.min(other.ci95.0), own.ci95.1.max(other.ci95.1));
        };
        match (self, other) {
            (Self::Fitted(own), Self::Fitted(other)) => widen(own, other),
            (Self::List(own), Self::List(other)) => {
                own.iter_mut().zip(other).for_each(|(own, other)| widen(own, other));
            }
            _ => {}
        }
    }
}

impl Parameter {
    /// A fitted number.
    pub(crate) fn fitted(name: &'static str, estimate: Estimate) -> Self {
        Self { name, value: ParameterValue::Fitted(estimate) }
    }

    fn list(name: &'static str, estimates: Vec<Estimate>) -> Self {
        Self { name, value: ParameterValue::List(estimates) }
    }

    fn given(name: &'static str, value: f64, unit: &str) -> Self {
        Self { name, value: ParameterValue::Given(value, unit.to_owned()) }
    }
}

#[cfg(test)]
mod tests;
