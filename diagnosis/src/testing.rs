//! What the tests share: machines with numbers from text, and recordings of them by the exact machine of `simulation`.
//!
//! In: a machine's name, calibrations as text, a path and an instrument. Out: the equations, and recordings as if they had
//! been read. Nothing of the diagnosis takes part in it.

#![expect(dead_code, reason = "tests of modules and of the whole each use their part")]

use std::path::Path as FilePath;

use model_dsl::calibration::{self, CalibratedTerm, Calibration, MachineNames, SeriesInput};
use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use model_dsl::{Compiled, compile, compile_word, yaml};
use simulation::noise::{Noise, Source};
use simulation::path::{Shape, Stroke};
use simulation::{
    Channel, Commands, Instrument as Reads, Measurement, Path, Plant, Scenario, Simulated, Temperature,
};

use crate::recording::{AxisChannels, Instrument, Line, Named, PartDatum, Recording};
use crate::{Chains, Inputs};

/// A machine that can be calibrated and recorded.
pub(crate) struct Bench {
    pub(crate) compiled: Compiled,
    pub(crate) names: MachineNames,
    name: String,
}

impl Bench {
    /// A shipped machine, or that of a topology word.
    pub(crate) fn of(name: &str) -> Self {
        let file = FilePath::new(env!("CARGO_MANIFEST_DIR")).join(format!("../machines/{name}.yaml"));
        let mut findings = Diagnostics::new();
        let compiled = match std::fs::read_to_string(file) {
            Ok(text) => compile(&SourceFile::new(name, text), &mut findings).unwrap(),
            Err(_) => compile_word(name, &mut findings).unwrap(),
        };
        let names = compiled.equations.names();
        Self { compiled, names, name: name.to_owned() }
    }

    /// The machine of a topology word whose machine file says this of its drives.
    pub(crate) fn driven(word: &str, drive: &str) -> Self {
        Self::file(&format!("topology: {word}\ndrive: {drive}\n"))
    }

    /// The machine of a machine file with this rest.
    pub(crate) fn file(rest: &str) -> Self {
        let text = format!("abbe: 1\nname: bench\n{rest}");
        let compiled = compile(&SourceFile::new("machine.yaml", text), &mut Diagnostics::new()).unwrap();
        let names = compiled.equations.names();
        Self { compiled, names, name: "bench".to_owned() }
    }

    pub(crate) fn equations(&self) -> &Equations {
        &self.compiled.equations
    }

    /// A calibration of which the block `errors` is given, in one line. Offsets without a default are 0, but the tool is
    /// 120 mm long.
    pub(crate) fn calibration(&self, errors: &str) -> Calibration {
        let constants = self.names.constants.iter().filter(|(_, default)| default.is_none());
        let constants =
            constants.map(|(name, _)| format!("{name}: {} mm", if name == "Zt" { 120 } else { 0 }));
        let constants: Vec<String> = constants.collect();
        let constants = if constants.is_empty() {
            String::new()
        } else {
            format!("constants: {{{}}}\n", constants.join(", "))
        };
        let text = format!("calibration: 1\nmachine: {}\n{constants}errors: {errors}\n", self.name);
        let source = SourceFile::new("calibration.yaml", text);
        let mut findings = Diagnostics::new();
        let tree = yaml::read(&source, &mut findings).unwrap();
        let read = calibration::read(&tree, &self.names, &mut findings);
        let Some(read) = read else { panic!("{}", render(&source, &findings, false)) };
        read
    }

    /// What a diagnosis of recordings starts from. Nothing is held out as a whole, and the machine's word is not in doubt.
    pub(crate) fn inputs<'i>(&'i self, known: &'i Calibration, recordings: &[&'i Recording]) -> Inputs<'i> {
        Inputs {
            equations: self.equations(),
            calibration: Some(known),
            recordings: recordings.to_vec(),
            holdout: None,
            calibration_file: None,
            chains: None,
        }
    }

    /// The same of the machine of a topology word that may be wrong.
    pub(crate) fn audited<'i>(&'i self, known: &'i Calibration, recording: &'i Recording) -> Inputs<'i> {
        let word = self.equations().machine.as_str();
        let chains = Some(Chains { file: word, word, derive: &derive });
        Inputs { chains, ..self.inputs(known, &[recording]) }
    }

    /// The number of an error motion.
    pub(crate) fn motion(&self, name: &str) -> usize {
        self.names.motion(name).unwrap()
    }

    pub(crate) fn plant(&self, truth: &Calibration) -> Plant {
        Plant::new(&self.compiled.machine, &self.names, truth).unwrap()
    }

    /// The recording of a machine with these numbers.
    pub(crate) fn record(&self, truth: &Calibration, scenario: &Scenario) -> Recording {
        self.recorded(&self.plant(truth), scenario)
    }

    /// The recording of a plant.
    pub(crate) fn recorded(&self, plant: &Plant, scenario: &Scenario) -> Recording {
        recording(simulation::simulate(plant, scenario).unwrap())
    }

    /// What would be read without noise.
    pub(crate) fn clean(&self, truth: &Calibration, scenario: &Scenario) -> Vec<Vec<f64>> {
        let simulated = simulation::simulate(&self.plant(truth), scenario).unwrap();
        simulated.readings.into_iter().map(|reading| reading.clean).collect()
    }
}

/// The equations of a topology word.
fn derive(word: &str) -> Option<Equations> {
    compile_word(word, &mut Diagnostics::new()).map(|compiled| compiled.equations)
}

/// A calibration with the terms of another one too.
pub(crate) fn together(known: &Calibration, more: &Calibration) -> Calibration {
    let mut sum = known.clone();
    let mut terms = Vec::new();
    for listed in &more.motions {
        for term in &listed.terms {
            let mut known = |number: usize| sum.sensor(&more.sensors.iter().nth(number).unwrap().name.value);
            let mut term = term.value.clone();
            if let Some(number) = term.sensor() {
                set_sensor(&mut term, known(number));
            }
            let term = term.with_factors(|factor| match factor.sensor() {
                Some(number) => factor.with_sensor(known(number)),
                None => factor,
            });
            terms.push((listed.motion, term));
        }
    }
    sum.with(&terms)
}

/// Points a term to another sensor.
pub(crate) fn set_sensor(term: &mut CalibratedTerm, to: usize) {
    if let CalibratedTerm::Polynomial { input: SeriesInput::Sensor(sensor), .. }
    | CalibratedTerm::Expansion { sensor, .. }
    | CalibratedTerm::Growth { sensor, .. } = term
    {
        *sensor = to;
    }
}

/// A simulated recording as if it had been read from its file.
pub(crate) fn recording(simulated: Simulated) -> Recording {
    let rows = simulated.time.len();
    let mut recording = Recording {
        file: "test.yaml".to_owned(),
        instrument: set_up(&simulated.instrument),
        datum: PartDatum::free_where(simulated.free_datum),
        holdout: (!simulated.holdout.is_empty()).then(|| simulated.holdout.clone()),
        normal: simulated.normals,
        time: simulated.time,
        run: simulated.run,
        temperatures: simulated.temperatures.into_iter().map(named).collect(),
        loads: simulated.loads.into_iter().map(named).collect(),
        ..Recording::default()
    };
    let axes = simulated.commands.into_iter().zip(simulated.actual);
    recording.axes = axes
        .map(|(command, actual)| AxisChannels { command: Some(command), actual, measured: None })
        .collect();
    for reading in simulated.readings {
        assert_eq!(reading.values.len(), rows);
        match reading.channel {
            Channel::Measured(direction) => recording.measured[direction] = Some(reading.values),
            Channel::Angle(axis) => recording.axes[axis].measured = Some(reading.values),
            Channel::Deviation => recording.deviation = Some(reading.values),
        }
    }
    recording
}

fn named(column: simulation::Column) -> Named {
    Named { name: column.name, unit: column.unit, values: column.values }
}

fn set_up(instrument: &Reads) -> Instrument {
    match *instrument {
        Reads::Position { .. } => Instrument::Position,
        Reads::Ballbar { center, radius, .. } => {
            Instrument::Ballbar { center: center.unwrap(), radius: radius.unwrap() }
        }
        Reads::Linear { axis, direction, .. } => Instrument::Linear(Line { axis: Some(axis), direction }),
        Reads::Straightness { axis, direction } => {
            Instrument::Straightness(Line { axis: Some(axis), direction })
        }
        Reads::Angular { axis, about } => Instrument::Angular { axis, about },
        Reads::Probe { .. } => Instrument::Probe,
    }
}

/// A path of one run.
pub(crate) fn path(shape: Shape, feed: f64, rate: f64) -> Path {
    Path { at: Vec::new(), shape, feed, acceleration: None, rate, runs: 1, pause: 2.0 }
}

/// There and back along one axis.
pub(crate) fn line(axis: usize, from: f64, to: f64) -> Shape {
    Shape::Line { strokes: vec![Stroke { axis, from, to }], back: true, overrun: 0.0, stations: None }
}

/// A circle in XY, counter-clockwise and back.
pub(crate) fn circle(radius: f64) -> Shape {
    Shape::Circle { plane: [0, 1], radius, start: 0.3, overshoot: 0.2, counterclockwise: vec![true, false] }
}

/// An instrument that reads the tip in some directions, `xy`.
pub(crate) fn position(directions: &str) -> Reads {
    let directions = ["x", "y", "z"].map(|direction| directions.contains(direction));
    Reads::Position { directions, angles: Vec::new() }
}

/// A ballbar that takes centre and radius from the path.
pub(crate) fn ballbar(eccentricity: [f64; 3]) -> Reads {
    Reads::Ballbar { center: None, radius: None, eccentricity, offset: 0.0 }
}

/// A recording without faults.
pub(crate) fn scenario(path: Path, instrument: Reads) -> Scenario {
    Scenario {
        title: None,
        path,
        temperatures: Vec::new(),
        loads: Vec::new(),
        measurement: Measurement::perfect(instrument),
        holdout: Vec::new(),
    }
}

/// A recording with white noise of this standard deviation (mm or rad), whose last run is held out where there are three.
pub(crate) fn noisy(path: Path, instrument: Reads, sigma: f64, seed: u64) -> Scenario {
    let holdout = if path.runs > 2 { vec![i64::from(path.runs)] } else { Vec::new() };
    let mut scenario = Scenario { holdout, ..scenario(path, instrument) };
    scenario.measurement.noise = Noise::white(sigma);
    scenario.measurement.seed = seed;
    scenario
}

/// A sensor that warms up from 20 degC by `by`, degC, with a time constant, s.
pub(crate) fn warming(name: &str, by: f64, time_constant: f64) -> Temperature {
    let start = 20.0;
    Temperature {
        name: name.to_owned(),
        start,
        steps: vec![(0.0, start + by)],
        time_constant,
        ..Temperature::default()
    }
}

/// A recording of nothing but time and the programmed positions of the axes, one column each.
pub(crate) fn programmed(time: &[f64], commands: &[Vec<f64>]) -> Recording {
    let axis =
        |command: &Vec<f64>| AxisChannels { command: Some(command.clone()), ..AxisChannels::default() };
    Recording {
        time: time.to_vec(),
        run: vec![1; time.len()],
        axes: commands.iter().map(axis).collect(),
        ..Recording::default()
    }
}

/// The commands of a recording, for a machine to follow again.
pub(crate) fn commands(recording: &Recording) -> Commands {
    Commands {
        time: recording.time.clone(),
        run: recording.run.clone(),
        positions: recording.axes.iter().map(|axis| axis.command.clone().unwrap()).collect(),
        ..Commands::default()
    }
}

/// Normal random numbers of a seed.
pub(crate) fn normals(seed: u64, count: usize) -> Vec<f64> {
    let mut source = Source::new(seed, "test");
    (0..count).map(|_| source.normal()).collect()
}

/// Flicker noise, 1/f at every frequency, of a seed: the half integral of white noise (Hosking, Fractional differencing, 1981).
pub(crate) fn flicker(seed: u64, count: usize) -> Vec<f64> {
    let white = normals(seed, count);
    let next = |response: &mut f64, lag: u32| {
        let now = *response;
        *response *= 1.0 - 0.5 / f64::from(lag);
        Some(now)
    };
    let response: Vec<f64> = (1..).take(count).scan(1.0, next).collect();
    let at = |row: usize| (0..=row).map(|lag| response[lag] * white[row - lag]).sum();
    (0..count).map(at).collect()
}

/// Times that go forward by uneven steps about `step`, s.
pub(crate) fn uneven(seed: u64, count: usize, step: f64) -> Vec<f64> {
    let mut source = Source::new(seed, "times");
    let mut time = 0.0;
    let next = |_| {
        let now = time;
        time += step * (0.2 + 1.6 * source.uniform());
        now
    };
    (0..count).map(next).collect()
}

/// The largest distance of two columns; NaN against NaN counts as none.
#[track_caller]
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let apart = |(a, b): (&f64, &f64)| if a.is_nan() && b.is_nan() { 0.0 } else { (a - b).abs() };
    a.iter()
        .zip(b)
        .map(apart)
        .fold(0.0, |worst: f64, apart| if apart.is_nan() { f64::INFINITY } else { worst.max(apart) })
}

/// The largest size in a column.
pub(crate) fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |peak: f64, value| peak.max(value.abs()))
}
