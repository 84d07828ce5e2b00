//! Where the ends of a table may lie.

use super::*;
use crate::curves::even;
use crate::noise::Noise;
use crate::recording::Recording;
use crate::side::Side;
use crate::terms::Setting;
use crate::testing::{Bench, programmed};

#[test]
fn a_table_ends_at_nodes_at_which_something_is_fitted() {
    let nodes = [0.0, 10.0, 20.0, 30.0, 50.0];
    let cut = |places: &[f64]| within(nodes.to_vec(), places);
    assert_eq!(cut(&[0.0, 12.0, 50.0]), nodes);
    assert_eq!(cut(&[5.0, 12.0, 40.0]), nodes, "half of the way to the next node");
    assert_eq!(cut(&[6.0, 39.0]), nodes[1..4], "nearer to the next nodes");
    assert_eq!(cut(&[18.0, 22.0]), [20.0], "in the middle alone");
    assert_eq!(cut(&[]).len(), 1);
}

/// A stage X at these places, one row each, which is off by a curve of 5 um.
fn curved(places: &[f64]) -> Recording {
    let time: Vec<f64> = (0..places.len()).map(crate::number).collect();
    let mut recording = programmed(&time, &[places.to_vec()]);
    recording.measured[0] = Some(places.iter().map(|place| place + 5e-3 * (place / 15.0).sin()).collect());
    recording
}

#[test]
fn a_thinned_table_ends_before_a_place_that_only_a_held_out_row_knows() {
    let bench = Bench::of("FX");
    // Places from 0 to 100 mm in no order. One row that is held out is then moved to 140 mm.
    let mut places: Vec<f64> = (0..101).map(|row| crate::number(row * 37 % 101)).collect();
    let recording = curved(&places);
    let before = Study::new(bench.equations(), None, &[&recording]);
    let held_out = before.scenes[0].fitted_rows().iter().position(|fitted| !fitted).unwrap();
    places[held_out] = 140.0;
    let recording = curved(&places);
    let study = Study::new(bench.equations(), None, &[&recording]);
    assert!(!study.scenes[0].fitted_rows()[held_out]);

    let place = Place::Motion { motion: bench.motion("EXX"), side: Side::After };
    let zero = Model::of_settings([Effect::setting(0, Setting::Offset { channel: 0 })]);
    let weights = Weights::of_all(&study, vec![vec![Noise::white(1e-4)]]);
    let table = thinned(&study, &zero, (place, 0), &even(0.0, 140.0, 15), &weights);
    let Some(Shape::Table { nodes, .. }) = table else { panic!("{table:?}") };
    assert_eq!((nodes[0], nodes[nodes.len() - 1]), (0.0, 100.0), "{nodes:?}");
}
