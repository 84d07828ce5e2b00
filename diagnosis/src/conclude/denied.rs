//! What an adequate model denies. In: a study in which nothing was found. Out: from which size on the effects that a shop asks for first
//! would have been found.
//!
//! It is an estimate from what the design knows already: by how much an effect of size one would lower the cost, and the price that it
//! has to pay. `abbe limits` asks the same by injection, and of every effect: on two quiet simulated machines its limits were 0.65 to
//! 1.6 times these.

use crate::design::{Design, Regressor};
use crate::diagnosis::Denied;
use crate::engine::Found;
use crate::model::{Effect, Place};
use crate::parameters::motion_unit;
use crate::ranges::periods;
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;

/// How many limits are told: a verdict is one sentence.
const MOST: usize = 3;

/// What an effect of one kind may be before the diagnosis names it, the least known axis of each kind first.
pub(super) fn denied(study: &Study<'_>, found: &Found) -> Vec<Denied> {
    let kinds: [&dyn Fn(&Effect) -> bool; 3] = [
        &|effect| matches!(effect.shape, Shape::Backlash { wind_up: 0.0, .. }) && is_own(study, effect),
        &|effect| matches!(effect.shape, Shape::Constant) && is_alignment(study, effect),
        &|effect| matches!(effect.shape, Shape::Cyclic { .. }),
    ];
    let pool = found.pool.iter().map(|kin| kin.effect.clone());
    let effects: Vec<Effect> = pool.chain(waves(study, found)).collect();
    let asked: Vec<Effect> =
        effects.into_iter().filter(|effect| kinds.iter().any(|kind| kind(effect))).collect();
    let sizes = sizes(study, found, &asked);
    let known: Vec<(&Effect, f64)> =
        asked.iter().zip(sizes).filter_map(|(effect, size)| Some((effect, size?))).collect();
    let of_kind = |kind: &&dyn Fn(&Effect) -> bool| {
        let sized = known.iter().filter(|(effect, _)| kind(effect));
        sized.max_by(|a, b| a.1.total_cmp(&b.1)).and_then(|(effect, size)| told(study, effect, *size))
    };
    kinds.iter().filter_map(of_kind).take(MOST).collect()
}

fn is_own(study: &Study<'_>, effect: &Effect) -> bool {
    effect.motion().is_some_and(|motion| study.own.contains(&Some(motion)))
}

fn is_alignment(study: &Study<'_>, effect: &Effect) -> bool {
    effect.motion().is_some_and(|motion| study.equations.motions[motion].alignment)
}

/// A wave in the own motion of each axis, a tenth of its travel long, where its rows resolve that: on each side of the drive's feedback
/// on which candidates of the motion stand.
fn waves(study: &Study<'_>, found: &Found) -> Vec<Effect> {
    let wave = |axis: usize| {
        let travel = found.travels.get(axis)?;
        let period = travel.range() / WAVES;
        let (shortest, longest) = periods(study, axis, travel);
        let resolved = travel.moves && period > RESOLVED * shortest && period < longest;
        resolved.then_some(Shape::Cyclic { axis, period, order: 1, center: travel.center() })
    };
    let of_axis = |axis: usize| -> Vec<Effect> {
        let motion = study.own.get(axis).copied().flatten();
        let Some((motion, shape)) = motion.zip(wave(axis)) else { return Vec::new() };
        let places = places(found, motion).into_iter();
        places.map(|place| Effect { place, shape: shape.clone() }).collect()
    };
    (0..study.equations.axes.len()).flat_map(of_axis).collect()
}

/// The places at which candidates of a motion stand, each once.
fn places(found: &Found, motion: usize) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    for kin in found.pool.iter().filter(|kin| kin.effect.motion() == Some(motion)) {
        if !places.contains(&kin.effect.place) {
            places.push(kin.effect.place);
        }
    }
    places
}

/// How many periods of the wave fit into the travel: more than a polynomial draws.
const WAVES: f64 = 10.0;

/// The shortest period that is asked, in shortest periods that rows can show (two rows). Six rows a period show a sine to 5 % (sinc of a
/// sixth).
const RESOLVED: f64 = 3.0;

/// The size of each effect that would be found in nine of ten cases, mm or rad; nothing where the recordings do not show it.
fn sizes(study: &Study<'_>, found: &Found, effects: &[Effect]) -> Vec<Option<f64>> {
    let settings = found.fit.model.settings();
    let regressors = settings.iter().map(|fitted| fitted.effect.clone()).chain(effects.iter().cloned());
    let regressors: Vec<Regressor> = regressors.map(Regressor::of).collect();
    let design = Design::new(study, &found.fit.model, &found.appraisal.weights, regressors);
    let (products, samples) = design.fitted();
    let mut swept = Swept::new(&products);
    (0..settings.len()).flat_map(|number| design.columns(number)).for_each(|column| {
        swept.take(column);
    });
    let scale = swept.remaining() / samples.max(1.0);
    let size = |(number, effect): (usize, &Effect)| {
        let columns: Vec<usize> = design.columns(settings.len() + number).collect();
        // Of a wave the mean of sine and cosine.
        let energies = columns.iter().map(|column| swept.energy(&[*column], &[1.0]));
        let energy = energies.sum::<f64>() / crate::number(columns.len().max(1)) / scale;
        let price = found.conditions().price(study, effect, samples);
        let size = (price.max(0.0).sqrt() + NINE_OF_TEN) / energy.sqrt();
        let seen = columns.iter().all(|column| swept.independence(*column) > SEEN);
        (seen && size.is_finite()).then_some(size)
    };
    effects.iter().enumerate().map(size).collect()
}

/// How many standard errors a size scatters below what nine of ten reach: of a normal distribution.
const NINE_OF_TEN: f64 = 1.282;

/// The share of a column that the settings must leave.
const SEEN: f64 = 1e-3;

fn told(study: &Study<'_>, effect: &Effect, size: f64) -> Option<Denied> {
    let motion = effect.motion()?;
    let (factor, unit) = motion_unit(study, motion);
    Some(Denied {
        motion: study.equations.motions[motion].name.clone(),
        term: effect.shape.name(),
        period: effect.shape.wave_along().map(|(axis, period)| {
            let (factor, unit) = crate::parameters::axis_unit(study, axis);
            (period * factor, unit)
        }),
        above: size * factor,
        unit,
    })
}
