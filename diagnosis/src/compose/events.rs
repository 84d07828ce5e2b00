//! Events: what happened once, in several error motions at the same moment.
//!
//! In: a study that was searched. Out: the moments at which steps of all motions together explain most, and models with those steps that
//! are worth their price. A crash moves more than one thing, and each step alone leaves the others to the noise: so the steps of one
//! moment are chosen together, beside what was found. The moment is looked for in all rows, since what is held out may be when it was.

use nalgebra::DMatrix;

use crate::audit::spread;
use crate::design::{Design, Regressor};
use crate::engine::Found;
use crate::fit;
use crate::model::{Effect, Model, Place};
use crate::parallel;
use crate::ranges::Resolution;
use crate::search::Choice;
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;

use super::forms;

/// How many moments get a choice of their own: the best one, and the best one elsewhere.
const MOMENTS: usize = 2;

/// How often a moment is looked for anew around the best one, each time in a tenth of the distance before: a thousandth of the recording,
/// and less, as far as rows tell.
const DATINGS: i32 = 3;

/// How many times are tried to each side of the best one.
const BESIDE: i32 = 10;

/// A model in which something happened at a moment.
pub(super) struct Event {
    pub(super) model: Model,
    /// How many steps it holds.
    pub(super) steps: usize,
}

/// How many steps compete.
pub(super) fn count(study: &Study<'_>) -> usize {
    forms::places(study).len() * forms::moments(study).len()
}

/// Models with steps at the moments that explain most, the best one first; none without a step.
pub(super) fn events(study: &Study<'_>, found: &Found) -> Vec<Event> {
    let places = forms::places(study);
    let grid = forms::moments(study);
    if grid.is_empty() || places.is_empty() {
        return Vec::new();
    }
    let mut best: Vec<f64> = Vec::new();
    for (time, _) in ranked(study, found, &places, &grid) {
        let near = |known: &f64| (known - time).abs() < 2.5 * forms::distance(study);
        if best.len() < MOMENTS && !best.iter().any(near) {
            best.push(time);
        }
    }
    best.into_iter()
        .map(|time| chosen(study, found, dated(study, found, &places, time), &places))
        .filter(|event| event.steps > 0)
        .collect()
}

/// The time around a moment at which steps explain most.
fn dated(study: &Study<'_>, found: &Found, places: &[Place], mut time: f64) -> f64 {
    for finer in 1..=DATINGS {
        let step = forms::distance(study) * 0.1_f64.powi(finer);
        let times: Vec<f64> = (-BESIDE..=BESIDE).map(|number| time + f64::from(number) * step).collect();
        let ranked = ranked(study, found, places, &times);
        let Some((_, most)) = ranked.first().copied() else { break };
        // Between two rows all times are one: the middle of them is told.
        let alike: Vec<f64> = ranked
            .into_iter()
            .filter(|(_, explained)| most - explained <= 1e-9 * most)
            .map(|(time, _)| time)
            .collect();
        time = alike.iter().sum::<f64>() / crate::number(alike.len());
    }
    time
}

/// Times with the sum of squares that steps in all places explain together there, beside the settings alone; the most first.
fn ranked(study: &Study<'_>, found: &Found, places: &[Place], times: &[f64]) -> Vec<(f64, f64)> {
    let model = &found.fit.model;
    let step =
        |time: f64, place: &Place| Regressor::of(Effect { place: *place, shape: Shape::Step { time } });
    let known = model.iter().map(|fitted| Regressor::of(fitted.effect.clone()));
    let steps = times.iter().flat_map(|time| places.iter().map(move |place| step(*time, place)));
    let regressors: Vec<Regressor> = known.chain(steps).collect();
    let columns_of = |effects: &[Regressor]| effects.iter().map(Regressor::columns).sum::<usize>();
    let (whole, always) = (columns_of(&regressors[..model.len()]), columns_of(&regressors[..found.always]));
    let size = always + places.len() + 1;
    let mut products = vec![DMatrix::<f64>::zeros(size, size); times.len()];
    for (scene, known) in study.scenes.iter().enumerate() {
        let rows = spread(known.rows());
        for channel in 0..known.channels.len() {
            let matrix = Design::columns_in(study, (scene, channel), model, &regressors, &rows);
            let response = restored(study, found, &matrix, (scene, channel), &rows);
            let weight = 1.0 / found.appraisal.noises[scene][channel].size();
            let of_time = |number: usize| {
                let first = whole + number * places.len();
                let settings = (0..always).map(|column| matrix.column(column).into_owned());
                let steps = (first..first + places.len()).map(|column| matrix.column(column).into_owned());
                let mut columns: Vec<_> = settings.chain(steps).chain([response.clone()]).collect();
                for column in &mut columns {
                    *column *= weight;
                    column.iter_mut().zip(response.iter()).for_each(|(value, known)| {
                        *value = if known.is_finite() && value.is_finite() { *value } else { 0.0 };
                    });
                }
                let together = DMatrix::from_columns(&columns);
                together.tr_mul(&together)
            };
            let parts = parallel::counted(times.len(), times.len() * rows.len() * size, of_time);
            products.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
        }
    }
    let explained = |products: &DMatrix<f64>| {
        let mut swept = Swept::new(products);
        for column in 0..always {
            swept.take(column);
        }
        swept.promise(&(always..size - 1).collect::<Vec<_>>()).0
    };
    let mut ranked: Vec<(f64, f64)> = times.iter().copied().zip(products.iter().map(explained)).collect();
    ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
    ranked
}

/// What the settings and the steps have to explain: the residual, with what the model takes from it; NaN in rows that do not count.
fn restored(
    study: &Study<'_>,
    found: &Found,
    matrix: &DMatrix<f64>,
    (scene, channel): (usize, usize),
    rows: &[usize],
) -> nalgebra::DVector<f64> {
    let mut response = matrix.column(matrix.ncols() - 1).into_owned();
    let coefficients = found.fit.model.iter().flat_map(|fitted| &fitted.coefficients);
    for (column, coefficient) in coefficients.enumerate() {
        response += matrix.column(column) * *coefficient;
    }
    let outliers = &study.scenes[scene].channels[channel].outliers;
    response.iter_mut().zip(rows).filter(|(_, row)| outliers[**row]).for_each(|(value, _)| *value = f64::NAN);
    response
}

/// The best set of what was found and of steps at a moment, by linear least squares.
fn chosen(study: &Study<'_>, found: &Found, time: f64, places: &[Place]) -> Event {
    let mut effects: Vec<Effect> = found.fit.model.iter().map(|fitted| fitted.effect.clone()).collect();
    effects.extend(places.iter().map(|place| Effect { place: *place, shape: Shape::Step { time } }));
    let regressors = effects.into_iter().map(Regressor::of).collect();
    // As white noise: a noise that wanders, as it seemed to before, would take the event for one of its steps.
    let noises = found.appraisal.as_white();
    let mut design = Design::new(study, &found.fit.model, &noises, regressors);
    design.rebase(&found.fit.model);
    let (products, samples) = design.fitted();
    let resolution = Resolution::new(study, &found.travels);
    let waves = found.tries.waves;
    let choice =
        Choice::new(study, &design, products.clone(), samples, found.always, waves, resolution).best();
    let model = fit::linear(&design, &products, found.always, &choice);
    let steps = model.iter().filter(|fitted| matches!(fitted.effect.shape, Shape::Step { .. })).count();
    Event { model, steps }
}
