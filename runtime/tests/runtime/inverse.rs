//! The inverse: the command found puts the tip where the target lies, error and all.
//!
//! In: random machines, calibrations, positions. Out: the equation of the inverse, checked through the nominal position of
//! the tip, which the compensator never sees.

use abbe_runtime::{Direction, ErrorMotion, Input, Kinematics, Sample, Table, Term, TermState, Values};
use proptest::prelude::*;

use crate::common::{Lathe, Slide, TableMill, at, with};

/// The error of a machine in a state, from the error motions and memories, without a compensator.
fn error_at<K: Kinematics>(
    machine: &K,
    motions: &[ErrorMotion<'_>],
    states: &[TermState],
    sample: &Sample<'_>,
) -> [f64; 3] {
    let mut rest = states;
    let values: Vec<f64> = motions
        .iter()
        .map(|motion| {
            let (mine, others) = rest.split_at(motion.terms.len());
            rest = others;
            motion.value(sample, mine)
        })
        .collect();
    let travel: Vec<f64> = machine.travels().iter().map(|&axis| sample.position[axis]).collect();
    machine.error(sample.position, &travel, &values)
}

fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Coefficients of a polynomial: up to 0.05 of offset, 1 mm/m of slope, and a bend.
fn coefficients() -> impl Strategy<Value = Vec<f64>> {
    (-0.05..0.05_f64, -1e-3..1e-3_f64, -1e-6..1e-6_f64).prop_map(|(a, b, c)| vec![a, b, c])
}

/// Values of a table, up to 0.05.
fn curve() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-0.05..0.05_f64, 8)
}

proptest! {
    #[test]
    fn lathe_with_a_negative_direction(
        tool in prop::array::uniform2(-150.0..150.0_f64), target in prop::array::uniform2(-300.0..300.0_f64),
        exx in coefficients(), ezz in coefficients(), forward in curve(), reverse in curve(),
        angle in -1e-3..1e-3_f64, turned in any::<bool>(),
    ) {
        let machine = Lathe { tool };
        let table = Table::uniform(-310.0, 90.0, Values::Directed { forward: &forward, reverse: &reverse }).unwrap();
        let exx = [Term::Polynomial { input: Input::Axis(0), coefficients: &exx }];
        let ezz = [
            Term::Coupling { axis: 1, coefficients: &ezz[1..] },
            Term::Table { axis: 1, table },
            Term::Cyclic { axis: 1, period: 10.0, amplitude: 0.002, phase: 0.3 },
        ];
        let ebx = [Term::Coupling { axis: 0, coefficients: &[angle / 300.0] }];
        let eb0z = [Term::Constant { value: angle }];
        let motions = [&exx[..], &ezz, &ebx, &eb0z].map(|terms| ErrorMotion { terms });
        let direction = [if turned { Direction::Negative } else { Direction::Positive }; 2];
        let sample = Sample { direction: &direction, ..at(&target) };
        let mut command = [0.0; 2];
        let (outcome, states) = with(&machine, &motions, |c| c.compensate(&sample, &mut command).unwrap());

        // The part stands on the carriage Z: the tip is at (x, 0, -z) of the part.
        let tip = |[x, z]: [f64; 2]| [x, 0.0, -z];
        let error = error_at(&machine, &motions, &states, &Sample { position: &command, ..sample });
        prop_assert!(apart(sum(tip(command), error), tip(target)) < 1e-9);
        prop_assert!(apart(outcome.error, error_at(&machine, &motions, &states, &sample)) < 1e-15);
        prop_assert!(apart(outcome.remaining, [0.0; 3]) < 1e-12);
    }

    #[test]
    fn mill_with_a_turned_part(
        tool in prop::array::uniform3(-100.0..100.0_f64), slides in prop::array::uniform3(-300.0..300.0_f64),
        c in -7.0..7.0_f64, linear in prop::array::uniform5(coefficients()),
        angular in prop::array::uniform3(-1e-6..1e-6_f64), squareness in -5e-4..5e-4_f64,
        warm in 10.0..40.0_f64, before in -2.0..2.0_f64,
    ) {
        let machine = TableMill { tool };
        let axes = [0, 0, 1, 1, 2];
        let polynomial = |k: usize| Term::Polynomial { input: Input::Axis(axes[k]), coefficients: &linear[k] };
        let exx = [polynomial(0), Term::Backlash { axis: 0, lost_motion: 0.02, wind_up: 3.0, ramp: 0.0 }];
        let ezz = [polynomial(4), Term::Expansion { axis: 2, sensor: 0, coefficient: 12e-6, reference: 20.0 }];
        let others = [1, 2, 3].map(|k| [polynomial(k)]);
        let coupled = angular.map(|slope| [slope]);
        let rotations: Vec<[Term<'_>; 1]> =
            coupled.iter().map(|slope| [Term::Coupling { axis: 0, coefficients: slope }]).collect();
        let square = [Term::Constant { value: squareness }];
        let motions = [
            &exx[..], &others[0], &others[1], &others[2], &ezz,
            &rotations[0], &rotations[1], &rotations[2], &square,
        ].map(|terms| ErrorMotion { terms });
        let target = [slides[0], slides[1], slides[2], c];
        let mut start = target;
        start[0] -= before;
        let temperature = [warm];
        let sample = Sample { temperature: &temperature, ..at(&target) };
        let mut command = [0.0; 4];
        let (outcome, states) = with(&machine, &motions, |compensator| {
            compensator.error(&Sample { position: &start, ..sample }).unwrap();
            compensator.compensate(&sample, &mut command).unwrap()
        });

        // The rotary axis is left alone, and the tip in the frame of the part is the bed's, turned back.
        prop_assert_eq!(command[3], c);
        let tip = |p: [f64; 4]| TableMill::in_part(p[3], [p[0], p[1], p[2]]);
        let error = error_at(&machine, &motions, &states, &Sample { position: &command, ..sample });
        prop_assert!(apart(sum(tip(command), error), tip(target)) < 1e-9);
        prop_assert!(apart(outcome.remaining, [0.0; 3]) < 1e-12);
    }
}

#[test]
fn a_scale_is_inverted_in_full_and_not_to_first_order() {
    let exx = [Term::Polynomial { input: Input::Axis(0), coefficients: &[0.0, 0.01] }];
    let motions = [ErrorMotion { terms: &exx }];
    let mut command = [0.0];
    let (outcome, _) = with(&Slide, &motions, |c| c.compensate(&at(&[100.0]), &mut command).unwrap());
    assert!((command[0] - 100.0 / 1.01).abs() < 1e-10);
    assert_eq!(outcome.error, [1.0, 0.0, 0.0]);
    assert!((100.0 - outcome.error[0] - command[0]).abs() > 0.009); // what subtracting the error would leave
    // Each step is 0.01 of the one before: 1, 1e-2, ... below 1e-10 at the sixth or seventh.
    assert!((6..=7).contains(&outcome.iterations), "{}", outcome.iterations);
}

#[test]
fn a_positive_error_on_a_carriage_of_the_part_asks_for_less() {
    // EZZ > 0: the part stands too far along its axis, hence the tip too far towards -Z of the part; the command is less.
    let ezz = [Term::Constant { value: 0.02 }];
    let none: &[Term<'_>] = &[];
    let motions = [none, &ezz, none, none].map(|terms| ErrorMotion { terms });
    let mut command = [0.0; 2];
    let machine = Lathe { tool: [0.0, 0.0] };
    let (outcome, _) = with(&machine, &motions, |c| c.compensate(&at(&[10.0, 50.0]), &mut command).unwrap());
    assert_eq!(outcome.error, [0.0, 0.0, -0.02]);
    assert!((command[0] - 10.0).abs() < 1e-15 && (command[1] - 49.98).abs() < 1e-12);
}

#[test]
fn a_travel_follows_the_command_unless_it_is_given() {
    // EB0Z gives X an error of -dz * angle; EZZ of 2 mm moves the command of Z from 100 to 98.
    let eb0z = [Term::Constant { value: 1e-3 }];
    let ezz = [Term::Constant { value: 2.0 }];
    let none: &[Term<'_>] = &[];
    let motions = [none, &ezz, none, &eb0z].map(|terms| ErrorMotion { terms });
    let machine = Lathe { tool: [0.0, 0.0] };
    let target = [0.0, 100.0];
    let run = |travel: &[f64]| {
        let mut command = [0.0; 2];
        with(&machine, &motions, |c| c.compensate(&Sample { travel, ..at(&target) }, &mut command).unwrap());
        command
    };
    // Z goes to 98, and the travel with it: 0.098. A travel that is given stays: 0.1.
    assert!((run(&[])[0] - 0.098).abs() < 1e-12);
    assert!((run(&[100.0])[0] - 0.1).abs() < 1e-12);
    assert!((run(&[40.0])[0] - 0.04).abs() < 1e-12);
}

/// One slide in a direction of one's choice, with an error of one's choice: EX, EY, EZ.
struct Oblique([f64; 3]);

impl Kinematics for Oblique {
    fn axes(&self) -> usize {
        1
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        3
    }
    fn error(&self, _position: &[f64], _travel: &[f64], motions: &[f64]) -> [f64; 3] {
        [motions[0], motions[1], motions[2]]
    }
    fn directions(&self, _position: &[f64], directions: &mut [[f64; 3]]) {
        directions.fill(self.0);
    }
}

#[test]
fn what_no_axis_reaches_remains() {
    let ex = [Term::Constant { value: 0.01 }];
    let motions = [&ex[..], &[], &[]].map(|terms| ErrorMotion { terms });
    let run = |direction| {
        let mut command = [0.0];
        let machine = Oblique(direction);
        let (outcome, _) = with(&machine, &motions, |c| c.compensate(&at(&[7.0]), &mut command).unwrap());
        (command[0], outcome.remaining)
    };
    // Along (0.6, 0, 0.8) the slide makes 0.6 of the error; (0.0064, 0, -0.0048) stands across it.
    let (command, remaining) = run([0.6, 0.0, 0.8]);
    assert!((command - (7.0 - 0.006)).abs() < 1e-12);
    assert!(apart(remaining, [0.0064, 0.0, -0.0048]) < 1e-12);
    // Across the error, or unable to correct: nothing moves, all of it remains.
    for direction in [[0.0, 1.0, 0.0], [0.0; 3]] {
        assert_eq!(run(direction), (7.0, [0.01, 0.0, 0.0]));
    }
}
