//! The design: every candidate as columns behind the whitening filter, and what their products add up to.
//!
//! In: a study, the present model, the noise of every channel, and effects. Out: for each block of rows the matrix of
//! products of all columns with one another and with the residual. Everything that selection, fitting and held-out checks
//! ask is in these matrices; the columns themselves are made in stretches and never kept, so that memory does not grow
//! with candidates.

mod lower;
mod random;
mod run;
mod shapes;

use nalgebra::DMatrix;

use crate::channel::ChannelAt;
use crate::course::{Course, STRETCH, pieces};
use crate::model::{Effect, Fitted, Model};
use crate::noise::Noise;
use crate::observations::{Frame, Passage};
use crate::parallel;
use crate::study::Study;
use crate::terms::Shape;
use crate::weights::Weights;

pub(crate) use lower::Lower;
pub(crate) use run::ChannelRun;

/// One or more columns: an effect, or how an effect changes with its nonlinear parameter.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Regressor {
    pub(crate) effect: Effect,
    /// Where it is set: one column, the change of these terms at its place, with their coefficients, for each unit of the nonlinear
    /// parameter that they share.
    pub(crate) slope: Option<Vec<(Shape, Vec<f64>)>>,
}

impl Regressor {
    /// The effect itself.
    pub(crate) fn of(effect: Effect) -> Self {
        Self { effect, slope: None }
    }

    /// How effects of a model change with the nonlinear parameter that they share. `group` has their numbers, one at least.
    pub(crate) fn slope(effects: &[Fitted], group: &[usize]) -> Self {
        let part = |number: &usize| {
            let Fitted { effect, coefficients } = &effects[*number];
            (effect.shape.clone(), coefficients.clone())
        };
        Self { effect: effects[group[0]].effect.clone(), slope: Some(group.iter().map(part).collect()) }
    }

    /// Effects, each for itself.
    pub(crate) fn all(effects: &[Fitted]) -> Vec<Self> {
        effects.iter().map(|fitted| Self::of(fitted.effect.clone())).collect()
    }

    /// How many columns it has.
    pub(crate) fn columns(&self) -> usize {
        if self.slope.is_some() { 1 } else { self.effect.shape.columns() }
    }
}

/// Products of all columns, block by block.
pub(crate) struct Design {
    pub(crate) regressors: Vec<Regressor>,
    /// The first column of each regressor.
    pub(crate) first: Vec<usize>,
    /// The number of columns; the residual is the column after the last.
    pub(crate) width: usize,
    pub(crate) blocks: Vec<Products>,
}

/// The products of one block of rows.
#[derive(Clone, Debug)]
pub(crate) struct Products {
    pub(crate) scene: usize,
    pub(crate) held_out: bool,
    /// Columns times columns, the residual last.
    pub(crate) matrix: DMatrix<f64>,
    /// How many samples there are.
    pub(crate) samples: f64,
}

impl Design {
    /// Runs through all recordings once.
    pub(crate) fn new(
        study: &Study<'_>,
        model: &Model,
        weights: &Weights,
        regressors: Vec<Regressor>,
    ) -> Self {
        let mut first = Vec::with_capacity(regressors.len());
        let mut width = 0;
        for regressor in &regressors {
            first.push(width);
            width += regressor.columns();
        }
        let mut blocks = Vec::new();
        for scene in 0..study.scenes.len() {
            blocks.extend(scene_products(study, scene, model, weights, &regressors, width));
        }
        Self { regressors, first, width, blocks }
    }

    /// The columns of a channel before whitening, in some rows; the residual is the column after the last.
    pub(crate) fn columns_in(
        study: &Study<'_>,
        at: ChannelAt,
        model: &Model,
        regressors: &[Regressor],
        rows: &[usize],
    ) -> DMatrix<f64> {
        let width = regressors.iter().map(Regressor::columns).sum();
        let noise = Noise::white(1.0);
        let scene = at.scene;
        let course = Course::new(study, scene, model);
        let mut run = ChannelRun::new(study, at, model, noise, regressors, width);
        let mut passage = Passage::new(study, scene, model);
        let mut chosen = DMatrix::zeros(rows.len(), width + 1);
        let mut next = 0;
        for stretch in pieces(0..study.scenes[scene].rows(), STRETCH) {
            let moved = passage.moved(study, &course, stretch.clone());
            let frame = Frame::new(study, &course, &moved, stretch.clone());
            let view = course.states(study.channel(at).kind).rows(stretch.clone());
            let columns = run.raw_columns(&[frame], &view);
            while let Some(row) = rows.get(next).filter(|row| stretch.contains(row)) {
                chosen.row_mut(next).copy_from(&columns.row(row - stretch.start));
                next += 1;
            }
        }
        chosen
    }

    /// Adds back to the residual what effects of the present model take from it, so that all effects stand on one line:
    /// those of the model can be kept, changed or dropped like any other.
    pub(crate) fn rebase(&mut self, effects: &[Fitted]) {
        let mut shares = vec![0.0; self.width];
        for fitted in effects {
            let number = self
                .regressors
                .iter()
                .position(|known| known.slope.is_none() && known.effect == fitted.effect);
            if let Some(number) = number {
                for (column, coefficient) in self.columns(number).zip(&fitted.coefficients) {
                    shares[column] = *coefficient;
                }
            }
        }
        for block in &mut self.blocks {
            add_back(&mut block.matrix, &shares);
        }
    }

    /// The products of all blocks that are fitted, and their samples.
    pub(crate) fn fitted(&self) -> (DMatrix<f64>, f64) {
        self.sum(|block| !block.held_out)
    }

    /// The products of the blocks that `which` picks.
    pub(crate) fn sum(&self, which: impl Fn(&Products) -> bool) -> (DMatrix<f64>, f64) {
        let mut sum = DMatrix::zeros(self.width + 1, self.width + 1);
        let mut samples = 0.0;
        for block in self.blocks.iter().filter(|block| which(block)) {
            sum += &block.matrix;
            samples += block.samples;
        }
        (sum, samples)
    }

    /// The columns of a regressor.
    pub(crate) fn columns(&self, regressor: usize) -> std::ops::Range<usize> {
        let first = self.first[regressor];
        first..first + self.regressors[regressor].columns()
    }
}

/// Replaces the response y, which is last, by y + X shares.
fn add_back(products: &mut DMatrix<f64>, shares: &[f64]) {
    let width = shares.len();
    let explained: Vec<f64> = (0..width)
        .map(|row| (0..width).map(|column| products[(row, column)] * shares[column]).sum())
        .collect();
    let cross: f64 = (0..width).map(|row| products[(row, width)] * shares[row]).sum();
    let square: f64 = explained.iter().zip(shares).map(|(explained, share)| explained * share).sum();
    products[(width, width)] += 2.0 * cross + square;
    for (row, explained) in explained.into_iter().enumerate() {
        products[(row, width)] += explained;
        products[(width, row)] += explained;
    }
}

fn scene_products(
    study: &Study<'_>,
    scene: usize,
    model: &Model,
    weights: &Weights,
    regressors: &[Regressor],
    width: usize,
) -> Vec<Products> {
    let known = &study.scenes[scene];
    let course = Course::new(study, scene, model);
    let of = |channel: usize| {
        let at = ChannelAt { scene, channel };
        ChannelRun::new(study, at, model, weights.noise(at), regressors, width)
    };
    let mut runs: Vec<ChannelRun<'_>> = (0..known.channels.len()).map(of).collect();
    let mut passage = Passage::new(study, scene, model);
    let batch = run::batch(width);
    let blocks = known.blocks.iter().map(|block| {
        for rows in pieces(block.rows.clone(), batch) {
            let moved = passage.moved(study, &course, rows);
            let stretches = moved.stretches();
            let frames = parallel::counted(stretches.len(), moved.work(), |number| {
                Frame::new(study, &course, &moved, stretches[number].clone())
            });
            let work = frames.len() * STRETCH * (width + 1);
            parallel::each(&mut runs, work, |run| run.add(&frames, &course, &weights.outliers));
        }
        let mut products = Products {
            scene,
            held_out: block.held_out,
            matrix: DMatrix::zeros(width + 1, width + 1),
            samples: 0.0,
        };
        for (matrix, samples) in runs.iter_mut().map(ChannelRun::finish_block) {
            products.matrix += matrix;
            products.samples += samples;
        }
        products
    });
    blocks.collect()
}

#[cfg(test)]
mod tests;
