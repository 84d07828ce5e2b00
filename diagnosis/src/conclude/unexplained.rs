//! The unexplained: what stands above the noise and no term of the vocabulary fits, in words.
//!
//! In: what the engine left: a feature at a place, an oscillation that is not steady, a residual that moves smoothly. Out:
//! where it shows, how large it is, and what comes nearest to it.

use super::units::Units;
use nalgebra::DMatrix;

use crate::certainty::Certainty;
use crate::diagnosis::{Interval, IntervalOf, ParameterValue, Unexplained};
use crate::engine::{self, Found};
use crate::local::Feature;
use crate::parameters::{Described, axis_unit, motion_unit};
use crate::study::Study;
use crate::unsteady::{self, Band, Moving, Suspect};
use crate::words;

/// What stays at one place of an axis.
pub(super) fn feature(study: &Study<'_>, found: &Found, feature: &Feature, units: &Units) -> Unexplained {
    let channel = &study.scenes[feature.scene].channels[feature.channel];
    let axis = &study.equations.axes[feature.axis];
    let (factor, unit) = axis_unit(study, feature.axis);
    let (from, to) = (feature.from * factor, feature.to * factor);
    let which = match feature.direction {
        d if d > 0.0 => "while it moves forward",
        d if d < 0.0 => "while it moves backward",
        _ => "in both directions of motion",
    };
    let table_of = engine::table_motion(study, found, feature)
        .map(|motion| study.equations.motions[motion].name.clone());
    Unexplained {
        link: Some(axis.letter.clone()),
        direction: channel.name.clone(),
        state: "position",
        interval: Some(Interval { of: IntervalOf::Axis(axis.letter.clone()), from, to, unit }),
        rms: feature.rms * units.unit.0,
        unit: units.unit.1,
        detail: format!(
            "comes back in every pass of {} from {from:.1} to {to:.1} {unit}, {which}; no term of the vocabulary has this form",
            axis.letter
        ),
        table_of,
    }
}

/// What is left of a band of frequencies, or moves smoothly; nothing where only noise is left.
pub(super) fn unsteady(
    study: &Study<'_>,
    found: &Found,
    moving: Option<Moving>,
    units: &Units,
) -> Option<Unexplained> {
    let counted = |moving: &Moving| {
        let kind = study.scenes[moving.scene].channels[moving.channel].kind;
        units.counts(study, kind)
    };
    match moving.filter(counted) {
        Some(moving) => Some(smoothly(study, found, moving, units)),
        None => found.bands.iter().max_by(|a, b| a.rms.total_cmp(&b.rms)).map(|band| of_band(study, *band)),
    }
}

fn smoothly(study: &Study<'_>, found: &Found, moving: Moving, units: &Units) -> Unexplained {
    let channel = &study.scenes[moving.scene].channels[moving.channel];
    let nearest = unsteady::suspect(study, found);
    let link = nearest.as_ref().and_then(|suspect| suspect.fitted.effect.motion());
    let near = nearest.as_ref().map_or_else(String::new, |suspect| near(study, suspect));
    Unexplained {
        link: link.map(|motion| study.equations.motions[motion].link.clone()),
        direction: channel.name.clone(),
        state: "time",
        interval: None,
        rms: moving.rms * units.unit.0,
        unit: units.unit.1,
        detail: format!(
            "keeps its direction for {} and more, as no sensor's noise does: something of the machine is still left out{near}",
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
    format!(
        "; {} of {motion} ({}) comes nearest: alone it would take {:.0} % of it, which so short a recording does not prove",
        effect.shape.name(),
        told.join(", "),
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
        detail: "oscillates with a strength that comes and goes; a steady vibration would be one line, and this is a band"
            .to_owned(),
        table_of: None,
    }
}
