//! The judge: what of a chosen model may be claimed.
//!
//! In: a fitted model. Out: the same without every effect that does not stand up: whose likelihood the noise alone could
//! give, that does not come back in the held-out data as it was fitted, or that rests on a few stretches only.

use nalgebra::DMatrix;

use crate::appraisal::Appraisal;
use crate::channel::ChannelAt;
use crate::conditions::Conditions;
use crate::design::{Design, Products, Regressor};
use crate::fit::Fit;
use crate::harmonics;
use crate::model::{Fitted, Model};
use crate::parallel;
use crate::rounded;
use crate::search::untold_price;
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;
use crate::weights::Weights;
use crate::zeros;

/// The share of its fitted strength with which an effect must come back in the held-out data, at least.
const RETURNS: f64 = 0.4;
/// The expected whitened energy in held-out data from which on they can tell.
const TELLING: f64 = 12.0;
/// How many standard deviations, as the scatter from block to block gives them, an effect must stand above zero.
const STEADY: f64 = 3.5;
/// The fewest blocks that give a scatter.
const FEW_BLOCKS: usize = 5;

/// Drops what does not stand up, one effect at a time, and fits the rest again.
pub(crate) fn uphold(study: &Study<'_>, mut fit: Fit, conditions: &Conditions<'_>) -> (Fit, Appraisal) {
    loop {
        let appraisal = Appraisal::new(study, &fit.model);
        let conditions = conditions.under(&appraisal.weights);
        let Some(weakest) = weakest(study, &fit, &appraisal, &conditions) else {
            let fit = conditions.refine(study, fit.model);
            return (fit, appraisal);
        };
        fit = conditions.refine(study, fit.model.without(weakest));
    }
}

/// The effect that stands up least, of those that do not.
fn weakest(
    study: &Study<'_>,
    fit: &Fit,
    appraisal: &Appraisal,
    conditions: &Conditions<'_>,
) -> Option<usize> {
    let chosen = fit.model.chosen_numbers();
    let design = design(study, &fit.model, &appraisal.weights);
    let (products, samples) = design.fitted();
    let mut swept = Swept::new(&products);
    for column in 0..design.width {
        swept.take(column);
    }
    let scale = (swept.remaining() / samples.max(1.0)).max(f64::MIN_POSITIVE);
    let beside_settings = beside_settings(&design, &products, chosen.start);
    let whole = zeros::residuals(study, &fit.model);
    let judged = |number: usize| {
        let columns: Vec<usize> = design.columns(number).collect();
        let worth = swept.worth(&columns) / scale;
        let told = columns.iter().filter(|column| swept.has(**column)).count();
        let price = conditions.price(study, &fit.model.effects[number].effect, samples)
            - untold_price(columns.len() - told, samples);
        let weak = worth < price || noise_explains(study, &design, &swept, fit, appraisal, number, price);
        let fails = weak && !conditions.stands_out(study, &fit.model, number, price)
            || !returns(&design, &swept, number, scale)
            || !steady(&design, &swept, number)
            || is_made_up_for(&design, &beside_settings, &fit.model, number)
            || imitates_a_state(study, &fit.model, (appraisal, &whole), number)
            || !pays(study, &design, &swept, fit, (appraisal, &whole), number, conditions);
        fails.then_some((worth, number))
    };
    let failing =
        parallel::counted(chosen.len(), study.rows() * chosen.len(), |number| judged(chosen.start + number));
    let weakest =
        failing.into_iter().flatten().reduce(|least, next| if next.0 < least.0 { next } else { least });
    weakest.map(|(_, number)| number)
}

/// The products as the settings leave them.
fn beside_settings(design: &Design, products: &DMatrix<f64>, settings: usize) -> Swept {
    let mut swept = Swept::new(products);
    for column in (0..settings).flat_map(|setting| design.columns(setting)) {
        swept.take(column);
    }
    swept
}

/// Whether an effect is the smaller of two of one motion that leave next to nothing of each other: neither is there as it was fitted.
fn is_made_up_for(design: &Design, beside_settings: &Swept, model: &Model, number: usize) -> bool {
    let energy = |effects: &[usize]| {
        let columns: Vec<usize> = effects.iter().flat_map(|effect| design.columns(*effect)).collect();
        let coefficients: Vec<f64> =
            effects.iter().flat_map(|effect| model.effects[*effect].coefficients.clone()).collect();
        beside_settings.energy(&columns, &coefficients)
    };
    let own = energy(&[number]);
    let same = |other: &usize| {
        *other != number
            && model.effects[*other].effect.motion().is_some()
            && model.effects[*other].effect.motion() == model.effects[number].effect.motion()
    };
    let mut others = (0..model.effects.len()).filter(same);
    others.any(|other| own <= energy(&[other]) && energy(&[number, other]) < LEAST * LEAST * own)
}

/// The share of the smaller of two effects of one motion that must be left of both together. Two of equal size leave a third where they
/// are alike to 0.94: a recording that tells them apart no better says nothing of either.
const LEAST: f64 = 1.0 / 3.0;

/// Whether the held-out samples, taken as they are, come nearer to the model through the effect than to the others fitted
/// without it, and whether the effect is large enough anywhere to matter beside the noise of a sample. `left` is what the whole
/// model leaves: its appraisal, and its residuals.
fn pays(
    study: &Study<'_>,
    design: &Design,
    swept: &Swept,
    fit: &Fit,
    left: (&Appraisal, &[Vec<Vec<f64>>]),
    number: usize,
    conditions: &Conditions<'_>,
) -> bool {
    let others = followed(study, without(design, swept, &fit.model, &[number]), fit, number, conditions);
    let channels = showing(study, &fit.model.without(number), &others, left);
    let told =
        !fit.model.effects[number].effect.shape.is_wave() || channels.iter().any(|channel| channel.told);
    let peak = channels.iter().map(|channel| channel.highest).fold(0.0, f64::max);
    let expected: f64 = channels.iter().map(|channel| channel.expected).sum();
    let gained: f64 = channels.iter().map(|channel| channel.gained).sum();
    let together = || {
        let harmonics = harmonics::together(&fit.model, number);
        harmonics.len() > 1 && {
            let others = without(design, swept, &fit.model, &harmonics);
            takes_more(&showing(study, &fit.model.without_all(&harmonics), &others, left))
        }
    };
    told && peak > MATERIAL && (expected < TELLING || gained > 0.0) && (takes_more(&channels) || together())
}

/// What a channel shows of effects, in units of its noise.
struct Shown {
    /// Their sum of squares.
    energy: f64,
    /// The most of them in a sample.
    highest: f64,
    /// Whether that is more than the beat of a wave with the rounding of the channel.
    told: bool,
    /// Their sum of squares in the held-out samples.
    expected: f64,
    /// By how much the sum of squares of the held-out samples is less through them.
    gained: f64,
    /// By how much that of all samples is.
    taken: f64,
    /// What comes back without a name beside them.
    returning: f64,
}

/// What the channels that show effects show of them: `bare` is the model without them, `others` the same with the others fitted again, and
/// `left` what the whole model leaves.
fn showing(
    study: &Study<'_>,
    bare: &Model,
    others: &Model,
    (appraisal, whole): (&Appraisal, &[Vec<Vec<f64>>]),
) -> Vec<Shown> {
    let [bare, others] = [bare, others].map(|model| zeros::residuals(study, model));
    let of_channel = |at: ChannelAt| -> Shown {
        let ChannelAt { scene, channel } = at;
        let fitted = study.scenes[scene].fitted_rows();
        let (size, outliers) = (appraisal.weights.noise(at).size(), appraisal.weights.outliers.of(at));
        let (bare, others, left) = (&bare[scene][channel], &others[scene][channel], &whole[scene][channel]);
        let rows = || (0..bare.len()).filter(|row| bare[*row].is_finite() && !outliers[*row]);
        let held = || rows().filter(|row| !fitted[*row]);
        let centered = |rows: &dyn Fn() -> Vec<usize>| -> Vec<f64> {
            let mut effect: Vec<f64> = rows().into_iter().map(|row| (bare[row] - left[row]) / size).collect();
            zeros::center(&mut effect);
            effect
        };
        let (everywhere, in_held) = (centered(&|| rows().collect()), centered(&|| held().collect()));
        let highest = everywhere.iter().fold(0.0, |highest: f64, value| highest.max(value.abs()));
        let squares = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
        let nearer = |row: usize| (others[row] * others[row] - left[row] * left[row]) / (size * size);
        Shown {
            energy: squares(&everywhere),
            highest,
            told: highest * size > rounded::beat(study.scenes[scene].channels[channel].rounding, size),
            expected: squares(&in_held),
            gained: held().map(nearer).sum(),
            taken: rows().map(nearer).sum(),
            returning: appraisal.returning[scene][channel] / (size * size),
        }
    };
    let channels: Vec<Shown> = study.channels().map(of_channel).collect();
    let energy = channels.iter().map(|channel| channel.energy).sum();
    channels.into_iter().filter(|channel| shows(channel.energy, energy)).collect()
}

/// Whether a channel shows an effect: by its energy there, in units of the noise, and in all channels. Where it does not, others that are
/// fitted a little differently beside the effect would be taken for it.
pub(crate) fn shows(energy: f64, of_all: f64) -> bool {
    energy > CRUMB * of_all
}

/// The share of the energy of an effect from which on a channel shows it. Of an effect of ten standard deviations in all, a hundredth of the
/// energy is one standard deviation: too little to tell anything.
const CRUMB: f64 = 0.01;

/// Whether effects take more than what still comes back without a name where they show: less may be a piece of that. The harmonics of a
/// wave are one thing, and take it together.
fn takes_more(channels: &[Shown]) -> bool {
    let taken: f64 = channels.iter().map(|channel| channel.taken).sum();
    let returning: f64 = channels.iter().map(|channel| channel.returning).sum();
    taken > returning
}

/// Whether a wave in time is a piece of a function of a state, which strokes of equal length bring back at equal times: most of it
/// goes where a state takes what comes back with it, and as much comes back beside it. A wave that is all that comes back is one.
fn imitates_a_state(
    study: &Study<'_>,
    model: &Model,
    (appraisal, whole): (&Appraisal, &[Vec<Vec<f64>>]),
    number: usize,
) -> bool {
    if !matches!(model.effects[number].effect.shape, Shape::Vibration { .. }) {
        return false;
    }
    let bare = zeros::residuals(study, &model.without(number));
    study.scenes.iter().enumerate().any(|(scene, known)| {
        (0..known.channels.len()).any(|channel| {
            let (bare, left) = (&bare[scene][channel], &whole[scene][channel]);
            let outliers = appraisal.weights.outliers.of(ChannelAt { scene, channel });
            let valid: Vec<bool> =
                bare.iter().zip(outliers).map(|(value, outlier)| value.is_finite() && !outlier).collect();
            let signal: Vec<f64> = bare.iter().zip(left).map(|(bare, left)| bare - left).collect();
            let squares = |values: &[f64]| -> f64 {
                values.iter().zip(&valid).filter(|(_, valid)| **valid).map(|(value, _)| value * value).sum()
            };
            known.returns.stays(&signal, bare, &valid) < MOSTLY_STAYS
                && squares(bare) - squares(left) < known.returns.most(left, &valid)
        })
    })
}

/// The share of a wave in time that no state may take.
const MOSTLY_STAYS: f64 = 0.5;

/// A model without an effect, in which the periods of other waves along the same axis follow: a slope beside a wave of two cycles
/// draws its period, and without it the wave fits as well at its own.
fn followed(
    study: &Study<'_>,
    others: Model,
    fit: &Fit,
    number: usize,
    conditions: &Conditions<'_>,
) -> Model {
    let dropped = &fit.model.effects[number].effect;
    let draws = |fitted: &Fitted| {
        fitted.effect.shape.is_wave()
            && fitted.effect.shape.axis() == dropped.shape.axis()
            && fitted.effect.motion() == dropped.motion()
    };
    let drawn = dropped.shape.axis().is_some() && others.effects.iter().any(draws);
    if drawn { conditions.refine(study, others).model } else { others }
}

/// An effect must reach this share of the noise of a sample somewhere.
const MATERIAL: f64 = 0.12;

/// The products of the effects of a model, slopes left out, the whole response restored.
pub(crate) fn design(study: &Study<'_>, model: &Model, weights: &Weights) -> Design {
    let regressors = Regressor::all(&model.effects);
    let mut design = Design::new(study, model, weights, regressors);
    design.rebase(&model.effects);
    design
}

/// Whether the noise alone, estimated anew without the effect, is nearly as likely. For an event all rows count: it may have happened in a
/// held-out part, from one row to the next. Among the fitted rows such a part is a gap, and a walk comes as far in that time.
fn noise_explains(
    study: &Study<'_>,
    design: &Design,
    swept: &Swept,
    fit: &Fit,
    appraisal: &Appraisal,
    number: usize,
    price: f64,
) -> bool {
    let without = without(design, swept, &fit.model, &[number]);
    let shape = &fit.model.effects[number].effect.shape;
    if shape.is_event() {
        let whole = Appraisal::of_all_rows(study, &fit.model, None);
        let bare = Appraisal::of_all_rows(study, &without, Some(&whole));
        return bare.deviance - whole.deviance < price;
    }
    let bare = Appraisal::beside(study, &without, appraisal);
    // A walk draws any curve along a single pass. It knows nothing of reversals, speeds and temperatures.
    if matches!(shape, Shape::Polynomial { .. } | Shape::Table { .. }) {
        // Both are less than the fit of greatest likelihood would give: the one keeps the coefficients, the other the noise.
        let floors = appraisal.weights.beside(bare.floors);
        let worth = worth_in(study, &fit.model, &floors, &[number]);
        return (bare.wandering - appraisal.wandering).max(worth) < price;
    }
    if bare.deviance - appraisal.deviance < price {
        return true;
    }
    // A wave has one frequency. Both noises are fitted to the residual, so they are about equally strong there.
    !shape.is_wave() && bare.above_in_flicker(study, appraisal).is_some_and(|rise| rise < price)
}

/// What effects of a model take together from minus twice the log-likelihood where samples weigh so.
pub(crate) fn worth_in(study: &Study<'_>, model: &Model, weights: &Weights, effects: &[usize]) -> f64 {
    let design = design(study, model, weights);
    let (products, samples) = design.fitted();
    let mut swept = Swept::new(&products);
    for column in 0..design.width {
        swept.take(column);
    }
    let scale = (swept.remaining() / samples.max(1.0)).max(f64::MIN_POSITIVE);
    let columns: Vec<usize> = effects.iter().flat_map(|number| design.columns(*number)).collect();
    swept.worth(&columns) / scale
}

/// The model without some effects, the linear coefficients of the others fitted again.
pub(crate) fn without(design: &Design, swept: &Swept, model: &Model, numbers: &[usize]) -> Model {
    let mut reduced = swept.clone();
    for column in numbers.iter().flat_map(|number| design.columns(*number)) {
        reduced.drop(column);
    }
    let kept = model.effects.iter().enumerate().filter(|(other, _)| !numbers.contains(other));
    model.with_effects(kept.map(|(other, fitted)| Fitted {
        effect: fitted.effect.clone(),
        coefficients: match fitted.effect.shape.nonlinear_in_coefficient() {
            true => fitted.coefficients.clone(),
            false => design.columns(other).map(|column| reduced.coefficient(column)).collect(),
        },
    }))
}

/// Whether the effect comes back in the held-out blocks about as strong as it was fitted; true where they cannot tell.
fn returns(design: &Design, swept: &Swept, number: usize, scale: f64) -> bool {
    let (energy, score) = design
        .blocks
        .iter()
        .filter(|block| block.held_out)
        .map(|block| share(design, swept, number, block))
        .fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
    if energy < TELLING * scale {
        return true;
    }
    // The strength in the held-out data is 1 + score / energy times the fitted one.
    1.0 + score / energy > RETURNS
}

/// Whether the effect stands above the scatter of its strength from block to block; true where there are too few.
fn steady(design: &Design, swept: &Swept, number: usize) -> bool {
    let shares: Vec<(f64, f64)> = design
        .blocks
        .iter()
        .filter(|block| !block.held_out)
        .map(|block| share(design, swept, number, block))
        .filter(|(energy, _)| *energy > 0.0)
        .collect();
    if shares.len() < FEW_BLOCKS {
        return true;
    }
    let energy: f64 = shares.iter().map(|(energy, _)| energy).sum();
    let scatter: f64 = shares.iter().map(|(_, score)| score * score).sum();
    energy > STEADY * scatter.sqrt()
}

/// In one block: the energy of an effect as fitted, and its product with what the whole model leaves.
fn share(design: &Design, swept: &Swept, number: usize, block: &Products) -> (f64, f64) {
    let coefficients: Vec<f64> = (0..design.width).map(|column| swept.coefficient(column)).collect();
    let columns = design.columns(number);
    let mut energy = 0.0;
    let mut score = 0.0;
    for row in columns.clone() {
        energy += columns
            .clone()
            .map(|column| coefficients[row] * coefficients[column] * block.matrix[(row, column)])
            .sum::<f64>();
        let explained: f64 =
            (0..design.width).map(|column| coefficients[column] * block.matrix[(row, column)]).sum();
        score += coefficients[row] * (block.matrix[(row, design.width)] - explained);
    }
    (energy, score)
}

#[cfg(test)]
mod tests;
