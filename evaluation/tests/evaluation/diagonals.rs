//! Diagonals of a machine with known errors.

use abbe_evaluation::Kind;
use recording::{Instrument, Line};

use crate::bench::{Bench, Program, near, reason, value};

/// Four body diagonals of a cube of 100 mm, five cycles each.
pub(crate) fn four(count: usize) -> Program {
    let mut program = Program::default();
    let corners = [[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, -1.0]];
    for signs in corners.iter().take(count) {
        let place = |at: f64| signs.map(|sign| if sign > 0.0 { at } else { 100.0 - at }).to_vec();
        let one = Program::stations(&[0.0, 25.0, 50.0, 75.0, 100.0], 5.0, 5, place);
        let last = program.run.last().copied().unwrap_or(0);
        for row in 0..one.time.len() {
            let at: Vec<f64> = one.positions.iter().map(|column| column[row]).collect();
            program.row(4.0, last + one.run[row], &at);
        }
    }
    program
}

#[test]
fn scale_and_squareness_show_on_diagonals_as_they_must() {
    // X is longer by 0.1 um/mm; the angle between X and Y is off by 30 urad.
    let bench = Bench::new(
        "FXYZ",
        "EXX: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.1]}}, {backlash: {lost_motion: 6 um}}], EC0Y: 30 urad",
    );
    let evaluation = bench.evaluate(&bench.positions(&four(4), 0.0, 1));
    assert_eq!(evaluation.positioning.len(), 4);
    let root = 3.0_f64.sqrt();
    for line in &evaluation.positioning {
        assert_eq!(line.kind, Kind::BodyDiagonal);
        // Over the cube, X moves 100 mm to a side: its scale gives 10 um along X, the squareness 3 um along X for 100 mm of Y,
        // against X where Y rises; on a diagonal both count by the cosine of 1 / sqrt 3.
        let opposed = line.direction[0] * line.direction[1] < 0.0;
        let tilt = if opposed { 3.0 } else { -3.0 };
        near(value(&line.figures, "M"), (10.0 + tilt) / root, 2e-3);
        near(value(&line.figures, "B"), 6.0 / root, 2e-3);
        near(value(&line.figures, "E"), (16.0 + tilt) / root, 3e-3);
    }
    let together = evaluation.diagonals.unwrap();
    assert_eq!(together.names, ["+X+Y+Z", "+X+Y-Z", "+X-Y+Z", "+X-Y-Z"]);
    near(value(&together.figures, "E_d"), 19.0 / root, 3e-3);
    near(value(&together.figures, "B_d"), 6.0 / root, 2e-3);
    let three = bench.evaluate(&bench.positions(&four(3), 0.0, 1)).diagonals.unwrap();
    assert_eq!(reason(&three.figures, "E_d"), "it needs all 4 body diagonals, but there are 3");
}

#[test]
fn a_beam_along_a_face_diagonal_reads_it() {
    let bench = Bench::new("FXY", "EXX: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.1]}}]");
    let program = Program::stations(&[0.0, 25.0, 50.0, 75.0, 100.0], 5.0, 5, |at| vec![at, 100.0 - at]);
    let mut recording = bench.positions(&program, 0.0, 1);
    let root = 0.5_f64.sqrt();
    // The beam looks the other way: along -X and Y.
    let column =
        |part: usize| recording.measured[part].clone().unwrap().into_iter().zip(&program.positions[part]);
    let along = column(0).zip(column(1)).map(|((x, at), (y, other))| root * ((y - other) - (x - at)));
    recording.deviation = Some(along.collect());
    recording.measured = [None, None, None];
    recording.instrument = Instrument::Linear(Line { axis: None, direction: [-root, root, 0.0] });
    let evaluation = bench.evaluate(&recording);
    let line = &evaluation.positioning[0];
    assert_eq!(line.kind, Kind::FaceDiagonal);
    near(value(&line.figures, "M"), 10.0 * root, 1e-6);
    // The scale lengthens X: further out, further ahead.
    let mean = |number: usize| line.targets[number].mean().unwrap();
    near(1e3 * (mean(5) - mean(1)), 10.0 * root, 1e-6);
    near(value(&evaluation.diagonals.unwrap().figures, "E_d"), 10.0 * root, 1e-6);
}
