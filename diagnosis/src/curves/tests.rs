//! Curves: nodes where something was observed, and a stage whose curve no polynomial follows.

use super::*;
use crate::conditions::Tries;
use crate::course::courses;
use crate::noise::Noise;
use crate::recording::Recording;
use crate::side::Side;
use crate::terms::Setting;
use crate::testing::{Bench, line, noisy, path, position, programmed};
use crate::weights::Weights;
use simulation::path::{Shape as PathShape, Stations, Stroke};

fn travel(low: f64, high: f64) -> Travel {
    Travel { low, high, step: 1.0, moves: true, between: 1.0, ..Travel::default() }
}

#[test]
fn stations_are_the_few_places_at_which_an_axis_stood() {
    // Five places, read three times each with 10 um between readings: a ten-thousandth of the travel.
    let places: Vec<f64> =
        (0..5).flat_map(|n| [0.0, 0.01, 0.02].map(|off| 25.0 * f64::from(n) + off)).collect();
    let found = at_few(&places, &travel(0.0, 100.02)).unwrap();
    assert_eq!(found, [0.0, 25.0, 50.0, 75.0, 100.0]);
    // Half a millimetre is another place.
    let mut more = places.clone();
    more.insert(3, 0.5);
    assert_eq!(at_few(&more, &travel(0.0, 100.02)).unwrap()[..3], [0.0, 0.5, 25.0]);
}

#[test]
fn too_few_places_and_too_many_are_no_stations() {
    let even = |count: usize| -> Vec<f64> { (0..count).map(crate::number).collect() };
    assert_eq!(at_few(&[], &travel(0.0, 1.0)), None);
    assert_eq!(at_few(&even(FEWEST_STATIONS - 1), &travel(0.0, 2.0)), None);
    assert_eq!(at_few(&even(FEWEST_STATIONS), &travel(0.0, 3.0)).unwrap(), even(FEWEST_STATIONS));
    assert_eq!(at_few(&even(MOST_STATIONS), &travel(0.0, 39.0)).unwrap(), even(MOST_STATIONS));
    assert_eq!(at_few(&even(MOST_STATIONS + 1), &travel(0.0, 40.0)), None);
}

#[test]
fn nodes_are_held_where_something_is_nearer_to_each_than_to_its_neighbours() {
    let nodes = [0.0, 10.0, 20.0, 30.0];
    assert!(held(&nodes, &[0.0, 10.0, 20.0, 30.0]));
    assert!(held(&nodes, &[4.0, 6.0, 24.0, 26.0]));
    assert!(!held(&nodes, &[4.0, 6.0, 14.0, 24.0]), "nothing near 30");
    assert!(!held(&nodes, &[6.0, 14.0, 20.0, 30.0]), "nothing near 0");
    assert!(!held(&nodes, &[0.0, 1.0, 2.0, 20.0, 30.0]), "nothing near 10");
    assert!(!held(&nodes, &[]));
}

/// The nodes of the tables that are tried for a stage X at these places, one row each.
fn nodes(places: &[f64]) -> Vec<Vec<f64>> {
    let bench = Bench::of("FX");
    let time: Vec<f64> = (0..places.len()).map(crate::number).collect();
    let mut recording = programmed(&time, &[places.to_vec()]);
    recording.measured[0] = Some(places.to_vec());
    of_recording(&bench, &recording)
}

fn of_recording(bench: &Bench, recording: &Recording) -> Vec<Vec<f64>> {
    let study = Study::new(bench.equations(), None, &[recording]);
    let travels = crate::travel::travels(&study, &courses(&study, &Model::default()));
    let nodes = |shape: Shape| match shape {
        Shape::Table { axis: 0, nodes, directed: false, repeats: false } => nodes,
        other => panic!("{other:?}"),
    };
    tables(&study, 0, &travels[0]).into_iter().map(nodes).collect()
}

#[test]
fn a_stage_that_stops_has_its_nodes_where_it_stops() {
    let stops = [-30.0, 0.0, 10.0, 50.0, 90.0];
    let way: Vec<f64> = stops.iter().chain(stops.iter().rev()).flat_map(|stop| [*stop; 3]).collect();
    assert_eq!(nodes(&way), [stops]);
}

#[test]
fn a_stage_that_is_read_on_its_way_has_its_nodes_at_equal_steps_over_the_travel() {
    let there = (-100..=100).map(f64::from);
    let way: Vec<f64> = there.clone().chain(there.rev()).collect();
    let found = nodes(&way);
    assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), NODES);
    for nodes in found {
        assert_eq!((nodes[0], nodes[nodes.len() - 1]), (-100.0, 100.0));
        let step = 200.0 / crate::number(nodes.len() - 1);
        assert!(nodes.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() < 1e-9), "{nodes:?}");
    }
}

/// On one way, each place is in one block, of 17 rows or 17 mm: those around a node of twenty, 10.5 mm, may all be held out.
#[test]
fn no_node_stands_where_all_that_was_observed_is_held_out() {
    let way: Vec<f64> = (-100..=100).map(f64::from).collect();
    assert_eq!(nodes(&way).iter().map(Vec::len).collect::<Vec<_>>(), [8, 12]);
}

#[test]
fn no_node_stands_where_nothing_was_observed() {
    // The nodes around 37 mm reach from 32 to 41 where there are twelve, from 34 to 40 where there are twenty.
    let all = || (0..=200).map(|row| 0.5 * f64::from(row));
    for (unseen, expected) in [(33.0..40.0, vec![8, 12]), (30.0..48.0, vec![8])] {
        let way: Vec<f64> = all().filter(|place| !unseen.contains(place)).collect();
        assert_eq!(nodes(&way).iter().map(Vec::len).collect::<Vec<_>>(), expected);
        // The same way, with readings that are not there.
        let bench = Bench::of("FX");
        let places: Vec<f64> = all().collect();
        let time: Vec<f64> = (0..places.len()).map(crate::number).collect();
        let mut recording = programmed(&time, std::slice::from_ref(&places));
        let read = |place: &f64| if unseen.contains(place) { f64::NAN } else { *place };
        recording.measured[0] = Some(places.iter().map(read).collect());
        assert_eq!(of_recording(&bench, &recording), nodes(&way));
    }
    // Three stations are too few for a curve.
    assert!(nodes(&[0.0, 50.0, 100.0].repeat(20)).is_empty());
}

fn table(nodes: &[f64], directed: bool, coefficients: &[f64]) -> Fitted {
    let shape = Shape::Table { axis: 0, nodes: nodes.to_vec(), directed, repeats: false };
    let place = Place::Motion { motion: 0, side: Side::After };
    Fitted { effect: Effect { place, shape }, coefficients: coefficients.to_vec() }
}

#[test]
fn a_table_is_active_from_the_last_quiet_node_to_the_next() {
    let nodes = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0];
    // On whatever height it lies.
    for height in [0.0, 7.0] {
        let at = |values: [f64; 6]| active(&table(&nodes, false, &values.map(|value| value + height)));
        assert_eq!(at([0.0, 0.0, 5.0, -4.0, 0.0, 0.0]), Some((10.0, 40.0)));
        assert_eq!(at([0.0, 0.0, 0.0, 5.0, 0.5, 0.0]), Some((20.0, 40.0)), "a tenth is quiet");
        assert_eq!(at([5.0, 0.0, 0.0, 0.0, 0.0, 0.0]), Some((0.0, 10.0)));
        assert_eq!(at([0.0, 0.0, 0.0, 0.0, 0.0, 5.0]), Some((40.0, 50.0)));
        assert_eq!(at([5.0, 0.0, 0.0, 0.0, 0.0, 5.0]), Some((0.0, 50.0)));
    }
}

#[test]
fn a_table_by_direction_is_active_where_one_direction_is() {
    let nodes = [0.0, 10.0, 20.0, 30.0, 40.0];
    let backward = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0];
    assert_eq!(active(&table(&nodes, true, &backward)), Some((10.0, 30.0)));
    let both = [0.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0];
    assert_eq!(active(&table(&nodes, true, &both)), Some((0.0, 30.0)));
}

#[test]
fn what_is_no_table_is_not_active_anywhere() {
    let place = Place::Motion { motion: 0, side: Side::After };
    let effect = Effect { place, shape: Shape::Constant };
    assert_eq!(active(&Fitted { effect, coefficients: vec![1.0] }), None);
    assert_eq!(active(&table(&[], false, &[])), None);
}

/// White noise, mm, and how often a run goes to and fro.
const NOISE: f64 = 2e-4;
const RUNS: u32 = 4;

/// A stage X that stops at stations over 320 mm there and back.
fn stepped(bench: &Bench, errors: &str, count: u32) -> Recording {
    let stations = Stations { count, dwell: 1.0, readings: 2 };
    let strokes = vec![Stroke { axis: 0, from: 0.0, to: 320.0 }];
    let shape = PathShape::Line { strokes, back: true, overrun: 0.0, stations: Some(stations) };
    let mut way = path(shape, 50.0, 20.0);
    way.runs = RUNS;
    bench.record(&bench.calibration(errors), &noisy(way, position("x"), NOISE, 21))
}

/// What stands in the place of a polynomial of this degree: the model after the zero of the instrument, and both costs.
fn tried(bench: &Bench, recording: &Recording, degrees: &[usize]) -> (Model, [f64; 2]) {
    let study = Study::new(bench.equations(), None, &[recording]);
    let place = Place::Motion { motion: bench.motion("EXX"), side: Side::After };
    let zero = Effect::setting(0, Setting::Offset { channel: 0 });
    let mut model = Model::of_settings([zero]);
    for degree in degrees {
        let shape = Shape::Polynomial { axis: 0, degree: *degree, center: 160.0, scale: 160.0 };
        model.effects.push(Fitted { effect: Effect { place, shape }, coefficients: vec![0.0; degree + 1] });
    }
    let travels = crate::travel::travels(&study, &courses(&study, &model));
    let weights = Weights::of_all(&study, vec![vec![Noise::white(NOISE)]]);
    let tries = Tries { candidates: 40.0, waves: 40.0 };
    let conditions = Conditions { weights: &weights, travels: &travels, tries };
    let before = conditions.refine(&study, model);
    let costs = conditions.cost(&study, &before);
    let after = try_tables(&study, before, &conditions);
    let costs = [costs, conditions.cost(&study, &after)];
    (after.model.without(0), costs)
}

/// Values less their mean: the zero of the instrument is free.
fn about_mean(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / crate::number(values.len());
    values.iter().map(|value| value - mean).collect()
}

/// The mean error that was read at a station in all runs but the last, and how often. Which way the stage came to the later
/// readings at an end is not recorded; they are left out.
fn mean_error(recording: &Recording, station: f64) -> (f64, f64) {
    let command = recording.axes[0].command.as_ref().unwrap();
    let measured = recording.measured[0].as_ref().unwrap();
    let here = |row: &usize| (command[*row] - station).abs() < 1e-6 && recording.run[*row] != i64::from(RUNS);
    let unseen = crate::states::unseen_turns(&vec![0; command.len()], command);
    let rows: Vec<usize> = (0..command.len()).filter(here).filter(|row| !unseen[*row]).collect();
    let sum: f64 = rows.iter().map(|row| measured[*row] - command[*row]).sum();
    (sum / crate::number(rows.len()), crate::number(rows.len()))
}

#[test]
fn a_curve_that_no_cubic_follows_is_a_table_at_the_stations() {
    let truth = [0.0, 3.0, -2.0, 4.0, 1.0, -3.0, 2.0, -1.0, 3.0];
    let bench = Bench::of("FX");
    let errors = "{EXX: [{table: {axis: X, start: 0 mm, step: 40 mm, unit: um, values: [0, 3, -2, 4, 1, -3, 2, -1, 3]}}]}";
    let recording = stepped(&bench, errors, 9);
    let (model, [before, after]) = tried(&bench, &recording, &[3]);
    let [fitted] = model.effects.as_slice() else { panic!("{model:?}") };
    let Shape::Table { axis: 0, nodes, directed: false, repeats: false } = &fitted.effect.shape else {
        panic!("{fitted:?}")
    };
    let stations: Vec<f64> = (0..9).map(|n| 40.0 * f64::from(n)).collect();
    assert!(nodes.iter().zip(&stations).all(|(a, b)| (a - b).abs() < 1e-9) && nodes.len() == 9, "{nodes:?}");
    assert_eq!(fitted.effect.motion(), Some(bench.motion("EXX")));
    // By hand: the mean of what is fitted at each station, which is all but the last run.
    let means: Vec<(f64, f64)> = stations.iter().map(|station| mean_error(&recording, *station)).collect();
    let errors: Vec<f64> = means.iter().map(|(mean, _)| *mean).collect();
    let found = about_mean(&fitted.coefficients);
    for (station, (found, mean)) in found.iter().zip(about_mean(&errors)).enumerate() {
        assert!((found - mean).abs() < 1e-7, "station {station}: {found} {mean}");
    }
    for ((found, truth), (_, readings)) in found.iter().zip(about_mean(&truth)).zip(means) {
        assert!((found - 1e-3 * truth).abs() < 5.0 * NOISE / readings.sqrt(), "{found} {truth}");
    }
    assert!(after < before, "{before} {after}");
}

#[test]
fn a_cubic_stays_a_cubic() {
    let bench = Bench::of("FX");
    let errors =
        "{EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 0.06, -6e-4, 1.4e-6]}}]}";
    for count in [9, 30] {
        let (model, [before, after]) = tried(&bench, &stepped(&bench, errors, count), &[3]);
        let [fitted] = model.effects.as_slice() else { panic!("{model:?}") };
        assert!(matches!(fitted.effect.shape, Shape::Polynomial { degree: 3, .. }), "{fitted:?}");
        assert_eq!(before, after);
    }
}

#[test]
fn a_curve_read_on_the_way_takes_as_few_nodes_as_say_it() {
    // Bends at eight places: twelve nodes and twenty miss them.
    let bench = Bench::of("FX");
    let errors = "{EXX: [{table: {axis: X, start: 0 mm, step: 40 mm, unit: um, values: [0, 3, -2, 4, 1, -3, 2, -1]}}]}";
    let mut way = path(line(0, 0.0, 280.0), 50.0, 10.0);
    way.runs = RUNS;
    let recording = bench.record(&bench.calibration(errors), &noisy(way, position("x"), NOISE, 22));
    let (model, _) = tried(&bench, &recording, &[3]);
    let [fitted] = model.effects.as_slice() else { panic!("{model:?}") };
    let Shape::Table { nodes, .. } = &fitted.effect.shape else { panic!("{fitted:?}") };
    assert_eq!(nodes.len(), 8);
    let truth = [0.0, 3.0, -2.0, 4.0, 1.0, -3.0, 2.0, -1.0];
    for (found, truth) in about_mean(&fitted.coefficients).iter().zip(about_mean(&truth)) {
        assert!((found - 1e-3 * truth).abs() < NOISE, "{found} {truth}");
    }
}

#[test]
fn one_parabola_is_not_even_tried_and_a_bump_at_one_place_is_no_curve() {
    let bench = Bench::of("FX");
    let errors = "{EXX: [{table: {axis: X, start: 0 mm, step: 40 mm, unit: um, values: [0, 0, 0, 9, 0, 0, 0, 0, 0]}}]}";
    let recording = stepped(&bench, errors, 9);
    // A parabola is what it is; only two smooth terms or a higher power ask for a table.
    let (model, [before, after]) = tried(&bench, &recording, &[2]);
    assert!(matches!(model.effects[0].effect.shape, Shape::Polynomial { degree: 2, .. }) && before == after);
    // From 80 to 160 mm of 320: that is a place, and the cubic that stood for it goes.
    let (model, _) = tried(&bench, &recording, &[3]);
    assert!(model.effects.is_empty(), "{model:?}");
}

#[test]
fn waves_that_are_long_are_part_of_a_curve_and_short_ones_are_not() {
    let travels = [travel(0.0, 100.0), travel(0.0, 10.0)];
    let place = Place::Motion { motion: 0, side: Side::After };
    let smooth = |shape: Shape| smooth(&Effect { place, shape }, &travels);
    assert_eq!(smooth(Shape::Cyclic { axis: 0, period: 40.0, order: 1, center: 0.0 }), Some(0));
    assert_eq!(smooth(Shape::Cyclic { axis: 0, period: 4.0, order: 1, center: 0.0 }), None);
    assert_eq!(smooth(Shape::Cyclic { axis: 1, period: 4.0, order: 1, center: 0.0 }), Some(1));
    assert_eq!(smooth(Shape::Polynomial { axis: 1, degree: 2, center: 5.0, scale: 5.0 }), Some(1));
    assert_eq!(smooth(Shape::Backlash { axis: 0, wind_up: 0.0 }), None);
    assert_eq!(smooth(Shape::Vibration { frequency: 1.0 }), None);
}

#[test]
fn a_table_with_nodes_at_one_place_is_active_there_alone() {
    // Most of the nodes lie on the dent, and most of the travel beside it.
    let nodes = vec![0.0, 100.0, 104.0, 108.0, 112.0, 116.0, 300.0];
    let shape = Shape::Table { axis: 0, nodes, directed: false, repeats: false };
    let place = Place::Motion { motion: 0, side: Side::After };
    let coefficients = vec![0.002, 0.002, 0.007, 0.012, 0.007, 0.002, 0.002];
    let table = Fitted { effect: Effect { place, shape }, coefficients };
    assert_eq!(active(&table), Some((100.0, 116.0)));
}

fn vibrating(motion: usize, frequency: f64, amplitude: f64) -> Fitted {
    let effect =
        Effect { place: Place::Motion { motion, side: Side::After }, shape: Shape::Vibration { frequency } };
    Fitted { effect, coefficients: vec![amplitude, 0.0] }
}

#[test]
fn vibrations_in_multiples_of_one_are_pulses_unless_one_stands_out() {
    let model = |teeth: &[(f64, f64)]| -> Model {
        let teeth = teeth.iter().map(|(frequency, amplitude)| vibrating(0, *frequency, *amplitude));
        Model::of(teeth).with(vibrating(1, 3.0, 1e-3))
    };
    let comb = [(1.01, 1e-3), (2.0, 0.9e-3), (3.02, 1.1e-3), (4.97, 0.8e-3)];
    // What else vibrates in that motion goes with them, another motion keeps its own.
    let mut more = comb.to_vec();
    more.push((7.4, 1e-3));
    assert_eq!(without_combs(&model(&more)), Some(model(&[])));
    // A rotation and its harmonics, and frequencies that have nothing to do with each other.
    let turning = [(1.01, 5e-3), (2.0, 0.9e-3), (3.02, 1.1e-3), (4.97, 0.8e-3)];
    let apart = [(1.0, 1e-3), (1.43, 0.9e-3), (3.33, 1.1e-3), (4.71, 0.8e-3)];
    assert_eq!(without_combs(&model(&turning)), None);
    assert_eq!(without_combs(&model(&apart)), None);
    assert_eq!(without_combs(&model(&comb[..3])), None);
}

#[test]
fn waves_along_an_axis_are_kept_in_multiples_too() {
    let wave = |period: f64| Fitted {
        effect: Effect {
            place: Place::Motion { motion: 0, side: Side::After },
            shape: Shape::Cyclic { axis: 0, period, order: 1, center: 0.0 },
        },
        coefficients: vec![1e-3, 0.0],
    };
    let model = Model::of([10.0, 5.0, 2.5, 1.25, 1.0].map(wave));
    assert_eq!(without_combs(&model), None);
}
