//! Calibrations that were compiled in. In: random machines. Out: terms of every kind with random numbers, servo cycles with random
//! positions, directions and temperatures; what the runtime answers to them when it reads the terms from slices; and the
//! program by which compiled code answers the same.

use std::fmt::Write;

use abbe_runtime::{
    Compensator, Direction, ErrorMotion, Kinematics, Sample, Term, TermState, Work, states_needed,
};
use model_dsl::calibration::{
    CalibratedTerm, Calibration, Curve, CurveNodes, CurveValues, Factor, Ramp, SensorReadings, SeriesInput,
    Tool, Within,
};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::program::Interpreter;
use model_dsl::source::{SourceFile, Span, Spanned};
use proptest::prelude::Rng;
use proptest::test_runner::TestRng;

use super::list;
use crate::oracle::Machine;
use crate::random::state;

/// Cycles for each calibration.
const CYCLES: usize = 6;
/// The sensors of the machine, in the order in which the calibration first speaks of them.
const INPUTS: usize = 2;
/// Nodes of a long table: those of two motions fill a calibration file, which holds 200 000 values.
const LONG: usize = 99_000;

/// A calibration, and cycles in which it is asked for.
pub(super) struct Followed {
    pub(super) calibration: Calibration,
    cycles: Vec<Cycle>,
}

/// What the controller knows in one cycle.
struct Cycle {
    position: Vec<f64>,
    reversed: Vec<bool>,
    velocity: Vec<f64>,
    inputs: [f64; INPUTS],
    time_step: f64,
}

/// From -1 to 1.
fn draw(rng: &mut TestRng) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn pick(rng: &mut TestRng, count: usize) -> usize {
    rng.next_u32() as usize % count
}

fn draws(rng: &mut TestRng, size: f64, count: usize) -> Vec<f64> {
    (0..count).map(|_| size * draw(rng)).collect()
}

impl Followed {
    /// A calibration with up to so many terms for each error motion.
    pub(super) fn draw(machine: &Machine, equations: &Equations, most: usize, rng: &mut TestRng) -> Self {
        let mut calibration = with_sensors(equations);
        calibration.constants =
            equations.constants.iter().map(|constant| state(machine, 0).constants[&*constant.name]).collect();
        let mut terms = Vec::new();
        for (number, motion) in equations.motions.iter().enumerate() {
            let size = if motion.angular { 2e-5 } else { 0.02 };
            for _ in 0..pick(rng, most + 1) {
                if let Some(term) = term(rng, equations.axes.len(), size) {
                    let factors = factors(rng, equations.axes.len());
                    let takes = term.kind().takes_factors();
                    terms.push((number, if takes { term.times(factors) } else { term }));
                }
            }
        }
        let mut calibration = calibration.with(&terms);
        for motion in &mut calibration.motions {
            let backlash = |term: &CalibratedTerm| matches!(term.core(), CalibratedTerm::Backlash { .. });
            let ramped = motion.terms.iter().position(|term| backlash(&term.value));
            motion.ramps = ramped
                .filter(|_| pick(rng, 2) == 0)
                .map(|term| Ramp { term, time: 0.05 })
                .into_iter()
                .collect();
        }
        // Half of them with a tool, in whose place the constants themselves are others.
        if pick(rng, 2) == 0 {
            let constants = calibration.constants.iter().map(|constant| constant + 50.0).collect();
            let constants = std::mem::replace(&mut calibration.constants, constants);
            calibration.tools.push(Tool { name: Spanned::new("T1".to_owned(), Span::default()), constants });
        }
        let cycles = (0..CYCLES).map(|_| Cycle::draw(rng, equations.axes.len())).collect();
        Self { calibration, cycles }
    }

    /// With a table of very many nodes for each error motion, over the first axis.
    pub(super) fn with_long_tables(mut self, rng: &mut TestRng) -> Self {
        let nodes = || CurveNodes::Uniform { start: -300.0, step: 600.0 / LONG as f64 };
        for motion in 0..self.calibration.motions.len() {
            let curve = Curve::new(nodes(), CurveValues::Both(draws(rng, 2e-5, LONG)));
            self.calibration = self.calibration.with(&[(motion, CalibratedTerm::Table { axis: 0, curve })]);
        }
        self
    }

    /// The calls by which the compiled calibration answers every cycle.
    pub(super) fn program(&self, number: usize) -> String {
        let machine = if self.calibration.tools.is_empty() { "MACHINE" } else { "TOOLS[0].1" };
        let mut text = format!(
            "    {{ const MACHINE: m{number}::Machine = m{number}::Calibration::{machine};\n\
             let mut follow = Follow::new(&MACHINE, &m{number}::Calibration, m{number}::Calibration::TERMS);\n"
        );
        let sensors = self.calibration.sensors.iter().any(|sensor| sensor.used);
        if sensors {
            let _ = writeln!(text, "    let mut sensors = m{number}::Sensors::new();");
        }
        for cycle in &self.cycles {
            let used = self.calibration.sensors.inputs().map(|(index, _)| cycle.inputs[index]);
            let temperature = if sensors {
                format!("&sensors.update(*{})", list(&used.collect::<Vec<_>>()))
            } else {
                "&[]".to_owned()
            };
            let _ = writeln!(
                text,
                "    follow.say({}, &{:?}, {}, {temperature}, {:?});",
                list(&cycle.position),
                cycle.reversed,
                list(&cycle.velocity),
                cycle.time_step
            );
        }
        text.push_str("    }\n");
        text
    }

    /// What the runtime answers, a line for each cycle, with the interpreter and terms in slices.
    pub(super) fn at_run_time(&self, equations: &Equations) -> Vec<String> {
        let tool = self.calibration.tools.first().map(|tool| &tool.constants);
        let kinematics = Interpreter::new(equations, tool.unwrap_or(&self.calibration.constants));
        let terms: Vec<Vec<Term<'_>>> = (0..equations.motions.len())
            .map(|motion| self.calibration.runtime(motion).flat_map(Result::unwrap).collect())
            .collect();
        let motions: Vec<_> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
        let mut states = vec![TermState::default(); states_needed(&motions)];
        let (mut directions, mut values) = (vec![[0.0; 3]; kinematics.axes()], vec![0.0; motions.len()]);
        let mut travel = vec![0.0; kinematics.travels().len()];
        let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
        let mut compensator = Compensator::new(&kinematics, &motions, &mut states, work).unwrap();
        let mut readings = SensorReadings::new(&self.calibration.sensors);
        let answer = |cycle: &Cycle| {
            let direction: Vec<_> = cycle.reversed.iter().map(|reversed| way(*reversed)).collect();
            let sample = Sample {
                position: &cycle.position,
                travel: &[],
                direction: &direction,
                velocity: &cycle.velocity,
                temperature: readings.update(|index| cycle.inputs[index]),
                time_step: cycle.time_step,
            };
            let mut command = cycle.position.clone();
            match compensator.compensate(&sample, &mut command) {
                Ok(outcome) => {
                    let numbers = outcome.error.iter().chain(&outcome.remaining).chain(&command);
                    let bits =
                        numbers.map(|number| number.to_bits().to_string()).collect::<Vec<_>>().join(" ");
                    format!("{} {bits}", outcome.iterations)
                }
                Err(refusal) => format!("{refusal:?}"),
            }
        };
        self.cycles.iter().map(answer).collect()
    }
}

impl Cycle {
    fn draw(rng: &mut TestRng, axes: usize) -> Self {
        Self {
            position: draws(rng, 300.0, axes),
            reversed: (0..axes).map(|_| pick(rng, 2) == 0).collect(),
            velocity: draws(rng, 50.0, axes),
            inputs: std::array::from_fn(|_| 20.0 + 5.0 * draw(rng)),
            time_step: 0.01 * (1.0 + draw(rng)),
        }
    }
}

fn way(reversed: bool) -> Direction {
    if reversed { Direction::Negative } else { Direction::Positive }
}

/// A calibration without terms, of two sensors and two that are derived from them.
fn with_sensors(equations: &Equations) -> Calibration {
    let mut text = format!("calibration: 1\nmachine: {}\nconstants:\n", equations.machine);
    for (_, constant) in equations.offsets() {
        let _ = writeln!(text, "  {}: 1 mm", constant.name);
    }
    text.push_str("sensors: {both: {mean: [T1, T2]}, start: {initial: T2}}\n");
    let source = SourceFile::new("calibration.yaml", text);
    let mut diagnostics = Diagnostics::new();
    let root = model_dsl::yaml::read(&source, &mut diagnostics).unwrap();
    let read = model_dsl::calibration::read(&root, &equations.names(), &mut diagnostics);
    read.unwrap_or_else(|| panic!("{diagnostics:?}\n{}", source.text()))
}

/// Up to two factors that a controller knows, each of about 1 where a machine is; none of an axis where there is no axis. Which
/// units they have, the compiler of Rust does not ask.
fn factors(rng: &mut TestRng, axes: usize) -> Vec<Factor> {
    let most = if axes == 0 { 0 } else { pick(rng, 3) };
    (0..most).map(|_| factor(rng, axes)).collect()
}

fn factor(rng: &mut TestRng, axes: usize) -> Factor {
    let (axis, sensor) = (pick(rng, axes), pick(rng, 4));
    let narrow = Within { from: -1.0, to: 1.0 };
    let range = |rng: &mut TestRng| if pick(rng, 2) == 0 { Within::EVERYWHERE } else { narrow };
    match pick(rng, 10) {
        0 => Factor::Position { axis, power: 1 + u8::try_from(pick(rng, 3)).unwrap(), within: narrow },
        1 => Factor::Direction { axis },
        2 => Factor::Velocity { axis, within: narrow },
        3 => Factor::Speed { axis, within: narrow },
        4 => Factor::Fading { axis, over: 20.0 },
        5 => {
            let time_constant = if pick(rng, 2) == 0 { 0.0 } else { 0.02 };
            Factor::Temperature { sensor, reference: 20.0, time_constant, within: range(rng) }
        }
        6 => Factor::Play { sensor, reference: 20.0, width: 1.0 },
        7 => Factor::Warmth { axis, time_constant: 0.1, rise: 0.05 },
        8 => Factor::Turn { axis, period: 40.0, phase: draw(rng) },
        _ => Factor::Curve { axis, at: vec![-200.0, 0.0, 150.0], values: draws(rng, 1.0, 3) },
    }
}

/// A term of any kind that a controller compensates, of this size; none of an axis where there is no axis.
fn term(rng: &mut TestRng, axes: usize, size: f64) -> Option<CalibratedTerm> {
    let sensor = pick(rng, 4);
    // Over a few degC, and below over 300 mm, as much as the size.
    let warmth = size / 5.0;
    let value = size * draw(rng);
    let term = match (pick(rng, 13), axes) {
        (0, _) => CalibratedTerm::Constant { value },
        (1, _) => CalibratedTerm::Polynomial {
            input: SeriesInput::Sensor(sensor),
            coefficients: vec![value, warmth * draw(rng) / 5.0],
        },
        (2, _) => CalibratedTerm::Growth {
            sensor,
            coefficient: warmth * draw(rng),
            reference: 20.0,
            time_constant: if pick(rng, 2) == 0 { 0.0 } else { 0.02 },
        },
        (_, 0) => return None,
        (kind, _) => of_axis(rng, kind, axes, sensor, size),
    };
    Some(term)
}

/// A term of one of so many axes.
fn of_axis(rng: &mut TestRng, kind: usize, axes: usize, sensor: usize, size: f64) -> CalibratedTerm {
    let (axis, slope) = (pick(rng, axes), size / 300.0);
    match kind {
        3 => CalibratedTerm::Polynomial {
            input: SeriesInput::Axis(axis),
            coefficients: vec![size * draw(rng), slope * draw(rng), slope * draw(rng) / 300.0],
        },
        4 => CalibratedTerm::Coupling {
            axis,
            coefficients: vec![slope * draw(rng), slope * draw(rng) / 300.0],
        },
        5 => CalibratedTerm::Backlash {
            axis,
            lost_motion: size * draw(rng),
            wind_up: if pick(rng, 2) == 0 { 0.0 } else { 400.0 },
        },
        6 => CalibratedTerm::Cyclic { axis, period: 10.0, amplitude: slope * draw(rng), phase: draw(rng) },
        7 => CalibratedTerm::Lag { axis, gain: 5.0 / slope, frequency: 0.0 },
        8 => {
            CalibratedTerm::Expansion { axis, sensor, coefficient: slope * draw(rng) / 5.0, reference: 20.0 }
        }
        9 => CalibratedTerm::Delay { axis, time: slope / 5.0 },
        _ => CalibratedTerm::Table { axis, curve: curve(rng, size) },
    }
}

/// A curve over even or uneven nodes, rising or falling, in one direction or both; some of the positions lie beyond it.
fn curve(rng: &mut TestRng, size: f64) -> Curve {
    let count = 1 + pick(rng, 5);
    let nodes = match pick(rng, 4) {
        0 => CurveNodes::At((0..count).map(|node| 100.0 * node as f64 + 40.0 * draw(rng)).collect()),
        // Other tables of the axis have the same nodes.
        1 => CurveNodes::Uniform { start: 200.0, step: -90.0 },
        _ => CurveNodes::Uniform { start: -200.0, step: 90.0 },
    };
    let values = match pick(rng, 2) {
        0 => CurveValues::Both(draws(rng, size, count)),
        _ => CurveValues::Directed { forward: draws(rng, size, count), reverse: draws(rng, size, count) },
    };
    let repeats = count > 1 && pick(rng, 3) == 0;
    Curve { nodes, values, repeats }
}

/// The compiled side of [`Followed::at_run_time`].
pub(super) const FOLLOW: &str = r#"
use abbe_runtime::{Compensator, Direction, ErrorMotions, Sample, TermState, Work};
struct Follow<M: ErrorMotions + 'static> {
    compensator: Compensator<'static, dyn Kinematics, M>,
}
impl<M: ErrorMotions> Follow<M> {
    fn new(machine: &'static dyn Kinematics, calibration: &'static M, terms: usize) -> Self {
        let states = vec![TermState::default(); terms].leak();
        let work = Work {
            directions: vec![[0.0; 3]; machine.axes()].leak(),
            motions: vec![0.0; machine.motions()].leak(),
            travel: vec![0.0; machine.travels().len()].leak(),
        };
        let compensator = Compensator::with_calibration(machine, calibration, states, work).unwrap();
        Self { compensator }
    }
    fn say(&mut self, position: &[f64], reversed: &[bool], velocity: &[f64], temperature: &[f64], time_step: f64) {
        let way = |reversed: &bool| if *reversed { Direction::Negative } else { Direction::Positive };
        let direction: Vec<_> = reversed.iter().map(way).collect();
        let sample = Sample { position, travel: &[], direction: &direction, velocity, temperature, time_step };
        let mut command = position.to_vec();
        match self.compensator.compensate(&sample, &mut command) {
            Ok(outcome) => {
                let numbers = outcome.error.iter().chain(&outcome.remaining).chain(&command);
                let bits = numbers.map(|number| number.to_bits().to_string()).collect::<Vec<_>>().join(" ");
                println!("{} {bits}", outcome.iterations);
            }
            Err(refusal) => println!("{refusal:?}"),
        }
    }
}
"#;
