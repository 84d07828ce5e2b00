//! The unexplained: what stands above the noise and no term of the vocabulary fits, in words.
//!
//! In: what the engine left: a feature at a place, an oscillation that is not steady, a residual that moves smoothly. Out:
//! where it shows, how large it is, and what comes nearest to it.

use super::ceiling;
use super::units::unit_at;
use nalgebra::DMatrix;

use crate::certainty::Certainty;
use crate::channel::{Channel, ChannelAt, Kind};
use crate::dents;
use crate::diagnosis::{Interval, IntervalOf, ParameterValue, Unexplained};
use crate::engine::Found;
use crate::local::Feature;
use crate::noise;
use crate::parameters::{Described, axis_unit, motion_unit};
use crate::places;
use crate::returns::Quantity;
use crate::study::Study;
use crate::unsteady::{self, Band, Moving, Suspect};
use crate::words;

/// What stays at one place of an axis.
pub(super) fn feature(study: &Study<'_>, found: &Found, feature: &Feature) -> Unexplained {
    let at = ChannelAt { scene: feature.scene, channel: feature.channel };
    let (channel, of_channel) = (study.channel(at), unit_at(study, at));
    let axis = &study.equations.axes[feature.axis];
    let (factor, unit) = axis_unit(study, feature.axis);
    let (from, to) = (feature.from * factor, feature.to * factor);
    let digits = digits_of(to - from);
    let which = match feature.direction {
        d if d > 0.0 => "while it moves forward",
        d if d < 0.0 => "while it moves backward",
        _ => "in both directions of motion",
    };
    let table_of = places::table_motion(study, found, feature)
        .map(|motion| study.equations.motions[motion].name.clone());
    Unexplained {
        link: Some(axis.letter.clone()),
        direction: channel.name.clone(),
        state: "position",
        interval: Some(Interval { of: IntervalOf::Axis(axis.letter.clone()), from, to, unit }),
        rms: feature.rms * of_channel.0,
        unit: of_channel.1,
        detail: format!(
            "comes back in every pass of {} from {from:.digits$} to {to:.digits$} {unit}, {which}; no term of the vocabulary has this form",
            axis.letter
        ),
        table_of,
    }
}

/// What is left of a band of frequencies, or moves smoothly; nothing where only noise is left.
pub(super) fn unsteady(study: &Study<'_>, found: &Found, moving: Option<Moving>) -> Option<Unexplained> {
    match moving.filter(|moving| above_display(study, moving)) {
        Some(moving) => Some(smoothly(study, found, moving)),
        None => found.bands.iter().max_by(|a, b| a.rms.total_cmp(&b.rms)).map(|band| of_band(study, *band)),
    }
}

/// How far axes are from commands that are end points, while they are on their way there: no model of the machine says it.
pub(super) fn on_the_way(study: &Study<'_>) -> Option<Unexplained> {
    study.scenes.iter().find_map(|scene| {
        let axis = *scene.targets.axes.first()?;
        let letter = &study.equations.axes[axis].letter;
        let follows = |channel: &&Channel<'_>| match channel.kind {
            Kind::Stage(own) | Kind::Drive(own) => own == axis,
            Kind::Tip(direction) => ["X", "Y", "Z"][direction] == letter,
            _ => false,
        };
        let channel = scene.channels.iter().find(follows)?;
        let pairs = channel.values.iter().zip(scene.given.programmed[axis].iter()).zip(&scene.targets.on_the_way);
        let away: Vec<f64> = pairs
            .filter(|(_, on_the_way)| **on_the_way)
            .map(|((value, command), _)| (value - command).powi(2))
            .filter(|square| square.is_finite())
            .collect();
        let (factor, unit) = axis_unit(study, axis);
        let rms = (away.iter().sum::<f64>() / crate::number(away.len().max(1))).sqrt();
        Some(Unexplained {
            link: Some(letter.clone()),
            direction: channel.name.clone(),
            state: "velocity",
            interval: None,
            rms: rms * factor,
            unit,
            detail: format!(
                "the command of {letter} is the end point of its motion, not its target on the way: {} rows on the way there \
                 show nothing about the machine and are left out",
                away.len()
            ),
            table_of: None,
        })
    })
}

/// The state of which a function predicts most of what is left of a channel in units to which it was not fitted, in words, and its
/// share.
fn state_of_what_is_left(study: &Study<'_>, found: &Found, moving: &Moving) -> Option<(Quantity, f64)> {
    let scene = &study.scenes[moving.at.scene];
    let residual = &found.appraisal.residuals[moving.at.scene][moving.at.channel];
    let outliers = found.appraisal.weights.outliers.of(moving.at);
    let valid: Vec<bool> =
        residual.iter().zip(outliers).map(|(value, outlier)| value.is_finite() && !outlier).collect();
    let rounding = study.channel(moving.at).rounding;
    let noise = noise::estimate(&scene.recording.time, residual, &valid, rounding).0;
    let first = scene.returns.of(residual, &valid, noise).into_iter().next()?;
    Some((scene.returns.quantity(first), first.share))
}

/// What comes back with a state although no effect was found for it, where nothing moves smoothly: a model that leaves it is not adequate.
pub(super) fn returning(study: &Study<'_>, found: &Found) -> Option<Unexplained> {
    let rest = unsteady::returning(study, &found.appraisal)?;
    if above_display(study, &rest) { by_state(study, found, &rest) } else { None }
}

/// Whether more is left than rounding leaves, which comes back wherever an axis passes the steps of a display alike.
fn above_display(study: &Study<'_>, moving: &Moving) -> bool {
    moving.rms > study.channel(moving.at).rounding
}

/// What is left, with the state that takes most of it; `None` where no state does.
fn by_state(study: &Study<'_>, found: &Found, moving: &Moving) -> Option<Unexplained> {
    let (quantity, share) = state_of_what_is_left(study, found, moving)?;
    let state = ceiling::words(study, quantity);
    let of_channel = unit_at(study, moving.at);
    Some(Unexplained {
        link: quantity.axis().map(|axis| study.equations.axes[axis].letter.clone()),
        direction: study.channel(moving.at).name.clone(),
        state: quantity.state(),
        interval: None,
        rms: moving.rms * of_channel.0,
        unit: of_channel.1,
        detail: format!(
            "a function of the {state} predicts {:.0} % of it on data that was not fitted; no term of the vocabulary has this \
             form",
            100.0 * share
        ),
        table_of: None,
    })
}

/// What is left, with the place of an axis at which it stands out; `None` where there is no such place. A table over it was not upheld:
/// with few passes, what is left elsewhere may look like it.
fn at_a_dent(study: &Study<'_>, found: &Found, moving: &Moving) -> Option<Unexplained> {
    let dent = dents::outstanding(study, &found.fit.model, &found.appraisal, &found.conditions())?;
    let axis = &study.equations.axes[dent.axis].letter;
    let (factor, unit) = axis_unit(study, dent.axis);
    let (from, to) = (factor * (dent.middle - dent.flank), factor * (dent.middle + dent.flank));
    let (digits, of_channel) = (digits_of(to - from), unit_at(study, moving.at));
    Some(Unexplained {
        link: Some(axis.clone()),
        direction: study.channel(moving.at).name.clone(),
        state: "position",
        interval: Some(Interval { of: IntervalOf::Axis(axis.clone()), from, to, unit }),
        rms: moving.rms * of_channel.0,
        unit: of_channel.1,
        detail: format!(
            "stands out at one place of {axis}, from {from:.digits$} to {to:.digits$} {unit}, in both directions of motion: a bump there takes \
             {:.0} % of it, but the tests do not uphold a table",
            100.0 * dent.share
        ),
        table_of: Some(study.equations.motions[study.own[dent.axis]?].name.clone()),
    })
}

/// How many decimal places tell a width with two digits.
fn digits_of(width: f64) -> usize {
    crate::index((1.0 - width.abs().log10().floor()).clamp(0.0, 12.0)).unwrap_or_default()
}

fn smoothly(study: &Study<'_>, found: &Found, moving: Moving) -> Unexplained {
    if let Some(known) = by_state(study, found, &moving).or_else(|| at_a_dent(study, found, &moving)) {
        return known;
    }
    let (channel, of_channel) = (study.channel(moving.at), unit_at(study, moving.at));
    let nearest = unsteady::suspect(study, found);
    let link = nearest.as_ref().and_then(|suspect| suspect.fitted.effect.motion());
    let near = nearest.as_ref().map_or_else(String::new, |suspect| near(study, suspect));
    Unexplained {
        link: link.map(|motion| study.equations.motions[motion].link.clone()),
        direction: channel.name.clone(),
        state: "time",
        interval: None,
        rms: moving.rms * of_channel.0,
        unit: of_channel.1,
        detail: format!(
            "keeps its direction for {} and more, unlike the noise of a sensor: something in the machine is still missing from the model{near}",
            words::seconds(moving.time)
        ),
        table_of: None,
    }
}

fn near(study: &Study<'_>, suspect: &Suspect) -> String {
    let effect = &suspect.fitted.effect;
    let motion = effect.motion().map_or("", |motion| study.equations.motions[motion].name.as_str());
    let size = suspect.fitted.coefficients.len() + usize::from(effect.shape.nonlinear().is_some());
    let unknown = Certainty::linear(DMatrix::zeros(size, size));
    let parameters = Described::new(study, &suspect.fitted, &unknown).parameters();
    let told = parameters.iter().filter_map(|parameter| match &parameter.value {
        ParameterValue::Fitted(estimate) => Some(format!(
            "{} {} {}",
            parameter.name.replace('_', " "),
            three_digits(estimate.value),
            estimate.unit
        )),
        _ => None,
    });
    let told: Vec<String> = told.collect();
    let told = if told.is_empty() { String::new() } else { format!(" ({})", told.join(", ")) };
    format!(
        "; {} of {motion}{told} is the closest candidate: alone it would explain {:.0} % of it, but the recording is too short to prove it",
        effect.shape.name(),
        100.0 * suspect.share
    )
}

/// A number with three digits.
fn three_digits(value: f64) -> String {
    let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 12.0);
    format!("{value:.*}", crate::index(digits).unwrap_or_default())
}

fn of_band(study: &Study<'_>, band: Band) -> Unexplained {
    let known = &study.equations.motions[band.motion];
    let (factor, unit) = motion_unit(study, band.motion);
    Unexplained {
        link: Some(known.link.clone()),
        direction: known.name.clone(),
        state: "frequency",
        interval: Some(Interval { of: IntervalOf::Frequency, from: band.from, to: band.to, unit: "Hz" }),
        rms: band.rms * factor,
        unit,
        detail:
            "oscillates with a varying amplitude; a steady vibration would be one line, but this is a band"
                .to_owned(),
        table_of: None,
    }
}
