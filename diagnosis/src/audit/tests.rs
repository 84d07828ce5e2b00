//! Laws of faults: what is changed and turned back is what was read; a column is what the exact machine does differently.

use model_dsl::calibration::{self, Calibration};
use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use simulation::Path;
use simulation::path::Shape;

use super::catalogue;
use super::changed::Changed;
use super::columns::Versions;
use super::fault::{Fault, Scope, TermAt};
use crate::course::Course;
use crate::model::Model;
use crate::observations;
use crate::recording::{PartDatum, Recording};
use crate::study::Study;
use crate::testing::*;
use crate::{Chains, Inputs};

/// Every kind of term that a fault may change, and motions that have none.
const ERRORS: &str = "{EXX: [{table: {axis: X, start: 0 mm, step: 100 mm, unit: um, values: [0, 9, -6, 12, 3, -8]}}, \
    {cyclic: {axis: X, period: 40 mm, amplitude: 2 um, phase: 30 deg}}], \
    EYX: [{table: {axis: X, start: 0 mm, step: 100 mm, unit: um, forward: [0, 4, -3, 8, 5, 1], reverse: [1, 6, -1, 9, 3, 2]}}], \
    EBX: [{polynomial: {axis: X, per: mm, unit: urad, coefficients: [0, 0.1, -2e-4]}}], \
    ECX: [{table: {axis: X, start: 0 mm, step: 100 mm, unit: urad, values: [0, -30, 40, 70, 20, -60]}}], \
    EYY: [{lag: {gain: 60 1/s}}, {backlash: {lost_motion: 4 um, inside_loop: true}}, {backlash: {lost_motion: 3 um}}, {expansion: {axis: Y, sensor: scale, coefficient: 8 um/m/K, reference: 20 degC}}], \
    EAY: [{table: {axis: Y, start: 0 mm, step: 100 mm, unit: urad, values: [0, 45, -35, 25]}}], \
    EZZ: [{growth: {sensor: head, coefficient: 3 um/K, reference: 20 degC}}], EC0Y: 60 urad}";

fn recorded(bench: &Bench, known: &Calibration) -> Recording {
    let corners = [(0, 480.0), (1, 280.0), (2, -10.0), (0, 20.0), (1, 20.0), (0, 300.0)];
    let start = vec![(0, 20.0), (1, 20.0), (2, -90.0)];
    let points = std::iter::once(start).chain(corners.map(|corner| vec![corner])).collect();
    let mut scenario = scenario(Path { runs: 2, ..path(Shape::Points(points), 50.0, 4.0) }, position("xyz"));
    scenario.temperatures = vec![warming("scale", 4.0, 60.0), warming("head", 9.0, 20.0)];
    // The machine itself was measured: what rotates all its points is its own.
    Recording { datum: PartDatum::Fixed, ..bench.record(known, &scenario) }
}

/// About one unit of a fault, so small that it is one.
fn amount(fault: &Fault) -> f64 {
    match fault {
        Fault::Shift { quarters, .. } => 25.0 * f64::from(*quarters),
        Fault::Size(_) | Fault::Scale { .. } => 0.25,
        _ => 1.0,
    }
}

/// The amount that takes back so much of a fault.
fn back(fault: &Fault, amount: f64) -> f64 {
    if fault.is_factor() {
        1.0 / (1.0 + amount) - 1.0
    } else if fault.is_whole() {
        amount
    } else {
        -amount
    }
}

/// Whether two calibrations have the same numbers, up to the last digits.
fn same(one: &Calibration, other: &Calibration) -> bool {
    let digits = |known: &Calibration| -> String {
        let mut known = known.clone();
        known.motions.sort_by_key(|listed| listed.motion);
        let numbers = known.motions.iter_mut().flat_map(|listed| &mut listed.terms);
        numbers.flat_map(|term| term.value.linear_mut()).for_each(|(_, numbers)| {
            numbers.iter_mut().for_each(|number| *number = (*number * 1e12).round());
        });
        format!(
            "{:?} {:?}",
            known.constants,
            known.motions.iter().map(|listed| (listed.motion, &listed.terms)).collect::<Vec<_>>()
        )
    };
    digits(one) == digits(other)
}

/// What a fault may change of a recording: its temperatures by name, in order.
fn readings(inputs: &Inputs<'_>) -> Vec<(String, Vec<f64>)> {
    let temperatures = inputs.recordings.iter().flat_map(|recording| &recording.temperatures);
    let mut all: Vec<_> =
        temperatures.map(|channel| (channel.name.clone(), channel.values.clone())).collect();
    all.sort_by(|one, other| one.0.cmp(&other.0));
    all
}

#[test]
fn what_is_changed_is_written_and_read_again() {
    let bench = Bench::of("FXYZ");
    let known = bench.calibration(ERRORS);
    let recording = recorded(&bench, &known);
    let inputs = bench.audited(&known, &recording);
    for fault in catalogue::faults(&inputs) {
        let changed = Changed::new(&inputs, &fault, amount(&fault)).unwrap();
        let with = changed.inputs(&inputs);
        let names = with.equations.names();
        let text = calibration::write(with.calibration.unwrap(), &names);
        let source = SourceFile::new("changed.yaml", text);
        let mut findings = Diagnostics::new();
        let tree = yaml::read(&source, &mut findings).unwrap();
        let read = calibration::read(&tree, &names, &mut findings);
        assert!(read.is_some(), "{fault:?}: {}", render(&source, &findings, false));
    }
}

#[test]
fn what_is_changed_and_turned_back_is_what_was_read() {
    let bench = Bench::of("FXYZ");
    let known = bench.calibration(ERRORS);
    let recording = recorded(&bench, &known);
    let inputs = bench.audited(&known, &recording);
    let faults = catalogue::faults(&inputs);
    assert!(faults.len() > 100, "{}", faults.len());
    for fault in faults {
        let changed = Changed::new(&inputs, &fault, amount(&fault)).unwrap();
        let with = changed.inputs(&inputs);
        let turned = fault.turned_back(Some("FXYZ"));
        let again = Changed::new(&with, &turned, back(&fault, amount(&fault))).unwrap();
        let again = again.inputs(&with);
        assert!(same(again.calibration.unwrap(), &known), "{fault:?}");
        assert_eq!(readings(&again), readings(&inputs), "{fault:?}");
        assert_eq!(again.equations.names(), bench.names, "{fault:?}");
        let other = !same(with.calibration.unwrap(), &known)
            || with.equations.names() != bench.names
            || readings(&with) != readings(&inputs);
        assert!(other, "{fault:?} changes nothing");
    }
}

#[test]
fn a_column_is_what_the_exact_machine_does_differently() {
    let bench = Bench::of("FXYZ");
    let known = bench.calibration(ERRORS);
    let recording = recorded(&bench, &known);
    let inputs = bench.audited(&known, &recording);
    let study = Study::new(inputs.equations, inputs.calibration, &inputs.recordings);
    let versions = Versions::new(&study, &Model::default(), &inputs, catalogue::faults(&inputs));
    assert!(versions.suspected.len() > 50, "{}", versions.suspected.len());
    let left = left(&inputs);
    for suspected in &versions.suspected {
        let amount = amount(&suspected.fault);
        let changed = Changed::new(&inputs, &suspected.fault, amount).unwrap();
        let other = self::left(&changed.inputs(&inputs));
        for channel in 0..3 {
            let each = versions.rows[0].iter().zip(&suspected.columns[0][channel]);
            let each: Vec<(f64, f64)> = each
                .map(|(row, column)| (amount * column, left[channel][*row] - other[channel][*row]))
                .filter(|(_, exact)| exact.is_finite())
                .collect();
            // What is the same in every row is a zero of the instrument.
            let zero = each[0].1 - each[0].0;
            let largest = each.iter().fold(0.0, |most: f64, (_, exact)| most.max(exact.abs()));
            for (column, exact) in &each {
                // Products of two errors: 100 urad of 100 urad over 500 mm.
                let away = (column + zero - exact).abs();
                assert!(away < 5e-6 + 1e-2 * largest, "{:?} {channel}: {column} {exact}", suspected.fault);
            }
        }
    }
}

/// What the exact machine leaves of every channel.
fn left(inputs: &Inputs<'_>) -> Vec<Vec<f64>> {
    let study = Study::new(inputs.equations, inputs.calibration, &inputs.recordings);
    let course = Course::new(&study, 0, &Model::default());
    observations::residuals(&study, 0, &Model::default(), &course)
}

#[test]
fn words_are_tried_in_every_order_or_with_neighbours_exchanged() {
    let bench = Bench::of("FXYZ");
    let known = bench.calibration(ERRORS);
    let recording = recorded(&bench, &known);
    let mut inputs = bench.audited(&known, &recording);
    let orders = |inputs: &Inputs<'_>| {
        let faults = catalogue::faults(inputs).into_iter();
        faults
            .filter_map(|fault| match fault {
                Fault::Order(word) => Some(word),
                _ => None,
            })
            .collect::<Vec<_>>()
    };
    let mut all = orders(&inputs);
    all.sort();
    all.dedup();
    assert_eq!(all.len(), 23);
    inputs.chains = Some(Chains { word: "CAFXYZ", ..inputs.chains.unwrap() });
    assert_eq!(orders(&inputs), ["ACFXYZ", "CFAXYZ", "CAXFYZ", "CAFYXZ", "CAFXZY"]);
    inputs.chains = None;
    assert!(orders(&inputs).is_empty());
    inputs.calibration = None;
    assert!(catalogue::faults(&inputs).is_empty());
}

#[test]
fn numbers_that_are_moved_out_of_sight_are_no_suspects() {
    let bench = Bench::of("FXYZ");
    let known = bench.calibration(
        "{EXX: [{table: {axis: X, start: 0 mm, step: 100 mm, unit: um, values: [0, 9, -6, 12, 3, -8]}}]}",
    );
    let mut recording = recorded(&bench, &known);
    // What moves Y and Z is not seen.
    recording.measured[1] = None;
    recording.measured[2] = None;
    let inputs = bench.audited(&known, &recording);
    let study = Study::new(inputs.equations, inputs.calibration, &inputs.recordings);
    let versions = Versions::new(&study, &Model::default(), &inputs, catalogue::faults(&inputs));
    let moved: Vec<&Fault> = versions
        .suspected
        .iter()
        .map(|suspected| &suspected.fault)
        .filter(|fault| matches!(fault, Fault::Moved { .. }))
        .collect();
    // Z stays beyond the nodes, where the curve is the same everywhere.
    let (from, to) = (bench.motion("EXX"), bench.motion("EXY"));
    assert_eq!(moved, [&Fault::Moved { from, to }]);
    let size = Fault::Size(Scope::Term(TermAt { motion: from, place: 0 }));
    assert!(versions.suspected.iter().any(|suspected| suspected.fault == size));
}
