//! Where waves are looked for: the error motions along whose axis, or over time, a wave would show.
//!
//! In: the recordings, and how far their axes travel. Out: places, each once; of those at which the recordings show waves alike, the simplest.

use std::ops::Range;
use std::sync::Arc;

use crate::course::Course;
use crate::kinship;
use crate::model::{Effect, Place};
use crate::noise::Noise;
use crate::scene::Scene;
use crate::side::Side;
use crate::study::Study;
use crate::terms::Shape;
use crate::travel::Travel;

/// A place where waves are looked for; places at which the recordings show waves alike are looked at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WavePlace {
    pub(super) motion: usize,
    pub(super) side: Side,
    /// Whether along the motion's axis, in time, or both.
    pub(super) cyclic: bool,
    pub(super) vibration: bool,
}

impl WavePlace {
    /// The place of a wave of the machine.
    pub(crate) fn of(effect: &Effect) -> Option<Self> {
        let (motion, side) = (effect.motion()?, effect.side()?);
        let cyclic = matches!(effect.shape, Shape::Cyclic { .. });
        Some(Self { motion, side, cyclic, vibration: !cyclic })
    }
}

/// The places where waves can be looked for.
pub(crate) fn places(
    study: &Study<'_>,
    courses: &[Arc<Course>],
    noises: &[Vec<Noise>],
    travels: &[Travel],
) -> Vec<WavePlace> {
    let span =
        courses.iter().filter_map(|course| course.shown.given.time.last()).copied().fold(0.0, f64::max);
    let mut samples = Vec::new();
    for (motion, known) in study.equations.motions.iter().enumerate().filter(|(_, known)| !known.alignment) {
        let driven = known.axis.is_some_and(|axis| study.own[axis] == Some(motion) && study.has_drive(axis));
        let sides = [(Side::After, true), (Side::Drive, driven)];
        for side in sides.into_iter().filter(|(_, possible)| *possible).map(|(side, _)| side) {
            let place = Place::Motion { motion, side };
            let along = known.axis.filter(|axis| travels[*axis].moves);
            if let Some(axis) = along.filter(|axis| !travels[*axis].is_known_at_stations_alone()) {
                // Any period and any frequency tell which places are alike.
                let period = travels[axis].range() / 3.7;
                samples.push(Effect {
                    place,
                    shape: Shape::Cyclic { axis, period, order: 1, center: travels[axis].center() },
                });
            }
            // A wave in time of a motor of a beam is one of its slide.
            let in_time = !known.shares_beam() && along.is_none_or(|axis| !steadily(study, axis));
            if in_time && !in_steps(study, travels) {
                samples.push(Effect { place, shape: Shape::Vibration { frequency: 7.3 / span } });
            }
        }
    }
    let mut places: Vec<WavePlace> = Vec::new();
    for kin in kinship::groups(study, courses, noises, samples) {
        let (Some(motion), Some(side)) = (kin.effect.motion(), kin.effect.side()) else { continue };
        let cyclic = matches!(kin.effect.shape, Shape::Cyclic { .. });
        match places.iter_mut().find(|known| (known.motion, known.side) == (motion, side)) {
            Some(known) => {
                known.cyclic |= cyclic;
                known.vibration |= !cyclic;
            }
            None => places.push(WavePlace { motion, side, cyclic, vibration: !cyclic }),
        }
    }
    places
}

/// Whether an axis moves at one speed all the time, in all recordings: then time and place are the same, and so are waves in
/// both. Of the two names that of the place is told, and the other beside it.
fn steadily(study: &Study<'_>, axis: usize) -> bool {
    let speeds: Vec<f64> = study.scenes.iter().flat_map(|scene| speeds(scene, axis)).collect();
    let most = speeds.iter().fold(f64::NEG_INFINITY, |most, speed| most.max(*speed));
    let least = speeds.iter().fold(f64::INFINITY, |least, speed| least.min(*speed));
    least * most > 0.0 && (most - least) <= STEADY * (most + least).abs()
}

/// The mean speeds of an axis over tenths of each run.
fn speeds(scene: &Scene<'_>, axis: usize) -> Vec<f64> {
    let (time, position) = (&scene.given.time, &scene.given.programmed[axis]);
    let of_run = |rows: Range<usize>| {
        let far = (rows.len() / 10).max(1);
        let ends = rows.clone().step_by(far).zip(rows.clone().skip(far).step_by(far));
        ends.map(|(from, to)| (position[to] - position[from]) / (time[to] - time[from])).collect::<Vec<f64>>()
    };
    let runs = scene.recording.runs().into_iter();
    runs.flat_map(|(rows, _)| of_run(rows)).filter(|speed| speed.is_finite()).collect()
}

/// Whether rows are stations: between two of them an axis goes a good part of its travel, and rows are far apart; or where it is
/// between stations is not known. Such a table shows no vibration, whatever its times say.
fn in_steps(study: &Study<'_>, travels: &[Travel]) -> bool {
    let sparse = study.scenes.iter().all(Scene::sparse);
    let steps = |travel: &Travel| travel.moves && sparse && travel.step > STATION * travel.range();
    travels.iter().any(|travel| steps(travel) || travel.is_known_at_stations_alone())
}

/// The share of the travel from station to station: with fifty and more, rows are a slow log.
const STATION: f64 = 0.02;

/// Speeds that differ by less than this share shift no wave by more than a part of a turn.
const STEADY: f64 = 0.05;
