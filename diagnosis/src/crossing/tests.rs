//! How far plays are crossed, and which are tried.

use super::*;
use crate::conditions::Tries;
use crate::model::Fitted;
use crate::noise::Noise;
use crate::recording::Recording;
use crate::testing::{Bench, circle, distance, noisy, path, peak, position, together};
use crate::weights::Weights;
use crate::zeros;

/// Lost motion of X and of Y, mm.
const LOST: [f64; 2] = [0.009, 0.012];

/// A slow circle of a machine whose slides stand still until their drives have crossed the plays, read without noise.
fn circled(bench: &Bench) -> Recording {
    let free = "{EXX: [{backlash: {lost_motion: 9 um, wind_up: 9 um}}], \
                EYY: [{backlash: {lost_motion: 12 um, wind_up: 12 um}}]}";
    bench.record(&bench.calibration(free), &noisy(path(circle(90.0), 20.0, 100.0), position("xy"), 0.0, 1))
}

fn own(bench: &Bench, axis: usize, shape: Shape, coefficient: f64) -> Fitted {
    let place = Place::Motion { motion: bench.motion(["EXX", "EYY"][axis]), side: Side::After };
    Fitted { effect: Effect { place, shape }, coefficients: vec![coefficient] }
}

fn at_once(bench: &Bench, axis: usize, lost: f64) -> Fitted {
    own(bench, axis, Shape::Backlash { axis, wind_up: 0.0 }, lost)
}

/// A model whose first axes cross their plays over these ways.
fn crossing(mut model: Model, ways: [f64; 2]) -> Model {
    ways.into_iter().enumerate().for_each(|(axis, way)| model.cross(axis, way));
    model
}

/// The ways over which the first axes of a model cross their plays.
fn ways(model: &Model) -> [f64; 2] {
    [0, 1].map(|axis| model.crossing(axis))
}

#[test]
fn a_crossed_play_is_what_a_machine_with_free_play_does() {
    let bench = Bench::of("XFY");
    let recording = circled(&bench);
    // X is known, Y is in the model: both are crossed alike.
    let known = bench.calibration("{EXX: [{backlash: {lost_motion: 9 um}}]}");
    let study = Study::new(bench.equations(), Some(&known), &[&recording]);
    let model = Model::of([at_once(&bench, 1, LOST[1])]);
    // Where the path turns a corner between two rows, nothing is known.
    let known = |left: Vec<f64>| left.into_iter().filter(|left| left.is_finite()).collect::<Vec<f64>>();
    let left = |model: &Model| known(zeros::residuals(&study, model).remove(0).concat());
    // At once, the whole play is missing as long as it is crossed.
    assert!(peak(&left(&model)) > 0.9 * LOST[1]);
    let crossed = left(&crossing(model, LOST));
    assert!(crossed.len() > recording.time.len() && peak(&crossed) < 1e-9, "{}", peak(&crossed));
}

#[test]
fn a_play_is_crossed_as_far_as_it_goes_and_given_up_with_it() {
    let bench = Bench::of("XFY");
    let recording = circled(&bench);
    let known = bench.calibration("{EXX: [{backlash: {lost_motion: 9 um}}]}");
    let study = Study::new(bench.equations(), Some(&known), &[&recording]);
    let mut more = Model::of([at_once(&bench, 0, 0.002), at_once(&bench, 1, LOST[1])]);
    // What is not crossed stays so.
    assert!(!follow(&study, &mut more) && !more.crosses());
    let mut more = crossing(more, LOST);
    assert!(follow(&study, &mut more));
    assert!(distance(&ways(&more), &[0.011, LOST[1]]) < 1e-12);
    // Within a hundredth it is the same.
    let mut nearly = more.with_effects([at_once(&bench, 0, 0.002_1), at_once(&bench, 1, LOST[1])]);
    assert!(!follow(&study, &mut nearly));
    // A play that is no longer in the model is no longer crossed; nor is one that would be negative.
    let mut none = nearly.with_effects([]);
    assert!(follow(&study, &mut none));
    assert!(distance(&ways(&none), &[LOST[0], 0.0]) < 1e-12);
    let mut negative = none.with_effects([at_once(&bench, 0, -0.02)]);
    assert!(follow(&study, &mut negative) && !negative.crosses());
}

#[test]
fn only_plays_of_the_axis_itself_behind_the_drive_that_act_at_once_are_crossed() {
    let bench = Bench::of("XFY");
    let recording = circled(&bench);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let play = |fitted: Fitted| play(&study, &Model::of([fitted]), 0);
    assert_eq!(play(at_once(&bench, 0, 0.004)), 0.004);
    assert_eq!(play(own(&bench, 0, Shape::Backlash { axis: 0, wind_up: 0.5 }, 0.004)), 0.0);
    assert_eq!(play(own(&bench, 1, Shape::Backlash { axis: 0, wind_up: 0.0 }, 0.004)), 0.0);
    let mut friction = at_once(&bench, 0, 0.004);
    friction.effect.place = Place::Motion { motion: bench.motion("EXX"), side: Side::Drive };
    assert_eq!(play(friction), 0.0);
}

#[test]
fn what_holds_an_axis_is_tried_without_it_and_without_the_plays_beside_it() {
    let bench = Bench::of("XFY");
    let recording = circled(&bench);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let spike = own(&bench, 0, Shape::ReversalSpike { axis: 0, decay: 0.05 }, 0.003);
    let wound = own(&bench, 0, Shape::Backlash { axis: 0, wind_up: 0.5 }, 0.003);
    let (x, y) = (at_once(&bench, 0, 0.004), at_once(&bench, 1, 0.004));
    let trials = |model: &Model| without_holds(&study, model, 0);
    let all = Model::of([spike.clone(), x.clone(), y.clone()]);
    assert_eq!(trials(&all), [all.clone(), Model::of([x.clone(), y.clone()]), Model::of([y.clone()])]);
    assert_eq!(
        trials(&Model::of([wound.clone(), y.clone()])),
        [Model::of([wound, y.clone()]), Model::of([y.clone()])]
    );
    // Settings that are always fitted stay, whatever they are; so does what holds another axis.
    let held = all.clone().with_settings(1);
    let rest = Model::of([spike.clone(), y.clone()]).with_settings(1);
    assert_eq!(trials(&held), [held.clone(), held.clone(), rest]);
    assert_eq!(without_holds(&study, &all, 1), [all.clone(), all.clone(), Model::of([spike, x])]);
}

#[test]
fn nothing_is_tried_where_nothing_holds_an_axis() {
    let bench = Bench::of("XFY");
    let recording = circled(&bench);
    let known = bench.calibration("{EXX: [{backlash: {lost_motion: 9 um}}]}");
    let study = Study::new(bench.equations(), Some(&known), &[&recording]);
    let tries = Tries { candidates: 50.0, waves: 100.0 };
    let weights = Weights::of_all(&study, vec![vec![Noise::white(1e-4); 2]]);
    let travels = crate::travel::travels(&study, &crate::engine::courses(&study, &Model::default()));
    let conditions = Conditions { weights: &weights, travels: &travels, tries };
    let model = Model::of([at_once(&bench, 1, LOST[1])]);
    assert!(try_plays(&study, &model, &conditions).is_none());
    // With something that does, the known play explains what that seemed to.
    let spiked = Model::of([
        own(&bench, 0, Shape::ReversalSpike { axis: 0, decay: 0.05 }, 0.003),
        model.effects[0].clone(),
    ]);
    let chosen = try_plays(&study, &spiked, &conditions).unwrap();
    assert!(distance(&ways(&chosen), &[LOST[0], 0.0]) < 1e-12);
    assert_eq!(chosen.effects.len(), 1);
    assert_eq!(crossing_only(&chosen), [0]);
    assert!(crossing_only(&spiked.crossed_as(&chosen)).is_empty());
}

#[test]
fn plays_that_are_known_and_found_are_one_way_to_cross() {
    let bench = Bench::of("XFY");
    let part = bench.calibration("{EXX: [{backlash: {lost_motion: 5 um}}]}");
    let whole = together(&part, &bench.calibration("{EXX: [{backlash: {lost_motion: 4 um}}]}"));
    let recording = circled(&bench);
    let study = Study::new(bench.equations(), Some(&whole), &[&recording]);
    assert!((play(&study, &Model::default(), 0) - LOST[0]).abs() < 1e-12);
    assert!((play(&study, &Model::of([at_once(&bench, 0, 0.001)]), 0) - 0.010).abs() < 1e-12);
}
