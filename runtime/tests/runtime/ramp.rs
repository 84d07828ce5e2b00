//! The ramp of a reversal: the correction follows in steps that a drive can make, the prediction does not wait.
//!
//! In: directions, time steps and ramps, also random ones. Out: what the ramp allows a cycle, where it ends, and what a
//! second reversal makes of it.

use abbe_runtime::{Direction, ErrorMotion, Input, Sample, SetupError, Term, TermState};
use proptest::prelude::*;

use crate::common::{Slide, at, with};

/// 10 um of lost motion; the correction of a reversal takes a second.
const PLAY: Term<'static> = Term::Backlash { axis: 0, lost_motion: 0.01, wind_up: 0.0, ramp: 1.0 };

const FORWARD: &[Direction] = &[Direction::Positive];
const BACK: &[Direction] = &[Direction::Negative];

/// What is corrected after each cycle, in mm.
fn corrected(term: Term<'_>, cycles: &[(&[Direction], f64)]) -> Vec<f64> {
    let mut state = TermState::default();
    let of = |&(direction, time_step): &(&[Direction], f64)| {
        let sample = Sample { direction, time_step, ..at(&[3.0]) };
        term.advance(&sample, &mut state);
        term.corrected(&sample, &state)
    };
    cycles.iter().map(of).collect()
}

fn assert_close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-15, "{found} is not {expected}");
    }
}

#[test]
fn the_first_cycle_is_taken_as_it_is_and_a_reversal_spread_over_its_time() {
    let found =
        corrected(PLAY, &[(BACK, 0.25), (FORWARD, 0.25), (FORWARD, 0.5), (FORWARD, 0.25), (FORWARD, 9.0)]);
    assert_close(&found, &[0.005, 0.0025, -0.0025, -0.005, -0.005]);
}

#[test]
fn a_second_reversal_turns_back_from_where_the_first_has_come() {
    let found =
        corrected(PLAY, &[(FORWARD, 0.0), (BACK, 0.3), (FORWARD, 0.1), (FORWARD, 0.1), (FORWARD, 0.1)]);
    assert_close(&found, &[-0.005, -0.002, -0.003, -0.004, -0.005]);
}

#[test]
fn no_time_no_step() {
    assert_close(&corrected(PLAY, &[(FORWARD, 1.0), (BACK, 0.0), (BACK, 0.0)]), &[-0.005; 3]);
}

#[test]
fn a_time_or_a_place_that_is_no_number_leaves_the_ramp_where_it_is() {
    let found =
        corrected(PLAY, &[(FORWARD, 0.0), (BACK, 0.3), (BACK, f64::NAN), (BACK, f64::INFINITY), (BACK, 0.2)]);
    assert_close(&found, &[-0.005, -0.002, -0.002, -0.002, 0.0]);

    let wound = Term::Backlash { axis: 0, lost_motion: 0.01, wind_up: 4.0, ramp: 1.0 };
    let mut state = TermState::default();
    for (position, time_step) in [(3.0, 0.0), (0.0, 0.1)] {
        wound.advance(&Sample { direction: BACK, time_step, ..at(&[position]) }, &mut state);
    }
    let before = state;
    wound.advance(&Sample { direction: BACK, time_step: 0.1, ..at(&[f64::NAN]) }, &mut state);
    assert_eq!(state, before);
}

#[test]
fn the_prediction_does_not_wait_and_the_rest_is_told() {
    let motions = [ErrorMotion { terms: &[PLAY] }];
    let ((outcome, command), _) = with(&Slide, &motions, |compensator| {
        let mut command = [0.0];
        compensator.compensate(&at(&[5.0]), &mut command).unwrap();
        let back = Sample { direction: BACK, time_step: 0.25, ..at(&[5.0]) };
        (compensator.compensate(&back, &mut command).unwrap(), command[0])
    });
    // The play is there at once; a quarter of the way is corrected, the slide stands 7.5 um ahead.
    assert_close(&outcome.error, &[0.005, 0.0, 0.0]);
    assert_close(&outcome.remaining, &[0.0075, 0.0, 0.0]);
    assert_close(&[command], &[5.0025]);
}

#[test]
fn a_motion_corrects_what_each_of_its_terms_corrects() {
    let terms = [PLAY, Term::Constant { value: 0.02 }];
    let motion = ErrorMotion { terms: &terms };
    let mut states = [TermState::default(); 2];
    motion.advance(&at(&[5.0]), &mut states);
    let back = Sample { direction: BACK, time_step: 0.25, ..at(&[5.0]) };
    motion.advance(&back, &mut states);
    assert_close(&[motion.value(&back, &states), motion.corrected(&back, &states)], &[0.025, 0.0175]);
}

/// On an axis whose error changes with the position, what remains is what stands at the command and not at the target.
#[test]
fn the_rest_is_that_of_the_place_where_the_axis_goes() {
    let scale = Term::Polynomial { input: Input::Axis(0), coefficients: &[0.0, 0.01] };
    let terms = [PLAY, scale];
    let motions = [ErrorMotion { terms: &terms }];
    let ((outcome, command), _) = with(&Slide, &motions, |compensator| {
        let mut command = [0.0];
        compensator.compensate(&at(&[100.0]), &mut command).unwrap();
        let back = Sample { direction: BACK, time_step: 0.25, ..at(&[100.0]) };
        (compensator.compensate(&back, &mut command).unwrap(), command[0])
    });
    // Half of the take-up is followed: c + 0.01 c - 0.0025 = 100, while the slide stands at c + 0.01 c + 0.005.
    assert!((command - 100.0025 / 1.01).abs() < 1e-9, "{command}");
    assert!((outcome.remaining[0] - 0.0075).abs() < 1e-9, "{:?}", outcome.remaining);
    assert!((command + 0.01 * command + 0.005 - 100.0 - outcome.remaining[0]).abs() < 1e-9);
}

#[test]
fn an_axis_without_a_ramp_reports_nothing_remaining() {
    let plain = Term::Backlash { axis: 0, lost_motion: 0.01, wind_up: 0.0, ramp: 0.0 };
    let motions = [ErrorMotion { terms: &[plain] }];
    let (outcome, _) = with(&Slide, &motions, |compensator| {
        compensator.compensate(&Sample { direction: BACK, ..at(&[5.0]) }, &mut [0.0]).unwrap()
    });
    assert_close(&outcome.remaining, &[0.0; 3]);
}

#[test]
fn a_switched_off_compensator_goes_along_with_the_ramp() {
    let motions = [ErrorMotion { terms: &[PLAY] }];
    let (command, _) = with(&Slide, &motions, |compensator| {
        let mut command = [0.0];
        compensator.enabled = false;
        compensator.compensate(&at(&[5.0]), &mut command).unwrap();
        compensator
            .compensate(&Sample { direction: BACK, time_step: 0.5, ..at(&[5.0]) }, &mut command)
            .unwrap();
        compensator.enabled = true;
        let later = Sample { direction: BACK, time_step: 0.25, ..at(&[5.0]) };
        compensator.compensate(&later, &mut command).unwrap();
        command[0]
    });
    assert_close(&[command], &[5.0 - 0.0025]);
}

#[test]
fn a_wind_up_is_followed_behind_the_ramp() {
    // u goes from +1 to 0 over 2 of the 4 mm at once; half a ramp's time later the correction is there.
    let term = Term::Backlash { axis: 0, lost_motion: 2.0, wind_up: 4.0, ramp: 1.0 };
    let mut state = TermState::default();
    let mut cycle = |position: f64, time_step: f64| {
        let position = [position];
        let sample = Sample { direction: BACK, time_step, ..at(&position) };
        term.advance(&sample, &mut state);
        (term.value(&sample, &state), term.corrected(&sample, &state))
    };
    let start = Sample { time_step: 0.0, ..at(&[10.0]) };
    assert_eq!(cycle(10.0, 0.0).0, 1.0);
    cycle(20.0, 9.0); // taken up forwards, and followed
    assert_eq!(term.value(&start, &TermState::default()), -1.0);
    assert_eq!(cycle(18.0, 0.25), (0.0, -0.5));
    assert_eq!(cycle(18.0, 0.25), (0.0, 0.0));
}

#[test]
fn a_bad_ramp_is_named() {
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let terms = [Term::Backlash { axis: 0, lost_motion: 0.01, wind_up: 0.0, ramp: bad }];
        let motions = [ErrorMotion { terms: &terms }];
        let mut states = [TermState::default()];
        let (mut directions, mut values) = ([[0.0; 3]], [0.0]);
        let work = abbe_runtime::Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
        let built = abbe_runtime::Compensator::new(&Slide, &motions, &mut states, work);
        let expected = SetupError::Parameter { motion: 0, term: 0, parameter: "ramp" };
        assert_eq!(built.err(), Some(expected));
    }
}

/// Random cycles: a direction and a time step each.
fn cycles() -> impl Strategy<Value = Vec<(bool, f64)>> {
    prop::collection::vec((any::<bool>(), 0.0..0.2_f64), 1..60)
}

proptest! {
    /// However an axis turns: no step is larger than the ramp allows, the correction goes towards the play and never past
    /// it, and after a ramp's time in one direction it is the whole of it, exactly.
    #[test]
    fn the_correction_follows_and_arrives(cycles in cycles(), lost_motion in -0.1..0.1_f64, ramp in 1e-3..2.0_f64) {
        let term = Term::Backlash { axis: 0, lost_motion, wind_up: 0.0, ramp };
        let mut state = TermState::default();
        let mut before: Option<f64> = None;
        let mut cycle = |back: bool, time_step: f64, before: Option<f64>| {
            let direction = if back { BACK } else { FORWARD };
            let sample = Sample { direction, time_step, ..at(&[0.0]) };
            term.advance(&sample, &mut state);
            let (whole, now) = (term.value(&sample, &state), term.corrected(&sample, &state));
            assert_eq!(whole, if back { 0.5 * lost_motion } else { -0.5 * lost_motion });
            if let Some(before) = before {
                let allowed = lost_motion.abs() * time_step / ramp;
                assert!((now - before).abs() <= allowed * (1.0 + 1e-9) + 1e-16, "{before} {now} {allowed}");
                assert!((now - before) * (whole - before) >= 0.0, "{before} {now}: away from {whole}");
                assert!((whole - now).abs() <= (whole - before).abs(), "{before} {now}: past {whole}");
            }
            (whole, now)
        };
        for (back, time_step) in cycles {
            before = Some(cycle(back, time_step, before).1);
        }
        for _ in 0..1001 {
            before = Some(cycle(true, ramp / 1000.0, before).1);
        }
        let (whole, now) = cycle(true, 0.0, before);
        prop_assert_eq!(now, whole);
    }
}
