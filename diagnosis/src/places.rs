//! Places: tables for what comes back at one place of an axis.
//!
//! In: a model that was found, and a feature that it leaves at a place. Out: the model with a table there, where the judge upholds
//! it; else what is left beside such a table, and the motion of which it would be.

use crate::appraisal::Appraisal;
use crate::candidates;
use crate::course::courses;
use crate::curves::{self, BROAD};
use crate::design::{Design, Regressor};
use crate::engine::{Found, upheld};
use crate::local::Feature;
use crate::model::{Effect, Fitted, Place};
use crate::side::Side;
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;
use crate::travel::Travel;

/// How many nodes a table gets, at most.
const NODES: usize = 24;

/// The model with a table for a feature that covers much of an axis, where the judge upholds it.
pub(crate) fn with_table(study: &Study<'_>, found: &Found, feature: &Feature) -> Option<Found> {
    let effect = table(study, found, feature)?;
    // The table takes over what smooth terms of the same motion said.
    let covered = |fitted: &Fitted| {
        fitted.effect.motion() == effect.motion() && matches!(fitted.effect.shape, Shape::Polynomial { .. })
    };
    let rest = found.fit.model.keeping(|fitted| !covered(fitted));
    let model = rest.with(Fitted::unfitted(effect.clone()));
    let fit = found.conditions().refine(study, model);
    let (fit, appraisal) = upheld(study, fit, &found.conditions());
    if !fit.model.effects.iter().any(|fitted| fitted.effect == effect) {
        return None;
    }
    Some(Found { fit, appraisal, plain_zeros: false, ..found.clone() })
}

/// What is left beside a feature: the appraisal of the model with a table in its place.
pub(crate) fn beside(study: &Study<'_>, found: &Found, feature: &Feature) -> Option<Appraisal> {
    let effect = table(study, found, feature)?;
    let model = found.fit.model.with(Fitted::unfitted(effect));
    let weights = found.appraisal.weights.as_white();
    Some(Appraisal::new(study, &found.conditions().under(&weights).refine(study, model).model))
}

/// The motion of which a table would explain most of a feature.
pub(crate) fn table_motion(study: &Study<'_>, found: &Found, feature: &Feature) -> Option<usize> {
    table(study, found, feature).and_then(|effect| effect.motion())
}

/// The nodes of a table for a feature: over all of the travel where it covers much of it; else over its place, and the ends of the
/// travel, so that the table is straight beside it. They are where the axis was read: between stations nothing tells of a curve.
fn nodes(feature: &Feature, travel: &Travel, read: &[f64]) -> Vec<f64> {
    let mut nodes = if feature.extent(travel) >= BROAD {
        curves::even(travel.low, travel.high, NODES.min(feature.profile.len() / 2).max(2))
    } else {
        let beside = FOOT * (feature.to - feature.from);
        let from = last_before(read, feature.from - beside).map_or(travel.low, |from| from.max(travel.low));
        let to = first_behind(read, feature.to + beside).map_or(travel.high, |to| to.min(travel.high));
        let mut nodes = curves::even(from, to, OF_A_PLACE);
        nodes.insert(0, travel.low);
        nodes.push(travel.high);
        nodes
    };
    nodes.iter_mut().for_each(|node| *node = nearest(read, *node));
    nodes.dedup();
    nodes
}

/// The places at which the axis of a feature stood where the channel that shows it was read.
fn places_read(study: &Study<'_>, found: &Found, feature: &Feature) -> Vec<f64> {
    let courses = courses(study, &found.fit.model);
    let kind = study.scenes[feature.scene].channels[feature.channel].kind;
    let position = &courses[feature.scene].states(kind).axes[feature.axis].position;
    let residual = &found.appraisal.residuals[feature.scene][feature.channel];
    let rows = position.iter().zip(residual).filter(|(place, left)| place.is_finite() && left.is_finite());
    rows.map(|(place, _)| *place).collect()
}

fn last_before(read: &[f64], at: f64) -> Option<f64> {
    read.iter().copied().filter(|place| *place <= at).reduce(f64::max)
}

fn first_behind(read: &[f64], at: f64) -> Option<f64> {
    read.iter().copied().filter(|place| *place >= at).reduce(f64::min)
}

fn nearest(read: &[f64], node: f64) -> f64 {
    let nearer = |one: f64, other: f64| if (other - node).abs() < (one - node).abs() { other } else { one };
    read.iter().copied().reduce(nearer).unwrap_or(node)
}

/// How many nodes a place gets: straight lines between them leave a thirtieth of the height of a bell, by its curvature at the top.
const OF_A_PLACE: usize = 13;
/// A feature is told down to a quarter of its height. A bell falls to a hundredth of it this share of that width farther on.
const FOOT: f64 = 0.4;

/// The table of that motion of the feature's axis that lowers the weighted sum of squares most; simpler names first.
fn table(study: &Study<'_>, found: &Found, feature: &Feature) -> Option<Effect> {
    let shape = Shape::Table {
        axis: feature.axis,
        nodes: nodes(feature, &found.travels[feature.axis], &places_read(study, found, feature)),
        directed: feature.direction != 0.0,
        repeats: false,
    };
    let motions = study.equations.motions.iter().enumerate();
    let tables: Vec<Effect> = motions
        .filter(|(_, known)| known.axis == Some(feature.axis) && !known.alignment)
        .map(|(motion, _)| Effect {
            place: Place::Motion { motion, side: Side::After },
            shape: shape.clone(),
        })
        .collect();
    let model = &found.fit.model;
    let weights = found.appraisal.weights.as_white();
    let mut regressors = Regressor::all(&model.effects);
    regressors.extend(tables.iter().cloned().map(Regressor::of));
    let design = Design::new(study, model, &weights, regressors);
    let (products, _) = design.fitted();
    let mut swept = Swept::new(&products);
    for column in (0..model.effects.len()).flat_map(|number| design.columns(number)) {
        swept.take(column);
    }
    let gain = |number: usize| {
        let columns: Vec<usize> = design.columns(model.effects.len() + number).collect();
        swept.promise(&columns).0 - candidates::simplicity(study, &tables[number])
    };
    (0..tables.len()).max_by(|a, b| gain(*a).total_cmp(&gain(*b))).map(|best| tables[best].clone())
}
