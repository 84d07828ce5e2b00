//! The joint fit: all effects of a model at once, those parameters included that are not linear.
//!
//! In: chosen effects. Out: their coefficients with the covariance that the correlated noise gives them.

use nalgebra::{DMatrix, DVector};

use crate::design::{Design, Products, Regressor};
use crate::harmonics;
use crate::model::{Effect, Fitted, Model};
use crate::ranges::range;
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;
use crate::travel::Travel;
use crate::weights::Weights;

/// A fitted model and how certain it is.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub(crate) model: Model,
    /// For each effect: the covariance of its linear coefficients, its nonlinear parameter last where it has one.
    pub(crate) covariances: Vec<DMatrix<f64>>,
    /// The whitened sum of squares of the fitted blocks, and their samples.
    pub(crate) remaining: f64,
    pub(crate) samples: f64,
}

/// The effects of chosen regressors of a rebased design, by linear least squares. The first regressors, `settings` in number, are among them.
pub(crate) fn linear(
    design: &Design,
    products: &DMatrix<f64>,
    settings: usize,
    chosen: &[usize],
) -> Vec<Fitted> {
    let numbers: Vec<usize> = (0..settings).chain(chosen.iter().copied()).collect();
    let mut swept = Swept::new(products);
    for column in numbers.iter().flat_map(|number| design.columns(*number)) {
        swept.take(column);
    }
    let fitted = |number: &usize| Fitted {
        effect: design.regressors[*number].effect.clone(),
        coefficients: design.columns(*number).map(|column| swept.coefficient(column)).collect(),
    };
    numbers.iter().map(fitted).collect()
}

/// The most steps of a fit.
const STEPS: usize = 12;
/// A fit is done when the sum of squares falls by less than this share.
const DONE: f64 = 1e-7;

/// Fits all parameters of a model, from where it stands, by Gauss-Newton steps that never make it worse.
pub(crate) fn refine(study: &Study<'_>, model: Model, weights: &Weights, travels: &[Travel]) -> Fit {
    let groups = harmonics::sharing(&model.effects);
    let mut best = Linearised::new(study, model, weights, &groups);
    let mut size = 1.0;
    for _ in 0..STEPS {
        let next = Linearised::new(study, best.stepped(study, size, travels), weights, &groups);
        let fall = (best.remaining - next.remaining) / best.remaining;
        if fall >= 0.0 {
            best = next;
            size = 1.0;
        } else {
            size *= 0.3;
        }
        if fall.abs() < DONE || size < 1e-3 {
            break;
        }
    }
    best.fit()
}

/// The covariance of each effect of a fitted model whose intervals may be as narrow as the likelihood has them times `least`, where they
/// scatter no more from block to block.
pub(crate) fn covariances(
    study: &Study<'_>,
    model: &Model,
    weights: &Weights,
    least: &[f64],
) -> Vec<DMatrix<f64>> {
    let groups = harmonics::sharing(&model.effects);
    Linearised::new(study, model.clone(), weights, &groups).covariances(least)
}

/// The standard deviation of the nonlinear parameter of one effect of a fitted model, as far as this effect alone shows it: others that
/// share it keep theirs.
pub(crate) fn deviation_alone(
    study: &Study<'_>,
    model: &Model,
    weights: &Weights,
    number: usize,
) -> Option<f64> {
    let mut groups = harmonics::sharing(&model.effects);
    *groups.iter_mut().find(|group| group.contains(&number))? = vec![number];
    let fit = Linearised::new(study, model.clone(), weights, &groups).fit();
    fit.covariances[number].diagonal().iter().next_back().map(|variance| variance.sqrt())
}

/// A model with its design, slopes included.
struct Linearised<'g> {
    model: Model,
    design: Design,
    /// For each effect the regressor of its slope, where it has one. Harmonics of one wave have one together.
    slopes: Vec<Option<usize>>,
    /// The numbers of the effects that share a nonlinear parameter.
    groups: &'g [Vec<usize>],
    swept: Swept,
    remaining: f64,
    samples: f64,
}

impl<'g> Linearised<'g> {
    fn new(study: &Study<'_>, model: Model, weights: &Weights, groups: &'g [Vec<usize>]) -> Self {
        let mut regressors = Regressor::all(&model.effects);
        let mut slopes = vec![None; model.effects.len()];
        for group in groups {
            group.iter().for_each(|number| slopes[*number] = Some(regressors.len()));
            regressors.push(Regressor::slope(&model.effects, group));
        }
        let design = Design::new(study, &model, weights, regressors);
        let (products, samples) = design.fitted();
        let mut swept = Swept::new(&products);
        let remaining = swept.remaining();
        for column in 0..design.width {
            swept.take(column);
        }
        Self { model, design, slopes, groups, swept, remaining, samples }
    }

    /// The model after a step of this size (1: the whole step) towards the least squares.
    fn stepped(&self, study: &Study<'_>, size: f64, travels: &[Travel]) -> Model {
        let parameters = self.parameters(study, size, travels);
        let step = |(number, fitted): (usize, &Fitted)| {
            let change = |column: usize| size * self.swept.coefficient(column);
            let coefficients: Vec<f64> = fitted
                .coefficients
                .iter()
                .zip(self.design.columns(number))
                .map(|(coefficient, column)| coefficient + change(column))
                .collect();
            let coefficients = match fitted.effect.shape {
                // A loop that rings cannot run ahead of its command.
                Shape::Lag { inertia, .. } if inertia > 0.0 => {
                    coefficients.iter().map(|lag| lag.max(1e-7)).collect()
                }
                _ => coefficients,
            };
            let moved = parameters[number].map(|value| fitted.effect.shape.with_nonlinear(value));
            let shape = moved.unwrap_or_else(|| fitted.effect.shape.clone());
            let (shape, coefficients) = timed(shape, coefficients);
            Fitted { effect: Effect { place: fitted.effect.place, shape }, coefficients }
        };
        self.model.with_effects(self.model.effects.iter().enumerate().map(step))
    }

    /// The nonlinear parameter of each effect after a step of this size. One that several share goes as far as all of them may.
    fn parameters(&self, study: &Study<'_>, size: f64, travels: &[Travel]) -> Vec<Option<f64>> {
        let mut parameters = vec![None; self.model.effects.len()];
        for group in self.groups {
            let shapes = || group.iter().map(|number| &self.model.effects[*number].effect.shape);
            let moved = shapes().zip(group).filter_map(|(shape, number)| {
                let (slope, now) = (self.slopes[*number]?, shape.nonlinear()?.value);
                let change = size * self.swept.coefficient(self.design.first[slope]);
                let most = furthest(shape, travels);
                let change = change.clamp(-most, most).clamp(-0.5 * now, now);
                let (least, most) = range(study, travels, shape);
                Some((now, (now + change).max(least.min(now)).min(most.max(now))))
            });
            let nearest = moved.min_by(|a, b| (a.1 - a.0).abs().total_cmp(&(b.1 - b.0).abs()));
            group.iter().for_each(|number| parameters[*number] = nearest.map(|(_, value)| value));
        }
        parameters
    }

    fn fit(self) -> Fit {
        let covariances = self.covariances(&vec![1.0; self.model.effects.len()]);
        Fit { covariances, remaining: self.remaining, samples: self.samples, model: self.model }
    }

    /// The covariance of each effect. Its intervals are as wide as estimates scatter from block to block, and no narrower than the
    /// likelihood has them times `least`.
    fn covariances(&self, least: &[f64]) -> Vec<DMatrix<f64>> {
        let scale = self.swept.remaining() / self.samples.max(1.0);
        let widths = widths(&self.design, &self.swept, scale);
        let covariance = |number: usize| {
            let mut columns: Vec<usize> = self.design.columns(number).collect();
            columns.extend(self.slopes[number].map(|slope| self.design.first[slope]));
            let width = |column: usize| widths[columns[column]].max(least[number]);
            DMatrix::from_fn(columns.len(), columns.len(), |row, column| {
                let widened = width(row) * width(column);
                scale * widened * self.swept.covariance(columns[row], columns[column])
            })
        };
        (0..self.model.effects.len()).map(covariance).collect()
    }
}

/// Moves the coefficient of a delay into its time: 1.2 times a delay of 5 ms is nearly a delay of 6 ms. The fit is repeated until the
/// coefficient is 1, where the two are the same.
fn timed(shape: Shape, coefficients: Vec<f64>) -> (Shape, Vec<f64>) {
    match (&shape, coefficients.as_slice()) {
        (Shape::Delay { axis, time }, [times]) => {
            let time = time * times.clamp(1.0 / FURTHEST_TIME, FURTHEST_TIME);
            (Shape::Delay { axis: *axis, time }, vec![1.0])
        }
        _ => (shape, coefficients),
    }
}

/// How many times longer or shorter a delay may become in one step: the motion of an axis is straight over a few times a delay, not
/// over many.
const FURTHEST_TIME: f64 = 3.0;

/// For each column by how far estimates scatter from block to block, in units of the standard deviation that the likelihood has: this asks
/// the data themselves how much of them is independent. The sandwich estimator, with the blocks for meat. 0 where there are too few blocks.
pub(crate) fn widths(design: &Design, swept: &Swept, scale: f64) -> Vec<f64> {
    let width = design.width;
    let blocks: Vec<&Products> = design.blocks.iter().filter(|block| !block.held_out).collect();
    let count = crate::number(blocks.len());
    if count < FEWEST_BLOCKS {
        return vec![0.0; width];
    }
    let coefficients: Vec<f64> = (0..width).map(|column| swept.coefficient(column)).collect();
    let bread = DMatrix::from_fn(width, width, |row, column| swept.covariance(row, column));
    let mut variances = vec![0.0; width];
    for block in blocks {
        let score = DVector::from_fn(width, |row, _| {
            let explained: f64 =
                (0..width).map(|column| block.matrix[(row, column)] * coefficients[column]).sum();
            block.matrix[(row, width)] - explained
        });
        let moved = &bread * score;
        variances.iter_mut().zip(moved.iter()).for_each(|(variance, moved)| *variance += moved * moved);
    }
    let student = 1.0 + STUDENT / count;
    let ratio = |column: usize| {
        let own = scale * bread[(column, column)];
        let scattered = variances[column] * count / (count - 1.0);
        if own > 0.0 { (scattered / own).sqrt() * student } else { 0.0 }
    };
    (0..width).map(ratio).collect()
}

/// The fewest blocks from which a scatter is told.
const FEWEST_BLOCKS: f64 = 6.0;
/// The 97.5 % point of Student's distribution of n - 1 degrees of freedom is that of the normal one times 1 + 1.5 / n, within 2 %
/// from six on.
const STUDENT: f64 = 1.5;

/// How far a nonlinear parameter may go in one step: a wave must not slip by a cycle.
fn furthest(shape: &Shape, travels: &[Travel]) -> f64 {
    match shape.core() {
        // A harmonic slips by a cycle first.
        Shape::Cyclic { axis, period, order, .. } => {
            let cycles = f64::from(*order) * (travels[*axis].range() / period).max(1.0);
            0.3 * period / cycles
        }
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests;
