//! Searches for a command whose steps are coarse.
//!
//! In: a slide far from its zero, a rotary table that corrects its own angle. Out: the command as near as its steps come to it; no search
//! that goes to and fro between two neighbours until it is given up.

use abbe_runtime::single::{
    Compensator, Direction, ErrorMotion, Input, Kinematics, Refusal, Sample, SetupError, Share, Term,
    TermState, Turning, Work,
};

use crate::{ROUNDING, drawn};

/// A slide X and a table C, which corrects its own angle, and behind them a motor that follows X; motions EXX and ECC.
struct TurningTable;

impl Kinematics for TurningTable {
    fn axes(&self) -> usize {
        3
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        2
    }
    fn error(&self, _: &[f32], _: &[f32], motions: &[f32]) -> [f32; 3] {
        [motions[0], 0.0, 0.0]
    }
    fn turning(&self) -> &[Turning] {
        &[Turning { axis: 1, motion: 1 }]
    }
    fn following(&self) -> &[Share] {
        &[Share { motor: 2, of: 0, weight: 1.0 }]
    }
    fn directions(&self, _: &[f32], directions: &mut [[f32; 3]]) {
        directions.copy_from_slice(&[[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
    }
}

const SCALE: f32 = 0.0009765625;

fn commands(positions: &[[f32; 3]]) -> Vec<Result<[f32; 3], Refusal>> {
    let (exx, ecc) = (
        [Term::Polynomial { input: Input::Axis(0), coefficients: &[0.03, SCALE] }],
        [Term::Polynomial { input: Input::Axis(1), coefficients: &[0.0001, SCALE] }],
    );
    let motions = [ErrorMotion { terms: &exx }, ErrorMotion { terms: &ecc }];
    let (mut states, mut directions, mut values) = ([TermState::default(); 2], [[0.0; 3]; 3], [0.0; 2]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
    let compensator: Result<_, SetupError> = Compensator::new(&TurningTable, &motions, &mut states, work);
    let mut compensator = compensator.unwrap();
    let compensate = |position: &[f32; 3]| {
        let sample = Sample {
            position,
            travel: &[],
            direction: &[Direction::Positive; 3],
            velocity: &[],
            temperature: &[],
            time_step: 0.001,
        };
        let mut command = [0.0; 3];
        compensator.compensate(&sample, &mut command).map(|_| command)
    };
    positions.iter().map(compensate).collect()
}

/// The command c of c + c0 + s c = target, from numbers of 64 bits, and how far the steps of 32 bits may keep from it: half of one, what
/// the error changes by over one and over the step that ends a search, and what it is rounded by.
fn expected(target: f32, offset: f32) -> (f64, f64) {
    let [target, offset, scale] = [target, offset, SCALE].map(f64::from);
    let command = (target - offset) / (1.0 + scale);
    let step = f64::from((command as f32).abs().next_up() - (command as f32).abs());
    (command, step * (0.5 + scale) + scale * 1e-6 + 4.0 * ROUNDING * (scale * command.abs() + offset))
}

/// Up to two metres, and up to sixteen turns, whose steps are 8 urad. An error of 1 mm/m is ten times that of a bad machine: commands
/// are so near to the middle between two steps the more often the faster it changes.
#[test]
fn every_command_is_found_as_near_as_its_steps_come() {
    let mut draw = drawn(5);
    let positions: Vec<[f32; 3]> = (0..200_000)
        .map(|_| {
            let x = 2000.0 * draw();
            [x, 100.0 * draw(), x]
        })
        .collect();
    for (position, command) in positions.iter().zip(commands(&positions)) {
        let [x, c, motor] = command.unwrap_or_else(|refusal| panic!("{position:?}: {refusal}"));
        for (found, (expected, bound)) in
            [(x, expected(position[0], 0.03)), (c, expected(position[1], 0.0001))]
        {
            assert!((f64::from(found) - expected).abs() <= bound, "{position:?}: {found} is not {expected}");
        }
        // The motor goes as far as its axis, and is rounded once more.
        assert!((motor - x).abs() <= 2000.0 * f32::EPSILON, "{position:?}: {motor} is not {x}");
    }
}

/// Where a motor stands is a sum of rounded positions; what is farther off is a mistake.
#[test]
fn a_motor_may_be_where_rounding_puts_it() {
    let found = commands(&[[1900.0, 0.0, 1900.0_f32.next_up()], [1900.0, 0.0, 1900.002]]);
    assert!(found[0].is_ok(), "{:?}", found[0]);
    assert!(matches!(found[1], Err(Refusal::Motor { axis: 2, .. })), "{:?}", found[1]);
}
