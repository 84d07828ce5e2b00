//! Select: as few coefficients as pay.
//!
//! In: a problem. Out: least squares of a few coefficients, all others standing. They are taken one after the other, the one
//! that lowers the price most: `n ln(sum of squares / n) + k (ln n + 2 ln p)`, the criterion of Schwarz with what it costs to
//! have looked among p candidates. Each must lower the leave-one-out error too, and one that no longer pays goes again. The
//! values of one table are taken together. Of candidates that the points cannot tell apart the one is taken that has to
//! change least, relative to itself; the others are named beside it.

use nalgebra::{DMatrix, DVector};

use crate::matrix::extend;
use crate::number;
use crate::singular::{Decomposition, Scaling};
use crate::solution::{Problem, Solution};

/// What no measurement of a part tells from zero, mm: an exact fit has a price too.
const FLOOR: f64 = 1e-6;

/// Prices that differ by less do not decide between two candidates.
const UNDECIDED: f64 = 2.0;

/// Solves a problem; nothing where singular values cannot be computed.
pub(crate) fn solve(problem: &Problem) -> Option<Solution> {
    let search = Search::new(problem);
    let mut chosen: Vec<usize> = Vec::new();
    while let Some(better) = search.better(&chosen)? {
        chosen = better;
    }
    let fit = search.fit(&chosen)?;
    let mut solution = fit.solution;
    for piece in &chosen {
        let others = search.alternatives(&chosen, *piece, fit.price)?;
        for coefficient in search.columns(&[*piece]) {
            if let Some(slot) = solution.alternatives.get_mut(coefficient) {
                slot.clone_from(&others);
            }
        }
    }
    Some(solution)
}

struct Search<'p> {
    problem: &'p Problem,
    /// All pieces in order.
    pieces: Vec<usize>,
}

/// A choice, fitted.
struct Fit {
    solution: Solution,
    price: f64,
    leave_one_out: Option<f64>,
}

impl<'p> Search<'p> {
    fn new(problem: &'p Problem) -> Self {
        let mut pieces = problem.pieces.clone();
        pieces.dedup();
        Self { problem, pieces }
    }

    /// The coefficients of some pieces.
    fn columns(&self, chosen: &[usize]) -> Vec<usize> {
        let all = self.problem.pieces.iter().enumerate();
        all.filter(|(_, piece)| chosen.contains(piece)).map(|(column, _)| column).collect()
    }

    /// The choice with one more piece, less those that no longer pay; `Some(None)` where nothing is gained.
    fn better(&self, chosen: &[usize]) -> Option<Option<Vec<usize>>> {
        let present = self.fit(chosen)?;
        let mut best: Option<(usize, Fit)> = None;
        let basis = self.basis(chosen);
        let open = self.pieces.iter().filter(|piece| !chosen.contains(piece));
        for piece in open.filter(|piece| self.price_with(&basis, chosen, **piece) < present.price) {
            let with: Vec<usize> = chosen.iter().copied().chain([*piece]).collect();
            let fit = self.fit(&with)?;
            let better = best.as_ref().is_none_or(|(other, known)| {
                let alike = (fit.price - known.price).abs() < 1e-6;
                let least = self.greatest_change(&fit, *piece) < self.greatest_change(known, *other);
                if alike { least } else { fit.price < known.price }
            });
            if better {
                best = Some((*piece, fit));
            }
        }
        let pays = |fit: &Fit| {
            fit.price < present.price
                && fit.leave_one_out.zip(present.leave_one_out).is_some_and(|(after, before)| after < before)
        };
        let Some((piece, fit)) = best.filter(|(_, fit)| pays(fit)) else { return Some(None) };
        let with = chosen.iter().copied().chain([piece]).collect();
        self.pruned(with, fit.price).map(Some)
    }

    /// The choice without those pieces that no longer pay.
    fn pruned(&self, mut chosen: Vec<usize>, mut price: f64) -> Option<Vec<usize>> {
        let mut place = 0;
        while place < chosen.len() {
            let without: Vec<usize> = (chosen.iter().enumerate())
                .filter(|(other, _)| *other != place)
                .map(|(_, piece)| *piece)
                .collect();
            let fit = self.fit(&without)?;
            if fit.price < price {
                (chosen, price, place) = (without, fit.price, 0);
            } else {
                place += 1;
            }
        }
        Some(chosen)
    }

    /// The pieces that would do nearly as well in the place of one of them.
    fn alternatives(&self, chosen: &[usize], piece: usize, price: f64) -> Option<Vec<usize>> {
        let others: Vec<usize> = chosen.iter().copied().filter(|other| *other != piece).collect();
        let basis = self.basis(&others);
        let open = self.pieces.iter().filter(|other| !chosen.contains(other));
        let mut alike: Vec<(f64, usize)> = open
            .map(|other| (self.price_with(&basis, &others, *other), *other))
            .filter(|(other, _)| *other < price + UNDECIDED)
            .collect();
        alike.sort_by(|left, right| left.0.total_cmp(&right.0).then(left.1.cmp(&right.1)));
        let first = |piece: &usize| self.columns(&[*piece]).first().copied();
        Some(alike.iter().filter_map(|(_, piece)| first(piece)).collect())
    }

    fn greatest_change(&self, fit: &Fit, piece: usize) -> f64 {
        let columns = self.columns(&[piece]);
        columns.iter().filter_map(|column| fit.solution.change.get(*column)).fold(0.0, |a, b| a.max(b.abs()))
    }

    /// What is explained already: the zeros of the parts and the columns of some pieces.
    fn basis(&self, chosen: &[usize]) -> Vec<DVector<f64>> {
        let mut basis = self.problem.datum.basis();
        for column in self.columns(chosen) {
            extend(&mut basis, self.problem.jacobian.column(column).into_owned());
        }
        basis
    }

    /// The price of a choice with one more piece, from what is explained without it.
    fn price_with(&self, basis: &[DVector<f64>], chosen: &[usize], piece: usize) -> f64 {
        let mut basis = basis.to_vec();
        let before = basis.len();
        for column in self.columns(&[piece]) {
            extend(&mut basis, self.problem.jacobian.column(column).into_owned());
        }
        if basis.len() == before {
            return f64::INFINITY;
        }
        let left = crate::matrix::without(&basis, &self.problem.residual);
        self.price(left.norm_squared(), self.columns(chosen).len() + self.columns(&[piece]).len())
    }

    fn price(&self, sum: f64, coefficients: usize) -> f64 {
        let rows = self.problem.free_rows();
        let candidates = number(self.pieces.len().max(1));
        if rows - number(coefficients) < 1.0 {
            return f64::INFINITY;
        }
        let mean = (sum / rows).max(FLOOR * FLOOR);
        rows * mean.ln() + number(coefficients) * (rows.ln() + 2.0 * candidates.ln())
    }

    /// Least squares of some pieces.
    fn fit(&self, chosen: &[usize]) -> Option<Fit> {
        let columns = self.columns(chosen);
        let all = self.problem.jacobian.ncols();
        let selected = DMatrix::from_fn(self.problem.rows(), columns.len(), |row, place| {
            let column = columns.get(place).copied().unwrap_or(0);
            self.problem.jacobian.get((row, column)).copied().unwrap_or(0.0)
        });
        let reduced = Problem {
            jacobian: selected,
            residual: self.problem.residual.clone(),
            datum: self.problem.datum.clone(),
            pieces: Vec::new(),
        };
        let decomposition = Decomposition::of(&reduced.jacobian, Scaling::Greatest, None)?;
        let own = decomposition.solve(&reduced);
        let left = reduced.left(&own.change);
        let price = self.price(left.norm_squared(), columns.len());
        let leave_one_out = reduced.leave_one_out(&left, &own.leverage);
        let mut solution = Solution {
            change: DVector::zeros(all),
            moved: vec![false; all],
            spread: vec![None; all],
            root: own.root.as_ref().map(|root| DMatrix::zeros(all, root.ncols())),
            alternatives: vec![Vec::new(); all],
            ..own.clone()
        };
        for (place, column) in columns.iter().enumerate() {
            solution.change[*column] = own.change[place];
            solution.moved[*column] = true;
            solution.spread[*column] = own.spread[place];
            if let (Some(root), Some(known)) = (&mut solution.root, &own.root) {
                root.row_mut(*column).copy_from(&known.row(place));
            }
        }
        Some(Fit { solution, price, leave_one_out })
    }
}
