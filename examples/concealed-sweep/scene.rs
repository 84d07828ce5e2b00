//! Recordings to be made. In: a machine and random choices. Out: where the axes go, what reads them, and with what noise.

use std::f64::consts::TAU;

use simulation::noise::{Correlated, Missing, Noise, Outliers, Walk};
use simulation::path::{Path, Shape, Stations, Stroke};
use simulation::{Instrument, Load, Measurement, Normal, Plant, Pulses, Scenario, Swing, Temperature};

use crate::bench::Bench;
use crate::draw::Draw;

/// What a recording looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Circle,
    Ballbar,
    Lines,
    Heights,
    Diagonal,
    Grid,
    Diamond,
    Spiral,
    Stations,
    Straightness,
    Angular,
    Probe,
    WarmUp,
    Fast,
    Slow,
    Rotary,
}

/// The noise of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Noises {
    White,
    Correlated,
    Walk,
    Quantised,
}

impl Noises {
    pub(crate) const ALL: [Self; 4] = [Self::White, Self::Correlated, Self::Walk, Self::Quantised];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::White => "white",
            Self::Correlated => "correlated",
            Self::Walk => "random walk",
            Self::Quantised => "quantised",
        }
    }
}

/// A recording to be made.
pub(crate) struct Scene {
    pub(crate) kind: Kind,
    pub(crate) scenario: Scenario,
    /// The axes that move.
    pub(crate) moving: Vec<usize>,
    /// The run that ends early, and the share of its rows that it has.
    pub(crate) short: Option<(i64, f64)>,
    /// Readings a second.
    pub(crate) rate: f64,
    /// How long it takes, s.
    pub(crate) duration: f64,
}

impl Kind {
    const OF_SEVERAL: [(Self, f64); 14] = [
        (Self::Circle, 4.0),
        (Self::Ballbar, 4.0),
        (Self::Lines, 3.0),
        (Self::Heights, 3.0),
        (Self::Diagonal, 1.5),
        (Self::Grid, 1.5),
        (Self::Diamond, 1.5),
        (Self::Spiral, 1.0),
        (Self::Stations, 2.5),
        (Self::Straightness, 1.0),
        (Self::Angular, 1.0),
        (Self::Probe, 1.0),
        (Self::WarmUp, 4.0),
        (Self::Fast, 1.5),
    ];

    /// A kind that a machine can do.
    pub(crate) fn draw(bench: &Bench, draw: &mut Draw) -> Self {
        let slow = draw.chance(0.04);
        match bench.slides().len() {
            0 => Self::Rotary,
            _ if slow => Self::Slow,
            1 => draw.pick(&[Self::Lines, Self::Lines, Self::Stations, Self::WarmUp, Self::Fast]),
            _ if !bench.rotaries().is_empty() && draw.chance(0.5) => Self::Rotary,
            _ => draw.weighted(&Self::OF_SEVERAL),
        }
    }

    /// Whether temperatures are recorded.
    pub(crate) fn warm(self) -> bool {
        matches!(self, Self::WarmUp | Self::Slow)
    }

    /// Whether it is read at stops.
    pub(crate) fn stops(self) -> bool {
        matches!(self, Self::Stations)
    }
}

/// What moves, before it is timed.
struct Course {
    shape: Shape,
    moving: Vec<usize>,
    at: Vec<Vec<f64>>,
    feed: f64,
    runs: u32,
}

impl Scene {
    /// A recording of a kind.
    pub(crate) fn draw(bench: &Bench, kind: Kind, noises: Noises, draw: &mut Draw) -> Self {
        let course = course(bench, kind, draw);
        let acceleration =
            (draw.chance(0.35) && !kind.stops()).then(|| course.feed * draw.between(2.0, 10.0));
        let mut path = Path {
            at: course.at,
            shape: course.shape,
            feed: course.feed,
            acceleration,
            rate: 1.0,
            runs: 1,
            pause: draw.between(0.5, 20.0),
        };
        let rotary: Vec<bool> = bench.names.axes.iter().map(|axis| axis.rotary).collect();
        let once = path.timeline(&rotary).unwrap();
        let once = once.instants().last().map_or(1.0, |instant| instant.time).max(1.0);
        path.runs = course.runs;
        let rows = if draw.chance(0.06) { 20_000.0 } else { draw.ratio(250.0, 8000.0) };
        path.rate = match kind {
            Kind::Fast => 1000.0,
            Kind::Slow => 0.1,
            _ => (rows / (f64::from(path.runs) * once)).clamp(0.05, 1000.0),
        };
        if kind == Kind::WarmUp {
            path.pause = (3600.0 / f64::from(path.runs) - once).max(5.0);
        }
        let duration = f64::from(path.runs) * (once + path.pause);
        let temperatures = if kind.warm() { temperatures(duration, draw) } else { Vec::new() };
        let loads = if draw.chance(0.15) { vec![load(duration, draw)] } else { Vec::new() };
        let mut measurement = Measurement::perfect(instrument(bench, kind, &course.moving, draw));
        measurement.seed = draw.seed();
        let rate = path.rate;
        let holdout = match path.runs {
            3.. if draw.chance(0.8) => vec![i64::from(draw.count(2, path.runs))],
            2 if draw.chance(0.6) => vec![2],
            _ => Vec::new(),
        };
        let short = (path.runs > 1 && draw.chance(0.1))
            .then(|| (i64::from(draw.count(1, path.runs)), draw.between(0.5, 0.9)));
        let scenario = Scenario { title: None, path, temperatures, loads, measurement, holdout };
        let mut scene = Self { kind, scenario, moving: course.moving, short, rate, duration };
        scene.take_noise(noises, draw);
        scene.take_drives(bench, draw);
        scene
    }

    /// Whether what is read is an angle.
    pub(crate) fn angular(&self) -> bool {
        match &self.scenario.measurement.instrument {
            Instrument::Angular { .. } => true,
            Instrument::Position { directions, .. } => *directions == [false; 3],
            _ => false,
        }
    }

    /// Whether it is read at stops only.
    pub(crate) fn stops(&self) -> bool {
        matches!(self.scenario.path.shape, Shape::Line { stations: Some(_), .. })
    }

    fn take_noise(&mut self, noises: Noises, draw: &mut Draw) {
        let stage = self.kind == Kind::Rotary && self.angular();
        let (low, high, step) = match self.angular() {
            true if stage => (3e-6, 2e-5, 1.745e-6),
            true => (3e-7, 2e-6, 4.85e-8),
            false => (2e-4, 1e-3, 1e-4),
        };
        let quantised = noises == Noises::Quantised;
        let white = if quantised { step * draw.between(0.3, 2.0) } else { draw.ratio(low, high) };
        let measurement = &mut self.scenario.measurement;
        let correlated = (noises == Noises::Correlated)
            .then(|| Correlated { sigma: white, time_constant: draw.ratio(0.2, 5.0) });
        let walk = (noises == Noises::Walk)
            .then(|| Walk { sigma: white * draw.between(1.0, 3.0), after: self.duration });
        let outliers = draw.chance(0.1).then_some(Outliers { rate: 0.002, size: 50.0 * white });
        measurement.noise = Noise {
            white,
            correlated,
            walk,
            outliers,
            resolution: if quantised || draw.chance(0.5) { step } else { 0.1 * step },
        };
        if draw.chance(0.15) {
            let length = self.duration * draw.between(0.005, 0.03);
            measurement.missing = Missing { rate: draw.between(0.0, 0.02), blocks: draw.count(0, 3), length };
        }
    }

    fn take_drives(&mut self, bench: &Bench, draw: &mut Draw) {
        let position = matches!(self.scenario.measurement.instrument, Instrument::Position { .. });
        if !position || !draw.chance(0.25) {
            return;
        }
        let measurement = &mut self.scenario.measurement;
        measurement.drives = self.moving.clone();
        let rotary = self.moving.iter().any(|axis| bench.names.axes[*axis].rotary);
        let slide = self.moving.iter().any(|axis| !bench.names.axes[*axis].rotary);
        if rotary && slide {
            measurement.drives.retain(|axis| !bench.names.axes[*axis].rotary);
        }
        let size = if slide { 1e-4 } else { 2e-6 };
        measurement.drive_noise =
            Noise { resolution: 0.5 * size, ..Noise::white(size * draw.between(0.5, 2.0)) };
    }
}

/// The middle of two ranges and the largest circle around it, a little smaller.
fn round(bench: &Bench, plane: [usize; 2], draw: &mut Draw) -> ([f64; 2], f64) {
    let half = plane.map(|axis| 0.5 * (bench.travels[axis][1] - bench.travels[axis][0]));
    let middle = plane.map(|axis| (0.5 * (bench.travels[axis][1] + bench.travels[axis][0])).round());
    (middle, (half[0].min(half[1]).min(160.0) * draw.between(0.55, 0.95)).round())
}

fn course(bench: &Bench, kind: Kind, draw: &mut Draw) -> Course {
    let slides = bench.slides();
    let at: Vec<Vec<f64>> = bench.home.iter().map(|place| vec![*place]).collect();
    match kind {
        Kind::Circle | Kind::Ballbar | Kind::Diamond | Kind::Spiral | Kind::Grid => {
            plane(bench, kind, at, draw)
        }
        Kind::Probe if slides.len() > 1 && draw.chance(0.5) => plane(bench, Kind::Circle, at, draw),
        Kind::Rotary => turn(bench, at, draw),
        Kind::Diagonal => {
            let mut moving = slides.clone();
            if moving.len() > 2 && draw.chance(0.5) {
                moving.remove(draw.index(3));
            }
            let backwards = draw.chance(0.4);
            let strokes = moving.iter().enumerate().map(|(number, axis)| {
                let [low, high] = inside(bench, *axis);
                let (from, to) = if backwards && number == 1 { (high, low) } else { (low, high) };
                Stroke { axis: *axis, from, to }
            });
            let shape = Shape::Line { strokes: strokes.collect(), back: true, overrun: 0.0, stations: None };
            Course { shape, moving, at, feed: draw.between(10.0, 40.0), runs: draw.count(2, 5) }
        }
        _ => line(bench, kind, at, draw),
    }
}

fn inside(bench: &Bench, axis: usize) -> [f64; 2] {
    let [low, high] = bench.travels[axis];
    let margin = 0.02 * (high - low);
    [(low + margin).round(), (high - margin).round()]
}

fn plane(bench: &Bench, kind: Kind, mut at: Vec<Vec<f64>>, draw: &mut Draw) -> Course {
    let slides = bench.slides();
    let (mut plane, mut others) = ([slides[0], slides[1]], slides.get(2).copied());
    if let Some(third) = others {
        let choices = [[slides[0], slides[1]], [slides[0], third], [slides[1], third]];
        plane = draw.weighted(&[(choices[0], 3.0), (choices[1], 1.0), (choices[2], 1.0)]);
        others = slides.iter().copied().find(|axis| !plane.contains(axis));
    }
    let (middle, radius) = round(bench, plane, draw);
    plane.into_iter().zip(middle).for_each(|(axis, place)| at[axis] = vec![place]);
    let runs = draw.count(2, 5);
    if let Some(other) = others.filter(|_| kind != Kind::Ballbar && draw.chance(0.3)) {
        at[other] = (0..runs)
            .map(|_| draw.between(inside(bench, other)[0], inside(bench, other)[1]).round())
            .collect();
    }
    let [first, second] = plane;
    let ranges = [inside(bench, first), inside(bench, second)];
    let overshoot = draw.pick(&[0.0, 0.2, 0.5]);
    let shape = match kind {
        Kind::Diamond => Shape::Diamond { plane, radius },
        Kind::Spiral => {
            Shape::Spiral { plane, inner: 0.15 * radius, outer: radius, turns: draw.between(3.0, 6.0) }
        }
        Kind::Grid => Shape::Grid {
            plane,
            from: [ranges[0][0], ranges[1][0]],
            to: [ranges[0][1], ranges[1][1]],
            lines: draw.count(4, 9),
        },
        _ => {
            let first = draw.chance(0.5);
            let both = vec![first, !first];
            Shape::Circle { plane, radius, start: draw.between(0.0, TAU), overshoot, counterclockwise: both }
        }
    };
    Course { shape, moving: plane.to_vec(), at, feed: draw.between(6.0, 40.0), runs }
}

fn line(bench: &Bench, kind: Kind, mut at: Vec<Vec<f64>>, draw: &mut Draw) -> Course {
    let slides = bench.slides();
    let axis = draw.pick(&slides);
    let [low, high] = inside(bench, axis);
    let length = high - low;
    let runs = match kind {
        Kind::Fast => 1,
        Kind::Slow => draw.count(1, 2),
        Kind::WarmUp => draw.count(5, 12),
        _ => draw.count(2, 5),
    };
    let feed = match kind {
        Kind::Fast => draw.between(10.0, 25.0),
        Kind::Slow => length / draw.between(1200.0, 3000.0),
        _ => draw.between(8.0, 50.0),
    };
    let (low, high) = match kind {
        Kind::Fast => (low, (low + feed * draw.between(3.0, 7.0)).min(high).round()),
        _ => (low, high),
    };
    if kind == Kind::Heights || draw.chance(0.15) && runs > 1 {
        for other in slides.iter().copied().filter(|other| *other != axis) {
            let [from, to] = inside(bench, other);
            at[other] = match draw.chance(0.7) {
                true => (0..runs)
                    .map(|run| (from + (to - from) * f64::from(run) / f64::from(runs - 1).max(1.0)).round())
                    .collect(),
                false => continue,
            };
        }
    }
    let stations = kind.stops().then(|| Stations {
        count: draw.count(11, 31),
        dwell: draw.between(2.0, 5.0),
        readings: draw.count(1, 2),
    });
    let overrun = if kind.stops() { 1.0 } else { 0.0 };
    let runs = if kind.stops() { draw.count(3, 5) } else { runs };
    let shape =
        Shape::Line { strokes: vec![Stroke { axis, from: low, to: high }], back: true, overrun, stations };
    Course { shape, moving: vec![axis], at, feed, runs }
}

/// One rotary axis, to and fro, alone.
fn turn(bench: &Bench, at: Vec<Vec<f64>>, draw: &mut Draw) -> Course {
    let axis = draw.pick(&bench.rotaries());
    let [low, high] = bench.travels[axis];
    let stations = draw.chance(0.2).then(|| Stations { count: draw.count(13, 37), dwell: 3.0, readings: 1 });
    let overrun = if stations.is_some() { 0.02 } else { 0.0 };
    let shape =
        Shape::Line { strokes: vec![Stroke { axis, from: low, to: high }], back: true, overrun, stations };
    Course { shape, moving: vec![axis], at, feed: draw.ratio(0.01, 0.3), runs: draw.count(2, 4) }
}

/// The direction in which the nominal tip moves with an axis: a unit vector without rounding.
fn along(bench: &Bench, axis: usize) -> [f64; 3] {
    let plant = Plant::perfect(&bench.compiled.machine, &bench.names, &bench.constants).unwrap();
    let mut moved = bench.home.clone();
    moved[axis] += 1.0;
    let way = plant.nominal(&moved).tip - plant.nominal(&bench.home).tip;
    [way.x.round(), way.y.round(), way.z.round()]
}

fn instrument(bench: &Bench, kind: Kind, moving: &[usize], draw: &mut Draw) -> Instrument {
    let sensitive = bench.sensitive();
    let axis = moving[0];
    let way = along(bench, axis);
    let unit = |direction: usize| {
        let mut unit = [0.0; 3];
        unit[direction] = 1.0;
        unit
    };
    let across: Vec<usize> =
        (0..3).filter(|direction| sensitive[*direction] && way[*direction] == 0.0).collect();
    let rotary = bench.names.axes[axis].rotary;
    match kind {
        Kind::Ballbar => {
            let mut eccentricity = [0.0; 3];
            for axis in moving {
                let size = draw.between(-0.014, 0.014);
                along(bench, *axis)
                    .iter()
                    .zip(&mut eccentricity)
                    .for_each(|(way, entry)| *entry += way * size);
            }
            Instrument::Ballbar {
                center: None,
                radius: None,
                eccentricity,
                offset: draw.between(-0.02, 0.02),
            }
        }
        Kind::Stations if draw.chance(0.7) && !rotary => {
            Instrument::Linear { axis, direction: way, cosine: 0.0 }
        }
        Kind::Straightness if !across.is_empty() => {
            Instrument::Straightness { axis, direction: unit(draw.pick(&across)) }
        }
        Kind::Angular => Instrument::Angular { axis: Some(axis), about: unit(draw.index(3)) },
        Kind::Probe if moving.len() == 2 => Instrument::Probe { normal: Normal::Radial(None) },
        Kind::Probe => {
            let seen: Vec<usize> = (0..3).filter(|direction| sensitive[*direction]).collect();
            Instrument::Probe { normal: Normal::Fixed(unit(draw.pick(&seen))) }
        }
        Kind::Rotary if draw.chance(0.7) || bench.slides().is_empty() => {
            Instrument::Position { directions: [false; 3], angles: vec![axis] }
        }
        _ => {
            let mut directions = sensitive;
            if moving.len() == 2 && draw.chance(0.5) || draw.chance(0.2) && !rotary {
                let ways: Vec<[f64; 3]> = moving.iter().map(|axis| along(bench, *axis)).collect();
                (0..3).for_each(|direction| {
                    directions[direction] &= ways.iter().any(|way| way[direction] != 0.0)
                });
            }
            Instrument::Position { directions, angles: Vec::new() }
        }
    }
}

/// Three sensors that rise together.
fn temperatures(duration: f64, draw: &mut Draw) -> Vec<Temperature> {
    let count = if draw.chance(0.75) { 3 } else { 2 };
    let names = ["scale", "motor", "ambient"];
    let mut sensors: Vec<Temperature> = Vec::new();
    for (number, name) in names.into_iter().take(count).enumerate() {
        let rise = [draw.between(4.0, 9.0), draw.between(8.0, 18.0), draw.between(1.0, 4.0)][number];
        let start = draw.between(19.5, 20.5);
        let swing = Swing {
            amplitude: draw.between(0.0, 0.4),
            period: draw.between(900.0, 4000.0),
            phase: draw.between(0.0, TAU),
        };
        sensors.push(Temperature {
            name: name.to_owned(),
            start,
            steps: vec![(0.0, start + rise)],
            time_constant: duration
                * [draw.between(0.3, 0.8), draw.between(0.15, 0.5), draw.between(0.4, 1.0)][number],
            swing: Some(swing),
            noise: Noise { resolution: 0.001, ..Noise::white(draw.between(0.005, 0.03)) },
        });
    }
    sensors
}

fn load(duration: f64, draw: &mut Draw) -> Load {
    let period = duration / draw.between(5.0, 30.0);
    let pulses = Pulses {
        height: draw.between(100.0, 600.0),
        period,
        width: period * draw.between(0.2, 0.7),
        start: 0.3 * period,
    };
    let swing =
        Swing { amplitude: draw.between(0.0, 60.0), period: duration / draw.between(3.0, 50.0), phase: 0.0 };
    Load {
        name: "tool".to_owned(),
        unit: "N".to_owned(),
        base: draw.between(0.0, 50.0),
        pulses: Some(pulses),
        swing: Some(swing),
        noise: Noise::white(2.0),
    }
}
