//! Numbers of 32 bits beside those of 64, on the shipped machines.
//!
//! In: machines and calibrations, compiled over both; random positions in the workspace that both can hold. Out: how far the commands of
//! 32 bits are from those of 64, against what rounding leaves, and in the words of `docs/performance.md`.

#![expect(clippy::cast_possible_truncation, reason = "the nearest number of 32 bits is asked for")]

use std::fs;

use abbe_runtime::math::length;
use abbe_runtime::{Direction, ErrorMotion, Input, Sample, Term, TermState};

use crate::oracle::draw;
use crate::shipped::root;

/// Cycles for each machine.
const CYCLES: u64 = 20_000;

/// What one operation of 32 bits rounds by, beside its result.
const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;

/// The step that ends a search over numbers of 32 bits, mm or rad, and the fastest change of an error of these machines over a mm or a
/// rad: what is left behind the step is their product.
const LAST_STEP: f64 = 1e-6;
const FASTEST: f64 = 2e-3;

/// One servo cycle: positions that have a like in 32 bits, and directions of motion.
struct Cycle {
    position: Vec<f32>,
    backward: Vec<bool>,
}

/// A machine over one kind of numbers: the commands and errors of cycles, one after the other.
type Compiled = fn(&[Cycle]) -> Vec<(Vec<f64>, [f64; 3])>;

/// A machine over both kinds of numbers, and where it works.
struct Machine {
    /// What it is called in the documentation.
    name: &'static str,
    double: Compiled,
    single: Compiled,
    numbers: fn() -> Numbers,
    /// The temperature of every sensor, degC.
    temperatures: fn() -> Vec<f64>,
    /// The range of each axis, mm or rad.
    workspace: &'static [[f32; 2]],
    /// How many of these are slides; rotary axes come behind them.
    slides: usize,
}

/// The error motions of a machine with their names, and its constants in mm.
struct Numbers {
    names: &'static [&'static str],
    motions: &'static [ErrorMotion<'static>],
    constants: Vec<f64>,
}

/// Slides at this speed in every cycle, mm/s; a cycle in s.
const VELOCITY: f32 = 2.5;
const TIME_STEP: f32 = 0.0078125;

/// A machine with a calibration over one kind of numbers: `$runtime` has them.
macro_rules! over {
    ($runtime:path, $temperatures:expr, $($files:tt)+) => {
        use $runtime as runtime;
        use runtime::{Compensator, ErrorMotions, Kinematics, Real, TermState, Work};

        abbe_macros::machine!($($files)+);

        pub(in crate::single) fn temperatures() -> Vec<Real> {
            $temperatures
        }

        pub(in crate::single) fn answers(cycles: &[crate::single::Cycle]) -> Vec<(Vec<f64>, [f64; 3])> {
            let machine = Calibration::MACHINE;
            let mut states = [TermState::default(); Calibration::TERMS];
            let mut directions = [[0.0; 3]; Axes::NAMES.len()];
            let mut values = [0.0; Motions::NAMES.len()];
            let mut travel = vec![0.0; machine.travels().len()];
            let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
            let compensator = Compensator::with_calibration(&machine, &Calibration, &mut states, work);
            let mut compensator = compensator.unwrap();
            compensator.limits = Calibration::LIMITS;
            cycles.iter().map(|cycle| answer(&mut compensator, cycle)).collect()
        }

        fn answer(
            compensator: &mut Compensator<'_, Machine, Calibration>,
            cycle: &crate::single::Cycle,
        ) -> (Vec<f64>, [f64; 3]) {
            let of_backward = |backward: &bool| match backward {
                true => runtime::Direction::Negative,
                false => runtime::Direction::Positive,
            };
            let sample = runtime::Sample {
                position: &cycle.position.iter().copied().map(Real::from).collect::<Vec<_>>(),
                travel: &[],
                direction: &cycle.backward.iter().map(of_backward).collect::<Vec<_>>(),
                velocity: &[Real::from(crate::single::VELOCITY); Axes::NAMES.len()],
                temperature: &temperatures(),
                time_step: Real::from(crate::single::TIME_STEP),
            };
            let mut command = [0.0; Axes::NAMES.len()];
            let outcome = compensator.compensate(&sample, &mut command);
            let outcome = outcome.unwrap_or_else(|refusal| panic!("{:?}: {refusal}", cycle.position));
            (command.map(f64::from).to_vec(), outcome.error.map(f64::from))
        }

        /// The terms, as the code has them.
        pub(in crate::single) fn motions() -> &'static [runtime::ErrorMotion<'static>] {
            const COMPILED_IN: &Calibration = &Calibration;
            COMPILED_IN.motions()
        }
    };
}

/// A machine with a calibration over both.
macro_rules! both {
    ($module:ident, $temperatures:expr, $machine:literal, $calibration:literal) => {
        mod $module {
            pub(in crate::single) mod double {
                over!(abbe_runtime, $temperatures, $machine, $calibration);
            }
            #[expect(dead_code, reason = "a machine offers more than is asked for")]
            mod single {
                over!(abbe_runtime::single, $temperatures, $machine, $calibration, f32);
            }
            pub(in crate::single) fn numbers() -> super::Numbers {
                let constants = double::Calibration::MACHINE.constants.to_array().to_vec();
                super::Numbers { names: &double::Motions::NAMES, motions: double::motions(), constants }
            }
            pub(in crate::single) use double::{answers as in_64, temperatures};
            pub(in crate::single) use single::answers as in_32;
        }
    };
}

both!(lathe, vec![], "machines/excello-921.yaml", "calibrations/excello-921.yaml");
both!(
    turning_center,
    Sensors::new().update([21.5; Sensors::INPUTS.len()]).to_vec(),
    "machines/nist-turning-center.yaml",
    "calibrations/nist-turning-center.yaml"
);
both!(mill, vec![], "machines/postech-mill.yaml", "calibrations/postech-mill.yaml");
both!(
    head_table,
    Sensors::new().update([21.5, 22.25]).to_vec(),
    "machines/head-table-5axis.yaml",
    "examples/controller/numbers.yaml"
);
both!(trunnion, vec![], "machines/trunnion-5axis.yaml", "tests/fixtures/calibrations/trunnion.yaml");
both!(
    pointing,
    vec![],
    "tests/fixtures/pointing-trunnion.yaml",
    "tests/fixtures/calibrations/pointing-trunnion.yaml"
);

macro_rules! entry {
    ($name:literal, $module:ident, $slides:literal, $workspace:expr) => {
        Machine {
            name: $name,
            double: $module::in_64,
            single: $module::in_32,
            numbers: $module::numbers,
            temperatures: $module::temperatures,
            workspace: &$workspace,
            slides: $slides,
        }
    };
}

/// Where each calibration holds: travels of the lathe in inches, tables of the mill; the others are taken as large as such machines are.
const MACHINES: [Machine; 5] = [
    entry!("excello-921", lathe, 2, [[0.0, 305.0], [0.0, 559.0]]),
    entry!("nist-turning-center", turning_center, 2, [[-250.0, 0.0], [-500.0, 0.0]]),
    entry!("postech-mill", mill, 3, [[0.0, 550.0], [0.0, 280.0], [-110.0, 0.0]]),
    entry!(
        "head-table-5axis",
        head_table,
        3,
        [[-400.0, 400.0], [-400.0, 400.0], [-400.0, 400.0], [-1.6, 1.6], [-6.3, 6.3]]
    ),
    entry!(
        "trunnion-5axis",
        trunnion,
        3,
        [[-400.0, 400.0], [-400.0, 400.0], [-400.0, 400.0], [-1.6, 1.6], [-6.3, 6.3]]
    ),
];

impl Machine {
    fn cycles(&self) -> Vec<Cycle> {
        (0..CYCLES).map(|number| self.cycle(number)).collect()
    }

    /// A cycle anywhere in the workspace.
    fn cycle(&self, number: u64) -> Cycle {
        let part = |axis: usize, what: &str| draw(number, &format!("{} {axis} {what}", self.name));
        let place = |(axis, [from, to]): (usize, &[f32; 2])| {
            let middle = f64::from(from + to) / 2.0;
            (middle + part(axis, "position") * f64::from(to - from) / 2.0) as f32
        };
        Cycle {
            position: self.workspace.iter().enumerate().map(place).collect(),
            backward: (0..self.workspace.len()).map(|axis| part(axis, "direction") < 0.0).collect(),
        }
    }

    /// The farthest that an axis is from its zero, mm or rad.
    fn farthest(&self, axis: usize) -> f64 {
        let [from, to] = self.workspace[axis].map(f64::from);
        from.abs().max(to.abs())
    }

    /// How large the numbers are that a term is summed up of, at any place of the workspace: mm or rad.
    fn size(&self, term: &Term<'_>) -> f64 {
        let at = |axis: usize| self.farthest(axis);
        let polynomial = |coefficients: &[f64], at: f64| {
            coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * at + coefficient.abs())
        };
        let temperature = |sensor: usize| (self.temperatures)()[sensor].abs();
        match *term {
            Term::Constant { value } => value.abs(),
            Term::Polynomial { input: Input::Axis(axis), coefficients } => polynomial(coefficients, at(axis)),
            Term::Polynomial { input: Input::Sensor(sensor), coefficients } => {
                polynomial(coefficients, temperature(sensor))
            }
            Term::Coupling { axis, coefficients } => polynomial(coefficients, at(axis)) * at(axis),
            // A value and a rise, which is up to twice as large as the largest value.
            Term::Table { axis, table } => {
                let [from, to] = self.workspace[axis].map(f64::from);
                let places = (0..=1000).map(|part| from + (to - from) * f64::from(part) / 1000.0);
                let values = places.flat_map(|place| {
                    [Direction::Positive, Direction::Negative]
                        .map(|direction| table.value(place, direction).abs())
                });
                3.0 * values.fold(0.0, f64::max)
            }
            Term::Backlash { lost_motion, .. } => lost_motion.abs(),
            // The number of periods is rounded, and its angle with it.
            Term::Cyclic { axis, period, amplitude, phase } => {
                let angle = std::f64::consts::TAU * at(axis) / period.abs() + phase.abs();
                amplitude.abs() * (1.0 + angle)
            }
            Term::Expansion { axis, sensor, coefficient, reference } => {
                coefficient.abs() * (temperature(sensor) + reference.abs()) * at(axis)
            }
            Term::Growth { sensor, coefficient, reference, .. } => {
                coefficient.abs() * (temperature(sensor) + reference.abs())
            }
            Term::Lag { gain, .. } => f64::from(VELOCITY) / gain.abs(),
            Term::Factor(_) => panic!("none of these calibrations has a factor"),
        }
    }

    /// How large what the error of the tip is summed up of is, mm, and how often it is rounded on the way.
    fn summed_up(&self) -> (f64, f64) {
        let Numbers { names, motions, constants } = (self.numbers)();
        // A lever arm is a sum of constants and positions; sines and cosines make none of them larger.
        let slides = (0..self.slides).map(|axis| self.farthest(axis));
        let arm: f64 = constants.iter().map(|constant| constant.abs()).chain(slides).sum();
        let of_motion = |(name, motion): (&&str, &ErrorMotion<'_>)| {
            let size: f64 = motion.terms.iter().map(|term| self.size(term)).sum();
            if name.as_bytes()[1] < b'X' { size * arm } else { size }
        };
        let size = names.iter().zip(motions).map(of_motion).sum();
        let most = motions.iter().map(|motion| motion.terms.len()).max().unwrap_or_default();
        // In a term no more than ten (the third power of Horner's rule with its coefficients, once rounded themselves), in a lever arm
        // sines, cosines, their products and the sum of its parts, and a sum over all terms and all motions.
        (size, 10.0 + 2.0 * (constants.len() + self.workspace.len()) as f64 + (most + motions.len()) as f64)
    }

    /// The most that a command of 32 bits may be from one of 64, mm or rad: half a step of the farthest command, what the error is rounded
    /// by, and what a search leaves.
    fn bound(&self, axis: usize) -> f64 {
        let Numbers { motions, .. } = (self.numbers)();
        let step = {
            let farthest = self.farthest(axis) as f32;
            f64::from(farthest.next_up() - farthest)
        };
        let (size, times) = self.summed_up();
        let size = if axis < self.slides {
            size
        } else {
            let turned = |term: &Term<'_>| if term.axis() == Some(axis) { self.size(term) } else { 0.0 };
            motions.iter().flat_map(|motion| motion.terms).map(turned).sum()
        };
        step / 2.0 + ROUNDING * size * times + LAST_STEP * FASTEST
    }
}

/// What was found for one machine.
struct Found {
    /// The greatest difference of commands of slides, mm, and of rotary axes, rad.
    slides: f64,
    rotary: f64,
    /// The greatest difference of predicted errors, mm.
    error: f64,
}

fn found(machine: &Machine) -> Found {
    let cycles = machine.cycles();
    let (expected, single) = ((machine.double)(&cycles), (machine.single)(&cycles));
    let mut found = Found { slides: 0.0, rotary: 0.0, error: 0.0 };
    let bounds: Vec<f64> = (0..machine.workspace.len()).map(|axis| machine.bound(axis)).collect();
    for (cycle, (expected, single)) in cycles.iter().zip(expected.iter().zip(&single)) {
        for (axis, (a, b)) in expected.0.iter().zip(&single.0).enumerate() {
            let apart = (a - b).abs();
            assert!(apart <= bounds[axis], "{} axis {axis} at {:?}: {apart}", machine.name, cycle.position);
            let most = if axis < machine.slides { &mut found.slides } else { &mut found.rotary };
            *most = most.max(apart);
        }
        let apart = expected.1.iter().zip(&single.1).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        found.error = found.error.max(apart);
    }
    found
}

/// The row of a machine in the documentation.
fn row(machine: &Machine, found: &Found) -> String {
    let farthest = (0..machine.slides).map(|axis| machine.farthest(axis)).fold(0.0, f64::max);
    let rotary = if machine.slides < machine.workspace.len() {
        format!("{:.2}", found.rotary * 1e6)
    } else {
        String::new()
    };
    format!(
        "| {} | {farthest} | {:.1} | {rotary} | {:.2} |",
        machine.name,
        found.slides * 1e6,
        found.error * 1e6
    )
}

/// The page that states what is lost has this.
fn stated(text: &str) {
    let page = fs::read_to_string(root().join("docs/performance.md")).unwrap();
    assert!(page.contains(text), "docs/performance.md does not have: {text}");
}

#[test]
fn commands_of_32_bits_are_those_of_64_but_for_rounding() {
    let rows: Vec<String> = MACHINES.iter().map(|machine| row(machine, &found(machine))).collect();
    stated(&rows.join("\n"));
}

/// A trunnion whose rotary axes correct the direction of the tool. Below a tilt of 0.1 rad they turn up to a hundred times as far as the
/// direction, and what rounding takes of it grows as much.
const POINTING: Machine = entry!(
    "pointing-trunnion",
    pointing,
    3,
    [[-400.0, 400.0], [-400.0, 400.0], [-400.0, 400.0], [0.1, 1.6], [-6.3, 6.3]]
);

/// Where the tip of the tool really is at a command, and how the tool really points, by the equations of 64 bits.
fn really(command: &[f64], cycle: &Cycle) -> [[f64; 3]; 2] {
    use pointing::double::{Axes, Calibration, Motions};
    let of_backward = |backward: &bool| if *backward { Direction::Negative } else { Direction::Positive };
    let sample = Sample {
        position: command,
        travel: &[],
        direction: &cycle.backward.iter().map(of_backward).collect::<Vec<_>>(),
        velocity: &[],
        temperature: &[],
        time_step: 0.0,
    };
    let value =
        |motion: &ErrorMotion<'_>| motion.value(&sample, &vec![TermState::default(); motion.terms.len()]);
    let motions: Vec<f64> = pointing::double::motions().iter().map(value).collect();
    let (axes, motions) =
        (Axes::from_array(command.try_into().unwrap()), Motions::from_array(motions[..].try_into().unwrap()));
    let machine = Calibration::MACHINE;
    let sum = |[a, b]: [[f64; 3]; 2]| std::array::from_fn(|k| a[k] + b[k]);
    [
        sum([machine.nominal(&axes), machine.error(&axes, &motions)]),
        sum([machine.direction(&axes), machine.direction_error(&axes, &motions)]),
    ]
}

/// Commands of rotary axes that are rounded take the tip along, and slides follow it there: tip and direction count, not the commands. The
/// slides find out where the tip is from its place before and behind that turn, which is rounded twice.
#[test]
fn tools_point_as_well_but_for_rounding() {
    let cycles = POINTING.cycles();
    let (expected, single) = ((POINTING.double)(&cycles), (POINTING.single)(&cycles));
    let mut most = [0.0_f64; 2];
    for (cycle, (expected, single)) in cycles.iter().zip(expected.iter().zip(&single)) {
        let (expected, single) = (really(&expected.0, cycle), really(&single.0, cycle));
        for (most, (a, b)) in most.iter_mut().zip(expected.iter().zip(single)) {
            let apart: [f64; 3] = std::array::from_fn(|k| a[k] - b[k]);
            *most = most.max(length(apart));
        }
    }
    let [tip, direction] = most;
    // Sines, cosines, two products and sums of three lever arms: ten roundings of no more than all arms, in each of three directions.
    let arm: f64 =
        (POINTING.numbers)().constants.iter().map(|constant| constant.abs()).sum::<f64>() + 3.0 * 400.0;
    let slides = (0..3).map(|axis| POINTING.bound(axis)).sum::<f64>();
    assert!(tip <= 3.0_f64.sqrt() * 2.0 * 10.0 * ROUNDING * arm + slides, "{tip} mm");
    // A turn that changes by less than the step which ends a search is kept; each command is rounded by half a step.
    let rotary = (3..5).map(|axis| POINTING.bound(axis)).sum::<f64>();
    assert!(direction <= LAST_STEP + rotary, "{direction} rad");
    stated(&format!("{:.0} nm at the tip, {:.1} urad in its direction", tip * 1e6, direction * 1e6));
}
