//! How far plays are crossed, and which are tried.

use super::*;
use crate::conditions::Tries;
use crate::model::Fitted;
use crate::noise::Noise;
use crate::recording::Recording;
use crate::testing::{Bench, circle, distance, noisy, path, peak, position, together};
use crate::weights::Weights;
use crate::words;
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
    ways.into_iter().enumerate().for_each(|(axis, way)| model.cross(axis, Crossing::over(way)));
    model
}

/// The ways over which the first axes of a model cross their plays; 0 where they act at once.
fn ways(model: &Model) -> [f64; 2] {
    [0, 1].map(|axis| match model.crossing(axis) {
        Crossing::Over(way) => way,
        Crossing::AtOnce => 0.0,
        Crossing::After(way) => panic!("it comes after {way}"),
    })
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
    let travels = crate::travel::travels(&study, &crate::course::courses(&study, &Model::default()));
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
    assert!(crossing_only(&spiked.moving_as(&chosen)).is_empty());
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

/// A slow circle of a machine whose X loses motion so far back after each reversal, mm, all at once.
fn circled_late(bench: &Bench, way: f64) -> Recording {
    let scenario = noisy(path(circle(90.0), 20.0, 100.0), position("xy"), 0.0002, 1);
    let mut recording = bench.record(&bench.calibration("{}"), &scenario);
    let lost = bench.record(&bench.calibration("{EXX: [{backlash: {lost_motion: 9 um}}]}"), &scenario);
    let command = recording.axes[0].command.clone().unwrap();
    // Which way it goes, and how far it came that way.
    let (mut direction, mut furthest) = (1.0, command[0]);
    let turned: Vec<f64> = command
        .iter()
        .map(|place| {
            if direction * (furthest - place) > way {
                direction = -direction;
                furthest = *place;
            }
            if direction * (place - furthest) > 0.0 {
                furthest = *place;
            }
            direction
        })
        .collect();
    let (read, shifted) = (recording.measured[0].as_mut().unwrap(), lost.measured[0].as_ref().unwrap());
    // Both have turned at the end.
    let half = (shifted[read.len() - 1] - read[read.len() - 1]) / turned[read.len() - 1];
    read.iter_mut().zip(turned).for_each(|(read, direction)| *read += half * direction);
    recording
}

#[test]
fn a_play_that_comes_late_is_told_from_one_that_is_crossed() {
    let bench = Bench::of("XFY");
    let tries = Tries { candidates: 50.0, waves: 100.0 };
    for way in [0.05, 0.4, 2.0] {
        let recording = circled_late(&bench, way);
        let study = Study::new(bench.equations(), None, &[&recording]);
        let weights = Weights::of_all(&study, vec![vec![Noise::white(2e-4); 2]]);
        let travels = crate::travel::travels(&study, &crate::course::courses(&study, &Model::default()));
        let conditions = Conditions { weights: &weights, travels: &travels, tries };
        let spike = own(&bench, 0, Shape::ReversalSpike { axis: 0, decay: 0.05 }, 0.003);
        let spiked = Model::of([spike, at_once(&bench, 0, 0.005)]);
        let chosen = try_plays(&study, &spiked, &conditions).unwrap();
        let Crossing::After(found) = chosen.crossing(0) else { panic!("{way}: {:?}", chosen.crossing(0)) };
        // Between two rows the axis goes so far there.
        let step = (2.0 * 90.0 * way).sqrt() * 20.0 / 100.0 / 90.0;
        assert!((found - way).abs() < step + 0.01 * way, "{way}: {found}");
        assert_eq!(chosen.effects.len(), 1, "{way}: the spike stays");
        assert!((chosen.effects[0].coefficients[0] - LOST[0]).abs() < 5e-5, "{way}: {:?}", chosen.effects);
        assert_eq!(crossing_only(&chosen), [0]);
        let detail = words::location(&study, &chosen, &chosen.effects[0], &[]).detail;
        assert_eq!(detail, format!("jumps {found:.3} mm after every reversal of x"));
        // It goes with the last jump of the axis.
        let mut none = chosen.with_effects([]);
        assert!(follow(&study, &mut none) && !none.crosses());
        let mut same = chosen.clone();
        assert!(!follow(&study, &mut same) && same == chosen);
    }
}

#[test]
fn a_way_that_is_a_parameter_has_its_price() {
    let mut model = Model::default();
    model.cross(0, Crossing::Over(0.01));
    assert_eq!(price(&model, 1000.0), 0.0);
    model.cross(1, Crossing::After(0.01));
    assert!((price(&model, 1000.0) - 1000.0_f64.ln() - VERY_STRONG).abs() < 1e-12);
}

#[test]
fn the_golden_section_finds_the_valley() {
    for place in [-1.9, -0.3, 0.0, 1.2, 1.99] {
        let found = golden_section(-2.0, 2.0, |at| (at - place).abs());
        assert!((found - place).abs() < 0.02, "{place}: {found}");
    }
}
