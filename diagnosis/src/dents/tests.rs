//! Which dents are seen beside what hides them, and what is none.

use super::*;
use crate::conditions::Tries;
use crate::engine::courses;
use crate::terms::Setting;
use crate::testing::{Bench, line, noisy, path, position};
use crate::travel::travels;

/// The nodes of the table with which a search of a machine with these errors of X would begin anew. X goes 200 mm there and back, once.
fn begun(errors: &str) -> Option<Vec<f64>> {
    let bench = Bench::of("FX");
    let there_and_back = path(line(0, 0.0, 200.0), 20.0, 50.0);
    let truth = bench.calibration(errors);
    let recording = bench.record(&truth, &noisy(there_and_back, position("x"), 0.000_3, 5));
    let study = Study::new(bench.equations(), None, std::slice::from_ref(&&recording));
    let zero = Effect::setting(0, Setting::Offset { channel: 0 });
    let model = vec![Fitted { effect: zero, coefficients: vec![0.0] }];
    let travels = travels(&study, &courses(&study, &model));
    let noises = vec![vec![Noise::white(0.000_3)]];
    let tries = Tries { candidates: 40.0, waves: 300.0 };
    let conditions = Conditions { always: 1, noises: &noises, travels: &travels, tries };
    let (dent, beside) = hidden(&study, &model, &conditions).pop()?;
    match dent.added(&study, beside, &conditions).pop()?.effect.shape {
        Shape::Table { nodes, .. } => Some(nodes),
        _ => None,
    }
}

/// A play that is taken up over 80 mm hides most of what else there is.
const PLAY: &str = "{backlash: {lost_motion: 30 um, wind_up: 80 mm}}";

#[test]
fn a_dent_is_seen_beside_a_play_that_hides_it() {
    let dent = "{table: {start: 105 mm, step: 15 mm, unit: um, values: [0, 40, 0]}}";
    let nodes = begun(&format!("{{EXX: [{dent}, {PLAY}]}}")).unwrap();
    let (from, to) = (nodes[1], nodes[nodes.len() - 2]);
    assert!((80.0..110.0).contains(&from) && (130.0..160.0).contains(&to), "{nodes:?}");
    // Beside it, to both ends of the travel, the table is straight.
    assert!(nodes[0] < 1.0 && nodes[nodes.len() - 1] > 199.0, "{nodes:?}");
}

#[test]
fn what_stands_out_on_one_way_alone_is_no_dent() {
    let one_way = "{table: {start: 105 mm, step: 15 mm, unit: um, forward: [0, 40, 0], reverse: [0, 0, 0]}}";
    assert_eq!(begun(&format!("{{EXX: [{one_way}, {PLAY}]}}")), None);
    let turned = "{table: {start: 105 mm, step: 15 mm, unit: um, forward: [0, 40, 0], reverse: [0, -40, 0]}}";
    assert_eq!(begun(&format!("{{EXX: [{turned}, {PLAY}]}}")), None);
}

#[test]
fn a_play_alone_hides_no_dent() {
    assert_eq!(begun(&format!("{{EXX: [{PLAY}]}}")), None);
}
