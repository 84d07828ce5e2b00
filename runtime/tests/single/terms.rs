//! Every kind of term and factor, over both kinds of numbers, in the same cycles.
//!
//! In: the same parameters, positions, velocities and temperatures, all of which have a like in 32 bits. Out: values that differ by what
//! rounding leaves.

use crate::{ROUNDING, drawn};

/// What the machine does in one cycle: position, velocity, temperature.
type Cycle = (f32, f32, f32);

/// The values of each term or product below in each cycle, in a module of the runtime.
macro_rules! values_over {
    ($name:ident, $real:ident, $($path:ident)::+) => {
        mod $name {
            use $($path)::+::{
                Direction, ErrorMotion, Factor, Input, Sample, Table, Term, TermState, Values, Within,
            };

            use super::Cycle;

            pub(super) fn values(cycles: &[Cycle]) -> Vec<Vec<f64>> {
                let coefficients: [$real; 4] = [0.25, -0.5, 0.125, 0.0625].map(|number: $real| number / 1024.0);
                let curve: [$real; 4] = [0.0, 0.25, -0.5, 0.125];
                let table = Table::uniform(-512.0, 256.0, Values::Both(&curve)).unwrap();
                let within = Within { from: -300.0, to: 300.0 };
                let one = Term::Constant { value: 1.0 };
                let factors = [
                    Factor::Position { axis: 0, power: 3, within },
                    Factor::Direction { axis: 0 },
                    Factor::Velocity { axis: 0, within },
                    Factor::Speed { axis: 0, within },
                    Factor::Fading { axis: 0, over: 16.0 },
                    Factor::Temperature { sensor: 0, reference: 20.0, time_constant: 64.0, within: Within::EVERYWHERE },
                    Factor::Play { sensor: 0, reference: 20.0, width: 0.5 },
                    Factor::Warmth { axis: 0, time_constant: 64.0, rise: 0.25 },
                    Factor::Turn { axis: 0, period: 0.25, phase: 0.5 },
                    Factor::Curve { axis: 0, table },
                ];
                let mut lists: Vec<Vec<Term<'_>>> = vec![
                    vec![Term::Constant { value: 0.375 }],
                    vec![Term::Polynomial { input: Input::Axis(0), coefficients: &coefficients }],
                    vec![Term::Polynomial { input: Input::Sensor(0), coefficients: &coefficients }],
                    vec![Term::Coupling { axis: 0, coefficients: &coefficients }],
                    vec![Term::Table { axis: 0, table }],
                    vec![Term::Backlash { axis: 0, lost_motion: 0.0625, wind_up: 2.0, ramp: 0.5 }],
                    vec![Term::Cyclic { axis: 0, period: 0.03125, amplitude: 0.25, phase: 1.0 }],
                    vec![Term::Expansion { axis: 0, sensor: 0, coefficient: 0.0009765625, reference: 20.0 }],
                    vec![Term::Growth { sensor: 0, coefficient: 0.5, reference: 20.0, time_constant: 64.0 }],
                    vec![Term::Lag { axis: 0, gain: 32.0 }],
                ];
                lists.extend(factors.map(|factor| vec![Term::Factor(factor), one]));
                lists.iter().map(|terms| of_one(terms, cycles)).collect()
            }

            fn of_one(terms: &[Term<'_>], cycles: &[Cycle]) -> Vec<f64> {
                let motion = ErrorMotion { terms };
                let mut states = vec![TermState::default(); terms.len()];
                let mut before = 0.0;
                let follow = |&(position, velocity, temperature): &Cycle| {
                    let direction = if position < before { Direction::Negative } else { Direction::Positive };
                    before = position;
                    let sample = Sample {
                        position: &[position.into()],
                        travel: &[],
                        direction: &[direction],
                        velocity: &[velocity.into()],
                        temperature: &[temperature.into()],
                        time_step: 0.0078125,
                    };
                    motion.advance(&sample, &mut states);
                    f64::from(motion.corrected(&sample, &states))
                };
                cycles.iter().map(follow).collect()
            }
        }
    };
}

values_over!(double, f64, abbe_runtime);
values_over!(single, f32, abbe_runtime::single);

/// How large what is summed up in each of these is, in the order above, times how many operations round it. Angles of a period count with
/// the number of periods, since a quotient rounds them: 512 mm are 16 384 of the shorter ones.
const SIZES: [f64; 20] = [
    // Constant; polynomials: 512 mm to the power 3, and 40 degC; coupling: to the power 4. Horner's rule has two operations a coefficient.
    0.0,
    8.0 * 8700.0,
    8.0 * 6.0,
    9.0 * 4.3e6,
    // A table of three steps that rise by 0.75.
    3.0 * 3.0 * 0.75 + 3.0,
    // Play: a sum over 2000 cycles that loses nothing but its last digit; the product.
    4.0 * 0.0625,
    // Periods, their rest and 2 pi each, and the sine.
    0.25 * (2.0 * core::f64::consts::TAU * 16384.0 + 16.0),
    3.0 * 0.5 * 20.0,
    // The filtered temperature: sum, difference, product.
    3.0 * 40.0 * 0.5,
    20.0,
    // Factors.
    3.0 * 2.7e7,
    0.0,
    300.0,
    300.0,
    8.0,
    3.0 * 40.0,
    3.0 * 40.0,
    4.0 * 100.0,
    2.0 * core::f64::consts::TAU * 2048.0 + 16.0,
    3.0 * 3.0 * 0.75 + 3.0,
];

#[test]
fn all_are_those_of_64_bits_but_for_rounding() {
    let mut draw = drawn(3);
    let cycles: Vec<Cycle> =
        (0..2000).map(|_| (512.0 * draw(), 400.0 * draw(), 20.0 + 20.0 * draw())).collect();
    let (found, expected) = (single::values(&cycles), double::values(&cycles));
    assert_eq!(found.len(), SIZES.len());
    for ((number, size), (found, expected)) in SIZES.iter().enumerate().zip(found.iter().zip(&expected)) {
        for (cycle, (found, expected)) in found.iter().zip(expected).enumerate() {
            assert!(
                (found - expected).abs() <= ROUNDING * size * (1.0 + 1e-4),
                "list {number}, cycle {cycle}: {found} is not {expected}"
            );
        }
        assert!(expected.iter().any(|value| *value != 0.0), "list {number} says nothing");
    }
}
