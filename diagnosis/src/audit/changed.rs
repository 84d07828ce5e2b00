//! Changed files: inputs without a fault.
//!
//! In: the files as they were read, a fault and how much of it there is. Out: the files as they would be without it.

use model_dsl::calibration::{CalibratedMotion, CalibratedTerm, Calibration, Curve, CurveNodes, CurveValues};
use model_dsl::equations::{ConstantInfo, Equations};

use super::fault::{Fault, Scope, TermAt};
use crate::Inputs;
use crate::recording::Recording;

/// The parts of the inputs that differ from what was read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Changed {
    equations: Option<Equations>,
    word: Option<String>,
    calibration: Option<Calibration>,
    /// Recordings by their numbers, and the one that is held out as a whole.
    recordings: Vec<(usize, Recording)>,
    holdout: Option<Recording>,
}

impl Changed {
    /// The inputs with an amount of a fault taken out; `None` if the fault does not fit them.
    pub(super) fn new(inputs: &Inputs<'_>, fault: &Fault, amount: f64) -> Option<Self> {
        let known = inputs.calibration?;
        let mut changed = Self::default();
        match fault {
            Fault::Order(word) => {
                let other = (inputs.chains?.derive)(word)?;
                changed.calibration = Some(translated(known, inputs.equations, &other)?);
                changed.equations = Some(other);
                changed.word = Some(word.clone());
            }
            Fault::Scale { recording } => {
                let scaled = scaled(inputs.recordings.get(*recording)?, 1.0 / (1.0 + amount));
                changed.recordings.push((*recording, scaled));
            }
            Fault::Sensors { one, other } => {
                let names = [*one, *other].map(|number| sensor(known, number));
                let swapped = |recording: &Recording| swapped(recording, names);
                let all = inputs.recordings.iter().enumerate();
                changed.recordings = all.map(|(number, recording)| (number, swapped(recording))).collect();
                changed.holdout = inputs.holdout.map(swapped);
            }
            _ => changed.calibration = Some(calibration(known, inputs.equations, fault, amount)?),
        }
        Some(changed)
    }

    /// The inputs with the changed parts.
    pub(crate) fn inputs<'c>(&'c self, of: &Inputs<'c>) -> Inputs<'c> {
        let mut inputs = of.clone();
        inputs.equations = self.equations.as_ref().unwrap_or(of.equations);
        inputs.calibration = self.calibration.as_ref().or(of.calibration);
        if let (Some(chains), Some(word)) = (&mut inputs.chains, &self.word) {
            chains.word = word;
        }
        for (number, recording) in &self.recordings {
            inputs.recordings[*number] = recording;
        }
        inputs.holdout = self.holdout.as_ref().or(of.holdout);
        inputs
    }
}

/// The calibration with an amount of a fault taken out; `None` if the fault is not one of its numbers. For sensors that are exchanged in
/// the recordings, the terms read each other's sensor: that predicts the same.
pub(super) fn calibration(
    known: &Calibration,
    equations: &Equations,
    fault: &Fault,
    amount: f64,
) -> Option<Calibration> {
    let mut changed = known.clone();
    match fault {
        Fault::Size(scope) => resize(&mut changed, equations, *scope, 1.0 + amount),
        Fault::Mirror(at) => mirror(curve(&mut changed, *at)?),
        Fault::Shift { at, .. } => shift(curve(&mut changed, *at)?, amount),
        Fault::Slip { at, nodes } => {
            let curve = curve(&mut changed, *at)?;
            let step = node_step(curve)?;
            shift(curve, f64::from(*nodes) * step);
        }
        Fault::Axis { of, read, .. } => {
            let term = term(&mut changed, *of)?;
            *term = term.clone().with_axis(*read);
        }
        Fault::Directions(at) => match &mut curve(&mut changed, *at)?.values {
            CurveValues::Directed { forward, reverse } => std::mem::swap(forward, reverse),
            CurveValues::Both(_) => return None,
        },
        Fault::Exchange { one, other } => exchange(&mut changed, equations, *one, *other),
        Fault::Moved { from, to } => exchange(&mut changed, equations, *from, *to),
        Fault::Constant(number) => *changed.constants.get_mut(*number)? += amount,
        Fault::Reference => each_term(&mut changed, |term| {
            *term = term.clone().with_references(&|reference| reference + amount);
        }),
        Fault::Sensors { one, other } => each_term(&mut changed, |term| {
            let exchanged = |sensor: usize| match sensor {
                sensor if sensor == *one => *other,
                sensor if sensor == *other => *one,
                sensor => sensor,
            };
            let mut read = term.clone();
            if let Some(sensor) = term.sensor() {
                read = read.with_sensor(exchanged(sensor));
            }
            *term = read.with_factors(|factor| match factor.sensor() {
                Some(sensor) => factor.with_sensor(exchanged(sensor)),
                None => factor,
            });
        }),
        Fault::Order(_) | Fault::Scale { .. } => return None,
    }
    Some(changed)
}

fn term(known: &mut Calibration, at: TermAt) -> Option<&mut CalibratedTerm> {
    let listed = known.motions.iter_mut().find(|listed| listed.motion == at.motion)?;
    Some(&mut listed.terms.get_mut(at.place)?.value)
}

fn curve(known: &mut Calibration, at: TermAt) -> Option<&mut Curve> {
    match term(known, at)? {
        CalibratedTerm::Table { curve, .. } => Some(curve),
        _ => None,
    }
}

/// The curve of a table, to be read.
pub(super) fn table(known: &Calibration, at: TermAt) -> Option<&Curve> {
    match &known.terms(at.motion).get(at.place)?.value {
        CalibratedTerm::Table { curve, .. } => Some(curve),
        _ => None,
    }
}

fn each_term(known: &mut Calibration, mut change: impl FnMut(&mut CalibratedTerm)) {
    let terms = known.motions.iter_mut().flat_map(|listed| &mut listed.terms);
    terms.for_each(|term| change(&mut term.value));
}

fn resize(known: &mut Calibration, equations: &Equations, scope: Scope, factor: f64) {
    for listed in &mut known.motions {
        let motion = &equations.motions[listed.motion];
        for (place, term) in listed.terms.iter_mut().enumerate() {
            let of = match scope {
                Scope::Term(at) => at == TermAt { motion: listed.motion, place },
                Scope::Motion(motion) => motion == listed.motion,
                Scope::Axis(axis) => motion.axis == Some(axis) && !motion.alignment,
                Scope::Angles => motion.angular && !motion.alignment,
                Scope::Everything => true,
            };
            if of {
                let numbers = term.value.linear_mut().into_iter().flat_map(|(_, numbers)| numbers);
                numbers.for_each(|number| *number *= factor);
            }
        }
    }
}

/// The same values from the other end.
fn mirror(curve: &mut Curve) {
    match &mut curve.values {
        CurveValues::Both(values) => values.reverse(),
        CurveValues::Directed { forward, reverse } => {
            forward.reverse();
            reverse.reverse();
        }
    }
}

/// The mean step between the nodes of a curve.
pub(super) fn node_step(curve: &Curve) -> Option<f64> {
    let (places, [first, last]) = (curve.positions(), curve.ends()?);
    (places.len() > 1).then(|| (last - first) / crate::number(places.len() - 1))
}

fn shift(curve: &mut Curve, amount: f64) {
    match &mut curve.nodes {
        CurveNodes::Uniform { start, .. } => *start += amount,
        CurveNodes::At(places) => places.iter_mut().for_each(|place| *place += amount),
    }
}

/// Gives each of two error motions the numbers of the other. What reads the axis of one then reads that of the other: a table is
/// entered under a motion together with its axis.
fn exchange(known: &mut Calibration, equations: &Equations, one: usize, other: usize) {
    let axis = |motion: usize| equations.motions[motion].axis;
    for listed in &mut known.motions {
        let to = match listed.motion {
            motion if motion == one => other,
            motion if motion == other => one,
            _ => continue,
        };
        reread(listed, axis(listed.motion), axis(to));
        listed.motion = to;
    }
}

fn reread(listed: &mut CalibratedMotion, from: Option<usize>, to: Option<usize>) {
    let (Some(from), Some(to)) = (from, to) else { return };
    for term in &mut listed.terms {
        if term.value.axis() == Some(from) {
            term.value = term.value.clone().with_axis(to);
        }
    }
}

/// The calibration for other equations of the same axes; `None` where they lack a motion or a constant.
fn translated(known: &Calibration, from: &Equations, to: &Equations) -> Option<Calibration> {
    let letters = |equations: &Equations| -> Vec<String> {
        equations.axes.iter().map(|axis| axis.letter.clone()).collect()
    };
    if letters(from) != letters(to) {
        return None;
    }
    let mut other = known.clone();
    for listed in &mut other.motions {
        let name = &from.motions[listed.motion].name;
        listed.motion = to.motions.iter().position(|motion| motion.name == *name)?;
    }
    let value = |constant: &ConstantInfo| {
        let place = from.constants.iter().position(|known| known.name == constant.name)?;
        known.constants.get(place).copied()
    };
    other.constants = to.constants.iter().map(value).collect::<Option<_>>()?;
    Some(other)
}

/// The name of a sensor of a calibration.
pub(super) fn sensor(known: &Calibration, number: usize) -> &str {
    known.sensors.iter().nth(number).map_or("", |sensor| sensor.name.value.as_str())
}

/// A recording in which two sensors have each other's readings.
fn swapped(recording: &Recording, [one, other]: [&str; 2]) -> Recording {
    let mut swapped = recording.clone();
    for channel in &mut swapped.temperatures {
        if channel.name == one {
            other.clone_into(&mut channel.name);
        } else if channel.name == other {
            one.clone_into(&mut channel.name);
        }
    }
    swapped
}

fn scaled(recording: &Recording, factor: f64) -> Recording {
    let mut scaled = recording.clone();
    scaled.deviation.iter_mut().flatten().for_each(|reading| *reading *= factor);
    scaled
}
