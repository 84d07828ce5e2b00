//! Motors: what the exact machine does, and the commands of the runtime as they put it right.
//!
//! In: machines with crossed belts and with beams, whose motors err. Out: where the tool really stands, against numbers by hand; and where
//! it stands with the commands of the compensator, each motor being sent where that says.

use abbe_runtime::{
    Compensator, Direction, ErrorMotion, Kinematics, Limits, Refusal, Sample, Term, TermState, Work,
    states_needed,
};
use abbe_simulation::Commands;
use model_dsl::compile;
use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::equations::Equations;
use model_dsl::machine::Machine;
use model_dsl::program::Interpreter;
use model_dsl::source::SourceFile;

use crate::common::Built;

const CROSSED: &str = "topology: FXYZ\ntransmission: {A: X + Y, B: X - Y}\n";

/// A beam along X that carries X and Z, its drives 400 mm before its origin and 600 mm behind it.
const BEAM: &str = "chain:\n  tool:\n    - slide: Y\n      along: +Y\n      drives: {Y1: {x: -400 mm}, Y2: {x: 600 mm}}\n    - slide: X\n      along: +X\n    - slide: Z\n      along: +Z\n    - tool: tip\n      offset: [Xt, Yt, Zt]\n";

/// A machine with the errors of its calibration, in one line.
fn built(rest: &str, errors: &str) -> (Built, Equations) {
    let source = SourceFile::new("machine.yaml", format!("abbe: 1\nname: machine\n{rest}"));
    let mut findings = Diagnostics::new();
    let Some(compiled) = compile(&source, &mut findings) else {
        panic!("{}", render(&source, &findings, false))
    };
    let machine: Machine = compiled.machine;
    let constants = "constants: {Xt: 30 mm, Yt: 20 mm, Zt: 120 mm}\n";
    (Built::with(machine, &format!("{constants}errors: {errors}\n")), compiled.equations)
}

/// Positions of the axes with those of the motors behind them.
fn with_motors<const AXES: usize>(equations: &Equations, axes: [f64; AXES]) -> Vec<f64> {
    let mut position = axes.to_vec();
    position.resize(equations.axes.len(), 0.0);
    for share in equations.following() {
        position[share.motor] += share.weight * axes[share.of];
    }
    position
}

/// The commands of the compensator at a place, all axes and motors having come in these directions.
fn commanded(
    (built, equations): &(Built, Equations),
    position: &[f64],
    direction: &[Direction],
    limit: Option<f64>,
) -> Result<Vec<f64>, Refusal> {
    let (calibration, names) = (&built.calibration, equations.names());
    assert_eq!(names.motions.len(), built.names.motions.len(), "every motion has a lever");
    let terms: Vec<Vec<Term<'_>>> = (0..names.motions.len())
        .map(|motion| {
            let number = built.names.motion(&names.motions[motion].name).unwrap();
            calibration.runtime(number).flat_map(Result::unwrap).collect()
        })
        .collect();
    let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
    let machine = Interpreter::new(equations, &calibration.constants);
    let mut states = vec![TermState::default(); states_needed(&motions)];
    let mut directions = vec![[0.0; 3]; machine.axes()];
    let (mut values, mut travel) = (vec![0.0; motions.len()], vec![]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let mut compensator = Compensator::new(&machine, &motions, &mut states, work).unwrap();
    compensator.limits = Limits { compensation: limit, ..Limits::default() };
    let mut command = vec![0.0; machine.axes()];
    let sample = Sample { position, travel: &[], direction, velocity: &[], temperature: &[], time_step: 0.0 };
    compensator.compensate(&sample, &mut command)?;
    Ok(command)
}

fn close(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} is not {expected}");
}

/// A has 40 um of lost motion. Both slides go on, and A with them: it stays 20 um behind, so 10 um in X and in Y. Then X goes on and Y goes
/// back by more: A turns, and both slides change by 20 um, X without having turned at all.
#[test]
fn the_play_of_a_crossed_motor_is_seen_in_both_slides() {
    let (built, _) = built(CROSSED, "{EA: [{backlash: {lost_motion: 40 um}}]}");
    let commands = Commands {
        time: vec![0.0, 1.0, 2.0],
        run: vec![1; 3],
        positions: vec![
            vec![0.0, 10.0, 12.0],
            vec![0.0, 10.0, 5.0],
            vec![0.0; 3],
            vec![0.0; 3],
            vec![0.0; 3],
        ],
        ..Commands::default()
    };
    let plant = built.plant();
    let mut seen = Vec::new();
    plant
        .run(&commands, |moment| {
            let off = moment.pose.tip - plant.nominal(&[12.0, 5.0, 0.0]).tip;
            seen.push((off.x, off.y, moment.drive[3]));
        })
        .unwrap();
    let (x, y, a) = seen[1];
    close(x, -2.0 - 0.010, 1e-12);
    close(y, 5.0 - 0.010, 1e-12);
    close(a, 20.0, 1e-12);
    let (x, y, a) = seen[2];
    close(x, 0.010, 1e-12);
    close(y, 0.010, 1e-12);
    close(a, 17.0, 1e-12);
}

/// A goes 100 um/m too far and has play; c + 1e-4 c - 0.02 = 150 is what it must be sent to, and 50 is right for B.
#[test]
fn crossed_motors_are_sent_where_their_own_errors_cancel() {
    let machine = built(
        CROSSED,
        "{EA: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.1]}}, {backlash: {lost_motion: 40 um}}]}",
    );
    let position = with_motors(&machine.1, [100.0, 50.0, 0.0]);
    let command = commanded(&machine, &position, &[Direction::Positive; 5], None).unwrap();
    close(command[3], 150.02 / 1.0001, 1e-9);
    close(command[4], 50.0, 1e-9);
    close(command[0], 0.5 * (command[3] + command[4]), 1e-9);
    close(command[1], 0.5 * (command[3] - command[4]), 1e-9);
}

/// With its drives commanded alone, a beam is straight and in its place, whatever else is wrong. The judge goes another way than the
/// compiler: each drive stands at its command plus its error, the line through both is the beam, and ECY is added to its slope.
#[test]
fn drives_put_their_beam_where_it_belongs() {
    let machine = built(
        BEAM,
        "{EY1: [{polynomial: {per: mm, unit: um, coefficients: [3, 0.1]}}], EY2: [{backlash: {lost_motion: 20 um}}], \
         ECY: [{polynomial: {per: mm, unit: urad, coefficients: [10, 0.02]}}], EXX: 7 um, EYX: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.03]}}]}",
    );
    let (x, y) = (150.0, 250.0);
    let position = with_motors(&machine.1, [x, y, 0.0]);
    assert_eq!(position[3..], [y, y]);
    let command = commanded(&machine, &position, &[Direction::Positive; 5], None).unwrap();
    let first = command[3] + 0.003 + 1e-4 * command[3];
    let second = command[4] - 0.010;
    let slope = (second - first) / 1000.0 + 10e-6 + 0.02e-6 * command[1];
    // The beam is square, and stands where the error of X along it is taken away at the tool.
    close(slope, 0.0, 1e-11);
    let along = first + 0.4 * (second - first);
    close(along + 0.03e-3 * command[0], y, 1e-8);
    close(command[0], x - 0.007, 1e-9);
}

/// Left to the slides, the same errors are corrected at the tool, and both drives get one command.
#[test]
fn drives_that_do_not_correct_follow_their_slide() {
    let rest = BEAM.replace("600 mm}}\n", "600 mm}}\n      corrects: false\n");
    let machine = built(&rest, "{EY2: 20 um, EC0Y: 50 urad}");
    let position = with_motors(&machine.1, [150.0, 250.0, 0.0]);
    let command = commanded(&machine, &position, &[Direction::Positive; 5], None).unwrap();
    assert_eq!(command[3..], [command[1], command[1]]);
    // 0.4 e2 at the origin, and e2/1000 mm as a rotation: at x + Xt = 180 mm in Y, at Yt = 20 mm in X; the squareness takes X by c y.
    // By the lever arms at the place: X is sent 0.013 mm further, over which the rotation makes 0.26 nm.
    close(command[1], 250.0 - 0.020 * 0.4 - 0.020 / 1000.0 * 180.0, 3e-7);
    close(command[0], 150.0 + 0.020 / 1000.0 * 20.0 + 50e-6 * 250.0, 1e-6);
}

#[test]
fn a_drive_is_refused_over_the_limit_and_a_motor_out_of_place() {
    let machine = built(BEAM, "{EY1: 50 um}");
    let mut position = with_motors(&machine.1, [0.0, 0.0, 0.0]);
    let ways = [Direction::Positive; 5];
    let refused = commanded(&machine, &position, &ways, Some(0.04));
    assert!(matches!(refused, Err(Refusal::OverLimit { limit: 0.04, .. })), "{refused:?}");
    assert!(commanded(&machine, &position, &ways, Some(0.06)).is_ok());
    position[4] = 0.001;
    let refused = commanded(&machine, &position, &ways, None);
    assert_eq!(refused, Err(Refusal::Motor { axis: 4, expected: 0.0, found: 0.001 }));
}

/// A screw of the first drive that waves, and nothing else: the slides have nothing to do, and the search must go on for the drive alone.
#[test]
fn a_drive_that_errs_alone_is_sent_where_its_own_error_cancels() {
    let machine = built(BEAM, "{EY1: [{cyclic: {period: 10 mm, amplitude: 20 um, phase: 0 deg}}]}");
    let wave = |place: f64| 0.020 * (2.0 * std::f64::consts::PI * place / 10.0).sin();
    for y in [250.0, 252.3, 254.9] {
        let position = with_motors(&machine.1, [150.0, y, 0.0]);
        let command = commanded(&machine, &position, &[Direction::Positive; 5], None).unwrap();
        close(command[3] + wave(command[3]), y, 1e-9);
        close(command[4], y, 1e-9);
    }
}

/// Where rotary axes aim the tool, motors stand where the slides put them, and a beam turns itself back as without.
#[test]
fn motors_follow_slides_and_square_their_beam_where_rotary_axes_aim() {
    let crossed = "topology: CAFXYZ\norientation: true\ntransmission: {P: X + Y, Q: X - Y}\n";
    let machine = built(crossed, "{EXX: 10 um, EYY: 4 um, EBX: 30 urad}");
    let position = with_motors(&machine.1, [100.0, 50.0, 20.0, 0.5, 0.3]);
    let command = commanded(&machine, &position, &[Direction::Positive; 7], None).unwrap();
    let moved = |axis: usize| command[axis] - position[axis];
    assert!(moved(0).abs() > 0.005 && moved(4).abs() > 1e-6, "{command:?}");
    close(moved(5), moved(0) + moved(1), 1e-12);
    close(moved(6), moved(0) - moved(1), 1e-12);
    // The beam turns about the tool, which then points as before: the rotary axes have nothing to do.
    let rotary = "  workpiece:\n    - rotary: A\n      along: +A\n    - rotary: C\n      along: +C\n";
    let commands = ["true", "uncorrected"].map(|orientation| {
        let rest =
            format!("orientation: {orientation}\n{}", BEAM.replace("chain:\n", &format!("chain:\n{rotary}")));
        let machine = built(&rest, "{EY1: 40 um, EY2: -30 um, ECY: 10 urad, EXX: 7 um}");
        let position = with_motors(&machine.1, [150.0, 250.0, 20.0, 0.5, 0.3]);
        commanded(&machine, &position, &[Direction::Positive; 7], None).unwrap()
    });
    for (aimed, told) in commands[0].iter().zip(&commands[1]) {
        close(*aimed, *told, 1e-9);
    }
    // EY1 and what ECY is over the 400 mm to the first drive, with their signs: the beam is sent back by both.
    close(commands[0][5] - 250.0 - (commands[0][1] - 250.0), -0.040 + 400.0 * 10e-6, 1e-9);
}
