//! Positioning of machines with known errors.

use abbe_evaluation::{Kind, Unit, Zero};
use recording::{Instrument, Line, Recording};

use crate::bench::{Bench, Program, figure, near, reason, value};

const SYMBOLS: [&str; 12] =
    ["B", "B_mean", "R_up", "R_down", "R", "E_up", "E_down", "E", "M", "A_up", "A_down", "A"];

fn targets(count: u32, step: f64) -> Vec<f64> {
    (0..count).map(|number| f64::from(number) * step).collect()
}

/// A scale of 0.1 um/mm over 200 mm and a lost motion of 8 um.
const SCALE_AND_PLAY: &str =
    "EXX: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.1]}}, {backlash: {lost_motion: 8 um}}]";

/// Scale and play alone: every figure has its closed form.
const CLOSED: [(&str, f64); 12] = [
    ("B", 8.0),
    ("B_mean", -8.0),
    ("R_up", 0.0),
    ("R_down", 0.0),
    ("R", 8.0),
    ("E_up", 20.0),
    ("E_down", 20.0),
    ("E", 28.0),
    ("M", 20.0),
    ("A_up", 20.0),
    ("A_down", 20.0),
    ("A", 28.0),
];

#[test]
fn scale_and_play_give_their_closed_forms_on_every_branch() {
    for word in ["FXYZ", "XYFZ", "XFYZ"] {
        let bench = Bench::new(word, SCALE_AND_PLAY);
        let program = Program::stations(&targets(11, 20.0), 4.0, 5, |at| vec![at, 30.0, -40.0]);
        let mut recording = bench.positions(&program, 0.0, 1);
        let evaluation = bench.evaluate(&recording);
        let [line] = evaluation.positioning.as_slice() else { panic!("{evaluation:?}") };
        assert_eq!((line.kind, line.unit, line.zero), (Kind::Slide, Unit::Length, Zero::Nominal));
        assert_eq!(line.at, [("Y".to_owned(), 30.0, Unit::Length), ("Z".to_owned(), -40.0, Unit::Length)]);
        for (symbol, closed) in CLOSED {
            near(value(&line.figures, symbol), closed, 1e-6);
        }
        near(line.targets[4].up.unwrap().mean, 0.006 - 0.004, 1e-9);
        // The overrun at the end is approached upwards only, that at the beginning downwards only.
        assert_eq!(line.left_out, [-4.0, 204.0]);
        // A beam sees the same, and a beam that looks across nothing of it.
        let measured = recording.measured[0].take().unwrap();
        let column = measured.iter().zip(&program.positions[0]).map(|(read, at)| (read - at) + 0.5);
        recording.deviation = Some(column.collect());
        recording.measured = [None, None, None];
        let beam = |direction: [f64; 3]| Instrument::Linear(Line { axis: None, direction });
        recording.instrument = beam([1.0, 0.0, 0.0]);
        let beam_line = &bench.evaluate(&recording).positioning[0];
        assert_eq!(beam_line.zero, Zero::Instrument);
        for (symbol, closed) in CLOSED {
            near(value(&beam_line.figures, symbol), closed, 1e-6);
        }
        recording.instrument = beam([0.0, 1.0, 0.0]);
        let across = bench.evaluate(&recording);
        assert!(!across.gives_any() && across.not_given[0].because.contains("another direction"));
    }
}

#[test]
fn noise_comes_back_as_s_and_the_zero_does_not_matter() {
    let bench = Bench::new("FXYZ", SCALE_AND_PLAY);
    let program = Program::stations(&targets(41, 5.0), 1.0, 9, |at| vec![at, 0.0, 0.0]);
    let recording = bench.positions(&program, 0.002, 7);
    let line = bench.evaluate(&recording).positioning.remove(0);
    let squares: Vec<f64> = line
        .targets
        .iter()
        .filter(|target| target.reversal().is_some())
        .flat_map(|target| [target.up, target.down])
        .map(|side| side.unwrap().s.unwrap().powi(2))
        .collect();
    // 82 estimates with 8 degrees of freedom each: 5.5 % of the variance, and three times that is allowed.
    assert_eq!(squares.len(), 82);
    let variance = squares.iter().sum::<f64>() / 82.0;
    near(variance / 4e-6, 1.0, 0.165);
    // B_mean is the mean of 41 differences of means of nine.
    near(value(&line.figures, "B_mean"), -8.0, 3.0 * 2.0 * (2.0_f64 / 9.0 / 41.0).sqrt());
    // Without a calibration the zero is the mean of all readings, and nothing else changes.
    let shifted = abbe_evaluation::evaluate(&abbe_evaluation::Inputs {
        equations: &bench.compiled.equations,
        calibration: None,
        recording: &{
            let mut shifted = recording.clone();
            shifted.measured[0].as_mut().unwrap().iter_mut().for_each(|value| *value += 12.5);
            shifted
        },
    });
    assert_eq!(shifted.positioning[0].zero, Zero::Mean);
    for symbol in SYMBOLS {
        near(value(&shifted.positioning[0].figures, symbol), value(&line.figures, symbol), 1e-8);
    }
}

#[test]
fn the_order_of_runs_does_not_matter_and_dwells_are_read_in_their_later_half() {
    let bench = Bench::new("FX", SCALE_AND_PLAY);
    let once = Program::stations(&targets(6, 40.0), 4.0, 5, |at| vec![at]);
    // The same with six rows at every station, the first three of which are far off.
    let mut dwelling = Program::default();
    for row in 0..once.time.len() {
        (0..6).for_each(|_| dwelling.row(0.7, once.run[row], &[once.positions[0][row]]));
    }
    let mut recording = bench.positions(&dwelling, 0.0, 1);
    let settling = |(row, value): (usize, &mut f64)| *value += if row % 6 < 3 { 0.5 } else { 0.0 };
    recording.measured[0].as_mut().unwrap().iter_mut().enumerate().for_each(settling);
    let line = bench.evaluate(&recording).positioning.remove(0);
    for (symbol, closed) in CLOSED {
        near(value(&line.figures, symbol), closed, 1e-6);
    }
    assert!(line.notes.is_empty(), "{:?}", line.notes);
    let figures = bench.evaluate(&bench.positions(&once, 0.001, 3)).positioning.remove(0).figures;
    let mut turned = bench.positions(&once, 0.001, 3);
    let rows = once.time.len() / 5;
    let order: Vec<usize> = [3, 1, 0, 4, 2].iter().flat_map(|run| run * rows..(run + 1) * rows).collect();
    let turn = |column: &Vec<f64>| order.iter().map(|row| column[*row]).collect::<Vec<f64>>();
    turned.measured[0] = turned.measured[0].as_ref().map(turn);
    let other = bench.evaluate(&turned).positioning.remove(0).figures;
    for symbol in SYMBOLS {
        near(value(&other, symbol), value(&figures, symbol), 1e-9);
    }
}

#[test]
fn one_way_alone_gives_the_figures_of_one_way() {
    let bench = Bench::new("FX", SCALE_AND_PLAY);
    let mut program = Program::default();
    for run in 1..=5 {
        [-5.0, 0.0, 50.0, 100.0, 150.0, 200.0].iter().for_each(|at| program.row(4.0, run, &[*at]));
    }
    let line = bench.evaluate(&bench.positions(&program, 0.0, 1)).positioning.remove(0);
    near(value(&line.figures, "E_up"), 20.0, 1e-6);
    for symbol in ["B", "B_mean", "R", "E", "M", "A"] {
        assert_eq!(reason(&line.figures, symbol), "every target was approached only upwards");
    }
    assert_eq!(reason(&line.figures, "A_down"), "no target was approached downwards");
    assert_eq!(figure(&line.figures, "R_up").rests.targets, Some(5));
}

#[test]
fn a_single_cycle_has_a_reversal_and_no_repeatability() {
    let bench = Bench::new("FX", SCALE_AND_PLAY);
    let program = Program::stations(&targets(5, 50.0), 4.0, 1, |at| vec![at]);
    let line = bench.evaluate(&bench.positions(&program, 0.0, 1)).positioning.remove(0);
    near(value(&line.figures, "B"), 8.0, 1e-6);
    near(value(&line.figures, "E"), 28.0, 1e-6);
    for symbol in ["R_up", "R", "A_up", "A"] {
        assert_eq!(reason(&line.figures, symbol), "the target 0 mm was approached upwards only once");
    }
    assert!(line.notes[0].contains("requires 5 approaches"), "{:?}", line.notes);
}

#[test]
fn lines_at_other_heights_and_of_other_axes_stand_apart() {
    let bench = Bench::new(
        "FXYZ",
        "EXX: [{backlash: {lost_motion: 8 um}}], EYY: [{backlash: {lost_motion: 3 um}}], EBX: [{polynomial: {per: mm, unit: urad, coefficients: [0, 0.2]}}]",
    );
    let mut program = Program::stations(&targets(5, 25.0), 4.0, 5, |at| vec![at, 0.0, 0.0]);
    for other in [
        Program::stations(&targets(5, 25.0), 4.0, 5, |at| vec![at, 0.0, 100.0]),
        Program::stations(&targets(5, 25.0), 4.0, 5, |at| vec![50.0, at, 0.0]),
    ] {
        let last = *program.run.last().unwrap();
        for row in 0..other.time.len() {
            let at: Vec<f64> = other.positions.iter().map(|column| column[row]).collect();
            program.row(4.0, last + other.run[row], &at);
        }
    }
    let lines = bench.evaluate(&bench.positions(&program, 0.0, 1)).positioning;
    let found: Vec<(&str, f64)> =
        lines.iter().map(|line| (line.axes[0].as_str(), value(&line.figures, "B"))).collect();
    assert_eq!(found.iter().map(|(axis, _)| *axis).collect::<Vec<&str>>(), ["X", "X", "Y"]);
    [8.0, 8.0, 3.0].iter().zip(&found).for_each(|(closed, (_, own))| near(*own, *closed, 1e-6));
    // A pitch of 20 urad at the end of the travel is 2 um more at 100 mm: the tool hangs on X.
    near(value(&lines[1].figures, "M"), 2.0, 1e-4);
    near(value(&lines[0].figures, "M"), 0.0, 1e-4);
}

#[test]
fn a_rotary_axis_is_evaluated_in_angles() {
    let bench = Bench::new("FC", "");
    let step = 30.0_f64.to_radians();
    let program = Program::stations(&targets(12, step), 0.1, 5, |at| vec![at]);
    let mut recording = bench.positions(&program, 0.0, 1);
    recording.measured = [None, None, None];
    // 10 urad of play, and an encoder that begins again after each turn.
    let mut before = 0.0;
    let read = |at: &f64| {
        let play = if *at > before { -5e-6 } else { 5e-6 };
        before = *at;
        (at + play).rem_euclid(std::f64::consts::TAU)
    };
    recording.axes[0].measured = Some(program.positions[0].iter().map(read).collect());
    let line = bench.evaluate(&recording).positioning.remove(0);
    assert_eq!((line.kind, line.unit), (Kind::Rotary, Unit::Angle));
    near(value(&line.figures, "B"), 0.01, 1e-9);
    near(value(&line.figures, "E"), 0.01, 1e-9);
    near(value(&line.figures, "M"), 0.0, 1e-9);
}

/// What is done to a recording.
type Change = fn(&mut Recording);

#[test]
fn what_cannot_be_given_says_why() {
    let bench = Bench::new("FXYZ", "");
    let program = Program::stations(&targets(5, 25.0), 4.0, 5, |at| vec![at, 0.0, 0.0]);
    let recording = bench.positions(&program, 0.0, 1);
    let because = |change: Change| {
        let mut changed = recording.clone();
        change(&mut changed);
        let evaluation = bench.evaluate(&changed);
        assert!(!evaluation.gives_any(), "{evaluation:?}");
        evaluation.not_given[0].because.clone()
    };
    let cases: [(&str, Change); 6] = [
        ("`command.<axis>`", |one| one.axes.iter_mut().for_each(|axis| axis.command = None)),
        ("in motion", |one| one.time.iter_mut().for_each(|time| *time /= 100.0)),
        ("`measured.x` is missing", |one| one.measured[0] = None),
        ("have no readings", |one| one.measured[0].as_mut().unwrap().fill(f64::NAN)),
        ("points of a surface", |one| one.instrument = Instrument::Probe),
        ("reads across", |one| one.instrument = Instrument::Straightness(Line::default())),
    ];
    for (part, change) in cases {
        let said = because(change);
        assert!(said.contains(part), "{said}");
    }
}

#[test]
fn nothing_at_all_is_no_reason_to_stop() {
    let bench = Bench::new("FXYZ", "");
    let empty = Recording::default();
    assert!(!bench.evaluate(&empty).gives_any());
    let program = Program::stations(&[0.0], 4.0, 1, |at| vec![at, 0.0, 0.0]);
    let mut recording = bench.positions(&program, 0.0, 1);
    for cell in recording.axes.iter_mut().filter_map(|axis| axis.command.as_mut()).flatten() {
        *cell = f64::NAN;
    }
    assert!(!bench.evaluate(&recording).gives_any());
    recording
        .axes
        .iter_mut()
        .filter_map(|axis| axis.command.as_mut())
        .flatten()
        .for_each(|cell| *cell = 1e300);
    assert!(!bench.evaluate(&recording).gives_any());
}

/// The rows of a cycle without those of the overrun, as an instrument writes them that is triggered at stations.
fn stations_only(program: &Program, recording: &Recording, ends: [f64; 2]) -> Recording {
    let rows: Vec<usize> =
        (0..program.time.len()).filter(|row| !ends.contains(&program.positions[0][*row])).collect();
    let take = |column: &Vec<f64>| rows.iter().map(|row| column[*row]).collect::<Vec<f64>>();
    let mut only = recording.clone();
    only.time = take(&only.time);
    only.run = rows.iter().map(|row| recording.run[*row]).collect();
    only.axes.iter_mut().for_each(|axis| axis.command = axis.command.as_ref().map(take));
    only.measured = only.measured.map(|column| column.as_ref().map(take));
    only
}

#[test]
fn an_overrun_that_was_not_recorded_is_seen_from_what_was() {
    let bench = Bench::new("FX", SCALE_AND_PLAY);
    let program = Program::stations(&targets(6, 40.0), 4.0, 5, |at| vec![at]);
    let mut recording = stations_only(&program, &bench.positions(&program, 0.0, 1), [-4.0, 204.0]);
    for one_way in [false, true] {
        if one_way {
            // Every way a run of its own, up and down.
            recording.run = (0..60).map(|row| row / 6 + 1).collect();
        }
        let line = bench.evaluate(&recording).positioning.remove(0);
        for (symbol, closed) in CLOSED {
            near(value(&line.figures, symbol), closed, 1e-6);
        }
        let rests = figure(&line.figures, "A").rests;
        assert_eq!((rests.targets, rests.runs), (Some(6), [5, 5]));
        assert!(line.notes.iter().any(|note| note.contains("overrun")), "{:?}", line.notes);
    }
    // Where all runs go one way nothing tells how their first place was approached.
    let up = Program::stations(&targets(6, 40.0), 4.0, 5, |at| vec![at]);
    let mut upwards = Program::default();
    for row in (0..up.time.len()).filter(|row| (1..7).contains(&(row % 15))) {
        upwards.row(4.0, up.run[row], &[up.positions[0][row]]);
    }
    let line = bench.evaluate(&bench.positions(&upwards, 0.0, 1)).positioning.remove(0);
    assert_eq!(line.targets.len(), 5);
    near(value(&line.figures, "E_up"), 16.0, 1e-6);
}

#[test]
fn where_commands_are_missing_at_a_turn_nothing_is_taken_for_granted() {
    let bench = Bench::new("FX", SCALE_AND_PLAY);
    let once = Program::stations(&targets(6, 40.0), 4.0, 5, |at| vec![at]);
    let mut dwelling = Program::default();
    for row in 0..once.time.len() {
        (0..7).for_each(|_| dwelling.row(0.6, once.run[row], &[once.positions[0][row]]));
    }
    let mut recording = bench.positions(&dwelling, 0.0, 1);
    // The overrun is driven, and its commands are not in the recording.
    for cell in recording.axes[0].command.as_mut().unwrap() {
        *cell = if [-4.0, 204.0].contains(cell) { f64::NAN } else { *cell };
    }
    let line = bench.evaluate(&recording).positioning.remove(0);
    // The ends were approached from outside, or are one stand with a gap: what is known is one side of each.
    assert_eq!(line.left_out, [0.0, 200.0]);
    for (symbol, closed) in [("B", 8.0), ("M", 12.0), ("E", 20.0), ("R", 8.0), ("A", 20.0)] {
        near(value(&line.figures, symbol), closed, 1e-6);
    }
    assert_eq!(figure(&line.figures, "A").rests.runs, [5, 5]);
}
