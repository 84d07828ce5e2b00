//! Ranges against recordings of which cycles, periods, reversals and times were counted by hand.

use std::f64::consts::TAU;

use super::*;
use crate::course::courses;
use crate::model::Model;
use crate::recording::Recording;
use crate::testing::{Bench, programmed};
use crate::travel::travels;

/// The step between rows, s, and the way between them, mm.
const STEP: f64 = 0.1;
const WAY: f64 = 2.0;
/// Rows from one end of the travel of 100 mm to the other.
const STROKE: usize = 50;

/// Five strokes of 5 s over 100 mm, from -20 to 80 and back; nothing was read for 600 s in the middle of the third.
fn strokes() -> Recording {
    let rows = 0..=5 * STROKE;
    let pause = |row: usize| if row > 5 * STROKE / 2 { 600.0 } else { 0.0 };
    let time: Vec<f64> = rows.clone().map(|row| crate::number(row) * STEP + pause(row)).collect();
    let place = |row: usize| {
        let (stroke, way) = (row / STROKE, WAY * crate::number(row % STROKE));
        if stroke.is_multiple_of(2) { way - 20.0 } else { 80.0 - way }
    };
    programmed(&time, &[rows.map(place).collect()])
}

/// What was observed of it, s: 25 s without the one step that is the pause.
const OBSERVED: f64 = 25.0 - STEP;

/// A recording every 0.5 s for 10 s, in which the axis stands.
fn short() -> Recording {
    let time: Vec<f64> = (0..=20).map(|row| 0.5 * f64::from(row)).collect();
    programmed(&time, &[vec![0.0; 21]])
}

/// What `each` says of the study of recordings of a stage X.
fn with<T>(recordings: &[&Recording], each: impl FnOnce(&Study<'_>, &[Travel]) -> T) -> T {
    let bench = Bench::of("FX");
    let study = Study::new(bench.equations(), None, recordings);
    let courses = courses(&study, &Model::default());
    let travels = travels(&study, &courses);
    each(&study, &travels)
}

fn range_of(recordings: &[&Recording], shape: &Shape) -> (f64, f64) {
    with(recordings, |study, travels| range(study, travels, shape))
}

#[track_caller]
fn assert_near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
}

const SPIKE: Shape = Shape::ReversalSpike { axis: 0, decay: 1.0 };
const PLAY: Shape = Shape::Backlash { axis: 0, wind_up: 1.0 };
const WAVE: Shape = Shape::Cyclic { axis: 0, period: 1.0, order: 1, center: 0.0 };
const VIBRATION: Shape = Shape::Vibration { frequency: 1.0 };
const DRIFT: Shape = Shape::Drift { time_constant: 1.0 };
const GROWTH: Shape = Shape::Growth { sensor: 0, reference: 20.0, time_constant: 1.0 };

#[test]
fn a_vibration_has_enough_cycles_in_what_was_observed_and_two_rows_a_cycle() {
    let recording = strokes();
    let (slowest, fastest) = range_of(&[&recording], &VIBRATION);
    // The turns of the slowest one, added up from row to row, but not over the pause.
    let steps = recording.time.windows(2).filter(|pair| pair[1] - pair[0] < 1.0);
    let cycles: f64 = steps.map(|pair| slowest * (pair[1] - pair[0])).sum();
    assert_near(cycles, CYCLES);
    assert_near(slowest * OBSERVED, CYCLES);
    // Nyquist: the next faster one looks like a slower one.
    assert_near(fastest * STEP, 0.5);
}

#[test]
fn a_wave_has_more_than_one_period_in_the_travel_and_two_rows_a_period() {
    let (shortest, longest) = range_of(&[&strokes()], &WAVE);
    assert_near(shortest, 2.0 * WAY);
    assert_near(100.0 / longest, PERIODS);
}

#[test]
fn a_spike_has_faded_when_the_axis_turns_again() {
    let (shortest, longest) = range_of(&[&strokes()], &SPIKE);
    // Four reversals in the time that was observed.
    let between = OBSERVED / 4.0;
    assert_near(longest, DECAY * between);
    assert!((-between / longest).exp() < 0.05, "{longest}");
    // Of the quickest one the first row after a reversal still shows something.
    assert!((-STEP / shortest).exp() > 0.02 && shortest < STEP, "{shortest}");
}

#[test]
fn play_is_taken_up_between_two_rows_at_least_and_within_the_travel() {
    let (least, most) = range_of(&[&strokes()], &PLAY);
    assert_near(least, WAY);
    assert_near(most, WIND_UP * 100.0);
    // Rows that are further apart than that: 90 mm of 100.
    let time: Vec<f64> = (0..5).map(f64::from).collect();
    let coarse = programmed(&time, &[vec![0.0, 90.0, 100.0, 10.0, 100.0]]);
    let (least, most) = range_of(&[&coarse], &PLAY);
    assert!(least <= most, "{least} {most}");
}

#[test]
fn a_settling_takes_some_rows_and_some_recordings() {
    let (shortest, longest) = range_of(&[&strokes()], &DRIFT);
    assert_near(longest, SETTLING * OBSERVED);
    assert!(shortest > STEP && shortest < 0.1 * OBSERVED, "{shortest}");
    let (shortest, longest) = range_of(&[&strokes()], &GROWTH);
    assert_near(longest, SETTLING * OBSERVED);
    assert_near(shortest, STEP);
}

#[test]
fn what_has_no_parameter_but_linear_ones_has_no_range() {
    for shape in [Shape::Constant, Shape::Lag { axis: 0, inertia: 0.0 }, Shape::Acceleration { axis: 0 }] {
        assert_eq!(range_of(&[&strokes()], &shape), (f64::NEG_INFINITY, f64::INFINITY));
    }
}

#[test]
fn the_longest_recording_and_the_quickest_count() {
    let (long, short) = (strokes(), short());
    with(&[&short], |study, _| assert_near(shortest_step(study), 0.5));
    with(&[&short, &long], |study, _| assert_near(shortest_step(study), STEP));
    for shape in [VIBRATION, DRIFT, GROWTH] {
        let alone = range_of(&[&long], &shape);
        assert_eq!(range_of(&[&short, &long], &shape), alone, "{shape:?}");
        assert_eq!(range_of(&[&long, &short], &shape), alone, "{shape:?}");
    }
}

#[test]
fn an_axis_that_stands_leaves_no_room_and_nothing_breaks() {
    for shape in [SPIKE, PLAY, WAVE, VIBRATION, DRIFT, GROWTH] {
        let (least, most) = range_of(&[&short()], &shape);
        assert!(!least.is_nan() && !most.is_nan(), "{shape:?}: {least} {most}");
        if shape.axis().is_some() {
            assert_eq!(most, 0.0, "{shape:?}");
        }
    }
}

#[test]
fn what_has_run_to_its_end_is_a_step() {
    let step = Some(Shape::Backlash { axis: 0, wind_up: 0.0 });
    let recording = strokes();
    with(&[&recording], |study, travels| {
        let limit = |shape: Shape| limit(study, travels, &shape);
        let (quickest, slowest) = range(study, travels, &SPIKE);
        assert_eq!(limit(SPIKE.with_nonlinear(slowest)), step);
        assert_eq!(limit(SPIKE.with_nonlinear(2.0 * slowest)), step);
        assert_eq!(limit(SPIKE.with_nonlinear(0.9 * slowest)), None);
        assert_eq!(limit(SPIKE.with_nonlinear(quickest)), None);
        // Rows are 2 mm apart.
        assert_eq!(limit(PLAY.with_nonlinear(2.0)), step);
        assert_eq!(limit(PLAY.with_nonlinear(0.1)), step);
        assert_eq!(limit(PLAY.with_nonlinear(2.2)), None);
        assert_eq!(limit(PLAY.with_nonlinear(80.0)), None);
        assert_eq!(limit(PLAY.with_nonlinear(0.0)), None);
        for shape in [WAVE, VIBRATION, DRIFT, GROWTH] {
            let (least, most) = range(study, travels, &shape);
            assert_eq!(limit(shape.with_nonlinear(least)), None);
            assert_eq!(limit(shape.with_nonlinear(most)), None);
        }
        assert_eq!(limit(Shape::Constant), None);
    });
}

#[test]
fn a_spike_of_another_axis_becomes_play_of_that_axis() {
    let bench = Bench::of("FXY");
    let recording = strokes();
    let along = recording.axes[0].command.clone().unwrap();
    let across: Vec<f64> = along.iter().map(|place| 0.5 * place).collect();
    let recording = programmed(&recording.time, &[along, across]);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let travels = travels(&study, &courses(&study, &Model::default()));
    let found = limit(&study, &travels, &Shape::ReversalSpike { axis: 1, decay: 1e3 });
    assert_eq!(found, Some(Shape::Backlash { axis: 1, wind_up: 0.0 }));
    // Its rows are half as far apart.
    assert_eq!(limit(&study, &travels, &Shape::Backlash { axis: 1, wind_up: 1.5 }), None);
    assert!(limit(&study, &travels, &Shape::Backlash { axis: 0, wind_up: 1.5 }).is_some());
}

fn vibration(frequency: f64) -> Shape {
    Shape::Vibration { frequency }
}

fn wave(axis: usize, period: f64) -> Shape {
    Shape::Cyclic { axis, period, order: 1, center: 0.0 }
}

#[test]
fn vibrations_blur_until_one_makes_a_turn_more_than_the_other() {
    let recording = strokes();
    let resolution = with(&[&recording], Resolution::new);
    let steps: Vec<f64> = recording.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    for turns in [0.0, 0.3, 0.95, 1.05, 2.5] {
        let (slow, fast) = (3.0, 3.0 + turns / OBSERVED);
        // How far the second one gets ahead of the first while there are rows, in turns.
        let ahead: f64 = steps.iter().filter(|step| **step < 1.0).map(|step| (fast - slow) * step).sum();
        assert_eq!(resolution.blurs(&vibration(slow), &vibration(fast)), ahead < 1.0, "{turns}");
        assert_eq!(resolution.blurs(&vibration(fast), &vibration(slow)), ahead < 1.0, "{turns}");
    }
}

#[test]
fn vibrations_a_turn_apart_have_nothing_in_common() {
    // Why a turn: over it, what two sines have in common cancels, whatever their phases.
    let time: Vec<f64> = (0..250).map(|row| STEP * f64::from(row)).collect();
    let recording = programmed(&time, &[vec![0.0; time.len()]]);
    let resolution = with(&[&recording], Resolution::new);
    let common = |fast: f64| {
        let product = |part: fn(f64) -> f64| -> f64 {
            time.iter().map(|time| (TAU * 3.0 * time).sin() * part(TAU * fast * time)).sum()
        };
        product(f64::sin).hypot(product(f64::cos)) / 125.0
    };
    let apart = 3.0 + 1.0 / 24.89;
    assert!(common(apart) < 0.05 && !resolution.blurs(&vibration(3.0), &vibration(apart)));
    let near = 3.0 + 0.4 / 24.9;
    assert!(common(near) > 0.7 && resolution.blurs(&vibration(3.0), &vibration(near)));
}

#[test]
fn waves_along_an_axis_blur_until_one_has_a_period_more() {
    let resolution = with(&[&strokes()], Resolution::new);
    // Ten periods of 10 mm in 100 mm; eleven of 9.09 mm; nine of 11.11 mm.
    for (period, blurred) in [(10.0, true), (9.2, true), (9.05, false), (11.0, true), (11.2, false)] {
        assert_eq!(resolution.blurs(&wave(0, 10.0), &wave(0, period)), blurred, "{period}");
        assert_eq!(resolution.blurs(&wave(0, period), &wave(0, 10.0)), blurred, "{period}");
    }
}

#[test]
fn only_waves_of_one_kind_along_one_axis_blur() {
    let resolution = with(&[&strokes()], Resolution::new);
    assert!(!resolution.blurs(&wave(0, 10.0), &wave(1, 10.0)));
    assert!(!resolution.blurs(&wave(0, 10.0), &vibration(10.0)));
    assert!(!resolution.blurs(&vibration(10.0), &wave(0, 10.0)));
    assert!(!resolution.blurs(&Shape::Constant, &Shape::Constant));
    assert!(!resolution.blurs(&SPIKE, &SPIKE));
}
