//! Circles of machines with known errors.

use abbe_evaluation::{Sense, Sensor};
use recording::{Instrument, Recording};

use crate::bench::{Bench, Program, near, reason, value};

const RADIUS: f64 = 100.0;
const BOTH: [f64; 2] = [1.0, -1.0];

/// The same as a ballbar reads it that is set up `off` in X from the centre.
fn as_bar(recording: &Recording, off: f64) -> Recording {
    let column = |part: usize| recording.measured[part].clone().unwrap();
    let distance = column(0).into_iter().zip(column(1)).map(|(x, y)| (x - off).hypot(y) - RADIUS);
    Recording {
        deviation: Some(distance.collect()),
        measured: [None, None, None],
        instrument: Instrument::Ballbar { center: [0.0; 3], radius: RADIUS },
        ..recording.clone()
    }
}

fn circle(bench: &Bench, recording: &Recording) -> abbe_evaluation::Circle {
    let evaluation = bench.evaluate(recording);
    let [circle] = evaluation.circles.as_slice() else { panic!("{:?}", evaluation.not_given) };
    circle.clone()
}

#[test]
fn squareness_is_an_oval_of_its_angle_times_the_radius() {
    let bench = Bench::new("FXYZ", "EC0Y: 50 urad");
    let program = Program::circles(RADIUS, 20.0, 10.0, &BOTH, 2);
    let plain = bench.positions(&program, 0.0, 1);
    for recording in [plain.clone(), as_bar(&plain, 0.0), as_bar(&plain, 0.02)] {
        let circle = circle(&bench, &recording);
        assert_eq!((circle.plane, circle.traces.len(), circle.pairs.len()), ("XY", 4, 2));
        let senses: Vec<Sense> = circle.traces.iter().map(|trace| trace.sense).collect();
        assert_eq!(senses[..2], [Sense::Counterclockwise, Sense::Clockwise]);
        near(circle.feed, 20.0, 0.01);
        for symbol in ["G_CCW", "G_CW", "G_b"] {
            near(value(&circle.figures, symbol), 5.0, 0.004);
        }
        near(value(&circle.figures, "F_max"), 2.5, 0.02);
        near(value(&circle.figures, "F_min"), -2.5, 0.02);
        near(value(&circle.figures, "D"), 0.0, 0.02);
    }
    // As it was set up, the bar sees its own place as well.
    let off = circle(&bench, &as_bar(&plain, 0.02));
    // The greatest of 20 cos a + 2.5 sin 2a: to first order 20 + (2 * 2.5)^2 / (2 * 20).
    near(value(&off.figures, "F_max_set_up"), 20.625, 0.06);
    near(off.traces[0].figures.as_ref().unwrap().center.unwrap()[0], -0.02, 1e-4);
}

#[test]
fn play_steps_by_itself_at_each_reversal() {
    let bench = Bench::new("FXYZ", "EXX: [{backlash: {lost_motion: 9 um}}]");
    let program = Program::circles(RADIUS, 20.0, 20.0, &BOTH, 1);
    let circle = circle(&bench, &as_bar(&bench.positions(&program, 0.0, 1), 0.0));
    // From +B/2 to -B/2 where X turns, in one sense and the other: no centre makes less of it.
    for symbol in ["G_CCW", "G_CW", "G_b"] {
        near(value(&circle.figures, symbol), 9.0, 0.01);
    }
    near(value(&circle.figures, "D"), 0.0, 0.01);
}

#[test]
fn a_lag_makes_both_circles_smaller_by_its_closed_form() {
    // tau 20 ms, v 50 mm/s, R 100 mm: (v tau)^2 / (2 R) is 5 um. The chords of 0.1 mm take off 0.1^2 / (12 R), 0.008 um.
    let bench = Bench::new("FXYZ", "EXX: [{lag: {gain: 50 1/s}}], EYY: [{lag: {gain: 50 1/s}}]");
    let program = Program::circles(RADIUS, 50.0, 500.0, &BOTH, 1);
    let circle = circle(&bench, &bench.positions(&program, 0.0, 1));
    near(value(&circle.figures, "D"), -5.0, 0.05);
    near(value(&circle.figures, "G_CCW"), 0.0, 0.05);
    // Different lags are ovals across one another: (tau_x - tau_y) v / 2 to each side in each sense, twice that together.
    let bench = Bench::new("FXYZ", "EXX: [{lag: {gain: 49.504950495 1/s}}], EYY: [{lag: {gain: 50 1/s}}]");
    let circle = self::circle(&bench, &bench.positions(&program, 0.0, 1));
    for symbol in ["G_CCW", "G_CW", "G_b"] {
        near(value(&circle.figures, symbol), 0.2e-3 * 50.0 * 1e3, 0.1);
    }
}

#[test]
fn the_planes_turn_right_handed() {
    for (plane, [one, other]) in [("XY", [0, 1]), ("YZ", [1, 2]), ("ZX", [2, 0])] {
        let bench = Bench::new("FXYZ", "");
        let flat = Program::circles(RADIUS, 20.0, 5.0, &BOTH, 1);
        let mut program =
            Program { time: flat.time.clone(), run: flat.run.clone(), positions: vec![vec![]; 3] };
        for column in &mut program.positions {
            *column = vec![30.0; flat.time.len()];
        }
        program.positions[one] = flat.positions[0].clone();
        program.positions[other] = flat.positions[1].clone();
        let circle = circle(&bench, &bench.positions(&program, 0.0, 1));
        assert_eq!((circle.plane, circle.traces[0].sense), (plane, Sense::Counterclockwise));
        near(value(&circle.figures, "G_b"), 0.0, 1e-6);
    }
}

#[test]
fn feeds_and_radii_stand_apart() {
    let bench = Bench::new("FXYZ", "EXX: [{lag: {gain: 50 1/s}}], EYY: [{lag: {gain: 50 1/s}}]");
    let (mut program, fast) =
        (Program::circles(RADIUS, 25.0, 250.0, &BOTH, 1), Program::circles(RADIUS, 50.0, 500.0, &BOTH, 1));
    for row in 0..fast.time.len() {
        program.row(0.002, 2, &[fast.positions[0][row], fast.positions[1][row], 0.0]);
    }
    let circles = bench.evaluate(&bench.positions(&program, 0.0, 1)).circles;
    assert_eq!(circles.len(), 2);
    near(value(&circles[0].figures, "D"), -1.25, 0.05);
    near(value(&circles[1].figures, "D"), -5.0, 0.05);
}

#[test]
fn one_sense_arcs_and_gaps_say_what_they_cannot_give() {
    let bench = Bench::new("FXYZ", "EC0Y: 50 urad");
    let one = bench.positions(&Program::circles(RADIUS, 20.0, 10.0, &[1.0], 1), 0.0, 1);
    let only = circle(&bench, &one);
    near(value(&only.figures, "G_CCW"), 5.0, 0.004);
    assert_eq!(reason(&only.figures, "G_CW"), "the circle was not driven clockwise");
    assert_eq!(reason(&only.figures, "G_b"), "full circles were driven only CCW");
    let gap = |share: f64| {
        let mut lost = as_bar(&one, 0.0);
        let rows = lost.deviation.as_ref().unwrap().len();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "a few hundred rows"
        )]
        let count = (share * rows as f64) as usize;
        lost.deviation.as_mut().unwrap()[200..200 + count].fill(f64::NAN);
        circle(&bench, &lost)
    };
    near(value(&gap(0.01).figures, "G_CCW"), 5.0, 0.1);
    let lost = gap(0.1);
    assert!(reason(&lost.figures, "G_CCW").contains("of the circle have no readings"), "{lost:?}");
    // Half a circle still has its radial deviation about the centre as set up.
    let mut half = as_bar(&one, 0.0);
    let rows = half.time.len() / 2;
    half.time.truncate(rows);
    half.run.truncate(rows);
    half.deviation.as_mut().unwrap().truncate(rows);
    half.axes.iter_mut().for_each(|axis| axis.command.as_mut().unwrap().truncate(rows));
    let half = circle(&bench, &half);
    assert!(reason(&half.figures, "F_max").contains("not a full circle"));
    near(value(&half.figures, "F_max_set_up"), 2.5, 0.01);
    near(value(&half.figures, "F_min_set_up"), -2.5, 0.01);
}

#[test]
fn drives_alone_give_what_drives_see() {
    let bench = Bench::new("FXYZ", "");
    let mut recording = bench.positions(&Program::circles(RADIUS, 20.0, 10.0, &BOTH, 1), 0.0, 1);
    recording.measured = [None, None, None];
    let said = bench.evaluate(&recording).not_given[0].because.clone();
    assert!(said.contains("actual.x"), "{said}");
    for axis in recording.axes.iter_mut().take(2) {
        axis.actual = axis.command.as_ref().map(|command| command.iter().map(|at| 0.9999 * at).collect());
    }
    let circle = circle(&bench, &recording);
    assert_eq!(circle.sensor, Sensor::Feedback);
    near(value(&circle.figures, "D"), -10.0, 1e-6);
    recording.measured[0] = recording.axes[0].command.clone();
    let said = bench.evaluate(&recording).not_given[0].because.clone();
    assert!(said.contains("`measured.y` is missing"), "{said}");
}
