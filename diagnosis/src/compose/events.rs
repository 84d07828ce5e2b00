//! Events: what happened once, in several error motions at the same moment.
//!
//! In: a study that was searched. Out: the moments at which steps of all motions together explain most, and models with those steps that
//! are worth their price. A crash moves more than one thing, and each step alone leaves the others to the noise: so the steps of one
//! moment are chosen together, beside what was found. The moment is looked for in all rows, since what is held out may be when it was.

use nalgebra::DMatrix;

use crate::audit::spread;
use crate::channel::ChannelAt;
use crate::design::{Design, Regressor};
use crate::engine::Found;
use crate::fit;
use crate::model::{Effect, Fitted, Model, Place};
use crate::ranges::Resolution;
use crate::search::{Choice, rivals};
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;

use super::forms;

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

/// Models with steps at the moments that explain most; none without a step. The best moment beside all that was found comes first: it is
/// right where nothing of that imitates the event. Then come the two best moments beside the settings and the plays alone. The plays are
/// among them because what a play leaves at a reversal looks like a step there.
pub(super) fn events(study: &Study<'_>, found: &Found) -> Vec<Event> {
    let places = forms::places(study);
    let grid = forms::moments(study);
    if grid.is_empty() || places.is_empty() {
        return Vec::new();
    }
    let settings_and_plays: Vec<Effect> =
        effects(found.fit.model.settings()).into_iter().chain(plays(found)).collect();
    let mut best: Vec<f64> = Vec::new();
    for (beside, moments) in [(effects(&found.fit.model.effects), 1), (settings_and_plays, 2)] {
        let most = best.len() + moments;
        for (time, _) in ranked(study, found, &beside, &places, &grid) {
            let is_near = |known: &f64| (known - time).abs() < 2.5 * forms::distance(study);
            if best.len() < most && !best.iter().any(is_near) {
                best.push(dated(study, found, &beside, &places, time));
            }
        }
    }
    best.into_iter().map(|time| chosen(study, found, time, &places)).filter(|event| event.steps > 0).collect()
}

/// The model with each of its events at the moment that explains most beside all else.
pub(super) fn dated_again(study: &Study<'_>, found: &Found) -> Model {
    let mut model = found.fit.model.clone();
    let mut moments: Vec<f64> = model.chosen().iter().filter_map(|fitted| moment(&fitted.effect)).collect();
    moments.dedup();
    for first in moments {
        let is_of_it = |effect: &Effect| moment(effect) == Some(first);
        let (steps, beside): (Vec<Effect>, Vec<Effect>) =
            effects(&found.fit.model.effects).into_iter().partition(is_of_it);
        let places: Vec<Place> = steps.iter().map(|step| step.place).collect();
        let time = dated(study, found, &beside, &places, first);
        for fitted in model.chosen_mut().iter_mut().filter(|fitted| is_of_it(&fitted.effect)) {
            fitted.effect.shape = Shape::Step { time };
        }
    }
    model
}

/// When a step happened.
fn moment(effect: &Effect) -> Option<f64> {
    match effect.shape {
        Shape::Step { time } => Some(time),
        _ => None,
    }
}

fn effects(fitted: &[Fitted]) -> Vec<Effect> {
    fitted.iter().map(|fitted| fitted.effect.clone()).collect()
}

/// The candidates that are plays which act at once.
fn plays(found: &Found) -> impl Iterator<Item = Effect> + '_ {
    let effects = found.pool.iter().map(|kin| &kin.effect);
    effects.filter(|effect| matches!(effect.shape, Shape::Backlash { wind_up: 0.0, .. })).cloned()
}

/// The time around a moment at which steps explain most beside some effects.
fn dated(study: &Study<'_>, found: &Found, beside: &[Effect], places: &[Place], mut time: f64) -> f64 {
    for finer in 1..=DATINGS {
        let step = forms::distance(study) * 0.1_f64.powi(finer);
        let times: Vec<f64> = (-BESIDE..=BESIDE).map(|number| time + f64::from(number) * step).collect();
        let ranked = ranked(study, found, beside, places, &times);
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

/// Times with the sum of squares that steps in all places explain together there beside some effects, the most first.
///
/// A step is how its motion is seen, from its time on. So its products are sums over the rows from that time on, and one pass over the
/// rows gives those of all times.
fn ranked(
    study: &Study<'_>,
    found: &Found,
    beside: &[Effect],
    places: &[Place],
    times: &[f64],
) -> Vec<(f64, f64)> {
    let model = &found.fit.model;
    let always_there = |place: &Place| Effect { place: *place, shape: Shape::Step { time: f64::MIN } };
    let known = model.effects.iter().map(|fitted| fitted.effect.clone());
    let effects = known.chain(beside.iter().cloned()).chain(places.iter().map(always_there));
    let regressors: Vec<Regressor> = effects.map(Regressor::of).collect();
    let columns_of = |regressors: &[Regressor]| regressors.iter().map(Regressor::columns).sum::<usize>();
    let (known, rest) = regressors.split_at(model.effects.len());
    let first = columns_of(known);
    let always = columns_of(&rest[..beside.len()]);
    let mut times = times.to_vec();
    times.sort_by(f64::total_cmp);
    let mut sums = Sums::new(always, places.len(), times.len());
    for (scene, known) in study.scenes.iter().enumerate() {
        let rows = spread(known.rows());
        for channel in 0..known.channels.len() {
            let at = ChannelAt { scene, channel };
            let matrix = Design::columns_in(study, at, model, &regressors, &rows);
            let response = restored(found, &matrix, at, &rows);
            let weight = 1.0 / found.appraisal.weights.noise(at).size();
            let mut row_of = vec![0.0; always + places.len() + 1];
            for (place, row) in rows.iter().enumerate() {
                let columns = first..first + always + places.len();
                let values = columns.map(|column| matrix[(place, column)]).chain([response[place]]);
                row_of.iter_mut().zip(values).for_each(|(sum, value)| *sum = weight * value);
                let since = times.partition_point(|time| *time <= known.given.time[*row]);
                sums.add(&row_of, since);
            }
        }
    }
    let explained = sums.explained();
    let mut ranked: Vec<(f64, f64)> = times.into_iter().zip(explained).collect();
    ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
    ranked
}

/// Products of what always acts, of steps and of the response, for many times of the steps.
struct Sums {
    always: usize,
    places: usize,
    /// Of the rows between each time and the next one: the products of the steps with everything. Those before the first time hold none.
    between: Vec<DMatrix<f64>>,
    /// The products of what always acts and of the response, over all rows.
    whole: DMatrix<f64>,
}

impl Sums {
    fn new(always: usize, places: usize, times: usize) -> Self {
        let size = always + places + 1;
        let between = vec![DMatrix::zeros(size, places); times];
        Self { always, places, between, whole: DMatrix::zeros(size, size) }
    }

    /// Adds a row. `since` is the number of times that lie before it. A row with a value missing is left out.
    fn add(&mut self, row: &[f64], since: usize) {
        if row.iter().any(|value| !value.is_finite()) {
            return;
        }
        let row = nalgebra::DVectorView::from_slice(row, row.len());
        self.whole.ger(1.0, &row, &row, 1.0);
        if let Some(between) = since.checked_sub(1).and_then(|number| self.between.get_mut(number)) {
            between.ger(1.0, &row, &row.rows(self.always, self.places), 1.0);
        }
    }

    /// For each time the sum of squares that steps explain together, beside what always acts.
    fn explained(&self) -> Vec<f64> {
        let steps = self.always..self.always + self.places;
        let mut since = DMatrix::zeros(self.whole.nrows(), self.places);
        let mut explained: Vec<f64> = self
            .between
            .iter()
            .rev()
            .map(|between| {
                since += between;
                let mut products = self.whole.clone();
                for (number, column) in steps.clone().enumerate() {
                    products.column_mut(column).copy_from(&since.column(number));
                    products.row_mut(column).tr_copy_from(&since.column(number));
                }
                let mut swept = Swept::new(&products);
                for column in 0..self.always {
                    swept.take(column);
                }
                swept.promise(&steps.clone().collect::<Vec<_>>()).0
            })
            .collect();
        explained.reverse();
        explained
    }
}

/// What the settings and the steps have to explain: the residual, with what the model takes from it; NaN in rows that do not count.
fn restored(found: &Found, matrix: &DMatrix<f64>, at: ChannelAt, rows: &[usize]) -> nalgebra::DVector<f64> {
    let mut response = matrix.column(matrix.ncols() - 1).into_owned();
    let coefficients = found.fit.model.effects.iter().flat_map(|fitted| &fitted.coefficients);
    for (column, coefficient) in coefficients.enumerate() {
        response += matrix.column(column) * *coefficient;
    }
    let outliers = found.appraisal.weights.outliers.of(at);
    response.iter_mut().zip(rows).filter(|(_, row)| outliers[**row]).for_each(|(value, _)| *value = f64::NAN);
    response
}

/// The best set of what was found, of plays and of steps at a moment, by linear least squares. A play of the size of the step may only be
/// seen beside it.
fn chosen(study: &Study<'_>, found: &Found, time: f64, places: &[Place]) -> Event {
    let mut effects = effects(&found.fit.model.effects);
    effects.extend(
        plays(found).filter(|play| !found.fit.model.effects.iter().any(|known| rivals(&known.effect, play))),
    );
    effects.extend(places.iter().map(|place| Effect { place: *place, shape: Shape::Step { time } }));
    let regressors = effects.into_iter().map(Regressor::of).collect();
    // As white noise: a noise that wanders, as it seemed to before, would take the event for one of its steps.
    let weights = found.appraisal.weights.as_white();
    let mut design = Design::new(study, &found.fit.model, &weights, regressors);
    design.rebase(&found.fit.model.effects);
    let (products, samples) = design.fitted();
    let resolution = Resolution::new(study, &found.travels);
    let (settings, waves) = (found.fit.model.settings().len(), found.tries.waves);
    let choice = Choice::new(study, &design, products.clone(), samples, settings, waves, resolution).best();
    let model = found.fit.model.with_effects(fit::linear(&design, &products, settings, &choice));
    let steps = model.effects.iter().filter(|fitted| fitted.effect.shape.is_event()).count();
    Event { model, steps }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows 0, 0, 3, 3 beside a zero: a step before the third row explains all of 9 about the mean of 1.5. One before the second row
    /// leaves means of 0 and 2, and explains 1.5^2 + 3 0.5^2 = 3. One behind all rows, or before the first, explains nothing.
    #[test]
    fn a_step_explains_what_lies_between_the_means() {
        let mut sums = Sums::new(1, 1, 4);
        for (since, response) in [(1, 0.0), (2, 0.0), (3, 3.0), (3, 3.0)] {
            sums.add(&[1.0, 1.0, response], since);
        }
        let explained = sums.explained();
        for (found, expected) in explained.iter().zip([0.0, 3.0, 9.0, 0.0]) {
            assert!((found - expected).abs() < 1e-9, "{explained:?}");
        }
    }

    /// A row that is not known says nothing.
    #[test]
    fn what_is_missing_does_not_count() {
        let mut sums = Sums::new(1, 1, 2);
        for (since, response) in [(1, 0.0), (2, 3.0), (2, f64::NAN)] {
            sums.add(&[1.0, 1.0, response], since);
        }
        let explained = sums.explained();
        assert!((explained[1] - 4.5).abs() < 1e-9, "{explained:?}");
    }
}
