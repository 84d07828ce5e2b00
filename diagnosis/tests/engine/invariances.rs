//! What changes nothing of the machine changes nothing of the diagnosis. In: random small recordings with one or two effects of clear
//! size, and the same in another form: every second row, other units, other origins, runs in another order, a constant more, columns
//! more. Out: the same findings, with numbers that agree within their intervals.

use std::fs;
use std::path::Path as FilePath;

use abbe_diagnosis::diagnosis::{Diagnosis, Estimate, Finding, ParameterValue};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use simulation::noise::Source;
use simulation::{Path, Scenario};

use crate::common::*;
use crate::recording::{Named, Recording, read_header};
use crate::testing::*;

/// So many random recordings of each invariance.
const CASES: u64 = 10;

/// Standard deviation of the noise, mm: a fifth of the smallest effect.
const SIGMA: f64 = 0.001;

/// A recording of a machine with effects that nothing is known of.
struct Case {
    bench: Bench,
    recording: Recording,
    concealed: String,
}

/// Random numbers for a case.
struct Random(Source);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    /// These in a random order.
    fn shuffled<T>(&mut self, of: Vec<T>) -> Vec<T> {
        let mut all: Vec<(f64, T)> = of.into_iter().map(|one| (self.0.uniform(), one)).collect();
        all.sort_by(|one, other| one.0.total_cmp(&other.0));
        all.into_iter().map(|(_, one)| one).collect()
    }

    /// One or two of these.
    fn some(&mut self, of: Vec<String>) -> Vec<String> {
        let count = 1 + usize::from(self.0.uniform() < 0.5);
        self.shuffled(of).into_iter().take(count).collect()
    }
}

/// A case of an even seed is a stage that goes there and back, one of an odd seed a mill that goes round.
fn case(seed: u64) -> Case {
    let mut random = Random(Source::new(seed, "invariances"));
    if seed.is_multiple_of(2) { stage(&mut random, seed) } else { mill(&mut random, seed) }
}

fn stage(random: &mut Random, seed: u64) -> Case {
    // Periods of which 60 mm is a multiple: see the origin of the position.
    let period = random.shuffled(vec![10, 12, 15, 20])[0];
    let terms = vec![
        format!("{{backlash: {{lost_motion: {} um}}}}", random.between(5.0, 12.0)),
        format!(
            "{{cyclic: {{period: {period} mm, amplitude: {} um, phase: {} rad}}}}",
            random.between(5.0, 8.0),
            random.between(-1.5, 1.5)
        ),
        format!(
            "{{polynomial: {{axis: X, per: mm, unit: um, coefficients: [0, {}]}}}}",
            random.between(0.04, 0.1)
        ),
        format!(
            "{{expansion: {{sensor: scale, coefficient: {}e-6 1/K, reference: 20 degC}}}}",
            random.between(4.0, 8.0)
        ),
    ];
    let terms = random.some(terms);
    let from = random.between(0.0, 40.0);
    let shape = line(0, from, from + random.between(200.0, 260.0));
    // At one constant speed a late drive would be the same as a play.
    let acceleration = Some(random.between(15.0, 30.0));
    let lines = Path { runs: 4, pause: 40.0, acceleration, ..path(shape, random.between(18.0, 25.0), 12.0) };
    let mut scenario = noisy(lines, position("x"), SIGMA, seed);
    if terms.iter().any(|term| term.contains("scale")) {
        scenario.temperatures = vec![warming("scale", 10.0, 150.0)];
    }
    recorded("FX", format!("{{EXX: [{}]}}", terms.join(", ")), &scenario)
}

fn mill(random: &mut Random, seed: u64) -> Case {
    let feed = random.between(50.0, 70.0);
    let motions = vec![
        format!("EC0Y: {} urad", random.between(60.0, 120.0)),
        format!("EYY: [{{backlash: {{lost_motion: {} um}}}}]", random.between(5.0, 12.0)),
        // Behind by 5 to 12 um.
        format!("EXX: [{{lag: {{gain: {} 1/s}}}}]", feed / random.between(0.005, 0.012)),
    ];
    let motions = random.some(motions);
    let round = Path {
        at: vec![vec![250.0], vec![140.0], vec![-50.0]],
        runs: 4,
        acceleration: Some(300.0),
        ..path(circle(random.between(60.0, 90.0)), feed, 20.0)
    };
    recorded("xyfz-mill", format!("{{{}}}", motions.join(", ")), &noisy(round, position("xy"), SIGMA, seed))
}

fn recorded(machine: &str, concealed: String, scenario: &Scenario) -> Case {
    let bench = Bench::of(machine);
    let recording = bench.record(&bench.calibration(&concealed), scenario);
    Case { bench, recording, concealed }
}

/// A number by which both say the same: two fits to the same samples.
fn each_within_the_other(one: &Estimate, other: &Estimate) -> bool {
    let holds = |of: &Estimate, value: f64| of.ci95.0 <= value && value <= of.ci95.1;
    holds(one, other.value) && holds(other, one.value)
}

/// The same of fits to other samples of one machine.
fn overlapping(one: &Estimate, other: &Estimate) -> bool {
    one.ci95.0 <= other.ci95.1 && other.ci95.0 <= one.ci95.1
}

type Agree = fn(&Estimate, &Estimate) -> bool;

/// Diagnoses every case as it is and as it is changed, and holds both against each other.
fn same(cases: impl Iterator<Item = u64>, change: impl Fn(u64, &Case) -> Recording, agree: Agree) {
    let (mut wrong, mut seen) = (Vec::new(), 0);
    for seed in cases {
        let case = case(seed);
        let known = case.bench.calibration("{}");
        let original = diagnosed(&case.bench, &known, &[&case.recording]);
        let changed = diagnosed(&case.bench, &known, &[&change(seed, &case)]);
        seen += original.findings.len();
        wrong.extend(
            apart(&original, &changed, agree).map(|what| format!("seed {seed}, {}: {what}", case.concealed)),
        );
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(seen > 0, "nothing was found in any case");
}

/// In what two diagnoses differ.
fn apart(one: &Diagnosis, other: &Diagnosis, agree: Agree) -> Option<String> {
    let [ones, others] = [one, other].map(sorted);
    let [names, other_names] =
        [&ones, &others].map(|findings| findings.iter().map(|one| named(one)).collect::<Vec<_>>());
    if names != other_names || one.verdict != other.verdict {
        return Some(format!("{:?} {names:?}, then {:?} {other_names:?}", one.verdict, other.verdict));
    }
    ones.iter().zip(&others).find_map(|(one, other)| parameters_apart(one, other, agree))
}

fn sorted(diagnosis: &Diagnosis) -> Vec<&Finding> {
    let mut findings: Vec<&Finding> = diagnosis.findings.iter().collect();
    findings.sort_by_key(|finding| named(finding));
    findings
}

/// Motion, term, and what it reads.
fn named(finding: &Finding) -> String {
    let words = finding.parameters.iter().filter_map(|parameter| match &parameter.value {
        ParameterValue::Name(name) => Some(name.as_str()),
        _ => None,
    });
    format!("{} {} {}", finding.motion, finding.term, words.collect::<Vec<_>>().join(" "))
}

fn parameters_apart(one: &Finding, other: &Finding, agree: Agree) -> Option<String> {
    let parameters = one.parameters.iter().zip(&other.parameters);
    let mut unlike = parameters.filter(|(one, other)| {
        one.name != other.name || {
            let (ones, others) = (fitted(&one.value), fitted(&other.value));
            ones.len() != others.len() || !ones.iter().zip(others).all(|(one, other)| agree(one, other))
        }
    });
    let first = unlike.next().map(|(parameter, other)| format!("{parameter:?}, then {other:?}"));
    first.map(|first| format!("{}: {first}", named(one)))
}

fn fitted(value: &ParameterValue) -> &[Estimate] {
    match value {
        ParameterValue::Fitted(estimate) => std::slice::from_ref(estimate),
        ParameterValue::List(list) => list,
        _ => &[],
    }
}

#[test]
fn every_second_row_shows_the_same() {
    let half = |_, case: &Case| {
        let rows: Vec<usize> = (0..case.recording.time.len()).step_by(2).collect();
        of_rows(&case.recording, &rows)
    };
    same(0..CASES, half, overlapping);
}

#[test]
fn runs_in_another_order_show_the_same() {
    let order = |_, case: &Case| {
        let runs = case.recording.runs();
        // The second, the fourth, the first, the third: each begins where the one that stood there began.
        let order = [1, 3, 0, 2].map(|number: usize| runs[number].0.clone());
        let mut changed = of_rows(&case.recording, &order.clone().into_iter().flatten().collect::<Vec<_>>());
        let mut row = 0;
        for ((slot, number), from) in runs.iter().zip(order) {
            let later = case.recording.time[slot.start] - case.recording.time[from.start];
            for _ in from {
                changed.time[row] += later;
                changed.run[row] = *number;
                row += 1;
            }
        }
        assert!(changed.time.is_sorted_by(|one, next| one < next), "runs are of one length");
        changed
    };
    same(0..CASES, order, overlapping);
}

#[test]
fn a_constant_more_shows_the_same() {
    let constant = |_, case: &Case| {
        let mut changed = case.recording.clone();
        for (column, constant) in changed.measured.iter_mut().flatten().zip([0.37, -0.052]) {
            column.iter_mut().for_each(|value| *value += constant);
        }
        changed
    };
    same(0..CASES, constant, each_within_the_other);
}

/// What grows from the origin knows where it is; all else does not.
#[test]
fn another_origin_of_position_shows_the_same() {
    let moved = |_, case: &Case| {
        let mut changed = case.recording.clone();
        // A multiple of every period: a wave keeps its phase.
        for value in changed.axes.iter_mut().filter_map(|axis| axis.command.as_mut()).flatten() {
            *value += 60.0;
        }
        for value in changed.measured.iter_mut().flatten().flatten() {
            *value += 60.0;
        }
        changed
    };
    let anywhere = (0..2 * CASES).filter(|seed| !case(*seed).concealed.contains("expansion"));
    same(anywhere.take(usize::try_from(CASES).unwrap()), moved, each_within_the_other);
}

#[test]
fn columns_more_show_the_same() {
    let more = |seed, case: &Case| {
        let mut changed = case.recording.clone();
        let rows = changed.time.len();
        let column = |name: &str, unit: &str, seed, level: f64, size: f64| Named {
            name: name.to_owned(),
            unit: unit.to_owned(),
            values: normals(seed, rows).iter().map(|normal| level + size * normal).collect(),
        };
        changed.temperatures.push(column("cabinet", "degC", 100 + seed, 24.0, 0.3));
        changed.loads.push(column("fan", "A", 200 + seed, 1.5, 0.1));
        changed
    };
    same(0..CASES, more, each_within_the_other);
}

/// An instrument that also reads directions in which nothing is to be seen finds what it finds without them, also of an effect that is
/// smaller than the noise. Their noise walks about as far as it scatters: a zero that is fitted a little differently gains or loses as much
/// there as the effect does where it shows.
#[test]
fn directions_that_wander_change_nothing() {
    let wandering = |seed: u64, rows: usize| -> Vec<f64> {
        let mut walked = 0.0;
        let steps = normals(seed, rows).into_iter();
        let walk = steps.map(|step| {
            walked += 0.03 * SIGMA * step;
            walked
        });
        let white = normals(seed + 50, rows);
        walk.zip(white).map(|(walk, white)| walk + SIGMA * white).collect()
    };
    let mut found = 0;
    for seed in 0..CASES {
        let mut random = Random(Source::new(seed, "directions"));
        let wave = format!(
            "{{EXX: [{{cyclic: {{period: {} mm, amplitude: {} mm, phase: {} rad}}}}]}}",
            random.between(10.0, 20.0),
            random.between(0.3, 0.5) * SIGMA,
            random.between(-1.5, 1.5)
        );
        let lines = Path { runs: 6, ..path(line(0, 0.0, random.between(200.0, 260.0)), 20.0, 12.0) };
        let Case { bench, recording, concealed } =
            recorded("FX", wave, &noisy(lines, position("x"), SIGMA, seed));
        let mut more = recording.clone();
        more.measured[1] = Some(wandering(300 + seed, more.time.len()));
        more.measured[2] = Some(wandering(400 + seed, more.time.len()));
        let known = bench.calibration("{}");
        let [alone, beside] = [&recording, &more].map(|one| diagnosed(&bench, &known, &[one]));
        let waves =
            |diagnosis: &Diagnosis| -> Vec<String> { sorted(diagnosis).into_iter().map(named).collect() };
        assert_eq!(waves(&alone), waves(&beside), "seed {seed}, {concealed}");
        found += alone.findings.len();
    }
    assert!(found > 0, "nothing was found in any case");
}

/// The recording as it is read from a file with these units of lengths, time and temperature; its clock begins at `origin`, s.
fn read_from(name: &str, case: &Case, units: &[Unit; 3], origin: f64) -> Recording {
    let [length, time, temperature] = units;
    let recording = &case.recording;
    let mut columns = vec![("time".to_owned(), time, recording.time.iter().map(|t| t + origin).collect())];
    for (axis, channels) in case.bench.equations().axes.iter().zip(&recording.axes) {
        let command = channels.command.clone().unwrap();
        columns.push((format!("command.{}", axis.letter.to_lowercase()), length, command));
    }
    for (direction, column) in ["x", "y", "z"].iter().zip(&recording.measured) {
        columns.extend(column.iter().map(|column| (format!("measured.{direction}"), length, column.clone())));
    }
    let sensors = recording.temperatures.iter();
    columns.extend(sensors.map(|one| (format!("temperature.{}", one.name), temperature, one.values.clone())));
    let mut header = format!(
        "recording: 1\nmachine: {}\ninstrument: position\ndata: data.csv\nholdout: {{runs: [4]}}\nchannels:\n  run: {{column: run}}\n",
        case.bench.equations().machine
    );
    let mut table = "run".to_owned();
    for (name, unit, _) in &columns {
        header += &format!("  {name}: {{column: {name}, unit: {}}}\n", unit.name);
        table += &format!(",{name}");
    }
    for (row, run) in recording.run.iter().enumerate() {
        table += &format!("\n{run}");
        table.extend(columns.iter().map(|(_, unit, values)| format!(",{}", unit.of(values[row]))));
    }
    let folder = FilePath::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).unwrap();
    let data = folder.join("data.csv");
    fs::write(&data, table + "\n").unwrap();
    let mut findings = Diagnostics::new();
    let root = yaml::read(&SourceFile::new("recording.yaml", header), &mut findings).unwrap();
    let read = read_header(&root, case.bench.equations(), &mut findings);
    let Some(read) = read else { panic!("{findings:?}") };
    read.read_data(&data).unwrap_or_else(|error| panic!("{error}"))
}

/// A unit, by its name and by what a number of ours is in it.
struct Unit {
    name: &'static str,
    factor: f64,
    zero: f64,
}

impl Unit {
    const fn new(name: &'static str, factor: f64, zero: f64) -> Self {
        Self { name, factor, zero }
    }

    fn of(&self, value: f64) -> f64 {
        self.factor * value + self.zero
    }
}

const OURS: [Unit; 3] = [Unit::new("mm", 1.0, 0.0), Unit::new("s", 1.0, 0.0), Unit::new("degC", 1.0, 0.0)];

#[test]
fn other_units_show_the_same() {
    let others = [
        [Unit::new("um", 1e3, 0.0), Unit::new("ms", 1e3, 0.0), Unit::new("K", 1.0, 273.15)],
        [Unit::new("in", 1.0 / 25.4, 0.0), Unit::new("min", 1.0 / 60.0, 0.0), Unit::new("degF", 1.8, 32.0)],
    ];
    let read = |seed: u64, case: &Case| {
        let units = &others[usize::from(seed % 4 > 1)];
        read_from(&format!("units-{seed}"), case, units, 0.0)
    };
    same(0..CASES, read, each_within_the_other);
}

#[test]
fn another_origin_of_time_shows_the_same() {
    // Seconds since 1970.
    let read = |seed: u64, case: &Case| read_from(&format!("clock-{seed}"), case, &OURS, 1.7e9);
    same(0..CASES, read, each_within_the_other);
}
