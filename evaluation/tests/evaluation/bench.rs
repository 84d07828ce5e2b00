//! Machines that are driven and read. In: a topology, its true errors, a program. Out: recordings.

use abbe_evaluation::{Evaluation, Figure, Inputs, evaluate};
use model_dsl::calibration::{self, Calibration};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::{Compiled, compile_word, yaml};
use recording::{AxisChannels, Instrument, Recording};
use simulation::noise::Source;
use simulation::{Commands, Plant};

pub(crate) struct Bench {
    pub(crate) compiled: Compiled,
    pub(crate) truth: Calibration,
}

/// A program: the time of every row, its run, and the position of every axis.
#[derive(Default)]
pub(crate) struct Program {
    pub(crate) time: Vec<f64>,
    pub(crate) run: Vec<i64>,
    pub(crate) positions: Vec<Vec<f64>>,
}

impl Program {
    pub(crate) fn row(&mut self, step: f64, run: i64, position: &[f64]) {
        self.positions.resize(position.len(), Vec::new());
        self.time.push(self.time.last().map_or(0.0, |last| last + step));
        self.run.push(run);
        self.positions.iter_mut().zip(position).for_each(|(column, at)| column.push(*at));
    }

    /// Stations from below, from above, with an overrun at both ends; one row every 4 s.
    pub(crate) fn stations(
        targets: &[f64],
        overrun: f64,
        runs: i64,
        place: impl Fn(f64) -> Vec<f64>,
    ) -> Self {
        let mut program = Self::default();
        let (first, last) = (targets.first().unwrap() - overrun, targets.last().unwrap() + overrun);
        for run in 1..=runs {
            let up = [first].into_iter().chain(targets.iter().copied());
            let down = [last].into_iter().chain(targets.iter().rev().copied()).chain([first]);
            up.chain(down).for_each(|at| program.row(4.0, run, &place(at)));
        }
        program
    }

    /// Circles in the plane of two axes of three, counterclockwise and clockwise, with an overshoot of 20 degrees.
    pub(crate) fn circles(radius: f64, feed: f64, rate: f64, senses: &[f64], runs: i64) -> Self {
        let mut program = Self::default();
        let step = feed / radius / rate;
        let rows = ((2.0 * std::f64::consts::PI + 0.7) / step).ceil();
        for run in 1..=runs {
            for sense in senses {
                let mut number = 0.0;
                while number <= rows {
                    let angle = sense * (number * step - 0.35);
                    program.row(1.0 / rate, run, &[radius * angle.cos(), radius * angle.sin(), 0.0]);
                    number += 1.0;
                }
            }
        }
        program
    }
}

impl Bench {
    pub(crate) fn new(word: &str, errors: &str) -> Self {
        let mut findings = Diagnostics::new();
        let compiled = compile_word(word, &mut findings).unwrap();
        let names = compiled.equations.names();
        let constants: Vec<String> =
            names.constants.iter().map(|(name, _)| format!("{name}: 0 mm")).collect();
        let text = format!(
            "calibration: 1\nmachine: {word}\nconstants: {{{}}}\nerrors: {{{errors}}}\n",
            constants.join(", ")
        );
        let tree = yaml::read(&SourceFile::new("c.yaml", text), &mut findings).unwrap();
        let truth = calibration::read(&tree, &names, &mut findings).unwrap_or_else(|| panic!("{findings:?}"));
        Self { compiled, truth }
    }

    /// What an instrument reads that sees all of the tool tip, and the angles of rotary axes, with normal noise.
    pub(crate) fn positions(&self, program: &Program, noise: f64, seed: u64) -> Recording {
        let commands = Commands {
            time: program.time.clone(),
            run: program.run.clone(),
            positions: program.positions.clone(),
            ..Commands::default()
        };
        let names = self.compiled.equations.names();
        let plant = Plant::new(&self.compiled.machine, &names, &self.truth).unwrap();
        let mut source = Source::new(seed, "bench");
        let mut tips: [Vec<f64>; 3] = Default::default();
        plant
            .run(&commands, |moment| {
                for (tip, place) in tips.iter_mut().zip(moment.pose.tip.iter()) {
                    tip.push(place + noise * source.normal());
                }
            })
            .unwrap();
        let axis = |command: &Vec<f64>| AxisChannels { command: Some(command.clone()), ..Default::default() };
        Recording {
            file: "bench.yaml".to_owned(),
            instrument: Instrument::Position,
            axes: program.positions.iter().map(axis).collect(),
            measured: tips.map(Some),
            time: program.time.clone(),
            run: program.run.clone(),
            ..Recording::default()
        }
    }

    pub(crate) fn evaluate(&self, recording: &Recording) -> Evaluation {
        evaluate(&Inputs { equations: &self.compiled.equations, calibration: Some(&self.truth), recording })
    }
}

pub(crate) fn figure<'f>(figures: &'f [Figure], symbol: &str) -> &'f Figure {
    figures.iter().find(|figure| figure.symbol == symbol).unwrap()
}

/// The value in um, or in units of 1e-3 rad.
pub(crate) fn value(figures: &[Figure], symbol: &str) -> f64 {
    let figure = figure(figures, symbol);
    1e3 * figure.value.number().unwrap_or_else(|| panic!("{figure:?}"))
}

pub(crate) fn reason(figures: &[Figure], symbol: &str) -> String {
    figure(figures, symbol).value.reason().unwrap().to_owned()
}

#[track_caller]
pub(crate) fn near(own: f64, other: f64, bound: f64) {
    assert!((own - other).abs() <= bound, "{own} is not {other} within {bound}");
}
