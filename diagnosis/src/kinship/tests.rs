//! What a recording shows alike stands in one group; what it tells apart does not.

use super::*;
use crate::model::Place;
use crate::recording::Recording;
use crate::side::Side;
use crate::terms::Shape;
use crate::testing::{Bench, circle, line, path, position, scenario};
use simulation::path::Shape as PathShape;

fn recorded(bench: &Bench, shape: PathShape, directions: &str, heights: &[f64]) -> Recording {
    let mut scenario = scenario(path(shape, 30.0, 5.0), position(directions));
    scenario.path.at = vec![vec![200.0], vec![120.0], heights.to_vec()];
    scenario.path.runs = u32::try_from(heights.len()).unwrap();
    bench.record(&bench.calibration("{}"), &scenario)
}

/// The groups of these effects, by their names and shapes.
fn grouped(
    bench: &Bench,
    recording: &Recording,
    effects: &[(&str, Shape)],
) -> Vec<Vec<(String, &'static str)>> {
    let study = Study::new(bench.equations(), None, &[recording]);
    let courses = [Course::new(&study, 0, &Model::default())];
    let noises = vec![vec![
        Noise { white: 1e-3, wander: 0.0, time_constant: 1.0, alike: 1.0 };
        study.scenes[0].channels.len()
    ]];
    let effect = |(name, shape): &(&str, Shape)| Effect {
        place: Place::Motion { motion: bench.motion(name), side: Side::After },
        shape: shape.clone(),
    };
    let found = groups(&study, &courses, &noises, effects.iter().map(effect).collect());
    let named =
        |effect: &Effect| (bench.names.motions[effect.motion().unwrap()].name.clone(), effect.shape.name());
    let members = |kin: &Kin| std::iter::once(&kin.effect).chain(&kin.equals).map(named).collect::<Vec<_>>();
    let mut found: Vec<Vec<_>> = found.iter().map(members).collect();
    found.iter_mut().for_each(|group| group.sort());
    found.sort();
    found
}

fn names<'g>(group: &'g [(String, &'static str)]) -> Vec<&'g str> {
    group.iter().map(|(name, _)| name.as_str()).collect()
}

#[test]
fn at_one_point_a_vibration_in_y_is_that_of_any_link() {
    let bench = Bench::of("XYFZ");
    let recording = recorded(&bench, PathShape::Still { time: 60.0 }, "xyz", &[-50.0]);
    let shape = Shape::Vibration { frequency: 1.7 };
    let effects = ["EYX", "EYY", "EYZ", "EXX", "EXY", "EZZ"].map(|name| (name, shape.clone()));
    let groups = grouped(&bench, &recording, &effects);
    let groups: Vec<Vec<&str>> = groups.iter().map(|group| names(group)).collect();
    assert_eq!(groups, [vec!["EXX", "EXY"], vec!["EYX", "EYY", "EYZ"], vec!["EZZ"]]);
}

#[test]
fn a_squareness_is_a_guide_that_leans_and_no_yaw() {
    let bench = Bench::of("XYFZ");
    let linear = Shape::Polynomial { axis: 1, degree: 1, center: 120.0, scale: 60.0 };
    let bent = Shape::Polynomial { axis: 1, degree: 2, center: 120.0, scale: 60.0 };
    let effects = [
        ("EC0Y", Shape::Constant),
        ("EXY", linear.clone()),
        ("EXY", bent),
        ("EYY", linear.clone()),
        ("ECY", linear),
    ];
    for shape in [circle(60.0), line(1, 40.0, 200.0)] {
        let recording = recorded(&bench, shape, "xy", &[-50.0]);
        let groups = grouped(&bench, &recording, &effects);
        let of_squareness = groups.iter().find(|group| names(group).contains(&"EC0Y")).unwrap();
        assert_eq!(
            of_squareness.as_slice(),
            [("EC0Y".to_owned(), "constant"), ("EXY".to_owned(), "polynomial")]
        );
    }
    // The simplest of the group stands for it.
    let recording = recorded(&bench, circle(60.0), "xy", &[-50.0]);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let noises = vec![vec![Noise { white: 1e-3, wander: 0.0, time_constant: 1.0, alike: 1.0 }; 2]];
    let linear = Shape::Polynomial { axis: 1, degree: 1, center: 120.0, scale: 60.0 };
    let place = |name: &str| Place::Motion { motion: bench.motion(name), side: Side::After };
    let effects = vec![
        Effect { place: place("EXY"), shape: linear },
        Effect { place: place("EC0Y"), shape: Shape::Constant },
    ];
    let kin = groups_of(&study, &noises, effects);
    assert_eq!((kin.len(), kin[0].effect.shape.name(), kin[0].equals.len()), (1, "constant", 1));
}

fn groups_of(study: &Study<'_>, noises: &[Vec<Noise>], effects: Vec<Effect>) -> Vec<Kin> {
    groups(study, &[Course::new(study, 0, &Model::default())], noises, effects)
}

#[test]
fn one_height_leaves_a_pitch_and_a_position_alike_and_two_heights_do_not() {
    let bench = Bench::of("XYFZ");
    let play = Shape::Backlash { axis: 0, wind_up: 0.0 };
    let effects = [("EXX", play.clone()), ("EBX", play)];
    let one = grouped(&bench, &recorded(&bench, line(0, 0.0, 300.0), "x", &[-50.0]), &effects);
    assert_eq!(one.len(), 1);
    let two = grouped(&bench, &recorded(&bench, line(0, 0.0, 300.0), "x", &[-80.0, -20.0]), &effects);
    assert_eq!(two.len(), 2);
}

#[test]
fn what_nothing_shows_is_left_out() {
    let bench = Bench::of("XYFZ");
    let recording = recorded(&bench, line(0, 0.0, 300.0), "x", &[-50.0]);
    let unseen = [
        ("EYX", Shape::Backlash { axis: 0, wind_up: 0.0 }),
        // A constant is no more than the free zero of the channel.
        ("EXX", Shape::Constant),
        // An axis that stands still has no squareness to show.
        ("EC0Y", Shape::Constant),
    ];
    assert!(grouped(&bench, &recording, &unseen).is_empty());
}
