//! Times: cycles of a tenth of a millisecond, of which each alone is lost in a coarse sum.
//!
//! In: slow filters, clocks and fades. Out: that they go on, at the pace that they should have.

use abbe_runtime::single::{
    AxisMemory, Compensator, Direction, ErrorMotion, Kinematics, Memory, Sample, State, Supervisor, Term,
    TermState, Transition, Work,
};

const CYCLE: f32 = 1e-4;

fn sample<'a>(position: &'a [f32], temperature: &'a [f32]) -> Sample<'a> {
    Sample {
        position,
        travel: &[],
        direction: &[Direction::Positive],
        velocity: &[],
        temperature,
        time_step: CYCLE,
    }
}

/// 1 K for a minute behind a filter of an hour: 1 - exp(-1/60) of it. Each cycle adds 3e-8 K to 20 degC, whose steps are 2e-6 K.
#[test]
fn a_slow_filter_follows() {
    let growth = Term::Growth { sensor: 0, coefficient: 1.0, reference: 20.0, time_constant: 3600.0 };
    let mut state = TermState::default();
    growth.advance(&sample(&[0.0], &[20.0]), &mut state);
    let warm = [21.0];
    for _ in 0..600_000 {
        growth.advance(&sample(&[0.0], &warm), &mut state);
    }
    let (found, expected) =
        (f64::from(growth.value(&sample(&[0.0], &warm), &state)), -(-1.0_f64 / 60.0).exp_m1());
    // A step of a temperature near 20 degC; and the part of a cycle, which is rounded once and for all.
    let bound = 2e-6 + expected * 3.0 * f64::from(f32::EPSILON);
    assert!((found - expected).abs() <= bound, "{found} is not {expected}");
}

/// A play that is taken up over 2 mm, by an axis that creeps: 1e-8 mm a cycle, a sixth of a step of the take-up.
#[test]
fn an_axis_that_creeps_takes_up_its_play() {
    let play = Term::Backlash { axis: 0, lost_motion: 0.01, wind_up: 2.0, ramp: 0.0 };
    let mut state = TermState::default();
    let creeping = |step: u32| 1e-8 * step as f32;
    // Taken up towards -, then 1e-3 mm onwards.
    let back = Sample { direction: &[Direction::Negative], ..sample(&[0.0], &[]) };
    play.advance(&back, &mut state);
    for step in 1..=100_000 {
        play.advance(&sample(&[creeping(step)], &[]), &mut state);
    }
    // -B/2 u, u from -1 on by 2 dq/w.
    let (found, expected) = (f64::from(play.value(&sample(&[1e-3], &[]), &state)), -0.005 * (-1.0 + 1e-3));
    assert!((found - expected).abs() <= 0.005 * 2.0 * f64::from(f32::EPSILON), "{found} is not {expected}");
}

struct Slide;

impl Kinematics for Slide {
    fn axes(&self) -> usize {
        1
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        1
    }
    fn error(&self, _: &[f32], _: &[f32], motions: &[f32]) -> [f32; 3] {
        [motions[0], 0.0, 0.0]
    }
    fn directions(&self, _: &[f32], directions: &mut [[f32; 3]]) {
        directions.fill([1.0, 0.0, 0.0]);
    }
}

/// Runs a supervisor over a slide that stands 20 um too far and warms up by 1 um/K.
fn supervised<R>(transition: Transition, test: impl FnOnce(&mut Supervisor<'_, Slide>) -> R) -> R {
    let terms = [
        Term::Constant { value: 0.02 },
        Term::Growth { sensor: 0, coefficient: 0.001, reference: 20.0, time_constant: 0.0 },
    ];
    let motions = [ErrorMotion { terms: &terms }];
    let (mut states, mut directions, mut values) = ([TermState::default(); 2], [[0.0; 3]], [0.0]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
    let compensator = Compensator::new(&Slide, &motions, &mut states, work).unwrap();
    let (mut axes, mut temperature, mut silence) = ([AxisMemory::default()], [0.0], [0.0]);
    let memory = Memory { axes: &mut axes, temperature: &mut temperature, silence: &mut silence };
    let mut supervisor = Supervisor::new(compensator, memory).unwrap();
    supervisor.transition = transition;
    test(&mut supervisor)
}

/// A fade of a day: a cycle takes 1e-9 of it, a fiftieth of the step of a number near 1.
#[test]
fn a_fade_of_a_day_goes_on() {
    supervised(Transition { fade: 86_400.0, ..Transition::default() }, |supervisor| {
        let mut command = [0.0];
        let made: Vec<f32> = (0..100)
            .map(|_| {
                assert!(supervisor.cycle(&sample(&[1.0], &[20.0]), &mut command).settling);
                supervisor.axes()[0].made()
            })
            .collect();
        assert!(made.windows(2).all(|pair| pair[1] <= pair[0]) && made[99] < 10.0 * made[0], "{made:?}");
    });
}

/// A rate of 10 nm/s: 1e-9 mm a cycle, less than half a step of a correction of 0.02 mm. It is kept, over a thousand cycles.
#[test]
fn a_slow_rate_is_kept() {
    let transition = Transition { rate: Some(1e-5), fade: 0.0, ..Transition::default() };
    supervised(Transition { rate: None, ..transition }, |supervisor| {
        let mut command = [0.0];
        let _ = supervisor.cycle(&sample(&[1.0], &[20.0]), &mut command);
        supervisor.transition = transition;
        let before = supervisor.axes()[0].made();
        for _ in 0..1000 {
            assert!(supervisor.cycle(&sample(&[1.0], &[30.0]), &mut command).settling);
        }
        let gone = f64::from(supervisor.axes()[0].made() - before);
        // Two steps of a correction between 0.016 and 0.031 mm.
        assert!((gone - -1e-6).abs() <= 2.0 * 0.016 * f64::from(f32::EPSILON), "{gone}");
    });
}

/// A sensor is silent for longer than it may be, counted by a clock whose cycle is less than half of its steps.
#[test]
fn a_clock_that_ran_long_goes_on() {
    let transition = Transition { hold: 4096.01, ..Transition::default() };
    supervised(transition, |supervisor| {
        let mut command = [0.0];
        let _ = supervisor.cycle(&sample(&[1.0], &[20.0]), &mut command);
        let long = Sample { time_step: 4096.0, ..sample(&[1.0], &[f32::NAN]) };
        assert_eq!(supervisor.cycle(&long, &mut command).state, State::Holding { sensor: 0 });
        let lost = (0..200).position(|_| {
            supervisor.cycle(&sample(&[1.0], &[f32::NAN]), &mut command).state == State::Lost { sensor: 0 }
        });
        // No later than after 0.01 s.
        assert!(lost.is_some_and(|cycles| cycles <= 100), "{lost:?}");
    });
}

/// A fade ends in the cycle in which it should, though a part of it is left by rounding.
#[test]
fn a_fade_ends_in_its_time() {
    for cycles in 2..=30_u8 {
        let transition = Transition { fade: f32::from(cycles) * CYCLE, ..Transition::default() };
        supervised(transition, |supervisor| {
            let mut command = [0.0];
            for cycle in 1..=cycles {
                let done = supervisor.cycle(&sample(&[1.0], &[20.0]), &mut command);
                assert_eq!(done.settling, cycle < cycles, "{cycle} of {cycles}");
            }
        });
    }
}
