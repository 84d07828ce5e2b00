//! Effects that the calibration is not told of. In: a machine, a recording, random choices. Out: an effect of a plausible
//! shape, and ways to make it larger or smaller.

use std::f64::consts::TAU;

use model_dsl::calibration::{
    CalibratedTerm, Calibration, Curve, CurveNodes, CurveValues, MachineNames, SeriesInput,
};

use crate::bench::Bench;
use crate::draw::Draw;
use crate::scene::{Kind, Scene};

/// Something that was left out.
#[derive(Clone, Debug)]
pub(crate) enum Planted {
    /// A term of an error motion; whether the drive sees it.
    Term { motion: usize, term: CalibratedTerm, drive: bool },
    /// The clock of a recording is late by so much, s.
    Clock { scene: usize, offset: f64 },
    /// The beam of a recording is inclined, rad.
    Cosine { scene: usize, angle: f64 },
    /// A dent in a way that no smooth term describes.
    Dent { motion: usize, axis: usize, at: f64, width: f64, height: f64 },
}

/// The terms that can be planted, with how often.
pub(crate) const TERMS: [(&str, f64); 17] = [
    ("constant", 1.0),
    ("polynomial", 2.0),
    ("table", 1.2),
    ("backlash", 2.5),
    ("wind-up", 1.2),
    ("reversal-spike", 1.5),
    ("cyclic", 2.0),
    ("lag", 1.5),
    ("acceleration", 1.0),
    ("expansion", 1.5),
    ("growth", 1.5),
    ("drift", 1.2),
    ("vibration", 1.5),
    ("coupling", 1.2),
    ("compliance", 1.0),
    ("clock", 0.6),
    ("cosine", 0.6),
];

/// Whether a recording can show a term at all.
pub(crate) fn shows(bench: &Bench, scene: &Scene, term: &str) -> bool {
    let path = &scene.scenario.path;
    let stops = scene.stops();
    let feed = path.feed;
    match term {
        "constant" => scene.moving.len() > 1 || bench.slides().len() > 1 && !scene.angular(),
        "reversal-spike" => !stops && scene.rate > 8.0,
        "wind-up" => !stops && feed / scene.rate < 0.8,
        "cyclic" => stops || scene.rate > 0.4,
        "lag" => !stops && scene.kind != Kind::Slow,
        "clock" => !stops && !scene.angular() && !matches!(scene.kind, Kind::Slow | Kind::Ballbar),
        "acceleration" => {
            matches!(scene.kind, Kind::Circle | Kind::Ballbar | Kind::Spiral)
                || !stops && path.acceleration.is_some_and(|rise| feed / rise * scene.rate > 6.0)
        }
        "expansion" => !scene.scenario.temperatures.is_empty() && !scene.angular(),
        "growth" => !scene.scenario.temperatures.is_empty(),
        "drift" => scene.duration > 60.0,
        "vibration" => !stops && scene.rate > 5.0 || scene.kind == Kind::Slow,
        "coupling" => bench.slides().len() > 1,
        "compliance" => !scene.scenario.loads.is_empty(),
        "cosine" => matches!(scene.scenario.measurement.instrument, simulation::Instrument::Linear { .. }),
        _ => true,
    }
}

/// The number under which the first sensor of the recordings stands, and their names.
pub(crate) struct Sensors<'s> {
    pub(crate) calibration: &'s Calibration,
    pub(crate) names: Vec<String>,
}

/// An effect of a kind, of any size; its right size is found by simulating.
pub(crate) fn draw(
    bench: &Bench,
    scenes: &[Scene],
    sensors: &Sensors<'_>,
    term: &str,
    draw: &mut Draw,
) -> Option<Planted> {
    let number = draw.index(scenes.len());
    let scene = &scenes[number];
    let path = &scene.scenario.path;
    match term {
        "clock" => return Some(Planted::Clock { scene: number, offset: draw.either(0.01) }),
        "cosine" => return Some(Planted::Cosine { scene: number, angle: draw.either(0.002) }),
        _ => {}
    }
    let axis = draw.pick(&scene.moving);
    let [low, high] = bench.travels[axis];
    let rotary = bench.names.axes[axis].rotary;
    let own = bench.own(axis)?;
    let of_axis: Vec<usize> = bench
        .motions()
        .filter(|(_, motion)| motion.axis == Some(axis) && !motion.alignment)
        .map(|(number, _)| number)
        .collect();
    let any = draw.pick(&of_axis);
    let mostly_own = if draw.chance(0.75) { own } else { any };
    let sensor = |draw: &mut Draw| -> Option<usize> {
        let name =
            &sensors.names[draw.index(sensors.names.len().max(1)).min(sensors.names.len().checked_sub(1)?)];
        sensors.calibration.sensors.index(name)
    };
    let slow = scene.duration;
    let (motion, term) = match term {
        "constant" => {
            let alignments: Vec<usize> =
                bench.motions().filter(|(_, motion)| motion.alignment).map(|(number, _)| number).collect();
            if alignments.is_empty() {
                return None;
            }
            (draw.pick(&alignments), CalibratedTerm::Constant { value: draw.either(1e-5) })
        }
        "polynomial" => (
            any,
            CalibratedTerm::Polynomial {
                input: SeriesInput::Axis(axis),
                coefficients: powers(low, high, draw),
            },
        ),
        "table" => {
            let nodes = 7 + draw.index(6);
            let step = (high - low) / (nodes - 1) as f64;
            let values = CurveValues::Both(draw.curve(nodes, 1e-3));
            (
                any,
                CalibratedTerm::Table {
                    axis,
                    curve: Curve::new(CurveNodes::Uniform { start: low, step }, values),
                },
            )
        }
        "backlash" => (
            mostly_own,
            CalibratedTerm::Backlash {
                axis,
                lost_motion: if draw.chance(0.9) { 1e-3 } else { -1e-3 },
                wind_up: 0.0,
            },
        ),
        "wind-up" => {
            let wind_up = if rotary { draw.ratio(1e-3, 0.03) } else { draw.ratio(0.02, 2.0) };
            if path.feed / scene.rate > wind_up {
                return None;
            }
            (mostly_own, CalibratedTerm::Backlash { axis, lost_motion: 1e-3, wind_up })
        }
        "reversal-spike" => {
            let decay = draw.ratio(0.02, 0.3);
            if decay * scene.rate < 1.5 {
                return None;
            }
            (own, CalibratedTerm::ReversalSpike { axis, height: draw.either(1e-3), decay })
        }
        "cyclic" => {
            let period = if rotary {
                // What turns repeats in whole parts of a turn.
                TAU / (TAU / draw.ratio(0.01, 0.6)).round()
            } else {
                draw.pick(&[1.0, 2.0, 4.0, 5.0, 8.0, 10.0, 16.0, 20.0]) * draw.pick(&[1.0, 1.0, 0.93, 1.07])
            };
            let step = match scene.stops() {
                true => (high - low) / 20.0,
                false => path.feed / scene.rate,
            };
            if step > 0.4 * period {
                return None;
            }
            let phase = draw.between(-0.5 * TAU, 0.5 * TAU);
            (
                if draw.chance(0.8) { own } else { any },
                CalibratedTerm::Cyclic { axis, period, amplitude: 1e-3, phase },
            )
        }
        "lag" => (own, CalibratedTerm::Lag { axis, gain: draw.ratio(20.0, 150.0), frequency: 0.0 }),
        "acceleration" => (own, CalibratedTerm::Acceleration { axis, gain: draw.ratio(300.0, 5000.0) }),
        "expansion" => {
            let sensor = sensor(draw)?;
            (own, CalibratedTerm::Expansion { axis, sensor, coefficient: draw.either(1e-5), reference: 20.0 })
        }
        "growth" => {
            let time_constant = if draw.chance(0.4) { draw.ratio(100.0, 2000.0) } else { 0.0 };
            let sensor = sensor(draw)?;
            let angular = draw.chance(0.25);
            (
                motion(bench, angular, draw)?,
                CalibratedTerm::Growth {
                    sensor,
                    coefficient: draw.either(1e-3),
                    reference: 20.0,
                    time_constant,
                },
            )
        }
        "drift" => {
            let angular = draw.chance(0.25);
            (
                motion(bench, angular, draw)?,
                CalibratedTerm::Drift {
                    amplitude: draw.either(1e-3),
                    time_constant: slow * draw.between(0.1, 0.8),
                },
            )
        }
        "vibration" => {
            let highest = 0.4 * scene.rate;
            let frequency = draw.ratio((10.0 / slow).max(0.04 * scene.rate).min(highest), highest);
            let angular = draw.chance(0.15);
            (
                motion(bench, angular, draw)?,
                CalibratedTerm::Vibration { frequency, amplitude: 1e-3, phase: draw.between(-3.1, 3.1) },
            )
        }
        "coupling" => {
            let others: Vec<usize> = bench
                .motions()
                .filter(|(_, motion)| !motion.alignment && motion.axis.is_some_and(|of| of != axis))
                .map(|(number, _)| number)
                .collect();
            if others.is_empty() {
                return None;
            }
            let mut coefficients = vec![1.0 / (high - low)];
            if draw.chance(0.5) {
                coefficients.push(draw.either(1.0 / (high - low).powi(2)));
            }
            (draw.pick(&others), CalibratedTerm::Coupling { axis, coefficients })
        }
        "compliance" => {
            let load = scene.scenario.loads.first()?.name.clone();
            let angular = draw.chance(0.25);
            (
                motion(bench, angular, draw)?,
                CalibratedTerm::Compliance { load, coefficient: draw.either(1e-5) },
            )
        }
        "dent" => {
            let at = low + (high - low) * draw.between(0.2, 0.8);
            let width = (high - low) * draw.between(0.01, 0.03);
            return Some(Planted::Dent { motion: any, axis, at, width, height: draw.either(1e-3) });
        }
        _ => return None,
    };
    let drives = scenes.iter().all(|scene| scene.scenario.measurement.drives.contains(&axis));
    let friction = matches!(term, CalibratedTerm::Backlash { .. } | CalibratedTerm::ReversalSpike { .. });
    let drive = drives && friction && motion == own && draw.chance(0.5);
    Some(Planted::Term { motion, term, drive })
}

fn motion(bench: &Bench, angular: bool, draw: &mut Draw) -> Option<usize> {
    let fitting: Vec<usize> = bench
        .motions()
        .filter(|(_, motion)| motion.angular == angular && !motion.alignment)
        .map(|(number, _)| number)
        .collect();
    (!fitting.is_empty()).then(|| draw.pick(&fitting))
}

/// The coefficients of powers of the position of a polynomial that fills its range: a slope, or a bow of low order.
fn powers(low: f64, high: f64, draw: &mut Draw) -> Vec<f64> {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    if draw.chance(0.35) {
        return vec![0.0, draw.either(1.0 / half)];
    }
    let order = 2 + draw.index(2);
    // Horner's scheme with (q - middle) / half in place of q.
    let mut found = vec![0.0];
    for power in (0..=order).rev() {
        let mut next = vec![0.0; found.len() + 1];
        for (place, value) in found.iter().enumerate() {
            next[place + 1] += value / half;
            next[place] -= value * middle / half;
        }
        let own = if power == 0 {
            0.0
        } else {
            draw.between(-1.0, 1.0) + if power == order { draw.either(0.7) } else { 0.0 }
        };
        next[0] += own;
        found = next;
    }
    found.truncate(order + 1);
    found
}

fn series(coefficients: &[f64], at: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * at + coefficient)
}

impl Planted {
    /// Makes it larger by a factor.
    pub(crate) fn scale(&mut self, factor: f64) {
        match self {
            Self::Clock { offset, .. } => *offset *= factor,
            Self::Cosine { angle, .. } => *angle *= factor.sqrt(),
            Self::Dent { height, .. } => *height *= factor,
            Self::Term { term, .. } => scale(term, factor),
        }
    }

    /// Whether such a machine could stand in a shop.
    pub(crate) fn plausible(&self, bench: &Bench) -> bool {
        let size = |motion: &usize, value: f64| {
            value.abs() <= if bench.names.motions[*motion].angular { 1.5e-3 } else { 0.4 }
        };
        match self {
            Self::Clock { offset, .. } => offset.abs() < 0.3,
            Self::Cosine { angle, .. } => angle.abs() < 0.03,
            Self::Dent { motion, height, .. } => size(motion, *height),
            Self::Term { motion, term, .. } => match term {
                CalibratedTerm::Constant { value } => size(motion, *value),
                CalibratedTerm::Polynomial { input: SeriesInput::Axis(axis), coefficients } => {
                    let ends =
                        bench.travels[*axis].map(|end| series(coefficients, end) - series(coefficients, 0.0));
                    ends.iter().all(|end| size(motion, *end))
                }
                CalibratedTerm::Coupling { axis, coefficients } => {
                    bench.travels[*axis].iter().all(|end| size(motion, end * series(coefficients, *end)))
                }
                CalibratedTerm::Table { curve: Curve { values: CurveValues::Both(values), .. }, .. } => {
                    values.iter().all(|value| size(motion, *value))
                }
                CalibratedTerm::Backlash { lost_motion, .. } => size(motion, *lost_motion),
                CalibratedTerm::ReversalSpike { height, .. } => size(motion, *height),
                CalibratedTerm::Cyclic { amplitude, .. }
                | CalibratedTerm::Vibration { amplitude, .. }
                | CalibratedTerm::Drift { amplitude, .. } => size(motion, *amplitude),
                CalibratedTerm::Lag { gain, .. } => *gain > 8.0,
                CalibratedTerm::Expansion { coefficient, .. } => coefficient.abs() < 1e-3,
                CalibratedTerm::Growth { coefficient, .. } => size(motion, 10.0 * coefficient),
                CalibratedTerm::Compliance { coefficient, .. } => size(motion, 300.0 * coefficient),
                _ => true,
            },
        }
    }

    /// The error motion, or `instrument`, and the name of the term, as a diagnosis names them.
    pub(crate) fn name(&self, names: &MachineNames) -> (String, &'static str) {
        match self {
            Self::Term { motion, term, .. } => (names.motions[*motion].name.clone(), term.name()),
            Self::Clock { .. } => ("instrument".to_owned(), "clock"),
            Self::Cosine { .. } => ("instrument".to_owned(), "cosine"),
            Self::Dent { motion, .. } => (names.motions[*motion].name.clone(), "dent"),
        }
    }

    /// Its name in the tables.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Term { term: CalibratedTerm::Backlash { wind_up, .. }, .. } if *wind_up > 0.0 => "wind-up",
            Self::Term { term, .. } => term.name(),
            Self::Clock { .. } => "clock",
            Self::Cosine { .. } => "cosine",
            Self::Dent { .. } => "dent",
        }
    }
}

fn scale(term: &mut CalibratedTerm, factor: f64) {
    match term {
        CalibratedTerm::Lag { gain, .. } | CalibratedTerm::Acceleration { gain, .. } => *gain /= factor,
        CalibratedTerm::Delay { time, .. } => *time *= factor,
        linear => {
            let numbers = linear.linear_mut().into_iter().flat_map(|(_, numbers)| numbers);
            numbers.for_each(|number| *number *= factor);
        }
    }
}
