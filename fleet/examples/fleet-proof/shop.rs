//! A simulated shop. In: how many machines, how many weeks, a seed. Out: a folder with a fleet file, and with a recording of each machine
//! in each week; and the truth of every number in them.
//!
//! Every machine is a bridge mill XYFZ, and every recording a circle in both senses, read in X and Y by a grid encoder. All machines have a
//! lost motion of X and of Y and a wave of the screw of X, of sizes of their own that stay. In the first three, something changes.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::Path;

use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::{calibration, compile_word, yaml};
use recording::Moment;
use simulation::noise::{Noise, Source};
use simulation::path::Shape;
use simulation::write::{Head, recording, table};
use simulation::{Instrument, Measurement, Path as Driven, Plant, Scenario, simulate};

/// The machine's topology.
const WORD: &str = "XYFZ";

/// The lead of the screw of X, mm.
const LEAD: f64 = 10.0;

/// Of the grid encoder as it is read, mm.
const NOISE: f64 = 0.5e-3;

/// The first week.
const FIRST: &str = "2026-01-05T08:00";

/// Seconds of a week.
const WEEK: i64 = 604_800;

/// A shop.
#[derive(Clone, Copy)]
pub(crate) struct Shop {
    /// How many machines.
    pub(crate) machines: usize,
    /// How many weeks.
    pub(crate) weeks: usize,
    /// What the sizes and the noise are drawn from.
    pub(crate) seed: u64,
}

/// What is true of a machine in a week, mm and rad.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    /// The lost motion of X.
    pub(crate) backlash_x: f64,
    /// The lost motion of Y.
    pub(crate) backlash_y: f64,
    /// The amplitude of the wave of the screw of X.
    pub(crate) wave: f64,
    /// The squareness of Y to X.
    pub(crate) square: f64,
}

/// The three changes: the number of the machine, the effect and the parameter that tell it.
pub(crate) const PLANTED: [(usize, &str, &str); 3] =
    [(0, "EXX backlash", "lost_motion"), (1, "EXX cyclic", "amplitude"), (2, "EC0Y constant", "value")];

impl Shop {
    /// The name of a machine.
    pub(crate) fn name(self, machine: usize) -> String {
        format!("mill-{:02}", machine + 1)
    }

    /// The moment of a week's recordings.
    pub(crate) fn time(self, week: usize) -> Moment {
        let weeks = i64::try_from(week).unwrap() * WEEK;
        Moment::new(Moment::read(FIRST).unwrap().seconds() + weeks).unwrap()
    }

    /// What is true.
    pub(crate) fn truth(self, machine: usize, week: usize) -> Truth {
        let mut source = Source::new(self.seed, &self.name(machine));
        let mut drawn = |middle: f64, spread: f64| middle + spread * source.normal().clamp(-2.0, 2.0);
        let mut truth = Truth {
            backlash_x: drawn(3e-3, 0.8e-3),
            backlash_y: drawn(2e-3, 0.5e-3),
            wave: drawn(0.6e-3, 0.15e-3),
            square: 0.0,
        };
        let weeks = f64::from(u32::try_from(week).unwrap());
        match machine {
            0 => truth.backlash_x += 0.15e-3 * weeks,
            1 => truth.wave += 0.06e-3 * weeks,
            2 if week >= self.step() => truth.square = 8e-6,
            _ => {}
        }
        truth
    }

    /// The week from which on the squareness of the third machine is another one.
    pub(crate) fn step(self) -> usize {
        (self.weeks * 14).div_ceil(26)
    }

    /// How much a planted change is over all weeks, mm or rad.
    pub(crate) fn planted(self, number: usize) -> f64 {
        let (first, last) = (self.truth(number, 0), self.truth(number, self.weeks.saturating_sub(1)));
        let parts = [last.backlash_x - first.backlash_x, last.wave - first.wave, last.square - first.square];
        parts.into_iter().sum()
    }

    /// Writes all files.
    pub(crate) fn write(self, folder: &Path) {
        let mut fleet = "fleet: 1\nmachines:\n".to_owned();
        for machine in 0..self.machines {
            let name = self.name(machine);
            fleet += &format!(
                "  {name}: {{kind: {WORD} mill, recordings: \"{name}/*.yaml\", time: YYYY-MM-DD}}\n"
            );
            fs::create_dir_all(folder.join(&name)).unwrap();
            for week in 0..self.weeks {
                self.record(&folder.join(&name), machine, week);
            }
        }
        fs::write(folder.join("fleet.yaml"), fleet).unwrap();
    }

    fn record(self, folder: &Path, machine: usize, week: usize) {
        let Truth { backlash_x, backlash_y, wave, square } = self.truth(machine, week);
        let phase = 40 * (machine % 9);
        let text = format!(
            "calibration: 1\nmachine: {WORD}\nconstants: {{Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}}\nerrors:\n  EXX: [{{backlash: {{lost_motion: \
             {backlash_x:e} mm}}}}, {{cyclic: {{period: {LEAD} mm, amplitude: {wave:e} mm, phase: {phase} deg}}}}]\n  EYY: \
             [{{backlash: {{lost_motion: {backlash_y:e} mm}}}}]\n  EC0Y: {square:e} rad\n"
        );
        let mut findings = Diagnostics::new();
        let compiled = compile_word(WORD, &mut findings).unwrap();
        let names = compiled.equations.names();
        let root = yaml::read(&SourceFile::new("truth", text), &mut findings).unwrap();
        let truth = calibration::read(&root, &names, &mut findings).expect("a calibration");
        let plant = Plant::new(&compiled.machine, &names, &truth).unwrap();
        let counterclockwise = vec![true, false];
        let shape =
            Shape::Circle { plane: [0, 1], radius: 75.0, start: 0.3, overshoot: 0.2, counterclockwise };
        let path = Driven {
            at: Vec::new(),
            shape,
            feed: 3000.0 / 60.0,
            acceleration: None,
            rate: 50.0,
            runs: 1,
            pause: 2.0,
        };
        let instrument = Instrument::Position { directions: [true, true, false], angles: Vec::new() };
        let mut measurement = Measurement::perfect(instrument);
        measurement.noise = Noise::white(NOISE);
        measurement.seed = self.seed.wrapping_add((1000 * machine + week) as u64);
        let scenario = Scenario {
            title: None,
            path,
            temperatures: Vec::new(),
            loads: Vec::new(),
            measurement,
            holdout: Vec::new(),
        };
        let simulated = simulate(&plant, &scenario).unwrap();
        let day = self.time(week).day();
        let head = Head {
            machine: WORD.to_owned(),
            calibration: None,
            data: format!("{day}.csv"),
            axes: names.axes.clone(),
        };
        fs::write(folder.join(format!("{day}.yaml")), recording(&simulated, &head)).unwrap();
        table(
            &simulated,
            &names.axes,
            BufWriter::new(File::create(folder.join(format!("{day}.csv"))).unwrap()),
        )
        .unwrap();
    }
}

impl Truth {
    /// The truth of a number that is followed, in mm or rad; nothing of what no machine has, which is zero.
    pub(crate) fn of(self, effect: &str, parameter: &str) -> f64 {
        match (effect.split(' ').take(2).collect::<Vec<_>>().as_slice(), parameter) {
            (["EXX", "backlash"], "lost_motion") => self.backlash_x,
            (["EYY", "backlash"], "lost_motion") => self.backlash_y,
            (["EXX", "cyclic"], "amplitude") if is_screw(effect) => self.wave,
            (["EC0Y", "constant"], "value") => self.square,
            _ => 0.0,
        }
    }
}

/// Whether a wave is that of the screw.
fn is_screw(effect: &str) -> bool {
    let period = effect.split(' ').rev().nth(1).and_then(|period| period.parse::<f64>().ok());
    period.is_some_and(|period| (period - LEAD).abs() < 0.1)
}
