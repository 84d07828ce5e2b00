//! Cases: a machine, what is known of it, what was left out, and recordings of both. In: a seed and a number. Out: the
//! case, the same every time; and what any other effects would have shown in its recordings.

use std::sync::Arc;

use model_dsl::calibration::{CalibratedTerm, Calibration};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use nalgebra::Vector3;
use recording::{Recording, read_header};
use simulation::noise::{Missing, Noise};
use simulation::write::{Head, recording, table};
use simulation::{Instrument, Measurement, Plant, Scenario, Simulated, State, simulate};

use crate::bench::Bench;
use crate::draw::Draw;
use crate::effect::{self, Planted, Sensors, TERMS};
use crate::evidence::Channel;
use crate::scene::{Kind, Noises, Scene};

/// Readings further than this many standard deviations from what is clean are outliers: Gaussian noise never comes so far.
const FAR: f64 = 15.0;

/// From this number on, nothing is left out.
pub(crate) const QUIET: usize = 100_000;

/// What a diagnosis should say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Expected {
    Adequate,
    LeftOut,
    Dent,
    Loose,
}

/// One case.
pub(crate) struct Case {
    pub(crate) number: usize,
    pub(crate) bench: Bench,
    pub(crate) noises: Noises,
    /// What the diagnosis is told; nothing where the machine has no known errors.
    pub(crate) known: Calibration,
    /// The same, with a number for every sensor of the recordings.
    base: Calibration,
    pub(crate) scenes: Vec<Scene>,
    pub(crate) planted: Vec<Planted>,
    /// The largest deflection of each effect, in standard deviations of the noise, as it was asked for.
    pub(crate) sizes: Vec<f64>,
    pub(crate) expected: Expected,
    pub(crate) takes: Vec<Take>,
    /// The clean readings of the machine as it is known.
    still: Signal,
}

/// A recording as it was made.
pub(crate) struct Take {
    pub(crate) simulated: Simulated,
    /// The rows of the simulation that were kept.
    kept: Vec<usize>,
    /// The noise of each channel, then of each drive: its standard deviation.
    sigmas: Vec<f64>,
    /// What is free besides an offset of each channel: columns over the kept rows.
    free: Vec<Vec<f64>>,
}

/// What an effect shows in all recordings, channel after channel, in standard deviations of the noise.
pub(crate) type Signal = Vec<f64>;

/// The sizes, each with how often it comes; the last is whatever the effect's own parameters give.
pub(crate) const SIZES: [(f64, f64); 6] =
    [(0.25, 0.8), (0.5, 1.2), (1.0, 2.0), (2.0, 2.5), (5.0, 2.0), (10.0, 1.5)];
/// The size of effects that are taken as they come.
pub(crate) const LARGE: f64 = 100.0;

impl Case {
    /// The case of a number; `only` is a term that must be among its effects.
    pub(crate) fn draw(seed: u64, number: usize, only: Option<&str>) -> Self {
        let mut draw = Draw::new(seed, number);
        loop {
            // The term first, then recordings until one shows it: else what few recordings show would hardly come.
            let first = only.unwrap_or_else(|| draw.weighted(&TERMS));
            for _ in 0..60 {
                if let Some(case) = Self::attempt(number, first, only.is_some(), &mut draw) {
                    return case;
                }
            }
        }
    }

    /// A case whose first effect is a term; nothing where its recordings cannot show it.
    fn attempt(number: usize, first: &str, always: bool, draw: &mut Draw) -> Option<Self> {
        let bench = Bench::draw(draw);
        let noises = match number.checked_sub(QUIET) {
            Some(quiet) => [Noises::White, Noises::Correlated, Noises::Walk, Noises::Quantised][quiet % 4],
            None => draw.weighted(&[
                (Noises::White, 4.0),
                (Noises::Correlated, 2.5),
                (Noises::Walk, 2.0),
                (Noises::Quantised, 1.5),
            ]),
        };
        let kind = Kind::draw(&bench, draw);
        let mut scenes = vec![Scene::draw(&bench, kind, noises, draw)];
        if !kind.warm() && kind != Kind::Rotary && draw.chance(0.08) {
            let other = Kind::draw(&bench, draw);
            if !other.warm() {
                scenes.push(Scene::draw(&bench, other, noises, draw));
            }
        }
        let expected = match number {
            QUIET.. => Expected::Adequate,
            _ if !always && number % 25 == 7 => Expected::Dent,
            _ if !always && number % 25 == 15 => Expected::Loose,
            _ => Expected::LeftOut,
        };
        let names: Vec<String> =
            scenes[0].scenario.temperatures.iter().map(|sensor| sensor.name.clone()).collect();
        let stops = scenes.iter().any(Scene::stops);
        let known = bench.known(draw, names.first().map(String::as_str), stops);
        let mut base = known.clone();
        names.iter().for_each(|name| {
            base.sensor(name);
        });
        let mut case = Self {
            number,
            bench,
            noises,
            known,
            base,
            scenes,
            planted: Vec::new(),
            sizes: Vec::new(),
            expected,
            takes: Vec::new(),
            still: Vec::new(),
        };
        let shown = case.scenes.iter().all(|scene| effect::shows(&case.bench, scene, first));
        if expected == Expected::LeftOut && !shown {
            return None;
        }
        case.measure()?;
        match expected {
            Expected::Adequate => {}
            Expected::Loose => case.loosen(draw)?,
            Expected::Dent => case.plant(&["dent"], draw.pick(&[2.0, 5.0, 10.0]), draw)?,
            Expected::LeftOut => {
                let count = draw.weighted(&[(1, 0.55), (2, 0.3), (3, 0.15)]);
                for effect in 0..count {
                    let term = if effect == 0 { first } else { draw.weighted(&TERMS) };
                    let size = draw.weighted(&SIZES);
                    let planted = case.plant(&[term], size, draw);
                    if effect == 0 && planted.is_none() {
                        return None;
                    }
                }
            }
        }
        case.measure()?;
        Some(case)
    }

    /// Plants an effect of one of these kinds, of a size in standard deviations of the noise.
    fn plant(&mut self, terms: &[&str], size: f64, draw: &mut Draw) -> Option<()> {
        let term = draw.pick(terms);
        if !self.scenes.iter().all(|scene| effect::shows(&self.bench, scene, term)) {
            return None;
        }
        let names = self.scenes[0].scenario.temperatures.iter().map(|sensor| sensor.name.clone()).collect();
        for _ in 0..12 {
            let sensors = Sensors { calibration: &self.base, names: Vec::clone(&names) };
            let Some(mut planted) = effect::draw(&self.bench, &self.scenes, &sensors, term, draw) else {
                continue;
            };
            let as_it_comes = term == "lag" && draw.chance(0.3);
            let Some(signal) = self.sized(&mut planted, (!as_it_comes).then_some(size)) else { continue };
            let doubled = self.planted.iter().any(|known| {
                known.name(&self.bench.names) == planted.name(&self.bench.names)
                    || self
                        .signal(std::slice::from_ref(known))
                        .is_none_or(|known| alike(&known, &signal) > 0.98)
            });
            if !doubled && planted.plausible(&self.bench) {
                self.planted.push(planted);
                self.sizes.push(if as_it_comes { LARGE } else { size });
                return Some(());
            }
        }
        None
    }

    /// Gives an effect its size, and tells what it shows; nothing where the recordings hardly show it.
    fn sized(&self, planted: &mut Planted, size: Option<f64>) -> Option<Signal> {
        for _ in 0..4 {
            let raw = self.change(std::slice::from_ref(planted))?;
            let signal = self.projected(raw.clone());
            if rms(&signal) < 0.05 * rms(&raw) || rms(&raw) == 0.0 || !rms(&raw).is_finite() {
                return None;
            }
            let Some(size) = size else { return (peak(&signal) > 3.0).then_some(signal) };
            let factor = size / peak(&signal);
            if !(1e-9..1e9).contains(&factor) {
                return None;
            }
            if (factor - 1.0).abs() < 0.03 {
                return Some(signal);
            }
            planted.scale(factor);
        }
        // It does not grow with its parameter: only a second order of it shows.
        None
    }

    /// Displaces the part from run to run.
    fn loosen(&mut self, draw: &mut Draw) -> Option<()> {
        let scene = &mut self.scenes[0];
        if scene.scenario.path.runs < 4 || scene.angular() || self.takes.len() > 1 {
            return None;
        }
        let size = draw.pick(&[5.0, 10.0]);
        scene.scenario.measurement.fixture = size * self.takes[0].sigmas[0];
        self.sizes.push(size);
        Some(())
    }

    /// Makes the recordings with everything that was planted.
    fn measure(&mut self) -> Option<()> {
        let plant = self.plant_of(&self.planted)?;
        let mut takes = Vec::new();
        for (number, scene) in self.scenes.iter().enumerate() {
            let mut scenario = scene.scenario.clone();
            set_up(&mut scenario.measurement, number, &self.planted);
            let mut simulated = simulate(&plant, &scenario).ok()?;
            let kept = kept(&simulated, scene.short);
            trim(&mut simulated, &kept);
            if simulated.time.len() < 60 || simulated.time.len() > 60_000 {
                return None;
            }
            let free = free(&plant, &simulated);
            let drives = simulated.actual.iter().flatten();
            let drive = scenario.measurement.drive_noise;
            let sigmas = simulated.readings.iter().map(|reading| noise_of(&reading.values, &reading.clean));
            let sigmas =
                sigmas.chain(drives.map(|_| drive.white.hypot(drive.resolution / 12_f64.sqrt()))).collect();
            takes.push(Take { simulated, kept, sigmas, free });
        }
        self.takes = takes;
        self.still = self.clean(&[])?;
        Some(())
    }

    /// The machine as it is known, with these effects.
    fn plant_of(&self, planted: &[Planted]) -> Option<Plant> {
        let terms: Vec<(usize, CalibratedTerm)> = planted
            .iter()
            .filter_map(|planted| match planted {
                Planted::Term { motion, term, .. } => Some((*motion, term.clone())),
                _ => None,
            })
            .collect();
        let calibration = self.base.with(&terms);
        let machine = &self.bench.compiled.machine;
        let mut plant = Plant::new(machine, &self.bench.names, &calibration).ok()?;
        let mut places: Vec<usize> =
            (0..self.bench.names.motions.len()).map(|motion| self.base.terms(motion).len()).collect();
        for planted in planted {
            match planted {
                Planted::Term { motion, drive, .. } => {
                    if *drive {
                        plant.see_term_at_drive(machine, *motion, places[*motion]).ok()?;
                    }
                    places[*motion] += 1;
                }
                &Planted::Dent { motion, axis, at, width, height } => {
                    let dent = move |state: &State<'_>| {
                        let away = (state.position(axis) - at) / width;
                        height * (-0.5 * away * away).exp()
                    };
                    plant = plant.with_effect(motion, Arc::new(dent));
                }
                _ => {}
            }
        }
        Some(plant)
    }

    /// What these effects change in the clean readings, in standard deviations of the noise.
    fn change(&self, planted: &[Planted]) -> Option<Signal> {
        let mut with = self.clean(planted)?;
        with.iter_mut().zip(&self.still).for_each(|(with, without)| *with -= without);
        Some(with)
    }

    fn clean(&self, planted: &[Planted]) -> Option<Signal> {
        let plant = self.plant_of(planted)?;
        let mut signal = Vec::new();
        for (number, (scene, take)) in self.scenes.iter().zip(&self.takes).enumerate() {
            let mut scenario: Scenario = scene.scenario.clone();
            let measurement = &mut scenario.measurement;
            (measurement.noise, measurement.drive_noise) = (Noise::default(), Noise::default());
            (measurement.missing, measurement.fixture) = (Missing::default(), 0.0);
            set_up(measurement, number, planted);
            let simulated = simulate(&plant, &scenario).ok()?;
            let columns = simulated.readings.iter().map(|reading| &reading.clean);
            let columns = columns.chain(simulated.actual.iter().flatten());
            for (column, sigma) in columns.zip(&take.sigmas) {
                signal.extend(take.kept.iter().map(|row| column[*row] / sigma));
            }
        }
        Some(signal)
    }

    /// What is left of a change beside what is always free: an offset of each channel, the set-up of a ballbar.
    fn projected(&self, mut signal: Signal) -> Signal {
        let mut start = 0;
        for take in &self.takes {
            let rows = take.kept.len();
            for _ in &take.sigmas {
                let column = &mut signal[start..start + rows];
                let mut basis: Vec<Vec<f64>> = Vec::new();
                for free in std::iter::once(&vec![1.0; rows]).chain(&take.free) {
                    let mut free = free.clone();
                    basis.iter().for_each(|known| remove(&mut free, known));
                    let length = dot(&free, &free).sqrt();
                    if length > 1e-6 {
                        free.iter_mut().for_each(|entry| *entry /= length);
                        basis.push(free);
                    }
                }
                basis.iter().for_each(|known| remove(column, known));
                start += rows;
            }
        }
        signal
    }

    /// What these effects together show in the recordings beside what is always free.
    pub(crate) fn signal(&self, planted: &[Planted]) -> Option<Signal> {
        self.change(planted).map(|change| self.projected(change))
    }

    /// How far a signal stands above the noise in all: the root of its energy behind the filter that makes the noise white.
    pub(crate) fn energy(&self, signal: &[f64]) -> f64 {
        let mut energy = 0.0;
        let mut rest = signal;
        for (scene, take) in self.scenes.iter().zip(&self.takes) {
            let channels = take.simulated.readings.len();
            for (channel, sigma) in take.sigmas.iter().enumerate() {
                let Some((own, others)) = rest.split_at_checked(take.kept.len()) else { return 0.0 };
                rest = others;
                energy += match channel < channels {
                    true => {
                        let values = &take.simulated.readings[channel].values;
                        whitened(&take.simulated.time, own, values, *sigma, &scene.scenario.measurement.noise)
                    }
                    false => dot(own, own),
                };
            }
        }
        energy.sqrt()
    }

    /// How far an effect stands out where nobody knows the noise: the root of twice its gain in log likelihood, with all other effects
    /// known.
    pub(crate) fn evidence(&self, effect: &[f64]) -> f64 {
        let Some(clean) = self.clean(&self.planted) else { return 0.0 };
        let (mut gain, mut start) = (0.0, 0);
        for take in &self.takes {
            let readings = take.simulated.readings.iter().map(|reading| (&reading.values, true));
            let drives = take.simulated.actual.iter().flatten().map(|values| (values, false));
            for ((values, wanders), sigma) in readings.chain(drives).zip(&take.sigmas) {
                let own = start..start + take.kept.len();
                start = own.end;
                let (Some(effect), Some(clean)) = (effect.get(own.clone()), clean.get(own)) else {
                    return 0.0;
                };
                let noise = values.iter().zip(clean).map(|(value, clean)| value / sigma - clean);
                let near = |noise: f64| if noise.abs() < FAR { noise } else { f64::NAN };
                let noise: Vec<f64> = noise.map(near).collect();
                let (time, free) = (&take.simulated.time, &take.free);
                gain += Channel { time, noise: &noise, effect, free, wanders }.gain();
            }
        }
        gain.max(0.0).sqrt()
    }

    /// The number under which the effects of this case know a sensor.
    pub(crate) fn sensor(&self, name: &str) -> Option<usize> {
        self.base.sensors.index(name)
    }

    /// What the diagnosis is told: nothing where nothing is known.
    pub(crate) fn told(&self) -> Option<&Calibration> {
        let nothing = self.known.motions.is_empty() && self.bench.names.axes.len() == 1;
        (!nothing).then_some(&self.known)
    }

    /// The files of a recording: its head and its table.
    pub(crate) fn files(&self, take: usize) -> (String, Vec<u8>) {
        let (name, simulated) = (format!("recording-{}", take + 1), &self.takes[take].simulated);
        let head = Head {
            machine: self.bench.name.to_owned(),
            calibration: self.told().map(|_| "calibration.yaml".to_owned()),
            data: format!("{name}.csv"),
            axes: self.bench.names.axes.clone(),
        };
        let mut data = Vec::new();
        table(simulated, &head.axes, &mut data).unwrap();
        (recording(simulated, &head), data)
    }

    /// The recordings as they come back from their files.
    pub(crate) fn recordings(&self) -> Vec<Recording> {
        let read = |take: usize| {
            let (head, data) = self.files(take);
            let mut findings = Diagnostics::new();
            let root = yaml::read(&SourceFile::new("recording.yaml", head.clone()), &mut findings).unwrap();
            let header = read_header(&root, &self.bench.compiled.equations, &mut findings);
            let header =
                header.unwrap_or_else(|| panic!("{:?}\n{head}", findings.iter().collect::<Vec<_>>()));
            header.read_csv("data.csv", data.as_slice()).unwrap_or_else(|error| panic!("{error}\n{head}"))
        };
        (0..self.takes.len()).map(read).collect()
    }

    /// The root mean square of the noise of what is held out, its mean over everything else taken away; of everything
    /// where no run is.
    pub(crate) fn held_out_noise(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for take in &self.takes {
            let simulated = &take.simulated;
            for (reading, sigma) in simulated.readings.iter().zip(&take.sigmas) {
                let noise = reading.values.iter().zip(&reading.clean).map(|(value, clean)| value - clean);
                let noise: Vec<(f64, bool)> = noise
                    .zip(&simulated.run)
                    .map(|(noise, run)| (noise, simulated.holdout.contains(run)))
                    .filter(|(noise, _)| noise.abs() < FAR * sigma)
                    .collect();
                let fitted: Vec<f64> =
                    noise.iter().filter(|(_, out)| !out).map(|(noise, _)| *noise).collect();
                let mean = fitted.iter().sum::<f64>() / fitted.len().max(1) as f64;
                let named = !simulated.holdout.is_empty();
                for (noise, _) in noise.iter().filter(|(_, out)| *out || !named) {
                    sum += (noise - mean) * (noise - mean);
                    count += 1.0;
                }
            }
        }
        (sum / f64::max(count, 1.0)).sqrt()
    }
}

fn set_up(measurement: &mut Measurement, scene: usize, planted: &[Planted]) {
    for planted in planted {
        match *planted {
            Planted::Clock { scene: own, offset } if own == scene => measurement.clock += offset,
            Planted::Cosine { scene: own, angle } if own == scene => {
                if let Instrument::Linear { cosine, .. } = &mut measurement.instrument {
                    *cosine += angle;
                }
            }
            _ => {}
        }
    }
}

/// The rows that are kept where one run ends early.
fn kept(simulated: &Simulated, short: Option<(i64, f64)>) -> Vec<usize> {
    let rows = simulated.time.len();
    let Some((run, share)) = short else { return (0..rows).collect() };
    let of_run: Vec<usize> = (0..rows).filter(|row| simulated.run[*row] == run).collect();
    let last = of_run.len() as f64 * share;
    let cut = of_run.iter().enumerate().find(|(place, _)| *place as f64 > last).map(|(_, row)| *row);
    (0..rows).filter(|row| simulated.run[*row] != run || cut.is_none_or(|cut| *row < cut)).collect()
}

fn trim(simulated: &mut Simulated, kept: &[usize]) {
    let pick = |column: &mut Vec<f64>| *column = kept.iter().map(|row| column[*row]).collect();
    pick(&mut simulated.time);
    simulated.run = kept.iter().map(|row| simulated.run[*row]).collect();
    simulated.commands.iter_mut().for_each(pick);
    simulated.actual.iter_mut().flatten().for_each(pick);
    simulated.readings.iter_mut().for_each(|reading| {
        pick(&mut reading.values);
        pick(&mut reading.clean);
    });
    simulated.normals.iter_mut().flatten().for_each(pick);
    simulated.temperatures.iter_mut().chain(&mut simulated.loads).for_each(|column| pick(&mut column.values));
}

/// The directions of a ballbar: its centre is always free.
fn free(plant: &Plant, simulated: &Simulated) -> Vec<Vec<f64>> {
    let Instrument::Ballbar { center: Some(center), .. } = &simulated.instrument else { return Vec::new() };
    let mut columns = vec![Vec::new(); 3];
    for row in 0..simulated.time.len() {
        let positions: Vec<f64> = simulated.commands.iter().map(|column| column[row]).collect();
        let away = (plant.nominal(&positions).tip - Vector3::from(*center)).normalize();
        columns.iter_mut().zip(away.iter()).for_each(|(column, entry)| column.push(*entry));
    }
    columns
}

/// The standard deviation of the noise, gaps and far outliers left out.
fn noise_of(values: &[f64], clean: &[f64]) -> f64 {
    let noise: Vec<f64> = values
        .iter()
        .zip(clean)
        .map(|(value, clean)| value - clean)
        .filter(|noise| noise.is_finite())
        .collect();
    let mut sizes: Vec<f64> = noise.iter().map(|noise| noise.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let bound = FAR * sizes.get(sizes.len() / 2).copied().unwrap_or(1.0);
    let near: Vec<f64> = noise.into_iter().filter(|noise| noise.abs() <= bound).collect();
    let mean = near.iter().sum::<f64>() / near.len().max(1) as f64;
    let square =
        near.iter().map(|noise| (noise - mean) * (noise - mean)).sum::<f64>() / near.len().max(1) as f64;
    square.sqrt().max(1e-12)
}

/// The energy of a signal, in standard deviations of the noise, behind the Kalman filter of that noise. Missing values count
/// for nothing.
fn whitened(time: &[f64], signal: &[f64], values: &[f64], sigma: f64, noise: &Noise) -> f64 {
    let white = (noise.white * noise.white + noise.resolution * noise.resolution / 12.0) / (sigma * sigma);
    let (mut state, mut variance, mut energy) = (0.0, 0.0, 0.0);
    let mut before: Option<f64> = None;
    for ((time, signal), value) in time.iter().zip(signal).zip(values) {
        let step = before.map_or(f64::INFINITY, |before| time - before);
        if let Some(correlated) = &noise.correlated {
            let kept = (-step / correlated.time_constant).exp();
            let stationary = (correlated.sigma / sigma).powi(2);
            (state, variance) = (kept * state, kept * kept * variance + (1.0 - kept * kept) * stationary);
        }
        if let Some(walk) = &noise.walk {
            // The zero of a channel is free: where the walk begins is not known.
            let grown = (walk.sigma / sigma).powi(2) * step.min(1e4 * walk.after) / walk.after;
            variance += grown;
        }
        before = Some(*time);
        if value.is_nan() {
            continue;
        }
        let new = signal - state;
        energy += new * new / (variance + white);
        state += variance / (variance + white) * new;
        variance *= white / (variance + white);
    }
    energy
}

pub(crate) fn dot(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

pub(crate) fn remove(column: &mut [f64], known: &[f64]) {
    let share = dot(column, known);
    column.iter_mut().zip(known).for_each(|(entry, known)| *entry -= share * known);
}

pub(crate) fn rms(signal: &[f64]) -> f64 {
    (dot(signal, signal) / signal.len().max(1) as f64).sqrt()
}

fn peak(signal: &[f64]) -> f64 {
    signal.iter().fold(0.0, |largest, value| f64::max(largest, value.abs()))
}

/// The cosine of the angle between two signals, without its sign.
fn alike(left: &[f64], right: &[f64]) -> f64 {
    dot(left, right).abs() / (dot(left, left) * dot(right, right)).sqrt().max(f64::MIN_POSITIVE)
}
