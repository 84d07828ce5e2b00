//! Which dents are seen beside what hides them, and what is none.

use super::*;
use crate::conditions::Tries;
use crate::course::courses;
use crate::noise::Noise;
use crate::terms::Setting;
use crate::testing::{Bench, line, noisy, path, position};
use crate::travel::travels;

/// What `asked` tells of the dents that a recording of a machine with these errors of X shows. X goes 200 mm there and back, once.
fn with<T>(errors: &str, asked: impl Fn(&Study<'_>, &Model, &Conditions<'_>) -> T) -> T {
    let bench = Bench::of("FX");
    let there_and_back = path(line(0, 0.0, 200.0), 20.0, 50.0);
    let truth = bench.calibration(errors);
    let recording = bench.record(&truth, &noisy(there_and_back, position("x"), 0.000_3, 5));
    let study = Study::new(bench.equations(), None, std::slice::from_ref(&&recording));
    let zero = Effect::setting(0, Setting::Offset { channel: 0 });
    let model = Model::of_settings([zero]);
    let travels = travels(&study, &courses(&study, &model));
    let weights = Weights::of_all(&study, vec![vec![Noise::white(0.000_3)]]);
    let tries = Tries { candidates: 40.0, waves: 300.0 };
    asked(&study, &model, &Conditions { weights: &weights, travels: &travels, tries })
}

/// Middle and flank of the dent that is seen, mm.
fn seen(errors: &str) -> Option<(f64, f64)> {
    with(errors, |study, model, conditions| {
        let (dent, _) = hidden(study, model, conditions).pop()?;
        Some((dent.middle, dent.flank))
    })
}

/// The nodes of a table that is drawn over the dent, mm, and its values there, mm.
fn drawn(errors: &str) -> Option<Vec<(f64, f64)>> {
    with(errors, |study, model, conditions| {
        let (dent, beside) = hidden(study, model, conditions).pop()?;
        let begun = dent.added(study, &beside, conditions)?;
        let fit = dent.drawn(study, conditions.refine(study, begun), conditions);
        assert!(dent.is_in(&fit.model, conditions.travels));
        let table = fit.model.effects.iter().find(|fitted| dent.is_table(fitted))?;
        match &table.effect.shape {
            Shape::Table { nodes, .. } => {
                Some(nodes.iter().copied().zip(table.coefficients.iter().copied()).collect())
            }
            _ => None,
        }
    })
}

/// A play that is taken up over 80 mm hides most of what else there is.
const PLAY: &str = "{backlash: {lost_motion: 30 um, wind_up: 80 mm}}";

#[test]
fn a_dent_is_seen_beside_a_play_that_hides_it() {
    let dent = "{table: {start: 105 mm, step: 15 mm, unit: um, values: [0, 40, 0]}}";
    let (middle, flank) = seen(&format!("{{EXX: [{dent}, {PLAY}]}}")).unwrap();
    assert!((middle - 120.0).abs() < 8.0 && flank < 45.0, "{middle} {flank}");
}

#[test]
fn a_dent_is_seen_beside_a_lag_where_waves_draw_it() {
    let dent = "{table: {start: 105 mm, step: 15 mm, unit: um, values: [0, 500, 0]}}";
    with(&format!("{{EXX: [{dent}, {{lag: {{gain: 40 1/s}}}}]}}"), |study, model, conditions| {
        let of_x = |shape| Fitted::unfitted(Effect { place: study.own_place(0).unwrap(), shape });
        let wave = |order| Shape::Cyclic { axis: 0, period: 200.0, order, center: 100.0 };
        let lag = Shape::Lag { axis: 0, inertia: 0.0 };
        let drawn = (1..8).map(wave).chain([lag]).fold(model.clone(), |model, shape| model.with(of_x(shape)));
        let drawn = conditions.refine(study, drawn).model;
        let (dent, beside) = hidden(study, &drawn, conditions).pop().unwrap();
        assert_eq!(beside.chosen().len(), 1, "beside the lag alone");
        assert!((dent.middle - 120.0).abs() < 3.0 && dent.flank < 20.0 && dent.share > 0.9, "{dent:?}");
    });
}

#[test]
fn what_stands_out_on_one_way_alone_is_no_dent() {
    let one_way = "{table: {start: 105 mm, step: 15 mm, unit: um, forward: [0, 40, 0], reverse: [0, 0, 0]}}";
    assert_eq!(seen(&format!("{{EXX: [{one_way}, {PLAY}]}}")), None);
    let turned = "{table: {start: 105 mm, step: 15 mm, unit: um, forward: [0, 40, 0], reverse: [0, -40, 0]}}";
    assert_eq!(seen(&format!("{{EXX: [{turned}, {PLAY}]}}")), None);
}

#[test]
fn a_dent_is_drawn_with_the_nodes_that_it_needs() {
    let nodes =
        drawn("{EXX: [{table: {start: 105 mm, step: 15 mm, unit: um, values: [0, 40, 0]}}]}").unwrap();
    // Two on each side of its three corners, and both ends.
    assert!(nodes.len() <= 14, "{nodes:?}");
    // Straight to both ends of the travel beside it, and 40 um high in its middle.
    assert!(nodes[0].0 < 1.0 && nodes[nodes.len() - 1].0 > 199.0, "{nodes:?}");
    let at = |place: f64| {
        let behind = nodes.iter().position(|(node, _)| *node >= place).unwrap();
        let ((a, low), (b, high)) = (nodes[behind - 1], nodes[behind]);
        low + (high - low) * (place - a) / (b - a)
    };
    // A corner between two nodes, which are 2.2 mm apart where it falls by 2.7 um/mm, is cut by half a step at most.
    assert!((at(120.0) - at(60.0) - 0.04).abs() < 0.003, "{nodes:?}");
    assert!((at(112.5) - at(60.0) - 0.02).abs() < 0.001, "{nodes:?}");
    assert!((at(180.0) - at(60.0)).abs() < 0.001, "{nodes:?}");
}

#[test]
fn a_play_alone_hides_no_dent() {
    assert_eq!(seen(&format!("{{EXX: [{PLAY}]}}")), None);
}

/// Bumps of some 10 um that differ from one way to the other, and a dent of this height at 120 mm, um.
fn bumpy(seed: u64, dent: f64) -> String {
    let mut state = seed;
    let mut bumps = |of: &str| {
        let values = (0..21).map(|node| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let random = crate::number(usize::try_from(state >> 40).unwrap()) / crate::number(1 << 24) - 0.5;
            let own = if node == 0 { 0.0 } else { 30.0 * random };
            format!("{:.2}", own + if node == 12 { dent } else { 0.0 })
        });
        format!("{of}: [{}]", values.collect::<Vec<_>>().join(", "))
    };
    let (up, down) = (bumps("forward"), bumps("reverse"));
    format!("{{EXX: [{{table: {{start: 0 mm, step: 10 mm, unit: um, {up}, {down}}}}}]}}")
}

fn outstanding_in(errors: &str) -> Option<(f64, f64)> {
    with(errors, |study, model, conditions| {
        let appraisal = Appraisal::new(study, model);
        outstanding(study, model, &appraisal, conditions).map(|dent| (dent.middle, dent.flank))
    })
}

#[test]
fn a_dent_stands_out_among_bumps_that_differ_from_pass_to_pass() {
    for seed in 1..8 {
        let (middle, flank) = outstanding_in(&bumpy(seed, 60.0)).unwrap();
        assert!((middle - 120.0).abs() <= flank, "seed {seed}: {middle} {flank}");
    }
}

#[test]
fn bumps_that_agree_by_chance_do_not_stand_out() {
    // Chance lets them once in 30 times: four or more of 30 would be one time in 50.
    let told = (1..31).filter(|seed| outstanding_in(&bumpy(1000 + seed, 0.0)).is_some()).count();
    assert!(told < 4, "{told} of 30");
}
