//! Noise beside effects: what noise a channel may have, judged by what none of its columns could explain.
//!
//! In: the residual of a channel and the columns of all effects in it, before whitening. Out: noises that it may have, each with its
//! probability, and the products of the columns behind the filter that makes that noise white.
//!
//! A fit takes noise with it, and most of all the slow part of a noise that wanders: of a recording that is short against the effects,
//! what is left looks smaller and whiter than the noise is. So noises are held against the restricted likelihood, that of what is left in
//! all directions that the columns leave open (Patterson and Thompson 1971). How long a noise lasts is known roughly from a short
//! recording, and the interval of an effect hangs on it: so no noise is chosen, and each counts as much as it is likely.

use std::collections::BTreeSet;

use nalgebra::{DMatrix, Matrix2, SymmetricEigen};

use crate::channel::ChannelAt;
use crate::design::{Design, Lower, Regressor};
use crate::model::Model;
use crate::noise::{Noise, Whitening, log_sizes, typical_step, whiten};
use crate::number;
use crate::study::Study;
use crate::sweep::Swept;
use crate::weights::Weights;

/// A noise that a channel may have.
pub(super) struct Possible {
    pub(super) noise: Noise,
    /// How probable it is; all of a channel are 1 together.
    pub(super) probability: f64,
    /// The products of all columns that are white under it, the residual last.
    pub(super) products: DMatrix<f64>,
    /// How many samples there are.
    pub(super) samples: f64,
}

/// A channel with its columns before whitening.
struct Seen {
    time: Vec<f64>,
    valid: Vec<bool>,
    /// Columns that are told and not zero everywhere, the residual last.
    columns: DMatrix<f64>,
    /// Their places among all.
    places: Vec<usize>,
    /// How many columns there are in all, with the residual.
    width: usize,
    samples: f64,
    step: f64,
    span: f64,
    /// The least standard deviation of the white part: that of the rounding of the data.
    floor: f64,
}

/// A noise in numbers that a likelihood tells apart: the logarithms of how far it wanders from row to row, in its white part, and of its
/// time constant, s.
type Point = [f64; 2];

/// What is left beside the columns under a noise whose white part is 1.
struct Left {
    /// Minus twice the logarithm of the restricted likelihood, its scale at its best.
    cost: f64,
    /// That scale: the standard deviation of the white part.
    scale: f64,
    products: DMatrix<f64>,
}

/// A point that was looked at.
struct Weighed {
    cost: f64,
    point: Point,
    left: Left,
}

/// The fewest samples that must be left beside the columns: of fewer, Student's distribution has hardly an end.
const FEWEST_LEFT: f64 = 3.0;

/// The noises that a channel may have beside those columns that are told, the likeliest first; none where these leave too few samples to
/// judge by.
pub(super) fn possible(
    study: &Study<'_>,
    at: ChannelAt,
    under: (&Model, &Weights),
    columns: (&[Regressor], &[bool]),
) -> Vec<Possible> {
    let seen = Seen::new(study, at, under, columns);
    let mut around = seen.around();
    around.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let least = around.first().map_or(0.0, |first| first.cost);
    let weight = |known: &Weighed| (-(known.cost - least) / 2.0).exp();
    let sum: f64 = around.iter().map(weight).sum();
    around.iter().map(|known| seen.possible(known, weight(known) / sum)).collect()
}

impl Seen {
    fn new(
        study: &Study<'_>,
        at: ChannelAt,
        (model, weights): (&Model, &Weights),
        (regressors, told): (&[Regressor], &[bool]),
    ) -> Self {
        let (scene, outliers) = (&study.scenes[at.scene], weights.outliers.of(at));
        let rows: Vec<usize> = (0..scene.rows()).collect();
        let all = Design::columns_in(study, at, model, regressors, &rows);
        let is_known = |row: &usize| all.row(*row).iter().all(|value| value.is_finite());
        let kept: Vec<usize> = rows.into_iter().filter(|row| !outliers[*row]).filter(is_known).collect();
        let all = all.select_rows(&kept);
        let response = all.ncols().saturating_sub(1);
        let acts = |column: usize| told[column] && all.column(column).iter().any(|value| *value != 0.0);
        let counts = |column: &usize| *column == response || acts(*column);
        let places: Vec<usize> = (0..all.ncols()).filter(counts).collect();
        let time: Vec<f64> = kept.iter().map(|row| scene.recording.time[*row]).collect();
        let step = typical_step(&time);
        let span = time.first().zip(time.last()).map_or(0.0, |(first, last)| last - first);
        Self {
            valid: vec![true; time.len()],
            columns: all.select_columns(&places),
            places,
            width: all.ncols(),
            samples: number(kept.len()),
            step,
            span: span.max(step),
            floor: study.channel(at).rounding,
            time,
        }
    }

    fn possible(&self, Weighed { point, left, .. }: &Weighed, probability: f64) -> Possible {
        let noise = self.noise(*point);
        let scale = left.scale.max(self.floor);
        Possible {
            noise: Noise { white: scale, wander: scale * noise.wander, ..noise },
            probability,
            products: self.whole(&left.products) / (scale * scale),
            samples: self.samples,
        }
    }

    /// The noise at a point, with a white part of 1.
    fn noise(&self, [walk, time]: Point) -> Noise {
        let time_constant = time.exp();
        let wander = walk.exp() / self.renewed(time_constant).sqrt();
        Noise { white: 1.0, wander, time_constant, alike: 1.0 }
    }

    /// The share of a wandering that is new from row to row.
    fn renewed(&self, time_constant: f64) -> f64 {
        1.0 - (-2.0 * self.step / time_constant).exp()
    }

    /// What is left under the noise at a point; nothing where too few samples are.
    fn left(&self, point: Point) -> Option<Left> {
        let steps = Whitening::new(self.noise(point)).steps(&self.time, &self.valid);
        let mut columns = self.columns.clone();
        let mut states = vec![0.0; columns.ncols()];
        whiten(&steps, &mut states, columns.as_mut_slice());
        let mut products = Lower::new(columns.ncols());
        let places: Vec<usize> = (0..columns.ncols()).collect();
        products.add(&columns, &places);
        let products = products.take();
        let mut swept = Swept::new(&products);
        let taken = (0..columns.ncols().saturating_sub(1)).filter(|column| swept.take(*column)).count();
        let freedom = self.samples - number(taken);
        let variance = swept.remaining() / freedom;
        if freedom < FEWEST_LEFT || !variance.is_finite() {
            return None;
        }
        let variance = variance.max(f64::MIN_POSITIVE);
        let cost = freedom * variance.ln() + log_sizes(&steps) + swept.log_determinant();
        Some(Left { cost, scale: variance.sqrt(), products })
    }

    /// The cost of a point: that of its likelihood, less for a noise that lasts longer.
    fn cost(&self, point: Point, left: &Left) -> f64 {
        left.cost - 2.0 * LASTING * point[1]
    }

    /// The points that are not far less likely than the likeliest one, each with its cost: a grid, as close as the likelihood changes; none
    /// where too few samples are left.
    fn around(&self) -> Vec<Weighed> {
        let Some((middle, widths)) = self.likeliest() else { return Vec::new() };
        let (from, steps) = (middle.point, self.steps(&middle, widths));
        let at = |(first, second): Place| {
            let [along, across] = steps;
            [0, 1].map(|number| {
                from[number] + f64::from(first) * along[number] + f64::from(second) * across[number]
            })
        };
        let mut lowest = middle.cost;
        let mut found = vec![middle];
        let (mut seen, mut open) = (BTreeSet::from([(0, 0)]), vec![(0, 0)]);
        while let Some(place) = open.pop() {
            for place in neighbours(place).into_iter().filter(|place| seen.insert(*place)) {
                let near = self.weighed(at(place)).filter(|known| known.cost < lowest + FAR);
                if let Some(known) = near {
                    lowest = lowest.min(known.cost);
                    found.push(known);
                    open.push(place);
                }
            }
        }
        found
    }

    /// The likeliest point, as near as matters, and in each direction a width over which the cost rises, by 1.5 at
    /// most.
    fn likeliest(&self) -> Option<(Weighed, Point)> {
        let starts = self.starts().into_iter().filter_map(|start| self.weighed(start));
        let mut best = starts.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        let mut widths = [WIDEST; 2];
        for _ in 0..MOST_STEPS {
            let mut is_done = true;
            for direction in [0, 1] {
                let beside = self.beside(best.point, direction, widths[direction]);
                let steepest = beside.iter().fold(0.0, |most, known| f64::max(most, known.cost - best.cost));
                let lower = beside.into_iter().filter(|known| known.cost < best.cost);
                match lower.min_by(|a, b| a.cost.total_cmp(&b.cost)) {
                    Some(lower) => (best, is_done) = (lower, false),
                    None if steepest > RISE => {
                        (widths[direction], is_done) = (widths[direction] / 2.0, false)
                    }
                    None => {}
                }
            }
            if is_done {
                break;
            }
        }
        Some((best, widths))
    }

    /// The steps of the grid about the likeliest point: along the ridge of the likelihood, and across it. Of a noise that is shorter and
    /// wanders further from row to row, much is the same.
    fn steps(&self, middle: &Weighed, widths: Point) -> [Point; 2] {
        let rise = |first: f64, second: f64| {
            let point = [middle.point[0] + first * widths[0], middle.point[1] + second * widths[1]];
            self.weighed(point).map(|known| known.cost - middle.cost)
        };
        let mean = |of: [Option<f64>; 2]| {
            let known: Vec<f64> = of.into_iter().flatten().collect();
            (!known.is_empty()).then(|| known.iter().sum::<f64>() / number(known.len()))
        };
        let [first, second] =
            [mean([rise(1.0, 0.0), rise(-1.0, 0.0)]), mean([rise(0.0, 1.0), rise(0.0, -1.0)])];
        let same = mean([rise(1.0, 1.0), rise(-1.0, -1.0)]);
        let other = mean([rise(1.0, -1.0), rise(-1.0, 1.0)]);
        let both = same.zip(other).map_or(0.0, |(same, other)| (same - other) / 4.0);
        let curved = Matrix2::new(first.unwrap_or_default(), both, both, second.unwrap_or_default());
        let SymmetricEigen { eigenvectors, eigenvalues } = curved.symmetric_eigen();
        [0, 1].map(|number| {
            let axis = eigenvectors.column(number);
            let step = (RISE / eigenvalues[number].max(f64::MIN_POSITIVE)).sqrt();
            let [walk, time] = [step * axis[0] * widths[0], step * axis[1] * widths[1]];
            let longest = walk.abs().max(time.abs());
            let shorter = if longest > WIDEST { WIDEST / longest } else { 1.0 };
            [walk * shorter, time * shorter]
        })
    }

    /// The two neighbours of a point in a direction, where the recording tells them apart.
    fn beside(&self, point: Point, direction: usize, width: f64) -> Vec<Weighed> {
        let at = |by: f64| {
            let mut near = point;
            near[direction] += by;
            self.weighed(near)
        };
        [-width, width].into_iter().filter_map(at).collect()
    }

    /// Where the search for the likeliest point may begin: at short and at long times.
    fn starts(&self) -> Vec<Point> {
        let times = [1.5 * self.step, 10.0 * self.step, 0.1 * self.span, self.span];
        let walks = [0.1_f64, 1.0];
        times.into_iter().flat_map(|time| walks.map(|walk| self.inside([walk.ln(), time.ln()]))).collect()
    }

    /// A point with its cost; nothing where it lies beyond what the recording tells apart.
    fn weighed(&self, point: Point) -> Option<Weighed> {
        let left = self.left(point).filter(|_| self.beyond(point) <= ROUNDED)?;
        Some(Weighed { cost: self.cost(point, &left), point, left })
    }

    /// The products with those of the columns that are zero.
    fn whole(&self, products: &DMatrix<f64>) -> DMatrix<f64> {
        let mut whole = DMatrix::zeros(self.width, self.width);
        for (row, of_row) in self.places.iter().enumerate() {
            for (column, of_column) in self.places.iter().enumerate() {
                whole[(*of_row, *of_column)] = products[(row, column)];
            }
        }
        whole
    }

    /// A point moved to where the recording tells it apart.
    fn inside(&self, [walk, time]: Point) -> Point {
        let time = time.clamp((SHORTEST * self.step).ln(), (LONGEST * self.span).ln());
        [walk.clamp(self.least_walk(time), MOST.ln()), time]
    }

    /// By how much a point lies beyond that.
    fn beyond(&self, point: Point) -> f64 {
        let inside = self.inside(point);
        (point[0] - inside[0]).abs() + (point[1] - inside[1]).abs()
    }

    /// The least wandering that differs from none.
    fn least_walk(&self, time: f64) -> f64 {
        (LEAST / self.samples.sqrt() * self.renewed(time.exp()).sqrt()).ln()
    }
}

/// A place in a grid.
type Place = (i32, i32);

fn neighbours((row, column): Place) -> [Place; 4] {
    [(row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)]
}

/// A noise lasts half a step at least: a shorter one is white.
const SHORTEST: f64 = 0.5;
/// A noise that lasts ten recordings is a walk in each of them.
const LONGEST: f64 = 10.0;
/// A wandering of this share of what the mean of all samples is off by its white part is none: 4 % of that of the mean.
const LEAST: f64 = 0.2;
/// Of a noise that wanders by this many times its white part from row to row nobody sees the white part: it is 1 / 19 of the variance of
/// a difference of neighbours.
const MOST: f64 = 3.0;

/// How much more a noise counts that lasts longer, as a power of its time constant. What a recording cannot tell apart is the slow part of
/// its noise: of a few turns of a wave it is mostly fitted away, so that noises that last long look as if they were short. By simulated
/// sessions of one to five turns 0.90 to 0.95 of the intervals hold the truth without it, and 0.93 to 0.97 with it
/// (`short_sessions_have_intervals_that_hold_the_truth`).
const LASTING: f64 = 0.5;

/// What is left of a bound by the rounding of numbers.
const ROUNDED: f64 = 1e-9;

/// Neighbours in the grid differ in cost by so much at the likeliest point: 1.2 standard deviations apart, sums over the grid are integrals.
const RISE: f64 = 1.5;
/// The widest grid, in e-folds: the form of a noise changes within one.
const WIDEST: f64 = 1.2;
/// The search ends long before: each step goes down, or halves a width.
const MOST_STEPS: usize = 200;
/// Points with so much more cost are left out: each has a hundredth of the probability of the likeliest.
const FAR: f64 = 9.0;

#[cfg(test)]
mod tests;
