//! Answers: loads that a position loop puts out, and that therefore cannot be the cause of its error.
//!
//! In: the study. Out: for each axis the loads that its following error and its velocity give. A controller's output pushes
//! against the error, and error and output agree in every row, whatever the mechanics are: taken for a load it would explain
//! everything and say nothing. A load from outside goes its own way.

use nalgebra::DMatrix;

use crate::scene::Scene;
use crate::states::nominal_position;
use crate::study::Study;
use crate::sweep::Swept;

/// A load that answers the error of an axis.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Answer {
    /// The numbers of the axis and of the load.
    pub(crate) axis: usize,
    pub(crate) load: usize,
    /// How much of the load's variance following error, velocity and programmed motion give, with the other loads.
    pub(crate) share: f64,
}

/// Error and velocity give at least so much of an output: the law of a loop is exact but for rounding and sampling.
const GIVEN: f64 = 0.99;
/// The motion of the axis alone gives at least so much: an output carries friction and inertia. A load from outside may well
/// follow from the error that it makes, and does not follow from the motion.
const CARRIES: f64 = 0.5;
/// With this share the motion alone shows that a load is an output. Following error need not give it: a feedback that is itself wrong
/// shows another error than the loop answered. At three quarters the load's coefficient has a variance inflation of 4 beside the
/// terms of the motion, friction and inertia: it is collinear with them, and no cause that could be told apart.
const MOSTLY: f64 = 0.75;

/// The loads that the loops put out, as all recordings that hold both show.
pub(crate) fn answers(study: &Study<'_>) -> Vec<Answer> {
    let axes = (0..study.own.len()).filter(|axis| study.own[*axis].is_some());
    let pairs = axes.flat_map(|axis| (0..study.loads.len()).map(move |load| (axis, load)));
    pairs.filter_map(|(axis, load)| answer(study, axis, load)).collect()
}

fn answer(study: &Study<'_>, axis: usize, load: usize) -> Option<Answer> {
    let shares: Vec<(f64, f64)> = study.scenes.iter().filter_map(|scene| shares(scene, axis, load)).collect();
    let least = |of: fn(&(f64, f64)) -> f64| shares.iter().map(of).fold(f64::INFINITY, f64::min);
    let (given, carried) = (least(|share| share.0), least(|share| share.1));
    let answers = !shares.is_empty() && (given >= GIVEN && carried >= CARRIES || carried >= MOSTLY);
    answers.then_some(Answer { axis, load, share: given })
}

/// What error and velocity give of a load, and what the programmed motion gives, each with the other loads.
fn shares(scene: &Scene<'_>, axis: usize, load: usize) -> Option<(f64, f64)> {
    let known = &scene.recording.axes[axis];
    let (command, actual) = (known.command.as_ref()?, known.actual.as_ref()?);
    let time = &scene.recording.time;
    let programmed = nominal_position(known, time.len());
    let velocity = slope(time, &programmed);
    let error: Vec<f64> = command.iter().zip(actual).map(|(command, actual)| command - actual).collect();
    let direction: Vec<f64> = velocity.iter().map(|v| if *v == 0.0 { 0.0 } else { v.signum() }).collect();
    let acceleration = slope(time, &velocity);
    let others = scene.given.loads.iter().enumerate().filter(|(number, _)| *number != load);
    let others: Vec<&[f64]> = others.map(|(_, values)| values.as_slice()).filter(|v| varies(v)).collect();
    let target = scene.given.loads.get(load).filter(|values| varies(values))?;
    let law = [error.as_slice(), &slope(time, actual)];
    let motion = [velocity.as_slice(), &direction, &acceleration];
    Some((
        explained(target, &[&law[..], &motion[..], &others[..]].concat())?,
        explained(target, &[&motion, &others[..]].concat())?,
    ))
}

fn varies(values: &[f64]) -> bool {
    let mut known = values.iter().filter(|value| value.is_finite());
    known.next().is_some_and(|first| known.any(|value| value != first))
}

/// Central differences; NaN where a neighbour is missing.
fn slope(time: &[f64], values: &[f64]) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let between = |row: usize| {
        let (from, to) = (row.saturating_sub(1), (row + 1).min(last));
        (values[to] - values[from]) / (time[to] - time[from])
    };
    (0..values.len()).map(between).collect()
}

/// The share of the variance of a column that others give by least squares, over the rows in which all are known.
fn explained(target: &[f64], columns: &[&[f64]]) -> Option<f64> {
    let width = columns.len();
    let all = || columns.iter().copied().chain([target]);
    let rows: Vec<usize> =
        (0..target.len()).filter(|row| all().all(|column| column[*row].is_finite())).collect();
    if rows.len() < FEWEST * (width + 1) {
        return None;
    }
    let centred = |column: &[f64]| {
        let mean = rows.iter().map(|row| column[*row]).sum::<f64>() / crate::number(rows.len());
        let from_mean = rows.iter().map(|row| column[*row] - mean);
        let size = from_mean.clone().map(|value| value * value).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        from_mean.map(|value| value / size).collect::<Vec<f64>>()
    };
    let columns: Vec<Vec<f64>> = all().map(centred).collect();
    let product = |a: usize, b: usize| columns[a].iter().zip(&columns[b]).map(|(a, b)| a * b).sum();
    let mut swept = Swept::new(&DMatrix::from_fn(width + 1, width + 1, product));
    for column in 0..width {
        swept.take(column);
    }
    Some(1.0 - swept.remaining())
}

/// The fewest rows for each column.
const FEWEST: usize = 20;

#[cfg(test)]
mod tests;
