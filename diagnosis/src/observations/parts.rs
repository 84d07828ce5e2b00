//! Readings of parts. In: a recording of a part. Out: each reading beside where the calibration expects it, from which it is told how the
//! part lay.

use super::{Frame, along, each_frame};
use crate::channel::Kind;
use crate::course::Course;
use crate::model::Model;
use crate::recording::PartReading;
use crate::study::Study;

/// The readings of a part as the calibration and a model leave them, evenly from all rows: enough to tell how it lies.
pub(crate) fn part_readings(
    study: &Study<'_>,
    scene: usize,
    course: &Course,
    model: &Model,
) -> Vec<PartReading> {
    let known = &study.scenes[scene];
    let stride = known.rows().div_ceil(MOST_READINGS).max(1);
    let of_frame = |frame: &Frame<'_>| {
        let first = frame.first_row().next_multiple_of(stride) - frame.first_row();
        let mut readings = Vec::new();
        for (number, channel) in known.channels.iter().enumerate() {
            let left = frame.left(study, scene, (number, channel), model);
            for row in (first..frame.len()).step_by(stride) {
                let direction = match channel.kind {
                    Kind::Tip(d) => along(d),
                    Kind::Normal => frame.normal(study, scene, row),
                    _ => continue,
                };
                readings.push(PartReading { direction, place: frame.tip(row), deviation: left[row] });
            }
        }
        readings
    };
    let mut all = Vec::new();
    each_frame(study, scene, model, course, of_frame, |_, readings| all.extend(readings));
    all
}

/// The most rows that are looked at to tell how a part lies: its three angles are known from some dozen, and more only cost time.
const MOST_READINGS: usize = 10_000;
