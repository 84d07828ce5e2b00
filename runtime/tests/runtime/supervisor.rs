//! The supervisor: switches, refusals, silent sensors, limits of the rate; in cycles drawn at random and in ones laid out.
//!
//! In: samples cycle after cycle, and what happens to them. Out: commands, held against plain compensators and against
//! the straight lines that a fade is. It exists because a jump of a command is felt on the part, and no formula shows it.

use abbe_runtime::{
    AxisMemory, Compensator, Cycle, Direction, ErrorMotion, Input, Limits, Memory, Refusal, Sample,
    SetupError, State, Supervisor, Term, TermState, Transition, Work,
};
use proptest::prelude::*;

use crate::common::{Lathe, with};

/// A servo cycle, s.
const STEP: f64 = 0.001;
/// Rounding of sums of micrometres at positions of metres, mm.
const ROUNDING: f64 = 1e-12;
const POSITIVE: [Direction; 2] = [Direction::Positive; 2];
const LATHE: Lathe = Lathe { tool: [80.0, -120.0] };

/// Scale and play of X, warmth that moves Z, a carriage that yaws; one sensor.
const EXX: [Term<'static>; 2] = [
    Term::Polynomial { input: Input::Axis(0), coefficients: &[0.010, 50e-6] },
    Term::Backlash { axis: 0, lost_motion: 0.008, wind_up: 0.0, ramp: 0.0 },
];
const EZZ: [Term<'static>; 1] =
    [Term::Growth { sensor: 0, coefficient: 0.002, reference: 20.0, time_constant: 0.0 }];
const EBX: [Term<'static>; 1] = [Term::Cyclic { axis: 0, period: 10.0, amplitude: 20e-6, phase: 0.3 }];
const MOTIONS: [ErrorMotion<'static>; 4] = [
    ErrorMotion { terms: &EXX },
    ErrorMotion { terms: &EZZ },
    ErrorMotion { terms: &EBX },
    ErrorMotion { terms: &[] },
];

/// A supervisor of the lathe in fresh storage, handed to the test.
fn supervised<R>(transition: Transition, test: impl FnOnce(&mut Supervisor<'_, Lathe>) -> R) -> R {
    let mut states = [TermState::default(); 4];
    let (mut directions, mut values, mut travel) = ([[0.0; 3]; 2], [0.0; 4], [0.0; 1]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let compensator = Compensator::new(&LATHE, &MOTIONS, &mut states, work).unwrap();
    let (mut axes, mut temperature, mut silence) = ([AxisMemory::default(); 2], [0.0], [f64::NAN]);
    let memory = Memory { axes: &mut axes, temperature: &mut temperature, silence: &mut silence };
    let mut supervisor = Supervisor::new(compensator, memory).unwrap();
    supervisor.transition = transition;
    test(&mut supervisor)
}

/// A sample of the lathe.
fn sample<'a>(
    position: &'a [f64; 2],
    direction: &'a [Direction; 2],
    temperature: &'a [f64; 1],
) -> Sample<'a> {
    Sample { position, travel: &[], direction, velocity: &[], temperature, time_step: STEP }
}

/// One cycle at rest at X 100, Z 300: what was done, and the correction of each axis.
fn rest(supervisor: &mut Supervisor<'_, Lathe>, temperature: f64) -> (Cycle, [f64; 2]) {
    let (position, mut out) = ([100.0, 300.0], [f64::NAN; 2]);
    let cycle = supervisor.cycle(&sample(&position, &POSITIVE, &[temperature]), &mut out);
    (cycle, [out[0] - 100.0, out[1] - 300.0])
}

/// What a plain compensator writes for a sample.
fn plain(sample: &Sample<'_>, limit: Option<f64>) -> (Result<abbe_runtime::Outcome, Refusal>, [f64; 2]) {
    let mut out = [f64::NAN; 2];
    let (result, _) = with(&LATHE, &MOTIONS, |compensator| {
        compensator.limits = Limits { compensation: limit, ..Limits::default() };
        compensator.compensate(sample, &mut out)
    });
    (result, out)
}

fn fading(hold: f64, fade: f64) -> Transition {
    Transition { hold, fade, ..Transition::default() }
}

fn length([x, z]: [f64; 2]) -> f64 {
    x.hypot(z)
}

fn close(found: [f64; 2], expected: [f64; 2]) -> bool {
    found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < ROUNDING)
}

#[test]
fn compensation_comes_and_goes_along_a_straight_line() {
    let (_, [x, z]) = plain(&sample(&[100.0, 300.0], &POSITIVE, &[25.0]), None);
    let full = [x - 100.0, z - 300.0];
    assert!(length(full) > 0.010, "there is something to fade: {full:?}");
    supervised(fading(1.0, 0.004), |supervisor| {
        for part in [0.25, 0.5, 0.75, 1.0, 1.0] {
            let (cycle, made) = rest(supervisor, 25.0);
            assert!(close(made, full.map(|axis| axis * part)), "{part}: {made:?}");
            assert_eq!((cycle.state, cycle.settling), (State::Active, part < 1.0));
        }
        supervisor.compensator.enabled = false;
        for part in [0.75, 0.5] {
            let (cycle, made) = rest(supervisor, 25.0);
            assert!(close(made, full.map(|axis| axis * part)), "{part}: {made:?}");
            assert_eq!((cycle.state, cycle.settling), (State::Off, true));
        }
        // On again before it is out: from where it is, over the whole time.
        supervisor.compensator.enabled = true;
        for part in [0.625, 0.75, 0.875, 1.0] {
            let (_, made) = rest(supervisor, 25.0);
            assert!(close(made, full.map(|axis| axis * part)), "{part}: {made:?}");
        }
        supervisor.compensator.enabled = false;
        let last = (0..4).map(|_| rest(supervisor, 25.0)).last().unwrap();
        assert_eq!((last.1, last.0.correction, last.0.settling), ([0.0; 2], 0.0, false));
    });
}

#[test]
fn a_silent_sensor_is_held_then_compensation_fades_and_returns_with_it() {
    supervised(fading(0.003, 0.002), |supervisor| {
        rest(supervisor, 30.0);
        let (_, full) = rest(supervisor, 30.0);
        assert!(full[1] < -0.015, "ten degrees make 20 um: {full:?}");
        for _ in 0..3 {
            let (cycle, made) = rest(supervisor, f64::NAN);
            assert_eq!((cycle.state, made), (State::Holding { sensor: 0 }, full));
        }
        for part in [0.5, 0.0, 0.0] {
            let (cycle, made) = rest(supervisor, f64::INFINITY);
            assert_eq!(cycle.state, State::Lost { sensor: 0 });
            assert!(cycle.outcome.is_ok(), "the error is still told");
            assert!(close(made, full.map(|axis| axis * part)), "{part}: {made:?}");
        }
        for part in [0.5, 1.0] {
            let (cycle, made) = rest(supervisor, 30.0);
            assert_eq!(cycle.state, State::Active);
            assert!(close(made, full.map(|axis| axis * part)), "{part}: {made:?}");
        }
    });
}

#[test]
fn a_sensor_that_returns_with_another_reading_moves_nothing_at_once() {
    supervised(fading(1.0, 0.004), |supervisor| {
        for _ in 0..4 {
            rest(supervisor, 20.0);
        }
        let (_, before) = rest(supervisor, 20.0);
        rest(supervisor, f64::NAN);
        // Ten degrees more: 20 um of Z, a quarter of them a cycle.
        for part in [0.25, 0.5, 0.75, 1.0] {
            let (_, made) = rest(supervisor, 30.0);
            // Z of the machine moves the tip of this lathe towards -Z: E of Z is -EZZ.
            assert!((made[1] - before[1] + 0.020 * part).abs() < ROUNDING, "{part}: {before:?} {made:?}");
        }
    });
}

#[test]
fn a_sensor_that_never_spoke_lets_nothing_through() {
    supervised(fading(1.0, 0.002), |supervisor| {
        for _ in 0..3 {
            let (cycle, made) = rest(supervisor, f64::NAN);
            assert_eq!(
                (cycle.state, cycle.outcome, made),
                (State::Refused, Err(Refusal::NotFinite), [0.0; 2])
            );
        }
    });
}

#[test]
fn a_refusal_fades_and_never_cuts() {
    supervised(fading(1.0, 0.004), |supervisor| {
        let full = (0..4).map(|_| rest(supervisor, 25.0).1).last().unwrap();
        supervisor.compensator.limits = Limits { compensation: Some(0.001), ..Limits::default() };
        for part in [0.75, 0.5, 0.25, 0.0] {
            let (cycle, made) = rest(supervisor, 25.0);
            assert_eq!(cycle.state, State::Refused);
            assert!(matches!(cycle.outcome, Err(Refusal::OverLimit { .. })));
            assert!(close(made, full.map(|axis| axis * part)), "{part}: {made:?}");
        }
    });
}

#[test]
fn one_bad_position_passes_and_takes_nothing_from_the_other_axis() {
    supervised(fading(1.0, 0.004), |supervisor| {
        let full = (0..4).map(|_| rest(supervisor, 25.0).1).last().unwrap();
        let (position, mut out) = ([f64::NAN, 300.0], [0.0; 2]);
        let cycle = supervisor.cycle(&sample(&position, &POSITIVE, &[25.0]), &mut out);
        assert_eq!(cycle.state, State::Refused);
        assert!(out[0].is_nan(), "no position is made up");
        assert!((out[1] - 300.0 - 0.75 * full[1]).abs() < ROUNDING);
    });
}

/// A sensor returns with 90 degrees less, and has the old reading again one cycle later: what is wanted is then where the
/// correction was, and the rest of the fade comes on top of it.
#[test]
fn a_fade_stays_within_the_limit_where_the_wanted_correction_turns() {
    let greatest = |limit: Option<f64>| {
        supervised(fading(1.0, 0.010), |supervisor| {
            supervisor.compensator.limits.compensation = limit;
            let full = (0..12).map(|_| rest(supervisor, 110.0).0.correction).last().unwrap();
            assert!((0.18..0.2).contains(&full), "90 degrees make 180 um: {full}");
            rest(supervisor, f64::NAN);
            rest(supervisor, -70.0);
            let made: Vec<f64> = (0..12).map(|_| rest(supervisor, 110.0).0.correction).collect();
            assert!((made[11] - full).abs() < ROUNDING, "{made:?}");
            made.into_iter().fold(0.0, f64::max)
        })
    };
    assert!(greatest(None) > 0.4);
    assert!((greatest(Some(0.2)) - 0.2).abs() < ROUNDING);
}

#[test]
fn where_time_stands_still_so_does_the_correction() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        supervised(fading(1.0, 0.004), |supervisor| {
            let full = (0..4).map(|_| rest(supervisor, 25.0).1).last().unwrap();
            supervisor.compensator.enabled = false;
            let (position, mut out) = ([100.0, 300.0], [0.0; 2]);
            let still = Sample { time_step: bad, ..sample(&position, &POSITIVE, &[25.0]) };
            supervisor.cycle(&still, &mut out);
            assert!(close([out[0] - 100.0, out[1] - 300.0], full), "{bad}: {out:?}");
        });
    }
}

#[test]
fn a_restart_forgets_the_readings_and_leaves_the_correction_made() {
    supervised(fading(1.0, 0.004), |supervisor| {
        let (_, full) = (0..5).map(|_| rest(supervisor, 25.0)).last().unwrap();
        assert!(length(full) > 0.010, "there is something to fade: {full:?}");
        supervisor.restart();
        // No reading is left that a silent sensor could be given.
        for part in [0.75, 0.5] {
            let (cycle, made) = rest(supervisor, f64::NAN);
            assert_eq!((cycle.outcome, cycle.state), (Err(Refusal::NotFinite), State::Refused));
            assert!(close(made, full.map(|axis| axis * part)), "{part}: {made:?}");
        }
    });
}

#[test]
fn what_has_arrived_stays_arrived_while_time_stands_still() {
    supervised(Transition { rate: Some(2.0), fade: 0.001, ..Transition::default() }, |supervisor| {
        let (last, full) = (0..40).map(|_| rest(supervisor, 25.0)).last().unwrap();
        assert!(!last.settling && length(full) > 0.010, "{last:?}");
        let (position, mut out) = ([100.0, 300.0], [0.0; 2]);
        let still = Sample { time_step: 0.0, ..sample(&position, &POSITIVE, &[25.0]) };
        let cycle = supervisor.cycle(&still, &mut out);
        assert!(!cycle.settling, "{cycle:?}");
        assert_eq!([out[0] - 100.0, out[1] - 300.0], full);
    });
}

#[test]
fn slices_of_a_wrong_length_are_left_alone() {
    supervised(Transition::default(), |supervisor| {
        let position = [100.0, 300.0];
        let mut short = [7.0];
        let cycle = supervisor.cycle(&sample(&position, &POSITIVE, &[25.0]), &mut short);
        assert_eq!(cycle.outcome, Err(Refusal::Length { slice: "out", expected: 2, found: 1 }));
        assert_eq!((cycle.state, short), (State::Refused, [7.0]));
        let mut out = [7.0; 2];
        let none = Sample { temperature: &[], ..sample(&position, &POSITIVE, &[25.0]) };
        let cycle = supervisor.cycle(&none, &mut out);
        assert_eq!(cycle.outcome, Err(Refusal::Length { slice: "temperature", expected: 1, found: 0 }));
        assert_eq!(out, position);
    });
}

#[test]
fn the_storage_is_checked() {
    let (mut axes, mut reading) = ([AxisMemory::default(); 2], [0.0]);
    let mut states = [TermState::default(); 4];
    let (mut directions, mut values, mut travel) = ([[0.0; 3]; 2], [0.0; 4], [0.0; 1]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let compensator = Compensator::new(&LATHE, &MOTIONS, &mut states, work).unwrap();
    let memory = Memory { axes: &mut axes, temperature: &mut reading, silence: &mut [] };
    let wrong = Supervisor::new(compensator, memory).err();
    assert_eq!(wrong, Some(SetupError::Length { slice: "memory.silence", expected: 1, found: 0 }));
}

#[test]
fn a_reversal_is_taken_over_as_fast_as_the_rate_lets_it() {
    let transition = Transition { rate: Some(2.0), fade: 0.001, ..Transition::default() };
    supervised(transition, |supervisor| {
        // 2 um a cycle: the first correction takes its time too.
        let (mut made, mut cycles) = ([0.0; 2], 0);
        loop {
            let (cycle, next) = rest(supervisor, 20.0);
            let step = length([next[0] - made[0], next[1] - made[1]]);
            assert!(step < 0.002 + ROUNDING, "{step}");
            (made, cycles) = (next, cycles + 1);
            if !cycle.settling {
                break;
            }
            assert!((step - 0.002).abs() < ROUNDING, "as fast as it may: {step}");
        }
        assert!(cycles > 3, "{cycles}");
        // X turns: 8 um of play change sides in four cycles.
        let (position, turned) = ([100.0, 300.0], [Direction::Negative, Direction::Positive]);
        for cycle in 1..=5 {
            let mut out = [0.0; 2];
            let done = supervisor.cycle(&sample(&position, &turned, &[20.0]), &mut out);
            // Where X stands changes the yaw, and over 120 mm the correction by 12 nm: the fifth cycle makes that.
            let expected = made[0] - 0.002 * f64::from(cycle.min(4));
            assert!((out[0] - 100.0 - expected).abs() < 2e-5, "{cycle}: {} {expected}", out[0] - 100.0);
            assert_eq!(done.settling, cycle < 5);
        }
    });
}

#[test]
fn a_new_supervisor_takes_over_where_the_old_one_stopped() {
    let mut axes = [AxisMemory::default(); 2];
    let mut made = [0.0; 2];
    for cycle in 0..20 {
        let mut states = [TermState::default(); 4];
        let (mut directions, mut values, mut travel) = ([[0.0; 3]; 2], [0.0; 4], [0.0; 1]);
        let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
        let compensator = Compensator::new(&LATHE, &MOTIONS, &mut states, work).unwrap();
        let memory = Memory { axes: &mut axes, temperature: &mut [0.0], silence: &mut [0.0] };
        let mut supervisor = Supervisor::new(compensator, memory).unwrap();
        supervisor.transition.fade = 0.010;
        let (_, next) = rest(&mut supervisor, 25.0);
        assert!(length([next[0] - made[0], next[1] - made[1]]) < 0.1 * 0.05, "{cycle}: {made:?} {next:?}");
        assert!(cycle == 0 || length(next) > length(made));
        made = next;
    }
    assert!((axes[0].made() - made[0]).abs() < ROUNDING);
}

/// What happens in one cycle of a run drawn at random.
#[derive(Clone, Copy, Debug)]
struct Event {
    /// Way of X and Z in this cycle, mm.
    way: [f64; 2],
    temperature: f64,
    enabled: bool,
    limit: Option<f64>,
    time_step: f64,
}

fn event() -> impl Strategy<Value = Event> {
    let temperature = prop_oneof![6 => 15.0..35.0, 2 => Just(f64::NAN), 1 => Just(1e9)];
    let limit = prop_oneof![4 => Just(None), 3 => Just(Some(0.2)), 1 => Just(Some(0.005))];
    let time_step = prop_oneof![6 => Just(STEP), 1 => 0.0..0.01, 1 => Just(0.0), 1 => Just(f64::NAN)];
    let way = prop_oneof![8 => prop::array::uniform2(-0.2..0.2), 1 => Just([f64::NAN, 0.0])];
    (way, temperature, prop::bool::weighted(0.8), limit, time_step).prop_map(
        |(way, temperature, enabled, limit, time_step)| Event { way, temperature, enabled, limit, time_step },
    )
}

/// Runs of a few events each, so that states last.
fn events() -> impl Strategy<Value = Vec<Event>> {
    prop::collection::vec((event(), 1..8_usize), 1..40).prop_map(|runs| {
        runs.into_iter().flat_map(|(event, times)| std::iter::repeat_n(event, times)).collect()
    })
}

proptest! {
    /// Whatever happens, the correction changes by no more than the rate allows, stays finite, and never grows beyond the
    /// greatest limit in force.
    #[test]
    fn the_rate_holds_whatever_happens(events in events(), rate in 0.0..5.0_f64, fade in 0.0..0.02_f64) {
        supervised(Transition { rate: Some(rate), hold: 0.003, fade, ..Transition::default() }, |supervisor| {
            let (mut x, mut z, mut before, mut time) = (0.0, 0.0, [0.0; 2], 0.0);
            for event in events {
                let [way_x, way_z] = event.way;
                let position = [x + way_x, z + way_z];
                if way_x.is_finite() {
                    [x, z] = position;
                }
                supervisor.compensator.enabled = event.enabled;
                supervisor.compensator.limits = Limits { compensation: event.limit, ..Limits::default() };
                let mut out = [0.0; 2];
                let given = [event.temperature];
                let sample = Sample { time_step: event.time_step, ..sample(&position, &POSITIVE, &given) };
                let cycle = supervisor.cycle(&sample, &mut out);
                time += if event.time_step > 0.0 { event.time_step } else { 0.0 };
                prop_assert!(cycle.correction.is_finite());
                if !way_x.is_finite() {
                    continue; // X has no command, and none to compare with in the next cycle.
                }
                let made = [out[0] - x, out[1] - z];
                let changed = length([made[0] - before[0], made[1] - before[1]]);
                prop_assert!(changed <= (1.0 + 1e-9) * rate * time + ROUNDING, "{changed} {cycle:?} {event:?}");
                if let (Some(limit), true) = (event.limit, cycle.correction > length(before) + ROUNDING) {
                    prop_assert!(cycle.correction <= limit + ROUNDING, "{cycle:?}");
                }
                (before, time) = (made, 0.0);
            }
            Ok(())
        })?;
    }

    /// Without a limit of the rate, a switch changes the correction by no more than its share of the fade: at rest, where
    /// the compensator asks for one thing or for nothing.
    #[test]
    fn switches_are_bumpless(switches in prop::collection::vec((any::<bool>(), any::<bool>(), 1..30_usize), 1..20)) {
        supervised(fading(0.003, 0.020), |supervisor| {
            let (cycle, _) = rest(supervisor, 25.0);
            let greatest = 20.0 * cycle.correction;
            let mut before = cycle.correction;
            for (enabled, speaks, times) in switches {
                supervisor.compensator.enabled = enabled;
                for _ in 0..times {
                    let (cycle, made) = rest(supervisor, if speaks { 25.0 } else { f64::NAN });
                    prop_assert!((cycle.correction - before).abs() <= greatest / 20.0 + ROUNDING, "{cycle:?}");
                    prop_assert!((length(made) - cycle.correction).abs() < ROUNDING);
                    prop_assert!(cycle.correction <= greatest + ROUNDING);
                    before = cycle.correction;
                }
            }
            Ok(())
        })?;
    }

    /// Once settled, the commands are those of a plain compensator, bit for bit.
    #[test]
    fn settled_it_is_the_compensator_itself(ways in prop::collection::vec(prop::array::uniform2(-0.5..0.5), 1..60)) {
        supervised(fading(1.0, 0.005), |supervisor| {
            let mut position = [100.0, 300.0];
            for (cycle, [x, z]) in ways.into_iter().enumerate() {
                position = [position[0] + x, position[1] + z];
                let sample = sample(&position, &POSITIVE, &[25.0]);
                let mut out = [0.0; 2];
                let done = supervisor.cycle(&sample, &mut out);
                let (outcome, expected) = plain(&sample, None);
                prop_assert_eq!(done.outcome, outcome);
                prop_assert_eq!(done.settling, cycle < 4);
                if !done.settling {
                    prop_assert_eq!(out.map(f64::to_bits), expected.map(f64::to_bits));
                }
            }
            Ok(())
        })?;
    }
}
