//! Findings: the effects of a fitted model in words and numbers.
//!
//! In: what the engine found. Out: a finding for each effect of the machine, with its parameters, its share, its evidence
//! on held-out data and its other names; and the settings of instruments that the data demand.

use super::units::{Left, Units};
use crate::alternatives;
use crate::certainty::{self, WIDTH_95};
use crate::diagnosis::{Alternative, Diagnosis, Evidence, Finding, Parameter, Residual, SettingFinding};
use crate::elements;
use crate::engine::Found;
use crate::form;
use crate::judge;
use crate::model::{Effect, Model};
use crate::parameters::Described;
use crate::side::Side;
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::{Setting, Shape};
use crate::words;
use crate::zeros;

/// How many names are told for one finding at most.
const NAMES: usize = 4;

/// Fills findings and settings; the numbers of the model's effects that are the findings, in their order.
pub(super) fn report(
    study: &Study<'_>,
    found: &Found,
    units: &Units,
    diagnosis: &mut Diagnosis,
) -> Vec<usize> {
    let names = alternatives::find(study, found);
    let design = judge::design(study, &found.fit.model, &found.appraisal.weights);
    let (products, _) = design.fitted();
    let mut swept = Swept::new(&products);
    for column in 0..design.width {
        swept.take(column);
    }
    let left = units.left(study, &found.fit.model, &found.appraisal.weights.outliers);
    let shares = shares(study, found, units, &left);
    let certainties = certainty::certainties(study, &found.fit, &found.conditions());
    for (number, fitted) in found.fit.model.effects.iter().enumerate() {
        let described = Described::new(study, fitted, &certainties[number]);
        let names = number
            .checked_sub(found.fit.model.settings().len())
            .map_or(&[] as &[Effect], |place| &names[place]);
        let alternatives = told(study, &fitted.effect, names);
        let Some(motion) = fitted.effect.motion() else {
            if let Some(setting) = setting(study, found, number, alternatives) {
                diagnosis.settings.push(setting);
            }
            continue;
        };
        let mut reduced = judge::without(&design, &swept, &found.fit.model, &[number]);
        if found.plain_zeros {
            zeros::weigh_plainly(study, &mut reduced, &found.appraisal.weights.as_white());
        }
        zeros::free_held_out(study, &mut reduced);
        let known = &study.equations.motions[motion];
        let calibrated = described.calibrated();
        let parameters = described.parameters();
        diagnosis.findings.push(Finding {
            motion: known.name.clone(),
            motion_number: motion,
            motion_meaning: known.meaning.clone(),
            term: fitted.effect.shape.name(),
            over_travel: described.over_travel(&found.travels),
            repeats_with: elements::repeating(study, &found.travels, &fitted.effect.shape, &parameters),
            parameters,
            share: shares[number],
            location: words::location(study, &found.fit.model, fitted, names),
            evidence: evidence(study, units, &fitted.effect, (found, &left), &reduced),
            alternatives,
            explanation: fitted.effect.shape.meaning().to_owned(),
            compensable: calibrated.compensable(),
            form: form::form(study, &found.fit.model, &fitted.effect, &calibrated),
            sensors: calibrated.sensors().map(|sensor| (sensor, study.sensors[sensor].clone())).collect(),
            calibrated,
        });
    }
    diagnosis.findings.sort_by(|a, b| b.share.total_cmp(&a.share));
    diagnosis.settings = joined(std::mem::take(&mut diagnosis.settings));
    let model = found.fit.model.effects.iter().enumerate();
    let machine = model.filter(|(_, fitted)| fitted.effect.motion().is_some());
    let mut numbers: Vec<usize> = machine.map(|(number, _)| number).collect();
    numbers.sort_by(|a, b| shares[*b].total_cmp(&shares[*a]));
    numbers
}

/// What an effect does to held-out data, from what was found with it, with what that leaves, and the model without: to lengths or angles,
/// whichever it changes more; where it acts in a drive beside instruments outside, to that drive's own feedback, which shows it finer.
fn evidence(
    study: &Study<'_>,
    units: &Units,
    effect: &Effect,
    (found, left): (&Found, &[Left]),
    reduced: &Model,
) -> Evidence {
    let own = |motion: usize| study.own.iter().position(|own| *own == Some(motion));
    let at_drive = effect.side().is_some_and(Side::at_drive) && units.outside;
    let axis = effect.motion().and_then(own).filter(|axis| at_drive && study.has_drive(*axis));
    let outliers = &found.appraisal.weights.outliers;
    let at_drive = |model: &Model, axis: usize| units.at_drive(study, model, outliers, axis);
    let [with, without] = match axis {
        Some(axis) => [&found.fit.model, reduced].map(|model| at_drive(model, axis)),
        None => units.most_apart(left, &units.left(study, reduced, outliers)),
    };
    let drive = axis.map(|axis| study.equations.axes[axis].letter.clone());
    Evidence { with: held_rms(&with), without: held_rms(&without), unit: with.unit, drive }
}

/// The part of each effect in what all effects of the machine do together to the data that were held out (to all data, where
/// none were): its product with the sum over the square of the sum, zeros of channels left free. `left` is what the whole
/// model leaves.
fn shares(study: &Study<'_>, found: &Found, units: &Units, left: &[Left]) -> Vec<f64> {
    let model = &found.fit.model;
    let held_out = |model: &Model| units.held_out(study, model, &found.appraisal.weights.outliers, left);
    let whole = held_out(model);
    let difference = |number: usize| -> Vec<f64> {
        if model.effects[number].effect.motion().is_none() {
            return Vec::new();
        }
        let without = held_out(&model.without(number));
        without.iter().zip(&whole).map(|(without, whole)| without - whole).collect()
    };
    let signals: Vec<Vec<f64>> = (0..model.effects.len()).map(difference).collect();
    let sum: Vec<f64> =
        (0..whole.len()).map(|at| signals.iter().filter_map(|signal| signal.get(at)).sum()).collect();
    let product = |signal: &[f64]| signal.iter().zip(&sum).map(|(a, b)| a * b).sum::<f64>();
    let square = product(&sum).max(f64::MIN_POSITIVE);
    signals.iter().map(|signal| (product(signal) / square).clamp(0.0, 1.0)).collect()
}

fn held_rms(residual: &Residual) -> f64 {
    residual.holdout_rms.unwrap_or(residual.rms)
}

/// At most four other names, each once.
fn told(study: &Study<'_>, effect: &Effect, names: &[Effect]) -> Vec<Alternative> {
    let mut told: Vec<Alternative> = Vec::new();
    for name in names {
        let motion =
            name.motion().map_or("instrument", |motion| study.equations.motions[motion].name.as_str());
        let term = name.shape.name();
        let own =
            effect.motion().map_or("instrument", |motion| study.equations.motions[motion].name.as_str());
        let known = told.iter().any(|known| known.motion == motion && known.term == term);
        if told.len() < NAMES && !known && (own, effect.shape.name()) != (motion, term) {
            let separate_by = alternatives::separate_by(study, effect, name);
            told.push(Alternative { motion: motion.to_owned(), term, separate_by });
        }
    }
    told
}

/// A setting of an instrument, where the data demand it: it is far from zero.
fn setting(
    study: &Study<'_>,
    found: &Found,
    number: usize,
    alternatives: Vec<Alternative>,
) -> Option<SettingFinding> {
    let fitted = &found.fit.model.effects[number];
    let (crate::model::Place::Instrument { recording }, Shape::Instrument(setting)) =
        (fitted.effect.place, &fitted.effect.shape)
    else {
        return None;
    };
    let (fitted, variance) = (*fitted.coefficients.first()?, found.fit.covariances[number][(0, 0)]);
    let value = match setting {
        Setting::Rotation { direction } => rotation(study, &found.fit.model, recording)?[*direction],
        _ => fitted,
    };
    let half = WIDTH_95 * variance.max(0.0).sqrt();
    if value.abs() < DEMANDED * half / WIDTH_95 {
        return None;
    }
    let estimate = |value: f64, ends: (f64, f64), unit: &str| crate::diagnosis::Estimate {
        value,
        ci95: ends,
        unit: unit.to_owned(),
    };
    let plain = |unit: &str| estimate(value, (value - half, value + half), unit);
    let parameter = match setting {
        Setting::Offset { .. } | Setting::RunOffset { .. } | Setting::RunEccentricity { .. } => return None,
        Setting::Eccentricity { direction } => Parameter::fitted(["x", "y", "z"][*direction], plain("mm")),
        Setting::Displacement { direction } => Parameter::fitted(["x", "y", "z"][*direction], plain("mm")),
        Setting::Rotation { direction } => Parameter::fitted(["a", "b", "c"][*direction], plain("rad")),
        Setting::Radius => Parameter::fitted("offset", plain("mm")),
        Setting::Clock => Parameter::fitted("offset", plain("s")),
        Setting::Cosine => {
            let angle = |half_square: f64| (2.0 * half_square.max(0.0)).sqrt();
            let ends = (angle(value - half), angle(value + half));
            Parameter::fitted("angle", estimate(angle(value), ends, "rad"))
        }
    };
    Some(SettingFinding { recording, term: setting.name(), parameters: vec![parameter], alternatives })
}

/// How the part of a recording is turned: as its readings alone have it, and what the model adds to that, rad.
fn rotation(study: &Study<'_>, model: &Model, recording: usize) -> Option<[f64; 3]> {
    let mut more = [0.0; 3];
    for fitted in &model.effects {
        if let Some(Setting::Rotation { direction }) = fitted.effect.setting_of(recording) {
            more[direction] += fitted.coefficients.first()?;
        }
    }
    study.scenes[recording].pose.as_ref().map(|pose| pose.rotation_after(more))
}

/// A setting of an instrument is told from this many standard deviations on.
const DEMANDED: f64 = 4.0;

/// The directions of one eccentricity or datum, brought together.
fn joined(settings: Vec<SettingFinding>) -> Vec<SettingFinding> {
    let mut joined: Vec<SettingFinding> = Vec::new();
    for setting in settings {
        match joined
            .iter_mut()
            .find(|known| known.term == setting.term && known.recording == setting.recording)
        {
            Some(known) => known.parameters.extend(setting.parameters),
            None => joined.push(setting),
        }
    }
    joined
}
