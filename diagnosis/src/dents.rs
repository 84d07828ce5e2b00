//! Dents: one place of an axis at which something stands out on the way there and on the way back.
//!
//! In: a study, and a model that a search came to. Out: dents that may hide what else there is, and models with a table over one of
//! them. A search that begins without a dent that is larger than all else explains it by waves and powers, which no unit upholds, and
//! ends with nothing. One that begins with it sees what is beside it.

use nalgebra::{DMatrix, DVector};

use crate::appraisal::Appraisal;
use crate::conditions::Conditions;
use crate::curves::nodes::thinned;
use crate::curves::{FINE, even, is_dent, stations};
use crate::design::{Design, Regressor};
use crate::fit::Fit;
use crate::judge;
use crate::model::{Effect, Fitted, Model, Place};
use crate::noise;
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;
use crate::travel::Travel;
use crate::weights::Weights;

/// How many even places of an axis are looked at, a fortieth of the travel apart, as for the curves. A dent is at least as wide as from one to the next on both sides.
const PLACES: usize = FINE;
/// How many of these steps a dent falls over on each side. At eight it covers two fifths of the travel, and is a curve.
const FLANKS: [usize; 6] = [1, 2, 3, 4, 6, 8];
/// How many standard deviations its height must stand above nothing in each direction. At 192 places and widths, chance gives one of
/// them so much in both directions with one sign once in two million times; once in 1400 times where the floor is told a quarter too
/// small.
const SURE: f64 = 4.0;
/// The share of what is left that a dent must take, for it to hide what else is left. Beside a smaller one the search sees nine
/// tenths of that.
const HIDES: f64 = 0.1;
/// How much the heights of both directions may differ, as a share of the larger: what has a direction is no place. Heights that are just
/// sure are known to a quarter each; two that are equal differ by more than half once in six times.
const ALIKE: f64 = 0.5;

/// A dent stands out if it is this many times as high, in each direction, as hats elsewhere usually are. Of the 192 hats some 90 are
/// independent. By chance, one of them is that high in both directions, with one sign, in one recording of 30.
const OUTSTANDING: f64 = 2.2;
/// The median of the size of a normal variable, in standard deviations.
const NORMAL_MEDIAN: f64 = 0.6745;
/// The fewest heights that show what is usual: half of all hats of the widest kind, in both directions. The median of 24 that are
/// independent is known to a quarter.
const FEWEST: usize = 24;

/// Dents that may hide what else there is, each with the model beside which it takes most: the settings alone, all that was found,
/// and that without curves and waves along an axis. Many of those together draw a dent, and beside them there is none.
pub(crate) fn hidden(study: &Study<'_>, model: &Model, conditions: &Conditions<'_>) -> Vec<(Dent, Model)> {
    let largest =
        |known: &Model| largest(study, known, &Appraisal::new(study, known), conditions, Looked::is_sure);
    let mut beside = vec![model.settings_alone(), model.clone()];
    let undrawn = model.keeping(|fitted| !draws(&fitted.effect.shape));
    if beside.iter().all(|known| known.effects.len() != undrawn.effects.len()) {
        beside.push(undrawn);
    }
    let dents = beside.into_iter().filter_map(|known| Some((largest(&known)?, known)));
    dents.filter(|(dent, _)| !model.effects.iter().any(|fitted| dent.is_table(fitted))).collect()
}

/// Whether it is a curve or a wave along an axis.
fn draws(shape: &Shape) -> bool {
    matches!(shape, Shape::Polynomial { .. } | Shape::Cyclic { .. } | Shape::Table { .. })
}

/// The dent that takes most beside a model that leaves what the appraisal says, where it takes much and stands out among what is left
/// elsewhere.
pub(crate) fn outstanding(
    study: &Study<'_>,
    model: &Model,
    appraisal: &Appraisal,
    conditions: &Conditions<'_>,
) -> Option<Dent> {
    let counts =
        |looked: &Looked, middle, flank| looked.is_sure(middle, flank) && looked.stands_out(middle, flank);
    largest(study, model, appraisal, conditions, counts)
}

/// Of the dents that count, the one that takes most beside a model, where it takes much.
fn largest(
    study: &Study<'_>,
    model: &Model,
    appraisal: &Appraisal,
    conditions: &Conditions<'_>,
    counts: impl Fn(&Looked, usize, usize) -> bool,
) -> Option<Dent> {
    let axes = (0..study.own.len()).filter(|axis| conditions.travels[*axis].moves);
    let dents =
        axes.filter_map(|axis| Looked::new(study, model, axis, (appraisal, conditions))?.dent(&counts));
    dents.reduce(|most, next| if next.share > most.share { next } else { most })
}

/// How high a dent is in one direction of motion, and its standard deviation.
struct Height {
    value: f64,
    deviation: f64,
}

impl Height {
    fn is_sure(&self) -> bool {
        self.value.abs() > SURE * self.deviation
    }

    /// Whether both are sure, and alike.
    fn agrees(&self, other: &Self) -> bool {
        let (least, most) =
            (self.value.abs().min(other.value.abs()), self.value.abs().max(other.value.abs()));
        self.value * other.value > 0.0 && least > (1.0 - ALIKE) * most && self.is_sure() && other.is_sure()
    }
}

/// A dent of an axis: its middle and its flank, mm or rad.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Dent {
    place: Place,
    pub(crate) axis: usize,
    pub(crate) middle: f64,
    pub(crate) flank: f64,
    /// The share of what is left that it takes.
    pub(crate) share: f64,
}

impl Dent {
    /// A model with a table over the dent, behind its settings.
    pub(crate) fn added(
        &self,
        study: &Study<'_>,
        model: &Model,
        conditions: &Conditions<'_>,
    ) -> Option<Model> {
        let appraisal = Appraisal::new(study, model);
        let floors = appraisal.beside_floor();
        let under = conditions.under(&floors);
        let mut added = model.clone();
        added.effects.insert(model.settings().len(), self.table(study, model, &under)?);
        Some(conditions.refine(study, added).model)
    }

    /// Whether a model has a table of the dent's motion that is flat but for one place.
    pub(crate) fn is_in(&self, model: &Model, travels: &[Travel]) -> bool {
        model.effects.iter().any(|fitted| is_dent(fitted, self.place, &travels[self.axis]))
    }

    /// Whether a model has it, and it takes much of what all others leave.
    pub(crate) fn takes_much(&self, study: &Study<'_>, model: &Model, conditions: &Conditions<'_>) -> bool {
        if !self.is_in(model, conditions.travels) {
            return false;
        }
        let weights = Appraisal::new(study, model).weights.as_white();
        let design = judge::design(study, model, &weights);
        let (products, _) = design.sum(|_| true);
        let mut swept = Swept::new(&products);
        let (tables, others): (Vec<usize>, Vec<usize>) =
            (0..model.effects.len()).partition(|number| self.is_table(&model.effects[*number]));
        let mut left_by = |effects: Vec<usize>| {
            for column in effects.into_iter().flat_map(|number| design.columns(number)) {
                swept.take(column);
            }
            swept.remaining()
        };
        let without = left_by(others);
        without - left_by(tables) > HIDES * without
    }

    /// A fit with another table over the dent, as it shows beside all the others.
    pub(crate) fn drawn(&self, study: &Study<'_>, fit: Fit, conditions: &Conditions<'_>) -> Fit {
        let mut others = fit.model.keeping(|fitted| !self.is_table(fitted));
        let Some(table) = self.table(study, &others, conditions) else { return fit };
        others.effects.insert(others.settings().len(), table);
        conditions.refine(study, others)
    }

    /// A table over the dent beside a model: of close nodes those that it needs.
    fn table(&self, study: &Study<'_>, others: &Model, conditions: &Conditions<'_>) -> Option<Fitted> {
        let nodes = self.nodes(study, &conditions.travels[self.axis]);
        let shape = thinned(study, others, (self.place, self.axis), &nodes, conditions.weights)?;
        let effect = Effect { place: self.place, shape };
        Some(Fitted::unfitted(effect))
    }

    /// Close nodes over the dent, and the ends of the travel: the table is straight beside it. Of an axis that was observed at stations,
    /// these: nothing tells of a curve between them.
    fn nodes(&self, study: &Study<'_>, travel: &Travel) -> Vec<f64> {
        if let Some(stations) = stations(study, self.axis, travel) {
            return stations;
        }
        let reach = WIDER * self.flank;
        let from = (self.middle - reach).max(travel.low);
        let to = (self.middle + reach).min(travel.high);
        let mut nodes = even(from, to, FINE);
        nodes.insert(0, travel.low);
        nodes.push(travel.high);
        nodes.dedup();
        nodes
    }

    fn is_table(&self, fitted: &Fitted) -> bool {
        fitted.effect.place == self.place && matches!(fitted.effect.shape, Shape::Table { .. })
    }
}

/// A bell falls to a hundredth within three standard deviations; the triangle that takes most of it has a flank of two and a quarter.
/// What stands beside a dent may let it look half as wide.
const WIDER: f64 = 2.0 * 1.4;

/// The products of hats at the places of an axis, on the way up and on the way down, beside a model.
struct Looked {
    place: Place,
    axis: usize,
    low: f64,
    step: f64,
    /// How many columns the model has.
    beside: usize,
    /// Beside the floor: it tells whether a dent is sure.
    weighed: Sums,
    /// Each sample for itself: it tells how much a dent takes of what is left.
    plain: Sums,
}

/// Products of columns and response, and how many samples are in them.
struct Sums {
    products: DMatrix<f64>,
    samples: f64,
}

impl Looked {
    fn new(
        study: &Study<'_>,
        model: &Model,
        axis: usize,
        (appraisal, conditions): (&Appraisal, &Conditions<'_>),
    ) -> Option<Self> {
        let place = study.own_place(axis)?;
        let travel = &conditions.travels[axis];
        let nodes = even(travel.low, travel.high, PLACES);
        let hats = Effect { place, shape: Shape::Table { axis, nodes, directed: true, repeats: false } };
        let sums = |weights: &Weights| {
            let effects = model.effects.iter().map(|fitted| &fitted.effect).chain([&hats]);
            let regressors = effects.cloned().map(Regressor::of).collect();
            let mut design = Design::new(study, model, weights, regressors);
            design.rebase(&model.effects);
            let (products, samples) = design.sum(|_| true);
            (design.columns(model.effects.len()).start, Sums { products, samples })
        };
        let (beside, weighed) = sums(&appraisal.beside_floor());
        let (_, plain) = sums(&appraisal.weights.as_white());
        let step = travel.range() / crate::number(PLACES - 1);
        Some(Self { place, axis, low: travel.low, step, beside, weighed, plain })
    }

    /// The dent that takes most, of those that count.
    fn dent(&self, counts: impl Fn(&Self, usize, usize) -> bool) -> Option<Dent> {
        let mut beside = Swept::new(&self.plain.products);
        for column in 0..self.beside {
            beside.take(column);
        }
        let left = beside.remaining();
        let tried =
            FLANKS.into_iter().flat_map(|flank| (flank..PLACES - flank).map(move |middle| (middle, flank)));
        let counted = tried.filter(|(middle, flank)| counts(self, *middle, *flank));
        let taken = counted.filter_map(|(middle, flank)| {
            let swept = self.swept(&self.plain, middle, flank)?;
            Some((left - swept.remaining(), middle, flank))
        });
        let (takes, middle, flank) = taken.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let dent = Dent {
            place: self.place,
            axis: self.axis,
            middle: self.low + crate::number(middle) * self.step,
            flank: crate::number(flank) * self.step,
            share: takes / left,
        };
        (dent.share > HIDES).then_some(dent)
    }

    /// Whether a hat is sure in both directions, and as high.
    fn is_sure(&self, middle: usize, flank: usize) -> bool {
        self.heights(middle, flank).is_some_and(|[up, down]| up.agrees(&down))
    }

    /// Whether a hat is higher in both directions than hats elsewhere on the axis are: what is left has its own bumps, which differ from
    /// pass to pass and by chance agree somewhere.
    fn stands_out(&self, middle: usize, flank: usize) -> bool {
        let all = (flank..PLACES - flank).filter_map(|middle| self.heights(middle, flank));
        let mut sizes: Vec<f64> = all.flatten().map(|height| height.value.abs()).collect();
        let Some(usual) = noise::middle(&mut sizes).map(|median| median / NORMAL_MEDIAN) else {
            return false;
        };
        let heights = self.heights(middle, flank).into_iter().flatten();
        sizes.len() >= FEWEST && heights.into_iter().all(|height| height.value.abs() > OUTSTANDING * usual)
    }

    /// How high a hat is on the way up and on the way down.
    fn heights(&self, middle: usize, flank: usize) -> Option<[Height; 2]> {
        let swept = self.swept(&self.weighed, middle, flank)?;
        let scale = swept.remaining() / self.weighed.samples.max(1.0);
        let height = |column: usize| Height {
            value: swept.coefficient(column),
            deviation: (scale * swept.covariance(column, column)).max(0.0).sqrt(),
        };
        Some([height(self.beside), height(self.beside + 1)])
    }

    /// The columns of the model and of a hat in both directions, all taken; nothing where the model has a direction of the hat already.
    fn swept(&self, sums: &Sums, middle: usize, flank: usize) -> Option<Swept> {
        let joined = self.joined(middle, flank);
        let mut swept = Swept::new(&(joined.tr_mul(&sums.products) * &joined));
        for column in 0..self.beside {
            swept.take(column);
        }
        (swept.take(self.beside) && swept.take(self.beside + 1)).then_some(swept)
    }

    /// The columns of the model, of a hat on the way up and on the way down, and of the response.
    fn joined(&self, middle: usize, flank: usize) -> DMatrix<f64> {
        let size = self.weighed.products.nrows();
        let mut joined = DMatrix::zeros(size, self.beside + 3);
        for column in 0..self.beside {
            joined[(column, column)] = 1.0;
        }
        let hat = self.hat(middle, flank);
        for (direction, first) in [self.beside, self.beside + PLACES].into_iter().enumerate() {
            joined.view_mut((first, self.beside + direction), (PLACES, 1)).copy_from(&hat);
        }
        joined[(size - 1, self.beside + 2)] = 1.0;
        joined
    }

    fn hat(&self, middle: usize, flank: usize) -> DVector<f64> {
        DVector::from_fn(PLACES, |node, _| {
            let off = crate::number(node.abs_diff(middle)) / crate::number(flank);
            (1.0 - off).max(0.0)
        })
    }
}

#[cfg(test)]
mod tests;
