//! Nodes where a curve bends: those of a table that says most with fewest.
//!
//! In: a model without what imitates a curve, and nodes. Out: a table of the motion along the axis, with those of the nodes that the
//! curve needs. A table on some of the nodes is a sum of hats on all of them, so that one design tells what
//! each of these tables leaves.

use nalgebra::DMatrix;

use crate::curves::fitted_places;
use crate::design::{Design, Regressor};
use crate::model::{Effect, Model, Place};
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;
use crate::weights::Weights;

/// A table with as few of these nodes as Schwarz's criterion leaves; `None` where too few of them lie where something is fitted.
pub(crate) fn thinned(
    study: &Study<'_>,
    kept: &Model,
    (place, axis): (Place, usize),
    all: &[f64],
    weights: &Weights,
) -> Option<Shape> {
    let all = within(all.to_vec(), &fitted_places(study, axis));
    if all.len() < FEWEST {
        return None;
    }
    let shape = |nodes: Vec<f64>| Shape::Table { axis, nodes, directed: false, repeats: false };
    let mut regressors = Regressor::all(&kept.effects);
    regressors.push(Regressor::of(Effect { place, shape: shape(all.clone()) }));
    let mut design = Design::new(study, kept, weights, regressors);
    design.rebase(&kept.effects);
    let (products, samples) = design.fitted();
    let curve = Curve { first: *design.first.last()?, products, samples };
    let mut nodes: Vec<usize> = (0..all.len()).collect();
    let mut cost = curve.cost(&nodes);
    while nodes.len() > FEWEST {
        let (least, without) = (1..nodes.len() - 1)
            .map(|at| {
                let mut fewer = nodes.clone();
                fewer.remove(at);
                (curve.cost(&fewer), fewer)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        if least >= cost {
            break;
        }
        (cost, nodes) = (least, without);
    }
    Some(shape(nodes.into_iter().map(|node| all[node]).collect()))
}

/// The nodes from the first to the last one at which something is fitted: one of some places is nearer to it than to the next node. An end of
/// which only held-out samples know could have any value.
fn within(mut nodes: Vec<f64>, places: &[f64]) -> Vec<f64> {
    let nearer = |end: f64, next: f64| places.iter().any(|place| (place - end).abs() <= (place - next).abs());
    while let [first, second, ..] = nodes[..] {
        if nearer(first, second) {
            break;
        }
        nodes.remove(0);
    }
    while let [.., before, last] = nodes[..] {
        if nearer(last, before) {
            break;
        }
        nodes.pop();
    }
    nodes
}

/// A table of fewer nodes is a slope or a bend, which have names of their own.
const FEWEST: usize = 4;

/// The products of the columns of a model, of a hat on each node, and of the response.
struct Curve {
    /// The column of the first hat.
    first: usize,
    products: DMatrix<f64>,
    samples: f64,
}

impl Curve {
    /// What a table on some of the nodes costs.
    fn cost(&self, nodes: &[usize]) -> f64 {
        let joined = self.joined(nodes);
        let products = joined.tr_mul(&self.products) * &joined;
        let mut swept = Swept::new(&products);
        for column in 0..products.nrows() - 1 {
            swept.take(column);
        }
        let left = (swept.remaining() / self.samples.max(1.0)).max(f64::MIN_POSITIVE);
        self.samples * left.ln() + crate::number(nodes.len()) * self.samples.max(2.0).ln()
    }

    /// The columns of the table on some nodes, as sums of those on all of them.
    fn joined(&self, nodes: &[usize]) -> DMatrix<f64> {
        let mut joined = DMatrix::zeros(self.products.nrows(), self.first + nodes.len() + 1);
        for column in 0..self.first {
            joined[(column, column)] = 1.0;
        }
        joined[(self.products.nrows() - 1, self.first + nodes.len())] = 1.0;
        for (number, pair) in nodes.windows(2).enumerate() {
            let (from, to) = (pair[0], pair[1]);
            for node in from..to {
                let share = crate::number(node - from) / crate::number(to - from);
                joined[(self.first + node, self.first + number)] = 1.0 - share;
                joined[(self.first + node, self.first + number + 1)] = share;
            }
        }
        if let Some(last) = nodes.last() {
            joined[(self.first + last, self.first + nodes.len() - 1)] = 1.0;
        }
        joined
    }
}

#[cfg(test)]
mod tests;
