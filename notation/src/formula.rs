//! Terms as formulas. In: a term with its numbers, the names of its machine and of its sensors. Out: its value as plain text, LaTeX and
//! MathML, for reports and pages.
//!
//! The position of an axis is its small letter; `v`, `a` and `d` are velocity, acceleration and direction, `u` where a play stands, `W`
//! a warmth, `T` a temperature, `T'` one behind a play, `F` a load and `n` turns, each with its axis, sensor or channel below. In square
//! brackets stands what is held within the range in which it was seen, `f` is a measured curve.

mod spelling;

use model_dsl::calibration::factor::{Factor, Within, dimension_of};
use model_dsl::calibration::{CalibratedTerm, MachineNames, MotionName, Sensors, SeriesInput};
use model_dsl::quantity::Dimension;
use spelling::{Latex, MathMl, Plain, spelled};

/// A term in three notations.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Formula {
    /// Plain text: `-0.0038 mm * d_X * f(x)`.
    pub text: String,
    /// LaTeX, to be set in a formula.
    pub latex: String,
    /// A MathML `math` element.
    pub mathml: String,
}

/// What a formula is made of.
enum Math {
    /// A number with its unit, which may be empty.
    Quantity(f64, String),
    /// A letter, and what it is of.
    Symbol(String, String),
    /// Factors.
    Product(Vec<Math>),
    /// Parts with whether they are subtracted.
    Sum(Vec<(bool, Math)>),
    Quotient(Box<Math>, Box<Math>),
    Power(Box<Math>, usize),
    /// A function of something: `sin`, `exp`, `f`.
    Function(String, Box<Math>),
    Size(Box<Math>),
    /// 1 from a time on, and before it 0.
    Since(f64),
    /// Something held within a range.
    Held(Box<Math>),
}

/// The value of a term as a formula; `motion` is the number of its error motion.
pub fn formula(term: &CalibratedTerm, motion: usize, names: &MachineNames, sensors: &Sensors) -> Formula {
    let math = Words { names, sensors, motion: names.motions.get(motion) }.term(term);
    Formula {
        text: spelled(&math, &Plain),
        latex: spelled(&math, &Latex),
        mathml: format!("<math>{}</math>", spelled(&math, &MathMl)),
    }
}

/// What a term is written against.
struct Words<'w> {
    names: &'w MachineNames,
    sensors: &'w Sensors,
    motion: Option<&'w MotionName>,
}

impl Words<'_> {
    fn term(&self, term: &CalibratedTerm) -> Math {
        let steady = term.in_steady_state();
        let mut parts = self.core(steady.core(), self.scale(&steady));
        parts.extend(steady.factors().iter().map(|factor| self.factor(factor)));
        Math::Product(parts)
    }

    /// The kind of quantity that the linear numbers of a term are.
    fn scale(&self, term: &CalibratedTerm) -> Dimension {
        let motion = self.motion.map_or(Dimension::LENGTH, MotionName::dimension);
        motion.per(dimension_of(term.factors(), self.names))
    }

    /// A linear number of a term whose values are of this kind, which may be per more.
    fn linear(value: f64, scale: Dimension, per: Dimension) -> Math {
        let unit = match scale.per(per) {
            Dimension::NONE => String::new(),
            known => known.internal_unit(),
        };
        Math::Quantity(value, unit)
    }

    /// The factors of a term without those of its own.
    fn core(&self, term: &CalibratedTerm, scale: Dimension) -> Vec<Math> {
        let plain = |value: f64| Self::linear(value, scale, Dimension::NONE);
        let position = |axis: usize| self.names.axis_dimension(axis);
        match term {
            CalibratedTerm::Constant { value } => vec![plain(*value)],
            CalibratedTerm::Polynomial { input: SeriesInput::Axis(axis), coefficients } => {
                vec![series(coefficients, 0, &|| self.position(*axis), scale, position(*axis))]
            }
            CalibratedTerm::Polynomial { input: SeriesInput::Sensor(sensor), coefficients } => {
                vec![series(coefficients, 0, &|| self.temperature(*sensor), scale, Dimension::TEMPERATURE)]
            }
            CalibratedTerm::Coupling { axis, coefficients } => {
                vec![series(coefficients, 1, &|| self.position(*axis), scale, position(*axis))]
            }
            CalibratedTerm::Table { axis, .. } => {
                vec![Math::Function("f".to_owned(), self.position(*axis).into())]
            }
            CalibratedTerm::Backlash { axis, lost_motion, wind_up } => {
                let way = if *wind_up > 0.0 { "u" } else { "d" };
                vec![plain(-0.5 * lost_motion), self.of_axis(way, *axis)]
            }
            CalibratedTerm::ReversalSpike { axis, height, decay } => {
                let since = Math::Symbol("t".to_owned(), self.letter(*axis));
                vec![plain(-height), self.of_axis("d", *axis), fading(since, quantity(*decay, "s"))]
            }
            CalibratedTerm::Cyclic { axis, period, amplitude, phase } => {
                vec![plain(*amplitude), self.wave(*axis, *period, *phase)]
            }
            CalibratedTerm::Lag { axis, gain, .. } => {
                vec![quantity(-1.0 / gain, "s"), self.of_axis("v", *axis)]
            }
            CalibratedTerm::Acceleration { axis, gain } => {
                vec![quantity(-1.0 / gain, "s^2"), self.of_axis("a", *axis)]
            }
            CalibratedTerm::Expansion { axis, sensor, coefficient, reference } => {
                let per = position(*axis).times(Dimension::TEMPERATURE);
                let warmer = self.warmer(self.temperature(*sensor), *reference);
                vec![Self::linear(*coefficient, scale, per), warmer, self.position(*axis)]
            }
            CalibratedTerm::Growth { sensor, coefficient, reference, .. } => {
                let warmer = self.warmer(self.temperature(*sensor), *reference);
                vec![Self::linear(*coefficient, scale, Dimension::TEMPERATURE), warmer]
            }
            CalibratedTerm::Drift { amplitude, time_constant } => {
                let gone = fading(time(), quantity(*time_constant, "s"));
                vec![plain(*amplitude), Math::Sum(vec![(false, quantity(1.0, "")), (true, gone)])]
            }
            CalibratedTerm::Vibration { frequency, amplitude, phase } => {
                let turns = vec![turn(), quantity(*frequency, "Hz"), time()];
                vec![plain(*amplitude), sine(Math::Product(turns), *phase)]
            }
            CalibratedTerm::Compliance { load, coefficient } => {
                vec![
                    Self::linear(*coefficient, scale, Dimension::FORCE),
                    Math::Symbol("F".to_owned(), load.clone()),
                ]
            }
            CalibratedTerm::Delay { axis, time: late } => {
                let earlier = Math::Sum(vec![(false, time()), (true, quantity(*late, "s"))]);
                let at = |time: Math| Math::Function(self.letter(*axis).to_lowercase(), time.into());
                vec![Math::Sum(vec![(false, at(earlier)), (true, at(time()))])]
            }
            CalibratedTerm::Step { time, size } => vec![plain(*size), Math::Since(*time)],
            CalibratedTerm::Times { core, .. } => self.core(core, scale),
        }
    }

    fn factor(&self, factor: &Factor) -> Math {
        match factor {
            Factor::Position { axis, power, within } => {
                let held = held(self.position(*axis), *within);
                if *power > 1 { Math::Power(held.into(), usize::from(*power)) } else { held }
            }
            Factor::Direction { axis } => self.of_axis("d", *axis),
            Factor::Velocity { axis, within } => held(self.of_axis("v", *axis), *within),
            Factor::Speed { axis, within } => held(Math::Size(self.of_axis("v", *axis).into()), *within),
            Factor::Fading { axis, over } => {
                fading(Math::Size(self.of_axis("v", *axis).into()), quantity(*over, &self.speed(*axis)))
            }
            Factor::Acceleration { axis, within } => held(self.of_axis("a", *axis), *within),
            Factor::Temperature { sensor, reference, within, .. } => {
                self.warmer(held(self.temperature(*sensor), *within), *reference)
            }
            Factor::Play { sensor, reference, .. } => {
                self.warmer(Math::Symbol("T'".to_owned(), self.sensor(*sensor)), *reference)
            }
            Factor::Warmth { axis, .. } => self.of_axis("W", *axis),
            Factor::Load { load, within } => held(Math::Symbol("F".to_owned(), load.clone()), *within),
            Factor::Half { load, at } => {
                let share = Math::Quotient(
                    Math::Size(Math::Symbol("F".to_owned(), load.clone()).into()).into(),
                    quantity(*at, "N").into(),
                );
                let whole = Math::Sum(vec![(false, quantity(1.0, "")), (false, share)]);
                Math::Quotient(quantity(1.0, "").into(), whole.into())
            }
            Factor::Turn { axis, period, phase } => self.wave(*axis, *period, *phase),
            Factor::Spin { load, phase, .. } => {
                sine(Math::Product(vec![turn(), Math::Symbol("n".to_owned(), load.clone())]), *phase)
            }
            Factor::Curve { axis, .. } => Math::Function("f".to_owned(), self.position(*axis).into()),
            Factor::After { time } => Math::Since(*time),
        }
    }

    fn letter(&self, axis: usize) -> String {
        self.names.axes.get(axis).map_or_else(|| "?".to_owned(), |axis| axis.letter.clone())
    }

    fn of_axis(&self, symbol: &'static str, axis: usize) -> Math {
        Math::Symbol(symbol.to_owned(), self.letter(axis))
    }

    fn position(&self, axis: usize) -> Math {
        Math::Symbol(self.letter(axis).to_lowercase(), String::new())
    }

    fn speed(&self, axis: usize) -> String {
        self.names.axis_dimension(axis).per(Dimension::TIME).internal_unit()
    }

    fn sensor(&self, sensor: usize) -> String {
        self.sensors.iter().nth(sensor).map_or_else(|| "?".to_owned(), |sensor| sensor.name.value.clone())
    }

    fn temperature(&self, sensor: usize) -> Math {
        Math::Symbol("T".to_owned(), self.sensor(sensor))
    }

    fn warmer(&self, temperature: Math, reference: f64) -> Math {
        Math::Sum(vec![(false, temperature), (reference >= 0.0, quantity(reference.abs(), "degC"))])
    }

    fn wave(&self, axis: usize, period: f64, phase: f64) -> Math {
        let unit = self.names.axis_dimension(axis).internal_unit();
        let turns = Math::Quotient(self.position(axis).into(), quantity(period, &unit).into());
        sine(Math::Product(vec![turn(), turns]), phase)
    }
}

fn quantity(value: f64, unit: &str) -> Math {
    Math::Quantity(value, unit.to_owned())
}

fn time() -> Math {
    Math::Symbol("t".to_owned(), String::new())
}

/// 2 pi.
fn turn() -> Math {
    Math::Symbol("2 pi".to_owned(), String::new())
}

fn sine(argument: Math, phase: f64) -> Math {
    let argument = match phase {
        0.0 => argument,
        _ => Math::Sum(vec![(false, argument), (phase < 0.0, quantity(phase.abs(), "rad"))]),
    };
    Math::Function("sin".to_owned(), argument.into())
}

/// `exp(-of/over)`.
fn fading(of: Math, over: Math) -> Math {
    let gone = Math::Quotient(of.into(), over.into());
    Math::Function("exp".to_owned(), Math::Sum(vec![(true, gone)]).into())
}

fn held(state: Math, within: Within) -> Math {
    if within == Within::EVERYWHERE { state } else { Math::Held(state.into()) }
}

/// The sum of `c_k q^k`, k from `first`.
fn series(
    coefficients: &[f64],
    first: usize,
    input: &dyn Fn() -> Math,
    scale: Dimension,
    per: Dimension,
) -> Math {
    let part = |(number, value): (usize, &f64)| {
        let power = first + number;
        let under = per.power(i8::try_from(power).unwrap_or(i8::MAX));
        let mut factors = vec![Words::linear(value.abs(), scale, under)];
        match power {
            0 => {}
            1 => factors.push(input()),
            _ => factors.push(Math::Power(input().into(), power)),
        }
        (*value < 0.0, Math::Product(factors))
    };
    let told: Vec<(bool, Math)> =
        coefficients.iter().enumerate().filter(|(_, value)| **value != 0.0).map(part).collect();
    if told.is_empty() { quantity(0.0, "") } else { Math::Sum(told) }
}

#[cfg(test)]
mod tests;
