//! A printed data set: the report of an acceptance test of a slit (ESS, 11358, axis 1, 3 November 2021; open-loop stepper
//! against laser triangulation), five targets in five cycles both ways, with all its figures. Two of them contradict the
//! definitions: the report takes the greater of R up and R down for R, and the range of one direction for E.

use abbe_evaluation::iso230_2::{Target, TargetFigures, of_axis};
use abbe_evaluation::{Evaluation, Figure, Unit};
use recording::{AxisChannels, Instrument, Recording};

use crate::bench::{Bench, Program, figure, near, value};

pub(crate) const TARGETS: [f64; 5] = [15.0, 25.2, 35.4, 45.6, 55.8];

pub(crate) const UP: [[f64; 5]; 5] = [
    [15.00335, 15.00233, 15.00172, 15.00213, 15.00172],
    [25.19974, 25.20015, 25.20096, 25.20056, 25.20056],
    [35.40102, 35.3996, 35.40225, 35.40306, 35.40449],
    [45.59151, 45.5909, 45.59212, 45.5909, 45.58947],
    [55.80583, 55.80624, 55.80685, 55.80562, 55.80562],
];

pub(crate) const DOWN: [[f64; 5]; 5] = [
    [15.00518, 15.00518, 15.00416, 15.00335, 15.00314],
    [25.19628, 25.19607, 25.19567, 25.19587, 25.19526],
    [35.39817, 35.39837, 35.3998, 35.39939, 35.4],
    [45.59232, 45.59191, 45.59293, 45.59191, 45.59151],
    [55.80705, 55.80725, 55.80705, 55.80705, 55.80644],
];

/// What is printed of the axis, mm. The last digit is the report's rounding, once or twice.
const PRINTED: [(&str, f64); 10] = [
    ("B", 0.00456),
    ("B_mean", 0.00069),
    ("R_up", 0.0075),
    ("R_down", 0.00388),
    ("E_up", 0.01505),
    ("E_down", 0.01485),
    ("M", 0.01495),
    ("A_up", 0.01806),
    ("A_down", 0.01655),
    ("A", 0.01858),
];

/// What the report prints for R and E, and what the definitions give: 2 (0.00188 + 0.00083) + 0.00293 at 35.4 mm, and
/// 0.00697 - (-0.00902) over both directions.
const MISPRINTED: [(&str, f64, f64); 2] = [("R", 0.0075, 0.00835), ("E", 0.01485, 0.01599)];

fn targets() -> Vec<Target> {
    let minus = |read: &[f64; 5], target: f64| read.iter().map(|read| read - target).collect();
    let rows = TARGETS.iter().zip(UP.iter().zip(&DOWN));
    rows.map(|(at, (up, down))| Target { position: *at, up: minus(up, *at), down: minus(down, *at) })
        .collect()
}

fn agrees(figures: &[Figure]) {
    for (symbol, printed) in PRINTED {
        near(value(figures, symbol), 1e3 * printed, 0.0151);
    }
    for (symbol, printed, defined) in MISPRINTED {
        near(value(figures, symbol), 1e3 * defined, 0.0151);
        assert!((value(figures, symbol) - 1e3 * printed).abs() > 0.8, "{symbol}");
    }
}

#[test]
fn the_definitions_give_the_printed_figures_and_not_the_two_wrong_ones() {
    let targets: Vec<TargetFigures> = targets().iter().map(TargetFigures::of).collect();
    agrees(&of_axis(&targets, Unit::Length));
    // What is printed of the targets: mean up, down, both, B, s up, s down, R up, R down, R.
    let printed = [
        [0.00225, 0.0042, 0.00323, -0.00196, 0.00067, 0.00097, 0.00268, 0.00388, 0.00524],
        [0.00039, -0.00417, -0.00189, 0.00456, 0.00046, 0.00039, 0.00186, 0.00157, 0.00628],
        [0.00208, -0.00085, 0.00062, 0.00293, 0.00188, 0.00083, 0.0075, 0.00333, 0.00835],
        [-0.00902, -0.00788, -0.00845, -0.00114, 0.00098, 0.00054, 0.00393, 0.00216, 0.00419],
        [0.00603, 0.00697, 0.0065, -0.00094, 0.00052, 0.00031, 0.00208, 0.00124, 0.00259],
    ];
    for (target, printed) in targets.iter().zip(printed) {
        let (up, down) = (target.up.unwrap(), target.down.unwrap());
        let own = [
            up.mean,
            down.mean,
            target.mean().unwrap(),
            target.reversal().unwrap(),
            up.s.unwrap(),
            down.s.unwrap(),
            up.repeatability().unwrap(),
            down.repeatability().unwrap(),
            target.repeatability().unwrap(),
        ];
        for (own, printed) in own.into_iter().zip(printed) {
            near(own, printed, 1.3e-5);
        }
    }
}

/// The evaluation of a recording of the cycle.
pub(crate) fn evaluated() -> Evaluation {
    let program = Program::stations(&TARGETS, 5.0, 5, |at| vec![at]);
    let command = program.positions[0].clone();
    let mut seen = [[0_usize; 2]; 5];
    let mut before = f64::NAN;
    let measured = command.iter().map(|at| {
        let up = *at > before;
        before = *at;
        let target = TARGETS.iter().position(|target| target == at)?;
        let (side, table) = if up { (0, &UP) } else { (1, &DOWN) };
        seen[target][side] += 1;
        Some(table[target][seen[target][side] - 1])
    });
    let measured: Vec<f64> = measured.map(|read| read.unwrap_or(f64::NAN)).collect();
    let recording = Recording {
        instrument: Instrument::Position,
        axes: vec![AxisChannels { command: Some(command), ..AxisChannels::default() }],
        measured: [Some(measured), None, None],
        time: program.time,
        run: program.run,
        ..Recording::default()
    };
    Bench::new("FX", "").evaluate(&recording)
}

#[test]
fn the_same_comes_of_a_recording() {
    let evaluation = evaluated();
    let [line] = evaluation.positioning.as_slice() else { panic!("{evaluation:?}") };
    agrees(&line.figures);
    let rests = figure(&line.figures, "A").rests;
    assert_eq!((rests.targets, rests.readings, rests.runs), (Some(5), 50, [5, 5]));
    assert!(evaluation.not_given.is_empty() && line.left_out.is_empty());
}
