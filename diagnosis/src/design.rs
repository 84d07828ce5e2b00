//! The design: every candidate as columns behind the whitening filter, and what their products add up to.
//!
//! In: a study, the present model, the noise of every channel, and effects. Out: for each block of rows the matrix of
//! products of all columns with one another and with the residual. Everything that selection, fitting and held-out checks
//! ask is in these matrices; the columns themselves are made in stretches and never kept, so that memory does not grow
//! with candidates.

use std::panic::resume_unwind;

use nalgebra::DMatrix;

use crate::course::{Course, STRETCH, Terms};
use crate::model::{Effect, Model, Place, Side};
use crate::noise::{Noise, Step, Whitening, whiten};
use crate::observations::{Frame, acts};
use crate::states::Rows;
use crate::study::{Channel, Kind, Study};
use crate::terms::{Memory, Shape};

/// One or more columns: an effect, or how an effect changes with its nonlinear parameter.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Regressor {
    pub(crate) effect: Effect,
    /// Where it is set: one column, the change of the effect with these coefficients for each unit of the parameter.
    pub(crate) slope: Option<Vec<f64>>,
}

impl Regressor {
    /// The effect itself.
    pub(crate) fn of(effect: Effect) -> Self {
        Self { effect, slope: None }
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
        noises: &[Vec<Noise>],
        regressors: Vec<Regressor>,
    ) -> Self {
        let mut first = Vec::with_capacity(regressors.len());
        let mut width = 0;
        for regressor in &regressors {
            first.push(width);
            width += regressor.columns();
        }
        let mut blocks = Vec::new();
        for (scene, noises) in noises.iter().enumerate() {
            blocks.extend(scene_products(study, scene, model, noises, &regressors, width));
        }
        Self { regressors, first, width, blocks }
    }

    /// Adds back to the residual what the effects of the present model take from it, so that all effects stand on one line:
    /// those of the model can be kept, changed or dropped like any other.
    pub(crate) fn rebase(&mut self, model: &Model) {
        let mut shares = vec![0.0; self.width];
        for fitted in model {
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
    noises: &[Noise],
    regressors: &[Regressor],
    width: usize,
) -> Vec<Products> {
    let channels = &study.scenes[scene].channels;
    let course = Course::new(study, scene, model);
    let job = |channel: usize| {
        let mut run = ChannelRun::new(study, scene, channel, model, noises[channel], regressors, width);
        run.all(&course)
    };
    let results = in_parallel(channels.len(), &job);
    let blocks = study.scenes[scene].blocks.iter().enumerate();
    blocks
        .map(|(number, block)| {
            let mut products = Products {
                scene,
                held_out: block.held_out,
                matrix: DMatrix::zeros(width + 1, width + 1),
                samples: 0.0,
            };
            for (matrix, samples) in results.iter().filter_map(|blocks| blocks.get(number)) {
                products.matrix += matrix;
                products.samples += samples;
            }
            products
        })
        .collect()
}

/// Runs a job for each number below `count`, on all processors.
pub(crate) fn in_parallel<T: Send>(count: usize, job: &(impl Fn(usize) -> T + Sync)) -> Vec<T> {
    let workers = std::thread::available_parallelism().map_or(1, std::num::NonZero::get).min(count.max(1));
    if workers <= 1 {
        return (0..count).map(job).collect();
    }
    let share = |worker: usize| -> Vec<(usize, T)> {
        (worker..count).step_by(workers).map(|number| (number, job(number))).collect()
    };
    let mut results = std::thread::scope(|scope| {
        let others: Vec<_> = (1..workers).map(|worker| scope.spawn(move || share(worker))).collect();
        // This thread has its share too.
        let mut results = share(0);
        for other in others {
            results.extend(other.join().unwrap_or_else(|panic| resume_unwind(panic)));
        }
        results
    });
    results.sort_by_key(|(number, _)| *number);
    results.into_iter().map(|(_, result)| result).collect()
}

/// One channel on its way through a recording.
pub(crate) struct ChannelRun<'r> {
    study: &'r Study<'r>,
    scene: usize,
    number: usize,
    model: &'r Model,
    regressors: &'r [Regressor],
    width: usize,
    noise: Noise,
    shapes: Shapes,
    whitening: Whitening,
    /// The state of the whitening filter of each column, the residual last.
    filters: Vec<f64>,
}

impl<'r> ChannelRun<'r> {
    /// The run at the beginning of the recording.
    pub(crate) fn new(
        study: &'r Study<'r>,
        scene: usize,
        number: usize,
        model: &'r Model,
        noise: Noise,
        regressors: &'r [Regressor],
        width: usize,
    ) -> Self {
        let shapes = Shapes::new(regressors);
        let filters = vec![0.0; width + 1];
        let whitening = Whitening::new(noise);
        Self { study, scene, number, model, regressors, width, noise, shapes, whitening, filters }
    }

    fn channel(&self) -> &'r Channel {
        &self.study.scenes[self.scene].channels[self.number]
    }

    /// The products of every block.
    fn all(&mut self, course: &Course) -> Vec<(DMatrix<f64>, f64)> {
        let study = self.study;
        let (mut terms, mut drive_terms) = (Terms::new(self.model), Terms::new(self.model));
        let mut results = Vec::new();
        for block in &study.scenes[self.scene].blocks {
            let mut products = DMatrix::zeros(self.width + 1, self.width + 1);
            let mut samples = 0.0;
            let mut from = block.rows.start;
            while from < block.rows.end {
                let rows = from..(from + STRETCH).min(block.rows.end);
                from = rows.end;
                let frame = Frame::new(study, course, rows.clone(), &mut terms, &mut drive_terms);
                let view = course.states(self.channel().kind).rows(rows);
                samples += self.stretch(&frame, &view, &mut products);
            }
            results.push((products, samples));
        }
        results
    }

    /// For each column: sums against random weights with the channel's mean taken out, then the sum of squares about the
    /// mean, then the sum of squares. Columns weigh by the noise of the channel.
    pub(crate) fn random_sums(&mut self, course: &Course, count: usize) -> DMatrix<f64> {
        let study = self.study;
        let weight = 1.0 / self.noise.white;
        let (mut terms, mut drive_terms) = (Terms::new(self.model), Terms::new(self.model));
        let mut sums = DMatrix::zeros(count + 2, self.width);
        let (mut plain, mut weights) = (vec![0.0; self.width], vec![0.0; count]);
        let mut samples = 0.0;
        let mut random = Random::new(self.scene, self.number);
        let rows = study.scenes[self.scene].rows();
        let mut from = 0;
        while from < rows {
            let end = (from + STRETCH).min(rows);
            let frame = Frame::new(study, course, from..end, &mut terms, &mut drive_terms);
            let view = course.states(self.channel().kind).rows(from..end);
            let mut columns = self.raw_columns(&frame, &view);
            columns *= weight;
            let mut drawn = DMatrix::from_fn(end - from, count, |_, _| random.next());
            for row in 0..end - from {
                if columns.row(row).iter().all(|value| value.is_finite()) {
                    samples += 1.0;
                } else {
                    columns.row_mut(row).fill(0.0);
                    drawn.row_mut(row).fill(0.0);
                }
            }
            let columns = columns.columns(0, self.width);
            let products = drawn.transpose() * columns;
            for (number, sum) in weights.iter_mut().enumerate() {
                *sum += drawn.column(number).sum();
            }
            for column in 0..self.width {
                plain[column] += columns.column(column).sum();
                sums[(count + 1, column)] += columns.column(column).norm_squared();
                for number in 0..count {
                    sums[(number, column)] += products[(number, column)];
                }
            }
            from = end;
        }
        for column in 0..self.width {
            for (number, weight) in weights.iter().enumerate() {
                sums[(number, column)] -= weight * plain[column] / f64::max(samples, 1.0);
            }
            sums[(count, column)] =
                sums[(count + 1, column)] - plain[column] * plain[column] / f64::max(samples, 1.0);
        }
        sums
    }

    /// Adds the products of a stretch of rows; returns how many samples it has.
    fn stretch(&mut self, frame: &Frame<'_>, view: &Rows<'_>, products: &mut DMatrix<f64>) -> f64 {
        let rows = view.len();
        let mut columns = self.raw_columns(frame, view);
        let first_row = frame.first_row();
        let outliers = &self.channel().outliers[first_row..first_row + rows];
        let known = |row: usize| (0..=self.width).all(|column| columns[(row, column)].is_finite());
        let valid: Vec<bool> = (0..rows).map(|row| !outliers[row] && known(row)).collect();
        let steps: Vec<Step> = self.whitening.steps(view.time, &valid);
        for (column, filter) in columns.column_iter_mut().zip(&mut self.filters) {
            let mut column = column;
            if let Some(values) = column.as_mut_slice().get_mut(..) {
                whiten(&steps, filter, values);
            }
        }
        let transposed = columns.transpose();
        products.gemm(1.0, &transposed, &columns, 1.0);
        valid.iter().filter(|valid| **valid).map(|_| 1.0).sum()
    }

    /// The columns before whitening, the residual last.
    fn raw_columns(&mut self, frame: &Frame<'_>, view: &Rows<'_>) -> DMatrix<f64> {
        let (study, channel) = (self.study, self.channel());
        let after = frame.gains(study, self.scene, channel, self.model, Side::After);
        let drive = match channel.kind {
            Kind::Drive(_) => Some(frame.gains(study, self.scene, channel, self.model, Side::Drive)),
            _ => None,
        };
        let mut columns = DMatrix::zeros(view.len(), self.width + 1);
        self.shapes.fill(view);
        let mut next = 0;
        for (number, regressor) in self.regressors.iter().enumerate() {
            let count = regressor.columns();
            match (regressor.effect.place, &regressor.effect.shape) {
                (Place::Motion { motion, side }, _) => {
                    let gains = if side.at_drive() { drive.as_ref().unwrap_or(&after) } else { &after };
                    if let Some(gain) = &gains[motion] {
                        for (k, term) in self.shapes.columns(number).iter().enumerate() {
                            let mut target = columns.column_mut(next + k);
                            for ((target, gain), term) in target.iter_mut().zip(gain).zip(term) {
                                *target = gain * term;
                            }
                        }
                    }
                }
                (Place::Instrument { .. }, Shape::Instrument(setting))
                    if acts(&regressor.effect, self.scene) =>
                {
                    if let Some(values) = frame.setting(study, self.scene, self.number, *setting, self.model)
                    {
                        columns.column_mut(next).copy_from_slice(&values);
                    }
                }
                _ => {}
            }
            next += count;
        }
        let residual = frame.residual(study, self.scene, channel, self.model);
        let settings = frame.settings(study, self.scene, self.number, self.model);
        for ((target, residual), setting) in
            columns.column_mut(self.width).iter_mut().zip(residual).zip(settings)
        {
            *target = residual - setting;
        }
        columns
    }
}

/// The terms of all regressors, each different one worked out once.
struct Shapes {
    different: Vec<Different>,
    /// Of each regressor: the number of its shape, or of the two that its slope is taken from.
    of: Vec<Use>,
    slopes: Vec<Vec<Vec<f64>>>,
}

/// A term, behind the position loop that answers it where one does.
struct Different {
    shape: Shape,
    answered_by: Option<usize>,
    memory: Memory,
    columns: Vec<Vec<f64>>,
}

enum Use {
    Shape(usize),
    /// How the position changes with the inertia of the axis's loop.
    Inertia {
        axis: usize,
        place: usize,
    },
    Slope {
        low: usize,
        high: usize,
        step: f64,
        coefficients: Vec<f64>,
        place: usize,
    },
}

/// The relative step by which slopes are taken.
const SLOPE_STEP: f64 = 1e-4;

impl Shapes {
    fn new(regressors: &[Regressor]) -> Self {
        let mut shapes = Self { different: Vec::new(), of: Vec::new(), slopes: Vec::new() };
        for regressor in regressors {
            let shape = &regressor.effect.shape;
            let answered_by = regressor.effect.side().and_then(Side::answered_by);
            let place = shapes.slopes.len();
            let usage = match (&regressor.slope, shape.nonlinear()) {
                (Some(_), Some(_)) if let Shape::Lag { axis, .. } = *shape => Use::Inertia { axis, place },
                (Some(coefficients), Some(parameter)) => {
                    let step = parameter.value * SLOPE_STEP;
                    let low = shapes.number(shape.with_nonlinear(parameter.value - step), answered_by);
                    let high = shapes.number(shape.with_nonlinear(parameter.value + step), answered_by);
                    Use::Slope { low, high, step: 2.0 * step, coefficients: coefficients.clone(), place }
                }
                _ => Use::Shape(shapes.number(shape.clone(), answered_by)),
            };
            if !matches!(usage, Use::Shape(_)) {
                shapes.slopes.push(vec![Vec::new()]);
            }
            shapes.of.push(usage);
        }
        shapes
    }

    fn number(&mut self, shape: Shape, answered_by: Option<usize>) -> usize {
        let same = |known: &Different| known.shape == shape && known.answered_by == answered_by;
        if let Some(known) = self.different.iter().position(same) {
            return known;
        }
        let columns = vec![Vec::new(); shape.columns()];
        self.different.push(Different { shape, answered_by, memory: Memory::default(), columns });
        self.different.len() - 1
    }

    fn fill(&mut self, view: &Rows<'_>) {
        for known in &mut self.different {
            known.shape.fill_behind(known.answered_by, view, &mut known.memory, &mut known.columns);
        }
        for usage in &self.of {
            match usage {
                Use::Shape(_) => {}
                Use::Inertia { axis, place } => self.slopes[*place][0] = view.axis(*axis).inertia_slope(),
                Use::Slope { low, high, step, coefficients, place } => {
                    let sum = |number: usize, row: usize| -> f64 {
                        let columns = self.different[number].columns.iter().zip(coefficients);
                        columns.map(|(column, coefficient)| column[row] * coefficient).sum()
                    };
                    self.slopes[*place][0] =
                        (0..view.len()).map(|row| (sum(*high, row) - sum(*low, row)) / step).collect();
                }
            }
        }
    }

    fn columns(&self, regressor: usize) -> &[Vec<f64>] {
        match &self.of[regressor] {
            Use::Shape(number) => &self.different[*number].columns,
            Use::Inertia { place, .. } | Use::Slope { place, .. } => &self.slopes[*place],
        }
    }
}

/// Weights between -1 and 1 that are the same in every run of the program.
struct Random(u64);

impl Random {
    fn new(scene: usize, channel: usize) -> Self {
        Self(0x9E37_79B9_7F4A_7C15 ^ ((scene as u64) << 32) ^ (channel as u64))
    }

    /// One step of the generator splitmix64.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^= mixed >> 31;
        let half = u32::try_from(mixed >> 32).unwrap_or_default();
        f64::from(half) / f64::from(u32::MAX) * 2.0 - 1.0
    }
}

#[cfg(test)]
mod tests;
