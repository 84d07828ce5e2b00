//! Dents: one place of an axis at which something stands out on the way there and on the way back.
//!
//! In: a study, and the conditions under which its models are fitted. Out: the settings and a table over that place. A dent that is
//! larger than all else hides it: a search that begins without it explains it by waves and powers, which no unit upholds, and ends
//! with nothing. One that begins with it sees what is beside it.

use nalgebra::{DMatrix, DVector};

use crate::appraisal::Appraisal;
use crate::conditions::Conditions;
use crate::curves::even;
use crate::design::{Design, Regressor};
use crate::model::{Effect, Fitted, Model, Place};
use crate::places::OF_A_PLACE;
use crate::side::Side;
use crate::study::{Kind, Study};
use crate::sweep::Swept;
use crate::terms::Shape;
use crate::travel::Travel;

/// How many even places of an axis are looked at. A dent is at least as wide as from one to the next on both sides.
const PLACES: usize = 40;
/// How many of these steps a dent falls over on each side. At eight it covers two fifths of the travel, and is a curve.
const FLANKS: [usize; 4] = [1, 2, 4, 8];
/// How many standard deviations its height must stand above nothing in each direction: at 160 places and widths, chance gives one of
/// them so much in both directions with one sign once in 10 000 times.
const SURE: f64 = 4.0;
/// The share of what is left that a dent must take, for it to hide what else is left. Beside a smaller one the search sees nine
/// tenths of that.
const HIDES: f64 = 0.1;
/// How much the heights of both directions may differ, as a share of the larger: what has a direction is no place.
const ALIKE: f64 = 0.5;

/// What a search may begin anew with: the settings, and the dent that takes most beside them alone; the settings, and the one that
/// takes most beside all of the model. The last effect of each is the table over the dent.
pub(crate) fn hidden(study: &Study<'_>, model: &Model, conditions: &Conditions<'_>) -> Vec<Model> {
    let Some(settings) = model.get(..conditions.always) else { return Vec::new() };
    let mut begun: Vec<Model> = Vec::new();
    for known in [settings, &model[..]] {
        let Some(dent) = largest(study, &known.to_vec(), conditions) else { continue };
        let effect = Effect { place: dent.place, shape: dent.table(conditions.travels) };
        let is_there = |model: &Model| model.iter().any(|fitted| is_table_of(fitted, dent.place));
        if is_there(model) || begun.iter().any(is_there) {
            continue;
        }
        let mut start = settings.to_vec();
        start.push(Fitted { coefficients: vec![0.0; effect.shape.columns()], effect });
        begun.push(conditions.refine(study, start).model);
    }
    begun
}

fn is_table_of(fitted: &Fitted, place: Place) -> bool {
    fitted.effect.place == place && matches!(fitted.effect.shape, Shape::Table { .. })
}

/// The dent that takes most beside a model, where it takes much.
fn largest(study: &Study<'_>, model: &Model, conditions: &Conditions<'_>) -> Option<Dent> {
    let appraisal = Appraisal::new(study, model);
    let under = conditions.under(&appraisal.floors);
    let axes = (0..study.own.len()).filter(|axis| conditions.travels[*axis].moves);
    let dents = axes.filter_map(|axis| Looked::new(study, model, axis, &under)?.dent());
    dents.reduce(|most, next| if next.takes > most.takes { next } else { most })
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
struct Dent {
    place: Place,
    axis: usize,
    middle: f64,
    flank: f64,
    /// What it takes from the weighted sum of squares.
    takes: f64,
}

impl Dent {
    /// The table over it: straight to the ends of the travel beside it.
    fn table(&self, travels: &[Travel]) -> Shape {
        let travel = &travels[self.axis];
        let reach = WIDER * self.flank;
        let from = (self.middle - reach).max(travel.low);
        let to = (self.middle + reach).min(travel.high);
        let mut nodes = even(from, to, OF_A_PLACE);
        nodes.insert(0, travel.low);
        nodes.push(travel.high);
        nodes.dedup();
        Shape::Table { axis: self.axis, nodes, directed: false, repeats: false }
    }
}

/// A bell falls to a hundredth within three standard deviations; the triangle that takes most of it has a flank of two and a quarter.
const WIDER: f64 = 1.4;

/// The products of hats at the places of an axis, on the way up and on the way down, beside a model.
struct Looked {
    place: Place,
    axis: usize,
    low: f64,
    step: f64,
    /// How many columns the model has.
    beside: usize,
    products: DMatrix<f64>,
    samples: f64,
}

impl Looked {
    fn new(study: &Study<'_>, model: &Model, axis: usize, conditions: &Conditions<'_>) -> Option<Self> {
        let motion = study.own[axis]?;
        let mut kinds = study.scenes.iter().flat_map(|scene| &scene.channels).map(|channel| channel.kind);
        let side = if kinds.any(Kind::outside) { Side::After } else { Side::Drive };
        let place = Place::Motion { motion, side };
        let travel = &conditions.travels[axis];
        let nodes = even(travel.low, travel.high, PLACES);
        let shape = Shape::Table { axis, nodes, directed: true, repeats: false };
        let mut regressors: Vec<Regressor> =
            model.iter().map(|fitted| Regressor::of(fitted.effect.clone())).collect();
        regressors.push(Regressor::of(Effect { place, shape }));
        let mut design = Design::new(study, model, conditions.noises, regressors);
        design.rebase(model);
        let (products, samples) = design.sum(|_| true);
        let step = travel.range() / crate::number(PLACES - 1);
        Some(Self { place, axis, low: travel.low, step, beside: *design.first.last()?, products, samples })
    }

    /// The dent that takes most.
    fn dent(&self) -> Option<Dent> {
        let mut beside = Swept::new(&self.products);
        for column in 0..self.beside {
            beside.take(column);
        }
        let left = beside.remaining();
        let tried =
            FLANKS.into_iter().flat_map(|flank| (flank..PLACES - flank).map(move |middle| (middle, flank)));
        let taken = tried.filter_map(|(middle, flank)| Some((self.takes(middle, flank)?, middle, flank)));
        let (takes, middle, flank) = taken.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let dent = Dent {
            place: self.place,
            axis: self.axis,
            middle: self.low + crate::number(middle) * self.step,
            flank: crate::number(flank) * self.step,
            takes,
        };
        (takes > HIDES * left).then_some(dent)
    }

    /// What a hat takes from the sum of squares where it stands out alike in both directions.
    fn takes(&self, middle: usize, flank: usize) -> Option<f64> {
        let joined = self.joined(middle, flank);
        let products = joined.tr_mul(&self.products) * &joined;
        let mut swept = Swept::new(&products);
        for column in 0..self.beside {
            swept.take(column);
        }
        let (up, down) = (self.beside, self.beside + 1);
        let before = swept.remaining();
        if !swept.take(up) || !swept.take(down) {
            return None;
        }
        let scale = swept.remaining() / self.samples.max(1.0);
        let height = |column: usize| Height {
            value: swept.coefficient(column),
            deviation: (scale * swept.covariance(column, column)).max(0.0).sqrt(),
        };
        height(up).agrees(&height(down)).then(|| before - swept.remaining())
    }

    /// The columns of the model, of a hat on the way up and on the way down, and of the response.
    fn joined(&self, middle: usize, flank: usize) -> DMatrix<f64> {
        let size = self.products.nrows();
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
