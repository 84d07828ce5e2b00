//! Heat: two temperatures with which a machine grows, before anything else explains it.
//!
//! In: a model in which something grows with a temperature. Out: for each place that grows, the two growths that explain most without any
//! other effect. Temperatures of one machine rise together. A search that adds one effect after the other begins with the sensor that is
//! nearest to the sum of them all, and a drift then explains the rest.

use crate::appraisal::Appraisal;
use crate::conditions::Conditions;
use crate::design::{Design, Regressor};
use crate::fit;
use crate::kinship::Kin;
use crate::model::{Effect, Model, Place};
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;

/// A model with the two best growths at each place that grows, beside nothing but the settings. Each follows its sensor after its own
/// time constant. `None` where nothing grows, or where a place has no two sensors to grow with.
pub(crate) fn growths_alone(
    study: &Study<'_>,
    model: &Model,
    pool: &[Kin],
    conditions: &Conditions<'_>,
) -> Option<Model> {
    let places = grown_places(model);
    if places.is_empty() {
        return None;
    }
    // The noise beside all effects of the model: beside the settings alone, all of them would be noise.
    let known = Appraisal::new(study, model).weights;
    let conditions = conditions.under(&known);
    let settings = model.settings_alone();
    let grows = |effect: &&Effect| sensor_of(&effect.shape).is_some() && places.contains(&effect.place);
    let candidates = pool.iter().map(|kin| &kin.effect).filter(grows);
    let effects = settings.effects.iter().map(|fitted| &fitted.effect).chain(candidates);
    let regressors = effects.cloned().map(Regressor::of).collect();
    let mut design = Design::new(study, &settings, conditions.weights, regressors);
    design.rebase(&settings.effects);
    let (products, _) = design.fitted();

    let fixed = settings.effects.len();
    let mut swept = Swept::new(&products);
    for column in (0..fixed).flat_map(|setting| design.columns(setting)) {
        swept.take(column);
    }
    let mut chosen: Vec<usize> = Vec::new();
    for place in places {
        let there = |number: &usize| design.regressors[*number].effect.place == place;
        let numbers: Vec<usize> = (fixed..design.regressors.len()).filter(there).collect();
        chosen.extend(best_pair(&design, &swept, &numbers)?);
    }
    let growths = settings.with_effects(fit::linear(&design, &products, fixed, &chosen));
    Some(conditions.refine(study, growths).model)
}

/// The sensor with which a shape grows.
fn sensor_of(shape: &Shape) -> Option<usize> {
    match shape {
        Shape::Growth { sensor, .. } => Some(*sensor),
        _ => None,
    }
}

/// The places at which something of a model grows.
fn grown_places(model: &Model) -> Vec<Place> {
    let mut places = Vec::new();
    for fitted in model.chosen() {
        let effect = &fitted.effect;
        if sensor_of(&effect.shape).is_some() && !places.contains(&effect.place) {
            places.push(effect.place);
        }
    }
    places
}

/// The two of these growths, with different sensors, that leave least beside what has been swept in.
fn best_pair(design: &Design, swept: &Swept, growths: &[usize]) -> Option<[usize; 2]> {
    let sensor = |number: usize| sensor_of(&design.regressors[number].effect.shape);
    let mut best: Option<(f64, [usize; 2])> = None;
    for (at, one) in growths.iter().enumerate() {
        let mut with_one = swept.clone();
        if !with_one.take(design.first[*one]) {
            continue;
        }
        for other in growths[at + 1..].iter().filter(|other| sensor(**other) != sensor(*one)) {
            let (gain, _) = with_one.promise(&[design.first[*other]]);
            let left = with_one.remaining() - gain;
            if best.is_none_or(|(least, _)| left < least) {
                best = Some((left, [*one, *other]));
            }
        }
    }
    best.map(|(_, pair)| pair)
}

#[cfg(test)]
mod tests;
