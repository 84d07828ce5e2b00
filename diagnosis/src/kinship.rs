//! Kinship: which candidates the recordings show alike.
//!
//! In: effects. Out: groups of effects whose columns are proportional in every row, once the zero of each channel is free.
//! Only the simplest of a group is worth trying; the others are names for the same. Columns are compared by a few sums
//! against random weights, so that one run through the rows tells for all pairs.

use std::sync::Arc;

use nalgebra::DMatrix;

use crate::candidates::simplicity;
use crate::channel::ChannelAt;
use crate::course::Course;
use crate::design::{ChannelRun, Regressor};
use crate::model::{Effect, Model};
use crate::noise::Noise;
use crate::parallel;
use crate::study::Study;

/// An effect, and others that the recordings show alike.
#[derive(Clone, Debug)]
pub(crate) struct Kin {
    pub(crate) effect: Effect,
    pub(crate) equals: Vec<Effect>,
}

/// How many random sums each column is known by.
const SUMS: usize = 6;
/// How far normalised sums of proportional columns may differ.
const ALIKE: f64 = 1e-6;
/// The share of a column that must vary for it to be seen beside a free zero.
const VISIBLE: f64 = 1e-10;

/// Groups effects by what the recordings show of them; effects that they do not show are left out.
pub(crate) fn groups(
    study: &Study<'_>,
    courses: &[Arc<Course>],
    noises: &[Vec<Noise>],
    effects: Vec<Effect>,
) -> Vec<Kin> {
    let sums = column_sums(study, courses, noises, &effects);
    let mut order: Vec<usize> = (0..effects.len()).collect();
    order.sort_by(|a, b| simplicity(study, &effects[*a]).total_cmp(&simplicity(study, &effects[*b])));
    let mut next = 0;
    let columns: Vec<std::ops::Range<usize>> = effects
        .iter()
        .map(|effect| {
            let first = next;
            next += effect.shape.columns();
            first..next
        })
        .collect();
    let marks: Vec<Vec<[f64; SUMS]>> =
        columns.into_iter().map(|columns| columns.filter_map(|column| sums[column]).collect()).collect();
    let mut kin: Vec<(Kin, usize)> = Vec::new();
    for number in order {
        let mark = &marks[number];
        if mark.is_empty() {
            continue;
        }
        match kin.iter_mut().find(|(_, first)| alike(&marks[*first], mark)) {
            Some((known, _)) => known.equals.push(effects[number].clone()),
            None => kin.push((Kin { effect: effects[number].clone(), equals: Vec::new() }, number)),
        }
    }
    kin.into_iter().map(|(kin, _)| kin).collect()
}

fn alike(a: &[[f64; SUMS]], b: &[[f64; SUMS]]) -> bool {
    let near = |a: &[f64; SUMS], b: &[f64; SUMS]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < ALIKE);
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| near(a, b))
}

/// The normalised random sums of every column; `None` where the recordings do not show it.
fn column_sums(
    study: &Study<'_>,
    courses: &[Arc<Course>],
    noises: &[Vec<Noise>],
    effects: &[Effect],
) -> Vec<Option<[f64; SUMS]>> {
    let regressors: Vec<Regressor> = effects.iter().cloned().map(Regressor::of).collect();
    let width = regressors.iter().map(Regressor::columns).sum();
    let jobs: Vec<ChannelAt> = study.channels().collect();
    let model = Model::default();
    let results = parallel::counted(jobs.len(), study.rows() * width, |job| {
        let at = jobs[job];
        let noise = noises[at.scene][at.channel];
        let mut run = ChannelRun::new(study, at, &model, noise, &regressors, width);
        run.random_sums(&courses[at.scene], SUMS)
    });
    let total = results.into_iter().fold(DMatrix::zeros(SUMS + 2, width), |sum, matrix| sum + matrix);
    total.column_iter().map(|column| normalised(&column.iter().copied().collect::<Vec<f64>>())).collect()
}

/// The first of these sums are random ones; then come the squares about the mean, and all squares.
fn normalised(sums: &[f64]) -> Option<[f64; SUMS]> {
    let (random, squares) = sums.split_at(SUMS);
    let seen = squares[0] > VISIBLE * squares[1];
    if !seen {
        return None;
    }
    let mut mark = [0.0; SUMS];
    mark.copy_from_slice(random);
    let length = mark.iter().map(|value| value * value).sum::<f64>().sqrt();
    let sign = mark.iter().find(|value| value.abs() > 0.1 * length).map_or(1.0, |value| value.signum());
    Some(mark.map(|value| value * sign / length))
}

#[cfg(test)]
mod tests;
