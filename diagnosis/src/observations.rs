//! Observations: what a model predicts for each channel, and how each channel sees each effect.
//!
//! In: the states in a stretch of rows and a model. Out: the residual of every channel, and for every error motion its
//! gain there: the lever arm in the observed direction. A regressor is gain times term. The position behind a loop and what
//! the calibration says are taken exactly; error motions of the model act to first order, as in the compensation.

mod parts;
mod passage;
mod settings;

use std::ops::Range;

use model_dsl::program::Column;

use crate::channel::{Channel, Kind};
use crate::course::{BATCH, Course, inputs, part, pieces, plus, weighted_sum};
use crate::model::Model;
use crate::parallel;
use crate::side::Side;
use crate::study::Study;

pub(crate) use parts::part_readings;
pub(crate) use passage::{Moved, Passage};
use settings::ballbar;

/// In which direction a channel sees the tip, or about which it sees it turn, in every row of a stretch.
pub(crate) struct Sight {
    /// Whether it sees the rotation, and not the displacement.
    pub(crate) turning: bool,
    pub(crate) directions: Vec<[f64; 3]>,
}

/// Everything about a stretch of rows that the channels share.
pub(crate) struct Frame<'c> {
    rows: Range<usize>,
    course: &'c Course,
    /// The tip behind the loops, without error motions, and as programmed: X, Y, Z.
    nominal: [Vec<f64>; 3],
    reference: [Vec<f64>; 3],
    start: [f64; 3],
    levers: Vec<[Column<'c>; 3]>,
    turns: Vec<[Column<'c>; 3]>,
    /// Errors of the tip, with the terms of the calibration and of the model; and of the drives alone.
    error: [Vec<f64>; 3],
    motions: Vec<Option<&'c [f64]>>,
    drive_motions: Vec<Option<&'c [f64]>>,
}

impl<'c> Frame<'c> {
    /// The frame of a stretch of the rows in which a model has `moved`.
    pub(crate) fn new(study: &Study<'_>, course: &'c Course, moved: &'c Moved, rows: Range<usize>) -> Self {
        let view = course.shown.rows(rows.clone());
        let (positions, travels) = inputs(study, &view);
        let programmed: Vec<&'c [f64]> =
            course.shown.given.programmed.iter().map(|position| &position[rows.clone()]).collect();
        let interpreter = &course.built.interpreter;
        let levers = interpreter.lever_values(&positions, &travels);
        let within = rows.start - moved.rows.start..rows.end - moved.rows.start;
        let motions = part(&moved.motions, &within);
        let first: Vec<f64> =
            course.shown.given.programmed.iter().map(|position| first_known(position)).collect();
        // Only a channel that shows rotations reads the turns.
        let turning = course.known.turn.is_some();
        Self {
            error: plus(weighted_sum(&levers, &motions, rows.len()), &course.known.tip, &rows),
            turns: if turning { interpreter.turn_values(&positions, &travels) } else { Vec::new() },
            nominal: interpreter.nominal_columns(&positions),
            reference: interpreter.nominal_columns(&programmed),
            start: interpreter.nominal(&first),
            drive_motions: part(&moved.drive_motions, &within),
            rows,
            course,
            levers,
            motions,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// The number of its first row.
    pub(crate) fn first_row(&self) -> usize {
        self.rows.start
    }

    /// Observed minus predicted, without the instrument's settings but for a ballbar's, which act exactly.
    pub(crate) fn residual(
        &self,
        study: &Study<'_>,
        scene: usize,
        channel: &Channel<'_>,
        model: &Model,
    ) -> Vec<f64> {
        let observed = &channel.values[self.rows.clone()];
        let tip = |d: usize, row: usize| self.nominal[d][row] + self.error[d][row];
        let moved_in = |d: usize, row: usize| tip(d, row) - self.reference[d][row];
        let moved = |row: usize| [moved_in(0, row), moved_in(1, row), moved_in(2, row)];
        let pose = study.scenes[scene].pose.as_ref();
        let predicted: Vec<f64> = match channel.kind {
            Kind::Tip(d) => match pose {
                Some(pose) => (0..self.len()).map(|row| pose.moved(self.tip(row))[d]).collect(),
                None => (0..self.len()).map(|row| tip(d, row)).collect(),
            },
            Kind::Radius { center, radius } => {
                let (center, radius) = ballbar(scene, model, center, radius);
                let distance = |row: usize| length(self.spoke(center, row)) - radius;
                (0..self.len()).map(distance).collect()
            }
            Kind::Along(n) => (0..self.len()).map(|row| dot(n, moved(row))).collect(),
            Kind::Normal => {
                let normal = |row| self.normal(study, scene, row);
                let lies = |row: usize| {
                    pose.map_or_else(
                        || moved(row),
                        |pose| minus(pose.moved(self.tip(row)), at(&self.reference, row)),
                    )
                };
                (0..self.len()).map(|row| dot(normal(row), lies(row))).collect()
            }
            Kind::Turn(about) => self.turned(about),
            Kind::Stage(axis) => {
                let errors = self.turned(stage_direction(study, axis, &self.turns));
                let position = self.course.shown.rows(self.rows.clone()).axis(axis).position;
                position.iter().zip(errors).map(|(position, error)| position + error).collect()
            }
            Kind::Drive(axis) => self.drive(study, axis),
        };
        let left = observed.iter().zip(predicted).map(|(observed, predicted)| observed - predicted);
        let rows = self.rows.clone().zip(left);
        rows.map(|(row, left)| if study.scenes[scene].left_out(row) { f64::NAN } else { left }).collect()
    }

    /// Observed minus predicted of a channel by number, the instrument's settings included.
    pub(crate) fn left(
        &self,
        study: &Study<'_>,
        scene: usize,
        (number, channel): (usize, &Channel<'_>),
        model: &Model,
    ) -> Vec<f64> {
        let settings = self.settings(study, scene, number, model);
        let mut values = self.residual(study, scene, channel, model);
        values.iter_mut().zip(settings).for_each(|(value, setting)| *value -= setting);
        values
    }

    /// The tip with its error.
    fn tip(&self, row: usize) -> [f64; 3] {
        let part = |d: usize| self.nominal[d][row] + self.error[d][row];
        [part(0), part(1), part(2)]
    }

    /// From the centre to the tip.
    fn spoke(&self, center: [f64; 3], row: usize) -> [f64; 3] {
        let part = |d: usize| self.nominal[d][row] + self.error[d][row] - center[d];
        [part(0), part(1), part(2)]
    }

    fn normal(&self, study: &Study<'_>, scene: usize, row: usize) -> [f64; 3] {
        let normals = study.scenes[scene].recording.normal.as_ref();
        normals.map_or([f64::NAN; 3], |normals| at(normals, self.rows.start + row))
    }

    /// The rotation of the tool relative to the part about a direction.
    fn turned(&self, about: [f64; 3]) -> Vec<f64> {
        let mut turn = weighted_sum(&self.turns, &self.motions, self.len());
        if let Some(known) = &self.course.known.turn {
            turn = plus(turn, known, &self.rows);
        }
        (0..self.len()).map(|row| dot(about, at(&turn, row))).collect()
    }

    fn drive(&self, study: &Study<'_>, axis: usize) -> Vec<f64> {
        let states = self.course.states(Kind::Drive(axis)).rows(self.rows.clone());
        let position = states.axis(axis).position;
        let mut shown = position.to_vec();
        if let Some(own) = study.own[axis] {
            let known = self.course.known.drive[own].as_ref().map(|known| &known[self.rows.clone()]);
            for motion in known.into_iter().chain(self.drive_motions[own]) {
                shown.iter_mut().zip(motion).for_each(|(shown, motion)| *shown += motion);
            }
        }
        shown
    }

    /// How a channel sees each error motion: `None` where it does not. `side` tells on which side effects come in.
    pub(crate) fn gains(
        &self,
        study: &Study<'_>,
        scene: usize,
        channel: &Channel<'_>,
        model: &Model,
        side: Side,
    ) -> Vec<Option<Vec<f64>>> {
        let rows = self.len();
        if let (Kind::Tip(d), None) = (channel.kind, study.scenes[scene].pose) {
            return self.levers.iter().map(|parts| lever(&parts[d], rows)).collect();
        }
        if let Kind::Drive(axis) = channel.kind {
            let own = study.own[axis].filter(|_| side.at_drive());
            let gain = |motion: usize| (Some(motion) == own).then(|| vec![1.0; rows]);
            return (0..self.levers.len()).map(gain).collect();
        }
        let Sight { turning, directions } = self.sight(study, scene, channel, model);
        let of = if turning { &self.turns } else { &self.levers };
        of.iter().map(|parts| projected(parts, &directions)).collect()
    }

    /// What a channel sees of the tip, or of its rotation; nothing of either where it is a drive's own feedback. Of a part that lies turned
    /// it sees the directions in the part.
    pub(crate) fn sight(
        &self,
        study: &Study<'_>,
        scene: usize,
        channel: &Channel<'_>,
        model: &Model,
    ) -> Sight {
        let everywhere = |direction: [f64; 3]| vec![direction; self.len()];
        let pose = study.scenes[scene].pose.as_ref();
        let in_part = |direction: [f64; 3]| pose.map_or(direction, |pose| pose.back(direction));
        let directions = match channel.kind {
            Kind::Tip(d) => everywhere(in_part(along(d))),
            Kind::Radius { center, radius } => {
                let leans = study.scenes[scene].leans;
                let mut directions = self.spokes(ballbar(scene, model, center, radius).0);
                for (d, _) in leans.iter().enumerate().filter(|(_, leans)| !**leans) {
                    directions.iter_mut().for_each(|direction| direction[d] = 0.0);
                }
                directions
            }
            Kind::Along(n) | Kind::Turn(n) => everywhere(n),
            Kind::Normal => (0..self.len()).map(|row| in_part(self.normal(study, scene, row))).collect(),
            Kind::Stage(axis) => everywhere(stage_direction(study, axis, &self.turns)),
            Kind::Drive(_) => everywhere([0.0; 3]),
        };
        Sight { turning: matches!(channel.kind, Kind::Turn(_) | Kind::Stage(_)), directions }
    }

    /// Unit vectors from the centre to the tip.
    fn spokes(&self, center: [f64; 3]) -> Vec<[f64; 3]> {
        let unit = |row| {
            let spoke = self.spoke(center, row);
            let size = length(spoke);
            [spoke[0] / size, spoke[1] / size, spoke[2] / size]
        };
        (0..self.len()).map(unit).collect()
    }
}

/// What of lever arms lies in the direction of each row; `None` where that is nothing in all of them.
fn projected(parts: &[Column<'_>; 3], directions: &[[f64; 3]]) -> Option<Vec<f64>> {
    if parts.iter().all(|part| *part == Column::Same(0.0)) {
        return None;
    }
    let [x, y, z] = parts;
    let rows = directions.iter().enumerate();
    seen(rows.map(|(row, direction)| dot(*direction, [x.at(row), y.at(row), z.at(row)])).collect())
}

fn at(columns: &[Vec<f64>; 3], row: usize) -> [f64; 3] {
    [columns[0][row], columns[1][row], columns[2][row]]
}

/// One part of a lever arm in every row; `None` where it is zero everywhere.
fn lever(part: &Column<'_>, rows: usize) -> Option<Vec<f64>> {
    match part {
        Column::Same(value) => (*value != 0.0).then(|| vec![*value; rows]),
        Column::Rows(values) => seen(values.to_vec()),
    }
}

fn seen(gain: Vec<f64>) -> Option<Vec<f64>> {
    gain.iter().any(|gain| *gain != 0.0).then_some(gain)
}

/// The direction about which a rotary axis's own motion counts +1.
fn stage_direction(study: &Study<'_>, axis: usize, turns: &[[Column<'_>; 3]]) -> [f64; 3] {
    let own = study.own[axis].and_then(|own| turns.get(own));
    own.map_or([0.0; 3], |own| [0, 1, 2].map(|d| own[d].at(0)))
}

/// A direction of the part's frame.
fn along(direction: usize) -> [f64; 3] {
    [0, 1, 2].map(|other| if other == direction { 1.0 } else { 0.0 })
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn first_known(values: &[f64]) -> f64 {
    values.iter().copied().find(|value| value.is_finite()).unwrap_or_default()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Observed minus predicted of all channels of a scene, settings of the instrument included.
pub(crate) fn residuals(study: &Study<'_>, scene: usize, model: &Model, course: &Course) -> Vec<Vec<f64>> {
    let channels = &study.scenes[scene].channels;
    let rows = study.scenes[scene].rows();
    let mut residuals: Vec<Vec<f64>> = channels.iter().map(|_| Vec::with_capacity(rows)).collect();
    let of_frame = |frame: &Frame<'_>| -> Vec<Vec<f64>> {
        let each = channels.iter().enumerate();
        each.map(|(number, channel)| frame.left(study, scene, (number, channel), model)).collect()
    };
    each_frame(study, scene, model, course, of_frame, |_, parts| {
        for (residual, part) in residuals.iter_mut().zip(parts) {
            residual.extend(part);
        }
    });
    residuals
}

/// Runs through the rows of a scene in stretches: `work` on all processors, `take` in the order of the rows.
pub(crate) fn each_frame<T: Send>(
    study: &Study<'_>,
    scene: usize,
    model: &Model,
    course: &Course,
    work: impl Fn(&Frame<'_>) -> T + Sync,
    mut take: impl FnMut(Range<usize>, T),
) {
    let mut passage = Passage::new(study, scene, model);
    for batch in pieces(0..study.scenes[scene].rows(), BATCH) {
        let moved = passage.moved(study, course, batch);
        let stretches = moved.stretches();
        let results = parallel::counted(stretches.len(), moved.work(), |number| {
            work(&Frame::new(study, course, &moved, stretches[number].clone()))
        });
        for (stretch, result) in stretches.into_iter().zip(results) {
            take(stretch, result);
        }
    }
}

#[cfg(test)]
mod tests;
