//! A servo cycle asks for no memory. In: the five-axis machine, a term of every kind, thousands of cycles with switches,
//! refusals and silent sensors among them. Out: the count of an allocator that counts: none.

#![expect(clippy::unwrap_used, reason = "in a test a panic is the report")]

use abbe_generated::head_table_5axis::{Axes, Constants, Machine, Motions};
use abbe_runtime::{
    AxisMemory, Compensator, Direction, DirectionTracker, ErrorMotion, Factor, Input, Memory, Sample, State,
    Supervisor, Table, Term, TermState, Values, Within, Work, states_needed,
};

const CURVE: [f64; 4] = [0.0, 2e-3, 5e-3, 1e-3];

/// How many terms and factors there are.
const TERMS: usize = 21;

/// A term of every kind on X, which its temperature reads too, and behind every factor a constant.
fn terms() -> [Term<'static>; TERMS] {
    let (axis, sensor) = (0, 0);
    let directed = Values::Directed { forward: &CURVE, reverse: &CURVE };
    [
        Term::Constant { value: 1e-3 },
        Term::Polynomial { input: Input::Sensor(sensor), coefficients: &[0.0, 1e-4] },
        Term::Coupling { axis, coefficients: &[1e-6] },
        Term::Table { axis, table: Table::uniform(0.0, 100.0, Values::Both(&CURVE)).unwrap() },
        Term::Table { axis, table: Table::at(&[0.0, 50.0, 80.0, 300.0], directed).unwrap() },
        Term::Backlash { axis, lost_motion: 8e-3, wind_up: 1.0, ramp: 0.1 },
        Term::Cyclic { axis, period: 10.0, amplitude: 1e-3, phase: 0.1 },
        Term::Expansion { axis, sensor, coefficient: 1e-5, reference: 20.0 },
        Term::Growth { sensor, coefficient: 1e-3, reference: 20.0, time_constant: 600.0 },
        Term::Lag { axis, gain: 30.0 },
        Term::Factor(Factor::Position { axis, power: 2, within: Within { from: 0.0, to: 3.0 } }),
        Term::Factor(Factor::Direction { axis }),
        Term::Factor(Factor::Velocity { axis, within: Within { from: -1.0, to: 1.0 } }),
        Term::Factor(Factor::Speed { axis, within: Within { from: 0.0, to: 1.0 } }),
        Term::Factor(Factor::Fading { axis, over: 100.0 }),
        Term::Factor(Factor::Temperature {
            sensor,
            reference: 20.0,
            time_constant: 9.0,
            within: Within::EVERYWHERE,
        }),
        Term::Factor(Factor::Play { sensor, reference: 20.0, width: 0.5 }),
        Term::Factor(Factor::Warmth { axis, time_constant: 9.0, rise: 0.01 }),
        Term::Factor(Factor::Turn { axis, period: 10.0, phase: 0.0 }),
        Term::Factor(Factor::Curve { axis, table: Table::at(&[0.0, 50.0, 80.0, 300.0], directed).unwrap() }),
        Term::Constant { value: 1e-6 },
    ]
}

#[test]
fn a_servo_cycle_asks_for_no_memory() {
    let terms = terms();
    let machine = Machine { constants: Constants::from_array([100.0; Constants::NAMES.len()]) };
    let mut active = 0;
    let counted = allocation_counter::measure(|| active = run(&machine, &terms));
    assert!(active > 5_000, "most cycles correct something: {active}");
    assert_eq!(counted.count_total, 0, "{counted:?}");
    // The counter counts.
    assert_eq!(allocation_counter::measure(|| drop(std::hint::black_box(Box::new(1)))).count_total, 1);
}

/// Sets up a supervisor on the stack and runs it; tells how many cycles were active.
fn run(machine: &Machine, terms: &[Term<'_>]) -> u32 {
    let mut motions = [ErrorMotion::default(); Motions::NAMES.len()];
    motions[0] = ErrorMotion { terms };
    let mut states = [TermState::default(); TERMS];
    assert_eq!(states_needed(&motions), states.len());
    let (mut directions, mut values) = ([[0.0; 3]; Axes::NAMES.len()], [0.0; Motions::NAMES.len()]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
    let compensator = Compensator::new(machine, &motions, &mut states, work).unwrap();
    let (mut axes, mut readings, mut silence) = ([AxisMemory::default(); Axes::NAMES.len()], [0.0], [0.0]);
    let memory = Memory { axes: &mut axes, temperature: &mut readings, silence: &mut silence };
    let mut supervisor = Supervisor::new(compensator, memory).unwrap();
    let mut tracker = DirectionTracker::new(1e-3);
    let mut active = 0;
    for cycle in 0..10_000_u32 {
        let x = 150.0 + 100.0 * (f64::from(cycle) * 0.01).sin();
        let mut position = [0.0; Axes::NAMES.len()];
        position[0] = if cycle % 997 == 0 { f64::NAN } else { x };
        let mut direction = [Direction::Positive; Axes::NAMES.len()];
        direction[0] = tracker.update(x);
        supervisor.compensator.enabled = cycle % 4_000 < 3_500;
        let reading = if cycle % 3_000 > 1_000 { 25.0 } else { f64::NAN };
        let sample = Sample {
            position: &position,
            travel: &[],
            direction: &direction,
            velocity: &[1.0; Axes::NAMES.len()],
            temperature: &[reading],
            time_step: 0.001,
        };
        let mut command = [0.0; Axes::NAMES.len()];
        let done = supervisor.cycle(&sample, &mut command);
        active += u32::from(matches!(done.state, State::Active | State::Holding { .. }));
    }
    active
}
