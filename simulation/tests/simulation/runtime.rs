//! The terms against the runtime's: two readings of the same page, which must agree where both know the term.

use abbe_runtime::{Direction, ErrorMotion, Sample, TermState};
use abbe_simulation::Commands;

use crate::common::Built;

const ERRORS: &str = "{EXX: [{constant: {value: 3 um}}, {polynomial: {per: mm, unit: um, coefficients: [1, 0.02, -3e-5]}}, {cyclic: {period: 10 mm, amplitude: 2 um, phase: 1 rad}}, {backlash: {lost_motion: 8 um}}, {expansion: {sensor: scale, coefficient: 9 um/m/K, reference: 20 degC}}], EYX: [{table: {start: 0 mm, step: 40 mm, unit: um, forward: [1, 5, -2], reverse: [0, 4, 7]}}, {backlash: {lost_motion: 4 um, wind_up: 30 mm}}, {growth: {sensor: scale, coefficient: 2 um/K, reference: 21 degC}}], EZX: [{table: {at: [-20 mm, 3 mm, 50 mm], unit: um, values: [1, -5, 2]}}, {coupling: {axis: Y, per: mm, unit: um, coefficients: [0.01, 2e-4]}}, {polynomial: {sensor: both, unit: um, coefficients: [-3, 0.2]}}]}";

/// Each factor that the runtime has and that remembers nothing of time, on terms of several kinds.
const TIMES: &str = "{EXX: [{backlash: {lost_motion: 10 nm/mm, times: [{position: X, within: [0 mm, 50 mm]}]}}, {cyclic: {period: 10 mm, amplitude: 2 um, phase: 1 rad, times: [{direction: Y}]}}, {product: {value: 2 um.s/mm, times: [{velocity: X}, {turn: Y, period: 70 mm, phase: 20 deg}]}}], EYX: [{table: {start: 0 mm, step: 40 mm, unit: um/K, forward: [1, 5, -2], reverse: [0, 4, 7], times: [{temperature: scale, reference: 20 degC, within: [22 degC, 25 degC]}]}}, {lag: {gain: 400 mm/mm/s, axis: X, times: [{fading: Y, over: 30 mm/s}]}}], EZX: [{product: {value: 3e-4 s.s/mm, times: [{curve: Y, at: [-50 mm, 0 mm, 60 mm], values: [1, -2, 0.5]}, {speed: X, within: [0 mm/s, 20 mm/s]}, {speed: X}]}}, {polynomial: {sensor: both, unit: um/K, coefficients: [-3, 0.2], times: [{play: scale, reference: 22 degC, width: 0.4 K}]}}, {product: {value: 1 um/mm^3, times: [{position: Y, power: 3}]}}]}";

#[test]
fn the_terms_agree_with_the_runtime() {
    agree(ERRORS);
}

#[test]
fn terms_with_factors_agree_with_the_runtime() {
    agree(TIMES);
}

/// Every error motion is the same in every row, by both readings of its terms.
fn agree(errors: &str) {
    let built = Built::of("XYFZ", "{}");
    let rest = format!(
        "constants: {{Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}}\nsensors: {{both: {{mean: [scale, air]}}}}\nerrors: {errors}\n"
    );
    let built = Built::with(built.machine, &rest);
    let rows = 400;
    let number = |row: usize| f64::from(u32::try_from(row).unwrap());
    let x: Vec<f64> = (0..rows).map(|row| 60.0 * (number(row) * 0.07).sin() + 20.0).collect();
    let y: Vec<f64> = (0..rows).map(|row| 90.0 * (number(row) * 0.03).cos()).collect();
    let column = |name: &str, start: f64| abbe_simulation::Column {
        name: name.to_owned(),
        unit: "degC".to_owned(),
        values: (0..rows).map(|row| start + 0.01 * number(row)).collect(),
    };
    let commands = Commands {
        time: (0..rows).map(|row| 0.1 * number(row)).collect(),
        run: vec![1; rows],
        positions: vec![x.clone(), y.clone(), vec![0.0; rows]],
        temperatures: vec![column("air", 19.0), column("scale", 22.0)],
        ..Commands::default()
    };
    let mut states = vec![TermState::default(); 24];
    let mut compared = 0;
    built
        .plant()
        .run(&commands, |moment| {
            let row = moment.state.row;
            let temperatures: Vec<f64> =
                (0..built.calibration.sensors.len()).map(|sensor| moment.state.temperature(sensor)).collect();
            // Directions by hand: x and y of the rows themselves.
            let toward = |column: &[f64]| {
                let back = row > 0 && column[row] < column[row - 1];
                if back { Direction::Negative } else { Direction::Positive }
            };
            let direction = [toward(&x), toward(&y), Direction::Positive];
            let sample = Sample {
                position: &[x[row], y[row], 0.0],
                travel: &[],
                direction: &direction,
                velocity: &[0, 1, 2].map(|axis| moment.state.velocity(axis)),
                temperature: &temperatures,
                time_step: 0.1,
            };
            let mut number = 0;
            for listed in &built.calibration.motions {
                let mut sum = 0.0;
                for term in &listed.terms {
                    let terms = term.value.runtime().unwrap();
                    let one = ErrorMotion { terms: &terms };
                    let own = &mut states[number..number + terms.len()];
                    one.advance(&sample, own);
                    sum += one.value(&sample, own);
                    number += terms.len();
                }
                let own = moment.motions[listed.motion];
                assert!(
                    (own - sum).abs() < 1e-14 * sum.abs().max(1.0),
                    "row {row}, motion {}: {own} {sum}",
                    listed.motion
                );
                compared += 1;
            }
        })
        .unwrap();
    assert_eq!(compared, 3 * rows);
}
