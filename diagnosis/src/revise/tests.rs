//! What a revision promises, against what comes of it.

use super::*;
use crate::conditions::Tries;
use crate::model::Place;
use crate::side::Side;
use crate::terms::Setting;
use crate::testing::{Bench, line, noisy, path, position};
use crate::travel::travels;

/// What `asked` makes of a revision that knows `pool` and has refuted `refuted`. It revises a fit with one effect, `claimed`, of a machine
/// that has `errors` in EXX.
fn revising<T>(
    errors: &str,
    claimed: Shape,
    (pool, refuted): (&[Shape], &[Shape]),
    asked: impl FnOnce(&Study<'_>, &Revision<'_>, (Fit, Appraisal)) -> T,
) -> T {
    let bench = Bench::of("FX");
    let truth = bench.calibration(&format!("{{EXX: [{errors}]}}"));
    let there_and_back = path(line(0, 0.0, 300.0), 20.0, 20.0);
    let recording = bench.record(&truth, &noisy(there_and_back, position("x"), 0.000_3, 5));
    let study = Study::new(bench.equations(), None, &[&recording]);
    let place = Place::Motion { motion: bench.motion("EXX"), side: Side::After };
    let effect = |shape: &Shape| Effect { place, shape: shape.clone() };
    let zero = Fitted::unfitted(Effect::setting(0, Setting::Offset { channel: 0 }));
    let model = Model::of([zero, Fitted::unfitted(effect(&claimed))]).with_settings(1);
    let travels = travels(&study, &courses(&study, &model));
    let first = Appraisal::new(&study, &model);
    let tries = Tries { candidates: 40.0, waves: 300.0 };
    let before = Conditions { weights: &first.weights, travels: &travels, tries };
    let appraisal = Appraisal::new(&study, &before.refine(&study, model.clone()).model);
    let weights = appraisal.weights.clone();
    let conditions = before.under(&weights);
    let fit = conditions.refine(&study, model);
    let pool: Vec<Kin> = pool.iter().map(|shape| Kin { effect: effect(shape), equals: Vec::new() }).collect();
    let refuted: Vec<Effect> = refuted.iter().map(effect).collect();
    let revision = Revision { pool: &pool, places: &[], refuted: &refuted, bands: &[], conditions };
    asked(&study, &revision, (fit, appraisal))
}

/// A polynomial along X.
fn polynomial(degree: usize) -> Shape {
    Shape::Polynomial { axis: 0, degree, center: 150.0, scale: 150.0 }
}

/// A revision of a fit with a backlash, of a machine that has a backlash and a slope, um/mm. The revision knows the slope.
fn beside_a_backlash<T>(
    slope: f64,
    refuted: bool,
    asked: impl FnOnce(&Study<'_>, &Revision<'_>, (Fit, Appraisal)) -> T,
) -> T {
    let errors = format!(
        "{{backlash: {{lost_motion: 6 um}}}}, {{polynomial: {{axis: X, per: mm, unit: um, coefficients: [0, {slope}]}}}}"
    );
    let known = [polynomial(1)];
    let refuted = if refuted { &known[..] } else { &[] };
    revising(&errors, Shape::Backlash { axis: 0, wind_up: 0.0 }, (&known, refuted), asked)
}

/// What a slope beside a backlash promises, and what it saves when it is fitted.
fn promised_and_saved(slope: f64) -> (f64, f64) {
    beside_a_backlash(slope, false, |study, revision, (fit, appraisal)| {
        let conditions = &revision.conditions;
        let prices = conditions.prices(study, &fit.model, fit.samples);
        let cost = conditions.cost_at(study, &fit, &prices);
        let trials = revision.trials(study, &fit, &prices, &appraisal, &|_| true);
        let beside = trials.iter().find(|trial| trial.model.effects.len() > fit.model.effects.len()).unwrap();
        let fitted = conditions.refine(study, beside.model.clone());
        (beside.gain, cost - conditions.cost_at(study, &fitted, &beside.prices))
    })
}

/// The cost is logarithmic in what remains. So is a promise: where few stretches are told apart, an effect that takes most of the rest would
/// otherwise promise less than its price.
#[test]
fn what_a_linear_effect_promises_is_what_it_saves() {
    for slope in [0.02, 0.2, 2.0] {
        let (promised, saved) = promised_and_saved(slope);
        assert!((promised - saved).abs() < 1e-3 * saved.abs(), "{slope}: {promised} for {saved}");
    }
}

#[test]
fn what_was_refuted_is_not_looked_for_again() {
    let chosen = |refuted| {
        beside_a_backlash(0.2, refuted, |study, revision, (fit, appraisal)| {
            revision.revised(study, fit, appraisal).0.model.chosen().len()
        })
    };
    assert_eq!(chosen(false), 2, "the slope is found");
    assert_eq!(chosen(true), 1, "the slope is refuted");
}

/// What a model with a slope is worth beside one without.
#[test]
fn a_model_is_better_only_where_it_costs_less_than_the_one_that_stands() {
    let with_slope_is_better = |slope| {
        beside_a_backlash(slope, false, |study, revision, (fit, appraisal)| {
            let slope = Fitted::unfitted(revision.pool[0].effect.clone());
            let with = revision.conditions.refine(study, fit.model.with(slope));
            let left = Appraisal::new(study, &with.model);
            let [without, with] = [(fit, appraisal), (with, left)];
            let better = revision.is_better(study, &with, (&without.0, &without.1));
            assert!(
                !(better && revision.is_better(study, &without, (&with.0, &with.1))),
                "only one of both is"
            );
            better
        })
    };
    assert!(with_slope_is_better(0.2));
    assert!(!with_slope_is_better(0.0), "the slope of noise");
}

/// The degree of the polynomial that is left of one of degree 3, where the machine has one with these coefficients.
fn simplified(coefficients: &str) -> usize {
    let errors = format!("{{polynomial: {{axis: X, per: mm, unit: um, coefficients: {coefficients}}}}}");
    let simpler = [polynomial(1), polynomial(2)];
    revising(&errors, polynomial(3), (&simpler, &[]), |study, revision, (fit, appraisal)| {
        assert!(!appraisal.lacks(), "nothing is lacking");
        match revision.simplified(study, fit, appraisal).0.model.chosen() {
            [Fitted { effect: Effect { shape: Shape::Polynomial { degree, .. }, .. }, .. }] => *degree,
            other => panic!("{other:?}"),
        }
    })
}

#[test]
fn a_polynomial_keeps_the_powers_that_are_there() {
    assert_eq!(simplified("[0, 0.05]"), 1);
    assert_eq!(simplified("[0, 0.05, -2e-4]"), 2);
    assert_eq!(simplified("[0, 0.05, -2e-4, 1e-6]"), 3);
}
