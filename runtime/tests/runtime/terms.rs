//! Every term against a form that does not come from its code.
//!
//! In: parameters and states. Out: the values that section "terms" of the vocabulary asks for.

use abbe_runtime::{
    Direction, ErrorMotion, Factor, Input, Sample, Table, Term, TermState, Values, Within, math,
    states_needed,
};

use crate::common::at;

/// The value of a term that remembers nothing.
fn value(term: Term<'_>, sample: &Sample<'_>) -> f64 {
    term.value(sample, &TermState::default())
}

fn assert_close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-15 * (1.0 + expected.abs()), "{found} is not {expected}");
}

#[test]
fn functions_have_the_values_of_the_textbooks() {
    for (turn, sine, cosine) in [
        (0.0, 0.0, 1.0),
        (1.0 / 12.0, 0.5, 0.75_f64.sqrt()),
        (0.25, 1.0, 0.0),
        (-0.375, -0.5_f64.sqrt(), -0.5_f64.sqrt()),
    ] {
        let angle = core::f64::consts::TAU * turn;
        assert_close(math::sin(angle), sine);
        assert_close(math::sin_cos(angle).0, sine);
        assert_close(math::sin_cos(angle).1, cosine);
    }
    assert_eq!(math::sqrt(2.25), 1.5);
    assert!(math::sqrt(-1.0).is_nan());
    // e - 1, and the value itself where exp(value) would round to 1.
    assert_close(math::exp_m1(1.0), core::f64::consts::E - 1.0);
    assert_eq!(math::exp_m1(1e-20), 1e-20);
    assert_eq!(math::length([2.0, -3.0, 6.0]), 7.0);
}

#[test]
fn constant_is_its_value_everywhere() {
    let term = Term::Constant { value: 272e-6 };
    assert_eq!(value(term, &at(&[-40.0])), 272e-6);
    assert_eq!(value(term, &at(&[900.0])), 272e-6);
}

#[test]
fn polynomial_sums_powers_from_the_constant_on() {
    let term = Term::Polynomial { input: Input::Axis(1), coefficients: &[5.0, -3.0, 0.5, 2.0] };
    // 5 - 3 * 2 + 0.5 * 4 + 2 * 8 and 5 + 3 + 0.5 - 2
    assert_eq!(value(term, &at(&[99.0, 2.0])), 17.0);
    assert_eq!(value(term, &at(&[99.0, -1.0])), 6.5);
}

#[test]
fn polynomial_in_a_temperature() {
    let term = Term::Polynomial { input: Input::Sensor(1), coefficients: &[1.0, 0.25] };
    let sample = Sample { temperature: &[90.0, 24.0], ..at(&[3.0]) };
    assert_eq!(value(term, &sample), 7.0);
}

#[test]
fn polynomial_without_coefficients_is_zero() {
    assert_eq!(value(Term::Polynomial { input: Input::Axis(0), coefficients: &[] }, &at(&[8.0])), 0.0);
}

#[test]
fn coupling_has_no_constant() {
    let term = Term::Coupling { axis: 1, coefficients: &[2.0, 10.0] };
    assert_eq!(value(term, &at(&[7.0, 3.0])), 2.0 * 3.0 + 10.0 * 9.0);
    assert_eq!(value(term, &at(&[7.0, 0.0])), 0.0);
}

#[test]
fn table_reads_the_curve_of_its_axis_and_direction() {
    let values = Values::Directed { forward: &[1.0, 3.0], reverse: &[10.0, 20.0] };
    let term = Term::Table { axis: 1, table: Table::uniform(0.0, 4.0, values).unwrap() };
    let there = at(&[77.0, 1.0]);
    assert_eq!(value(term, &there), 1.5);
    let back = [Direction::Positive, Direction::Negative];
    assert_eq!(value(term, &Sample { direction: &back, ..there }), 12.5);
}

#[test]
fn backlash_lags_behind_the_motion() {
    let term = Term::Backlash { axis: 0, lost_motion: 0.010, wind_up: 0.0, ramp: 0.0 };
    assert_eq!(value(term, &at(&[5.0])), -0.005);
    assert_eq!(value(term, &Sample { direction: &[Direction::Negative], ..at(&[5.0]) }), 0.005);
}

#[test]
fn cyclic_is_a_sine_over_its_period() {
    let cyclic = |phase| Term::Cyclic { axis: 0, period: 8.0, amplitude: 3.0, phase };
    assert_close(value(cyclic(0.0), &at(&[2.0])), 3.0);
    assert_close(value(cyclic(0.0), &at(&[6.0])), -3.0);
    assert_close(value(cyclic(core::f64::consts::FRAC_PI_2), &at(&[0.0])), 3.0);
    assert_close(value(cyclic(0.0), &at(&[1.0])), 3.0 * 0.5_f64.sqrt());
    assert!((value(cyclic(0.4), &at(&[1.3])) - value(cyclic(0.4), &at(&[801.3]))).abs() < 1e-11);
}

#[test]
fn expansion_grows_with_temperature_and_position() {
    let term = Term::Expansion { axis: 0, sensor: 1, coefficient: 11.5e-6, reference: 20.0 };
    let sample = Sample { temperature: &[99.0, 24.0], ..at(&[500.0]) };
    assert_close(value(term, &sample), 0.023);
    let cold = Sample { temperature: &[99.0, 16.0], ..sample };
    assert_close(value(term, &cold), -0.023);
}

#[test]
fn lag_stays_behind_the_velocity() {
    let term = Term::Lag { axis: 0, gain: 20.0 };
    assert_eq!(value(term, &Sample { velocity: &[50.0], ..at(&[0.0]) }), -2.5);
    assert_eq!(value(term, &Sample { velocity: &[-50.0], ..at(&[0.0]) }), 2.5);
}

#[test]
fn what_a_sample_lacks_is_nan() {
    let sample = at(&[1.0]);
    for term in [
        Term::Polynomial { input: Input::Axis(1), coefficients: &[1.0] },
        Term::Polynomial { input: Input::Sensor(0), coefficients: &[] },
        Term::Coupling { axis: 1, coefficients: &[] },
        Term::Backlash { axis: 1, lost_motion: 1.0, wind_up: 0.0, ramp: 0.0 },
        Term::Cyclic { axis: 1, period: 1.0, amplitude: 1.0, phase: 0.0 },
        Term::Expansion { axis: 0, sensor: 0, coefficient: 1.0, reference: 0.0 },
        Term::Growth { sensor: 0, coefficient: 1.0, reference: 0.0, time_constant: 0.0 },
        Term::Lag { axis: 0, gain: 1.0 },
    ] {
        assert!(value(term, &sample).is_nan(), "{term:?}");
    }
}

/// Moves an axis through the positions and returns the value of the term after each.
fn travel(term: Term<'_>, positions: &[f64]) -> Vec<f64> {
    let mut state = TermState::default();
    positions
        .iter()
        .map(|&position| {
            let position = [position];
            term.advance(&at(&position), &mut state);
            term.value(&at(&position), &state)
        })
        .collect()
}

#[test]
fn wind_up_is_taken_up_over_its_travel() {
    let term = Term::Backlash { axis: 0, lost_motion: 2.0, wind_up: 4.0, ramp: 0.0 };
    // The value is -u: taken up at the start, from +1 to -1 over a travel of 4, half way (u = 0) after 2.
    let found = travel(term, &[10.0, 12.0, 11.0, 10.0, 8.0, 5.0, 6.0, 9.0, 12.0]);
    assert_eq!(found, [-1.0, -1.0, -0.5, 0.0, 1.0, 1.0, 0.5, -1.0, -1.0]);
}

#[test]
fn wind_up_closes_its_loop_and_forgets_smaller_ones() {
    let term = Term::Backlash { axis: 0, lost_motion: 2.0, wind_up: 4.0, ramp: 0.0 };
    let found = travel(term, &[0.0, 10.0, 9.0, 10.0, 20.0, 0.0, 20.0, 0.0]);
    assert_eq!(found[1], found[3]); // a small loop returns to where it began
    assert_eq!((found[4], found[5]), (-1.0, 1.0));
    assert_eq!((found[6], found[7]), (found[4], found[5]));
}

#[test]
fn wind_up_to_nothing_is_plain_backlash() {
    let positions: Vec<f64> = (0..200).map(|k| 30.0 * (f64::from(k) * 0.1).sin()).collect();
    let narrow = travel(Term::Backlash { axis: 0, lost_motion: 2.0, wind_up: 1e-9, ramp: 0.0 }, &positions);
    for (step, value) in positions.windows(2).zip(&narrow[1..]) {
        let direction = (step[1] - step[0]).signum();
        assert_eq!(*value, -direction);
    }
}

#[test]
fn wind_up_starts_in_the_direction_given() {
    let term = Term::Backlash { axis: 0, lost_motion: 2.0, wind_up: 4.0, ramp: 0.0 };
    let sample = Sample { direction: &[Direction::Negative], ..at(&[3.0]) };
    let mut state = TermState::default();
    assert_eq!(term.value(&sample, &state), 1.0);
    term.advance(&sample, &mut state);
    assert_eq!(term.value(&sample, &state), 1.0);
}

#[test]
fn asking_for_a_value_advances_nothing() {
    let term = Term::Backlash { axis: 0, lost_motion: 2.0, wind_up: 4.0, ramp: 0.0 };
    let mut state = TermState::default();
    term.advance(&at(&[0.0]), &mut state);
    let before = state;
    assert_eq!(term.value(&at(&[-3.0]), &state), -1.0);
    assert_eq!(state, before);
}

#[test]
fn growth_follows_a_step_by_the_exponential() {
    let term = Term::Growth { sensor: 0, coefficient: 2.0, reference: 15.0, time_constant: 300.0 };
    let mut state = TermState::default();
    let position = [0.0];
    let start = Sample { temperature: &[20.0], time_step: 7.0, ..at(&position) };
    term.advance(&start, &mut state);
    assert_eq!(term.value(&start, &state), 2.0 * (20.0 - 15.0));
    let mut time = 0.0;
    for time_step in [0.5, 100.0, 1e-4, 250.0, 3.0] {
        let warm = Sample { temperature: &[30.0], time_step, ..at(&position) };
        term.advance(&warm, &mut state);
        time += time_step;
        let filtered = 30.0 - 10.0 * (-time / 300.0_f64).exp();
        assert!((term.value(&warm, &state) - 2.0 * (filtered - 15.0)).abs() < 1e-13);
    }
}

#[test]
fn growth_without_a_time_constant_has_no_filter() {
    let term = Term::Growth { sensor: 0, coefficient: 2.0, reference: 20.0, time_constant: 0.0 };
    let mut state = TermState::default();
    for temperature in [21.0, 35.0, 18.0] {
        let temperature = [temperature];
        let sample = Sample { temperature: &temperature, ..at(&[0.0]) };
        term.advance(&sample, &mut state);
        assert_eq!(term.value(&sample, &state), 2.0 * (temperature[0] - 20.0));
    }
}

#[test]
fn memories_are_not_poisoned() {
    let play = Term::Backlash { axis: 0, lost_motion: 2.0, wind_up: 4.0, ramp: 0.0 };
    assert_eq!(travel(play, &[0.0, f64::NAN, -1.0])[2], -0.5);
    let growth = Term::Growth { sensor: 0, coefficient: 1.0, reference: 0.0, time_constant: 1.0 };
    let mut state = TermState::default();
    for temperature in [20.0, f64::NAN, 20.0] {
        growth.advance(&Sample { temperature: &[temperature], ..at(&[0.0]) }, &mut state);
    }
    assert_eq!(growth.value(&Sample { temperature: &[20.0], ..at(&[0.0]) }, &state), 20.0);
}

#[test]
fn an_error_motion_is_the_sum_of_its_terms() {
    let terms = [
        Term::Constant { value: 1.0 },
        Term::Coupling { axis: 0, coefficients: &[0.5] },
        Term::Backlash { axis: 0, lost_motion: 4.0, wind_up: 0.0, ramp: 0.0 },
    ];
    let motion = ErrorMotion { terms: &terms };
    assert_eq!(motion.value(&at(&[6.0]), &[TermState::default(); 3]), 1.0 + 3.0 - 2.0);
    assert!(motion.value(&at(&[6.0]), &[TermState::default(); 2]).is_nan());
    assert_eq!(states_needed(&[motion, ErrorMotion::default(), motion]), 6);
    let nothing = ErrorMotion::default().value(&at(&[6.0]), &[]);
    assert!(nothing == 0.0 && nothing.is_sign_positive());
}

#[test]
fn an_error_motion_advances_each_of_its_terms() {
    let play = |lost_motion| Term::Backlash { axis: 0, lost_motion, wind_up: 4.0, ramp: 0.0 };
    let terms = [play(2.0), Term::Constant { value: 0.0 }, play(20.0)];
    let motion = ErrorMotion { terms: &terms };
    let mut states = [TermState::default(); 3];
    motion.advance(&at(&[0.0]), &mut states);
    motion.advance(&at(&[-1.0]), &mut states);
    assert_eq!(motion.value(&at(&[-1.0]), &states), -0.5 - 5.0);
}

/// A factor's value in the first cycle.
fn factor(factor: Factor<'_>, sample: &Sample<'_>) -> f64 {
    value(Term::Factor(factor), sample)
}

#[test]
fn factors_have_the_values_of_their_formulas() {
    let within = Within::EVERYWHERE;
    let sample = Sample {
        direction: &[Direction::Positive, Direction::Negative],
        velocity: &[-9.0, 4.0],
        temperature: &[23.0, 18.0],
        ..at(&[-3.0, 5.0])
    };
    for (power, cube) in [(1, -3.0), (2, 9.0), (3, -27.0)] {
        assert_eq!(factor(Factor::Position { axis: 0, power, within }, &sample), cube);
    }
    assert_eq!(
        factor(Factor::Position { axis: 0, power: 2, within: Within { from: -2.0, to: 1.0 } }, &sample),
        4.0
    );
    assert_eq!(factor(Factor::Direction { axis: 1 }, &sample), -1.0);
    assert_eq!(factor(Factor::Velocity { axis: 0, within }, &sample), -9.0);
    assert_eq!(factor(Factor::Speed { axis: 0, within }, &sample), 9.0);
    assert_eq!(factor(Factor::Speed { axis: 0, within: Within { from: 0.0, to: 5.0 } }, &sample), 5.0);
    assert_close(factor(Factor::Fading { axis: 0, over: 3.0 }, &sample), (-3.0_f64).exp());
    let warm = Factor::Temperature { sensor: 0, reference: 20.0, time_constant: 60.0, within };
    assert_eq!(factor(warm, &sample), 3.0, "a filter starts where the temperature is");
    assert_eq!(factor(Factor::Play { sensor: 1, reference: 20.0, width: 1.0 }, &sample), -2.0);
    assert_eq!(
        factor(Factor::Warmth { axis: 0, time_constant: 60.0, rise: 1.0 }, &sample),
        0.0,
        "it starts cold"
    );
    let turn = Factor::Turn { axis: 1, period: 20.0, phase: core::f64::consts::FRAC_PI_2 };
    assert!(factor(turn, &sample).abs() < 1e-15, "a quarter of a turn before half of one");
    let table = Table::at(&[0.0, 10.0], Values::Both(&[2.0, 4.0])).unwrap();
    assert_eq!(factor(Factor::Curve { axis: 1, table }, &sample), 3.0);
    // What the sample lacks is NaN, whatever range it is held in.
    let bare = at(&[1.0]);
    assert!(factor(Factor::Speed { axis: 0, within: Within { from: 0.0, to: 5.0 } }, &bare).is_nan());
}

#[test]
fn a_factor_multiplies_the_next_term_alone() {
    let sample = Sample { direction: &[Direction::Negative], ..at(&[4.0]) };
    let position = Term::Factor(Factor::Position { axis: 0, power: 1, within: Within::EVERYWHERE });
    let direction = Term::Factor(Factor::Direction { axis: 0 });
    let (two, three) = (Term::Constant { value: 2.0 }, Term::Constant { value: 3.0 });
    let sum = |terms: &[Term<'_>]| {
        let states = vec![TermState::default(); states_needed(&[ErrorMotion { terms }])];
        ErrorMotion { terms }.value(&sample, &states)
    };
    assert_eq!(sum(&[position, two, three]), 11.0);
    assert_eq!(sum(&[two, position, three]), 14.0);
    assert_eq!(sum(&[position, direction, two, position, three]), 4.0);
}

#[test]
fn factors_remember_from_cycle_to_cycle() {
    let mut state = TermState::default();
    let warmth = Term::Factor(Factor::Warmth { axis: 0, time_constant: 50.0, rise: 0.1 });
    // At a speed that lasts it comes nearer to 0.1 K for each mm/s by 1 - 1/e in each time constant.
    let moving = Sample { velocity: &[-20.0], time_step: 0.5, ..at(&[0.0]) };
    for cycle in 1..=100_i32 {
        warmth.advance(&moving, &mut state);
        let expected = 2.0 * (1.0 - (-0.5 * f64::from(cycle) / 50.0).exp());
        assert!((warmth.value(&moving, &state) - expected).abs() < 1e-12);
    }
    let play = Term::Factor(Factor::Play { sensor: 0, reference: 20.0, width: 1.0 });
    let mut state = TermState::default();
    let found: Vec<f64> = [20.0, 20.4, 21.0, 20.8, 20.0, 19.9]
        .iter()
        .map(|temperature| {
            let readings = [*temperature];
            let sample = Sample { temperature: &readings, ..at(&[0.0]) };
            play.advance(&sample, &mut state);
            play.value(&sample, &state)
        })
        .collect();
    // It follows up to half a kelvin behind, and stands while the temperature turns.
    for (found, expected) in found.iter().zip([0.0, 0.0, 0.5, 0.5, 0.5, 0.4]) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}
