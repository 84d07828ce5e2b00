//! Whatever a sample holds, a cycle answers: any bits of a number, in any place, cycle after cycle.
//!
//! In: positions, velocities, temperatures and time steps of arbitrary bits; terms of every kind. Out: finite commands
//! within the limit, or a refusal that leaves the position alone. It exists because a cycle that ends the program, or writes
//! what is no number, stops a machine.

use abbe_runtime::{
    AxisMemory, Compensator, Direction, ErrorMotion, Input, Limits, Memory, Sample, Supervisor, Table, Term,
    TermState, Values, Work,
};
use proptest::prelude::*;

use crate::common::{Lathe, with};

const LIMIT: f64 = 0.5;
const LATHE: Lathe = Lathe { tool: [80.0, -120.0] };
const CURVE: [f64; 3] = [0.0, 0.01, -0.02];

/// A term of every kind, and a table from high to low.
fn terms() -> [Term<'static>; 11] {
    let axis = 0;
    let both = Values::Both(&CURVE);
    [
        Term::Constant { value: 0.01 },
        Term::Polynomial { input: Input::Axis(axis), coefficients: &[0.0, 1e-5, 1e-9] },
        Term::Polynomial { input: Input::Sensor(0), coefficients: &[0.0, 1e-4] },
        Term::Coupling { axis: 1, coefficients: &[1e-6] },
        Term::Table { axis, table: Table::uniform(300.0, -100.0, both).unwrap() },
        Term::Backlash { axis, lost_motion: 8e-3, wind_up: 1.0, ramp: 0.1 },
        Term::Cyclic { axis, period: 10.0, amplitude: 1e-3, phase: 0.1 },
        Term::Expansion { axis, sensor: 0, coefficient: 1e-5, reference: 20.0 },
        Term::Growth { sensor: 0, coefficient: 1e-3, reference: 20.0, time_constant: 600.0 },
        Term::Growth { sensor: 0, coefficient: 1e-3, reference: 20.0, time_constant: 0.0 },
        Term::Lag { axis, gain: 30.0 },
    ]
}

/// Numbers as a machine has them, and numbers of any bits.
fn number(usual: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![3 => usual, 1 => any::<u64>().prop_map(f64::from_bits)]
}

/// The numbers of one sample: positions, velocities, a temperature, a time step, directions.
type Numbers = ([f64; 2], [f64; 2], f64, f64, [bool; 2]);

fn numbers() -> impl Strategy<Value = Numbers> {
    let pair = |range: std::ops::Range<f64>| [number(range.clone()), number(range)];
    (pair(-100.0..400.0), pair(-50.0..50.0), number(10.0..40.0), number(0.0..0.01), any::<[bool; 2]>())
}

/// Hands a sample of these numbers to the test.
fn sampled<R>(
    &(position, velocity, temperature, time_step, turned): &Numbers,
    test: impl FnOnce(&Sample<'_>) -> R,
) -> R {
    let direction = turned.map(|turned| if turned { Direction::Negative } else { Direction::Positive });
    test(&Sample {
        position: &position,
        travel: &[],
        direction: &direction,
        velocity: &velocity,
        temperature: &[temperature],
        time_step,
    })
}

/// The error motions of the lathe: every term in EXX, an angle in EBX.
fn motions<'t>(terms: &'t [Term<'t>]) -> [ErrorMotion<'t>; 4] {
    let none = ErrorMotion::default();
    [ErrorMotion { terms }, none, ErrorMotion { terms: &terms[..1] }, none]
}

/// The longest correction: far out, where doubles stand apart, it is rounded to their distance.
fn longest(positions: [f64; 2]) -> f64 {
    let far = positions
        .into_iter()
        .filter(|position| position.is_finite())
        .fold(0.0, |far: f64, at| far.max(at.abs()));
    LIMIT + 1e-9 + 2.0 * far * f64::EPSILON
}

fn compensated(compensator: &mut Compensator<'_, Lathe>, numbers: &Numbers) -> Result<(), TestCaseError> {
    let mut out = [0.0; 2];
    let Ok(outcome) = sampled(numbers, |sample| compensator.compensate(sample, &mut out)) else {
        prop_assert_eq!(out.map(f64::to_bits), numbers.0.map(f64::to_bits));
        return Ok(());
    };
    prop_assert!(outcome.iterations <= compensator.convergence.iterations);
    prop_assert!(out.iter().chain(&outcome.error).chain(&outcome.remaining).all(|value| value.is_finite()));
    let [x, z] = numbers.0;
    prop_assert!((out[0] - x).hypot(out[1] - z) <= longest(numbers.0), "{:?}", out);
    Ok(())
}

fn supervised(supervisor: &mut Supervisor<'_, Lathe>, numbers: &Numbers) -> Result<(), TestCaseError> {
    let mut out = [0.0; 2];
    let cycle = sampled(numbers, |sample| supervisor.cycle(sample, &mut out));
    prop_assert!(cycle.correction <= longest(numbers.0), "{:?}", cycle);
    for (command, position) in out.into_iter().zip(numbers.0) {
        prop_assert_eq!(command.is_finite(), position.is_finite(), "{} {:?}", position, cycle);
    }
    Ok(())
}

proptest! {
    #[test]
    fn a_compensator_corrects_within_its_limit_or_not_at_all(cycles in prop::collection::vec(numbers(), 1..20)) {
        let terms = terms();
        let (result, _) = with(&LATHE, &motions(&terms), |compensator| {
            compensator.limits = Limits { compensation: Some(LIMIT), ..Limits::default() };
            cycles.iter().try_for_each(|numbers| compensated(compensator, numbers))
        });
        result?;
    }

    #[test]
    fn a_supervisor_writes_numbers_within_the_limit(cycles in prop::collection::vec(numbers(), 1..20)) {
        let terms = terms();
        let motions = motions(&terms);
        let mut states = [TermState::default(); 12];
        let (mut directions, mut values, mut travel) = ([[0.0; 3]; 2], [0.0; 4], [0.0; 1]);
        let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
        let mut compensator = Compensator::new(&LATHE, &motions, &mut states, work).unwrap();
        compensator.limits = Limits { compensation: Some(LIMIT), ..Limits::default() };
        let (mut axes, mut readings, mut silence) = ([AxisMemory::default(); 2], [0.0], [0.0]);
        let memory = Memory { axes: &mut axes, temperature: &mut readings, silence: &mut silence };
        let mut supervisor = Supervisor::new(compensator, memory).unwrap();
        cycles.iter().try_for_each(|numbers| supervised(&mut supervisor, numbers))?;
    }
}
