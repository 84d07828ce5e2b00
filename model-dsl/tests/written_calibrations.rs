//! Calibrations written and read again. In: the shipped calibrations, and random ones with every term, every form of
//! table, sensors derived from one another and names that YAML could mistake. Out: the same calibration, bit for bit.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

use std::path::Path;

use abbe_model_dsl::calibration::{
    AxisName, CalibratedTerm, Calibration, Curve, CurveNodes, CurveValues, Factor, LARGEST_ANGLE, Limits,
    MachineNames, MotionName, SensorKind, SeriesInput, Tool, Within, machine_of, read, write,
};
use abbe_model_dsl::diagnostic::{Diagnostics, render};
use abbe_model_dsl::source::{SourceFile, Span, Spanned};
use abbe_model_dsl::{compile, yaml};
use proptest::prelude::*;
use proptest::sample::Index;

/// A mill with a rotary table and a spindle.
fn names() -> MachineNames {
    let axis = |letter: &str, rotary| AxisName { letter: letter.to_owned(), rotary, follows: Vec::new() };
    let motion = |name: &str, angular, axis: Option<&str>| MotionName {
        name: name.to_owned(),
        angular,
        axis: axis.map(str::to_owned),
        own: matches!(name, "EXX" | "EYY" | "ECC"),
        counted: Vec::new(),
    };
    MachineNames {
        machine: "mill".to_owned(),
        constants: vec![("Xt".to_owned(), None), ("Zt".to_owned(), Some(120.0))],
        turning: None,
        axes: vec![axis("X", false), axis("Y", false), axis("C", true)],
        motions: vec![
            motion("EXX", false, Some("X")),
            motion("EBX", true, Some("X")),
            motion("EYY", false, Some("Y")),
            motion("EC0Y", true, Some("Y")),
            motion("ECC", true, Some("C")),
            motion("EZS", false, None),
        ],
        unseen: vec![motion("ECS", true, None)],
    }
}

fn read_back(text: &str, names: &MachineNames) -> Calibration {
    let source = SourceFile::new("written.yaml", text);
    let mut diagnostics = Diagnostics::new();
    let calibration = yaml::read(&source, &mut diagnostics).and_then(|root| {
        machine_of(&root, &mut diagnostics);
        read(&root, names, &mut diagnostics)
    });
    let Some(calibration) = calibration else { panic!("{}\n{text}", render(&source, &diagnostics, false)) };
    calibration
}

/// The codes that a text gives.
fn codes(text: &str, names: &MachineNames) -> Vec<&'static str> {
    let source = SourceFile::new("written.yaml", text);
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(&source, &mut diagnostics).unwrap();
    read(&root, names, &mut diagnostics);
    diagnostics.iter().map(|one| one.code).collect()
}

/// All that a calibration says, with sensors by their names; numbers in the digits that tell their bits.
#[derive(Debug, PartialEq)]
struct Said {
    head: String,
    motions: Vec<(usize, Vec<String>)>,
    sensors: Vec<String>,
}

fn said(calibration: &Calibration) -> Said {
    let name = |sensor: usize| calibration.sensors.iter().nth(sensor).unwrap().name.value.clone();
    let Limits { compensation, rotation, rate, rotation_rate, hold, fade } = calibration.limits;
    let limits =
        [compensation, rotation, rate, rotation_rate, hold, fade].map(|limit| limit.map(|limit| limit.value));
    let tools: Vec<_> = calibration.tools.iter().map(|tool| (&tool.name.value, &tool.constants)).collect();
    let head = format!(
        "{:?} {:?} {:?} {tools:?} {limits:?}",
        calibration.machine.value, calibration.source, calibration.constants
    );
    let term = |term: &CalibratedTerm| {
        let nameless = term.clone().with_sensor(0).with_factors(|factor| factor.with_sensor(0));
        format!("{nameless:?} {:?}", term.sensors().map(name).collect::<Vec<_>>())
    };
    let motions = calibration.motions.iter();
    let motions =
        motions.map(|listed| (listed.motion, listed.terms.iter().map(|one| term(&one.value)).collect()));
    let mut sensors: Vec<String> = calibration
        .sensors
        .iter()
        .filter(|sensor| sensor.used || sensor.kind != SensorKind::Input)
        .map(|sensor| {
            let from = match &sensor.kind {
                SensorKind::Input => String::new(),
                SensorKind::Mean(sources) => {
                    format!("mean {:?}", sources.iter().map(|source| name(*source)).collect::<Vec<_>>())
                }
                SensorKind::Initial(source) => format!("initial {:?}", name(*source)),
            };
            format!("{:?} {from} {}", sensor.name.value, sensor.used)
        })
        .collect();
    sensors.sort();
    Said { head, motions: motions.collect(), sensors }
}

/// Any finite number of any size; a zero has no sign in a file.
fn number() -> impl Strategy<Value = f64> {
    let usual = -1000.0..1000.0_f64;
    let any = prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO;
    prop_oneof![3 => usual, 1 => (-9999..9999_i32).prop_map(|count| f64::from(count) / 1000.0), 1 => any]
        .prop_map(|value| value + 0.0)
}

fn positive() -> impl Strategy<Value = f64> {
    number().prop_map(|value| if value == 0.0 { 1e-9 } else { value.abs() })
}

fn series() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(number(), 1..60)
}

/// Words of all kinds, without the white space at the ends that a file does not keep.
fn text() -> impl Strategy<Value = String> {
    let hard =
        ["null", "~", "- a", "a: b", "a #b", "[x]", "\"", "'", "%", "1e5", "yes", "T, U", "\\n", "\u{feff}a"];
    let any =
        prop::collection::vec(any::<char>(), 1..12).prop_map(|text| text.into_iter().collect::<String>());
    let plain = "[A-Za-z][A-Za-z0-9 _.,µ°-]{0,20}".prop_map(String::from);
    prop_oneof![2 => plain, 1 => any, 1 => prop::sample::select(hard.to_vec()).prop_map(str::to_owned)]
        .prop_map(|text| text.trim().to_owned())
        .prop_filter("no file can hold an empty name", |text| !text.is_empty())
}

/// A curve with one value a node, in each of its forms.
fn curve() -> impl Strategy<Value = Curve> {
    let step = positive().prop_filter("no table has a step next to zero", |step| step.recip().is_finite());
    let uniform = (number(), step, any::<bool>())
        .prop_map(|(start, step, down)| CurveNodes::Uniform { start, step: if down { -step } else { step } });
    let at = series().prop_map(|mut at| {
        at.sort_by(f64::total_cmp);
        at.dedup();
        CurveNodes::At(at)
    });
    let nodes = prop_oneof![uniform, at];
    (nodes, series(), series(), any::<[bool; 2]>()).prop_map(|(nodes, forward, reverse, [both, repeats])| {
        let length = match &nodes {
            CurveNodes::Uniform { .. } => forward.len(),
            CurveNodes::At(at) => at.len(),
        };
        let fit = |values: Vec<f64>| values.into_iter().cycle().take(length).collect::<Vec<f64>>();
        let values = match both {
            true => CurveValues::Both(fit(forward)),
            false => CurveValues::Directed { forward: fit(forward), reverse: fit(reverse) },
        };
        let curve = Curve { nodes, values, repeats };
        // Only what has a length can begin again after it.
        let repeats = curve.period().is_some_and(|period| period > 0.0 && period.is_finite());
        Curve { repeats, ..curve }
    })
}

/// A range in rising order, or none.
fn within() -> impl Strategy<Value = Within> {
    let range = (number(), number()).prop_map(|(a, b)| Within { from: a.min(b), to: a.max(b) });
    prop_oneof![Just(Within::EVERYWHERE), range]
}

/// A factor of any kind, its sensor still by its place in the list of names.
fn factor() -> impl Strategy<Value = Factor> {
    let parts = (0..15_usize, 0..3_usize, 0..5_usize, 1..4_u8, within(), text());
    let nodes = series().prop_map(|mut at| {
        at.sort_by(f64::total_cmp);
        at.dedup();
        at
    });
    (parts, [number().boxed(), number().boxed()], positive(), any::<bool>(), nodes).prop_map(
        |((kind, axis, sensor, power, within, load), [a, b], p, filtered, at)| match kind {
            0 => Factor::Position { axis, power, within },
            1 => Factor::Direction { axis },
            2 => Factor::Velocity { axis, within },
            3 => Factor::Speed { axis, within },
            4 => Factor::Fading { axis, over: p },
            5 => Factor::Acceleration { axis, within },
            6 => {
                let time_constant = if filtered { p } else { 0.0 };
                Factor::Temperature { sensor, reference: a, time_constant, within }
            }
            7 => Factor::Play { sensor, reference: a, width: p },
            8 => Factor::Warmth { axis, time_constant: p, rise: a },
            9 => Factor::Load { load, within },
            10 => Factor::Half { load, at: p },
            11 => Factor::Turn { axis, period: p, phase: a },
            12 => Factor::Spin { load, rate: a, phase: b },
            13 => Factor::Curve { axis, values: at.iter().rev().copied().collect(), at },
            _ => Factor::After { time: a },
        },
    )
}

/// A term with up to three factors.
fn term() -> impl Strategy<Value = (usize, CalibratedTerm)> {
    (plain_term(), prop::collection::vec(factor(), 0..4)).prop_map(|((motion, term), factors)| {
        let rings = matches!(term, CalibratedTerm::Lag { frequency, .. } if frequency > 0.0);
        let takes = term.kind().takes_factors() && !rings;
        (motion, if takes { term.times(factors) } else { term })
    })
}

/// A term under some motion, its sensor still by its place in the list of names.
fn plain_term() -> impl Strategy<Value = (usize, CalibratedTerm)> {
    let numbers = [number().boxed(), number().boxed(), number().boxed()];
    let measures = [positive().boxed(), positive().boxed()];
    (0..16_usize, 0..6_usize, 0..3_usize, 0..5_usize, numbers, measures, series(), curve(), text()).prop_map(
        |(kind, motion, axis, sensor, [a, b, c], [p, q], coefficients, curve, load)| {
            let own = names().motions[motion].axis.as_deref().and_then(|letter| names().axis(letter));
            let other = if own == Some(axis) { (axis + 1) % 3 } else { axis };
            // Half of them stand on the link's own axis, which a file need not name.
            let axis = if a < 0.0 { axis } else { own.unwrap_or(axis) };
            let mut term = match kind {
                0 => CalibratedTerm::Constant { value: a },
                1 if b < 0.0 => CalibratedTerm::Polynomial { input: SeriesInput::Axis(axis), coefficients },
                1 => CalibratedTerm::Polynomial { input: SeriesInput::Sensor(sensor), coefficients },
                2 => CalibratedTerm::Table { axis, curve },
                3 => {
                    CalibratedTerm::Backlash { axis, lost_motion: a, wind_up: if b < 0.0 { 0.0 } else { p } }
                }
                4 => CalibratedTerm::ReversalSpike { axis, height: a, decay: p },
                5 => CalibratedTerm::Cyclic { axis, period: p, amplitude: a, phase: b },
                6 => CalibratedTerm::Lag { axis, gain: p, frequency: if b < 0.0 { 0.0 } else { q } },
                7 => CalibratedTerm::Acceleration { axis, gain: p },
                8 => CalibratedTerm::Expansion { axis, sensor, coefficient: b, reference: c },
                9 => {
                    let time_constant = if a < 0.0 { 0.0 } else { q };
                    CalibratedTerm::Growth { sensor, coefficient: b, reference: c, time_constant }
                }
                10 => CalibratedTerm::Drift { amplitude: a, time_constant: q },
                11 => CalibratedTerm::Vibration { frequency: p, amplitude: a, phase: b },
                12 => CalibratedTerm::Coupling { axis: other, coefficients },
                13 => CalibratedTerm::Delay { axis, time: if b < 0.0 { -p } else { p } },
                14 => CalibratedTerm::Step { time: b, size: a },
                _ => CalibratedTerm::Compliance { load, coefficient: a },
            };
            // Error motions are small, and stay small over 20 mm and 20 degC: a polynomial reaches at most 2 c (20/4)^n.
            let power = term.growth().map(|(_, power, _)| i32::try_from(power).unwrap());
            let most = power.map_or(LARGEST_ANGLE, |power| LARGEST_ANGLE / (2.0 * 5.0_f64.powi(power)));
            if power.is_some() || term.told_size() > most {
                let numbers = term.linear_mut().into_iter().flat_map(|(_, numbers)| numbers);
                // A rest may be a zero below zero.
                numbers.for_each(|number| *number = *number % most + 0.0);
            }
            (motion, term)
        },
    )
}

/// A calibration with derived sensors, listed in any order, and some terms; then more terms, with new sensors.
fn calibration() -> impl Strategy<Value = Calibration> {
    let derived = prop::collection::vec((any::<bool>(), prop::collection::vec(any::<Index>(), 1..4)), 3);
    let order = Just(vec![0_usize, 1, 2]).prop_shuffle();
    let terms = || prop::collection::vec(term(), 0..8);
    let limit = || prop::option::of(positive());
    let limits = [limit(), limit(), limit(), limit(), limit(), limit()];
    // No two tools have one name.
    let tools = prop::collection::btree_map(text(), [number(), number()], 0..3);
    let head = (prop::option::of(text()), limits, [number(), number()], (text(), tools));
    (derived, order, terms(), terms(), head, text()).prop_map(|(derived, order, first, then, head, name)| {
        let (source, limits, constants, (machine, tools)) = head;
        let [compensation, rotation, rate, rotation_rate, hold, fade] =
            limits.map(|limit| limit.map(|limit| Spanned::new(limit, Span::default())));
        let mut calibration = read_back(&sensors_alone(&derived, &order), &names());
        calibration.machine.value = machine;
        calibration.source = source;
        calibration.constants = constants.to_vec();
        let tool = |(name, constants): (String, [f64; 2])| Tool {
            name: Spanned::new(name, Span::default()),
            constants: constants.to_vec(),
        };
        calibration.tools = tools.into_iter().map(tool).collect();
        calibration.limits = Limits { compensation, rotation, rate, rotation_rate, hold, fade };
        let known = ["spindle", "d0", "d1", "d2", name.as_str()];
        let calibration = extended(calibration, first, &known);
        extended(calibration, then, &known)
    })
}

/// A file with three derived sensors, each of channels or of those before it, listed in the order given.
fn sensors_alone(derived: &[(bool, Vec<Index>)], order: &[usize]) -> String {
    let all = ["T1", "T2", "spindle", "d0", "d1", "d2"];
    let one = |number: &usize| {
        let (mean, sources) = &derived[*number];
        let sources: Vec<&str> = sources.iter().map(|source| all[source.index(3 + number)]).collect();
        match mean {
            true => format!("d{number}: {{mean: [{}]}}", sources.join(", ")),
            false => format!("d{number}: {{initial: {}}}", sources[0]),
        }
    };
    let sensors: Vec<String> = order.iter().map(one).collect();
    format!("calibration: 1\nmachine: mill\nconstants: {{Xt: 0 mm}}\nsensors: {{{}}}\n", sensors.join(", "))
}

fn extended(
    mut calibration: Calibration,
    terms: Vec<(usize, CalibratedTerm)>,
    known: &[&str],
) -> Calibration {
    let terms: Vec<_> = terms
        .into_iter()
        .map(|(motion, mut term)| {
            if let Some(sensor) = term.sensor() {
                term = term.with_sensor(calibration.sensor(known[sensor]));
            }
            let term = term.with_factors(|factor| match factor.sensor() {
                Some(sensor) => factor.with_sensor(calibration.sensor(known[sensor])),
                None => factor,
            });
            (motion, term)
        })
        .collect();
    calibration.with(&terms)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_written_is_read(calibration in calibration()) {
        let names = names();
        let text = write(&calibration, &names);
        let again = read_back(&text, &names);
        prop_assert_eq!(said(&again), said(&calibration), "{}", text);
        // What was read is numbered as its text goes, and comes back with its numbers.
        let twice = write(&again, &names);
        prop_assert_eq!(&twice, &text);
        prop_assert_eq!(read_back(&twice, &names), again);
    }
}

/// The machine's own names, from its file.
fn names_of(machine: &str) -> MachineNames {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines").join(format!("{machine}.yaml"));
    let source = SourceFile::new("machine.yaml", std::fs::read_to_string(path).unwrap());
    compile(&source, &mut Diagnostics::new()).unwrap().equations.names()
}

#[test]
fn the_shipped_calibrations_come_back_equal() {
    for name in ["postech-mill", "nist-turning-center", "excello-921"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../calibrations").join(format!("{name}.yaml"));
        let names = names_of(name);
        let calibration = read_back(&std::fs::read_to_string(path).unwrap(), &names);
        assert_eq!(read_back(&write(&calibration, &names), &names), calibration, "{name}");
    }
}

/// A file of short terms in the units of the inside is written as a person would, so it is its own copy.
#[test]
fn a_file_is_laid_out_as_people_write_it() {
    let text = "\
calibration: 1
machine: machines/mill.yaml
source: table 1, second column
constants: {Xt: 0 mm, Zt: 120.5 mm}
limits: {compensation: 0.2 mm, rate: 2 mm/s, hold: 10 s, fade: 0.5 s}
sensors:
  body: {mean: [T10, T21]}
  start: {initial: body}
errors:
  EXX:
    - table: {axis: X, start: 0 mm, step: -55 mm, unit: mm, values: [-0.0005, 0.005, 0.0115]}
    - backlash: {lost_motion: 0.01 mm}
    - backlash: {lost_motion: 0.002 mm, wind_up: 0.5 mm, axis: Y}
    - expansion: {sensor: body, coefficient: 1.15e-5 1/K, reference: 20 degC}
    - backlash: {lost_motion: 0.002 mm, wind_up: 0.5 mm, axis: Y, ramp: 0.05 s}
    - lag: {gain: 16.28 1/s}
    - lag: {gain: 2 rad/mm/s, axis: C}
  EBX:
    - polynomial: {axis: X, per: mm, unit: rad, coefficients: [-1.0e-6, 2.5e-7]}
    - polynomial: {sensor: start, unit: rad, coefficients: [0, -1.0e-6]}
    - acceleration: {gain: 400 mm/rad/s^2}
  EC0Y: 0.000272 rad
  ECC:
    - table: {axis: C, at: [0, 1, 3], per: rad, unit: rad, forward: [0, 0.1, 0], reverse: [0, 0.2, 0]}
    - coupling: {axis: X, per: mm, unit: rad, coefficients: [1.0e-9]}
  EZS:
    - growth: {sensor: T27, coefficient: 0.001 mm/K, reference: 20 degC, time_constant: 600 s}
    - compliance: {load: spindle torque, coefficient: 2.0e-5 mm/N}
    - vibration: {frequency: 50 Hz, amplitude: 0.001 mm, phase: 0 rad}
    - constant: {value: 0 mm}
    - step: {time: 1200 s, size: 0.008 mm}
    - product: {value: 5.8e-8 1/mm, times: [{position: X}, {position: Y, within: [0 mm, 300 mm]}]}
    - product: {value: 1.1e-5 1/K, times: [{warmth: Y, time_constant: 480 s, rise: 0.02 s*K/mm}, {position: Y}]}
    - backlash: {lost_motion: 2.0e-5 mm/N, axis: X, times: [{load: feed}]}
    - backlash: {lost_motion: 0.0076 mm, axis: X, times: [{fading: X, over: 18 mm/s}]}
    - cyclic: {period: 10 mm, amplitude: 6.4e-6 mm/mm, phase: 0.6 rad, axis: X, times: [{position: X}]}
    - table: {axis: X, start: 0 mm, step: 10 mm, unit: mm/K, values: [0, 1, 2], times: [{temperature: body, reference: 20 degC}]}
    - lag: {gain: 16 1/s, axis: X, times: [{direction: X}]}
    - delay: {time: 0.003 s, axis: X}
";
    assert_eq!(write(&read_back(text, &names()), &names()), text);
}

#[test]
fn long_tables_are_broken_into_lines_that_can_be_read() {
    let values: Vec<f64> = (0..500).map(|step| f64::from(step) / 700.0).collect();
    let nodes = CurveNodes::Uniform { start: 0.0, step: 1.0 };
    let curve = Curve::new(nodes, CurveValues::Both(values));
    let calibration =
        Calibration::new("mill", vec![0.0, 0.0]).with(&[(0, CalibratedTerm::Table { axis: 0, curve })]);
    let text = write(&calibration, &names());
    assert!(text.lines().all(|line| line.chars().count() <= 130), "{text}");
    assert_eq!(read_back(&text, &names()), calibration);
}

/// What has no lever at the tool tip is warned of, kept and written back.
#[test]
fn what_has_no_effect_is_not_lost() {
    let text = "calibration: 1\nmachine: mill\nconstants: {Xt: 0 mm}\nerrors:\n  EXX: 0.003 mm\n  ECS:\n    - growth: {sensor: spindle, coefficient: 1.0e-6 rad/K, reference: 20 degC}\n    - constant: {value: 1.0e-5 rad}\n";
    let mut diagnostics = Diagnostics::new();
    let source = SourceFile::new("written.yaml", text);
    let root = yaml::read(&source, &mut diagnostics).unwrap();
    let calibration = read(&root, &names(), &mut diagnostics).unwrap();
    let told: Vec<_> = diagnostics.iter().map(|one| (one.code, source.slice(one.span).to_owned())).collect();
    assert_eq!(told, [("W0402", "ECS".to_owned())]);
    assert_eq!((calibration.motions.len(), calibration.unseen[0].terms.len()), (1, 2));
    assert_eq!(
        write(&calibration, &names()),
        text.replace("constants: {Xt: 0 mm}", "constants: {Xt: 0 mm, Zt: 120 mm}")
    );
}

#[test]
fn new_terms_stand_behind_those_that_were_there() {
    let text = "calibration: 1\nmachine: mill\nconstants: {Xt: 0 mm}\nsensors: {mean_T: {mean: [T1, T2]}}\nerrors:\n  EBX: 1 urad\n";
    let mut calibration = read_back(text, &names());
    let [spindle, mean, first] = ["spindle", "mean_T", "T1"].map(|name| calibration.sensor(name));
    assert_eq!([mean, first], ["mean_T", "T1"].map(|name| calibration.sensors.index(name).unwrap()));
    let growth =
        |sensor| CalibratedTerm::Growth { sensor, coefficient: 0.001, reference: 20.0, time_constant: 0.0 };
    let backlash = CalibratedTerm::Backlash { axis: 0, lost_motion: 1e-5, wind_up: 0.0 };
    let before = calibration.clone();
    let after = calibration.with(&[(0, growth(spindle)), (1, backlash.clone()), (0, growth(mean))]);
    assert_eq!(calibration, before);
    let listed = |motion| after.terms(motion).iter().map(|term| term.value.clone()).collect::<Vec<_>>();
    assert_eq!(listed(0), [growth(spindle), growth(mean)]);
    assert_eq!(listed(1), [CalibratedTerm::Constant { value: 1.0 * 1e-6 }, backlash]);
    let inputs: Vec<&str> = after.sensors.inputs().map(|(_, sensor)| sensor.name.value.as_str()).collect();
    assert_eq!(inputs, ["T1", "T2", "spindle"]);
    assert_eq!(before.sensors.inputs().count(), 0);
}

#[test]
fn a_calibration_without_terms_is_a_file_too() {
    let empty = Calibration::new("mill", vec![1.0, 2.0]);
    let text = write(&empty, &names());
    assert_eq!(text, "calibration: 1\nmachine: mill\nconstants: {Xt: 1 mm, Zt: 2 mm}\n");
    assert_eq!(read_back(&text, &names()), empty);
}

#[test]
fn what_the_machine_lacks_is_refused_when_it_is_read() {
    let written = |motion, term: CalibratedTerm| {
        let calibration = Calibration::new("mill", vec![0.0, 0.0]).with(&[(motion, term)]);
        codes(&write(&calibration, &names()), &names())
    };
    let lag = |axis, gain| CalibratedTerm::Lag { axis, gain, frequency: 0.0 };
    let growth =
        |reference| CalibratedTerm::Growth { sensor: 7, coefficient: 1.0, reference, time_constant: 0.0 };
    assert_eq!(written(0, lag(0, 1.0)), [""; 0]);
    assert_eq!(written(99, lag(0, 1.0)), ["E0407"]);
    assert_eq!(written(0, lag(99, 1.0)), ["E0414"]);
    // A drive that leads is written too, a gain of zero is none.
    assert_eq!(written(0, lag(0, -1.0)), [""; 0]);
    assert_eq!(written(0, lag(0, 0.0)), ["E0419"]);
    assert_eq!(written(0, lag(0, f64::NAN)), ["E0302"]);
    assert_eq!(written(0, lag(0, f64::INFINITY)), ["E0302"]);
    assert_eq!(written(5, growth(20.0)), ["E0404"]);
}
