//! The contest: every fault against what was found.
//!
//! In: what was found, and the columns of faults. Out: suspects. All models are compared under the noise that the search ended with.
//! Each consists of a fault and of those effects found that are still worth their price beside it. It is compared with the model
//! without a fault. A fault that makes most effects needless lowers the cost.

use std::ops::Range;

use nalgebra::DMatrix;

use super::Suspect;
use super::columns::{Suspected, Versions};
use super::fault::{FACTORS, Factor, Fault};
use super::verdict::Rest;
use crate::certainty::WIDTH_95;
use crate::design::{Design, Regressor};
use crate::engine::Found;
use crate::model::Effect;
use crate::noise::{Noise, Step, Whitening, whiten};
use crate::parallel;
use crate::search::untold_price;
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;

/// A fault must lower the cost by this much. The cost is that of Schwarz's criterion, and the odds are then 150 to 1.
pub(super) const DECISIVE: f64 = 10.0;

/// An amount has a name if it differs from that of the name by no more than this share, or if its interval holds it. Effects that were
/// found with the wrong files bias the amount. Once the files are changed, the interval must be no wider than this on either side. The
/// named factors lie a factor of 2 apart or more, so an interval of 10 % holds one of them at most.
pub(super) const NEAR: f64 = 0.1;

/// Products of the columns of what was found, of the faults, and of the response that both have to explain.
pub(super) struct Contest<'v> {
    suspected: &'v [Suspected],
    /// For each fault its products with the columns of what was found, with itself, and with the response.
    products: Vec<Vec<f64>>,
    /// The products of what was found, the response last.
    known: DMatrix<f64>,
    effects: Vec<Member>,
    samples: f64,
    /// Twice the logarithm of how many candidates there were.
    tried: f64,
}

/// An effect of the model: its columns and its price. Settings that are always fitted have no price and stay.
struct Member {
    columns: Range<usize>,
    price: Option<f64>,
}

/// The cheapest model with a fault, or without any.
struct Outcome {
    cost: f64,
    /// The coefficient of the fault, and its standard deviation; 0 without one.
    amount: f64,
    deviation: f64,
}

/// Effects of a model, and the products with their columns swept in.
type Set<'m> = (Swept, Vec<&'m Member>);

impl<'v> Contest<'v> {
    /// Works out the products over all recordings.
    pub(super) fn new(study: &Study<'_>, found: &Found, versions: &'v Versions) -> Self {
        let model = &found.fit.model;
        let regressors: Vec<Regressor> =
            model.iter().map(|fitted| Regressor::of(fitted.effect.clone())).collect();
        let width: usize = regressors.iter().map(Regressor::columns).sum();
        let mut contest = Self {
            suspected: &versions.suspected,
            products: vec![vec![0.0; width + 2]; versions.suspected.len()],
            known: DMatrix::zeros(width + 1, width + 1),
            effects: Vec::new(),
            samples: 0.0,
            tried: 2.0 * crate::number(found.pool.len() + versions.suspected.len()).ln(),
        };
        for (scene, rows) in versions.rows.iter().enumerate() {
            for channel in 0..study.scenes[scene].channels.len() {
                let mut columns = Design::columns_in(study, (scene, channel), model, &regressors, rows);
                let coefficients: Vec<f64> =
                    model.iter().flat_map(|fitted| &fitted.coefficients).copied().collect();
                add_back(&mut columns, &coefficients);
                contest.add(study, (scene, channel), (found.appraisal.noises[scene][channel], rows), columns);
            }
        }
        let conditions = found.conditions();
        let mut first = 0;
        for (number, fitted) in model.iter().enumerate() {
            let columns = first..first + regressors[number].columns();
            first = columns.end;
            let price = if number >= found.always {
                Some(conditions.price(study, &fitted.effect, contest.samples))
            } else {
                price_of_a_run(&fitted.effect, contest.samples)
            };
            contest.effects.push(Member { columns, price });
        }
        contest
    }

    /// Adds the rows of one channel.
    fn add(
        &mut self,
        study: &Study<'_>,
        (scene, channel): (usize, usize),
        (noise, rows): (Noise, &[usize]),
        mut columns: DMatrix<f64>,
    ) {
        let (known, fitted) = (&study.scenes[scene], study.scenes[scene].fitted_rows());
        let outliers = &known.channels[channel].outliers;
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
        let suspected = self.suspected;
        let work = suspected.len() * rows.len();
        let products = parallel::counted(suspected.len(), work, |number| {
            let mut column = suspected[number].columns[scene][channel].clone();
            whitened(&steps, &mut column);
            (0..rows.len()).filter(|place| !counts(*place)).for_each(|place| column[place] = 0.0);
            let square: f64 = column.iter().map(|value| value * value).sum();
            let mut products: Vec<f64> =
                columns.column_iter().map(|known| dot(known.as_slice(), &column)).collect();
            products.insert(width, square);
            products
        });
        for (sums, products) in self.products.iter_mut().zip(products) {
            sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
        }
    }

    /// The faults that cost decisively less than what was found, the cheapest first.
    pub(super) fn suspects(&self) -> Vec<Suspect> {
        let known = self.outcome(None).cost;
        let each = self.suspected.iter().enumerate();
        let mut suspects: Vec<Suspect> = each
            .filter_map(|(number, suspected)| {
                let outcome = self.outcome(Some(number));
                let fault = suspected.fault.clone();
                let (amount, named) = amount_to_try(&fault, &outcome)?;
                let parameter = if named { 0.0 } else { self.samples.max(2.0).ln() };
                let chance =
                    if named && amount == TURNED { turned_by_chance(outcome.deviation) } else { 0.0 };
                let gain = known - outcome.cost - self.tried - parameter + chance;
                let suspect = Suspect { fault, amount, gain, chance, named, others: Vec::new() };
                (gain > DECISIVE).then_some(suspect)
            })
            .collect();
        suspects.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        if let Some((first, rest)) = suspects.split_first_mut() {
            let alike = rest.iter().filter(|other| first.gain - other.gain < DECISIVE);
            first.others = alike.map(|other| (other.fault.clone(), other.amount)).collect();
        }
        suspects
    }

    /// The amount of the first fault beside what was found.
    pub(super) fn rest(&self) -> Option<Rest> {
        let outcome = self.suspected.first().map(|_| self.outcome(Some(0)))?;
        Some(Rest { amount: outcome.amount, deviation: outcome.deviation })
    }

    /// The cheapest model with a fault, or without any, and with those effects found that are worth their price.
    fn outcome(&self, fault: Option<usize>) -> Outcome {
        let width = self.known.ncols() - 1;
        let mut bare = Swept::new(&self.matrix(fault));
        let stays = |member: &&Member| member.price.is_none();
        for column in self.effects.iter().filter(stays).flat_map(|member| member.columns.clone()) {
            bare.take(column);
        }
        if fault.is_some() {
            bare.take(width);
        }
        // Effects that stand in for the fault may each seem worth their price beside the others. So they are also taken in one by one,
        // from none.
        let others = || self.effects.iter().filter(|member| member.price.is_some()).collect::<Vec<_>>();
        let whole = self.cut_down((bare.clone(), Vec::new()), others());
        let built = self.built_up((bare, Vec::new()), others());
        let (swept, cost) = if built.1 < whole.1 { built } else { whole };
        let scale = swept.remaining() / self.samples.max(1.0);
        Outcome {
            cost,
            amount: fault.map_or(0.0, |_| swept.coefficient(width)),
            deviation: fault.map_or(0.0, |_| (scale * swept.covariance(width, width)).max(0.0).sqrt()),
        }
    }

    /// Takes all effects in, then drops those that are not worth their price. The cost stands beside.
    fn cut_down<'m>(&self, (mut swept, mut kept): Set<'m>, others: Vec<&'m Member>) -> (Swept, f64) {
        for column in others.iter().flat_map(|member| member.columns.clone()) {
            swept.take(column);
        }
        kept.extend(others);
        while let Some(needless) = self.needless(&swept, &kept) {
            kept.remove(needless).columns.clone().for_each(|column| swept.drop(column));
        }
        let paid: f64 = kept.iter().filter_map(|member| member.price).sum();
        let cost = self.misfit(swept.remaining()) + paid;
        (swept, cost)
    }

    /// Takes effects in one by one, the most worth first, while one is worth its price. Then drops those that no longer are.
    fn built_up<'m>(&self, (mut swept, mut kept): Set<'m>, mut others: Vec<&'m Member>) -> (Swept, f64) {
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
        self.samples * (remaining.max(f64::MIN_POSITIVE) / self.samples.max(1.0)).ln()
    }

    /// The products, those of a fault inserted before the response.
    fn matrix(&self, fault: Option<usize>) -> DMatrix<f64> {
        let Some(fault) = fault else { return self.known.clone() };
        let width = self.known.ncols() - 1;
        let products = &self.products[fault];
        let mut matrix = self.known.clone().insert_row(width, 0.0).insert_column(width, 0.0);
        for (place, product) in products.iter().enumerate() {
            matrix[(place, width)] = *product;
            matrix[(width, place)] = *product;
        }
        matrix
    }
}

/// The price of the zero of one run; `None` for any other effect. A search always fits these zeros where runs do not repeat. Here they
/// have a price, since wrong files can make runs differ.
pub(super) fn price_of_a_run(effect: &Effect, samples: f64) -> Option<f64> {
    let is_one = matches!(effect.shape, Shape::Instrument(setting) if setting.of_a_run());
    is_one.then(|| untold_price(1, samples))
}

/// The amount to try, and whether it has a name. `None` if the fault cannot have the amount that was fitted.
fn amount_to_try(fault: &Fault, outcome: &Outcome) -> Option<(f64, bool)> {
    // An interval that holds 0 for the number itself tells no factor.
    let half = WIDTH_95 * outcome.deviation;
    let near = |from: f64, value: f64| from.abs() <= f64::max(NEAR * value.abs(), half) && half < value.abs();
    if fault.is_whole() {
        return near(outcome.amount - 1.0, 1.0).then_some((1.0, true));
    }
    let from = |factor: &&Factor| 1.0 + outcome.amount - factor.value;
    let named = FACTORS.iter().filter(|factor| fault.is_factor() && near(from(factor), factor.value));
    match named.min_by(|a, b| from(a).abs().total_cmp(&from(b).abs())) {
        Some(factor) => Some((factor.value - 1.0, true)),
        // A factor of 0 or below that is not -1 is no size that a number could have had: it is physics.
        None if fault.is_factor() && outcome.amount <= -1.0 => None,
        None => Some((outcome.amount, false)),
    }
}

/// The amount of a wrong sign.
pub(super) const TURNED: f64 = -2.0;

/// Twice the log of how unlikely it is that a number came to be its own reversal by chance, within this standard deviation. All changes
/// from -3 to +1 times the number are taken to be equally likely: that range is 4 wide, with the reversal, -2, inside.
fn turned_by_chance(deviation: f64) -> f64 {
    let interval = 2.0 * WIDTH_95 * deviation;
    2.0 * (4.0 / interval.clamp(1e-3, 4.0)).ln()
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
