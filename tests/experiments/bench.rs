//! What the experiments share: machines from files, a controller that compensates them, and the program on their files.
//!
//! In: files of `docs/cases/`. Out: where the tool went, and what a diagnosis says.

use std::fs;
use std::path::PathBuf;

use abbe_runtime::{
    Compensator, Direction, DirectionTracker, ErrorMotion, Kinematics, Outcome, Sample, Term, TermState,
    Work, states_needed,
};
use model_dsl::Compiled;
use model_dsl::calibration::{self, Calibration, MachineNames};
use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::program::Interpreter;
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use serde_json::Value;
use simulation::{Commands, Instrument, Measurement, Plant};

use crate::cli::{Run, abbe};
use crate::shipped::root;

/// An inch in mm.
pub(crate) const INCH: f64 = 25.4;

/// A machine, and calibrations against its names.
pub(crate) struct Bench {
    pub(crate) compiled: Compiled,
    pub(crate) names: MachineNames,
}

impl Bench {
    /// The machine of a file, by its path from the root of the repository.
    pub(crate) fn of(path: &str) -> Self {
        let source = SourceFile::new(path, fs::read_to_string(root().join(path)).unwrap());
        let mut findings = Diagnostics::new();
        let compiled = model_dsl::compile(&source, &mut findings);
        let Some(compiled) = compiled else { panic!("{}", render(&source, &findings, false)) };
        let names = compiled.equations.names();
        Self { compiled, names }
    }

    /// A calibration from its text.
    pub(crate) fn calibration(&self, text: &str) -> Calibration {
        let source = SourceFile::new("calibration.yaml", text);
        let mut findings = Diagnostics::new();
        let tree = yaml::read(&source, &mut findings).unwrap();
        let read = calibration::read(&tree, &self.names, &mut findings);
        let Some(read) = read else { panic!("{}", render(&source, &findings, false)) };
        read
    }

    /// A calibration from its file.
    pub(crate) fn calibration_of(&self, path: &str) -> Calibration {
        self.calibration(&fs::read_to_string(root().join(path)).unwrap())
    }

    pub(crate) fn plant(&self, truth: &Calibration) -> Plant {
        Plant::new(&self.compiled.machine, &self.names, truth).unwrap()
    }

    /// What a controller with this calibration sends in place of the commands, sample by sample, with what it said of each.
    pub(crate) fn compensated(&self, known: &Calibration, commands: &Commands) -> (Commands, Vec<Outcome>) {
        let machine = Interpreter::new(&self.compiled.equations, &known.constants);
        self.compensated_by(&machine, known, commands)
    }

    /// The same by any form of the machine's equations.
    pub(crate) fn compensated_by<K: Kinematics>(
        &self,
        machine: &K,
        known: &Calibration,
        commands: &Commands,
    ) -> (Commands, Vec<Outcome>) {
        let motions = self.compiled.equations.motions.len();
        let terms: Vec<Vec<Term<'_>>> =
            (0..motions).map(|motion| known.runtime(motion).flat_map(Result::unwrap).collect()).collect();
        let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
        let axes = commands.positions.len();
        let mut states = vec![TermState::default(); states_needed(&motions)];
        let (mut directions, mut values) = (vec![[0.0; 3]; axes], vec![0.0; motions.len()]);
        let mut travel = vec![0.0; self.compiled.equations.travels.len()];
        let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
        let mut compensator = Compensator::new(machine, &motions, &mut states, work).unwrap();
        let mut trackers = vec![DirectionTracker::new(0.0); axes];
        let mut sent = Commands { positions: vec![Vec::new(); axes], ..commands.clone() };
        let mut outcomes = Vec::new();
        let mut before = None;
        for (row, &time) in commands.time.iter().enumerate() {
            let position: Vec<f64> = commands.positions.iter().map(|column| column[row]).collect();
            let direction: Vec<Direction> = trackers
                .iter_mut()
                .zip(&position)
                .map(|(tracker, &position)| tracker.update(position))
                .collect();
            let time_step = time - before.replace(time).unwrap_or(time);
            let sample = Sample {
                position: &position,
                travel: &[],
                direction: &direction,
                velocity: &[],
                temperature: &[],
                time_step,
            };
            let mut command = vec![0.0; axes];
            outcomes.push(compensator.compensate(&sample, &mut command).unwrap());
            sent.positions.iter_mut().zip(command).for_each(|(column, position)| column.push(position));
        }
        (sent, outcomes)
    }
}

/// Commands of one run at equal steps of time until an end; `at` gives the position of every axis.
pub(crate) fn commands(axes: usize, step: f64, end: f64, at: impl Fn(f64) -> Vec<f64>) -> Commands {
    let rows = (0..u32::MAX).map(|row| f64::from(row) * step);
    let time: Vec<f64> = rows.take_while(|time| *time <= end).collect();
    let places: Vec<Vec<f64>> = time.iter().map(|time| at(*time)).collect();
    let column = |axis: usize| places.iter().map(|place| place[axis]).collect();
    Commands {
        run: vec![1; time.len()],
        positions: (0..axes).map(column).collect(),
        time,
        ..Commands::default()
    }
}

/// Where the tool goes, without noise: X, Y, Z of every sample.
pub(crate) fn driven(plant: &Plant, commands: &Commands) -> Vec<[f64; 3]> {
    let instrument = Instrument::Position { directions: [true; 3], angles: Vec::new() };
    let simulated = simulation::replay(plant, commands, &Measurement::perfect(instrument)).unwrap();
    let value = |direction: usize, row: usize| simulated.readings[direction].values[row];
    (0..commands.time.len()).map(|row| std::array::from_fn(|direction| value(direction, row))).collect()
}

/// A folder of an experiment's own, empty.
pub(crate) fn folder(experiment: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("experiments").join(experiment);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Runs the program, which must end well.
pub(crate) fn done(arguments: &[&str]) -> Run {
    let run = abbe(arguments, "");
    assert_eq!(run.status, 0, "{arguments:?}: {}", run.err);
    run
}

/// Simulates a path file of a case and gives the recording's path.
pub(crate) fn recorded(case: &str, truth: &str, path: &str, known: &str, name: &str) -> String {
    let file = |name: &str| format!("docs/cases/{case}/{name}");
    let output = folder(name).to_str().unwrap().to_owned();
    done(&["simulate", &file(truth), &file(path), "--known", &file(known), "--output", &output]);
    format!("{output}/recording.yaml")
}

/// The diagnosis of recordings.
pub(crate) fn diagnosed(recordings: &[&str]) -> Value {
    let run = done(&[&["diagnose", "--format", "json", "--quiet"], recordings].concat());
    serde_json::from_str(&run.out).unwrap()
}

/// The findings by their names: `EXX backlash`.
pub(crate) fn found(diagnosis: &Value) -> Vec<String> {
    let name = |finding: &Value| {
        format!("{} {}", finding["motion"].as_str().unwrap(), finding["term"].as_str().unwrap())
    };
    diagnosis["findings"].as_array().unwrap().iter().map(name).collect()
}

/// A number with its interval, of a parameter of a finding.
pub(crate) fn parameter(diagnosis: &Value, finding: &str, name: &str) -> (f64, [f64; 2]) {
    let place = found(diagnosis).iter().position(|own| own == finding);
    let Some(place) = place else { panic!("no {finding} in {diagnosis:#}") };
    let number = &diagnosis["findings"][place]["parameters"][name];
    let bound = |number: &Value| number.as_f64().unwrap();
    (bound(&number["value"]), [bound(&number["ci95"][0]), bound(&number["ci95"][1])])
}

/// How far a number is from the truth, in half widths of its interval.
pub(crate) fn off((value, [low, high]): (f64, [f64; 2]), truth: f64) -> f64 {
    let side = if truth > value { high - value } else { value - low };
    (truth - value).abs() / side
}
