//! The contest: candidates against what was found.
//!
//! In: what was found, and a column for each candidate. Out: what a model with a candidate costs. All models are compared under the
//! noise that the search ended with. Each consists of a candidate and of those effects found that are still worth their price beside
//! it. A candidate that makes most effects needless lowers the cost.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::channel::ChannelAt;
use crate::design::{Design, Regressor};
use crate::engine::Found;
use crate::model::{Effect, Model};
use crate::noise::{Step, Whitening, whiten};
use crate::parallel;
use crate::search::untold_price;
use crate::study::Study;
use crate::sweep::{Swept, misfit};
use crate::terms::Shape;
use crate::weights::Weights;

/// A candidate must lower the cost by this much. The cost is that of Schwarz's criterion, and the odds are then 150 to 1.
pub(crate) const DECISIVE: f64 = 10.0;

/// How many columns are worked out at once. With the largest number of rows they take 10 MB.
const CHUNK: usize = 256;

/// Products of the columns of what was found, of the candidates, and of the response that both have to explain.
pub(crate) struct Contest {
    /// For each candidate its products with the columns of what was found, with itself, and with the response.
    products: Vec<Vec<f64>>,
    /// The products of what was found, the response last.
    known: DMatrix<f64>,
    effects: Vec<Member>,
    pub(crate) samples: f64,
}

/// An effect of the model: its number there, its columns and its price. Settings that are always fitted have no price and stay.
struct Member {
    number: usize,
    columns: Range<usize>,
    price: Option<f64>,
}

/// The cheapest model with a candidate, or without any.
pub(crate) struct Outcome {
    pub(crate) cost: f64,
    /// The coefficient of the candidate, and its standard deviation; 0 without one.
    pub(crate) amount: f64,
    pub(crate) deviation: f64,
    /// The effects found that are worth their price beside it, by their numbers in the model, in rising order.
    pub(crate) kept: Vec<usize>,
}

/// Effects of a model, and the products with their columns swept in.
type Set<'m> = (Swept, Vec<&'m Member>);

/// The columns of some candidates in the rows of a channel.
pub(crate) type Columns<'c> = dyn Fn(Range<usize>, ChannelAt) -> Vec<Vec<f64>> + Sync + 'c;

impl Contest {
    /// Works out the products over all recordings, in the given rows of each, under these weights. The model is what was
    /// found, and behind it what may be missing, with coefficients of 0. `candidates` is the number of candidates.
    pub(crate) fn new(
        study: &Study<'_>,
        (found, model, weights): (&Found, &Model, &Weights),
        rows: &[Vec<usize>],
        candidates: usize,
        of_candidates: &Columns<'_>,
    ) -> Self {
        let regressors = Regressor::all(&model.effects);
        let width: usize = regressors.iter().map(Regressor::columns).sum();
        let mut contest = Self {
            products: vec![vec![0.0; width + 2]; candidates],
            known: DMatrix::zeros(width + 1, width + 1),
            effects: Vec::new(),
            samples: 0.0,
        };
        for (scene, rows) in rows.iter().enumerate() {
            for channel in 0..study.scenes[scene].channels.len() {
                let at = ChannelAt { scene, channel };
                let mut columns = Design::columns_in(study, at, model, &regressors, rows);
                let coefficients: Vec<f64> =
                    model.effects.iter().flat_map(|fitted| &fitted.coefficients).copied().collect();
                add_back(&mut columns, &coefficients);
                contest.add(study, at, (weights, rows), columns, of_candidates);
            }
        }
        let conditions = found.conditions();
        let mut first = 0;
        for (number, fitted) in model.effects.iter().enumerate() {
            let columns = first..first + regressors[number].columns();
            first = columns.end;
            let price = if model.chosen_numbers().contains(&number) {
                Some(conditions.price(study, &fitted.effect, contest.samples))
            } else {
                price_of_a_run(&fitted.effect, contest.samples)
            };
            contest.effects.push(Member { number, columns, price });
        }
        contest
    }

    /// Adds the rows of one channel.
    fn add(
        &mut self,
        study: &Study<'_>,
        at: ChannelAt,
        (weights, rows): (&Weights, &[usize]),
        mut columns: DMatrix<f64>,
        of_candidates: &Columns<'_>,
    ) {
        let known = &study.scenes[at.scene];
        let (noise, outliers) = (weights.noise(at), weights.outliers.of(at));
        let fitted = known.fitted_rows();
        let valid: Vec<bool> = rows
            .iter()
            .enumerate()
            .map(|(place, row)| !outliers[*row] && columns.row(place).iter().all(|value| value.is_finite()))
            .collect();
        let counts = |place: usize| valid[place] && fitted[rows[place]];
        let time: Vec<f64> = rows.iter().map(|row| known.recording.time[*row]).collect();
        let steps = Whitening::new(noise).steps(&time, &valid);
        for mut column in columns.column_iter_mut() {
            whitened(&steps, column.as_mut_slice());
            (0..rows.len()).filter(|place| !counts(*place)).for_each(|place| column[place] = 0.0);
        }
        self.samples += crate::number((0..rows.len()).filter(|place| counts(*place)).count()) / noise.alike;
        self.known += columns.tr_mul(&columns);
        let width = columns.ncols() - 1;
        for first in (0..self.products.len()).step_by(CHUNK) {
            let chunk = first..(first + CHUNK).min(self.products.len());
            let raw = of_candidates(chunk.clone(), at);
            let products = parallel::counted(raw.len(), raw.len() * rows.len(), |number| {
                let mut column = raw[number].clone();
                column.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
                whitened(&steps, &mut column);
                (0..rows.len()).filter(|place| !counts(*place)).for_each(|place| column[place] = 0.0);
                let square: f64 = column.iter().map(|value| value * value).sum();
                let mut products: Vec<f64> =
                    columns.column_iter().map(|known| dot(known.as_slice(), &column)).collect();
                products.insert(width, square);
                products
            });
            for (sums, products) in self.products[chunk].iter_mut().zip(products) {
                sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
            }
        }
    }

    /// The cheapest model with a candidate, or without any, and with those effects found that are worth their price.
    pub(crate) fn outcome(&self, candidate: Option<usize>) -> Outcome {
        let width = self.known.ncols() - 1;
        let mut bare = Swept::new(&self.matrix(candidate));
        let stays = |member: &&Member| member.price.is_none();
        for column in self.effects.iter().filter(stays).flat_map(|member| member.columns.clone()) {
            bare.take(column);
        }
        if candidate.is_some() {
            bare.take(width);
        }
        // Effects that stand in for the candidate may each seem worth their price beside the others. So they are also taken in one by one,
        // from none.
        let others = || self.effects.iter().filter(|member| member.price.is_some()).collect::<Vec<_>>();
        let whole = self.cut_down((bare.clone(), Vec::new()), others());
        let built = self.built_up((bare, Vec::new()), others());
        let (swept, cost, members) = if built.1 < whole.1 { built } else { whole };
        let scale = swept.remaining() / self.samples.max(1.0);
        Outcome {
            cost,
            amount: candidate.map_or(0.0, |_| swept.coefficient(width)),
            deviation: candidate.map_or(0.0, |_| (scale * swept.covariance(width, width)).max(0.0).sqrt()),
            kept: self.numbers(&members),
        }
    }

    /// Takes all effects in, then drops those that are not worth their price. The cost stands beside.
    fn cut_down<'m>(
        &self,
        (mut swept, mut kept): Set<'m>,
        others: Vec<&'m Member>,
    ) -> (Swept, f64, Vec<&'m Member>) {
        for column in others.iter().flat_map(|member| member.columns.clone()) {
            swept.take(column);
        }
        kept.extend(others);
        while let Some(needless) = self.needless(&swept, &kept) {
            kept.remove(needless).columns.clone().for_each(|column| swept.drop(column));
        }
        let paid: f64 = kept.iter().filter_map(|member| member.price).sum();
        let cost = self.misfit(swept.remaining()) + paid;
        (swept, cost, kept)
    }

    /// Takes effects in one by one, the most worth first, while one is worth its price. Then drops those that no longer are.
    fn built_up<'m>(
        &self,
        (mut swept, mut kept): Set<'m>,
        mut others: Vec<&'m Member>,
    ) -> (Swept, f64, Vec<&'m Member>) {
        let worth = |swept: &Swept, member: &Member| {
            let columns: Vec<usize> = member.columns.clone().collect();
            let with = swept.remaining() - swept.promise(&columns).0;
            self.misfit(swept.remaining()) - self.misfit(with) - member.price.unwrap_or_default()
        };
        loop {
            let each = others.iter().enumerate().map(|(number, member)| (number, worth(&swept, member)));
            let best = each.filter(|(_, worth)| *worth > 0.0).max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((best, _)) = best else { return self.cut_down((swept, kept), Vec::new()) };
            let member = others.remove(best);
            member.columns.clone().for_each(|column| {
                swept.take(column);
            });
            kept.push(member);
        }
    }

    /// The effect whose removal lowers the cost most, if any does.
    fn needless(&self, swept: &Swept, kept: &[&Member]) -> Option<usize> {
        let saved = |member: &Member| {
            let columns: Vec<usize> = member.columns.clone().collect();
            let without = swept.remaining() + swept.worth(&columns);
            member.price.unwrap_or_default() + self.misfit(swept.remaining()) - self.misfit(without)
        };
        let each = kept.iter().enumerate().map(|(number, member)| (number, saved(member)));
        each.filter(|(_, saved)| *saved > 0.0).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(number, _)| number)
    }

    fn misfit(&self, remaining: f64) -> f64 {
        misfit(remaining, self.samples)
    }

    /// The products, those of a candidate inserted before the response.
    fn matrix(&self, candidate: Option<usize>) -> DMatrix<f64> {
        let Some(candidate) = candidate else { return self.known.clone() };
        let width = self.known.ncols() - 1;
        let products = &self.products[candidate];
        let mut matrix = self.known.clone().insert_row(width, 0.0).insert_column(width, 0.0);
        for (place, product) in products.iter().enumerate() {
            matrix[(place, width)] = *product;
            matrix[(width, place)] = *product;
        }
        matrix
    }

    /// The numbers of the effects of a set, and of the settings that stay.
    fn numbers(&self, set: &[&Member]) -> Vec<usize> {
        let always = self.effects.iter().filter(|member| member.price.is_none());
        let mut numbers: Vec<usize> = always.chain(set.iter().copied()).map(|member| member.number).collect();
        numbers.sort_unstable();
        numbers
    }

    /// By how much each candidate alone lowers the misfit: beside all effects found, and beside none but the settings.
    pub(crate) fn promises(&self) -> Vec<[f64; 2]> {
        let beside = [true, false].map(|all| {
            let mut swept = Swept::new(&self.known);
            let taken = self.effects.iter().filter(|member| all || member.price.is_none());
            for column in taken.flat_map(|member| member.columns.clone()) {
                swept.take(column);
            }
            swept
        });
        let work = self.products.len() * self.known.ncols() * self.known.ncols();
        parallel::counted(self.products.len(), work, |number| {
            beside.each_ref().map(|swept| self.promise(swept, &self.products[number]))
        })
    }

    /// By how much a column with these products lowers the misfit beside what is swept in.
    fn promise(&self, swept: &Swept, products: &[f64]) -> f64 {
        let width = self.known.ncols() - 1;
        let (mut square, mut response) = (products[width], products[width + 1]);
        let taken: Vec<usize> = (0..width).filter(|column| swept.has(*column)).collect();
        for one in &taken {
            response -= products[*one] * swept.coefficient(*one);
            let along: f64 =
                taken.iter().map(|other| products[*other] * swept.covariance(*one, *other)).sum();
            square -= products[*one] * along;
        }
        // A column that the others hold already says nothing.
        if square <= HELD * products[width] {
            return 0.0;
        }
        let remaining = swept.remaining();
        self.misfit(remaining) - self.misfit(remaining - response * response / square)
    }
}

/// A candidate of which the effects found leave less than this share of its square is one of them under another name.
const HELD: f64 = 1e-4;

/// The price of the zero of one run; `None` for any other effect. A search always fits these zeros where runs do not repeat. Here they
/// have a price, since wrong files can make runs differ.
pub(crate) fn price_of_a_run(effect: &Effect, samples: f64) -> Option<f64> {
    let is_one = matches!(effect.shape, Shape::Instrument(setting) if setting.of_a_run());
    is_one.then(|| untold_price(1, samples))
}

/// Adds what the effects of the model explain back to the residual, which is the last column.
fn add_back(columns: &mut DMatrix<f64>, coefficients: &[f64]) {
    let width = columns.ncols() - 1;
    for (column, coefficient) in coefficients.iter().enumerate() {
        let share = columns.column(column) * *coefficient;
        let mut left = columns.column_mut(width);
        left += share;
    }
}

fn whitened(steps: &[Step], column: &mut [f64]) {
    whiten(steps, &mut [0.0], column);
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}
