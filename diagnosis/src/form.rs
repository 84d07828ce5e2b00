//! Forms in words: composed findings.
//!
//! In: a term with factors, or an event, with its numbers. Out: its equation, a sentence of its size, and which physics has that form.
//! A form is not a cause: the vocabulary alone has names of causes.

use model_dsl::calibration::{CalibratedTerm, Factor, Sensors, TermKind, Within};

use crate::alternatives::{factor_state, listed};
use crate::diagnosis::Form;
use crate::legs;
use crate::model::{Effect, Model};
use crate::report::figure::significant;
use crate::study::Study;
use crate::terms::Shape;
use crate::words::seconds;

/// The form of an effect of a model; `None` where its term has a name.
pub(crate) fn form(
    study: &Study<'_>,
    model: &Model,
    effect: &Effect,
    calibrated: &CalibratedTerm,
) -> Option<Form> {
    let motion = effect.motion().filter(|_| effect.shape.is_composed())?;
    let words = Words { study, motion, plain: plain(model, effect) };
    let sentence = match calibrated {
        CalibratedTerm::Step { time, size } => {
            format!("A step of {} {}.", words.amount(*size), when(study, *time))
        }
        _ => words.sentence(effect, calibrated),
    };
    let physics = calibrated.factors().iter().map(|factor| factor.kind().entry().physics);
    let names = study.equations.names();
    let sensors = Sensors::named(study.sensors.iter().map(String::as_str));
    let equation = notation::formula(calibrated, motion, &names, &sensors);
    Some(Form { equation, words: sentence, physics: physics.collect() })
}

/// When something happened: between which rows, where these lie apart.
fn when(study: &Study<'_>, time: f64) -> String {
    let Some(scene) = study.scenes.first() else { return format!("at {}", seconds(time)) };
    let times = &scene.given.time;
    let after = times.partition_point(|known| *known < time);
    match after.checked_sub(1).and_then(|before| times.get(before).zip(times.get(after))) {
        Some((before, after)) if after - before > legs::GAP * scene.given.step => {
            format!("between {} and {}", seconds(*before), seconds(*after))
        }
        _ => format!("at {}", seconds(time)),
    }
}

/// The linear number of the same term without factors beside it, which adds up with it.
fn plain(model: &Model, effect: &Effect) -> f64 {
    let same = model
        .effects
        .iter()
        .filter(|other| other.effect.place == effect.place && other.effect.shape == *effect.shape.core());
    // A constant beside a product is a zero.
    let same = same.filter(|other| other.effect.shape != Shape::Constant);
    same.filter_map(|other| other.coefficients.first()).sum()
}

/// What a sentence is written with.
struct Words<'w> {
    study: &'w Study<'w>,
    motion: usize,
    plain: f64,
}

impl Words<'_> {
    fn sentence(&self, effect: &Effect, term: &CalibratedTerm) -> String {
        let known = &self.study.equations.motions[self.motion];
        let of = match effect.shape.axis() {
            Some(axis) => format!("{} of {}", noun(term.core().kind()), self.letter(axis)),
            None => format!("part of the {}", known.meaning),
        };
        match (self.linear(term), term.factors()) {
            (Some(number), [factor]) => format!("A {of} {}.", self.follows(number, factor)),
            (_, factors) => {
                let states: Vec<String> = factors.iter().map(|factor| self.state(factor)).collect();
                format!("A {of} in proportion to the product of {}{}.", listed(&states), self.most(term))
            }
        }
    }

    /// The number that says how large a term is, where that is one.
    fn linear(&self, term: &CalibratedTerm) -> Option<f64> {
        let mut core = term.core().clone();
        match core.linear_mut().as_slice() {
            [(_, [number])] => Some(*number),
            _ => None,
        }
    }

    /// How a size follows a factor.
    fn follows(&self, number: f64, factor: &Factor) -> String {
        let at = |value: f64| self.amount(self.plain + number * value);
        let between = |within: Within, from: f64, to: f64, unit: &str| {
            let (low, high) = (self.plain + number * from, self.plain + number * to);
            let verb = if low.abs() <= high.abs() { "grows" } else { "shrinks" };
            format!(
                "that {verb} from {} at {} {unit} to {} at {} {unit} of {}",
                self.amount(low),
                plainly(within.from),
                self.amount(high),
                plainly(within.to),
                self.state(factor)
            )
        };
        let unit = |axis: usize| if self.study.equations.axes[axis].rotary { "rad" } else { "mm" };
        match *factor {
            Factor::Position { axis, power, within } if within != Within::EVERYWHERE => {
                let raised = |position: f64| position.powi(i32::from(power));
                between(within, raised(within.from), raised(within.to), unit(axis))
            }
            Factor::Velocity { axis, within } | Factor::Speed { axis, within }
                if within != Within::EVERYWHERE =>
            {
                between(within, within.from, within.to, &format!("{}/s", unit(axis)))
            }
            Factor::Acceleration { axis, within } if within != Within::EVERYWHERE => {
                between(within, within.from, within.to, &format!("{}/s^2", unit(axis)))
            }
            Factor::Temperature { reference, within, .. } if within != Within::EVERYWHERE => {
                between(within, within.from - reference, within.to - reference, "degC")
            }
            Factor::Load { within, .. } if within != Within::EVERYWHERE => {
                between(within, within.from, within.to, "units")
            }
            Factor::Fading { axis, over } => format!(
                "that is {} at rest and fades with {}: a third of {} remains at {over:.3} {}/s",
                at(1.0),
                self.state(factor),
                self.amount(number),
                unit(axis)
            ),
            Factor::Warmth { axis, time_constant, .. } => format!(
                "that grows as the motion of {} warms it, within {}",
                self.letter(axis),
                seconds(3.0 * time_constant)
            ),
            Factor::Spin { ref load, rate, .. } => format!(
                "that oscillates by {}, {} times per second for each unit of {load}",
                self.amount(number.abs()),
                significant(rate, 4)
            ),
            Factor::Half { at: half, .. } => {
                format!(
                    "that is {} without a load, of which half remains at {half:.3} units of {}",
                    at(1.0),
                    self.state(factor)
                )
            }
            Factor::Curve { axis, at: ref nodes, .. } => {
                let ends = nodes.first().zip(nodes.last()).map_or((0.0, 0.0), |(from, to)| (*from, *to));
                let [from, middle, to] = [ends.0, 0.5 * (ends.0 + ends.1), ends.1].map(plainly);
                let (most, unit) = (at(1.0), unit(axis));
                format!(
                    "that is {most} at {middle} {unit} of {} and fades to both sides, to {} at {from} and at {to} {unit}",
                    self.state(factor),
                    at(0.0)
                )
            }
            _ => format!("that follows {}", self.state(factor)),
        }
    }

    /// How large a product becomes where each factor has its largest value.
    fn most(&self, term: &CalibratedTerm) -> String {
        let Some(number) = self.linear(term) else { return String::new() };
        let largest = |factor: &Factor| match *factor {
            Factor::Position { power, within, .. } => Some(size(within)?.powi(i32::from(power))),
            Factor::Velocity { within, .. }
            | Factor::Speed { within, .. }
            | Factor::Acceleration { within, .. }
            | Factor::Load { within, .. } => size(within),
            Factor::Temperature { reference, within, .. } => {
                size(Within { from: within.from - reference, to: within.to - reference })
            }
            _ => None,
        };
        let product: Option<f64> = term.factors().iter().map(largest).product();
        product.map_or_else(String::new, |product| {
            format!(": {} where each of them is largest", self.amount((number * product).abs()))
        })
    }

    /// A size of the error motion.
    fn amount(&self, value: f64) -> String {
        let unit = if self.study.equations.motions[self.motion].angular { "urad" } else { "um" };
        let value = 1e3 * if unit == "urad" { 1e3 * value } else { value };
        let digits = if value.abs() < 1.0 {
            2
        } else if value.abs() < 100.0 {
            1
        } else {
            0
        };
        format!("{value:.digits$} {unit}")
    }

    fn letter(&self, axis: usize) -> &str {
        &self.study.equations.axes[axis].letter
    }

    fn state(&self, factor: &Factor) -> String {
        let number = |name: String| self.study.loads.iter().position(|(known, _)| *known == name);
        factor.clone().with_load(number).map_or_else(String::new, |factor| factor_state(self.study, &factor))
    }
}

/// What a term is called in a sentence.
fn noun(term: TermKind) -> String {
    match term {
        TermKind::Cyclic => "wave".to_owned(),
        TermKind::Polynomial | TermKind::Table => "curve".to_owned(),
        other => other.name().replace('-', " "),
    }
}

/// A number with three decimals at most.
fn plainly(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The greatest size within a range.
fn size(within: Within) -> Option<f64> {
    let size = within.from.abs().max(within.to.abs());
    size.is_finite().then_some(size)
}
