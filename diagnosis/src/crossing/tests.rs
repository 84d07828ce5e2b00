//! How far plays are crossed, and which are tried.

use super::*;
use crate::conditions::Tries;
use crate::model::Fitted;
use crate::noise::Noise;
use crate::recording::Recording;
use crate::testing::{Bench, circle, distance, noisy, path, peak, position, together};
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

#[test]
fn a_crossed_play_is_what_a_machine_with_free_play_does() {
    let bench = Bench::of("XFY");
    let recording = circled(&bench);
    // X is known, Y is in the model: both are crossed alike.
    let known = bench.calibration("{EXX: [{backlash: {lost_motion: 9 um}}]}");
    let mut study = Study::new(bench.equations(), Some(&known), &[&recording]);
    let model = vec![at_once(&bench, 1, LOST[1])];
    // Where the path turns a corner between two rows, nothing is known.
    let known = |left: Vec<f64>| left.into_iter().filter(|left| left.is_finite()).collect::<Vec<f64>>();
    let left = |study: &Study<'_>| known(zeros::residuals(study, &model).remove(0).concat());
    // At once, the whole play is missing as long as it is crossed.
    assert!(peak(&left(&study)) > 0.9 * LOST[1]);
    study.crossings = LOST.to_vec();
    let crossed = left(&study);
    assert!(crossed.len() > recording.time.len() && peak(&crossed) < 1e-9, "{}", peak(&crossed));
}

#[test]
fn a_play_is_crossed_as_far_as_it_goes_and_given_up_with_it() {
    let bench = Bench::of("XFY");
    let recording = circled(&bench);
    let known = bench.calibration("{EXX: [{backlash: {lost_motion: 9 um}}]}");
    let mut study = Study::new(bench.equations(), Some(&known), &[&recording]);
    let more = vec![at_once(&bench, 0, 0.002), at_once(&bench, 1, LOST[1])];
    // What is not crossed stays so.
    assert!(!follow(&mut study, &more) && !study.crosses());
    study.crossings = LOST.to_vec();
    assert!(follow(&mut study, &more));
    assert!(distance(&study.crossings, &[0.011, LOST[1]]) < 1e-12);
    // Within a hundredth it is the same.
    let nearly = vec![at_once(&bench, 0, 0.002_1), at_once(&bench, 1, LOST[1])];
    assert!(!follow(&mut study, &nearly));
    // A play that is no longer in the model is no longer crossed; nor is one that would be negative.
    assert!(follow(&mut study, &Model::new()));
    assert!(distance(&study.crossings, &[LOST[0], 0.0]) < 1e-12);
    assert!(follow(&mut study, &vec![at_once(&bench, 0, -0.02)]) && !study.crosses());
}

#[test]
fn only_plays_of_the_axis_itself_behind_the_drive_that_act_at_once_are_crossed() {
    let bench = Bench::of("XFY");
    let recording = circled(&bench);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let play = |fitted: Fitted| play(&study, &vec![fitted], 0);
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
    let trials = |model: &Model, always: usize| without_holds(&study, model, always, 0);
    let all = vec![spike.clone(), x.clone(), y.clone()];
    assert_eq!(trials(&all, 0), [all.clone(), vec![x.clone(), y.clone()], vec![y.clone()]]);
    assert_eq!(trials(&vec![wound.clone(), y.clone()], 0), [vec![wound, y.clone()], vec![y.clone()]]);
    // Settings that are always fitted stay, whatever they are; so does what holds another axis.
    assert_eq!(trials(&all, 1), [all.clone(), all.clone(), vec![spike.clone(), y.clone()]]);
    assert_eq!(without_holds(&study, &all, 0, 1), [all.clone(), all.clone(), vec![spike, x]]);
}

#[test]
fn nothing_is_tried_where_nothing_holds_an_axis() {
    let bench = Bench::of("XFY");
    let recording = circled(&bench);
    let known = bench.calibration("{EXX: [{backlash: {lost_motion: 9 um}}]}");
    let mut study = Study::new(bench.equations(), Some(&known), &[&recording]);
    let tries = Tries { candidates: 50.0, waves: 100.0 };
    let noises = vec![vec![Noise::white(1e-4); 2]];
    let travels = crate::travel::travels(&study, &crate::engine::courses(&study, &Model::new()));
    let conditions = Conditions { always: 0, noises: &noises, travels: &travels, tries };
    let model = vec![at_once(&bench, 1, LOST[1])];
    assert!(try_plays(&mut study, &model, &conditions).is_none());
    // With something that does, the known play explains what that seemed to.
    let spiked = vec![own(&bench, 0, Shape::ReversalSpike { axis: 0, decay: 0.05 }, 0.003), model[0].clone()];
    let chosen = try_plays(&mut study, &spiked, &conditions).unwrap();
    assert!(distance(&study.crossings, &[LOST[0], 0.0]) < 1e-12);
    assert_eq!(chosen.len(), 1);
    assert_eq!(crossing_only(&study, &chosen), [0]);
    assert!(crossing_only(&study, &spiked).is_empty());
}

#[test]
fn plays_that_are_known_and_found_are_one_way_to_cross() {
    let bench = Bench::of("XFY");
    let part = bench.calibration("{EXX: [{backlash: {lost_motion: 5 um}}]}");
    let whole = together(&part, &bench.calibration("{EXX: [{backlash: {lost_motion: 4 um}}]}"));
    let recording = circled(&bench);
    let study = Study::new(bench.equations(), Some(&whole), &[&recording]);
    assert!((play(&study, &Model::new(), 0) - LOST[0]).abs() < 1e-12);
    assert!((play(&study, &vec![at_once(&bench, 0, 0.001)], 0) - 0.010).abs() < 1e-12);
}
