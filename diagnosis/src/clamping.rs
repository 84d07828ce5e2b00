//! The position and the rotation of measured parts.
//!
//! In: a scene of points at rest, and what was found of the machine. Out: how the part lies there, where that is free; and the rotation
//! because of which its datum is taken as free, if the recording has no `datum`. It exists because a part that was clamped anew stands at an angle of its own,
//! which looks like an error of the machine that made it: in one clamping the two cannot be told apart.

use crate::course::Course;
use crate::model::{Model, Place};
use crate::observations::part_readings;
use crate::recording::{Instrument, PartDatum, PartPose, Turned, turned};
use crate::study::Study;

/// A rotation must explain at least this share of what an effect stands for. A rotation alone explains all of it; over a square part it
/// explains half of a squareness. This is half way between.
const LEAST_SHARE: f64 = 0.75;

/// How the part of a scene lies where that is free.
pub(crate) fn pose(study: &Study<'_>, number: usize, course: &Course) -> Option<PartPose> {
    let scene = &study.scenes[number];
    let is_free = scene.recording.datum == PartDatum::Free || scene.turned.is_some();
    is_free.then(|| PartPose::of(&part_readings(study, number, course, &Model::default()), scene.is_probed()))
}

/// The rotation that readings show as they are, where their recording says nothing of one.
pub(crate) fn turned_as_read(study: &Study<'_>, number: usize, course: &Course) -> Option<Turned> {
    if !may_be_turned(study, number) {
        return None;
    }
    turned(&part_readings(study, number, course, &Model::default()))
}

/// The rotations that effects of a model stand for, each by the number of its scene: beside all that was found but one effect, the part
/// shows a rotation, and little else. This finds a rotation that larger effects hide in the raw readings.
pub(crate) fn turned_as_found(study: &Study<'_>, model: &Model) -> Vec<(usize, Turned)> {
    let of_scene = |number: usize| {
        let mut rests = rests(study, model).into_iter();
        let found = rests.find_map(|rest| {
            let course = Course::new(study, number, &rest);
            turned(&part_readings(study, number, &course, &rest)).filter(|turned| turned.share > LEAST_SHARE)
        });
        Some((number, found?))
    };
    (0..study.scenes.len()).filter(|number| may_be_turned(study, *number)).filter_map(of_scene).collect()
}

/// The model without each of the effects that can move a point across its axis, and without all of them.
fn rests(study: &Study<'_>, model: &Model) -> Vec<Model> {
    let is_across = |number: &usize| match model.effects[*number].effect.place {
        Place::Motion { motion, .. } => !study.own.contains(&Some(motion)),
        Place::Instrument { .. } => false,
    };
    let across: Vec<usize> = model.chosen_numbers().filter(is_across).collect();
    let each = across.iter().map(|number| model.without(*number));
    let all = (across.len() > 1).then(|| model.without_all(&across));
    each.chain(all).collect()
}

/// Whether a rotation of the part is looked for: its recording has no `datum`, and its points are separate stations.
fn may_be_turned(study: &Study<'_>, number: usize) -> bool {
    let scene = &study.scenes[number];
    let is_unsaid = scene.recording.datum == PartDatum::Unsaid && scene.pose.is_none();
    is_unsaid && scene.recording.instrument == Instrument::Position && scene.sparse()
}
