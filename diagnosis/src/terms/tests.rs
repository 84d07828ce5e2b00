//! Terms against the runtime where it has them, and against their formulas where it has not.

use std::f64::consts::TAU;

use abbe_runtime::{Direction, ErrorMotion, Sample, TermState};
use model_dsl::calibration::{CalibratedTerm, Curve, CurveNodes, CurveValues, Factor, SeriesInput, Within};

use super::*;
use crate::states::Driven;
use crate::states::{Given, States};
use crate::testing::{distance, normals, peak, programmed, uneven};

const ROWS: usize = 240;

/// Two axes that turn several times at uneven times, a sensor and a load.
fn states() -> States {
    let time = uneven(41, ROWS, 0.05);
    let x = time.iter().map(|t| 60.0 * (0.8 * t).sin() + 25.0).collect();
    let y = time.iter().map(|t| 30.0 * (1.7 * t + 1.0).cos() - 4.0).collect();
    let recording = programmed(&time, &[x, y]);
    let warm = time.iter().map(|t| 21.0 + 3.0 * (1.0 - (-t / 4.0).exp())).collect();
    let load = time.iter().map(|t| 100.0 * (3.0 * t).sin()).collect();
    States::new(&recording, &Given::new(&recording, vec![warm], vec![load]), &[Driven::default(); 2], 0.0)
}

fn value(term: &CalibratedTerm, states: &States) -> Vec<f64> {
    let (shape, coefficients) = known(term, &|name: &str| (name == "force").then_some(0)).unwrap();
    assert_eq!(shape.name(), term.name());
    assert_eq!(shape.columns(), coefficients.len());
    let rows = states.rows(0..states.given.time.len());
    let mut sum = vec![0.0; rows.len()];
    shape.add(&coefficients, Side::After, &rows, &mut Memory::default(), &mut sum);
    // Columns times coefficients say the same; but a loop is in the states, and its column is how they change.
    if !matches!(shape, Shape::Lag { .. }) {
        let mut columns = vec![vec![f64::NAN; 3]; shape.columns()];
        shape.fill(&rows, &mut Memory::default(), &mut columns);
        let by_columns =
            (0..rows.len()).map(|row| columns.iter().zip(&coefficients).map(|(c, k)| c[row] * k).sum());
        let by_columns: Vec<f64> = by_columns.collect();
        assert!(distance(&by_columns, &sum) <= 1e-12 * peak(&sum).max(1e-3), "{term:?}");
    }
    sum
}

fn by_runtime(term: &CalibratedTerm, states: &States) -> Vec<f64> {
    let terms = term.runtime().unwrap();
    let motion = ErrorMotion { terms: &terms };
    let mut memory = vec![TermState::default(); terms.len()];
    let mut before = states.given.time[0];
    let row = |row: usize| {
        let position: Vec<f64> = states.axes.iter().map(|axis| axis.position[row]).collect();
        // The derivatives of the positions above.
        let t = states.given.time[row];
        let velocity = [48.0 * (0.8 * t).cos(), -51.0 * (1.7 * t + 1.0).sin()];
        let way = |axis: &crate::states::AxisStates| match axis.direction[row] {
            d if d > 0.0 => Direction::Positive,
            _ => Direction::Negative,
        };
        let direction: Vec<Direction> = states.axes.iter().map(way).collect();
        let temperature: Vec<f64> = states.given.temperatures.iter().map(|sensor| sensor[row]).collect();
        let sample = Sample {
            position: &position,
            travel: &[],
            direction: &direction,
            velocity: &velocity,
            temperature: &temperature,
            time_step: states.given.time[row] - before,
        };
        before = states.given.time[row];
        motion.advance(&sample, &mut memory);
        motion.value(&sample, &memory)
    };
    (0..states.given.time.len()).map(row).collect()
}

fn table(nodes: CurveNodes, values: CurveValues) -> CalibratedTerm {
    CalibratedTerm::Table { axis: 0, curve: Curve::new(nodes, values) }
}

#[test]
fn terms_are_those_of_the_runtime() {
    let at = || CurveNodes::At(vec![-20.0, -3.0, 30.0, 41.0]);
    let directed =
        || CurveValues::Directed { forward: vec![0.1, 0.3, -0.2, 0.05], reverse: vec![0.0, -0.1, 0.2, 0.6] };
    let play = CalibratedTerm::Backlash { axis: 0, lost_motion: 0.02, wind_up: 0.0 };
    let one = CalibratedTerm::Constant { value: 0.1 };
    let (narrow, warm) = (Within { from: -20.0, to: 10.0 }, Within { from: 21.5, to: 23.0 });
    let terms = [
        CalibratedTerm::Constant { value: 0.3 },
        CalibratedTerm::Polynomial {
            input: SeriesInput::Axis(1),
            coefficients: vec![0.2, -0.01, 3e-4, 1e-6],
        },
        CalibratedTerm::Polynomial { input: SeriesInput::Sensor(0), coefficients: vec![-3.0, 0.2, 0.004] },
        table(at(), CurveValues::Both(vec![0.1, 0.3, -0.2, 0.05])),
        table(at(), directed()),
        table(CurveNodes::Uniform { start: -10.0, step: 15.0 }, directed()),
        table(CurveNodes::Uniform { start: 50.0, step: -25.0 }, directed()),
        table(CurveNodes::Uniform { start: 50.0, step: -25.0 }, CurveValues::Both(vec![0.4, 0.1, -0.7])),
        table(CurveNodes::At(vec![7.0]), CurveValues::Both(vec![0.4])),
        CalibratedTerm::Backlash { axis: 0, lost_motion: 0.02, wind_up: 0.0 },
        CalibratedTerm::Backlash { axis: 1, lost_motion: 0.02, wind_up: 9.0 },
        CalibratedTerm::Backlash { axis: 1, lost_motion: -0.02, wind_up: 500.0 },
        CalibratedTerm::Cyclic { axis: 0, period: 8.0, amplitude: 0.004, phase: 2.0 },
        CalibratedTerm::Expansion { axis: 1, sensor: 0, coefficient: 1.1e-5, reference: 20.0 },
        CalibratedTerm::Growth { sensor: 0, coefficient: 0.01, reference: 20.0, time_constant: 0.0 },
        CalibratedTerm::Coupling { axis: 1, coefficients: vec![2e-4, -3e-6] },
        play.clone().times(vec![Factor::Position { axis: 1, power: 2, within: narrow }]),
        play.times(vec![Factor::Temperature {
            sensor: 0,
            reference: 20.0,
            time_constant: 0.0,
            within: warm,
        }]),
        one.clone()
            .times(vec![Factor::Direction { axis: 1 }, Factor::Turn { axis: 0, period: 30.0, phase: 1.0 }]),
        one.clone().times(vec![Factor::Play { sensor: 0, reference: 20.0, width: 0.7 }]),
        one.times(vec![Factor::Curve { axis: 1, at: vec![-20.0, 5.0, 12.0], values: vec![1.0, -0.4, 0.3] }]),
        table(at(), directed()).times(vec![Factor::Position {
            axis: 1,
            power: 1,
            within: Within::EVERYWHERE,
        }]),
    ];
    let states = states();
    for term in &terms {
        let expected = by_runtime(term, &states);
        assert!(peak(&expected) > 0.0);
        assert!(distance(&value(term, &states), &expected) <= 1e-12 * peak(&expected).max(1e-3), "{term:?}");
    }
}

#[test]
fn a_filtered_temperature_is_that_of_the_runtime_in_fine_steps() {
    let term = CalibratedTerm::Growth { sensor: 0, coefficient: 0.01, reference: 20.0, time_constant: 2.0 };
    let apart = |step: f64| {
        let time: Vec<f64> = (0..).map(|row| step * f64::from(row)).take_while(|t| *t < 12.0).collect();
        let recording = programmed(&time, std::slice::from_ref(&time));
        let warm = time.iter().map(|t| 21.0 + t.sin()).collect();
        let states = States::new(
            &recording,
            &Given::new(&recording, vec![warm], Vec::new()),
            &[Driven::default()],
            0.0,
        );
        distance(&value(&term, &states), &by_runtime(&term, &states))
    };
    // The runtime holds the temperature through a step: the difference is of the order of the step.
    let (coarse, fine) = (apart(0.02), apart(0.005));
    assert!(coarse < 0.01 * 0.02 && (3.5..4.5).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn a_filtered_temperature_that_rises_evenly_is_the_closed_solution() {
    let (rate, lag) = (0.3, 2.5);
    let time = uneven(43, 150, 0.1);
    let recording = programmed(&time, std::slice::from_ref(&time));
    let mut warm: Vec<f64> = time.iter().map(|t| 22.0 + rate * t).collect();
    let behind = |t: &f64| 22.0 + rate * (t - lag * (1.0 - (-t / lag).exp())) - 20.0;
    let expected: Vec<f64> = time.iter().map(behind).collect();
    let term = CalibratedTerm::Growth { sensor: 0, coefficient: 1.0, reference: 20.0, time_constant: lag };
    let found = value(
        &term,
        &States::new(
            &recording,
            &Given::new(&recording, vec![warm.clone()], Vec::new()),
            &[Driven::default()],
            0.0,
        ),
    );
    assert!(distance(&found, &expected) < 1e-10);
    // A gap is bridged: the filter runs on through it.
    warm[40..70].fill(f64::NAN);
    let found = value(
        &term,
        &States::new(&recording, &Given::new(&recording, vec![warm], Vec::new()), &[Driven::default()], 0.0),
    );
    assert!(found[40..70].iter().all(|value| value.is_nan()));
    assert!(distance(&found[70..], &expected[70..]) < 1e-10);
}

#[test]
fn terms_that_no_controller_has_are_their_formulas() {
    let states = states();
    let axis = &states.axes[0];
    let check = |term: CalibratedTerm, formula: &dyn Fn(usize, f64) -> f64| {
        let expected: Vec<f64> =
            states.given.time.iter().enumerate().map(|(row, t)| formula(row, *t)).collect();
        assert!(peak(&expected) > 0.0);
        assert!(distance(&value(&term, &states), &expected) <= 1e-12 * peak(&expected), "{term:?}");
    };
    check(CalibratedTerm::Drift { amplitude: 0.2, time_constant: 3.0 }, &|_, t| {
        0.2 * (1.0 - (-t / 3.0).exp())
    });
    check(CalibratedTerm::Vibration { frequency: 1.3, amplitude: 0.2, phase: -1.1 }, &|_, t| {
        0.2 * (TAU * 1.3 * t - 1.1).sin()
    });
    check(CalibratedTerm::Compliance { load: "force".to_owned(), coefficient: -2e-4 }, &|row, _| {
        -2e-4 * states.given.loads[0][row]
    });
    check(CalibratedTerm::Acceleration { axis: 0, gain: 400.0 }, &|row, _| -axis.acceleration[row] / 400.0);
    // From the positions alone: where x turned last.
    let turned = |row: usize| {
        let turns = |row: usize| {
            (axis.position[row] - axis.position[row - 1]) * (axis.position[row - 1] - axis.position[row - 2])
                < 0.0
        };
        (2..=row).rev().find(|row| turns(*row))
    };
    check(CalibratedTerm::ReversalSpike { axis: 0, height: 0.01, decay: 0.4 }, &|row, t| {
        turned(row).map_or(0.0, |at| {
            -0.01
                * (axis.position[at] - axis.position[at - 1]).signum()
                * (-(t - states.given.time[at]) / 0.4).exp()
        })
    });
    let missing = CalibratedTerm::Compliance { load: "current".to_owned(), coefficient: 1.0 };
    assert!(known(&missing, &|name: &str| (name == "force").then_some(0)).is_none());
}

#[test]
fn a_lag_is_a_time_constant_and_acts_through_the_states() {
    let states = states();
    let term = CalibratedTerm::Lag { axis: 0, gain: 40.0, frequency: 0.0 };
    assert!(value(&term, &states).iter().all(|value| *value == 0.0));
    let (shape, coefficients) = known(&term, &|_| None).unwrap();
    assert_eq!(coefficients, [1.0 / 40.0]);
    let mut columns = [Vec::new()];
    let rows = states.rows(0..ROWS);
    shape.fill(&rows, &mut Memory::default(), &mut columns);
    let column: Vec<f64> = columns[0].iter().map(|slope| slope / 40.0).collect();
    // In the first row the axis still stands.
    let expected = by_runtime(&term, &states);
    assert!(distance(&column[1..ROWS - 1], &expected[1..ROWS - 1]) < 2e-3 * peak(&expected));
}

#[test]
fn memory_goes_on_from_stretch_to_stretch() {
    let states = states();
    let shapes = [
        Shape::Backlash { axis: 1, wind_up: 12.0 },
        Shape::Growth { sensor: 0, reference: 20.0, time_constant: 1.5 },
        Shape::ReversalSpike { axis: 0, decay: 0.2 },
        Shape::Table { axis: 0, nodes: vec![-10.0, 20.0, 60.0], directed: true, repeats: false },
    ];
    for shape in shapes {
        let fill = |pieces: &[std::ops::Range<usize>]| {
            let mut memory = Memory::default();
            let mut whole = vec![Vec::new(); shape.columns()];
            for rows in pieces {
                let mut columns = vec![Vec::new(); shape.columns()];
                shape.fill(&states.rows(rows.clone()), &mut memory, &mut columns);
                whole.iter_mut().zip(columns).for_each(|(whole, piece)| whole.extend(piece));
            }
            whole
        };
        assert_eq!(
            fill(&[0..17, 17..18, 18..130, 130..ROWS]),
            fill(std::slice::from_ref(&(0..ROWS))),
            "{shape:?}"
        );
    }
}

#[test]
fn a_missing_position_is_a_missing_term() {
    let time: Vec<f64> = (0..6).map(f64::from).collect();
    let recording = programmed(&time, &[vec![0.0, 1.0, f64::NAN, 3.0, 2.0, 1.0]]);
    let states =
        States::new(&recording, &Given::new(&recording, Vec::new(), Vec::new()), &[Driven::default()], 0.0);
    let terms = [
        CalibratedTerm::Polynomial { input: SeriesInput::Axis(0), coefficients: vec![1.0, 2.0] },
        table(CurveNodes::At(vec![0.0, 3.0]), CurveValues::Both(vec![0.0, 1.0])),
        CalibratedTerm::Cyclic { axis: 0, period: 8.0, amplitude: 1.0, phase: 0.3 },
    ];
    for term in &terms {
        let missing: Vec<bool> = value(term, &states).iter().map(|value| value.is_nan()).collect();
        assert_eq!(missing, [false, false, true, false, false, false], "{term:?}");
    }
}

#[test]
fn polynomials_of_the_scaled_position_become_those_of_the_position() {
    let shapes = [
        Shape::Polynomial { axis: 0, degree: 3, center: 140.0, scale: 90.0 },
        Shape::SensorPolynomial { sensor: 0, degree: 2, center: 23.0, scale: 1.7 },
        Shape::Coupling { axis: 0, degree: 2, scale: 250.0 },
        Shape::Coupling { axis: 0, degree: 1, scale: -3.0 },
        Shape::Polynomial { axis: 0, degree: 0, center: 1.0, scale: 2.0 },
    ];
    for shape in shapes {
        let coefficients = normals(45, shape.columns());
        let (first, center, scale) = match shape {
            Shape::Polynomial { center, scale, .. } | Shape::SensorPolynomial { center, scale, .. } => {
                (0, center, scale)
            }
            Shape::Coupling { scale, .. } => (1, 0.0, scale),
            _ => panic!("no polynomial: {shape:?}"),
        };
        let matrix = polynomial_in_position(&shape);
        let powers: Vec<f64> =
            matrix.iter().map(|row| row.iter().zip(&coefficients).map(|(a, b)| a * b).sum()).collect();
        for q in [-30.0, 0.0, 17.0, 140.0, 400.0] {
            let x: f64 = (q - center) / scale;
            let scaled = (first..).zip(&coefficients).map(|(power, c)| c * x.powi(power)).sum::<f64>();
            let plain = (0..).zip(&powers).map(|(power, c)| c * f64::powi(q, power)).sum::<f64>();
            assert!((scaled - plain).abs() < 1e-9 * scaled.abs().max(1.0), "{shape:?} at {q}");
        }
    }
    assert!(polynomial_in_position(&Shape::Constant).is_empty());
}

#[test]
fn the_nonlinear_parameter_is_read_and_set() {
    let shapes = [
        Shape::Backlash { axis: 0, wind_up: 2.0 },
        Shape::ReversalSpike { axis: 0, decay: 2.0 },
        Shape::Cyclic { axis: 0, period: 2.0, order: 1, center: 0.0 },
        Shape::Growth { sensor: 0, reference: 20.0, time_constant: 2.0 },
        Shape::Drift { time_constant: 2.0 },
        Shape::Vibration { frequency: 2.0 },
        Shape::Lag { axis: 0, inertia: 2.0 },
    ];
    for shape in shapes {
        assert_eq!(shape.nonlinear().unwrap().value, 2.0);
        let other = shape.with_nonlinear(3.5);
        assert_eq!(other.nonlinear().unwrap().value, 3.5);
        assert_eq!(other.with_nonlinear(2.0), shape);
    }
    let play = Shape::Backlash { axis: 0, wind_up: 0.0 };
    assert!(play.nonlinear().is_none(), "play that is taken up at once has no wind-up to fit");
    assert!(Shape::Lag { axis: 0, inertia: 0.0 }.nonlinear().is_none(), "a first-order loop has no inertia");
    assert!(Shape::Constant.nonlinear().is_none() && Shape::Constant.with_nonlinear(3.0) == Shape::Constant);
}

/// Factors that the runtime lacks, or has for velocities that a controller knows better, against their formulas.
#[test]
fn other_factors_are_their_formulas() {
    let states = states();
    let within = Within::EVERYWHERE;
    let [x, load] = [&states.axes[0], &states.axes[1]].map(|axis| axis.velocity.clone());
    assert!(peak(&x) > 40.0 && peak(&load) > 40.0, "the axes move");
    let force = states.given.loads[0].clone();
    let time = states.given.time.clone();
    let one = || CalibratedTerm::Constant { value: 2.0 };
    let name = || "force".to_owned();
    let check = |factor: Factor, of: &dyn Fn(usize) -> f64| {
        let found = value(&one().times(vec![factor.clone()]), &states);
        let expected: Vec<f64> = (0..found.len()).map(|row| 2.0 * of(row)).collect();
        assert!(distance(&found, &expected) <= 1e-12 * peak(&expected).max(1.0), "{factor:?}");
    };
    check(Factor::Velocity { axis: 0, within }, &|row| x[row]);
    check(Factor::Speed { axis: 0, within: Within { from: 5.0, to: 30.0 } }, &|row| {
        x[row].abs().clamp(5.0, 30.0)
    });
    check(Factor::Fading { axis: 0, over: 20.0 }, &|row| (-x[row].abs() / 20.0).exp());
    check(Factor::Acceleration { axis: 0, within }, &|row| states.axes[0].acceleration[row]);
    check(Factor::Load { load: name(), within }, &|row| force[row]);
    check(Factor::Half { load: name(), at: 40.0 }, &|row| 1.0 / (1.0 + force[row].abs() / 40.0));
    check(Factor::After { time: time[100] }, &|row| f64::from(u8::from(row >= 100)));
    let steady = CalibratedTerm::Lag { axis: 0, gain: 20.0, frequency: 0.0 };
    let slow = steady.times(vec![Factor::Direction { axis: 0 }]);
    let expected: Vec<f64> = (0..x.len()).map(|row| -x[row] / 20.0 * states.axes[0].direction[row]).collect();
    let shape = known(&slow, &|_| None).unwrap();
    assert_eq!(shape.0.core(), &Shape::Constant, "a lag with factors is its steady state");
    let mut sum = vec![0.0; x.len()];
    shape.0.add(&shape.1, Side::After, &states.rows(0..x.len()), &mut Memory::default(), &mut sum);
    assert!(distance(&sum, &expected) <= 1e-12 * peak(&expected));
}

/// What remembers time, in steps of different length: a filter and a warmth against their differential equations, in fine steps.
#[test]
fn factors_that_remember_follow_their_equations() {
    let states = states();
    let (time, velocity) = (states.given.time.clone(), states.axes[0].velocity.clone());
    let warm = states.given.temperatures[0].clone();
    let force = states.given.loads[0].clone();
    let one = CalibratedTerm::Constant { value: 1.0 };
    // Euler steps from one row to the next; between rows the input is linear.
    let fine = 2000_u32;
    let solved = |input: &dyn Fn(usize) -> f64, start: f64, tau: f64| -> Vec<f64> {
        let mut now = start;
        let mut all = vec![now];
        for row in 1..time.len() {
            let step = (time[row] - time[row - 1]) / f64::from(fine);
            for part in 0..fine {
                let share = (f64::from(part) + 0.5) / f64::from(fine);
                let driven = input(row - 1) * (1.0 - share) + input(row) * share;
                now += step / tau * (driven - now);
            }
            all.push(now);
        }
        all
    };
    let near = |term: CalibratedTerm, expected: &[f64]| {
        let found = value(&term, &states);
        assert!(distance(&found, expected) < 1e-3 * peak(expected), "{term:?}");
    };
    let warmth = Factor::Warmth { axis: 0, time_constant: 3.0, rise: 0.02 };
    near(one.clone().times(vec![warmth]), &solved(&|row| 0.02 * velocity[row].abs(), 0.0, 3.0));
    let filtered =
        Factor::Temperature { sensor: 0, reference: 0.0, time_constant: 2.0, within: Within::EVERYWHERE };
    near(one.clone().times(vec![filtered]), &solved(&|row| warm[row], warm[0], 2.0));
    // Turns add up; one unit of the load is a hundredth of a turn each second.
    let mut turns = 0.0;
    let expected: Vec<f64> = (0..time.len())
        .map(|row| {
            if row > 0 {
                turns += 0.01 * 0.5 * (force[row] + force[row - 1]) * (time[row] - time[row - 1]);
            }
            (TAU * turns + 0.3).sin()
        })
        .collect();
    let spin = Factor::Spin { load: "force".to_owned(), rate: 0.01, phase: 0.3 };
    near(one.times(vec![spin]), &expected);
}

/// A delay is where the axis was, and an event is there from its time on.
#[test]
fn a_delay_looks_back_and_a_step_stays() {
    let states = states();
    let (time, x) = (states.given.time.clone(), states.axes[0].position.clone());
    let late = value(&CalibratedTerm::Delay { axis: 0, time: 0.01 }, &states);
    // Within a hundredth of a second the way bends little.
    let velocity = &states.axes[0].velocity;
    for (row, (late, velocity)) in late.iter().zip(velocity.iter()).enumerate().skip(2).take(x.len() - 4) {
        assert!((late + 0.01 * velocity).abs() < 0.1, "row {row}: {late} {velocity}");
    }
    assert_eq!(late[0], 0.0, "before the first row it stood there");
    let early = value(&CalibratedTerm::Delay { axis: 0, time: -0.01 }, &states);
    assert!(early[20] * late[20] < 0.0, "below zero it is early");
    let step = value(&CalibratedTerm::Step { time: time[50], size: 0.3 }, &states);
    assert_eq!((step[49], step[50], step[239]), (0.0, 0.3, 0.3));
}

/// However many rows there are, and however far from the first turn: each phase by the standard library, to what the product with 2 pi loses.
#[test]
fn waves_are_sines_and_cosines_of_their_turns() {
    for count in 0..10_u32 {
        let turns: Vec<f64> =
            (0..count).map(|row| 0.37 * f64::from(row) - 1.1 + 1e3 * f64::from(count)).collect();
        let mut columns = vec![vec![7.0; 3], Vec::new()];
        wave(turns.iter().copied(), &mut columns);
        let (sines, cosines) = (&columns[0], &columns[1]);
        assert_eq!([sines.len(), cosines.len()], [turns.len(); 2]);
        for (row, turn) in turns.iter().enumerate() {
            let (sine, cosine) = (TAU * turn).sin_cos();
            assert!((sines[row] - sine).abs() < 1e-15 && (cosines[row] - cosine).abs() < 1e-15, "{turn}");
        }
    }
    let mut unknown = vec![Vec::new(), Vec::new()];
    wave([f64::NAN, 0.25].into_iter(), &mut unknown);
    assert!(unknown[0][0].is_nan() && unknown[1][0].is_nan() && unknown[0][1] == 1.0, "{unknown:?}");
}
