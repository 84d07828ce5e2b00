//! A channel on its way through a recording.
//!
//! In: stretches of rows, in order. Out: the columns of all regressors behind the whitening filter of the channel, and what their
//! products add up to in each block; or sums of the columns against random weights.

use nalgebra::DMatrix;

use super::Regressor;
use super::lower::{Lower, NARROW};
use super::random::RandomWeights;
use super::shapes::Shapes;
use crate::channel::{Channel, ChannelAt, Kind};
use crate::course::{BATCH, Course, STRETCH, pieces};
use crate::model::{Model, Place};
use crate::noise::{Noise, Step, Whitening, whiten};
use crate::observations::{Frame, Passage};
use crate::parallel;
use crate::side::Side;
use crate::states::Rows;
use crate::study::Study;
use crate::weights::Outliers;

/// How many rows of `width` columns are worked on at a time: as many as stay in a cache, in whole stretches.
pub(super) fn batch(width: usize) -> usize {
    (CACHED / (width + 1) / STRETCH * STRETCH).clamp(STRETCH, BATCH)
}

/// Numbers that stay in a cache: 256 KiB, as the second level of a small processor has.
const CACHED: usize = 1 << 15;

/// One channel on its way through a recording.
pub(crate) struct ChannelRun<'r> {
    study: &'r Study<'r>,
    at: ChannelAt,
    model: &'r Model,
    regressors: &'r [Regressor],
    width: usize,
    noise: Noise,
    shapes: Shapes,
    whitening: Whitening,
    /// The state of the whitening filter of each column, the residual last.
    filters: Vec<f64>,
    /// Whether the channel has seen anything of each regressor; columns of others are zero.
    seen: Vec<bool>,
    /// The products of the present block.
    products: Lower,
    /// How many independent samples its valid rows are worth.
    samples: f64,
}

/// What a channel sees in one stretch of rows.
struct Sight {
    /// How the channel sees each error motion that enters behind the feedback: its lever arm in each row; `None` where it does not.
    after: Vec<Option<Vec<f64>>>,
    /// The same for motions that enter on the drive's side; `None` where the channel sees both sides alike.
    drive: Option<Vec<Option<Vec<f64>>>>,
    /// The settings of the instrument among the regressors, by their numbers.
    settings: Vec<(usize, Vec<f64>)>,
    residual: Vec<f64>,
}

impl Sight {
    /// How an error motion is seen; `None` where it is not.
    fn gain(&self, motion: usize, side: Side) -> Option<&[f64]> {
        let drive = self.drive.as_ref().filter(|_| side.at_drive());
        drive.unwrap_or(&self.after)[motion].as_deref()
    }

    /// The column of a setting by the number of its regressor.
    fn setting(&self, number: usize) -> Option<&[f64]> {
        let mut known = self.settings.iter();
        known.find(|(of, _)| *of == number).map(|(_, values)| values.as_slice())
    }
}

impl<'r> ChannelRun<'r> {
    /// The run at the beginning of the recording.
    pub(crate) fn new(
        study: &'r Study<'r>,
        at: ChannelAt,
        model: &'r Model,
        noise: Noise,
        regressors: &'r [Regressor],
        width: usize,
    ) -> Self {
        Self {
            study,
            at,
            model,
            regressors,
            width,
            noise,
            shapes: Shapes::new(regressors),
            whitening: Whitening::new(noise),
            filters: vec![0.0; width + 1],
            seen: vec![false; regressors.len()],
            products: Lower::new(width + 1),
            samples: 0.0,
        }
    }

    fn channel(&self) -> &'r Channel<'r> {
        self.study.channel(self.at)
    }

    /// Adds the products of the next rows, which these frames hold. Outliers do not count.
    pub(super) fn add(&mut self, frames: &[Frame<'_>], course: &Course, outliers: &Outliers) {
        let (Some(first), Some(last)) = (frames.first(), frames.last()) else { return };
        let rows = first.first_row()..last.first_row() + last.len();
        let view = course.states(self.channel().kind).rows(rows.clone());
        let sights = self.sights(frames);
        self.mark_seen(&sights);
        let places = self.places();
        let mut columns = self.columns(&sights, &view, &places);
        let mut valid = known(&columns);
        let outliers = &outliers.of(self.at)[rows];
        valid.iter_mut().zip(outliers).for_each(|(valid, outlier)| *valid &= !outlier);
        let steps = self.whitening.steps(view.time, &valid);
        let mut filters: Vec<f64> = places.iter().map(|place| self.filters[*place]).collect();
        whiten_all(&steps, &mut filters, columns.as_mut_slice());
        places.iter().zip(filters).for_each(|(place, filter)| self.filters[*place] = filter);
        self.products.add(&columns, &places);
        self.samples += crate::number(valid.iter().filter(|valid| **valid).count()) / self.noise.alike;
    }

    /// The products of the block that ends here, and its samples; the next block begins.
    pub(super) fn finish_block(&mut self) -> (DMatrix<f64>, f64) {
        (self.products.take(), std::mem::take(&mut self.samples))
    }

    /// For each column: sums against random weights with the channel's mean taken out, then the sum of squares about the
    /// mean, then the sum of squares. Columns weigh by the noise of the channel.
    pub(crate) fn random_sums(&mut self, course: &Course, count: usize) -> DMatrix<f64> {
        let study = self.study;
        let scale = 1.0 / self.noise.white;
        let mut passage = Passage::new(study, self.at.scene, self.model);
        let mut sums = DMatrix::zeros(count + 2, self.width);
        let (mut column_sums, mut drawn_sums) = (vec![0.0; self.width], vec![0.0; count]);
        let mut samples = 0.0;
        let mut random = RandomWeights::new(self.at);
        for stretch in pieces(0..study.scenes[self.at.scene].rows(), STRETCH) {
            let rows = stretch.len();
            let moved = passage.moved(study, course, stretch.clone());
            let frame = Frame::new(study, course, &moved, stretch.clone());
            let mut columns = self.raw_columns(&[frame], &course.states(self.channel().kind).rows(stretch));
            columns *= scale;
            let mut drawn = DMatrix::from_fn(rows, count, |_, _| random.next());
            samples += crate::number(drop_unknown(&mut columns, &mut drawn));
            let columns = columns.columns(0, self.width);
            let products = drawn.transpose() * columns;
            for (number, sum) in drawn_sums.iter_mut().enumerate() {
                *sum += drawn.column(number).sum();
            }
            for column in 0..self.width {
                column_sums[column] += columns.column(column).sum();
                sums[(count + 1, column)] += columns.column(column).norm_squared();
                for number in 0..count {
                    sums[(number, column)] += products[(number, column)];
                }
            }
        }
        for column in 0..self.width {
            let mean = column_sums[column] / f64::max(samples, 1.0);
            for (number, drawn_sum) in drawn_sums.iter().enumerate() {
                sums[(number, column)] -= drawn_sum * mean;
            }
            sums[(count, column)] = sums[(count + 1, column)] - column_sums[column] * mean;
        }
        sums
    }

    /// The columns before whitening, the residual last, in the rows of these frames.
    pub(super) fn raw_columns(&mut self, frames: &[Frame<'_>], view: &Rows<'_>) -> DMatrix<f64> {
        self.seen.fill(true);
        let places = self.places();
        self.columns(&self.sights(frames), view, &places)
    }

    fn sights(&self, frames: &[Frame<'_>]) -> Vec<Sight> {
        let rows: usize = frames.iter().map(Frame::len).sum();
        parallel::counted(frames.len(), rows * self.regressors.len(), |number| self.sight(&frames[number]))
    }

    /// Marks the regressors of which there is something to see. One that was seen goes on: its filter remembers it.
    fn mark_seen(&mut self, sights: &[Sight]) {
        for (number, regressor) in self.regressors.iter().enumerate() {
            self.seen[number] = self.seen[number]
                || sights.iter().any(|sight| match regressor.effect.place {
                    Place::Motion { motion, side } => sight.gain(motion, side).is_some(),
                    Place::Instrument { .. } => sight.setting(number).is_some(),
                });
        }
        // The products of a few columns are summed in another order, which may change the last digit. So columns of zeros are added until
        // there are more: the result must not depend on how many regressors were seen.
        let mut missing = (NARROW + 1).saturating_sub(self.places().len());
        for (seen, regressor) in self.seen.iter_mut().zip(self.regressors) {
            if !*seen && missing > 0 {
                *seen = true;
                missing = missing.saturating_sub(regressor.columns());
            }
        }
    }

    /// The places of the columns of all regressors that were seen, and of the residual.
    fn places(&self) -> Vec<usize> {
        let (mut places, mut first) = (Vec::with_capacity(self.width + 1), 0);
        for (regressor, seen) in self.regressors.iter().zip(&self.seen) {
            let end = first + regressor.columns();
            places.extend((first..end).filter(|_| *seen));
            first = end;
        }
        places.push(self.width);
        places
    }

    /// The columns at these places, which are those of all regressors that were seen, and the residual.
    fn columns(&mut self, sights: &[Sight], view: &Rows<'_>, places: &[usize]) -> DMatrix<f64> {
        self.shapes.fill(view);
        let rows = view.len();
        let mut columns = DMatrix::zeros(rows, places.len());
        let mut rest = columns.as_mut_slice();
        let mut targets = Vec::with_capacity(self.regressors.len());
        for (number, regressor) in self.regressors.iter().enumerate().filter(|(number, _)| self.seen[*number])
        {
            let (target, others) = rest.split_at_mut(rows * regressor.columns());
            targets.push((number, target));
            rest = others;
        }
        let work = rows * places.len();
        parallel::each(&mut targets, work, |(number, target)| self.fill(*number, sights, rows, target));
        let mut from = 0;
        for sight in sights {
            rest[from..from + sight.residual.len()].copy_from_slice(&sight.residual);
            from += sight.residual.len();
        }
        columns
    }

    fn sight(&self, frame: &Frame<'_>) -> Sight {
        let (study, channel) = (self.study, self.channel());
        let drive = matches!(channel.kind, Kind::Drive(_));
        let settings = self.regressors.iter().enumerate().filter_map(|(number, regressor)| {
            let setting = regressor.effect.setting_of(self.at.scene)?;
            Some((number, frame.setting(study, self.at.scene, self.at.channel, setting, self.model)?))
        });
        Sight {
            after: frame.gains(study, self.at.scene, channel, self.model, Side::After),
            drive: drive.then(|| frame.gains(study, self.at.scene, channel, self.model, Side::Drive)),
            settings: settings.collect(),
            residual: frame.left(study, self.at.scene, (self.at.channel, channel), self.model),
        }
    }

    /// Fills the columns of one regressor, which are zero, with `rows` rows each.
    fn fill(&self, number: usize, sights: &[Sight], rows: usize, target: &mut [f64]) {
        let mut from = 0;
        for sight in sights {
            let stretch = from..from + sight.residual.len();
            from = stretch.end;
            if let Place::Motion { motion, side } = self.regressors[number].effect.place {
                let Some(gain) = sight.gain(motion, side) else { continue };
                for (column, term) in target.chunks_exact_mut(rows).zip(self.shapes.columns(number)) {
                    let values = gain.iter().zip(&term[stretch.clone()]);
                    for (target, (gain, term)) in column[stretch.clone()].iter_mut().zip(values) {
                        *target = gain * term;
                    }
                }
            } else if let Some(values) = sight.setting(number) {
                target[stretch].copy_from_slice(values);
            }
        }
    }
}

/// Sets rows that are not known in all columns to zero, in both matrices. Returns how many rows are left.
fn drop_unknown(columns: &mut DMatrix<f64>, drawn: &mut DMatrix<f64>) -> usize {
    let mut left = 0;
    for (row, is_known) in known(columns).into_iter().enumerate() {
        if is_known {
            left += 1;
        } else {
            columns.row_mut(row).fill(0.0);
            drawn.row_mut(row).fill(0.0);
        }
    }
    left
}

/// For each row whether all columns are known there.
fn known(columns: &DMatrix<f64>) -> Vec<bool> {
    // 0 times a finite number is 0; 0 times NaN is NaN. So a sum is 0 where all columns are known.
    let mut sums = vec![0.0; columns.nrows()];
    for column in columns.column_iter() {
        sums.iter_mut().zip(column.iter()).for_each(|(sum, value)| *sum += 0.0 * value);
    }
    sums.into_iter().map(|sum| sum == 0.0).collect()
}

/// Whitens columns that stand one behind the other, each with the state of its own filter.
fn whiten_all(steps: &[Step], filters: &mut [f64], columns: &mut [f64]) {
    let rows = steps.len().max(1);
    let work = columns.len();
    let together = columns.chunks_mut(TOGETHER * rows).zip(filters.chunks_mut(TOGETHER));
    let mut together: Vec<(&mut [f64], &mut [f64])> = together.collect();
    parallel::each(&mut together, work, |(columns, filters)| {
        whiten(steps, filters, columns);
        zero_faded(columns);
        zero_faded(filters);
    });
}

/// Sets to zero what has faded below [`FADED`]. The memory of a filter decays for ever over a column that is zero from some row on. It
/// becomes subnormal, and a processor takes a hundred times as long for a product of subnormal numbers.
fn zero_faded(values: &mut [f64]) {
    for value in values {
        *value = if value.abs() < FADED { 0.0 } else { *value };
    }
}

/// A number whose square adds nothing to any sum of squares.
const FADED: f64 = 1e-100;

/// Columns that are whitened at once. Each row of a filter waits for a multiplication and an addition of the row before, some 8 cycles;
/// meanwhile the other columns go on.
const TOGETHER: usize = 8;
