//! Following: how large effects are that are known to the machine, in recordings that may be too weak to find them.
//!
//! In: recordings, and effects that were found in any recording of the machine. Out: the size of each with a 95 % interval, whether or
//! not it would be claimed here. That a weak effect is not found says that it is below what the recording shows, and not that it is
//! zero: who compares what was found sees effects flicker, who compares sizes does not.
//!
//! What is not linear in an effect (a period, a time constant, a way over which a play is taken up) stays as it was found. All effects
//! are fitted together, with the settings of the instruments, to all rows: nothing is chosen, so that nothing need be held out.

use model_dsl::calibration::{CalibratedTerm, TermKind};
use nalgebra::DMatrix;

use crate::Inputs;
use crate::appraisal::Appraisal;
use crate::candidates;
use crate::certainty::{Certainty, WIDTH_95};
use crate::design::{Design, Regressor};
use crate::diagnosis::{Estimate, Finding};
use crate::engine;
use crate::fit;
use crate::model::{Effect, Fitted, Model, Place};
use crate::parameters::{Described, motion_unit};
use crate::side::Side;
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::{self, Shape};
use crate::travel::{self, Travel};
use crate::waves;
use crate::weights::Weights;

mod wave;

/// An effect that is followed.
#[derive(Clone, Debug, PartialEq)]
pub struct Followed {
    /// The error motion's number in the equations.
    pub motion: usize,
    /// Whether the drive's own feedback shows it.
    pub at_drive: bool,
    /// Whether the position loop of the motion's axis answers it.
    pub inside_loop: bool,
    /// The term, in mm, rad, s and degC; its sizes do not matter, what is not linear in it does.
    pub term: CalibratedTerm,
    /// The sensors that it and its factors read: their numbers in the term, and their names.
    pub sensors: Vec<(usize, String)>,
}

/// The size of an effect in recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct Size {
    /// What is sized, named as in calibration files: `lost_motion`, `amplitude`, `coefficients[1]`. Of a term whose number is a gain it is
    /// `1/gain`, in which the error is linear.
    pub name: String,
    /// The value with its interval.
    pub estimate: Estimate,
}

impl From<&Finding> for Followed {
    fn from(finding: &Finding) -> Self {
        Self {
            motion: finding.motion_number,
            at_drive: finding.location.at_drive,
            inside_loop: finding.location.inside_loop,
            term: finding.calibrated.clone(),
            sensors: finding.sensors.clone(),
        }
    }
}

/// How often the fit and the noise that it leaves are worked out in turn: each follows from the other, and they settle at once.
const ROUNDS: usize = 4;

/// The share of a column's squared length that the others must leave: below, an interval would be more than four times as wide as that
/// of the effect alone, and the number would be that of a mixture.
const APART: f64 = 0.06;

/// The sizes of effects in the recordings of `inputs`, in the order of `followed`: nothing of an effect that these recordings do not show,
/// or do not tell from those before it. So the surest come first.
pub fn follow(inputs: &Inputs<'_>, followed: &[Followed]) -> Vec<Vec<Size>> {
    let study = Study::new(inputs.equations, inputs.calibration, &inputs.recordings).with_nothing_held_out();
    let settings = Model::of_settings(candidates::always(&study));
    let travels = travel::travels(&study, &engine::courses(&study, &settings));
    let begun: Vec<Option<Fitted>> = followed.iter().map(|one| begun(&study, &travels, one)).collect();
    let effects = settings.effects.iter().chain(begun.iter().flatten()).cloned();
    let model = settings.with_effects(effects);
    let sized = Sized::new(&study, model);
    let mut numbers = settings.effects.len()..;
    let size = |begun: &Option<Fitted>| match begun {
        Some(_) => numbers.next().map(|number| sized.sizes(&study, number)).unwrap_or_default(),
        None => Vec::new(),
    };
    begun.iter().map(size).collect()
}

/// The parameter by which two effects of one term are told apart: the period of a wave along an axis, the frequency of one in time.
pub fn told_by(term: &str) -> Option<&'static str> {
    match TermKind::of_name(term)? {
        TermKind::Cyclic => Some("period"),
        TermKind::Vibration => Some("frequency"),
        _ => None,
    }
}

/// Whether a term happened once: when it did says nothing of another recording, so that it is not followed.
pub fn is_event(term: &str) -> bool {
    TermKind::of_name(term) == Some(TermKind::Step)
}

/// The effect as these recordings have it; nothing where they lack a state that it reads, or an axis that moves.
fn begun(study: &Study<'_>, travels: &[Travel], followed: &Followed) -> Option<Fitted> {
    if is_event(followed.term.core().name()) {
        return None;
    }
    let term = renumbered(study, followed)?;
    let load = |name: &str| study.loads.iter().position(|(known, _)| known == name);
    let (shape, coefficients) = terms::known(&term, &load)?;
    let motion = Some(followed.motion).filter(|motion| *motion < study.equations.motions.len())?;
    let axis = study.own.iter().position(|own| *own == Some(motion));
    if shape.axis().is_some_and(|axis| travels.get(axis).is_none_or(|travel| !travel.moves)) {
        return None;
    }
    if !comes_round(study, travels, &shape) {
        return None;
    }
    let side = match axis.filter(|_| followed.inside_loop) {
        Some(axis) => Side::Loop { axis },
        None if followed.at_drive => Side::Drive,
        None => Side::After,
    };
    let shape = about(shape, travels);
    let effect = Effect { place: Place::Motion { motion, side }, shape };
    // What acts on the states is fitted from where it was found; all else from nothing.
    Some(match effect.shape.nonlinear_in_coefficient() {
        true => Fitted { effect, coefficients },
        false => Fitted::unfitted(effect),
    })
}

/// Whether a wave comes round once at least: a part of one is any curve.
fn comes_round(study: &Study<'_>, travels: &[Travel], shape: &Shape) -> bool {
    match *shape.core() {
        Shape::Cyclic { axis, period, .. } => {
            travels.get(axis).is_some_and(|travel| travel.range() >= period)
        }
        Shape::Vibration { frequency } => waves::observed(study) * frequency >= 1.0,
        _ => true,
    }
}

/// The term with its sensors under their numbers in the study.
fn renumbered(study: &Study<'_>, followed: &Followed) -> Option<CalibratedTerm> {
    let recorded = candidates::recorded(study);
    let number = |sensor: usize| {
        let (_, name) = followed.sensors.iter().find(|(known, _)| *known == sensor)?;
        study.sensors.iter().position(|known| known == name).filter(|number| recorded.contains(number))
    };
    if followed.term.sensors().any(|sensor| number(sensor).is_none()) {
        return None;
    }
    let mut term = followed.term.clone();
    if let Some(sensor) = term.sensor().and_then(number) {
        term = term.with_sensor(sensor);
    }
    Some(term.with_factors(|factor| match factor.sensor().and_then(number) {
        Some(sensor) => factor.with_sensor(sensor),
        None => factor,
    }))
}

/// A shape about the middle of the travel, where its powers are told apart best.
fn about(shape: Shape, travels: &[Travel]) -> Shape {
    let middle =
        |axis: usize| travels.get(axis).map_or((0.0, 1.0), |travel| (travel.center(), travel.range() / 2.0));
    match shape {
        Shape::Polynomial { axis, degree, .. } => {
            let (center, scale) = middle(axis);
            Shape::Polynomial { axis, degree, center, scale }
        }
        Shape::Cyclic { axis, period, .. } => Shape::Cyclic { axis, period, center: middle(axis).0 },
        other => other,
    }
}

/// A model whose sizes were fitted.
struct Sized {
    model: Model,
    design: Design,
    swept: Swept,
    /// The variance of the noise, in that by which rows are weighted.
    scale: f64,
    /// For each column how many times wider its interval is than the likelihood has it.
    widths: Vec<f64>,
    /// Whether a column was told from those before it.
    told: Vec<bool>,
}

impl Sized {
    fn new(study: &Study<'_>, mut model: Model) -> Self {
        // Where nothing is fitted yet, every sample counts.
        let first = Appraisal::new(study, &model).weights.as_white();
        let mut weights = Weights::of_all(study, first.noises);
        for _ in 1..ROUNDS {
            model = Self::once(study, model, &weights).stepped();
            weights = Appraisal::new(study, &model).weights;
        }
        let last = Self::once(study, model, &weights);
        Self { model: last.stepped(), ..last }
    }

    /// One linear fit, from where the model stands.
    fn once(study: &Study<'_>, model: Model, weights: &Weights) -> Self {
        let regressors = Regressor::all(&model.effects);
        let design = Design::new(study, &model, weights, regressors);
        let (products, samples) = design.fitted();
        let mut swept = Swept::new(&products);
        let take = |column: usize| swept.independence(column) > APART && swept.take(column);
        let told: Vec<bool> = (0..design.width).map(take).collect();
        let columns = told.iter().filter(|told| **told).count();
        // Of a short recording each column takes a sample's worth of the noise with it.
        let scale = swept.remaining() / (samples - crate::number(columns)).max(1.0);
        let widths = fit::widths(&design, &swept, scale);
        Self { model, design, swept, scale, widths, told }
    }

    /// The model with its coefficients moved to the least squares; those that are not told are nothing.
    fn stepped(&self) -> Model {
        let moved = |(number, fitted): (usize, &Fitted)| {
            let columns = self.design.columns(number).zip(&fitted.coefficients);
            let change = |(column, known): (usize, &f64)| match self.told.get(column) {
                Some(true) => known + self.swept.coefficient(column),
                _ => 0.0,
            };
            Fitted { effect: fitted.effect.clone(), coefficients: columns.map(change).collect() }
        };
        self.model.with_effects(self.model.effects.iter().enumerate().map(moved))
    }

    /// The sizes of an effect; none where one of its columns is not told. The power 0 of a polynomial is free where a zero is.
    fn sizes(&self, study: &Study<'_>, number: usize) -> Vec<Size> {
        let Some(fitted) = self.model.effects.get(number) else { return Vec::new() };
        let shape = fitted.effect.shape.core();
        let Some(kind) = TermKind::of_name(shape.name()) else { return Vec::new() };
        let free = usize::from(matches!(shape, Shape::Polynomial { .. } | Shape::SensorPolynomial { .. }));
        let columns = self.design.columns(number);
        let untold = |column: usize| self.told.get(column) != Some(&true);
        let (partly, first) = (matches!(shape, Shape::Table { .. }), columns.start);
        if !partly && columns.clone().skip(free).any(untold) {
            return Vec::new();
        }
        let covariance = self.covariance(number);
        if shape.is_wave() {
            let Some(motion) = fitted.effect.motion() else { return Vec::new() };
            let estimate = wave::amplitude(&fitted.coefficients, &covariance, motion_unit(study, motion));
            return estimate
                .map(|estimate| Size { name: "amplitude".to_owned(), estimate })
                .into_iter()
                .collect();
        }
        if let Shape::Lag { .. } | Shape::Acceleration { .. } = shape {
            let half = WIDTH_95 * covariance[(0, 0)].max(0.0).sqrt();
            let value = fitted.coefficients.first().copied().unwrap_or_default();
            let unit = if matches!(shape, Shape::Lag { .. }) { "s" } else { "s^2" };
            let estimate = Estimate { value, ci95: (value - half, value + half), unit: unit.to_owned() };
            return vec![Size { name: "1/gain".to_owned(), estimate }];
        }
        let certainty = Certainty::linear(covariance);
        let held = fitted.effect.shape.nonlinear().map(|parameter| parameter.name);
        let parameters = Described::new(study, fitted, &certainty).parameters();
        let fitted = parameters.iter().filter(|parameter| Some(parameter.name) != held);
        let sizes = fitted
            .flat_map(|parameter| parameter.estimates(kind))
            .map(|(name, estimate)| Size { name, estimate });
        // What no interval was found for was not told: a node that no row comes near, the free power of a polynomial.
        let of_node = |place: usize| !partly || !untold(first + place);
        let known = |size: &Size| size.estimate.ci95.0 < size.estimate.ci95.1;
        sizes
            .enumerate()
            .filter(|(place, size)| of_node(*place) && known(size))
            .map(|(_, size)| size)
            .collect()
    }

    /// The covariance of the coefficients of an effect; a last row of nothing for a parameter that is held.
    fn covariance(&self, number: usize) -> DMatrix<f64> {
        let columns: Vec<usize> = self.design.columns(number).collect();
        let held = usize::from(
            self.model.effects.get(number).is_some_and(|fitted| fitted.effect.shape.nonlinear().is_some()),
        );
        let size = columns.len() + held;
        DMatrix::from_fn(size, size, |row, column| match (columns.get(row), columns.get(column)) {
            (Some(row), Some(column)) => {
                self.scale * self.widths[*row] * self.widths[*column] * self.swept.covariance(*row, *column)
            }
            _ => 0.0,
        })
    }
}

#[cfg(test)]
mod tests;
