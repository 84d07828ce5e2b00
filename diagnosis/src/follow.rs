//! Following: how large effects are that are known to the machine, in recordings that may be too weak to find them.
//!
//! In: recordings, and effects that were found in any recording of the machine. Out: the size of each with a 95 % interval, whether or
//! not it would be claimed here. That a weak effect is not found says that it is below what the recording shows, and not that it is
//! zero: who compares what was found sees effects flicker, who compares sizes does not.
//!
//! What is not linear in an effect (a period, a time constant, a way over which a play is taken up) stays as it was found. All effects
//! are fitted together, with the settings of the instruments, to all rows: nothing is chosen, so that nothing need be held out.

use std::sync::Arc;

use model_dsl::calibration::{CalibratedTerm, TermKind};
use nalgebra::DMatrix;

use crate::Inputs;
use crate::appraisal::Appraisal;
use crate::candidates;
use crate::certainty::{Certainty, WIDTH_95};
use crate::course::Course;
use crate::course::courses;
use crate::design::{Design, Regressor};
use crate::diagnosis::{Estimate, Finding, ParameterValue};
use crate::fit;
use crate::model::{Effect, Fitted, Model, Place};
use crate::parameters::{Described, motion_unit};
use crate::side::Side;
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::{self, Shape};
use crate::travel::{self, Travel};
use crate::waves;
use crate::weights::{Outliers, Weights};

mod beside;
mod mixed;
mod wave;

use beside::Possible;
use mixed::Mixed;

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
    /// Of a wave, half the 95 % interval of its period or frequency as a share of that; 0 where it is exact.
    pub share: f64,
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

/// Why recordings say nothing about an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Untold {
    /// An axis does not move, or a sensor was not recorded.
    Absent,
    /// A wave does not come round once where something was read: a part of one is any curve.
    Part,
    /// The period of a wave is not known well enough for so many turns.
    Slips,
    /// Those before it explain it as well.
    Mixed,
    /// The recording does not tell how large its noise is where the effect shows.
    Short,
}

impl Untold {
    /// The reason as a clause.
    #[must_use]
    pub fn why(self) -> &'static str {
        match self {
            Self::Absent => "its axis does not move, or its sensor was not recorded",
            Self::Part => "it does not come round once",
            Self::Slips => "its period is not known well enough for so many turns",
            Self::Mixed => "other effects explain it as well",
            Self::Short => "the recording is too short to tell it from noise",
        }
    }
}

impl From<&Finding> for Followed {
    fn from(finding: &Finding) -> Self {
        let told_by = told_by(finding.term);
        let mut held = finding.parameters.iter().filter(|parameter| Some(parameter.name) == told_by);
        let share = held.find_map(|parameter| match &parameter.value {
            ParameterValue::Fitted(estimate) => {
                Some((estimate.ci95.1 - estimate.ci95.0) / 2.0 / estimate.value)
            }
            _ => None,
        });
        Self {
            motion: finding.motion_number,
            at_drive: finding.location.at_drive,
            inside_loop: finding.location.inside_loop,
            term: finding.calibrated.clone(),
            sensors: finding.sensors.clone(),
            share: share.unwrap_or_default(),
        }
    }
}

/// How often the fit and the noise that it leaves are worked out in turn: each follows from the other, and they settle at once.
const ROUNDS: usize = 3;

/// The share of a column's squared length that the others must leave: below, an interval would be more than four times as wide as that
/// of the effect alone, and the number would be that of a mixture.
const APART: f64 = 0.06;

/// The degrees of freedom that the variance of an estimate must have: its standard deviation is known within a factor of 1.6 then. With fewer
/// a recording does not tell how large its noise is there: of a turn or two of a wave, beside effects that take all that is as slow. By
/// simulated sessions 0.8 to 0.9 of such intervals hold the truth, however wide they are, and 0.95 of all others
/// (`short_sessions_have_intervals_that_hold_the_truth`).
const FEWEST_KNOWN: f64 = 2.0;

/// The scatter from block to block counts where it is so many times wider than the noise has it: of a dozen blocks chance gives more in one
/// of twenty cases, the end of chi-squared with eleven degrees of freedom (19.7 / 11) with what is added for Student's distribution.
const BY_CHANCE: f64 = 1.5;

/// The sizes of effects in the recordings of `inputs`, in the order of `followed`; or why these recordings say nothing about one. What is
/// not told from others is that which comes later: so the surest come first.
pub fn follow(inputs: &Inputs<'_>, followed: &[Followed]) -> Vec<Result<Vec<Size>, Untold>> {
    let study = Study::new(inputs.equations, inputs.calibration, &inputs.recordings).with_nothing_held_out();
    let settings = Model::of_settings(candidates::always(&study));
    let courses = courses(&study, &settings);
    let travels = travel::travels(&study, &courses);
    let read = read(&study, &courses);
    let begun: Vec<Result<Fitted, Untold>> =
        followed.iter().map(|one| begun(&study, (&travels, &read), one)).collect();
    let effects = settings.effects.iter().chain(begun.iter().flatten()).cloned();
    let sized = Sized::new(&study, settings.with_effects(effects));
    let mut numbers = settings.effects.len()..;
    let size = |begun: &Result<Fitted, Untold>| {
        begun.as_ref().map_err(|untold| *untold)?;
        numbers.next().ok_or(Untold::Absent).and_then(|number| sized.sizes(&study, number))
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

/// The effect as these recordings have it; or why they do not show it.
fn begun(
    study: &Study<'_>,
    (travels, read): (&[Travel], &[f64]),
    followed: &Followed,
) -> Result<Fitted, Untold> {
    let (effect, coefficients) = placed(study, travels, followed).ok_or(Untold::Absent)?;
    let turns = turns(study, read, &effect.shape);
    if turns.is_some_and(|turns| turns < 1.0) {
        return Err(Untold::Part);
    }
    if turns.is_some_and(|turns| followed.share * turns / 2.0 > SLIP) {
        return Err(Untold::Slips);
    }
    // What acts on the states is fitted from where it was found; all else from nothing.
    Ok(match effect.shape.nonlinear_in_coefficient() {
        true => Fitted { effect, coefficients },
        false => Fitted::unfitted(effect),
    })
}

/// The effect with the coefficients with which it was found; nothing where the recordings lack a state that it reads, or an axis that
/// moves.
fn placed(study: &Study<'_>, travels: &[Travel], followed: &Followed) -> Option<(Effect, Vec<f64>)> {
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
    let side = match axis.filter(|_| followed.inside_loop) {
        Some(axis) => Side::Loop { axis },
        None if followed.at_drive => Side::Drive,
        None => Side::After,
    };
    let place = Place::Motion { motion, side };
    Some((Effect { place, shape: about(shape, travels) }, coefficients))
}

/// How far apart each axis was in rows in which something was read.
fn read(study: &Study<'_>, courses: &[Arc<Course>]) -> Vec<f64> {
    let range = |axis: usize| {
        let positions = study.scenes.iter().zip(courses).flat_map(|(scene, course)| {
            let is_read = |row: &usize| scene.channels.iter().any(|channel| channel.values[*row].is_finite());
            let positions = &course.shown.axes[axis].position;
            (0..scene.rows())
                .filter(is_read)
                .map(|row| positions[row])
                .filter(|position| position.is_finite())
        });
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = positions.fold(ends, |(low, high), place| (low.min(place), high.max(place)));
        high - low
    };
    (0..study.equations.axes.len()).map(range).collect()
}

/// How often a wave comes round where something was read. A part of a turn is any curve.
fn turns(study: &Study<'_>, read: &[f64], shape: &Shape) -> Option<f64> {
    match *shape.core() {
        Shape::Vibration { frequency } => Some(waves::observed(study) * frequency),
        ref along => along.wave_along().and_then(|(axis, period)| Some(read.get(axis)? / period)),
    }
}

/// By which part of a turn a wave may be off at either end of a recording, at the end of the interval of its period, for it to be followed.
/// One that slips so far from the middle to both ends comes out too small by 10 %: the mean cosine of up to 45 deg.
const SLIP: f64 = 0.125;

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
        Shape::Cyclic { axis, period, order, .. } => {
            Shape::Cyclic { axis, period, order, center: middle(axis).0 }
        }
        other => other,
    }
}

/// A model whose sizes were fitted.
struct Sized {
    model: Model,
    design: Design,
    /// The covariance of all coefficients.
    covariance: DMatrix<f64>,
    /// Whether a column was told from those before it, and whether its noise is known too.
    told: Vec<bool>,
    known: Vec<bool>,
}

impl Sized {
    fn new(study: &Study<'_>, model: Model) -> Self {
        let (model, told, weights) = settled(study, model);
        let regressors = Regressor::all(&model.effects);
        let possible = |at| beside::possible(study, at, (&model, &weights), (&regressors, &told));
        let noises: Vec<Vec<Possible>> = study.channels().map(possible).collect();
        let design = Design::new(study, &model, &likeliest(study, &weights, &noises), regressors);
        let (swept, scale) = least_squares(&design, &told);
        let mixed = Mixed::new(&noises, design.width);
        let model = stepped(&model, &design, &told, &mixed.coefficients);
        let widths = fit::widths(&design, &swept, scale);
        let wider = |column: usize| if widths[column] > BY_CHANCE { widths[column] } else { 1.0 };
        let covariance = DMatrix::from_fn(design.width, design.width, |row, column| {
            mixed.covariance[(row, column)] * wider(row) * wider(column)
        });
        let known = told.iter().zip(&mixed.freedoms);
        let known = known.map(|(told, freedom)| *told && *freedom >= FEWEST_KNOWN).collect();
        Self { model, design, covariance, told, known }
    }

    /// The sizes of an effect, or why it has none. The power 0 of a polynomial is free where a zero is; of a table each value is told for
    /// itself.
    fn sizes(&self, study: &Study<'_>, number: usize) -> Result<Vec<Size>, Untold> {
        let fitted = self.model.effects.get(number).ok_or(Untold::Absent)?;
        let shape = fitted.effect.shape.core();
        let free = usize::from(matches!(shape, Shape::Polynomial { .. } | Shape::SensorPolynomial { .. }));
        let columns = match shape {
            Shape::Table { .. } => 0..0,
            _ => self.design.columns(number),
        };
        let mut needed = columns.skip(free);
        if needed.clone().any(|column| !self.told[column]) {
            return Err(Untold::Mixed);
        }
        if needed.any(|column| !self.known[column]) {
            return Err(Untold::Short);
        }
        let sizes = match shape {
            shape if shape.is_wave() => self.of_wave(study, fitted, number),
            Shape::Lag { .. } => vec![self.of_gain(fitted, number, "s")],
            Shape::Acceleration { .. } => vec![self.of_gain(fitted, number, "s^2")],
            _ => self.of_parameters(study, fitted, number),
        };
        if sizes.is_empty() { Err(Untold::Mixed) } else { Ok(sizes) }
    }

    fn of_wave(&self, study: &Study<'_>, fitted: &Fitted, number: usize) -> Vec<Size> {
        let Some(motion) = fitted.effect.motion() else { return Vec::new() };
        let unit = motion_unit(study, motion);
        let estimate = wave::amplitude(&fitted.coefficients, &self.covariance(number), unit);
        estimate.map(|estimate| Size { name: "amplitude".to_owned(), estimate }).into_iter().collect()
    }

    fn of_gain(&self, fitted: &Fitted, number: usize, unit: &str) -> Size {
        let half = WIDTH_95 * self.covariance(number)[(0, 0)].max(0.0).sqrt();
        let value = fitted.coefficients.first().copied().unwrap_or_default();
        let estimate = Estimate { value, ci95: (value - half, value + half), unit: unit.to_owned() };
        Size { name: "1/gain".to_owned(), estimate }
    }

    fn of_parameters(&self, study: &Study<'_>, fitted: &Fitted, number: usize) -> Vec<Size> {
        let shape = fitted.effect.shape.core();
        let Some(kind) = TermKind::of_name(shape.name()) else { return Vec::new() };
        let certainty = Certainty::linear(self.covariance(number));
        let held = fitted.effect.shape.nonlinear().map(|parameter| parameter.name);
        let parameters = Described::new(study, fitted, &certainty).parameters();
        let fitted = parameters.iter().filter(|parameter| Some(parameter.name) != held);
        let sizes = fitted
            .flat_map(|parameter| parameter.estimates(kind))
            .map(|(name, estimate)| Size { name, estimate });
        // What no interval was found for was not told: a node that no row comes near, the free power of a polynomial.
        let (partly, first) = (matches!(shape, Shape::Table { .. }), self.design.columns(number).start);
        let of_node = |place: usize| !partly || self.known.get(first + place) == Some(&true);
        let known = |size: &Size| size.estimate.ci95.0 < size.estimate.ci95.1;
        let told = sizes.enumerate().filter(|(place, size)| of_node(*place) && known(size));
        told.map(|(_, size)| size).collect()
    }

    /// The covariance of the coefficients of an effect; a last row of nothing for a parameter that is held.
    fn covariance(&self, number: usize) -> DMatrix<f64> {
        let columns: Vec<usize> = self.design.columns(number).collect();
        let held = usize::from(
            self.model.effects.get(number).is_some_and(|fitted| fitted.effect.shape.nonlinear().is_some()),
        );
        let size = columns.len() + held;
        DMatrix::from_fn(size, size, |row, column| match (columns.get(row), columns.get(column)) {
            (Some(row), Some(column)) => self.covariance[(*row, *column)],
            _ => 0.0,
        })
    }
}

/// A model brought to where a fit of it stays: with loops, which act on the states, as they are fitted; whether each column is told from
/// those before it; and the weights that it leaves, without outliers.
fn settled(study: &Study<'_>, mut model: Model) -> (Model, Vec<bool>, Weights) {
    // Where nothing is fitted yet, every sample counts.
    let first = Appraisal::new(study, &model).weights.as_white();
    let mut weights = Weights::of_all(study, first.noises);
    let mut told = Vec::new();
    for _ in 0..ROUNDS {
        let design = Design::new(study, &model, &weights, Regressor::all(&model.effects));
        told = apart(&design);
        let (swept, _) = least_squares(&design, &told);
        let change: Vec<f64> = (0..design.width).map(|column| swept.coefficient(column)).collect();
        model = stepped(&model, &design, &told, &change);
        weights = Appraisal::new(study, &model).weights;
    }
    (model, told, weights)
}

/// The weights of the likeliest noises. Of a channel that tells no noise no sample counts.
fn likeliest(study: &Study<'_>, weights: &Weights, noises: &[Vec<Possible>]) -> Weights {
    let mut marks: Vec<Vec<Vec<bool>>> = vec![Vec::new(); study.scenes.len()];
    let mut likeliest = weights.noises.clone();
    for (at, possible) in study.channels().zip(noises) {
        let known = possible.first();
        let outliers = weights.outliers.of(at);
        marks[at.scene].push(outliers.iter().map(|outlier| *outlier || known.is_none()).collect());
        if let Some(possible) = known {
            likeliest[at.scene][at.channel] = possible.noise;
        }
    }
    Weights { noises: likeliest, outliers: Outliers::new(marks) }
}

/// Whether each column of a design is told from those before it.
fn apart(design: &Design) -> Vec<bool> {
    let mut swept = Swept::new(&design.fitted().0);
    (0..design.width).map(|column| swept.independence(column) > APART && swept.take(column)).collect()
}

/// The least squares of the columns that are told, and the variance of what is left.
fn least_squares(design: &Design, told: &[bool]) -> (Swept, f64) {
    let (products, samples) = design.fitted();
    let mut swept = Swept::new(&products);
    let taken = (0..design.width).filter(|column| told[*column] && swept.take(*column)).count();
    // Of a short recording each column takes a sample's worth of the noise with it.
    let scale = swept.remaining() / (samples - crate::number(taken)).max(1.0);
    (swept, scale)
}

/// A model with its coefficients changed; those that are not told are nothing.
fn stepped(model: &Model, design: &Design, told: &[bool], change: &[f64]) -> Model {
    let moved = |(number, fitted): (usize, &Fitted)| {
        let columns = design.columns(number).zip(&fitted.coefficients);
        let moved = |(column, known): (usize, &f64)| match told.get(column).zip(change.get(column)) {
            Some((true, change)) => known + change,
            _ => 0.0,
        };
        Fitted { effect: fitted.effect.clone(), coefficients: columns.map(moved).collect() }
    };
    model.with_effects(model.effects.iter().enumerate().map(moved))
}

#[cfg(test)]
mod sessions;
#[cfg(test)]
mod tests;
