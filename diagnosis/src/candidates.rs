//! Candidates: every term of every error motion that the recordings could show.
//!
//! In: the study. Out: effects, from the machine itself: each error motion, with each term whose state was recorded.
//! Terms with a parameter that is not linear stand on a grid; periods and frequencies are searched for elsewhere.

use crate::answers::answers;
use crate::channel::Kind;
use crate::model::{Effect, Place};
use crate::ranges::shortest_step;
use crate::scene::Scene;
use crate::side::Side;
use crate::study::Study;
use crate::terms::{REFERENCE_TEMPERATURE, Setting, Shape};
use crate::travel::Travel;

/// The highest power of a polynomial along an axis.
const HIGHEST_POWER: usize = 3;
/// The highest power of a coupling.
const HIGHEST_COUPLING: usize = 2;

/// Settings of the instruments that are fitted whatever else is.
pub(crate) fn always(study: &Study<'_>) -> Vec<Effect> {
    let mut effects = Vec::new();
    for (number, scene) in study.scenes.iter().enumerate() {
        for (channel, known) in scene.channels.iter().enumerate() {
            if matches!(known.kind, Kind::Radius { .. }) {
                effects.push(Effect::setting(number, Setting::Radius));
                let directions = (0..3).filter(|direction| scene.leans[*direction]);
                effects.extend(
                    directions.map(|direction| Effect::setting(number, Setting::Eccentricity { direction })),
                );
            } else {
                effects.push(Effect::setting(number, Setting::Offset { channel }));
            }
        }
        effects.extend(datum(scene).map(|setting| Effect::setting(number, setting)));
    }
    effects
}

/// How the part of a recording lies, where that is free, beside the zeros of its channels: each that a recording shows.
fn datum<'s>(scene: &'s Scene<'_>) -> impl Iterator<Item = Setting> + 's {
    scene.pose.iter().flat_map(|pose| {
        let along = (0..3).filter(|direction| pose.displacements[*direction]);
        let about = (0..3).filter(|direction| pose.rotations[*direction]);
        let along = along.filter(|_| scene.is_probed()).map(|direction| Setting::Displacement { direction });
        along.chain(about.map(|direction| Setting::Rotation { direction }))
    })
}

/// All candidates but waves, in order of simplicity.
pub(crate) fn candidates(study: &Study<'_>, travels: &[Travel]) -> Vec<Effect> {
    let grids = Grids::new(study);
    let outside = study.scenes.iter().flat_map(|scene| &scene.channels).any(|channel| channel.kind.outside());
    let answers = answers(study);
    let answered = |axis: Option<usize>, shape: &Shape| {
        let Shape::Compliance { load } = *shape else { return false };
        answers.iter().any(|answer| Some(answer.axis) == axis && answer.load == load)
    };
    let mut effects = settings(study);
    for (motion, known) in study.equations.motions.iter().enumerate() {
        for shape in shapes(study, motion, travels, &grids) {
            let own = known.axis.is_some_and(|axis| study.own[axis] == Some(motion));
            let drive = own && known.axis.is_some_and(|axis| study.has_drive(axis));
            let lag = matches!(shape, Shape::Lag { .. });
            if (drive && !answered(known.axis, &shape)) || (own && lag) {
                let side = at_drive(known.axis, &shape);
                effects.push(Effect { place: Place::Motion { motion, side }, shape: shape.clone() });
            }
            if outside && !lag {
                effects.push(Effect { place: Place::Motion { motion, side: Side::After }, shape });
            }
        }
    }
    effects
}

/// Where a term acts on the drive's side. A load has to move the drive against its position loop, and never acts at once.
fn at_drive(axis: Option<usize>, shape: &Shape) -> Side {
    match (axis, shape) {
        (Some(axis), Shape::Compliance { .. }) => Side::Loop { axis },
        _ => Side::Drive,
    }
}

fn settings(study: &Study<'_>) -> Vec<Effect> {
    let both =
        |recording| [Setting::Clock, Setting::Cosine].map(|setting| Effect::setting(recording, setting));
    (0..study.scenes.len()).flat_map(both).collect()
}

/// Values of the parameters that are not linear.
struct Grids {
    /// The typical step between rows, s.
    step: f64,
    filters: Vec<f64>,
    drifts: Vec<f64>,
}

impl Grids {
    fn new(study: &Study<'_>) -> Self {
        let step = shortest_step(study);
        let span =
            study.scenes.iter().filter_map(|scene| scene.recording.time.last()).copied().fold(0.0, f64::max);
        Self {
            step,
            filters: geometric((4.0 * step).max(span / 60.0), 0.7 * span, 2.0),
            drifts: geometric((10.0 * step).max(span / 60.0), 3.0 * span, 2.5),
        }
    }
}

/// From `low` to at most `high` by a factor.
pub(crate) fn geometric(low: f64, high: f64, factor: f64) -> Vec<f64> {
    if !(low > 0.0 && high >= low) {
        return Vec::new();
    }
    std::iter::successors(Some(low), |value| Some(value * factor))
        .take_while(|value| *value <= high)
        .collect()
}

/// The terms of one error motion, simplest first.
fn shapes(study: &Study<'_>, motion: usize, travels: &[Travel], grids: &Grids) -> Vec<Shape> {
    let known = &study.equations.motions[motion];
    let mut shapes = vec![Shape::Constant];
    let moving = known.axis.filter(|axis| travels[*axis].moves && !known.alignment);
    if let Some(axis) = moving {
        shapes.extend(along(study, motion, axis, &travels[axis], grids));
    }
    for (axis, travel) in travels.iter().enumerate() {
        // Where a motor stands is told by its axes, and what is wrong with it is its own.
        let other = study.equations.programs(axis) && known.by_motor.is_empty();
        if travel.moves && other && known.axis != Some(axis) && !known.alignment {
            let scale = travel.low.abs().max(travel.high.abs());
            shapes.extend((1..=HIGHEST_COUPLING).map(|degree| Shape::Coupling { axis, degree, scale }));
        }
    }
    for sensor in recorded(study) {
        let reference = REFERENCE_TEMPERATURE;
        if !known.alignment {
            let (center, scale) = warmth(study, sensor);
            shapes.push(Shape::SensorPolynomial { sensor, degree: 2, center, scale });
        }
        shapes.push(Shape::Growth { sensor, reference, time_constant: 0.0 });
        shapes.extend(grids.filters.iter().map(|time_constant| Shape::Growth {
            sensor,
            reference,
            time_constant: *time_constant,
        }));
        if let Some(axis) = moving {
            shapes.push(Shape::Expansion { axis, sensor, reference });
        }
    }
    shapes.extend(grids.drifts.iter().map(|time_constant| Shape::Drift { time_constant: *time_constant }));
    if !known.alignment {
        shapes.extend((0..study.loads.len()).map(|load| Shape::Compliance { load }));
    }
    shapes
}

/// Terms of the motion's own axis.
fn along(study: &Study<'_>, motion: usize, axis: usize, travel: &Travel, grids: &Grids) -> Vec<Shape> {
    let mut shapes = Vec::new();
    if study.own[axis] == Some(motion) && study.equations.programs(axis) {
        shapes.push(Shape::Lag { axis, inertia: 0.0 });
    }
    let (center, scale) = ((travel.low + travel.high) / 2.0, travel.range() / 2.0);
    if travel.turns {
        shapes.push(Shape::Backlash { axis, wind_up: 0.0 });
    }
    // What is smooth along a beam is told of its slide. Its two motors could say the same in other names, and would then share what one
    // table tells.
    let powers = if study.equations.motions[motion].shares_beam() { 0 } else { HIGHEST_POWER };
    shapes.extend((1..=powers).map(|degree| Shape::Polynomial { axis, degree, center, scale }));
    shapes.push(Shape::Acceleration { axis });
    shapes.extend(wind_ups(axis, travel));
    let decays = geometric(0.7 * grids.step, 0.25 * travel.between, 2.0);
    shapes.extend(decays.into_iter().map(|decay| Shape::ReversalSpike { axis, decay }));
    shapes
}

/// Forms of a term with more parameters, of which the first ones mean the same.
pub(crate) fn richer(shape: &Shape, travels: &[Travel]) -> Vec<Shape> {
    match *shape {
        Shape::Polynomial { axis, degree, center, scale } => (degree + 1..=HIGHEST_POWER)
            .map(|degree| Shape::Polynomial { axis, degree, center, scale })
            .collect(),
        Shape::SensorPolynomial { sensor, degree, center, scale } => {
            vec![Shape::SensorPolynomial { sensor, degree: degree + 1, center, scale }]
        }
        Shape::Coupling { axis, degree, scale } => {
            (degree + 1..=HIGHEST_COUPLING).map(|degree| Shape::Coupling { axis, degree, scale }).collect()
        }
        Shape::Backlash { axis, wind_up: 0.0 } => wind_ups(axis, &travels[axis]),
        _ => Vec::new(),
    }
}

/// Plays that are taken up over part of the travel.
fn wind_ups(axis: usize, travel: &Travel) -> Vec<Shape> {
    if !travel.turns {
        return Vec::new();
    }
    let wind_ups = geometric(3.0 * travel.step, 0.4 * travel.range(), 2.0);
    wind_ups.into_iter().map(|wind_up| Shape::Backlash { axis, wind_up }).collect()
}

/// The middle and the half range of what a sensor read over all recordings, degC.
fn warmth(study: &Study<'_>, sensor: usize) -> (f64, f64) {
    let known = study
        .scenes
        .iter()
        .flat_map(|scene| &scene.given.temperatures[sensor])
        .filter(|value| value.is_finite());
    let (low, high) =
        known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| (low.min(*t), high.max(*t)));
    ((low + high) / 2.0, ((high - low) / 2.0).max(1e-3))
}

/// The sensors of which there are samples in every recording.
pub(crate) fn recorded(study: &Study<'_>) -> Vec<usize> {
    let known = |sensor: &usize| {
        study
            .scenes
            .iter()
            .all(|scene| scene.given.temperatures[*sensor].iter().any(|value| value.is_finite()))
    };
    (0..study.sensors.len()).filter(known).collect()
}

/// How much a term must bring beyond its parameters to stand before a simpler one: in units of minus twice the
/// log-likelihood. It decides between names for what the data cannot tell apart.
pub(crate) fn simplicity(study: &Study<'_>, effect: &Effect) -> f64 {
    let shape = match effect.shape.core() {
        Shape::Constant | Shape::Lag { .. } => 0.0,
        Shape::Backlash { wind_up, .. } => {
            if *wind_up > 0.0 {
                1.5
            } else {
                0.0
            }
        }
        Shape::Polynomial { .. } => 1.0,
        Shape::Expansion { .. } | Shape::Compliance { .. } | Shape::Cyclic { .. } => 1.0,
        Shape::Growth { .. } | Shape::Vibration { .. } => 1.5,
        Shape::Instrument(_) => 1.2,
        Shape::Acceleration { .. } | Shape::ReversalSpike { .. } => 2.0,
        Shape::Coupling { .. } => 2.5,
        // The path of a wandering sensor looks like a settling more often than like anything else.
        Shape::Drift { .. } => 15.0,
        Shape::SensorPolynomial { .. } => 10.0,
        Shape::Table { .. } => 4.0,
        Shape::Delay { .. } => 1.0,
        Shape::Step { .. } => 2.0,
        // Factors of factors there are none.
        Shape::Times { .. } => 0.0,
    };
    let shape = shape + FACTOR * effect.shape.factors().len() as f64;
    let rests = matches!(
        effect.shape,
        Shape::Lag { .. } | Shape::Acceleration { .. } | Shape::Instrument(Setting::Clock)
    );
    let sparse = rests && study.scenes.iter().all(|scene| scene.sparse());
    let shape = if sparse { shape + UNSEEN_MOTION } else { shape };
    shape + effect.motion().map_or(0.0, |motion| place(study, motion, &effect.shape))
}

/// The price of each factor. The cost is a deviance, so half of it is a logarithm of odds: with one more factor a form is e times less
/// likely before any data are seen.
const FACTOR: f64 = 2.0;

/// What a term that needs the motion between rows must bring beyond others where rows are far apart: the axes may well be at
/// rest in every row.
const UNSEEN_MOTION: f64 = 8.0;

/// A motion in the axis's own direction or a constant squareness is the first to be thought of, an angle the last.
fn place(study: &Study<'_>, motion: usize, shape: &Shape) -> f64 {
    let known = &study.equations.motions[motion];
    match shape {
        Shape::Constant | Shape::Step { .. } if known.alignment => 0.0,
        _ if known.alignment => 0.8,
        _ if study.own.contains(&Some(motion)) => 0.0,
        _ if known.angular => 0.6,
        _ => 0.3,
    }
}
