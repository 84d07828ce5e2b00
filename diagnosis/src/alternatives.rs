//! Alternatives: what else would explain the same.
//!
//! In: a fitted model and all candidates. Out: for each effect the names that could stand in its place without the data
//! becoming clearly less likely, all other effects fitted again: the null space of the joint design, and its surroundings as
//! far as the noise hides the difference. A clock is also held against loops on all axes at once.

use model_dsl::calibration::Factor;

use crate::candidates::simplicity;
use crate::design::{Design, Regressor};
use crate::engine::Found;
use crate::kinship::Kin;
use crate::model::{Effect, Model, Place};
use crate::search::rivals;
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::{Setting, Shape};
use crate::weights::Weights;

/// By how much minus twice the log-likelihood may rise for another name still to be possible: odds of one to twenty.
const HIDDEN: f64 = 6.0;

/// For each chosen effect of the model: other effects that could stand in its place, simplest first.
pub(crate) fn find(study: &Study<'_>, found: &Found) -> Vec<Vec<Effect>> {
    let model = &found.fit.model;
    let weights = &found.appraisal.weights;
    let others = others(study, found);
    let design = joint(study, model, weights, &others);
    let (products, samples) = design.fitted();
    let mut swept = Swept::new(&products);
    for column in (0..model.effects.len()).flat_map(|number| design.columns(number)) {
        swept.take(column);
    }
    let scale = (swept.remaining() / samples.max(1.0)).max(f64::MIN_POSITIVE);
    let columns = |number: usize| design.columns(number).collect::<Vec<usize>>();
    model
        .chosen_numbers()
        .map(|number| {
            let worth = swept.worth(&columns(number)) / scale;
            let mut without = swept.clone();
            columns(number).into_iter().for_each(|column| without.drop(column));
            let stands_in = |other: usize| {
                let (gain, _) = without.promise(&columns(model.effects.len() + other));
                worth - gain / scale < HIDDEN
            };
            let mut names = same_place(&model.effects[number].effect, &others);
            names.extend(all_loops(study, &design, &without, model, number, worth - HIDDEN, scale));
            names.extend(
                (0..others.len()).filter(|other| stands_in(*other)).flat_map(|other| all(&others[other])),
            );
            let kept = model.chosen();
            names.retain(|name| {
                !rivals(name, &model.effects[number].effect)
                    && !kept.iter().any(|fitted| rivals(&fitted.effect, name))
            });
            names.sort_by(|a, b| simplicity(study, a).total_cmp(&simplicity(study, b)));
            names
        })
        .collect()
}

/// Loops on all axes, where together they could stand in for a clock that brings `worth`.
fn all_loops(
    study: &Study<'_>,
    design: &Design,
    without: &Swept,
    model: &Model,
    number: usize,
    worth: f64,
    scale: f64,
) -> Vec<Effect> {
    if model.effects[number].effect.shape != Shape::Instrument(Setting::Clock) {
        return Vec::new();
    }
    let is_loop = |other: &usize| matches!(design.regressors[*other].effect.shape, Shape::Lag { .. });
    let loops: Vec<usize> = (model.effects.len()..design.regressors.len()).filter(is_loop).collect();
    let columns: Vec<usize> = loops.iter().flat_map(|other| design.columns(*other)).collect();
    let (gain, _) = without.promise(&columns);
    let stand_in = loops.len() > 1 && gain / scale > worth && study.own.iter().flatten().count() > 1;
    let effects = loops.into_iter().map(|other| design.regressors[other].effect.clone());
    if stand_in { effects.collect() } else { Vec::new() }
}

fn all(kin: &Kin) -> Vec<Effect> {
    std::iter::once(kin.effect.clone()).chain(kin.equals.iter().cloned()).collect()
}

/// The effects that the recordings show exactly alike, from the group that the effect came from.
fn same_place(effect: &Effect, others: &[Kin]) -> Vec<Effect> {
    others.iter().map(all).filter(|group| group.contains(effect)).flatten().collect()
}

/// All candidates, and the effects of the model at all other motions where they could be.
fn others(study: &Study<'_>, found: &Found) -> Vec<Kin> {
    let kept = || found.fit.model.chosen().iter().map(|fitted| &fitted.effect);
    let turned = kept().flat_map(|effect| other_guise(study, effect));
    let moved = kept().flat_map(|effect| elsewhere(study, effect)).chain(turned);
    let moved = moved.map(|effect| Kin { effect, equals: Vec::new() });
    found.pool.iter().cloned().chain(moved).collect()
}

/// A wave, a filtered temperature or a composed form, which the candidates do not hold in this form, at the other motions that could
/// have it.
fn elsewhere(study: &Study<'_>, effect: &Effect) -> Vec<Effect> {
    let shape = &effect.shape;
    let is_of_its_own = shape.nonlinear().is_some() || shape.is_composed();
    let (Some(motion), Some(side), true) = (effect.motion(), effect.side(), is_of_its_own) else {
        return Vec::new();
    };
    let motions = study.equations.motions.iter().enumerate().filter(|(number, _)| *number != motion);
    let possible = motions.filter(|(_, known)| match effect.shape.axis() {
        Some(axis) => known.axis == Some(axis) && !known.alignment,
        // A squareness may change with temperature and time, but does not oscillate.
        None => !known.alignment || !matches!(effect.shape, Shape::Vibration { .. }),
    });
    possible
        .map(|(motion, _)| Effect { place: Place::Motion { motion, side }, shape: effect.shape.clone() })
        .collect()
}

/// A wave in time as waves along the axes that it may be, and a wave along an axis as one in time: at a constant speed they are
/// the same.
fn other_guise(study: &Study<'_>, effect: &Effect) -> Vec<Effect> {
    let as_vibration = |(axis, period): (usize, f64)| {
        Some((axis, Shape::Vibration { frequency: speed(study, axis)? / period }))
    };
    let shapes: Vec<(usize, Shape)> = match effect.shape {
        Shape::Vibration { frequency } => {
            let axes = (0..study.own.len()).filter_map(|axis| Some((axis, speed(study, axis)?)));
            axes.map(|(axis, speed)| {
                (axis, Shape::Cyclic { axis, period: speed / frequency, order: 1, center: 0.0 })
            })
            .collect()
        }
        ref shape => shape.wave_along().and_then(as_vibration).into_iter().collect(),
    };
    let at_home = |axis: usize| {
        effect.motion().is_some_and(|motion| study.equations.motions[motion].axis == Some(axis))
    };
    let here = shapes.into_iter().filter(|(axis, _)| at_home(*axis));
    here.map(|(_, shape)| Effect { place: effect.place, shape }).collect()
}

/// The speed of an axis while it moves, mm/s or rad/s: the way over the time of the strides in which it moves at more than half
/// of its greatest speed. `None` where it stands.
fn speed(study: &Study<'_>, axis: usize) -> Option<f64> {
    let steps = || {
        study.scenes.iter().flat_map(|scene| {
            let (run, rows) = (&scene.recording.run, scene.recording.run.len());
            let far = (rows / STRIDES).max(1);
            let (time, programmed) = (&scene.given.time, &scene.given.programmed[axis]);
            (0..rows.saturating_sub(far))
                .step_by(far)
                .map(move |row| (row, row + far))
                .filter(|(from, to)| run[*from] == run[*to])
                .map(|(from, to)| (time[to] - time[from], (programmed[to] - programmed[from]).abs()))
                .filter(|(time, way)| *time > 0.0 && way.is_finite())
        })
    };
    let fastest = steps().map(|(time, way)| way / time).fold(0.0, f64::max);
    let moving = steps().filter(|(time, way)| *way > 0.5 * fastest * time);
    let (time, way) = moving.fold((0.0, 0.0), |(all, far), (time, way)| (all + time, far + way));
    (time > 0.0 && way > 0.0).then(|| way / time)
}

/// The number of strides in which a recording is walked through: single rows may be read unevenly.
const STRIDES: usize = 400;

/// The design of the model and of everything that could stand in for it, the present model's response restored.
fn joint(study: &Study<'_>, model: &Model, weights: &Weights, others: &[Kin]) -> Design {
    let mut regressors = Regressor::all(&model.effects);
    regressors.extend(others.iter().map(|kin| Regressor::of(kin.effect.clone())));
    let mut design = Design::new(study, model, weights, regressors);
    design.rebase(&model.effects);
    design
}

/// The measurement that would tell two names apart.
pub(crate) fn separate_by(study: &Study<'_>, this: &Effect, other: &Effect) -> String {
    let letter = |axis: usize| study.equations.axes[axis].letter.clone();
    match (&this.shape, &other.shape) {
        (Shape::Instrument(Setting::Clock), _) | (_, Shape::Instrument(Setting::Clock)) => {
            "record the drive's feedback on the instrument's clock, or start and stop abruptly: a loop needs time to follow, a \
             clock does not"
                .to_owned()
        }
        (Shape::Instrument(Setting::Cosine), _) | (_, Shape::Instrument(Setting::Cosine)) => {
            "align the beam again and repeat: a cosine error changes, a scale error does not".to_owned()
        }
        (Shape::Instrument(_), _) | (_, Shape::Instrument(_)) => {
            "set up the instrument again at another place and repeat: errors of the machine do not change".to_owned()
        }
        (Shape::Lag { axis: a, .. }, Shape::Lag { axis: b, .. }) if a != b => {
            format!("a straight line along {} alone", letter(*a))
        }
        _ => by_lever(study, this, other).unwrap_or_else(|| by_state(study, this, other)),
    }
}

/// Different lever arms are told apart where the lever changes.
fn by_lever(study: &Study<'_>, this: &Effect, other: &Effect) -> Option<String> {
    let (a, b) = (this.motion()?, other.motion()?);
    if a == b {
        return None;
    }
    let [first, second] = [a, b].map(|motion| {
        let arms = model_dsl::algebra::Axis::ALL.map(|direction| study.equations.arm(direction, motion));
        let seen: Vec<&str> = ["X", "Y", "Z"]
            .into_iter()
            .zip(&arms)
            .filter(|(_, arm)| !arm.is_zero())
            .map(|(name, _)| name)
            .collect();
        (arms.clone(), seen)
    });
    if first.0 == second.0 {
        let states = states_of(study, this, other);
        return Some(format!(
            "vary {states} separately: at the tool tip alone, the two have the same lever arms"
        ));
    }
    let names = [&first, &second].map(|(arms, _)| positions(arms));
    let differing: Vec<String> = names[0]
        .iter()
        .chain(&names[1])
        .filter(|name| !(names[0].contains(name) && names[1].contains(name)))
        .map(|name| name.to_uppercase())
        .collect();
    if let Some(axis) = differing.first() {
        return Some(format!("the same path at another {axis}: the lever arms change differently"));
    }
    if first.1 != second.1 {
        let only: Vec<&str> = first
            .1
            .iter()
            .chain(&second.1)
            .copied()
            .filter(|d| !(first.1.contains(d) && second.1.contains(d)))
            .collect();
        if let Some(direction) = only.first() {
            return Some(format!("also measure direction {direction}, which only one of them affects"));
        }
    }
    Some("the same path with a tool of another length or at another place of the table".to_owned())
}

/// The axis positions in lever arms.
fn positions(arms: &[model_dsl::algebra::Polynomial; 3]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for symbol in arms.iter().flat_map(|arm| arm.symbols()) {
        if let model_dsl::algebra::Symbol::Position(name) = symbol
            && !names.iter().any(|known| **known == *name.to_string())
        {
            names.push(name.to_string());
        }
    }
    names
}

fn by_state(study: &Study<'_>, this: &Effect, other: &Effect) -> String {
    format!("a recording in which {} do not change together", states_of(study, this, other))
}

fn states_of(study: &Study<'_>, this: &Effect, other: &Effect) -> String {
    let [a, b] = [this, other].map(|effect| state(study, effect));
    if a == b { format!("{a} of the two links") } else { format!("{a} and {b}") }
}

/// The state that a factor is, in words.
pub(crate) fn factor_state(study: &Study<'_>, factor: &Factor<usize>) -> String {
    let of = |axis: usize| study.equations.axes[axis].letter.to_lowercase();
    match *factor {
        Factor::Position { axis, .. } | Factor::Turn { axis, .. } | Factor::Curve { axis, .. } => {
            format!("the position of {}", of(axis))
        }
        Factor::Direction { axis } => format!("the direction of {}", of(axis)),
        Factor::Velocity { axis, .. } => format!("the velocity of {}", of(axis)),
        Factor::Speed { axis, .. } | Factor::Fading { axis, .. } => format!("the speed of {}", of(axis)),
        Factor::Acceleration { axis, .. } => format!("the acceleration of {}", of(axis)),
        Factor::Temperature { sensor, .. } | Factor::Play { sensor, .. } => {
            format!("temperature {}", study.sensors[sensor])
        }
        Factor::Warmth { axis, .. } => format!("the heat from the motion of {}", of(axis)),
        Factor::Load { load, .. } | Factor::Half { load, .. } | Factor::Spin { load, .. } => {
            format!("load {}", study.loads[load].0)
        }
        Factor::After { .. } => "time".to_owned(),
    }
}

/// `a`, `a and b`, `a, b and c`.
pub(crate) fn listed(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [alone] => alone.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The state that an effect depends on, in words.
pub(crate) fn state(study: &Study<'_>, effect: &Effect) -> String {
    let of = |axis: usize| study.equations.axes[axis].letter.to_lowercase();
    match &effect.shape {
        Shape::Constant => match effect.motion().and_then(|motion| study.equations.motions[motion].axis) {
            Some(axis) => format!("the travel of {}", of(axis)),
            None => "the set-up".to_owned(),
        },
        Shape::Polynomial { axis, .. } | Shape::Table { axis, .. } | Shape::Cyclic { axis, .. } => {
            format!("the position of {}", of(*axis))
        }
        Shape::Coupling { axis, .. } => format!("the position of {}", of(*axis)),
        Shape::Backlash { axis, .. } => format!("the direction of {}", of(*axis)),
        Shape::ReversalSpike { axis, .. } => format!("the time since the last reversal of {}", of(*axis)),
        Shape::Lag { axis, .. } => format!("the velocity of {}", of(*axis)),
        Shape::Acceleration { axis } => format!("the acceleration of {}", of(*axis)),
        Shape::Expansion { sensor, .. }
        | Shape::Growth { sensor, .. }
        | Shape::SensorPolynomial { sensor, .. } => {
            format!("temperature {}", study.sensors[*sensor])
        }
        Shape::Drift { .. } | Shape::Vibration { .. } => "time".to_owned(),
        Shape::Compliance { load } => format!("load {}", study.loads[*load].0),
        Shape::Delay { axis, .. } => format!("the velocity of {}", of(*axis)),
        Shape::Step { .. } => "time".to_owned(),
        Shape::Times { core, factors } => {
            let factors = factors.iter().map(|factor| factor_state(study, factor));
            let core = match **core {
                Shape::Constant => None,
                _ => Some(state(study, &Effect { place: effect.place, shape: (**core).clone() })),
            };
            listed(&core.into_iter().chain(factors).collect::<Vec<_>>())
        }
        Shape::Instrument(setting) => format!("the instrument's {}", setting.name()),
    }
}
